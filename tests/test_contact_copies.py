"""Contacts that are copies of each other, moved, are paired once: each is what it would be if it were found alone."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import scipy

import contactdd as cd
from contactdd.interface import alike, detection
from contactdd.interface.detection import facing_pairs
from contactdd.interface.discretise import Interface, discretise
from contactdd.interface.overlap import common_normals, segments
from contactdd.local import choose

LAYER = cd.PowerLayer(B=4e-6, a=1.1)


def dent(x: np.ndarray) -> np.ndarray:
    """A gap that is another one at every height."""
    return 1e-4 * (1 + x[-1]) * np.maximum(np.cos(x[0]), 0) ** 1.5


def block(place: int, cells: int, dim: int, bulge: float = 0.0, **more) -> cd.Body:
    """A block of a stack, made of something of its own, its top and bottom curved alike."""
    if dim == 2:
        mesh = cd.rectangle((0, place), (2, place + 1), (cells, 2), shape="quadrilateral")
    else:
        mesh = cd.box((0, 0, place), (2, 1, place + 1), (cells, 2, 1))
    x = mesh.domain.geometry.x
    x[:, dim - 1] += bulge * x[:, 0] * (2 - x[:, 0])
    supports: list[object] = [cd.Symmetry("left", "right"), *([cd.Symmetry("front", "back")] if dim == 3 else [])]
    supports += [cd.Fixed("bottom")] if place == 0 else []
    return cd.Body(f"block {place}", mesh, cd.Isotropic(2e5 * (1 + place % 5), 0.3), supports=supports, **more)


def stack(cells: list[int], dim: int = 2, bulge: float = 0.0, degree: int = 1, **more) -> cd.Scene:
    top = {"loads": [cd.Pressure("top", 10.0)]}
    last = len(cells) - 1
    blocks = [
        block(place, n, dim, bulge, degree=degree, **(top if place == last else {})) for place, n in enumerate(cells)
    ]
    contacts = [cd.Contact((a, "top"), (b, "bottom"), LAYER, gap=dent, **more) for a, b in pairwise(blocks)]
    return cd.Scene(blocks, contacts)


def found_alone(scene: cd.Scene) -> list[Interface]:
    index = {body.name: place for place, body in enumerate(scene.bodies)}
    return [discretise(c, (index[c.sides[0][0].name], index[c.sides[1][0].name])) for c in scene.contacts]


def differs(one: object, other: object, rounding: float) -> bool:
    a, b = (np.asarray(each.toarray() if scipy.sparse.issparse(each) else each) for each in (one, other))
    return a.shape != b.shape or bool(np.abs(a - b).max() > rounding)


CASES = {
    "plane, unlike": ([4, 3] * 3, {}),
    "plane, alike": ([3] * 5, {}),
    "curved": ([5, 4] * 3, {"bulge": 0.1}),
    "quadratic": ([3, 2] * 2, {"degree": 2, "quadrature_degree": 6}),
    "facets": ([4, 3] * 2, {"quadrature": "facet"}),
    "space": ([3, 2] * 2, {"dim": 3}),
}


@pytest.mark.parametrize("case", CASES)
def test_a_copy_is_the_contact_elsewhere(case):
    cells, more = CASES[case]
    scene = stack(cells, **more)
    alone, shared = found_alone(scene), scene.interfaces
    first = shared[0].sides[0].trace
    assert any(i.sides[0].trace is first for i in shared[1:]), "some contacts are copies"
    axis = np.eye(shared[0].x.shape[1])[0]
    for one, other in zip(alone, shared, strict=True):
        rounding = 1e-13 * len(cells)  # of the coordinates, in facets that are a tenth of the height or more
        for name in ("x", "normal", "weights", "geometric_gap", "prescribed_gap"):
            assert not differs(getattr(one, name), getattr(other, name), rounding), name
        for here, there in zip(one.sides, other.sides, strict=True):
            assert here.body == there.body
            assert here.surface.body is there.surface.body
            assert not differs(here.trace, there.trace, rounding)
            assert not differs(here.along(axis), there.along(axis), rounding)
            values = one.x[:, 0]
            assert not differs(here.transfer @ values, there.transfer @ values, 10 * rounding)
            for name in ("corners", "moduli", "facet_sizes", "trace", "weights"):
                assert not differs(getattr(here.surface, name), getattr(there.surface, name), 1e6 * rounding), name
            assert not differs(here.surface.points.x, there.surface.points.x, rounding)
        assert one.functions.surface.body is other.functions.surface.body
        assert not differs(one.functions.x, other.functions.x, rounding)
        assert not differs(one.functions.at_values, other.functions.at_values, 10 * rounding)
        assert one.unpaired_area == pytest.approx(other.unpaired_area)


def test_sharing_changes_no_pressure(monkeypatch):
    """The gap at each height is another one, the blocks' moduli are others: only the geometry is shared."""
    shared = cd.solve(stack([5, 4] * 4, bulge=0.1))
    monkeypatch.setattr(alike, "_likeness", lambda contact: object())
    alone = cd.solve(stack([5, 4] * 4, bulge=0.1))
    for contact in range(7):
        pressure = alone.contact(contact).pressure
        assert shared.contact(contact).pressure == pytest.approx(pressure, abs=1e-8 * pressure.max())  # 100 tolerances


