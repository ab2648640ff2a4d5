"""Points on facets: areas and normals by the divergence theorem, and what passes from the points to a body's own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import scipy

import contactdd as cd
from contactdd.base.facets import facet_points, facet_type
from contactdd.interface.discretise import discretise
from contactdd.interface.pairing import _nearest
from contactdd.interface.surface import ContactSurface, Gather
from contactdd.interface.trace import normal_trace
from contactdd.quadrature import find_quadrature

MESHES = Path(__file__).parents[1] / "meshes"
STEEL = cd.Isotropic(2.1e5, 0.3)
KINDS = ("triangle", "quadrilateral", "tetrahedron", "hexahedron")


def bent(shape: str) -> cd.Mesh:
    """A block in whose mesh no facet is along an axis, with its whole boundary as one surface."""
    if shape in ("triangle", "quadrilateral"):
        mesh = cd.rectangle((0, 0), (2, 1), (3, 2), shape=shape)
    else:
        mesh = cd.box((0, 0, 0), (2, 1, 1), (3, 2, 2), shape=shape)
    x = mesh.domain.geometry.x
    x[:, :2] += 0.05 * np.sin(3.0 * x[:, 1::-1] + x[:, 2:]) + 0.03 * x[:, :1] * x[:, 1:2]
    if mesh.dim == 3:
        x[:, 2] += 0.1 * x[:, 0] * x[:, 1]
    return mesh.with_surfaces(boundary=lambda x: np.full(x.shape[1], True))


@pytest.mark.parametrize("shape", KINDS)
def test_divergence_theorem(shape):
    """∮ n da = 0 and ∮ x n da = V on every cell shape, and the normals point outwards."""
    mesh = bent(shape)
    side = ContactSurface(cd.Body("body", mesh, STEEL), "boundary", find_quadrature("gauss", 1, 6))
    x, forces = side.points.x, side.points.normal * side.areas[:, None]
    assert np.linalg.norm(side.points.normal, axis=1) == pytest.approx(1.0, rel=1e-14)
    assert np.abs(forces.sum(axis=0)).max() < 1e-13
    moments = x.T @ forces
    volume = np.trace(moments) / mesh.dim
    assert 1.0 < volume < 3.0
    assert moments == pytest.approx(volume * np.eye(mesh.dim), abs=1e-13)


@pytest.mark.parametrize("shape", KINDS)
def test_corners_are_around_the_points(shape):
    """A facet's middle is the mean of its corners, which come in order: neighbours share an edge."""
    side = ContactSurface(cd.Body("body", bent(shape), STEEL), "boundary", find_quadrature("gauss", 1))
    assert side.corners.mean(axis=1) == pytest.approx(side.middles.x, abs=1e-14)
    edges = np.roll(side.corners, -1, axis=1) - side.corners
    assert np.abs(edges.sum(axis=1)).max() < 1e-14
    if side.corners.shape[1] == 4:  # opposite edges run against each other
        assert np.all(np.sum(edges[:, 0] * edges[:, 2], axis=1) < 0)


@pytest.mark.parametrize("shape", KINDS)
@pytest.mark.parametrize("degree", [1, 2])
def test_trace_of_a_linear_displacement(shape, degree):
    """u = F x is in every space: its normal displacement is n·F x at any point."""
    body = cd.Body("body", bent(shape), STEEL, degree=degree)
    side = ContactSurface(body, "boundary", find_quadrature("gauss", degree))
    gradient = np.arange(1.0, 1.0 + body.mesh.dim**2).reshape(body.mesh.dim, -1)
    u = (body.space.tabulate_dof_coordinates()[:, : body.mesh.dim] @ gradient.T).ravel()
    expected = np.sum((side.points.x @ gradient.T) * side.points.normal, axis=1)
    assert side.trace @ u == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("shape", [*KINDS, "curved"])
