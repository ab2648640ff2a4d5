"""Eigenstrains: what heat prevented from expanding presses, in the pressures, the stresses and the energies."""

from __future__ import annotations

import numpy as np
import pytest
import ufl
from dolfinx import fem
from scenes import block, stack

import contactdd as cd

E, NU, ALPHA, RISE = 2.1e5, 0.3, 12e-6, 727.0
STEEL = cd.Isotropic(E=E, nu=NU)
#: Radii of the two rings of CalculiX' test ring1, their height and the layer's stiffness.
INNER, MIDDLE, OUTER, HEIGHT, K = 0.95, 1.05, 1.15, 0.1, 1e7


def lame() -> float:
    """The pressure between two rings, free along the axis, the inner one heated, through a linear layer."""
    inside = MIDDLE / E * ((MIDDLE**2 + INNER**2) / (MIDDLE**2 - INNER**2) - NU)
    outside = MIDDLE / E * ((OUTER**2 + MIDDLE**2) / (OUTER**2 - MIDDLE**2) + NU)
    return ALPHA * RISE * MIDDLE / (inside + outside + 1 / K)


def hoop(p: float, r: float, near: float, far: float) -> float:
    """The hoop stress at r of a ring that has p at `near` and nothing at `far`."""
    return p * near**2 / (far**2 - near**2) * (1 + far**2 / r**2)


def rings(heat: object, **options: object) -> cd.Scene:
    """The two rings on a smooth floor."""
    floor = [cd.Symmetry("bottom")]
    shape = {"shape": "quadrilateral"}
    inner = cd.rectangle((INNER, 0), (MIDDLE, HEIGHT), (4, 2), **shape)
    outer = cd.rectangle((MIDDLE, 0), (OUTER, HEIGHT), (4, 2), **shape)
    common = {"degree": 2, "kinematics": "axisymmetric", "supports": floor}
    bodies = [
        cd.Body("inner", inner, STEEL, loads=[heat], **common),
        cd.Body("outer", outer, STEEL, **common),
    ]
    return cd.Scene(bodies, [cd.Contact((bodies[0], "right"), (bodies[1], "left"), cd.LinearLayer(K))], **options)


def test_rings_of_which_one_is_heated():
    """Case 4 of the benchmarks: p = 86.9595 by Lamé's formulas, and their hoop stresses."""
    solution = cd.solve(rings(cd.ThermalStrain(ALPHA, RISE)))
    p = lame()
    assert p == pytest.approx(86.9595, abs=5e-5)
    # Elements of degree 2, four across a ring a tenth of its radius thick: 1/r within 1e-6. Free ends stay plane.
    np.testing.assert_allclose(solution.contact().pressure, p, rtol=1e-5)
    points = np.array([[INNER + 1e-9, 0.05], [MIDDLE - 1e-9, 0.05]])
    stress = solution.stress_at("inner", points)
    expected = [hoop(p, r, MIDDLE, INNER) for r in (INNER, MIDDLE)]
    np.testing.assert_allclose(stress[:, 2], expected, rtol=3e-3)  # stresses are of one degree less
    np.testing.assert_allclose(stress[:, 1], 0.0, atol=3e-3 * p)
    outside = solution.stress_at("outer", [[MIDDLE + 1e-9, 0.05]])[0, 2]
    assert outside == pytest.approx(hoop(p, MIDDLE, MIDDLE, OUTER), rel=3e-3)


def bar(heat: object, material: cd.Material = STEEL, gap: object = 0.0, **options: object) -> cd.Scene:
    """Two columns between rigid walls and floors, both heated or not."""
    supports = [[cd.Fixed("bottom")], [cd.Fixed("top")]]
    cells = options.pop("cells", (2, 2))
    bodies = [
        block(name, floor, cells, material, length=1.0, supports=held, loads=[heat], **options)
        for name, floor, held in zip(("low", "high"), (0.0, 1.0), supports, strict=True)
    ]
    return stack(bodies, cd.LinearLayer(1e9), gap)


