"""Loads, springs and prescribed displacements on bodies in contact."""

from __future__ import annotations

import basix.ufl
import numpy as np
import pytest
import ufl
from dolfinx import fem
from dolfinx import mesh as dmesh
from mpi4py import MPI
from scenes import LAYER, STEEL, groove
from scipy.optimize import brentq

import contactdd as cd
from contactdd.local.space import admissible_space

Q, WIDTH, HEIGHT = 10.0, 3.0, 2.0
# Uniform states are exact on every mesh; the solves end at 1e-12 of the forces, softer parts enlarge that.
EXACT = 1e-9


def scene(load, supports=None, *, dim=2, degree=1, **options):
    """Two blocks; the upper one carries `load`, the lower one stands on `supports`; their sides keep their planes."""
    if dim == 2:
        meshes = [cd.rectangle((0, y), (WIDTH, y + HEIGHT), (3, 2)) for y in (0.0, HEIGHT)]
        sides = cd.Symmetry("left", "right")
    else:
        meshes = [cd.box((0, 0, z), (WIDTH, 1, z + HEIGHT), (3, 1, 2)) for z in (0.0, HEIGHT)]
        sides = cd.Symmetry("left", "right", "front", "back")
    supports = [cd.Symmetry("bottom")] if supports is None else supports
    lower = cd.Body("lower", meshes[0], STEEL, supports=[sides, *supports], degree=degree)
    upper = cd.Body("upper", meshes[1], STEEL, supports=[sides], loads=load, degree=degree)
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), LAYER, **options)])


def solved(of, **options):
    return cd.solve(of, "newton", gamma="search", tolerance=1e-12, **options)


def moves(solution, body):
    """(coordinates, displacements) at the nodes of a body."""
    u = solution.displacement(body)
    x = u.function_space.tabulate_dof_coordinates()
    return x, u.x.array.reshape(len(x), -1)


def oedometric(material=STEEL):
    """Stress per strain of a block that cannot widen."""
    return material.stiffness()[1, 1]


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("degree", [1, 2])
def test_all_ways_to_say_the_same_load(dim, degree):
    total = np.zeros(dim)
    total[-1] = -Q * WIDTH
    traction = total / WIDTH
    loads = [
        cd.Pressure("top", Q),
        cd.Traction("top", traction),
        cd.Resultant("top", total),
        cd.Pressure("top", lambda x: np.full(x.shape[1], Q)),
        cd.Traction("top", ufl.as_vector(list(traction))),
        cd.Pressure("top", cd.Parameter(Q)),
        cd.Pressure("top", cd.Parameter(2.0).field(lambda q, x: 5 * q + 0 * x[0])),
    ]
    for load in loads:
        solution = solved(scene([load], dim=dim, degree=degree))
        assert solution.contact().force == pytest.approx(Q * WIDTH, rel=EXACT)
        # The condition of two blocks and a thin layer enlarges the residual most where the pressure varies.
        assert np.abs(solution.contact().pressure / Q - 1).max() < EXACT


def test_resultant_carries_its_force_on_a_curved_face():
    """A face bent by a quadratic map of a quadratic mesh: the nodal forces sum to the force, to rounding."""
    points = np.array([[0, 0], [1, 0], [0, 1], [0.7, 0.7], [0, 0.5], [0.5, 0.0]])  # P2: the hypotenuse bulges
    domain = dmesh.create_mesh(
        MPI.COMM_SELF,
        cells=np.arange(6)[None],
        x=points,
        e=basix.ufl.element("Lagrange", "triangle", 2, shape=(2,)),
    )
    mesh = cd.from_dolfinx(domain, arc=lambda x: (x[0] > 1e-9) & (x[1] > 1e-9) | np.isclose(x[0] + x[1], 1.0))
    body = cd.Body("b", mesh, STEEL, loads=[cd.Resultant("arc", (2.0, -5.0))], degree=2)
    vector = fem.assemble_vector(fem.form(body.loads[0].form(body.elements, ufl.TestFunction(body.space)))).array
    assert vector.reshape(-1, 2).sum(axis=0) == pytest.approx([2.0, -5.0], rel=1e-13)


