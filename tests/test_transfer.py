"""Contact between meshes that do not match, tested by physics: patch tests, balance, symmetry, known answers, rates."""

from __future__ import annotations

from pathlib import Path

import basix.ufl
import numpy as np
import pytest
import ufl
from dolfinx import mesh as dmesh
from mpi4py import MPI
from scenes import LAYER, LOAD, STEEL, groove
from scipy.interpolate import CubicSpline

import contactdd as cd
from contactdd.interface.detection import facing_pairs
from contactdd.interface.overlap import common_normals, segments

BRASS = cd.Isotropic(1.0e5, 0.35)
# A pressure comes from a gap of 1e-5 between displacements of 1e-4 that a direct solver knows to 1e-15: 1e-10 has room.
ROUNDING = 1e-10


def pressed(lower: cd.Mesh, upper: cd.Mesh, degree: int = 1, **options) -> cd.Scene:
    """Two blocks pressed together by a uniform pressure, held from the sides: the exact stress is uniform."""
    sides = cd.Symmetry("left", "right", *(["front", "back"] if lower.dim == 3 else []))
    a = cd.Body("a", lower, STEEL, supports=[sides], loads=[cd.Pressure("bottom", LOAD)], degree=degree)
    b = cd.Body("b", upper, BRASS, supports=[sides], loads=[cd.Pressure("top", LOAD)], degree=degree)
    return cd.Scene([a, b], [cd.Contact((a, "top"), (b, "bottom"), LAYER, **options)])


def newton(scene: cd.Scene, tolerance: float = 1e-12) -> cd.Solution:
    """The solution to rounding; a run that cannot come that far is judged by the test's own numbers."""
    return cd.solve(scene, "newton", gamma="search", tolerance=tolerance, max_iterations=60, on_failure="return")


@pytest.mark.parametrize("quadrature", ["facet", "gauss"])
@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("shapes", [("triangle", "triangle"), ("quadrilateral", "triangle"), ("quadrilateral",) * 2])
def test_patch_in_the_plane(shapes, degree, quadrature):
    lower = cd.rectangle((0, 0), (4, 1), (7, 3), shape=shapes[0])
    upper = cd.rectangle((0, 1), (4, 2), (11, 2), shape=shapes[1])
    check_patch(pressed(lower, upper, degree, quadrature=quadrature), area=4.0)


@pytest.mark.parametrize("quadrature", ["facet", "gauss"])
@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize(
    "shapes", [("tetrahedron", "tetrahedron"), ("hexahedron", "hexahedron"), ("tetrahedron", "hexahedron")]
)
def test_patch_in_space(shapes, degree, quadrature):
    lower = cd.box((0, 0, 0), (1, 1.3, 0.5), (3, 4, 1), shape=shapes[0])
    upper = cd.box((0, 0, 0.5), (1, 1.3, 1), (5, 3, 1), shape=shapes[1])
    check_patch(pressed(lower, upper, degree, quadrature=quadrature), area=1.3)


@pytest.mark.parametrize("quadrature", ["facet", "gauss"])
def test_patch_of_revolution(quadrature):
    """Two cylinders under a uniform pressure: every integral is over the full ring."""
    lower = cd.Body(
        "a",
        cd.rectangle((0, 0), (2, 1), (7, 3)),
        STEEL,
        supports=[cd.Symmetry("left", "bottom")],
        kinematics="axisymmetric",
    )
    upper = cd.Body(
        "b",
        cd.rectangle((0, 1), (1.9, 2), (11, 3)),
        BRASS,
        supports=[cd.Symmetry("left")],
        loads=[cd.Pressure("top", LOAD)],
        kinematics="axisymmetric",
    )
    whole = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), LAYER, quadrature=quadrature)])
    result = newton(whole).contact()
    assert result.weights.sum() == pytest.approx(np.pi * 1.9**2, rel=1e-13)
    assert result.force == pytest.approx(LOAD * np.pi * 1.9**2, rel=ROUNDING)
    assert result.unpaired_area == pytest.approx((np.pi * (4 - 1.9**2), 0.0), rel=1e-12)
    fitting = cd.Body(
        "c",
        cd.rectangle((0, 1), (2, 2), (11, 3)),
        BRASS,
        supports=[cd.Symmetry("left")],
        loads=[cd.Pressure("top", LOAD)],
        kinematics="axisymmetric",
    )
    patch = cd.Scene([lower, fitting], [cd.Contact((lower, "top"), (fitting, "bottom"), LAYER, quadrature=quadrature)])
    assert np.abs(newton(patch).contact().pressure / LOAD - 1).max() < ROUNDING


