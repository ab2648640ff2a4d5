"""Where rays enter rigid shapes: closed forms, and every shape as another shape describes it."""

from __future__ import annotations

import numpy as np
import pytest

import contactdd as cd

UP = np.array([0.0, 0.0, 1.0])


def rays(dim, seed=0):
    """Points below, and directions upwards, up to 25° aside."""
    rng = np.random.default_rng(seed)
    x = rng.uniform(-1.0, 1.0, (200, dim))
    x[:, -1] = rng.uniform(-1.5, -0.5, 200)
    direction = np.column_stack([rng.uniform(-0.3, 0.3, (200, dim - 1)), np.ones(200)])
    return x, direction / np.linalg.norm(direction, axis=1)[:, None]


def ends(shape, dim, seed=0):
    """Where the rays that meet a shape enter it."""
    x, direction = rays(dim, seed)
    found = shape.distance(x, direction)
    met = np.isfinite(found)
    assert met.sum() > 30
    return (x + np.where(met, found, 0.0)[:, None] * direction)[met]


@pytest.mark.parametrize("dim", [2, 3])
def test_rays_end_on_spheres(dim):
    centre = 2.0 * np.eye(dim)[-1]
    distances = np.linalg.norm(ends(cd.Sphere(centre, 2.0), dim) - centre, axis=1)
    assert distances == pytest.approx(2.0, rel=1e-13)
    assert np.all(ends(cd.Sphere(centre, 2.0), dim)[:, -1] < 2.0)  # the side that they come from
    hollow = ends(cd.Sphere(np.zeros(dim), 3.0, hollow=True), dim)
    assert np.linalg.norm(hollow, axis=1) == pytest.approx(3.0, rel=1e-13)
    assert np.all(hollow[:, -1] > -1.5)


def test_rays_end_on_cylinders_in_space():
    axis = np.array([1.0, 1.0, 0.0]) / np.sqrt(2)
    found = ends(cd.Cylinder((0, 0, 2), 2.0, axis=(1, 1, 0)), 3) - [0, 0, 2]
    assert np.linalg.norm(found - np.outer(found @ axis, axis), axis=1) == pytest.approx(2.0, rel=1e-13)


@pytest.mark.parametrize("dim", [2, 3])
def test_rays_end_on_cones(dim):
    found = ends(cd.Cone(np.zeros(dim), 1.2), dim)
    assert np.linalg.norm(found[:, :-1], axis=1) == pytest.approx(np.tan(1.2) * found[:, -1], abs=1e-11)
    # near the tip both roots are nearly one, and their rounding is that of a root of ε
    assert np.all(found[:, -1] >= 0.0)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_ray_through_the_tip_ends_there(dim):
    cone = cd.Cone(np.eye(dim)[-1], 1.0)
    assert cone.distance(np.zeros((1, dim)), np.eye(dim)[-1:]) == pytest.approx([1.0], abs=1e-15)


def test_planes_and_punches():
    plane = cd.Plane((0, 0, 1), (0.1, 0.2, -1))
    found = ends(plane, 3)
    assert np.abs((found - plane.centre) @ plane.normal).max() < 1e-14
    punch = cd.FlatPunch((0, 0, 1), 0.5)
    ended = ends(punch, 3)
    assert ended[:, 2] == pytest.approx(1.0)
    assert np.linalg.norm(ended[:, :2], axis=1).max() <= 0.5
    edge = np.array([[0.5, 0.0, 0.0], [0.5 + 1e-9, 0.0, 0.0]])
    assert punch.distance(edge, np.array([UP, UP])).tolist() == [1.0, np.inf]
    away = plane.distance(np.array([[0.0, 0.0, 0.0]]), -UP[None])
    assert away.tolist() == [np.inf]


SAME = {
    "sphere": (cd.Sphere((0, 0, 2), 2.0), lambda x: np.sum(x[:2] ** 2, axis=0) + (x[2] - 2) ** 2 - 4.0),
    "cone": (cd.Cone((0, 0, 0), 1.2), lambda x: np.hypot(x[0], x[1]) / np.tan(1.2) - x[2]),
    "plane": (cd.Plane((0, 0, 1), (0.1, 0.2, -1)), lambda x: 0.1 * x[0] + 0.2 * x[1] - (x[2] - 1)),
    "profile": (
        cd.Profile(lambda x, y: x**2 / 2 + y**2 / 3 + 0.1 * x, 3),
        lambda x: x[0] ** 2 / 2 + x[1] ** 2 / 3 + 0.1 * x[0] - x[2],
    ),
}


