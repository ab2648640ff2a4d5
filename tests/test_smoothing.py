"""Smoothed meshes: the same body in as many cells, of better shape, and fewer of them for an accuracy."""

from __future__ import annotations

import numpy as np
import pytest
import scenes

import contactdd as cd
from contactdd.base import compat
from contactdd.base.triangles import areas, flipped, inner_edges
from contactdd.smoothing import outline_points, smoothed, smooths

NOWHERE = np.zeros((0, 2))


def nodes_and_cells(mesh):
    return mesh.domain.geometry.x[:, :2], compat.geometry_dofmap(mesh.domain)


def graded(mesh, held=NOWHERE, ends=NOWHERE):
    """The mesh halved towards the origin and smoothed, its cells wanted smaller there."""
    for _ in range(3):
        mesh = mesh.refined(np.linalg.norm(mesh.middles[:, :2], axis=1) < 0.8)
    return mesh, smoothed(mesh, 0.05 + np.linalg.norm(mesh.middles[:, :2], axis=1), held, ends)


def body(mesh):
    return cd.Body("b", mesh, scenes.STEEL)


def notched():
    """Three quarters of a square, in two parts: a corner points inwards."""
    square = cd.rectangle((-1, -1), (1, 1), (8, 8))
    x, cells = nodes_and_cells(square)
    kept = ~np.all(square.middles[:, :2] > 0, axis=1)
    used, numbers = np.unique(cells[kept], return_inverse=True)
    domain = compat.from_arrays(numbers.reshape(-1, 3), x[used], compat.coordinate_element("triangle", 1))
    mesh = cd.Mesh(domain, {}).with_surfaces(
        notch=lambda x: (np.isclose(x[0], 0) & (x[1] > -1e-9)) | (np.isclose(x[1], 0) & (x[0] > -1e-9)),
        low=lambda x: np.isclose(x[1], -1) & (x[0] < 0.3),
    )
    return mesh.with_subdomains(left=lambda x: x[0] < 0, right=lambda x: x[0] > 0)


def test_the_body_stays():
    """Its area, its surfaces and the areas of its parts, inwards pointing corners and the ends of surfaces included."""
    before, after = graded(notched())
    assert after.cells == before.cells
    surfaces = list(before.surfaces)
    assert [body(after).area(n) for n in surfaces] == pytest.approx([body(before).area(n) for n in surfaces], rel=1e-12)
    sizes = [np.abs(areas(*nodes_and_cells(mesh))) for mesh in (before, after)]
    for name in before.subdomains:
        own = [size[mesh.subdomains[name]].sum() for size, mesh in zip(sizes, (before, after), strict=True)]
        assert own[0] == pytest.approx(own[1], rel=1e-12)
        assert np.all((after.middles[after.subdomains[name], 0] < 0) == (name == "left"))
    low = outline_points(after, ["notch"])
    assert low[:, 1].min() == pytest.approx(-1)
    assert sizes[1].min() > 0


def least_angles(mesh):
    x, cells = nodes_and_cells(mesh)
    sides = np.stack([x[cells[:, (i + 1) % 3]] - x[cells[:, i]] for i in range(3)])
    lengths = np.linalg.norm(sides, axis=2)
    cosines = [-(sides[i] * sides[i - 1]).sum(axis=1) / (lengths[i] * lengths[i - 1]) for i in range(3)]
    return np.degrees(np.arccos(np.max(cosines, axis=0)))


def test_better_shapes():
    """All halved cells have angles of 45° or less; where sizes vary, smoothed ones are closer to 60°."""
    before, after = (least_angles(mesh) for mesh in graded(cd.rectangle((0, 0), (2, 2), (8, 8))))
    assert before.max() == pytest.approx(45)
    assert (after > 47).mean() > 0.4
    assert after.min() > 15