def check_patch(scene: cd.Scene, area: float) -> None:
    solution = newton(scene)
    result = solution.contact()
    assert np.abs(result.pressure / LOAD - 1).max() < ROUNDING
    assert result.weights.sum() == pytest.approx(area, rel=1e-13)
    assert result.unpaired_area == (0.0, 0.0)
    forces = [solution.forces(body)["contact"] for body in scene.bodies]
    assert np.abs(forces[0] + forces[1]).max() < ROUNDING * LOAD * area
    assert np.abs(forces[0]).max() == pytest.approx(LOAD * area, rel=ROUNDING)


def test_decomposed_steps_reach_the_coupled_solution():
    scene = pressed(cd.rectangle((0, 0), (4, 1), (7, 3)), cd.rectangle((0, 1), (4, 2), (11, 2)), gap=groove)
    coupled = newton(scene).contact()
    for local_solver in ("condensed", "assembled"):
        parted = cd.solve(scene, "chord", gamma=0.6, tolerance=1e-9, local_solver=local_solver).contact()
        # The residual of 1e-9 is divided by the softest mode's stiffness, a few hundred times below the stiffest.
        assert np.abs(parted.pressure - coupled.pressure).max() < 1e-6 * LOAD


# ------------------------------------------------------------------------------------- what a pairing has to do


@pytest.mark.parametrize("quadrature", ["facet", "gauss"])
@pytest.mark.parametrize("dim", [2, 3])
def test_segments_of_matching_meshes_are_their_facets(dim, quadrature, monkeypatch):
    """Forced onto segments, meshes that match give the points and weights that they have without."""
    if dim == 2:
        meshes = cd.rectangle((0, 0), (4, 1), (5, 2)), cd.rectangle((0, 1), (4, 2), (5, 3), diagonal="left")
    else:
        meshes = cd.box((0, 0, 0), (1, 1, 1), (3, 2, 1)), cd.box((0, 0, 1), (1, 1, 2), (3, 2, 2))
    matching = pressed(*meshes, quadrature=quadrature, gap=groove)
    cut = pressed(*meshes, quadrature=quadrature, gap=groove)
    expected = newton(matching).contact()
    monkeypatch.setattr("contactdd.interface.discretise.matching", lambda *_: None)
    found = newton(cut).contact()
    places = nearest(expected.x, found.x)
    assert len(found.x) == len(expected.x)
    assert np.abs(found.x[places] - expected.x).max() < 1e-14
    assert found.weights[places] == pytest.approx(expected.weights, rel=1e-13)
    # The same problem with its sums in another order.
    assert np.abs(found.pressure[places] - expected.pressure).max() < ROUNDING * LOAD


def nearest(x: np.ndarray, points: np.ndarray) -> np.ndarray:
    """The place among `points` of each of x."""
    return np.argmin(np.linalg.norm(x[:, None] - points[None], axis=2), axis=1)


def test_overlap_of_turned_squares_is_an_octagon():
    square = np.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]])
    turn = np.array([[1, -1, 0], [1, 1, 0], [0, 0, np.sqrt(2)]]) / np.sqrt(2)
    turned = (square @ turn.T + [0, 0, 0.1])[::-1]
    points, weights = np.array([[1 / 3, 1 / 3]]), np.array([0.5])
    found = segments(square[None], turned[None], np.array([[0.0, 0, 1]]), points, weights)
    assert found.weight.sum() == pytest.approx(2 * (np.sqrt(2) - 1), rel=1e-14)
    assert found.weight @ found.line[:, :2] == pytest.approx(np.zeros(2), abs=1e-15)


@pytest.mark.parametrize("dim", [2, 3])
def test_search_leaves_no_overlap_out(dim):
    """Against the comparison of all pairs, on curved surfaces with facets of very unlike sizes and a wide gap."""
    lower, upper = wavy(dim, 9, 0.0, up=True), wavy(dim, 13, 0.4, up=False)
    normals = [facet_normals(lower, 1.0), facet_normals(upper, -1.0)]
    i, j = (k.ravel() for k in np.indices((len(lower), len(upper))))
    facing = np.sum(normals[0][i] * normals[1][j], axis=1) < -0.5
    i, j = i[facing], j[facing]
    rule = (np.full((1, dim - 1), 1 / 3), np.ones(1))  # any
    every = segments(lower[i], upper[j], common_normals(normals[0][i], normals[1][j]), *rule)
    expected = {(int(i[k]), int(j[k])) for k in every.pair}
    found = set(zip(*(map(int, k) for k in facing_pairs(lower, normals[0], upper, normals[1], 10.0)), strict=True))
    assert len(expected) > len(lower)
    assert expected <= found
    assert len(found) < 0.6 * len(i)  # else it would be no search


