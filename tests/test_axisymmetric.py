"""Bodies of revolution: x[0] is the radius, every integral is over the full ring."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import LAYER, STEEL

import contactdd as cd

Q = 10.0


def cylinders(*, inner=0.0, outer=1.5, supports=(), loads=(), shape="triangle", quadrature="gauss", **options):
    """Two cylinders (rings, if `inner` > 0) of height 1 pressed together along the axis."""
    axis = [cd.Symmetry("left")] if inner == 0.0 else []
    bodies = [
        cd.Body(
            name,
            cd.rectangle((inner, y), (outer, y + 1), (4, 3), shape=shape),
            STEEL,
            supports=[*axis, *supports],
            loads=[cd.Pressure(face, Q), *loads],
            kinematics="axisymmetric",
            **options,
        )
        for name, y, face in (("lower", 0, "bottom"), ("upper", 1, "top"))
    ]
    contact = cd.Contact((bodies[0], "top"), (bodies[1], "bottom"), LAYER, quadrature=quadrature)
    return cd.Scene(bodies, [contact])


@pytest.mark.parametrize("inner", [0.0, 0.5])
@pytest.mark.parametrize(
    ("shape", "degree", "quadrature"),
    [
        ("triangle", 1, "gauss"),
        ("triangle", 2, "gauss"),
        ("quadrilateral", 1, "facet"),
        ("quadrilateral", 2, "facet"),
    ],
)
def test_uniform_compression_of_stacked_cylinders(inner, shape, degree, quadrature):
    """σ_z = −q, ε_r = ε_θ = ν q / E: linear displacements, exact on every mesh up to the solve's tolerance of 1e-12."""
    scene = cylinders(inner=inner, shape=shape, degree=degree, quadrature=quadrature)
    solution = cd.solve(scene, "newton", gamma="search", tolerance=1e-12)
    area = np.pi * (1.5**2 - inner**2)
    result = solution.contact()
    assert result.force == pytest.approx(Q * area, rel=1e-10)
    assert result.area == pytest.approx(area, rel=1e-12)
    assert np.abs(result.pressure / Q - 1).max() < 1e-10
    u = solution.displacement("upper")
    x, u = u.function_space.tabulate_dof_coordinates(), u.x.array.reshape(-1, 2)
    assert np.abs(u[:, 0] - STEEL.nu * Q / STEEL.E * x[:, 0]).max() < 1e-10 * Q / STEEL.E
    assert np.ptp(u[:, 1]) == pytest.approx(Q / STEEL.E, rel=1e-10)
    stress = solution.stress("upper").x.array.reshape(-1, 6)
    assert np.abs(stress - [0, -Q, 0, 0, 0, 0]).max() < 1e-9 * Q  # differences of displacements over a cell
    assert solution.elastic_energy("upper") == pytest.approx(0.5 * Q**2 / STEEL.E * area, rel=1e-10)
    assert solution.forces("upper")["contact"] == pytest.approx([0, Q * area], rel=1e-10)
    assert solution.imbalance < 1e-12


@pytest.mark.parametrize("method", ["chord", "newton"])
@pytest.mark.parametrize("local_solver", ["condensed", "assembled"])
def test_every_road_to_the_solution_carries_the_ring(method, local_solver):
    """The Robin term in UFL and that of the condensed problem are the same integral over the ring."""
    bump = [cd.Symmetry("right")]
    options = {"gamma": 0.6 if method == "chord" else "search", "tolerance": 1e-11}
    scenes = [cylinders(supports=bump), cylinders(supports=bump)]
    for scene in scenes:
        scene.contacts[0].gap = lambda x: 1e-5 * np.cos(2 * x[0])
    expected = cd.solve(scenes[0], "newton", gamma="search", tolerance=1e-11)
    found = cd.solve(scenes[1], method, local_solver=local_solver, **options)
    # Residuals of 1e-11 of the loads, against a stiffness that spans two decades between bodies and layer.
    assert np.abs(found.contact().pressure - expected.contact().pressure).max() < 1e-8 * Q
    assert np.ptp(expected.contact().pressure) > 0.1 * Q


A, B, C, INSIDE, STIFFNESS = 1.0, 2.0, 3.0, 50.0, 4e5


def lame(r, inner, outer, p_inner, p_outer, material=STEEL):
    """Radial displacement and hoop stress of a thick tube in plane strain (Lamé 1852)."""
    difference = outer**2 - inner**2
    mean = (p_inner * inner**2 - p_outer * outer**2) / difference
    varying = (p_inner - p_outer) * inner**2 * outer**2 / difference
    mu = material.E / (2 * (1 + material.nu))
    u = (mean * (1 - 2 * material.nu) * r + varying / r) / (2 * mu)
    return u, mean + varying / r**2


def shrink_pressure():
    """Between two tubes through a linear layer: p = k (u₁ − u₂), both linear in p."""

    def overlap(p):
        return lame(B, A, B, INSIDE, p)[0] - lame(B, B, C, p, 0.0)[0]

    return STIFFNESS * overlap(0.0) / (1 - STIFFNESS * (overlap(1.0) - overlap(0.0)))