@pytest.mark.parametrize("kinematics", ["plane strain", "plane stress"])
@pytest.mark.parametrize("local_solver", ["condensed", "assembled", "multigrid"])
def test_fixed_bar(kinematics, local_solver):
    """Held on all sides: σ_yy = −(C : α ΔT)_yy in series with the layer; stored energy is −½ σ : α ΔT per volume."""
    scene = bar(cd.ThermalStrain(ALPHA, 10.0), kinematics=kinematics)
    solution = cd.solve(scene, local_solver=local_solver, tolerance=1e-10)
    strain = ALPHA * 10.0
    modulus = E / (1 - NU**2) if kinematics == "plane stress" else E * (1 - NU) / ((1 + NU) * (1 - 2 * NU))
    free = E * strain / (1 - NU) if kinematics == "plane stress" else E * strain / (1 - 2 * NU)
    p = free / (1 + modulus / (2 * 1e9))  # the layer gives way by p/k
    np.testing.assert_allclose(solution.contact().pressure, p, rtol=1e-8)
    stress = solution.body("low").stress
    np.testing.assert_allclose(stress[:, 1], -p, rtol=1e-8)
    across = 0.0 if kinematics == "plane stress" else NU / (1 - NU) * (free - p) - free
    np.testing.assert_allclose(stress[:, 2], across, rtol=1e-6, atol=1e-8 * p)
    # ½ (ε − ε₀) : C : (ε − ε₀) with ε_yy = (free − p) / modulus and all else held (in plane stress ε_zz is free).
    elastic = np.array([-strain, (free - p) / modulus - strain, -strain, 0, 0, 0])
    stiffness = STEEL.stiffness()
    if kinematics == "plane stress":
        elastic[2] = -NU / (1 - NU) * (elastic[0] + elastic[1])
    assert solution.elastic_energy("low") == pytest.approx(0.5 * elastic @ stiffness @ elastic, rel=1e-9)


def test_solid_bar():
    """In space, held on all sides: σ = −E α ΔT / (1 − 2ν) where no layer gives way, and a bar that is free has none."""
    mesh = cd.box((0, 0, 0), (1, 1, 1), (2, 2, 2))
    walls = [cd.Symmetry("left", "right", "front", "back")]
    heat = [cd.ThermalStrain(ALPHA, lambda x: 100.0 + 0 * x[0])]
    low = cd.Body("low", mesh, STEEL, supports=[*walls, cd.Fixed("bottom")], loads=heat)
    high = cd.Body("high", mesh.moved((0, 0, 1)), STEEL, supports=[*walls, cd.Fixed("top")], loads=heat)
    solution = cd.solve(cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(1e14))]))
    free = E * ALPHA * 100.0 / (1 - 2 * NU)
    # The layer gives way by 1e-9 of what the bars are shortened; forces balance to 1e-8 of theirs.
    np.testing.assert_allclose(solution.body("high").stress[:, :3], -free, rtol=1e-6)


def test_eigenstrains_of_free_and_held_bodies():
    """A block that nothing prevents expands without stress or energy; one that is held everywhere has −C : ε₀."""
    strain = np.array([[2e-3, 5e-4, 0], [5e-4, -1e-3, 0], [0, 0, 3e-3]])
    mesh = cd.rectangle((0, 0), (1, 1), (3, 3))
    sides = ("left", "right", "bottom", "top")
    held = cd.Body("held", mesh, STEEL, supports=[cd.Fixed(*sides)], loads=[cd.Eigenstrain(strain)])
    free = cd.Body(
        "free", mesh.moved((0, 1)), STEEL, kinematics="plane stress", supports=[cd.Symmetry("left", "bottom")],
        loads=[cd.Eigenstrain(np.diag(np.diag(strain)))],
    )  # fmt: skip
    scene = cd.Scene([held, free], [cd.Contact((held, "top"), (free, "bottom"), cd.LinearLayer(1.0), gap=0.5)])
    solution = cd.solve(scene)
    size = E * 3e-3
    np.testing.assert_allclose(solution.body("free").stress, 0.0, atol=1e-9 * size)
    assert abs(solution.elastic_energy("free")) < 1e-12 * size * 3e-3
    np.testing.assert_allclose(solution.displacement_at("free", [[1, 2]]), [[2e-3, -1e-3]], rtol=1e-9)
    expected = STEEL.stiffness() @ [2e-3, -1e-3, 3e-3, 0, 0, 1e-3]
    np.testing.assert_allclose(solution.body("held").stress, np.tile(-expected, (16, 1)), rtol=1e-10, atol=1e-10 * size)
    energy = 0.5 * expected @ [2e-3, -1e-3, 3e-3, 0, 0, 1e-3]
    assert solution.elastic_energy("held") == pytest.approx(energy, rel=1e-12)