def apart(gap: float) -> cd.Body:
    mesh = cd.rectangle((3, 1 + gap), (5, 2 + gap), (3, 2), shape="quadrilateral")
    return cd.Body("apart", mesh, cd.Isotropic(2e5, 0.3))


@pytest.mark.parametrize("wider", [1e-3, 1e-9])
def test_a_wider_gap_is_no_copy(wider):
    """Beside a block on a block the same blocks, further apart: by more than rounding it is another contact."""
    lower, upper = block(0, 4, 2), block(1, 3, 2)
    beside = cd.Body("beside", lower.mesh.moved((3, 0)), cd.Isotropic(2e5, 0.3))
    above = apart(wider)
    contacts = [
        cd.Contact((lower, "top"), (upper, "bottom"), LAYER),
        cd.Contact((beside, "top"), (above, "bottom"), LAYER),
    ]
    touching, open_ = cd.Scene([lower, upper, beside, above], contacts).interfaces
    assert not np.any(touching.geometric_gap)
    assert open_.geometric_gap == pytest.approx(wider, rel=1e-6)  # rounding of heights of one


@pytest.mark.parametrize("other", [{"measure_gap": False}, {"quadrature": "facet"}, {"quadrature_degree": 5}])
def test_other_settings_are_no_copy(other):
    """The same two meshes above each other a second time, paired in another way."""
    blocks = [block(place, 4 - place % 2, 2) for place in range(4)]
    contacts = [
        cd.Contact((blocks[0], "top"), (blocks[1], "bottom"), LAYER),
        cd.Contact((blocks[1], "top"), (blocks[2], "bottom"), LAYER),
        cd.Contact((blocks[2], "top"), (blocks[3], "bottom"), LAYER, **other),
    ]
    scene = cd.Scene(blocks, contacts)
    first, _, last = scene.interfaces
    assert last.sides[0].trace is not first.sides[0].trace
    alone = found_alone(scene)[2]
    assert not differs(alone.x, last.x, 0.0)
    assert not differs(alone.weights, last.weights, 0.0)


def test_a_ring_that_is_moved_is_another_ring():
    """Rings of other radii have other areas: no contact of theirs is taken over."""
    rings = [
        cd.Body(
            f"ring {place}",
            cd.rectangle((1 + place, 0), (2 + place, 1), (2, 3 + place % 2), shape="quadrilateral"),
            cd.Isotropic(2e5, 0.3),
            kinematics="axisymmetric",
        )
        for place in range(5)
    ]
    contacts = [cd.Contact((a, "right"), (b, "left"), LAYER) for a, b in pairwise(rings)]
    for place, interface in enumerate(cd.Scene(rings, contacts).interfaces):
        assert interface.weights.sum() == pytest.approx(2 * np.pi * (2 + place))


