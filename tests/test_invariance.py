"""What must change nothing: other units, a scene turned in the plane or in space, its mirror image."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import contactdd as cd

# The arithmetic is the same but for rounding (1e-16), enlarged by the condition of the linear systems, 1e5 or less.
UNCHANGED = 1e-9


@dataclass
class View:
    """How a scene is written down: a length and a stress unit, and an orthogonal matrix that turns or mirrors it."""

    length: float = 1.0
    stress: float = 1.0
    turn: np.ndarray = field(default_factory=lambda: np.eye(3))

    def place(self, mesh):
        mesh.domain.geometry.x[:] = self.length * mesh.domain.geometry.x @ self.turn.T
        return mesh

    def original(self, x):
        """Coordinates (dim, n) in the scene as it was."""
        return self.turn[: len(x), : len(x)].T @ x / self.length


def wood(view):
    """An orthotropic material with its axes 30° to the layers of the scene (MPa)."""
    constants = np.array([12e3, 2e3, 1.5e3]) * view.stress
    shear = np.array([750.0, 700.0, 300.0]) * view.stress
    material = cd.Orthotropic(*constants, 0.42, 0.39, 0.31, *shear)
    return material.rotated(view.turn @ Rotation.from_euler("z", 30, degrees=True).as_matrix())


def scene(view, dim):
    """A wooden block on springs below an isotropic one, a groove between, all kinds of loads (mm, MPa)."""
    if dim == 2:
        meshes = [cd.rectangle((0, y), (4, y + 1), (12, 4)) for y in (0, 1)]
        sides = cd.Symmetry("left")
    else:
        meshes = [cd.box((0, y, 0), (4, y + 1, 1), (6, 2, 2)) for y in (0, 1)]
        marks = [{"bottom": mark(1, y), "top": mark(1, y + 1), "back": mark(2, 0)} for y in (0, 1)]
        meshes = [mesh.with_surfaces(**named) for mesh, named in zip(meshes, marks, strict=True)]
        sides = cd.Symmetry("left", "back")
    meshes = [view.place(mesh) for mesh in meshes]
    turn = view.turn[:dim, :dim]
    down = turn @ np.array([0.3, -20.0, 0.0])[:dim]
    steel = cd.Isotropic(2.1e5 * view.stress, 0.3)
    weight = turn @ np.array([0.0, -0.5, 0.0])[:dim] * view.stress / view.length
    springs = cd.Spring("bottom", 4e3 * view.stress / view.length)
    lower = cd.Body("lower", meshes[0], wood(view), supports=[sides, springs], loads=[cd.BodyForce(weight)])
    area = view.stress * view.length ** (dim - 1)
    loads = [cd.Resultant("top", down * area), cd.Pressure("right", lambda x: view.stress * view.original(x[:dim])[1])]
    upper = cd.Body("upper", meshes[1], steel, supports=[sides], loads=loads)

    def gap(x):
        return view.length * 1e-2 * np.maximum(1 - (view.original(x)[0] - 1.0) ** 2, 0) ** 1.5

    layer = cd.PowerLayer(B=4e-5 * view.length / view.stress**1.1, a=1.1)
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), layer, gap=gap)])


def mark(axis, value):
    return lambda x: np.isclose(x[axis], value)


def result(view, dim, method):
    """Everything that can be compared, in the units and axes of the scene as it was."""
    options = {"newton": {"gamma": "search"}, "chord": {"gamma": 0.5, "max_iterations": 60, "on_failure": "return"}}
    solution = cd.solve(scene(view, dim), method, tolerance=1e-10, **options[method])
    contact, turn = solution.contact(), view.turn[:dim, :dim]
    values = {
        "pressure": contact.pressure / view.stress,
        "gap": contact.gap / view.length,
        "energy": solution.energy / (view.stress * view.length**dim),
    }
    for body in ("lower", "upper"):
        u = solution.displacement(body).x.array.reshape(-1, dim) @ turn / view.length
        values[body] = u
        forces = solution.forces(body)["contact"] @ turn
        values[f"force on {body}"] = forces / (view.stress * view.length ** (dim - 1))
    return solution.history.residual[:4], solution.iterations, values


def changed(found, expected):
    return {
        name: float(np.abs(found[name] - expected[name]).max() / np.abs(expected[name]).max())
        for name in found
        if np.abs(found[name] - expected[name]).max() > UNCHANGED * np.abs(expected[name]).max()
    }


IN_PLANE = {angle: Rotation.from_euler("z", angle, degrees=True).as_matrix() for angle in (30, 90, 180)}
VIEWS = {
    "m, N, Pa": (View(length=1e-3, stress=1e6), 2),
    "µm, µN": (View(length=1e3), 2),
    "odd units": (View(length=0.0254, stress=145.03773773), 2),
    "30°": (View(turn=IN_PLANE[30]), 2),
    "90°": (View(turn=IN_PLANE[90]), 2),
    "180°": (View(turn=IN_PLANE[180]), 2),
    "mirror": (View(turn=np.diag([-1.0, 1.0, 1.0])), 2),
    "m, N, Pa in space": (View(length=1e-3, stress=1e6), 3),
    "turned in space": (View(turn=Rotation.random(random_state=5).as_matrix()), 3),
    "mirror in space": (View(turn=np.diag([1.0, 1.0, -1.0])), 3),
}


@pytest.mark.parametrize("method", ["newton", "chord"])
@pytest.mark.parametrize("name", VIEWS)
def test_another_view_changes_no_iteration_and_no_digit(name, method):
    view, dim = VIEWS[name]
    residuals, iterations, expected = result(View(), dim, method)
    again, iterations_again, found = result(view, dim, method)
    assert changed(found, expected) == {}
    if np.allclose(np.abs(view.turn).max(axis=0), 1.0):
        # On tilted contacts other unknowns are eliminated: the residual has another norm, and may pass a step later.
        assert iterations_again == iterations
        assert np.abs(again - residuals).max() < UNCHANGED


def test_the_scene_is_not_symmetric_by_itself():
    """Else turning and mirroring it would show little."""
    _, iterations, values = result(View(), 2, "newton")
    assert 2 < iterations < 30
    closed = values["gap"] < 0
    assert 0.2 < closed.mean() < 1.0
    assert np.ptp(values["pressure"][closed]) > 0.5 * values["pressure"].max()