def wavy(dim: int, cells: int, height: float, up: bool) -> np.ndarray:
    """The facets of a wavy, graded surface, (n, corners, dim)."""
    t = np.linspace(0, 1, cells + 1) ** 2
    if dim == 2:
        x = np.column_stack([t, height + 0.2 * np.sin(5 * t)])
        return np.stack([x[:-1], x[1:]], axis=1)
    x, y = np.meshgrid(t, t, indexing="ij")
    p = np.stack([x, y, height + 0.2 * np.sin(5 * x) * np.cos(2 * y)], axis=2)
    a, b, c, d = (q.reshape(-1, 3) for q in (p[:-1, :-1], p[1:, :-1], p[1:, 1:], p[:-1, 1:]))
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def facet_normals(facets: np.ndarray, sign: float) -> np.ndarray:
    edge = facets[:, 1] - facets[:, 0]
    if facets.shape[2] == 2:
        normal = np.column_stack([-edge[:, 1], edge[:, 0]])
    else:
        normal = np.cross(edge, facets[:, 2] - facets[:, 0])
    return sign * normal / np.linalg.norm(normal, axis=1, keepdims=True)


# --------------------------------------------------------------------------------------------- partial overlap


def test_partly_overlapping_blocks_agree_with_the_same_contact_named_exactly():
    lower = cd.rectangle((0, 0), (4, 1), (16, 4)).with_surfaces(
        covered=lambda x: (x[1] > 1 - 1e-9) & (x[0] < 2.5 + 1e-9)
    )
    upper = cd.rectangle((0, 1), (2.5, 2), (10, 5))
    results = []
    for surface in ("top", "covered"):
        a = cd.Body("a", lower, STEEL, supports=[cd.Symmetry("left", "bottom")])
        b = cd.Body("b", upper, BRASS, supports=[cd.Symmetry("left")], loads=[cd.Pressure("top", LOAD)])
        scene = cd.Scene([a, b], [cd.Contact((a, surface), (b, "bottom"), LAYER)])
        results.append(newton(scene).contact())
    whole, exact = results
    assert whole.unpaired_area == pytest.approx((1.5, 0.0), rel=1e-13)
    assert exact.unpaired_area == (0.0, 0.0)
    assert whole.weights.sum() == pytest.approx(2.5, rel=1e-13)
    assert whole.force == pytest.approx(2.5 * LOAD, rel=ROUNDING)
    assert np.abs(whole.pressure[nearest(exact.x, whole.x)] - exact.pressure).max() < ROUNDING * LOAD


def test_facets_cut_by_an_edge_count_in_part():
    """The upper block ends in the middle of the lower one's facets, in space."""
    a = cd.Body("a", cd.box((0, 0, 0), (2, 2, 1), (3, 3, 1)), STEEL, supports=[cd.Fixed("bottom")])
    b = cd.Body("b", cd.box((0.3, 0.2, 1), (1.7, 1.5, 2), (2, 3, 1)), BRASS, loads=[cd.Pressure("top", LOAD)])
    scene = cd.Scene([a, b], [cd.Contact((a, "top"), (b, "bottom"), LAYER)])
    area = 1.4 * 1.3
    for solution in (newton(scene), cd.solve(scene, "chord", gamma=0.6, tolerance=1e-9)):
        result = solution.contact()
        assert result.weights.sum() == pytest.approx(area, rel=1e-13)
        assert result.unpaired_area == pytest.approx((4 - area, 0.0), rel=1e-12)
        assert result.force == pytest.approx(LOAD * area, rel=1e-7)  # of the decomposed run's residual, 1e-9


# ------------------------------------------------------------------------------------- symmetry and invariance


def bent(x: np.ndarray) -> np.ndarray:
    """A smooth map that bends a flat interface."""
    y = x.copy()
    y[:, -1] += 0.15 * np.cos(2.0 * x[:, 0])
    return y