def test_own_weight():
    """σ_y = −ρ g (height above): at the interface the upper block's weight, at half its height half of it."""
    solution = solved(scene([cd.BodyForce((0.0, -4.0))], degree=2))
    assert solution.contact().pressure == pytest.approx(4.0 * HEIGHT, rel=EXACT)
    stress = solution.stress("upper")
    y = stress.function_space.tabulate_dof_coordinates()[:, 1]
    assert stress.x.array.reshape(-1, 6)[:, 1] == pytest.approx(-4.0 * (2 * HEIGHT - y), rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("direction", [None, "normal", "axis"])
@pytest.mark.parametrize("local_solver", ["condensed", "assembled"])
def test_block_on_springs_settles_by_load_over_stiffness(dim, direction, local_solver):
    k = 500.0
    along = np.eye(dim)[-1] if direction == "axis" else direction
    of = scene([cd.Pressure("top", Q)], [cd.Spring("bottom", k, along)], dim=dim)
    solution = solved(of, local_solver=local_solver)
    x, u = moves(solution, "lower")
    bottom = x[:, dim - 1] < 1e-9
    assert u[bottom, -1] == pytest.approx(-Q / k, rel=EXACT)
    assert u[~bottom, -1].min() == pytest.approx(-Q / k - Q * HEIGHT / oedometric(), rel=EXACT)
    forces = solution.forces("lower")
    assert forces["supports"][-1] == pytest.approx(Q * WIDTH, rel=EXACT)
    assert solution.imbalance < EXACT
    area = WIDTH  # in space the blocks are one unit deep
    energy = 0.5 * Q**2 * area * (1 / k + HEIGHT / oedometric())
    assert solution.elastic_energy("lower") == pytest.approx(energy, rel=EXACT)


@pytest.mark.parametrize("local_solver", ["condensed", "assembled"])
def test_soft_springs_hold(local_solver):
    """Stiffness 1e-6 of the block's, which a threshold on its rigid motions' energy would take for rounding."""
    k, q = 1e-6 * STEEL.E, 1e-4
    of = scene([cd.Pressure("top", q)], [cd.Spring("bottom", k)])
    solution = cd.solve(of, "newton", gamma="search", tolerance=1e-7, local_solver=local_solver)
    x, u = moves(solution, "lower")
    # The condition of the system is 1e7 or so, of 1e-16: 1e-9, with room for a factor of 100.
    assert u[x[:, 1] < 1e-9, 1] == pytest.approx(-q / k, rel=1e-7)


def test_springs_of_varying_stiffness_answer_with_their_own_share():
    """A block much stiffer than its springs tilts as a rigid one: k(x) = k₀ x/l, load in the middle, sides free."""
    k, load = 1.0, 2.0
    stiff = cd.Isotropic(E=1e5, nu=0.3)
    lower = cd.Body(
        "lower",
        cd.rectangle((0, 0), (WIDTH, HEIGHT), (3, 2)),
        stiff,
        supports=[cd.Spring("bottom", lambda x: k * x[0] / WIDTH, "normal")],
    )
    upper = cd.Body("upper", cd.rectangle((0, 2), (3, 4), (3, 2)), stiff, loads=[cd.Resultant("top", (0, -load))])
    of = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.LinearLayer(1e5))])
    solution = cd.solve(of, "newton", gamma="search", tolerance=1e-9)
    x, u = moves(solution, "lower")
    # ∫ k (a + b x) dx = −load and ∫ k (a + b x) x dx = −load l / 2 with k = k₀ x / l.
    moments = [WIDTH ** (n + 1) / (n + 1) / WIDTH for n in (1, 2, 3)]
    a, b = np.linalg.solve([[moments[0], moments[1]], [moments[1], moments[2]]], [-load, -load * WIDTH / 2]) / k
    bottom = x[:, 1] < 1e-9
    # The block gives way by some load / E = 2e-5 where the springs do by 1.
    assert u[bottom, 1] == pytest.approx(a + b * x[bottom, 0], abs=1e-4 * np.abs([a, b]).max())