@pytest.mark.parametrize("name", SAME)
def test_level_sets_describe_the_same(name):
    shape, function = SAME[name]
    x, direction = rays(3, seed=1)
    expected = shape.distance(x, direction)
    found = cd.LevelSet(function, (0, 0, 0), reach=5.0).distance(x, direction)
    met = expected < 5.0
    assert met.sum() > 100
    # Bisection ends at the rounding of the function, which grows as √ε where a ray grazes the shape.
    assert found[met] == pytest.approx(expected[met], rel=1e-7, abs=1e-12)


@pytest.mark.parametrize(("axis", "body"), [(1, "above"), (1, "below"), (0, "above"), (0, "below")])
def test_profiles_on_all_sides(axis, body):
    """A parabola that opens up, down, to the right and to the left, seen straight and aslant: where the rays end."""
    sign = 1.0 if body == "above" else -1.0
    shape = cd.Profile(lambda s: sign * s**2 / 2, axis=axis, body=body)
    x = np.zeros((3, 2))
    x[:, axis], x[:, 1 - axis] = -sign, [-0.5, 0.1, 0.6]
    direction = np.zeros((3, 2))
    direction[:, axis], direction[:, 1 - axis] = sign, [0.0, 0.2, -0.3]
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    found = x + shape.distance(x, direction)[:, None] * direction
    assert found[:, axis] == pytest.approx(sign * found[:, 1 - axis] ** 2 / 2, abs=1e-14)
    assert np.all(np.isinf(shape.distance(x[:1], -direction[:1])))  # from behind there is nothing to enter


def test_measured_profiles():
    s = np.linspace(-1, 1, 41)
    shuffled = np.random.default_rng(0).permutation(np.column_stack([s, s**2]))
    x, up = np.column_stack([np.linspace(-0.9, 0.9, 7), np.zeros(7)]), np.tile([0.0, 1.0], (7, 1))
    step = 0.05
    for interpolation, bound in (("smooth", 0.3), ("linear", 1.0)):  # the line between errs by h²/8 · 2 = h²/4
        found = cd.Profile(shuffled, interpolation=interpolation).distance(x, up)
        assert np.abs(found - x[:, 0] ** 2).max() < bound * step**2 / 4 + 1e-15
    beyond = np.array([[1.5, 0.0]])
    assert cd.Profile(shuffled).distance(beyond, up[:1]).tolist() == [np.inf]
    grid = cd.Profile.on_grid(s, s[::2], s[:, None] ** 3 + s[None, ::2] ** 2 / 2)
    at = np.array([[0.33, -0.41, 0.0], [0.0, 2.0, 0.0]])
    # A cubic is its own spline.
    assert grid.distance(at, np.array([UP, UP])) == pytest.approx([0.33**3 + 0.41**2 / 2, np.inf], rel=1e-12)


def test_inside_is_negative():
    x, up = np.array([[0.0, 0.5]]), np.array([[0.0, 1.0]])
    for shape in (
        cd.Sphere((0, 1), 1.0),
        cd.Plane((0, 0), (0, -1)),
        cd.Cone((0, 0), 1.0),
        cd.FlatPunch((0, 0), 1.0),
        cd.Profile(lambda s: s**2),
        cd.LevelSet(lambda x: x[0] ** 2 + (x[1] - 1) ** 2 - 1, (0, 1), 2.0),
    ):
        assert shape.distance(x, up) == pytest.approx([-0.5], rel=1e-12)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: cd.Sphere((0, 0), -1), "radius = -1: expected a number > 0"),
        (lambda: cd.Sphere((0, 0, 0, 0), 1), "centre = .*: expected 2 or 3 finite numbers"),
        (lambda: cd.Plane((0, 0), (0, 0)), "normal = .*: expected 2 numbers, not all zero"),
        (lambda: cd.Plane((0, 0), (0, 0, 1)), "normal = .*: expected 2 numbers"),
        (lambda: cd.Cone((0, 0), 1.6), "half_angle = 1.6: expected radians above 0 and below π/2"),
        (lambda: cd.Cylinder((0, 0, 0), 1), "axis = None of a cylinder in 3 dimensions"),
        (lambda: cd.Profile([[0, 1]]), "height of shape .*: expected a function"),
        (lambda: cd.Profile([[0, 1], [0, 2]]), "each larger than the one before"),
        (lambda: cd.Profile(np.ones((3, 2)), 3), "see Profile.on_grid"),
        (lambda: cd.Profile(lambda s: s, body="left"), "body = 'left': expected one of 'above', 'below'"),
        (lambda: cd.Profile(lambda s: s, axis=2), "axis = 2: expected a coordinate from 0 to 1"),
        (lambda: cd.LevelSet(3, (0, 0), 1), "function = 3: expected a function"),
        (lambda: cd.LevelSet(lambda x: x[0], (0, 0), 0), "reach = 0: expected a number > 0"),
    ],
)
def test_what_is_refused(make, message):
    with pytest.raises((ValueError, TypeError), match=message):
        make()