def moved(mesh: cd.Mesh, map_points) -> cd.Mesh:
    """The same mesh with its nodes elsewhere."""
    dim = mesh.dim
    mesh.domain.geometry.x[:, :dim] = map_points(mesh.domain.geometry.x[:, :dim])
    return cd.Mesh(mesh.domain, mesh.surfaces)


def bent_scene(dim: int, quadrature: str = "gauss", swapped: bool = False) -> cd.Scene:
    """Two bent blocks with a wide gap; the lower is fixed, the upper pushed onto it."""
    if dim == 2:
        meshes = cd.rectangle((0, 0), (2, 1), (7, 3)), cd.rectangle((0, 1.05), (2, 2), (11, 3))
    else:
        meshes = cd.box((0, 0, 0), (2, 1, 1), (4, 2, 1)), cd.box((0, 0, 1.05), (2, 1, 2), (5, 3, 1), shape="hexahedron")
    lower, upper = (moved(mesh, bent) for mesh in meshes)
    a = cd.Body("a", lower, STEEL, supports=[cd.Fixed("bottom")])
    b = cd.Body("b", upper, BRASS, supports=[cd.Displacement("top", [0.0] * (dim - 1) + [-0.06])])
    sides = [(a, "top"), (b, "bottom")]
    layer = cd.LinearLayer(stiffness=1e5)
    return cd.Scene([a, b], [cd.Contact(*(sides[::-1] if swapped else sides), layer, quadrature=quadrature)])


@pytest.mark.parametrize("quadrature", ["facet", "gauss"])
@pytest.mark.parametrize("dim", [2, 3])
def test_exchanging_the_bodies_changes_nothing(dim, quadrature):
    scenes = [bent_scene(dim, quadrature, swapped) for swapped in (False, True)]
    here, there = (newton(scene).contact() for scene in scenes)
    # Seen from the other body x is the partner, so that points are told apart by both together.
    partners = here.x + scenes[0].interfaces[0].gap[:, None] * here.normal
    places = nearest(partners, there.x)
    assert len(np.unique(places)) == len(places) == len(there.x)
    # Points differ by rounding, times the slopes of curved facets where Newton's iteration ended. A mean gap along the
    # mean normal leads to the mean point but for how the normals turn within a segment.
    assert np.abs(partners - there.x[places]).max() < (1e-10 if quadrature == "gauss" else 1e-3)
    assert np.abs(here.normal + there.normal[places]).max() < 1e-10
    assert np.abs(here.weights - there.weights[places]).max() < 1e-10 * here.weights.max()
    assert np.abs(here.pressure - there.pressure[places]).max() < 1e-8 * here.pressure.max()


@pytest.mark.parametrize("quadrature", ["facet", "gauss"])
@pytest.mark.parametrize("dim", [2, 3])
def test_forces_and_moments_balance_on_bent_surfaces(dim, quadrature):
    """The contact forces on both bodies cancel, and so do their moments, although the surfaces are far apart."""
    scene = bent_scene(dim, quadrature)
    solution = newton(scene)
    interface, result = scene.interfaces[0], solution.contact()
    total, moment, size = np.zeros(dim), np.zeros((dim, dim)), 0.0
    for side in interface.sides:
        body = scene.bodies[side.body]
        forces = (side.trace.T @ (interface.weights * result.pressure)).reshape(-1, dim)
        x = body.space.tabulate_dof_coordinates()[:, :dim]
        total += forces.sum(axis=0)
        moment += forces.T @ x - x.T @ forces
        size += np.abs(forces).sum()
    assert size > 1.0
    assert np.abs(total).max() < 1e-13 * size
    assert np.abs(moment).max() < 1e-12 * size


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_turned_scene_has_the_same_solution(mirrored):
    rotation = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    rotation *= np.linalg.det(rotation) * (-1 if mirrored else 1)

    def turned(x: np.ndarray) -> np.ndarray:
        return x @ rotation.T + [3.0, -1.0, 2.0]

    def solve(place) -> cd.ContactResult:
        lower = moved(cd.box((0, 0, 0), (1, 1.3, 0.5), (3, 4, 1)), place)
        upper = moved(cd.box((0, 0, 0.5), (1, 0.9, 1), (4, 3, 1), shape="hexahedron"), place)
        a = cd.Body("a", lower, STEEL, supports=[cd.Symmetry("left", "front", "bottom")])
        b = cd.Body("b", upper, BRASS, supports=[cd.Symmetry("left", "front")], loads=[cd.Pressure("top", LOAD)])
        return newton(cd.Scene([a, b], [cd.Contact((a, "top"), (b, "bottom"), LAYER)])).contact()

    straight, tilted = solve(lambda x: x), solve(turned)
    places = nearest(turned(straight.x), tilted.x)
    # The cut of an overlap into triangles depends on nothing but its shape.
    assert np.abs(turned(straight.x) - tilted.x[places]).max() < 1e-12
    assert np.abs(straight.pressure - tilted.pressure[places]).max() < 1e-9 * LOAD


