"""Local solvers and bodies without a mesh that a user brings: through the front door, with every method."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import own_local_solver
import own_partner
import pytest

import contactdd as cd

STEEL = cd.Isotropic(2.1e5, 0.3)
SIDES = [cd.Symmetry("left", "right")]
DEMOS = Path(__file__).parents[1] / "demos"


class RigidCylinder(cd.MeshlessBody):
    """A rigid cylinder that may move up and down, under a force or moved to a height."""

    def __init__(self, centre, radius, force=0.0, moved=None):
        super().__init__("cylinder")
        self.centre, self.radius, self.force, self.moved = np.array(centre), radius, force, moved

    def gap(self, x, direction):
        offset = self.centre - x
        along = np.sum(offset * direction, axis=1)
        return along - np.sqrt(self.radius**2 - (np.sum(offset**2, axis=1) - along**2))

    def normal_displacement(self, x, direction):
        arm = x - self.centre
        return -np.column_stack([direction, arm[:, 0] * direction[:, 1] - arm[:, 1] * direction[:, 0]])

    def load(self):
        return np.array([0.0, -self.force, 0.0])

    def prescribed(self):
        return np.array([0.0, np.nan if self.moved is None else self.moved, 0.0])


def block():
    """A block fine about the middle of its top."""
    fine = np.concatenate([np.linspace(0, 1, 41)[:-1], np.geomspace(1, 10, 20)])
    depth = np.concatenate([[0.0], np.geomspace(0.02, 10, 30)])
    mesh = cd.rectangle(
        (-10, -10), (10, 0), (np.concatenate([-fine[:0:-1], fine]), -depth[::-1]), shape="quadrilateral"
    )
    return cd.Body("block", mesh, cd.Isotropic(1e3, 0.3), supports=[cd.Fixed("bottom")], degree=2)


def pressed(cylinder, swapped=False, **options):
    body = block()
    sides = [(body, "top"), cylinder]
    contact = cd.Contact(*(sides[::-1] if swapped else sides), cd.LinearLayer(1e6))
    return cd.solve(cd.Scene([body, cylinder], [contact]), **options)


def test_a_rigid_cylinder_is_hertz():
    force, radius = 10.0, 10.0
    solution = pressed(RigidCylinder((0, radius), radius, force))
    half_width = np.sqrt(4 * force * radius * (1 - 0.3**2) / (np.pi * 1e3))
    result = solution.contact()
    # The layer (1e6 against E/a = 3e3) and the finite block leave a few parts in a thousand.
    assert result.pressure.max() == pytest.approx(2 * force / (np.pi * half_width), rel=5e-3)
    assert result.force == pytest.approx(force, rel=1e-9)
    assert solution.forces("cylinder")["loads"].tolist() == [0.0, -force]


def test_force_and_displacement_say_the_same():
    loaded = pressed(RigidCylinder((0, 10.0), 10.0, force=10.0))
    depth = loaded.displacement("cylinder")[1]
    moved = pressed(RigidCylinder((0, 10.0), 10.0, moved=depth))
    assert moved.contact().force == pytest.approx(10.0, rel=1e-8)  # both are solved to 1e-10
    assert moved.forces("cylinder")["supports"][1] == pytest.approx(-10.0, rel=1e-8)


def test_the_order_of_the_sides_does_not_matter():
    one, other = (pressed(RigidCylinder((0, 10.0), 10.0, 10.0), swapped=swapped) for swapped in (False, True))
    assert other.contact().pressure == pytest.approx(one.contact().pressure, abs=1e-8 * one.contact().pressure.max())
    assert np.all(other.contact().normal == -one.contact().normal)


@pytest.mark.parametrize("method", ["auto", "newton-krylov", "newton-chord", "chord", "anderson"])
def test_every_method_takes_a_body_without_a_mesh(method):
    found, expected = (own_partner.solve(16, name) for name in (method, "newton"))
    assert found.contact().pressure == pytest.approx(expected.contact().pressure, abs=1e-6 * 30)  # solved to 1e-10
    assert found.imbalance < 1e-8
    assert found.residual < 1e-9


def test_influence_functions_converge():
    errors = [own_partner.error(own_partner.solve(cells)) for cells in (16, 32, 64)]
    rate = -np.polyfit(np.log([16, 32, 64]), np.log(errors), 1)[0]
    assert rate > 1.7  # linear triangles: 2, but for the kink at the edge of contact


def scene(local_solver, modulus=2.1e5, load=10.0):
    meshes = [cd.rectangle((0, y), (4, y + 1), (16, 8)) for y in (0, 1)]
    lower = cd.Body("lower", meshes[0], STEEL, supports=SIDES, loads=[cd.Pressure("bottom", load)])
    loads, material = [cd.Pressure("top", load)], cd.Isotropic(modulus, 0.3)
    upper = cd.Body("upper", meshes[1], material, supports=SIDES, loads=loads, local_solver=local_solver)
    contact = cd.Contact((lower, "top"), (upper, "bottom"), cd.PowerLayer(4e-6, 1.1), gap=own_local_solver.groove)
    return cd.Scene([lower, upper], [contact])


def rigid(task):
    return cd.ReducedProblem(task, task.body.rigid_modes())


@pytest.mark.parametrize("method", ["auto", "newton-krylov", "chord"])
def test_a_rigid_body_is_one_of_endless_stiffness(method):
    found = cd.solve(scene(rigid), method, tolerance=1e-9)
    stiff = cd.solve(scene(None, modulus=1e13), tolerance=1e-9)
    peak = stiff.contact().pressure.max()
    # The ratio of the moduli is 5e7: what is left of the stiff body's deformation is about its inverse.
    assert np.abs(found.contact().pressure - stiff.contact().pressure).max() < 1e-7 * peak
    assert found.residual < 1e-8
    assert found.imbalance < 1e-8


def test_a_whole_basis_is_the_body_itself():
    found = cd.solve(scene(lambda task: cd.ReducedProblem(task, np.eye(task.body.dofs))))
    expected = cd.solve(scene(None))
    # Both are solved to 1e-10; the eigenvalues of the whole basis lose some digits.
    assert found.contact().pressure == pytest.approx(expected.contact().pressure, abs=1e-7 * 24)
    u, v = (solution.displacement("upper").x.array.reshape(-1, 2) for solution in (found, expected))
    assert u - u.mean(axis=0) == pytest.approx(v - v.mean(axis=0), abs=1e-8 * np.abs(v).max())


def test_a_load_programme_goes_through_own_solvers():
    q = cd.Parameter(10.0)
    of = scene(rigid, load=q)
    cd.solve(of)
    q.value = 20.0
    assert cd.solve(of).contact().force == pytest.approx(80.0, rel=1e-9)


def test_a_registered_solver_is_asked_for_by_its_name():
    name = "rigid, for this test"
    cd.register_local_solver(name, rigid)
    try:
        by_name = cd.solve(scene(name)).contact().pressure
    finally:
        del cd.LOCAL_SOLVERS[name]
    assert by_name == pytest.approx(cd.solve(scene(rigid)).contact().pressure, abs=1e-8 * by_name.max())


def test_what_is_refused():
    with pytest.raises(ValueError, match="name = 'auto': there is a local solver of that name"):
        cd.register_local_solver("auto", rigid)
    with pytest.raises(TypeError, match="make = 3: expected a function"):
        cd.register_local_solver("three", 3)
    with pytest.raises(ValueError, match="local_solver = 'mine': expected one of"):
        scene("mine")
    with pytest.raises(ValueError, match=r"basis of shape \(3, 3\): expected finite numbers \(\d+, n\)"):
        cd.solve(scene(lambda task: cd.ReducedProblem(task, np.eye(3))))
    cylinder = RigidCylinder((0, 10.0), 10.0, 1.0)
    with pytest.raises(ValueError, match="expected one with a mesh"):
        cd.Contact(cylinder, RigidCylinder((0, -10.0), 10.0), cd.LinearLayer(1.0))
    cylinder.force = np.inf
    with pytest.raises(ValueError, match=r"load\(\) of body 'cylinder'"):
        pressed(cylinder)
    with pytest.raises(ValueError, match=r"gap of shape .*: expected finite numbers of \d+ points"):
        pressed(RigidCylinder((0, 1.0), np.nan, 1.0))


@pytest.mark.parametrize("demo", ["own_partner", "own_local_solver"])
def test_demos_draw_their_pictures(demo, tmp_path):
    command = [sys.executable, str(DEMOS / f"{demo}.py"), "--out", str(tmp_path)]
    subprocess.run(command, check=True, timeout=120)
    assert (tmp_path / "pressure.png").stat().st_size > 10_000
