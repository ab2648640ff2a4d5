"""Copies of a mesh, moved and mirrored: they are the mesh elsewhere, and a body on one is a body like any other."""

from __future__ import annotations

import basix
import numpy as np
import pytest
import ufl
from dolfinx import fem
from dolfinx import mesh as dmesh
from mpi4py import MPI

import contactdd as cd
from contactdd.base import compat
from contactdd.base.facets import facet_corners, facet_points
from contactdd.base.isometry import reflection, translation

SHAPES = ("triangle", "quadrilateral", "tetrahedron", "hexahedron")
STEEL = cd.Isotropic(2.1e5, 0.3)
#: By another order of its nodes a cell of each shape turns from a mirror image into the thing itself.
TURNED = {
    "triangle": [1, 0, 2],
    "quadrilateral": [1, 0, 3, 2],
    "tetrahedron": [1, 0, 2, 3],
    "hexahedron": [1, 0, 3, 2, 5, 4, 7, 6],
}


def block(shape: str) -> cd.Mesh:
    """A body with a flat top at height 1; its other sides are tilted."""
    if shape in ("triangle", "quadrilateral"):
        mesh = cd.rectangle((0, 0), (2, 1), (4, [0, 0.4, 1]), shape=shape)
    else:
        mesh = cd.box((0, 0, 0), (2, 1, 1), (3, 2, [0, 0.4, 1]), shape=shape)
    x = mesh.domain.geometry.x
    below = 1 - x[:, mesh.dim - 1]
    x[:, mesh.dim - 1] -= 0.15 * x[:, 0] * below
    x[:, 0] *= 1 + 0.2 * below
    return cd.Mesh(mesh.domain, mesh.surfaces)


def turned(mesh: cd.Mesh) -> cd.Mesh:
    """The same mesh made anew, its cells turned inside out."""
    x, shape = mesh.domain.geometry.x[:, : mesh.dim], mesh.domain.topology.cell_name()
    cells = compat.geometry_dofmap(mesh.domain)[:, TURNED[shape]].astype(np.int64)
    element = basix.ufl.element("Lagrange", shape, 1, shape=(mesh.dim,))
    domain = dmesh.create_mesh(MPI.COMM_SELF, cells, *mesh_arguments(np.array(x), element))
    corners = {name: facet_corners(mesh.domain, mesh.entities(name)).reshape(-1, mesh.dim) for name in mesh.surfaces}

    def among(points: np.ndarray):
        return lambda x: np.array([np.abs(points - p).max(axis=1).min() < 1e-12 for p in x[: mesh.dim].T])

    return cd.from_dolfinx(domain, **{name: among(points) for name, points in corners.items()})


def mesh_arguments(x: np.ndarray, element) -> tuple:
    """The nodes and the element in the order that dolfinx's create_mesh has them."""
    return (element, x) if compat.VERSION >= (0, 10) else (x, element)


def orientation(mesh: cd.Mesh) -> float:
    """The determinant of the first cell's map, in its first corner."""
    nodes = mesh.domain.geometry.x[compat.geometry_dofmap(mesh.domain)[0]][:, : mesh.dim]
    axes = [1, 2] if mesh.dim == 2 else [1, 2, 4 if len(nodes) == 8 else 3]
    return float(np.linalg.det(nodes[axes] - nodes[0]))


def volume(mesh: cd.Mesh) -> float:
    return fem.assemble_scalar(compat.form(fem.Constant(mesh.domain, 1.0) * ufl.dx(domain=mesh.domain)))


def copies(mesh: cd.Mesh) -> list[cd.Mesh]:
    """Copies of a mesh, of both orientations."""
    return [
        mesh.moved(np.arange(1, 1 + mesh.dim)),
        mesh.mirrored("x", -0.5),
        mesh.mirrored("y", 1.0).moved([0.3] * mesh.dim).mirrored("x", 2.0),
    ]


# ------------------------------------------------------------------------------------------------- what a copy is


@pytest.mark.parametrize("shape", SHAPES)
def test_a_copy_is_the_mesh_elsewhere(shape):
    mesh = block(shape)
    x, entities = mesh.domain.geometry.x[:, : mesh.dim], {name: mesh.entities(name) for name in mesh.surfaces}
    for copy in copies(mesh):
        isometry = copy.isometry_from(mesh)
        # The isometry is found from the coordinates, up to their rounding.
        assert np.abs(copy.domain.geometry.x[:, : mesh.dim] - isometry(x)).max() <= 2e-15 * 4
        assert copy.domain.topology._cpp_object is mesh.domain.topology._cpp_object
        assert set(copy.surfaces) == set(mesh.surfaces)
        for name, facets in mesh.surfaces.items():
            assert np.array_equal(copy.facets(name), facets)
            assert np.array_equal(copy.entities(name), entities[name])
        assert volume(copy) == pytest.approx(volume(mesh), rel=1e-13)
        assert copy.domain.ufl_domain() != mesh.domain.ufl_domain()
        assert np.sign(orientation(copy)) == np.sign(orientation(mesh)) * (-1 if np.prod(isometry.signs) < 0 else 1)
    assert np.array_equal(mesh.isometry_from(mesh)(x), x)