def test_prescribed_displacement_presses_the_blocks_together():
    """q from the scalar equation 2 q h / M + B q^a = Δ."""
    approach = 5e-4
    of = scene([])
    upper = cd.Body(
        "upper",
        of.bodies[1].mesh,
        STEEL,
        supports=[cd.Symmetry("left", "right"), cd.Displacement("top", (None, -approach))],
    )
    lower = of.bodies[0]
    of = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), LAYER)])
    solution = solved(of, start=0.2 * approach)

    def excess(q):
        return 2 * q * HEIGHT / oedometric() + LAYER.B * q**LAYER.a - approach

    expected = brentq(excess, 0.0, 100.0, xtol=1e-13)
    assert solution.contact().pressure == pytest.approx(expected, rel=EXACT)
    assert solution.forces("upper")["supports"][1] == pytest.approx(-expected * WIDTH, rel=EXACT)


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: cd.Spring("bottom", 0.0), ValueError, "stiffness = 0.0: expected a number > 0"),
        (lambda: cd.Spring("bottom", np.nan), ValueError, "stiffness = nan"),
        (
            lambda: cd.Spring("bottom", 1.0, "tangential"),
            ValueError,
            "direction = 'tangential': expected one of 'normal'",
        ),
        (lambda: cd.Spring("bottom", cd.Parameter(1.0)), TypeError, "stiffness = Parameter.*expected a number"),
        (lambda: cd.Parameter(np.inf), ValueError, "value = inf: expected finite numbers"),
        (
            lambda: solved(scene([], [cd.Spring("bottom", 1.0, (0, 0, 1))])),
            ValueError,
            "direction = .* 2 finite numbers",
        ),
        (lambda: solved(scene([], [cd.Spring("bottom", lambda x: x[0] - 1)])), ValueError, r"stiffness = -.* at x = "),
        (lambda: solved(scene([], [cd.Spring("base", 1.0)])), ValueError, "surface = 'base'.*'bottom'"),
        (lambda: solved(scene([cd.Resultant("top", 3.0)])), ValueError, "force = 3.0: expected 2 or 3 finite numbers"),
        (
            lambda: solved(scene([cd.Resultant("top", (0, np.nan))])),
            ValueError,
            "force = .*: expected 2 or 3 finite numbers",
        ),
        (lambda: solved(scene([cd.Pressure("top", np.nan)])), ValueError, "pressure = nan"),
        (lambda: solved(scene([cd.Pressure("top", lambda x: x[0] * np.nan)])), ValueError, "pressure: not finite at x"),
        (lambda: solved(scene([cd.Traction("top", (1, 2, 3))])), ValueError, r"traction = .* 2 finite numbers"),
        (
            lambda: solved(scene([cd.BodyForce(cd.Parameter(1.0))])),
            ValueError,
            "body force = .*: expected 2 or 3",
        ),
    ],
)
def test_wrong_loads_and_springs_are_refused_by_name(make, error, message):
    with pytest.raises(error, match=message):
        make()


#: Supports that hold a block's whole contact surface "top": a rigid foundation.
FOUNDATIONS = {
    "top fixed": [cd.Fixed("top", "bottom")],
    "top does not sink": [cd.Displacement("top", (None, 0.0)), cd.Fixed("bottom")],
    "all fixed": [cd.Fixed("left", "right", "bottom", "top")],
}


def on_a_foundation(supports, degree=1):
    """A grooved block pressed with Q · WIDTH onto one whose contact surface cannot move."""

    return scene([cd.Pressure("top", Q)], supports, degree=degree, gap=groove)


@pytest.mark.parametrize(
    ("local_solver", "method"),
    [
        ("condensed", "auto"),
        ("condensed", "newton-chord"),
        ("condensed", "chord"),
        ("condensed", "newton-krylov"),
        ("assembled", "auto"),
        ("assembled", "chord"),
        ("assembled", "newton-krylov"),
    ],
)
@pytest.mark.parametrize("foundation", FOUNDATIONS)
def test_rigid_foundation(foundation, local_solver, method):
    solution = cd.solve(on_a_foundation(FOUNDATIONS[foundation]), method, local_solver=local_solver)
    assert solution.contact().force == pytest.approx(Q * WIDTH, rel=EXACT)


