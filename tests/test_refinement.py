"""Finer meshes keep their surfaces, their shape and their bodies; solutions are carried over to them."""

from __future__ import annotations

import numpy as np
import pytest
import scenes
from dolfinx import mesh as dmesh
from mpi4py import MPI

import contactdd as cd
from contactdd.base import compat
from contactdd.base.facets import facet_points

RECTANGLE = cd.rectangle((0, 0), (2, 1), (6, 4))
BOX = cd.box((0, 0, 0), (2, 1, 1), (3, 2, 2))


def areas(mesh, **options):
    body = cd.Body("b", mesh, scenes.STEEL, **options)
    return {name: body.area(name) for name in mesh.surfaces}


def volumes(mesh):
    x = mesh.domain.geometry.x[compat.geometry_dofmap(mesh.domain)][:, : mesh.dim + 1, : mesh.dim]
    return np.abs(np.linalg.det(x[:, 1:] - x[:, :1])) / (2 if mesh.dim == 2 else 6)


@pytest.mark.parametrize("mesh", [RECTANGLE, BOX], ids=["triangles", "tetrahedra"])
@pytest.mark.parametrize("cells", [None, [0, 3, 5]], ids=["all", "some"])
def test_surfaces_and_volume_stay(mesh, cells):
    fine = mesh
    for _ in range(2):
        fine = fine.refined(cells)
        # The constructor refuses hanging nodes, inverted cells and facets inside the body.
        cd.Mesh(fine.domain, fine.surfaces)
        assert areas(fine) == pytest.approx(areas(mesh), rel=1e-12)
        assert volumes(fine).sum() == pytest.approx(volumes(mesh).sum(), rel=1e-12)
        middle = np.full((len(fine.entities("left")), mesh.dim - 1), 0.3)
        assert np.abs(facet_points(fine.domain, fine.entities("left"), middle).x[:, 0]).max() < 1e-14
        assert np.array_equal(np.sort(fine.facets("top")), fine.facets("top"))


def test_where_cells_lie():
    """Children lie in their parents, and none is as large as a parent that was chosen."""
    fine = RECTANGLE.refined(np.arange(RECTANGLE.cells) % 7 == 0)
    coarse, made = fine.refined_from
    assert coarse is RECTANGLE
    x = coarse.domain.geometry.x[compat.geometry_dofmap(coarse.domain)][made.parents, :, :2]
    corners = x[:, :1] + np.einsum("npk,nkd->npd", made.corners, x[:, 1:] - x[:, :1])
    ours = fine.domain.geometry.x[compat.geometry_dofmap(fine.domain)][:, :, :2]
    assert np.abs(corners - ours).max() < 1e-14
    chosen = np.isin(made.parents, np.flatnonzero(np.arange(RECTANGLE.cells) % 7 == 0))
    assert volumes(fine)[chosen].max() < 0.26 * volumes(RECTANGLE).max()


def curved(degree=2):
    """A quarter of a ring of second order between the radii 1 and 2: exact arcs are no polynomials."""
    straight = cd.rectangle((0, 0), (1, np.pi / 2), (2, 4))
    space_element = compat.coordinate_element("triangle", degree)
    from dolfinx import fem

    space = fem.functionspace(straight.domain, space_element)
    x = space.tabulate_dof_coordinates()
    r, angle = 1 + x[:, 0], x[:, 1]
    nodes = np.column_stack([r * np.cos(angle), r * np.sin(angle)])
    domain = compat.from_arrays(space.dofmap.list.astype(np.int64), nodes, space_element)

    def inside(x):
        return np.hypot(x[0], x[1]) < 1.01

    return cd.from_dolfinx(domain, inner=inside, outer=lambda x: np.hypot(x[0], x[1]) > 1.98)


def test_curved_cells_keep_their_curves():
    mesh = curved()
    fine = mesh.refined([0, 1, 2]).refined()
    cd.Mesh(fine.domain, fine.surfaces)
    assert compat.coordinate_map(fine.domain).degree == 2
    assert areas(fine) == pytest.approx(areas(mesh), rel=1e-6)  # the same curve; its length by more Gauss points
    assert areas(fine)["outer"] == pytest.approx(np.pi, rel=1e-4)
    middle = np.full((len(fine.entities("outer")), 1), 0.3)
    radius = np.linalg.norm(facet_points(fine.domain, fine.entities("outer"), middle).x, axis=1)
    assert np.abs(radius - 2).max() < 1e-3  # of straight facets it would be 1e-2


@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("mesh", [RECTANGLE, BOX, curved()], ids=["triangles", "tetrahedra", "curved"])
def test_a_polynomial_is_carried_over_exactly(mesh, degree):
    """On straight cells a displacement of the elements' own degree; on curved ones the coordinates themselves."""
    from dolfinx import fem

    power = degree if compat.coordinate_map(mesh.domain).degree == 1 else 1
    if power == 1 and degree == 1 and compat.coordinate_map(mesh.domain).degree == 2:
        pytest.skip("linear functions are none of linear elements on curved cells")
    coarse = cd.Body("b", mesh, scenes.STEEL, degree=degree)
    fine = coarse.on(mesh.refined([1, 2])).with_degree(degree + 1)

    def field(x):
        return np.stack([(x[0] - 0.3 * x[i]) ** power + i for i in range(mesh.dim)])

    u = fem.Function(coarse.space)
    u.interpolate(field)
    carried = fine.elements.interpolated(u, coarse.elements).reshape(-1, mesh.dim)
    x = fine.space.tabulate_dof_coordinates()
    assert np.abs(carried - field(x.T).T).max() < 1e-12


def test_a_finer_scene_starts_where_the_coarser_one_ended():
    coarse = scenes.pressed((16, 8))
    first = cd.solve(coarse)
    fine = coarse.refined({"lower": None, "upper": np.arange(10)})
    cold, warm = cd.solve(fine), cd.solve(fine, start=first)
    assert warm.iterations <= cold.iterations
    assert warm.energy == pytest.approx(cold.energy, rel=1e-11)
    assert first.energy > warm.energy  # the finer spaces contain the coarser ones, the gap is the same function
    assert cd.solve(coarse.refined()).contact().force == pytest.approx(first.contact().force, rel=1e-9)


def test_refusals():
    with pytest.raises(ValueError, match="quadrilaterals, which cannot be refined"):
        cd.rectangle((0, 0), (1, 1), (2, 2), shape="quadrilateral").refined()
    for cells in ([], [48], [-1], [0.5], [True]):
        with pytest.raises(ValueError, match="expected indices from 0 to 47, or truth values of 48 cells"):
            RECTANGLE.refined(cells)
    scene = scenes.pressed((4, 2))
    with pytest.raises(ValueError, match="body = 'middle'"):
        scene.refined({"middle": None})
    import ufl

    x = ufl.SpatialCoordinate(RECTANGLE.domain)
    body = cd.Body("b", RECTANGLE, scenes.STEEL, loads=[cd.Pressure("top", x[0])])
    with pytest.raises(ValueError, match="its Pressure is a UFL expression"):
        body.on(RECTANGLE.refined())
    assert body.on(RECTANGLE).loads == body.loads


def test_meshes_made_with_dolfinx():
    domain = dmesh.create_unit_square(MPI.COMM_SELF, 3, 3, dmesh.CellType.triangle)
    mesh = cd.from_dolfinx(domain, lid=lambda x: x[1] > 1 - 1e-9)
    assert areas(mesh.refined([2]).refined([0]))["lid"] == pytest.approx(1.0, rel=1e-13)