def test_flips_end_in_a_delaunay_triangulation():
    """No node lies in the circle through the corners of a triangle: opposite angles are at most π together."""
    rng = np.random.default_rng(3)
    mesh = cd.rectangle((0, 0), (1, 1), (12, 12))
    x, cells = nodes_and_cells(mesh)
    inner = np.all((x > 1e-9) & (x < 1 - 1e-9), axis=1)
    x = x + 0.02 * rng.standard_normal(x.shape) * inner[:, None]
    cells = np.where((areas(x, cells) < 0)[:, None], cells[:, [0, 2, 1]], cells)
    made = flipped(x, cells, np.zeros(len(cells), dtype=int))
    assert areas(x, made).min() > 0
    assert areas(x, made).sum() == pytest.approx(1.0, rel=1e-12)
    one, two = inner_edges(made)

    def angle(places):
        here, ends = x[made.ravel()[places]], [x[made[places // 3, (places % 3 + i) % 3]] for i in (1, 2)]
        u, v = ends[0] - here, ends[1] - here
        return np.arctan2(np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]), (u * v).sum(axis=1))

    assert (angle(one) + angle(two)).max() < np.pi + 1e-6


def test_nodes_that_are_held_and_wanted():
    """A node of the outline stays, another one is moved to where contact ends, as far as it lies within reach."""
    held, wanted = np.array([[0.5, 0.0]]), np.array([[0.77, 0.0]])
    _, after = graded(cd.rectangle((0, 0), (2, 2), (8, 8)), held, wanted)
    x, _ = nodes_and_cells(after)
    for point in (*held, *wanted):
        assert np.linalg.norm(x - point, axis=1).min() < 1e-12


def test_mirror_images_become_mirror_images():
    """Bodies that are copies stay so, and are condensed once."""
    mesh = cd.rectangle((0, 0), (2, 2), (8, 8))
    one, two = graded(mesh)[1], graded(mesh.mirrored("x", 0.0))[1]
    isometry = two.isometry_from(one)
    assert isometry is not None
    assert list(isometry.signs) == [-1, 1]


def test_only_straight_plane_triangles():
    assert smooths(cd.rectangle((0, 0), (1, 1), (2, 2)))
    assert not smooths(cd.rectangle((0, 0), (1, 1), (2, 2), shape="quadrilateral"))
    assert not smooths(cd.box((0, 0, 0), (1, 1, 1), (1, 1, 1)))


def true_error(solution):
    exact, result = cd.reference.groove(), solution.contact()
    p = exact.pressure(np.clip(result.x[:, 0], 0, exact.length))
    return np.sqrt(result.weights @ (result.pressure - p) ** 2 / (result.weights @ p**2))


def unknowns(scene):
    return sum(each.dofs for each in scene.bodies)


@pytest.mark.parametrize(("degree", "accuracy", "n", "fewer"), [(1, 1e-3, 32, 4.0), (2, 1.5e-4, 16, 5.0)])
def test_fewer_unknowns_than_uniform(degree, accuracy, n, fewer):
    """To the same error of p on the groove: 4.9 and 8 times fewer were measured; the error falls like N^-(k + 1)/2."""
    made = cd.adapt(scenes.pressed((8, 4), degree=degree), accuracy)
    even = scenes.pressed((2 * n, n), degree=degree)
    equal = unknowns(even) * (true_error(cd.solve(even)) / true_error(made.solution)) ** (2 / (degree + 1))
    assert equal > fewer * unknowns(made.scene)


def test_a_node_where_contact_ends():
    """From degree 2 on both bodies have one within a fiftieth of a facet of the edge; the exact one is near it, too."""
    made = cd.adapt(scenes.pressed((8, 4), degree=3), 1e-4)
    edge = cd.reference.groove().contact_edge
    for each in made.scene.bodies:
        x, _ = nodes_and_cells(each.mesh)
        along = np.sort(x[np.abs(x[:, 1] - 1) < 1e-9, 0])
        assert np.abs(along - edge).min() < 0.02 * np.diff(along).min()


def test_unlike_pressure_is_in_equilibrium():
    """Action is reaction on the meshes of two unlike materials, which become unlike: the force is the load."""
    soft = cd.Isotropic(E=7e4, nu=0.33)
    low = scenes.block("low", 0, (8, 4), soft, loads=[cd.Pressure("bottom", 10.0)])
    high = scenes.block("high", 1, (8, 4), loads=[cd.Pressure("top", 10.0)])
    made = cd.adapt(scenes.stack([low, high]), 5e-3)
    assert made.reached
    assert made.scene.bodies[0].mesh.cells != made.scene.bodies[1].mesh.cells
    assert made.solution.contact().force == pytest.approx(10.0 * scenes.LENGTH, rel=1e-5)  # residuals stay below 5e-6


def test_an_accuracy_is_asked_of_adapt():
    with pytest.raises(TypeError, match=r"accuracy = 0.001: solve keeps .* expected cd\.adapt\(scene, accuracy\)"):
        cd.solve(scenes.pressed((8, 4)), accuracy=1e-3)