@pytest.mark.parametrize("local_solver", ["condensed", "assembled"])
@pytest.mark.parametrize("method", ["auto", "chord"])
def test_rigid_foundation_that_may_slide(method, local_solver):
    """Nothing holds it along its surface, and no kept unknown does either."""
    held = [cd.Displacement("top", (None, 0.0))]
    lower = cd.Body("lower", cd.rectangle((0, 0), (WIDTH, HEIGHT), (3, 2)), STEEL, supports=held)
    pressed = on_a_foundation([]).bodies[1]
    on = cd.Scene([lower, pressed], [cd.Contact((lower, "top"), (pressed, "bottom"), LAYER)])
    assert cd.solve(on, method, local_solver=local_solver).contact().force == pytest.approx(Q * WIDTH, rel=EXACT)


@pytest.mark.parametrize("degree", [3, 5])
def test_rigid_foundation_of_higher_degree(degree):
    solution = cd.solve(on_a_foundation(FOUNDATIONS["top fixed"], degree), local_solver="condensed")
    assert solution.contact().force == pytest.approx(Q * WIDTH, rel=EXACT)


@pytest.mark.parametrize("method", ["auto", "chord", "newton-krylov"])
def test_multigrid_of_a_body_without_unknowns(method):
    solution = cd.solve(on_a_foundation(FOUNDATIONS["all fixed"]), method, local_solver="multigrid")
    assert solution.contact().force == pytest.approx(Q * WIDTH, rel=EXACT)


def test_multigrid_of_a_held_body_under_one_that_floats():
    lower = cd.Body("lower", cd.rectangle((0, 0), (4, 1), (1, 1)), STEEL, supports=[cd.Fixed("bottom", "top")])
    sides = [cd.Symmetry("left", "right")]
    load = [cd.Pressure("top", Q)]
    upper = cd.Body("upper", cd.rectangle((0, 1), (4, 2), (4, 2)), STEEL, supports=sides, loads=load)
    pressed = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), LAYER)])
    for method in ("auto", "chord"):
        force = cd.solve(pressed, method, local_solver="multigrid").contact().force
        assert force == pytest.approx(4 * Q, rel=EXACT)


@pytest.mark.parametrize(
    "right",
    [
        cd.Displacement("right", (0.0, lambda x: -1e-3 * (x[1] - HEIGHT) * 0.3 / HEIGHT)),
        cd.Displacement("right", (0.0, lambda x: 3e-4 * (x[1] - 2 * HEIGHT) - 1e-3 * 0.1 * 3)),
        cd.Displacement("right", (0.0, -1e-3 * 0.1 * 3)),
    ],
)
@pytest.mark.parametrize("order", [1, -1])
def test_supports_that_agree_to_rounding_are_no_conflict(right, order):
    lower = cd.Body("lower", cd.rectangle((0, 0), (WIDTH, HEIGHT), (3, 2)), STEEL, supports=[cd.Fixed("bottom")])
    supports = [right, cd.Displacement("top", (None, -3e-4))][::order]
    mesh = cd.rectangle((0, HEIGHT), (WIDTH, 2 * HEIGHT), (3, 2))
    upper = cd.Body("upper", mesh, STEEL, supports=supports)
    pushed = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), LAYER)])
    assert cd.solve(pushed).contact().force > 0.0


def test_supports_that_cross_zero_where_they_meet_are_no_conflict():
    rounding = 1e-21
    bent = cd.Displacement("top", (None, lambda x: 1e-4 * (x[0] / WIDTH - 1.0) + rounding))
    for supports in ([bent, cd.Displacement("right", (None, 0.0))], [cd.Displacement("right", (None, 0.0)), bent]):
        upper = cd.Body("upper", cd.rectangle((0, 2), (WIDTH, 4), (3, 2)), STEEL, supports=supports)
        assert admissible_space(upper).offset.min() < 0.0


def test_small_differences_of_supports_are_still_a_conflict():
    supports = [cd.Displacement("right", (0.0, -3.00000001e-4)), cd.Displacement("top", (None, -3e-4))]
    body = cd.Body("upper", cd.rectangle((0, 0), (WIDTH, 2), (3, 2)), STEEL, supports=supports)
    with pytest.raises(ValueError, match="prescribe different displacements"):
        admissible_space(body)