def tubes(cells, degree, material=STEEL):
    """One thick tube in another, pressure inside, plane strain along the axis."""
    ends = [cd.Symmetry("bottom", "top")]
    bodies = [
        cd.Body(
            name,
            cd.rectangle((inner, 0), (outer, 0.5), (cells, max(cells // 2, 1))),
            material,
            supports=ends,
            loads=loads,
            degree=degree,
            kinematics="axisymmetric",
        )
        for name, inner, outer, loads in (
            ("inner", A, B, [cd.Pressure("left", INSIDE)]),
            ("outer", B, C, []),
        )
    ]
    return cd.Scene(bodies, [cd.Contact((bodies[0], "right"), (bodies[1], "left"), cd.LinearLayer(STIFFNESS))])


@pytest.mark.parametrize(("degree", "rate"), [(1, 2.0), (2, 4.0)])
def test_tubes_in_each_other_converge_to_lame(degree, rate):
    """The mean pressure between the tubes, a functional of the displacement, at twice the rate of the strains."""
    cells, errors = [4, 8, 16], []
    for n in cells:
        solution = cd.solve(tubes(n, degree), "newton", gamma="search", tolerance=1e-12)
        result = solution.contact()
        errors.append(abs(result.force / result.area / shrink_pressure() - 1))
    fitted = -np.polyfit(np.log(cells), np.log(errors), 1)[0]
    assert fitted > rate - 0.2  # the coarsest mesh has four cells through a wall
    assert errors[-1] < (1e-3 if degree == 1 else 1e-6)


def test_tubes_stress_around_the_ring():
    solution = cd.solve(tubes(8, 2), "newton", gamma="search", tolerance=1e-12)
    pressure = shrink_pressure()
    for name, data in (("inner", (A, B, INSIDE, pressure)), ("outer", (B, C, pressure, 0.0))):
        stress = solution.stress(name)
        r = stress.function_space.tabulate_dof_coordinates()[:, 0]
        hoop = stress.x.array.reshape(-1, 6)[:, 2]
        # Stresses of quadratic elements 1/8 wide: h² of the second derivative of 1/r², 6 (1/8)² / 8.
        assert np.abs(hoop - lame(r, *data)[1]).max() < 0.012 * INSIDE


def test_a_modulus_given_as_a_function_is_integrated_over_the_ring_too():
    """E constant, as a number and as a function: the same tubes but for the quadrature of 1/r, which is not exact."""
    varying = cd.Isotropic(E=lambda x: STEEL.E + 0 * x[0], nu=STEEL.nu)
    expected, found = (cd.solve(tubes(4, 2, m), "newton", gamma="search").contact().force for m in (STEEL, varying))
    assert found == pytest.approx(expected, rel=1e-5)


def test_only_the_axis_is_a_free_rigid_motion():
    scene = cylinders(inner=0.5)
    lower = cd.Body("lower", scene.bodies[0].mesh, STEEL, loads=[cd.Pressure("top", 1.0)], kinematics="axisymmetric")
    other = cd.Scene(
        [lower, scene.bodies[1]], [cd.Contact((lower, "top"), (scene.bodies[1], "bottom"), LAYER, gap=1.0)]
    )
    with pytest.raises(cd.NoEquilibriumError, match="nothing stops its translation along the axis"):
        cd.solve(other, "chord", start=0.0)


def test_a_total_force_is_that_of_the_ring():
    mesh = cd.rectangle((0, 0), (2, 1), (4, 2))
    for degree in (1, 2):
        body = cd.Body("b", mesh, STEEL, kinematics="axisymmetric", degree=degree)
        assert body.elements.area("top") == pytest.approx(4 * np.pi, rel=1e-14)
        assert body.elements.area("right") == pytest.approx(4 * np.pi, rel=1e-14)


def solve_one(**options):
    cd.solve(cylinders(**options), "newton", gamma="search")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: solve_one(inner=-0.5), r"mesh of body 'lower': the radius x\[0\] = -0.5; expected x\[0\] >= 0"),
        (lambda: solve_one(inner=1e-300), r"body 'lower': it can open at .* on the axis r = 0; expected Symmetry"),
        (
            lambda: solve_one(inner=0.5, loads=[cd.Resultant("top", (1.0, 0.0))]),
            r"force = \(1.0, 0.0\): around a ring radial forces sum to zero",
        ),
    ],
)
def test_wrong_rings_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_the_vertex_rule_knows_no_rings():
    with pytest.raises(ValueError, match="quadrature = 'vertex' between bodies of revolution"):
        cylinders(quadrature="vertex")


def test_rings_touch_only_rings():
    ring, plane = (
        cd.Body(kind, cd.rectangle((1, y), (2, y + 1), (2, 2)), STEEL, kinematics=kind)
        for y, kind in enumerate(("axisymmetric", "plane strain"))
    )
    with pytest.raises(ValueError, match="one body is axisymmetric; expected both or none"):
        cd.Scene([ring, plane], [cd.Contact((ring, "top"), (plane, "bottom"), LAYER)])
