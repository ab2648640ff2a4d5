"""Bodies on copies of one mesh take over what their original knows, and nothing changes by it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scenes import LAYER, STEEL

import contactdd as cd
from contactdd.local.choose import LocalSolvers
from contactdd.local.condensation import MirroredCondensation
from contactdd.local.copies import originals, signs_between

#: Its axes are turned, so that the mirror image is another material.
WOOD = cd.Orthotropic(11e3, 0.9e3, 0.5e3, 0.4, 0.45, 0.5, 0.7e3, 0.6e3, 0.06e3).rotated(0.5)


def block(shape: str) -> cd.Mesh:
    if shape in ("triangle", "quadrilateral"):
        return cd.rectangle((0, 0), (2, 1), (4, [0, 0.4, 1]), shape=shape)
    return cd.box((0, 0, 0), (2, 1, 1), (3, 2, [0, 0.4, 1]), shape=shape)


def walls(mesh: cd.Mesh) -> cd.Symmetry:
    return cd.Symmetry("left", "right") if mesh.dim == 2 else cd.Symmetry("left", "right", "front", "back")


def groove(x: np.ndarray) -> np.ndarray:
    return 4e-4 * np.maximum(1 - x[0], 0) ** 2


def stack(shape: str, degree: int, load: object = 10.0, material: object = STEEL) -> cd.Scene:
    """Four blocks, every second one upside down, pressed from below and above; nothing holds them up."""
    first = block(shape)
    axis, height = ("y", 1.0) if first.dim == 2 else ("z", 1.0)
    up = np.eye(first.dim)[-1]
    flipped = first.mirrored(axis, height / 2)
    meshes = [(flipped if place % 2 else first).moved(place * height * up) for place in range(4)]
    outer = {0: "bottom", 3: "bottom"}  # the topmost is upside down
    bodies = [
        cd.Body(
            f"block {place}",
            mesh,
            material,
            degree=degree,
            supports=[walls(mesh)],
            loads=[cd.Pressure(outer[place], load)] if place in outer else [],
        )
        for place, mesh in enumerate(meshes)
    ]
    facing = [("top", "top"), ("bottom", "bottom"), ("top", "top")]
    contacts = [
        cd.Contact((a, s), (b, t), LAYER, gap=groove, name=f"{a.name}, {b.name}")
        for (a, b), (s, t) in zip(pairwise(bodies), facing, strict=True)
    ]
    return cd.Scene(bodies, contacts)


def alone(scene: cd.Scene) -> cd.Scene:
    """The scene, in which no body knows that it is a copy."""
    scene._solvers = LocalSolvers(scene.bodies, scene.interfaces, scene.ranks)
    scene._solvers._originals = [None] * len(scene.bodies)
    return scene


@pytest.mark.parametrize("method", ["auto", "chord"])
@pytest.mark.parametrize(
    ("shape", "degree"),
    [("triangle", 1), ("quadrilateral", 2), ("quadrilateral", 4), ("tetrahedron", 1), ("hexahedron", 1)],
)
@pytest.mark.parametrize("local_solver", ["condensed", "assembled"])
def test_sharing_changes_nothing(shape, degree, local_solver, method):
    options = {"local_solver": local_solver, "tolerance": 1e-10 if method == "auto" else 1e-6}
    scene = stack(shape, degree)
    assert [found is None for found in originals(scene.bodies)] == [True, False, False, False]
    shared = cd.solve(scene, method, **options)
    if local_solver == "condensed":
        assert any(
            isinstance(problem.condensation, MirroredCondensation) for problem in scene.local_problems("condensed")
        )
    expected = cd.solve(alone(stack(shape, degree)), method, **options)
    assert shared.iterations == expected.iterations
    for contact in scene.contacts:
        p, q = (solution.contact(contact.name).pressure for solution in (shared, expected))
        assert p == pytest.approx(q, abs=1e-7 * q.max())  # both are solved to no more than 1e-6 and alike
    for body in scene.bodies:
        u, v = (solution.displacement(body.name).x.array for solution in (shared, expected))
        assert u == pytest.approx(v, abs=1e-8 * np.abs(v).max())
        f, g = (solution.forces(body.name) for solution in (shared, expected))
        for name in f:
            assert f[name] == pytest.approx(g[name], abs=1e-6 * 20.0)  # the load is 10 on 2
    assert shared.imbalance < 2 * options["tolerance"]  # what the iteration left


def test_a_load_programme_of_copies():
    load = cd.Parameter(5.0)
    scene = stack("quadrilateral", 3, load)
    for value in (5.0, 20.0):
        load.value = value
        p = cd.solve(scene).contact(1).pressure
        assert p == pytest.approx(cd.solve(stack("quadrilateral", 3, value)).contact(1).pressure, rel=1e-8)


def test_a_copy_may_be_loaded_in_another_way():
    def scene(mesh: cd.Mesh, face: str, outer: str) -> cd.Scene:
        first = block("quadrilateral")
        lower = cd.Body("lower", first, STEEL, degree=3, supports=[walls(first)], loads=[cd.Pressure("bottom", 10.0)])
        pull = [cd.Traction(outer, [0.0, -10.0]), cd.BodyForce([1.0, 0.0])]
        upper = cd.Body("upper", mesh, STEEL, degree=3, supports=[walls(mesh)], loads=pull)
        return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, face), cd.LinearLayer(1e6), gap=groove)])

    copied = cd.solve(scene(block("quadrilateral").mirrored("y", 1.0), "top", "bottom"))
    anew = cd.rectangle((0, 1), (2, 2), (4, [1, 1.6, 2]), shape="quadrilateral")
    expected = cd.solve(scene(anew, "bottom", "top"))
    assert copied.contact().pressure == pytest.approx(expected.contact().pressure, abs=1e-8 * 10)


def test_a_copy_that_moves_is_named_with_its_motion():
    """Nothing holds the bodies sideways, and something pulls the upper one there."""

    def scene() -> cd.Scene:
        mesh = block("quadrilateral")
        sides = [cd.Symmetry("bottom")]
        pull = [cd.Pressure("left", 1.0)]
        lower = cd.Body("lower", mesh, STEEL, supports=sides)
        upper = cd.Body("upper", mesh.mirrored("y", 1.0), STEEL, supports=sides, loads=pull)
        return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "top"), cd.LinearLayer(1e6))])

    named = []
    for each in (scene(), alone(scene())):
        with pytest.raises(cd.NoEquilibriumError) as failure:
            cd.solve(each)
        named.append((failure.value.body, failure.value.motion))
    assert named == [("upper", "translation along x")] * 2


def test_rotations_of_a_mirror_image():
    """A body that may turn: its motions are those of the original, seen in the mirror."""

    def scene() -> cd.Scene:
        mesh = block("hexahedron")
        lower = cd.Body("lower", mesh, STEEL, loads=[cd.Pressure("bottom", 10.0)])
        upper = cd.Body("upper", mesh.mirrored("z", 1.0), STEEL, loads=[cd.Pressure("bottom", 10.0)])
        return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "top"), LAYER, gap=groove)])

    shared, expected = cd.solve(scene()), cd.solve(alone(scene()))
    for name in ("lower", "upper"):
        u, v = (solution.displacement(name).x.array for solution in (shared, expected))
        assert u == pytest.approx(v, abs=1e-8 * np.abs(v).max())


def test_which_bodies_are_copies():
    mesh = block("quadrilateral")
    original = cd.Body("original", mesh, STEEL, supports=[cd.Fixed("bottom")])
    moved, mirrored = mesh.moved((3, 0)), mesh.mirrored("x", 5.0)

    def signs(mesh: cd.Mesh, material: object = STEEL, **options: object) -> list[float] | None:
        found = signs_between(
            original, cd.Body("other", mesh, material, **{"supports": [cd.Fixed("bottom")], **options})
        )
        return None if found is None else found.tolist()

    assert signs(moved) == [1, 1]
    assert signs(mirrored) == [-1, 1]
    assert signs(mirrored.mirrored("y", 0.0), cd.Isotropic(2.1e5, 0.3)) == [-1, -1]
    assert signs(cd.rectangle((3, 0), (5, 1), (4, [0, 0.4, 1]), shape="quadrilateral")) == [1, 1]  # made anew
    assert signs(cd.rectangle((3, 0), (5, 1), (4, [0, 0.4 + 1e-12, 1]), shape="quadrilateral")) is None
    assert signs(moved, cd.Isotropic(2.1e5, 0.29)) is None
    assert signs(moved, degree=2) is None
    assert signs(moved, kinematics="plane stress") is None
    assert signs(moved, supports=[cd.Fixed("top")]) is None
    assert signs(moved, supports=[cd.Displacement("bottom", (0.0, 0.0))]) is None
    mesh.domain.geometry.x[0, 1] -= 0.01  # a corner of the original is no longer where the copies' is
    assert signs(moved) is None


def test_a_material_that_leans_is_another_one_in_the_mirror():
    mesh = block("quadrilateral")
    original, moved, mirrored = (
        cd.Body("body", each, WOOD) for each in (mesh, mesh.moved((3, 0)), mesh.mirrored("y", 1.0))
    )
    assert signs_between(original, moved).tolist() == [1, 1]
    assert signs_between(original, mirrored) is None
    scene = stack("quadrilateral", 3, material=WOOD)
    assert [found and found[0] for found in originals(scene.bodies)] == [None, None, 0, 1]
    shared = cd.solve(scene)
    expected = cd.solve(alone(stack("quadrilateral", 3, material=WOOD)))
    for index in range(3):
        p, q = (solution.contact(index).pressure for solution in (shared, expected))
        assert p == pytest.approx(q, abs=1e-7 * q.max())