def test_the_coordinates_of_a_copy_are_its_own():
    mesh = cd.rectangle((0, 0), (2, 1), (2, 2))
    right = mesh.moved((2, 0))
    assert np.ptp(right.domain.geometry.x[:, 0]) == 2.0
    assert right.domain.geometry.x[:, 0].min() == 2.0
    right.domain.geometry.x[:, 1] *= 2
    assert mesh.domain.geometry.x[:, 1].max() == 1.0


def test_a_mesh_can_be_mirrored_along_every_axis():
    mesh = cd.box((0, 0, 0), (1, 2, 3), (2, 2, 2))
    for place, axis in enumerate("xyz"):
        x = mesh.mirrored(axis, 4.0).domain.geometry.x
        assert np.array_equal(x[:, place], 8 - mesh.domain.geometry.x[:, place])
        others = [other for other in range(3) if other != place]
        assert np.array_equal(x[:, others], mesh.domain.geometry.x[:, others])


def test_copies_of_copies_are_copies_of_the_first_mesh():
    mesh = cd.rectangle((0, 0), (2, 1), (2, 2))
    there = mesh.moved((3, 1)).mirrored("y", 0.5)
    isometry = there.isometry_from(mesh)
    assert isometry.signs.tolist() == [1, -1]
    assert isometry.offset.tolist() == [3, 0]
    back = there.mirrored("y", 0.5).moved((-3, -1))
    assert np.array_equal(back.domain.geometry.x, mesh.domain.geometry.x)


def test_a_copy_with_more_surfaces_has_copies_of_its_own():
    mesh = cd.rectangle((0, 0), (2, 1), (2, 2))
    copy = mesh.moved((0, 1)).with_surfaces(corner=lambda x: (x[1] > 1.9) & (x[0] < 1.1))
    assert copy.isometry_from(mesh) is None  # it has other surfaces
    assert copy.moved((1, 0)).isometry_from(copy) is not None
    assert len(copy.facets("corner")) == 1
    assert "corner" in copy.mirrored("x", 0).surfaces


def test_a_mesh_without_surfaces_has_copies_too():
    domain = dmesh.create_unit_square(MPI.COMM_SELF, 2, 2)
    assert cd.from_dolfinx(domain).moved((1, 0)).with_surfaces(all=lambda x: x[0] > -1).facets("all").size == 8


@pytest.mark.parametrize("side", [0, 1])
def test_a_copy_whose_coordinates_were_changed_is_none(side):
    mesh = cd.rectangle((0, 0), (2, 1), (2, 2))
    copy = mesh.moved((0, 1))
    (mesh, copy)[side].domain.geometry.x[0, 0] -= 0.1
    assert copy.isometry_from(mesh) is None
    again = copy.moved((1, 0))
    assert again.isometry_from(copy) is not None
    assert np.array_equal(again.domain.geometry.x[:, 0], copy.domain.geometry.x[:, 0] + 1)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("degree", [1, 2, 3])
def test_spaces_on_copies_are_numbered_alike(shape, degree):
    mesh = block(shape)
    first = cd.Body("first", mesh, STEEL, degree=degree).space
    for copy in copies(mesh):
        space = cd.Body("copy", copy, STEEL, degree=degree).space
        assert np.array_equal(space.dofmap.list, first.dofmap.list)
        there = copy.isometry_from(mesh)(first.tabulate_dof_coordinates()[:, : mesh.dim])
        assert np.allclose(space.tabulate_dof_coordinates()[:, : mesh.dim], there, rtol=0, atol=1e-13)


def test_isometries_are_applied_one_after_the_other():
    x = np.random.default_rng(0).normal(size=(5, 3))
    first, then = reflection(3, 1, 0.7), translation(np.array([1.0, -2.0, 0.5]))
    assert np.allclose(then.after(first)(x), then(first(x)), rtol=0, atol=1e-15)
    assert np.allclose(first.after(then)(x), first(then(x)), rtol=0, atol=1e-15)
    assert np.prod(first.signs) < 0
    assert np.prod(first.after(first).signs) > 0
    assert np.all(first.after(first.inverse)(np.eye(3)) == np.eye(3))