# ------------------------------------------------------------------------------------------------ known answers


@pytest.mark.parametrize("n", [2, 3, 8, 64])
def test_column_stack(n):
    """ν = 0, ends brought together: a scalar equation. Gaps and interferences are in the meshes, which never match."""
    rng = np.random.default_rng(n)
    heights, moduli = rng.uniform(0.5, 2.0, n), 10 ** rng.uniform(3, 5, n)
    gaps = rng.uniform(-1e-3, 2e-3, n - 1)
    layers = [cd.PowerLayer(B=10 ** rng.uniform(-6, -4), a=rng.uniform(0.7, 1.6)) for _ in gaps]
    closure = float(gaps.sum() + 2e-3 * n)
    bodies, floor = [], 0.0
    for i, (height, E) in enumerate(zip(heights, moduli, strict=True)):
        mesh = cd.rectangle((0, floor), (1, floor + height), (2 + i % 2, 1))
        supports = [cd.Symmetry("left")]
        if i == 0:
            supports.append(cd.Symmetry("bottom"))
        if i == n - 1:
            supports.append(cd.Displacement("top", [None, -closure]))
        bodies.append(cd.Body(f"column {i}", mesh, cd.Isotropic(E, 0.0), supports=supports))
        floor += height + (gaps[i] if i < n - 1 else 0.0)
    contacts = [
        cd.Contact((a, "top"), (b, "bottom"), g) for a, b, g in zip(bodies[:-1], bodies[1:], layers, strict=True)
    ]
    scene = cd.Scene(bodies, contacts)
    assert cd.solve(scene).iterations <= 10  # they start evenly pressed, not with the last one alone
    solution = newton(scene)
    exact = cd.reference.column_stack(heights, moduli, layers, gaps, closure)
    for contact, compression in zip(contacts, exact.compressions, strict=True):
        result = solution.contact(contact)
        assert np.abs(result.pressure / exact.pressure - 1).max() < 1e-9
        assert (
            np.abs(result.compression / compression - 1).max() < 1e-8
        )  # a difference of heights up to 64 times larger


def test_hertz_in_space():
    """A bump of curved tetrahedra under a rigid plate of hexahedra, both a quarter."""
    E, nu, radius = 1e4, 0.3, 5.0
    mesh = cd.read_gmsh(Path(__file__).parents[1] / "meshes" / "bump.geo", dim=3, order=2, fine=0.15, zone=0.8)
    quarter = cd.Symmetry("left", "front")
    bump = cd.Body("bump", mesh, cd.Isotropic(E, nu), supports=[quarter, cd.Symmetry("bottom")], degree=2)
    plate = cd.Body(
        "plate",
        cd.box((0, 0, 0), (3, 3, 0.5), (17, 17, 1), shape="hexahedron"),
        cd.Isotropic(1e9, 0.0),
        supports=[quarter, cd.Displacement("top", [0, 0, -0.06])],
    )
    contact = cd.Contact((bump, "bump"), (plate, "bottom"), cd.LinearLayer(stiffness=1e6))
    result = newton(cd.Scene([bump, plate], [contact]), tolerance=1e-9).contact()
    exact = cd.reference.hertz_sphere(4 * result.force, radius, E, nu)
    # The layer takes 1e-3 of an approach of 0.06, the block is six radii of the contact high, a facet a quarter of one.
    assert result.pressure.max() == pytest.approx(exact.peak_pressure, rel=0.03)
    assert np.sqrt(4 * result.area / np.pi) == pytest.approx(exact.radius, rel=0.05)