def test_a_surface_is_its_points(shape):
    """What is tabulated once for all facets agrees with the same points given one by one, on curved cells too."""
    mesh = cd.read_gmsh(MESHES / "groove.geo", order=2) if shape == "curved" else bent(shape)
    name = "top" if shape == "curved" else "boundary"
    side = ContactSurface(cd.Body("body", mesh, STEEL, degree=3), name, find_quadrature("gauss", 3))
    rule_points, _ = side.rule.points(facet_type(mesh.domain))
    entities = np.repeat(side.entities, len(rule_points), axis=0)
    points = facet_points(mesh.domain, entities, np.tile(rule_points, (len(side.entities), 1)))
    for part in ("cells", "reference", "x", "normal", "area"):
        assert getattr(side.points, part) == pytest.approx(getattr(points, part), abs=1e-14)
    assert abs(side.trace - normal_trace(side.body.space, points)).max() < 1e-14


def test_only_the_nodes_that_are_seen_count():
    """Along a flat surface the trace touches one component of the surface's own nodes."""
    body = cd.Body("body", cd.rectangle((0, 0), (3, 1), (3, 2), shape="quadrilateral"), STEEL, degree=3)
    side = ContactSurface(body, "top", find_quadrature("gauss", 3))
    dofs = np.unique(side.trace.indices)
    assert len(dofs) == 3 * 3 + 1
    assert np.all(dofs % 2 == 1)
    assert body.space.tabulate_dof_coordinates()[dofs // 2, 1] == pytest.approx(1.0)


@pytest.mark.parametrize("name", ["gauss", "vertex", "facet"])
def test_spread_and_average(name):
    """The mean of what is spread is what it was, in any order; as an operator it is a matrix of zeros and ones."""
    body = cd.Body("body", cd.box((0, 0, 0), (1, 1, 1), (2, 2, 2)), STEEL)
    side = ContactSurface(body, "top", find_quadrature(name, 1))
    values = np.random.default_rng(1).random(len(side.value_weights))
    order = np.random.default_rng(2).permutation(len(values))
    assert side.mean(side.spread() @ values) == pytest.approx(values)
    assert side.mean(side.spread(order) @ values) == pytest.approx(values[order])
    assert side.weights @ (side.spread() @ values) == pytest.approx(side.value_weights @ values)
    matrix = scipy.sparse.random(5, len(side.weights), 0.5, format="csr", random_state=3)
    spread = side.spread(order)
    assert isinstance(spread, Gather)
    assert (matrix @ spread) @ values == pytest.approx(matrix @ (spread @ values))


@pytest.mark.parametrize("count", [7, 150])
def test_nearest(count):
    """Few points by all distances, many by a tree: the distance is to the point named, and none is nearer."""
    points, others = np.random.default_rng(count).random((2, count, 3))
    distance, index = _nearest(points, others)
    every = np.linalg.norm(points[:, None] - others, axis=2)
    assert distance == pytest.approx(every.min(axis=1))
    assert distance == pytest.approx(every[np.arange(count), index])


@pytest.mark.parametrize("shape", ["triangle", "quadrilateral"])
def test_facets_that_match_do_so_at_other_points(shape):
    """A contact at other points, its facets known, is the one found anew; the meshes' facets are not in one order."""
    lower = cd.Body("lower", cd.rectangle((0, 0), (3, 1), (5, 2), shape=shape), STEEL)
    mesh = cd.rectangle((0, 1), (3, 2), (5, 2), shape=shape)
    mesh.domain.geometry.x[:, 0] = 3.0 - mesh.domain.geometry.x[:, 0]  # mirrored: its facets run the other way
    upper = cd.Body("upper", mesh, STEEL)
    contact = cd.Contact((lower, "top"), (upper, "bottom"), cd.LinearLayer(1e5), gap=lambda x: 1e-3 * x[0])
    known = discretise(contact, (0, 1)).facets
    assert not np.array_equal(known, np.arange(5))
    found, anew = (discretise(contact.resampled(9), (0, 1), facets) for facets in (known, None))
    assert np.array_equal(found.x, anew.x)
    for side, other in zip(found.sides, anew.sides, strict=True):
        assert abs(side.trace - other.trace).max() == 0.0
    u = upper.space.tabulate_dof_coordinates()[:, :2].copy()
    u[:, 1] = 0.1 * u[:, 0]
    assert found.sides[1].trace @ u.ravel() == pytest.approx(-0.1 * found.x[:, 0])