@pytest.mark.parametrize(
    ("wrong", "error", "message"),
    [
        (lambda mesh: mesh.mirrored("z", 1.0), ValueError, r"axis = 'z': expected one of 'x', 'y'"),
        (lambda mesh: mesh.mirrored(1, 1.0), ValueError, r"axis = 1: expected one of 'x', 'y'"),
        (lambda mesh: mesh.mirrored("x", np.inf), ValueError, r"at = inf: expected a finite number"),
        (lambda mesh: mesh.mirrored("x", "left"), TypeError, r"at = 'left': expected a number"),
        (lambda mesh: mesh.mirrored("x", 1e16), ValueError, r"at = 1e\+16: so far .* loses the digits"),
        (lambda mesh: mesh.moved((1, 2, 3)), ValueError, r"offset = \(1, 2, 3\): expected 2 finite numbers"),
        (lambda mesh: mesh.moved(1.0), ValueError, r"offset = 1\.0: expected 2 finite numbers"),
        (lambda mesh: mesh.moved((0, np.nan)), ValueError, r"offset = \(0, nan\): expected 2 finite numbers"),
        (lambda mesh: mesh.moved((0, 1e16)), ValueError, r"offset = \(0, 1e\+16.* loses the digits of its shape"),
    ],
)
def test_what_is_no_isometry_is_refused(wrong, error, message):
    with pytest.raises(error, match=message):
        wrong(cd.rectangle((0, 0), (2, 1), (2, 2)))


# ------------------------------------------------------------------------------------ mirror images are meshes too


@pytest.mark.parametrize("shape", SHAPES)
def test_normals_point_outwards(shape):
    mesh = block(shape)
    for copy in [mesh, *copies(mesh)]:
        body, x = cd.Body("body", copy, STEEL), ufl.SpatialCoordinate(copy.domain)
        n = ufl.FacetNormal(copy.domain)
        # The divergence of x is the dimension: a normal that points inwards would show.
        around = sum(
            fem.assemble_scalar(compat.form(body.elements.over_surface(ufl.dot(x, n), s))) for s in copy.surfaces
        )
        assert around == pytest.approx(copy.dim * volume(copy), rel=1e-12)
        middle = copy.domain.geometry.x[:, : copy.dim].mean(axis=0)
        for name in copy.surfaces:
            entities = copy.entities(name)
            at = facet_points(copy.domain, entities, np.full((len(entities), copy.dim - 1), 0.3))
            assert np.all(np.sum((at.x - middle) * at.normal, axis=1) > 0)
            assert np.allclose(np.linalg.norm(at.normal, axis=1), 1, rtol=1e-14)


def solved(lower: cd.Mesh, upper: cd.Mesh, degree: int, **bodies) -> cd.Solution:
    """Two bodies between rigid walls without friction, pressed together; both have their tops at the contact."""
    sides = [name for name in lower.surfaces if name not in ("top", "bottom")]
    a, b = (
        cd.Body(name, mesh, STEEL, supports=[cd.Symmetry(*sides)], loads=[cd.Pressure("bottom", 10)], degree=degree)
        for name, mesh in (("a", lower), ("b", upper))
    )
    contact = cd.Contact((a, "top"), (b, "top"), cd.PowerLayer(B=4e-6, a=0.7), gap=lambda x: 2e-5 * (x[0] - 1) ** 2)
    return cd.solve(cd.Scene([a, b], [contact]), "newton", tolerance=1e-13)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("degree", [1, 2, 3])
def test_a_scene_with_a_mirror_image(shape, degree):
    lower = block(shape)
    upper = lower.mirrored("y" if lower.dim == 2 else "z", 1.0)
    assert orientation(upper) * orientation(turned(upper)) < 0
    mirrored, expected = solved(lower, upper, degree), solved(lower, turned(upper), degree)
    pressure = expected.contact().pressure
    assert np.ptp(pressure) > 0.1 * pressure.max()
    assert np.allclose(mirrored.contact().pressure, pressure, rtol=0, atol=1e-10 * pressure.max())
    # The scene is its own mirror image, and so are the displacements.
    down, up = (mirrored.displacement(name).x.array.reshape(-1, lower.dim) for name in ("a", "b"))
    image = down * upper.isometry_from(lower).signs
    assert np.allclose(up, image, rtol=0, atol=1e-9 * np.abs(image).max())


@pytest.mark.parametrize("shape", ["triangle", "quadrilateral"])
def test_a_rectangle_and_its_mirror_image_are_two_rectangles(shape):
    lines = ([0, 0.5, 1.2, 2], [0, 0.6, 1])
    lower = cd.rectangle((0, 0), (2, 1), lines, shape=shape)
    upper = cd.rectangle((0, 1), (2, 2), (lines[0], [1, 1.4, 2]), shape=shape, diagonal="left")
    upper = cd.Mesh(upper.domain, {**upper.surfaces, "top": upper.facets("bottom"), "bottom": upper.facets("top")})
    for degree in (1, 2, 3):
        pressure = solved(lower, upper, degree).contact().pressure
        mirrored = solved(lower, lower.mirrored("y", 1.0), degree).contact().pressure
        assert np.allclose(mirrored, pressure, rtol=0, atol=1e-10 * pressure.max())