def lame_shrink(a: float, b: float, c: float, inner: cd.Isotropic, outer: cd.Isotropic, q: float, k: float) -> float:
    """The contact pressure between two rings a–b, b–c under the outer pressure q (plane strain, layer σ = k w)."""

    def u(low, high, inside, outside, material):  # radial displacement at b by Lamé
        A = (inside * low**2 - outside * high**2) / (high**2 - low**2)
        C = (inside - outside) * low**2 * high**2 / (high**2 - low**2)
        return (1 + material.nu) / material.E * ((1 - 2 * material.nu) * A * b + C / b)

    closing = u(b, c, 1, 0, outer) - u(a, b, 0, 1, inner) + 1 / k
    return -u(b, c, 0, q, outer) / closing


def sector(low: float, high: float, cells: tuple[int, int], order: int) -> cd.Mesh:
    """A quarter of a ring of quadrilaterals, curved with order 2."""
    radial, around = (order * count + 1 for count in cells)
    r, t = np.meshgrid(np.linspace(low, high, radial), np.linspace(0, np.pi / 2, around), indexing="ij")
    nodes = np.column_stack([(r * np.cos(t)).ravel(), (r * np.sin(t)).ravel()])
    place = np.arange(radial * around).reshape(radial, around)
    local = basix.create_element(
        basix.ElementFamily.P, basix.CellType.quadrilateral, order, basix.LagrangeVariant.gll_warped
    ).points
    local = np.rint(local * order).astype(int)
    i, j = (order * k.ravel()[:, None] for k in np.indices(cells))
    element = basix.ufl.element("Lagrange", "quadrilateral", order, shape=(2,))
    domain = dmesh.create_mesh(
        MPI.COMM_SELF, cells=place[i + local[:, 0], j + local[:, 1]], x=nodes, e=ufl.Mesh(element)
    )
    near = 0.05 * (high - low)
    return cd.from_dolfinx(
        domain,
        inner=lambda x: np.hypot(x[0], x[1]) < low + near,
        outer=lambda x: np.hypot(x[0], x[1]) > high - near,
        below=lambda x: np.abs(x[1]) < 1e-9,
        beside=lambda x: np.abs(x[0]) < 1e-9,
    )