def test_a_fingerprint_is_that_of_all_copies():
    mesh = cd.rectangle((0, 0), (2, 1), (4, [0, 0.3, 1]))
    copies = [mesh.moved((1e3, -7.1)), mesh.mirrored("x", 0.3), mesh.with_surfaces(corner=lambda x: x[0] > 1.4)]
    assert {copy.fingerprint for copy in copies} == {mesh.fingerprint}
    assert cd.rectangle((0, 0), (2, 1), (4, [0, 0.301, 1])).fingerprint != mesh.fingerprint
    assert cd.rectangle((0, 0), (2, 1), (4, [0, 0.7, 1])).fingerprint != mesh.fingerprint


def rough(count: int, side: float, dim: int, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Facets here and there above the unit square, and their normals on that side."""
    middles = np.hstack([random.random((count, dim - 1)), 0.02 * random.random((count, 1))])
    size = [*np.full(dim - 1, 0.2), 0.05]
    corners = middles[:, None] + size * (random.random((count, dim, dim)) - 0.5)
    edges = corners[:, 1:] - corners[:, :1]
    normals = edges[:, 0, ::-1] * [1, -1] if dim == 2 else np.cross(edges[:, 0], edges[:, 1])
    normals *= side * np.sign(normals[:, -1:]) / np.linalg.norm(normals, axis=1, keepdims=True)
    return corners, normals


@pytest.mark.parametrize("dim", [2, 3])
def test_few_facets_meet_as_by_trees(dim, monkeypatch):
    """All pairs looked at: trees leave out some of these, but none that overlaps along its common normal."""
    random = np.random.default_rng(dim)
    first, second = rough(40, 1.0, dim, random), rough(33, -1.0, dim, random)

    def overlapping(pairs: tuple[np.ndarray, np.ndarray]) -> set[tuple[int, int]]:
        i, j = pairs
        facing = np.sum(first[1][i] * second[1][j], axis=1) < -0.5
        i, j = i[facing], j[facing]
        points, weights = np.full((1, dim - 1), 1 / 3), np.ones(1)
        common = common_normals(first[1][i], second[1][j])
        pair = segments(first[0][i], second[0][j], common, points, weights).pair
        return set(zip(i[pair].tolist(), j[pair].tolist(), strict=True))

    few = facing_pairs(*first, *second, 0.5)
    monkeypatch.setattr(detection, "FEW", 0)
    by_trees = facing_pairs(*first, *second, 0.5)
    assert overlapping(few) == overlapping(by_trees)
    assert 20 < len(overlapping(few)) < len(few[0]) < 40 * 33


@pytest.mark.parametrize("dim", [2, 3])
def test_many_bodies_give_the_fields_of_few(dim, monkeypatch):
    """What many bodies do not keep is made again: the same displacements, stresses and energy."""
    few = cd.solve(stack([3, 2] * 2, dim))
    monkeypatch.setattr(choose, "MANY", 1)
    many = cd.solve(stack([3, 2] * 2, dim))
    assert all(scipy.sparse.issparse(port.trace) for p in many._ensemble.problems for port in p.traces)
    assert many.iterations == few.iterations
    for place in range(4):
        name = f"block {place}"
        u, v = (solution.displacement(name).x.array for solution in (few, many))
        assert v == pytest.approx(u, abs=1e-11 * np.abs(u).max())  # sums in another order, a few hundred terms
        s, t = (solution.stress(name).x.array for solution in (few, many))
        assert t == pytest.approx(s, abs=1e-10 * np.abs(s).max())
    assert many.history.energy[-1] == pytest.approx(few.history.energy[-1], rel=1e-12)