# Facets


def sphere_of_facets(cells=24):
    """A ball of radius 1 about (0, 0, 2): a cube's six faces blown up, its triangles with their normals outwards."""
    s = np.linspace(-1, 1, cells + 1)
    a, b = np.meshgrid(s, s, indexing="ij")
    face = np.stack([a, b, np.ones_like(a)], axis=-1)
    quads = [face[:-1, :-1], face[1:, :-1], face[1:, 1:], face[:-1, 1:]]
    one = np.concatenate([np.stack([quads[0], quads[i], quads[i + 1]], axis=2).reshape(-1, 3, 3) for i in (1, 2)])
    faces = [np.roll(sign * one, shift, axis=2)[:, ::sign] for shift in range(3) for sign in (1, -1)]
    corners = np.concatenate(faces)
    return corners / np.linalg.norm(corners, axis=2, keepdims=True) + [0, 0, 2]


def test_facets_of_a_sphere():
    shape, exact = cd.FacetedSurface(sphere_of_facets()), cd.Sphere((0, 0, 2), 1.0)
    x, direction = rays(3)
    x[:, :2] *= 0.5
    found, expected = shape.distance(x, direction), exact.distance(x, direction)
    # h = 1/12 on the cube: facets lie h²/8 · a few inside of the sphere; no ray slips through between them.
    away = np.linalg.norm(np.cross(direction, x - [0, 0, 2]), axis=1)
    assert np.all(np.isfinite(found[away < 0.9]))
    assert found[away < 0.9] == pytest.approx(expected[away < 0.9], abs=8e-3)
    assert np.all(found[away < 0.9] >= expected[away < 0.9] - 1e-12)
    assert np.all(np.isinf(found[away > 1.0]))
    seam = np.array([[0.0, 0.0, 0.0], [shape.corners[0, 0, 0], shape.corners[0, 0, 1], 0.0]])
    assert np.all(np.isfinite(shape.distance(seam, np.array([UP, UP]))))  # through a common corner


@pytest.mark.parametrize("binary", [True, False])
def test_stl_files(binary, tmp_path):
    corners, file = sphere_of_facets(4), tmp_path / "ball.stl"
    if binary:
        record = np.zeros(len(corners), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("word", "<u2")])
        record["corners"] = corners
        file.write_bytes(b"solid but binary".ljust(80) + np.uint32(len(corners)).tobytes() + record.tobytes())
    else:
        loops = ("\n".join("vertex " + " ".join(f"{c:.9e}" for c in corner) for corner in facet) for facet in corners)
        body = "\n".join(f"facet normal 0 0 0\nouter loop\n{loop}\nendloop\nendfacet" for loop in loops)
        file.write_text(f"solid ball\n{body}\nendsolid ball\n")
    assert cd.FacetedSurface.from_stl(file).corners == pytest.approx(corners, abs=1e-6)  # single precision
    file.write_bytes(file.read_bytes()[:200])
    with pytest.raises(ValueError, match=r"path = .*: expected an STL file with triangles"):
        cd.FacetedSurface.from_stl(file)


@pytest.mark.parametrize("shape", ["triangle", "quadrilateral", "tetrahedron", "hexahedron"])
def test_facets_of_meshes(shape):
    """The bottom of a block above the points, and its top, which faces away."""
    flat = shape in ("triangle", "quadrilateral")
    mesh = (
        cd.rectangle((-2, 1), (2, 2), (3, 2), shape=shape)
        if flat
        else cd.box((-2, -2, 1), (2, 2, 2), (3, 3, 2), shape=shape)
    )
    x, direction = rays(2 if flat else 3)
    bottom = cd.FacetedSurface.from_mesh(mesh, "bottom").distance(x, direction)
    assert x[:, -1] + bottom * direction[:, -1] == pytest.approx(1.0, rel=1e-13)
    assert np.all(np.isinf(cd.FacetedSurface.from_mesh(mesh, "top").distance(x, direction)))


def test_facets_that_are_refused():
    with pytest.raises(ValueError, match=r"corners of shape \(1, 2, 3\)"):
        cd.FacetedSurface(np.zeros((1, 2, 3)))
    with pytest.raises(ValueError, match=r"corners\[1\] = .*: this facet has no area"):
        cd.FacetedSurface([[[0, 0], [1, 0]], [[2, 2], [2, 2]]])
