"""What the residual is measured against, and what a rigid motion of a whole scene changes: nothing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contactdd as cd
from contactdd.system import start
from contactdd.system.ensemble import Ensemble

STEEL, SIDES = cd.Isotropic(2.1e5, 0.3), cd.Symmetry("left", "right")
LAYER = cd.PowerLayer(4e-6, 1.1)


def groove(x: np.ndarray) -> np.ndarray:
    return 5e-4 * np.maximum(1 - x[0] ** 2, 0) ** 1.5


def rigid(shift: tuple[float, float], turn: float):
    """The displacement of a small rotation about the origin after a translation."""
    return [lambda x: shift[0] - turn * x[1], lambda x: shift[1] + turn * x[0]]


def moved_foundation(shift=(0.0, 0.0), turn=0.0, load=10.0, springs=None) -> cd.Scene:
    """A block on a foundation of another mesh, whose underside is moved like a rigid body."""
    lower = cd.Body(
        "lower", cd.rectangle((0, 0), (4, 1), (12, 4)), STEEL, supports=[cd.Displacement("bottom", rigid(shift, turn))]
    )
    supports = [] if springs is None else [cd.Spring("top", springs, direction=(1, 0))]
    upper = cd.Body(
        "upper", cd.rectangle((0.5, 1), (3, 2), (9, 4)), STEEL, supports=supports, loads=[cd.Pressure("top", load)]
    )
    return cd.Scene([lower, upper], [cd.Contact((upper, "bottom"), (lower, "top"), LAYER, gap=groove)])


@pytest.mark.parametrize("local_solver", ["condensed", "assembled", "multigrid"])
@settings(max_examples=5, deadline=None, derandomize=True)
@given(
    x=st.floats(-10, 10), y=st.floats(-10, 10), turn=st.floats(-1, 1), load=st.sampled_from([1e-3, 1.0, 10.0]),
    tolerance=st.sampled_from([1e-10, 1e-6]),
)  # fmt: skip
def test_rigid_motion_of_the_scene_changes_nothing(local_solver, x, y, turn, load, tolerance):
    """Displacements up to 1e8 times the layer's compression: its gaps are then known to 1e-16 of the displacements."""
    still = cd.solve(moved_foundation(load=load), local_solver=local_solver).contact()
    run = cd.solve(moved_foundation((x, y), turn, load), local_solver=local_solver, tolerance=tolerance)
    moved = run.contact()
    rounding = 1e-14 * (abs(x) + abs(y) + 4 * abs(turn))  # of u_n, a sum of some ten terms
    within = rounding * LAYER.derivative(-still.compression.min()) + 100 * tolerance * still.pressure.max()
    assert np.abs(moved.pressure - still.pressure).max() <= within
    assert run.residual <= max(2 * tolerance, 1e-12)
    assert run.imbalance <= max(2 * tolerance, 1e-12)


@pytest.mark.parametrize("method", ["auto", "newton-krylov", "chord", "kurchatov", "anderson"])
def test_every_method_starts_where_the_scene_was_moved(method):
    still, moved = (cd.solve(moved_foundation(shift), method) for shift in ((0.0, 0.0), (0.0, 3.0)))
    assert moved.iterations <= still.iterations + 2  # rounding decides the last one
    # Tolerance 1e-10 times the layer's slope over the bodies', and rounding of 3 beside a closing of 5e-5.
    assert moved.contact().pressure == pytest.approx(still.contact().pressure, rel=1e-7)


def test_displacements_are_the_whole_ones():
    """The foundation arrives where it was sent, the block is carried along, and stresses do not change."""
    shift, turn = (2.0, -1.0), 0.3
    still, moved = cd.solve(moved_foundation()), cd.solve(moved_foundation(shift, turn))
    for body in ("lower", "upper"):
        function = moved.displacement(body)
        x = function.function_space.tabulate_dof_coordinates().T
        carried = (
            function.x.array
            - still.displacement(body).x.array
            - np.array([each(x) for each in rigid(shift, turn)]).T.ravel()
        )
        # What slides without friction nothing holds; what the contact resists follows to rounding of 2.
        free = carried.reshape(-1, 2)[:, 1] if body == "lower" else np.zeros(1)
        assert np.abs(free).max() < 1e-12
    one, other = (run.stress("lower").x.array for run in (still, moved))
    assert np.abs(one - other).max() < 1e-7 * np.abs(one).max()  # E times the rounding of 2 over the size of a cell
    assert moved.elastic_energy() == pytest.approx(still.elastic_energy(), rel=1e-9)


@pytest.mark.parametrize("local_solver", ["condensed", "assembled", "multigrid"])
@pytest.mark.parametrize("method", ["auto", "newton-krylov"])
@pytest.mark.parametrize("spring", [1e-6, 1.0])
def test_block_held_sideways_by_springs_on_a_soft_layer(local_solver, method, spring):
    """The block sinks by q/k, 1e6 times what strains it; sideways springs change nothing of an even pressure."""
    stiff = cd.Isotropic(1e9, 0.0)
    base = cd.Body("base", cd.rectangle((-3, -1), (3, 0), (12, 2)), stiff, supports=[cd.Fixed("bottom")])
    block = cd.Body(
        "block", cd.rectangle((-1, 0), (1, 1), (8, 4)), stiff, loads=[cd.Pressure("top", 50.0)],
        supports=[cd.Spring("top", spring * 1e9, direction=(1, 0))],
    )  # fmt: skip
    scene = cd.Scene([base, block], [cd.Contact((block, "bottom"), (base, "top"), cd.LinearLayer(1e3))])
    solution = cd.solve(scene, method, local_solver=local_solver)
    assert solution.residual < 1e-10
    assert solution.contact().pressure == pytest.approx(50.0, rel=1e-6)  # the base bends by 1e-6 of the closing
    assert solution.energy == pytest.approx(-0.5 * 50.0 * 2 * 0.05, rel=1e-4)  # −½ L(u), u the sinking q/k