def test_temperature_from_function_and_parameter():
    """A field of dolfinx, a function and a parameter of the same values give the same; all are read anew."""
    scene = bar(cd.ThermalStrain(ALPHA, lambda x: 5.0 + x[1]))
    expected = cd.solve(scene).contact().pressure
    meshes = [body.mesh for body in scene.bodies]
    fields = [fem.Function(fem.functionspace(mesh.domain, ("Lagrange", 1))) for mesh in meshes]
    bodies = []
    for body, field in zip(scene.bodies, fields, strict=True):
        field.interpolate(lambda x: 5.0 + x[1])
        bodies.append(
            cd.Body(body.name, body.mesh, STEEL, supports=body.supports, loads=[cd.ThermalStrain(ALPHA, field)])
        )
    own = stack(bodies, cd.LinearLayer(1e9), 0.0)
    first = cd.solve(own)
    np.testing.assert_allclose(first.contact().pressure, expected, rtol=1e-10)
    before = first.stress("low").x.array.copy()
    for field in fields:
        field.x.array[:] *= 2
    second = cd.solve(own)
    np.testing.assert_allclose(second.contact().pressure, 2 * expected, rtol=1e-8)  # all is linear while closed
    np.testing.assert_array_equal(first.stress("low").x.array, before, err_msg="a solution keeps its temperature")
    assert first.elastic_energy() == pytest.approx(second.elastic_energy() / 4, rel=1e-8)
    rise = cd.Parameter(1.0)
    path = cd.programme(
        bar(cd.ThermalStrain(ALPHA, 3 * rise)), rise, [1.0, 2.0], record={"p": lambda s: s.contact().pressure}
    )
    np.testing.assert_allclose(path.records["p"][1], 2 * path.records["p"][0], rtol=1e-8)


def test_copies_have_their_own_temperature():
    """Equal blocks, of which only one is hot, share their matrices and nothing else."""
    shared = bar(cd.ThermalStrain(ALPHA, 10.0))
    both = cd.solve(shared).contact().force
    cold = cd.Body("high", shared.bodies[1].mesh, STEEL, supports=shared.bodies[1].supports)
    half = cd.solve(stack([shared.bodies[0], cold], cd.LinearLayer(1e9), 0.0)).contact().force
    assert half == pytest.approx(both / 2, rel=1e-9)


def test_error_estimate_and_adapt():
    """Heat is part of the better solution too: a field that linear elements miss is found, and refined away."""
    heat = cd.ThermalStrain(ALPHA, lambda x: 100.0 * x[0] ** 2)
    scene = bar(heat, cells=(4, 4))
    estimate = cd.error_estimate(cd.solve(scene))
    assert 1e-4 < estimate.pressure.relative < 0.2
    finer = cd.adapt(scene, estimate.pressure.relative / 3)
    assert finer.reached


def test_orthotropic_expansion():
    """Three coefficients: held in the plane, only those there and the one across press."""
    one = cd.solve(bar(cd.ThermalStrain((0.0, ALPHA, 0.0), 10.0))).contact().pressure
    three = cd.solve(bar(cd.ThermalStrain((ALPHA, ALPHA, ALPHA), 10.0))).contact().pressure
    # C : ε₀ along y is (λ + 2μ) for one and 3λ + 2μ for three.
    np.testing.assert_allclose(three / one, 1 + 2 * NU / (1 - NU), rtol=1e-8)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: cd.ThermalStrain("hot", 1.0), "alpha"),
        (lambda: cd.ThermalStrain(ALPHA, np.nan), "temperature"),
        (lambda: cd.ThermalStrain((1.0, 2.0), 1.0), "alpha"),
        (lambda: cd.ThermalStrain(cd.Parameter(1.0), 1.0), "alpha"),
        (lambda: cd.Eigenstrain([[1.0, 2.0], [2.0, 1.0]]), r"\(3, 3\)"),
        (lambda: cd.Eigenstrain(np.triu(np.ones((3, 3)))), "symmetric"),
    ],
)
def test_refusals(make, words):
    with pytest.raises((TypeError, ValueError), match=words):
        make()


def test_temperature_of_another_mesh():
    other = cd.rectangle((0, 0), (1, 1), (2, 2))
    field = fem.Function(fem.functionspace(other.domain, ("Lagrange", 1)))
    with pytest.raises(ValueError, match="another mesh"):
        cd.solve(bar(cd.ThermalStrain(ALPHA, field)))
    assert ufl.domain.extract_domains(field)