def ring_error(around: tuple[int, int], order: int, degree: int, measure_gap: bool) -> float:
    """The relative L2 error of the pressure between two rings with so many cells around."""
    q, k = 50.0, 1e5
    sides = cd.Symmetry("below", "beside")
    a = cd.Body("a", sector(1, 1.5, (around[0] // 2, around[0]), order), STEEL, supports=[sides], degree=degree)
    b = cd.Body(
        "b",
        sector(1.5, 2, (around[0] // 2, around[1]), order),
        BRASS,
        supports=[sides],
        loads=[cd.Pressure("outer", q)],
        degree=degree,
    )
    contact = cd.Contact((a, "outer"), (b, "inner"), cd.LinearLayer(stiffness=k), measure_gap=measure_gap)
    result = newton(cd.Scene([a, b], [contact])).contact()
    exact = lame_shrink(1, 1.5, 2, STEEL, BRASS, q, k)
    return float(np.sqrt(result.weights @ (result.pressure / exact - 1) ** 2 / result.weights.sum()))


def rate(errors: list[float]) -> float:
    """The order of convergence fitted to errors on meshes each twice as fine as the one before."""
    return float(-np.polyfit(np.arange(len(errors)), np.log2(errors), 1)[0])


@pytest.mark.parametrize(("order", "degree", "measure_gap"), [(1, 1, False), (2, 1, True), (2, 2, True)])
def test_rates_on_curved_surfaces_are_those_of_matching_meshes(order, degree, measure_gap):
    """Straight facets do not fit each other, so there the gap (none) is given; curved ones are measured."""
    matching = [ring_error((6 * k, 6 * k), order, degree, measure_gap) for k in (1, 2, 4)]
    unlike = [ring_error((6 * k, 9 * k + 1), order, degree, measure_gap) for k in (1, 2, 4)]
    assert rate(unlike) > rate(matching) - 0.15  # the fit over three meshes scatters by a tenth
    assert unlike[-1] < (20 if measure_gap else 5) * matching[-1] + 1e-4 * (degree == 2)


@pytest.mark.parametrize("degree", [1, 2])
def test_rates_on_flat_surfaces_are_those_of_matching_meshes(degree):
    """A smooth gap that closes everywhere: a smooth solution, against a fine one of degree 4."""

    def wave(x: np.ndarray) -> np.ndarray:
        return 2e-5 * (1 + np.cos(np.pi * x[0]))

    def pressure(cells: tuple[int, int], degree: int) -> cd.ContactResult:
        meshes = [
            cd.rectangle((0, y), (2, y + 1), (n, n // 2), shape="quadrilateral")
            for y, n in zip((0, 1), cells, strict=True)
        ]
        scene = pressed(*meshes, degree, gap=wave)
        scene = cd.Scene(scene.bodies, [cd.Contact(*scene.contacts[0].sides, cd.LinearLayer(stiffness=2e5), gap=wave)])
        return newton(scene).contact(degree=8)

    exact = pressure((16, 16), 4)
    order = np.argsort(exact.x[:, 0])
    x, p = exact.x[order, 0], exact.pressure[order]
    assert p.min() > 0  # closed everywhere

    def error(cells: tuple[int, int]) -> float:
        found = pressure(cells, degree)
        difference = found.pressure - CubicSpline(x, p)(found.x[:, 0])
        return float(np.sqrt(found.weights @ difference**2))

    matching = rate([error((8 * k, 8 * k)) for k in (1, 2, 4)])
    unlike = rate([error((7 * k, 11 * k)) for k in (1, 2, 4)])
    assert matching > degree + 0.8
    assert unlike > matching - 0.15


# --------------------------------------------------------------------------------- several zones, several bodies


def test_two_zones_between_two_bodies_are_one_contact_in_two():
    upper = cd.rectangle((0, 1), (4, 2), (12, 3))
    lower = cd.rectangle((0, 0), (4, 1), (10, 3))
    halves = {"one": lambda x: x[0] < 2 + 1e-9, "other": lambda x: x[0] > 2 - 1e-9}

    def zone(height, half):
        return lambda x: (np.abs(x[1] - height) < 1e-9) & half(x)

    lower, upper = (
        mesh.with_surfaces(**{name: zone(1.0, half) for name, half in halves.items()}) for mesh in (lower, upper)
    )
    whole = pressed(lower, upper, gap=groove)
    parts = cd.Scene(
        whole.bodies,
        [cd.Contact(*((body, zone) for body in whole.bodies), LAYER, gap=groove, name=zone) for zone in halves],
    )
    together = newton(whole).contact()
    apart = [newton(parts).contact(zone) for zone in halves]
    x, p = np.vstack([r.x for r in apart]), np.concatenate([r.pressure for r in apart])
    # The same points and the same problem: only sums run in another order.
    assert np.abs(p[nearest(together.x, x)] - together.pressure).max() < ROUNDING * LOAD


def test_one_body_under_two_others():
    long = cd.Body("long", cd.rectangle((0, 0), (4, 1), (23, 4)), STEEL, supports=[cd.Fixed("bottom")])
    blocks = [
        cd.Body(f"block {i}", cd.rectangle((x, 1), (x + 1.2, 2), (5 + i, 4)), BRASS, loads=[cd.Pressure("top", q)])
        for i, (x, q) in enumerate([(0.3, 5.0), (2.4, 12.0)])
    ]
    tops = {f"under {i}": (lambda x, i=i: (x[1] > 1 - 1e-9) & ((x[0] < 2.0) == (i == 0))) for i in (0, 1)}
    mesh = long.mesh.with_surfaces(**tops)
    long = cd.Body("long", mesh, STEEL, supports=[cd.Fixed("bottom")])
    contacts = [cd.Contact((long, f"under {i}"), (block, "bottom"), LAYER) for i, block in enumerate(blocks)]
    solution = newton(cd.Scene([long, *blocks], contacts))
    for contact, load in zip(contacts, (5.0, 12.0), strict=True):
        assert solution.contact(contact).force == pytest.approx(1.2 * load, rel=ROUNDING)
    assert solution.imbalance < ROUNDING


# ----------------------------------------------------------------------------------------------------- refusals


def two(lower: cd.Mesh, upper: cd.Mesh, first: str = "top", second: str = "bottom", **options) -> cd.Scene:
    a, b = cd.Body("a", lower, STEEL), cd.Body("b", upper, BRASS)
    return cd.Scene([a, b], [cd.Contact((a, first), (b, second), LAYER, **options)])


LOWER = ((0, 0), (4, 1), (7, 3))


@pytest.mark.parametrize("upper", [((0, 1), (4, 2), (11, 3)), ((0, 1), (4, 2), (7, 3))])
def test_surfaces_that_point_the_same_way_are_refused(upper):
    with pytest.raises(cd.MeshMismatchError, match="do not face each other"):
        two(cd.rectangle(*LOWER), cd.rectangle(*upper), second="top").interfaces  # noqa: B018


@pytest.mark.parametrize("shape", ["triangle", "quadrilateral"])
def test_surfaces_beside_each_other_are_refused(shape):
    with pytest.raises(cd.MeshMismatchError, match="do not overlap"):
        two(cd.rectangle(*LOWER, shape=shape), cd.rectangle((4.5, 1), (6, 2), (5, 3), shape=shape)).interfaces  # noqa: B018


@pytest.mark.parametrize("shape", ["tetrahedron", "hexahedron"])
def test_surfaces_beside_each_other_in_space_are_refused(shape):
    lower = cd.box((0, 0, 0), (1, 1, 1), (2, 2, 1), shape=shape)
    with pytest.raises(cd.MeshMismatchError, match="do not overlap"):
        two(lower, cd.box((1.2, 0, 1), (2, 1, 2), (3, 2, 1), shape=shape)).interfaces  # noqa: B018


@pytest.mark.parametrize("cells", [7, 11])
def test_surfaces_too_far_apart_are_refused(cells):
    upper = cd.rectangle((0, 1.5), (4, 2), (cells, 3))
    with pytest.raises(cd.MeshMismatchError, match=r"0\.5.* apart.*search_distance = 0\.3"):
        two(cd.rectangle(*LOWER), upper, search_distance=0.3).interfaces  # noqa: B018


def test_a_part_out_of_reach_is_outside_the_contact():
    """The search distance cuts off what cannot come into contact."""
    upper = moved(cd.rectangle((0, 1), (4, 2), (40, 3)), lambda x: x + np.outer(x[:, 0] / 4, [0, 1.0]))
    whole, near = (two(cd.rectangle(*LOWER), upper, search_distance=d).interfaces[0] for d in (None, 0.5))
    assert np.abs(near.gap).max() < 0.5 + 0.03  # segments are kept or not as a whole
    assert near.unpaired_area[0] == pytest.approx(2.0, abs=0.3)
    assert near.weights.sum() < 0.6 * whole.weights.sum()


def test_a_surface_behind_another_is_refused():
    nodes = np.array([[x, y] for y in (1.0, 1.5, 2.0, 2.5) for x in (0.0, 4.0, 5.0)])
    cells = np.array([[0, 1, 3, 4], [1, 2, 4, 5], [4, 5, 7, 8], [6, 7, 9, 10], [7, 8, 10, 11]])  # a C, open to the left
    element = basix.ufl.element("Lagrange", "quadrilateral", 1, shape=(2,))
    domain = dmesh.create_mesh(MPI.COMM_SELF, cells=cells, x=nodes, e=ufl.Mesh(element))
    shelves = cd.from_dolfinx(
        domain, bottom=lambda x: ((np.abs(x[1] - 1) < 1e-9) | (np.abs(x[1] - 2) < 1e-9)) & (x[0] < 4 + 1e-9)
    )
    with pytest.raises(cd.MeshMismatchError, match=r"two partners, one behind the other.*search_distance"):
        two(cd.rectangle(*LOWER), shelves, search_distance=2.0).interfaces  # noqa: B018
    far = two(cd.rectangle(*LOWER), shelves, search_distance=0.4).interfaces[0]
    assert far.unpaired_area == pytest.approx((0, 4.0))


def test_the_vertex_rule_needs_matching_meshes():
    with pytest.raises(cd.MeshMismatchError, match="quadrature = 'vertex' needs meshes that match"):
        two(cd.rectangle(*LOWER), cd.rectangle((0, 1), (4, 2), (11, 3)), quadrature="vertex").interfaces  # noqa: B018


@pytest.mark.parametrize("distance", [0.0, -1.0, np.nan])
def test_a_senseless_search_distance_is_refused(distance):
    with pytest.raises(ValueError, match="search_distance"):
        two(cd.rectangle(*LOWER), cd.rectangle((0, 1), (4, 2), (11, 3)), search_distance=distance)


def test_a_gap_that_is_not_a_number_is_refused():
    upper = cd.rectangle((0, 1), (4, 2), (11, 3))
    with pytest.raises(ValueError, match="gap: not finite at x ="):
        two(cd.rectangle(*LOWER), upper, gap=lambda x: np.where(x[0] < 1, np.nan, 0.0)).interfaces  # noqa: B018