def test_springs_of_a_moved_body():
    """A spring answers the rigid part of what is prescribed: reaction k u times the surface, and its energy."""
    lower = cd.Body(
        "lower", cd.rectangle((0, 0), (2, 1), (4, 2)), STEEL,
        supports=[cd.Displacement("bottom", [0.5, 0.0]), cd.Spring("left", 3.0, direction=(1, 0))],
    )  # fmt: skip
    upper = cd.Body("upper", cd.rectangle((0, 1), (2, 2), (4, 2)), STEEL, loads=[cd.Pressure("top", 1.0)])
    for solver in ("condensed", "assembled"):
        scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.LinearLayer(1e4))])
        solution = cd.solve(scene, local_solver=solver)
        # The spring strains the body by 1e-5 of its motion.
        assert solution.elastic_energy("lower") == pytest.approx(0.5 * 3.0 * 0.5**2, rel=1e-3)
        assert solution.imbalance < 1e-9
        # F₁ is stationary at the solution: twice the stored energy of linear laws is the work of all that moves it.
        assert solution.residual < 1e-9


def foams(k: float) -> cd.Scene:
    """Three steel blocks with two foams between, the top pushed by 0.1."""

    def block(name: str, y: float, *supports: cd.Support) -> cd.Body:
        return cd.Body(name, cd.rectangle((0, y), (4, y + 1), (8, 4)), STEEL, supports=[SIDES, *supports])

    a, b, c = block("a", 0, cd.Fixed("bottom")), block("b", 1), block("c", 2, cd.Displacement("top", [None, -0.1]))
    one = cd.TableLayer([0.01, 0.04, 0.06, 0.2], [0.1 * k, 0.2 * k, 2 * k, 100 * k])
    two = cd.TableLayer([0.02, 0.05, 0.2], [k, 1.1 * k, 50 * k])
    low, high = cd.Contact((a, "top"), (b, "bottom"), one), cd.Contact((b, "top"), (c, "bottom"), two)
    return cd.Scene([a, b, c], [low, high])


@pytest.mark.parametrize("method", ["auto", "chord"])
@pytest.mark.parametrize("k", [0.05, 5e-6])
@pytest.mark.parametrize("tolerance", [1e-10, 1e-6])
def test_foams_in_series_share_one_force(method, k, tolerance):
    solution = cd.solve(foams(k), method, tolerance=tolerance)
    low, high = (solution.contact(i) for i in (0, 1))
    # The residual is a norm over 18 nodes of two faces.
    assert low.force == pytest.approx(high.force, rel=20 * tolerance)
    assert low.compression.mean() + high.compression.mean() == pytest.approx(-0.1, rel=1e-4)  # steel gives 1e-6 of it
    assert solution.residual <= 2 * tolerance


@pytest.mark.parametrize("method", ["auto", "newton-krylov", "chord"])
def test_solve_and_solution_measure_by_one_scale(method):
    """Loads on what is held do no work: they loosen nothing."""
    lower = cd.Body(
        "lower", cd.rectangle((0, 0), (4, 1), (8, 4)), STEEL, supports=[SIDES, cd.Fixed("bottom")],
        loads=[cd.Pressure("bottom", 1e9)],
    )  # fmt: skip
    upper = cd.Body(
        "upper", cd.rectangle((0, 1), (4, 2), (8, 4)), STEEL, supports=[SIDES], loads=[cd.Pressure("top", 1.0)]
    )
    scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), LAYER, gap=groove)])
    run = cd.solve(scene, method, tolerance=1e-6)
    assert run.history.residual[-1] <= 1e-6
    assert run.residual == pytest.approx(run.history.residual[-1], rel=1e-3, abs=1e-12)  # rounding of the fields
    assert run.contact().force == pytest.approx(4.0, rel=1e-5)


def test_bent_surfaces_are_no_rigid_motion():
    """A prescribed bulge strains its body; its closed form is the deflection of the contact under no load."""
    for solver in ("condensed", "assembled"):
        lower = cd.Body(
            "lower", cd.rectangle((0, 0), (4, 1), (16, 4)), STEEL,
            supports=[cd.Displacement("bottom", [0.0, lambda x: 5 + 1e-3 * np.cos(np.pi * x[0] / 2)])],
        )  # fmt: skip
        upper = cd.Body(
            "upper", cd.rectangle((0, 1), (4, 2), (16, 4)), STEEL, supports=[cd.Symmetry("left")],
            loads=[cd.Pressure("top", 1e-3)],
        )  # fmt: skip
        scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.LinearLayer(1e2))])
        solution = cd.solve(scene, local_solver=solver)
        assert solution.contact().force == pytest.approx(4e-3, rel=1e-8)
        assert solution.residual < 1e-9


def test_start_follows_what_is_prescribed():
    scene = moved_foundation((0.0, 7.0))
    ensemble = Ensemble(scene.local_problems("condensed"), scene.interfaces)
    for state in (start.rigidly_closed(ensemble), start.uniformly_closed(ensemble, scene.ranks)):
        assert min(z.min() for z in state.gaps) == pytest.approx(-5.0357e-5, rel=1e-2)  # B q^a of the block's load
