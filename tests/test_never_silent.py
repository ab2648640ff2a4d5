"""What is no number, no unknown, no force: each ends in a status or a reason, and never as a solution."""

from __future__ import annotations

import math

import numpy as np
import pytest

import contactdd as cd
from contactdd.history import Record
from contactdd.iteration.line_search import minimise_along
from contactdd.iteration.stopping import StoppingCriterion

STEEL, SIDES = cd.Isotropic(2.1e5, 0.3), cd.Symmetry("left", "right")
METHODS = ("auto", "newton", "newton-krylov", "newton-chord", "anderson", "chord", "one-point", "kurchatov", "robin")
#: A linear law of stiffness 1e5 that ends at the compression 1e-3.
END = 1e-3


def ending(value: float):
    """g(w) = 1e5 w, and another value beyond the law's end."""
    return lambda w: np.where(w < -END, value, 1e5 * w)


def layer(value: float = math.nan, **parts) -> cd.CustomLayer:
    return cd.CustomLayer(ending(value), compression_range=0.9 * END, name="ends", **parts)


def linear(**parts) -> cd.CustomLayer:
    """g(w) = 1e5 w, checked to half of what the load of `two_blocks` compresses it by."""
    return cd.CustomLayer(lambda w: 1e5 * w, compression_range=5e-5, **parts)


def two_blocks(law, gap=0.0, load=10.0, **more) -> cd.Scene:
    lower = cd.Body("lower", cd.rectangle((0, 0), (4, 1), (8, 4)), STEEL, supports=[SIDES, cd.Fixed("bottom")])
    upper = cd.Body(
        "upper", cd.rectangle((0, 1), (4, 2), (8, 4)), STEEL, supports=[SIDES], loads=[cd.Pressure("top", load)]
    )
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), law, gap=gap, name="pad", **more)])


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("value", [math.nan, -math.inf])
@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning")  # NumPy's own word on ∞ − ∞
def test_a_law_that_ends_in_no_number_is_named(method, value):
    run = cd.solve(two_blocks(layer(value)), method, start=END, on_failure="return")  # closed by 2 END at the start
    assert run.status == "diverged"
    assert "'pad'" in run.reason
    assert "CustomLayer" in run.reason
    assert "stress" in run.reason


@pytest.mark.parametrize("criterion", ["residual", "change"])
def test_a_step_into_no_number_keeps_the_last_state(criterion):
    """A one-point step from a touch goes past the law's end under twice the load that it can carry."""
    run = cd.solve(
        two_blocks(layer(), load=200.0), "one-point", gamma=0.9, start=1e-6, criterion=criterion, on_failure="return"
    )
    assert run.status == "diverged"
    assert "'pad'" in run.reason
    assert np.all(np.isfinite(run.contact().pressure))
    assert np.all(np.isfinite(run.history.residual))


@pytest.mark.parametrize("method", ["auto", "newton-krylov", "newton-chord", "anderson"])
def test_a_searched_step_stops_before_a_pole(method):
    """p = −1e3 log(1 − c/h): under the load p = 5000 the closing is h (1 − e⁻⁵), 0.7 % short of the pole."""
    h = 1e-3
    with np.errstate(invalid="ignore", divide="ignore"):
        law = cd.CustomLayer(
            lambda w: 1e3 * np.log1p(w / h), derivative=lambda w: 1e3 / (h + w), compression_range=0.9 * h
        )
        run = cd.solve(two_blocks(law, load=5e3), method, start=1e-6)
    assert run.contact().compression == pytest.approx(-h * (1 - math.exp(-5)), rel=1e-9)


def test_energy_that_is_no_number_is_named():
    law = linear(energy=lambda w: np.where(w < -5e-5, math.nan, 0.5e5 * w**2))
    run = cd.solve(two_blocks(law), on_failure="return")  # w = −1e-4 under the load
    assert run.status == "diverged"
    assert "energy" in run.reason
    assert "'pad'" in run.reason


def test_energy_of_a_start_that_is_the_solution_is_looked_at():
    law = linear(energy=lambda w: np.where(w < -5e-5, math.nan, 0.5e5 * w**2))
    done = cd.solve(two_blocks(layer()))
    again = cd.solve(two_blocks(law), start=done, on_failure="return")
    assert again.status == "diverged"
    assert "energy" in again.reason


def test_coefficient_that_is_no_number_is_refused():
    scheme = cd.Scheme("mine", lambda law, z, before, x: np.where(x[0] > 2, np.nan, 1e5), "decomposed", "")
    with pytest.raises(ValueError, match="φ = nan"):
        cd.solve(two_blocks(cd.LinearLayer(1e5)), scheme)
    law = linear(derivative=lambda w: np.where(w < -5e-5, math.nan, 1e5))
    run = cd.solve(two_blocks(law), "newton", start=3e-5, on_failure="return")
    assert run.status == "diverged"
    assert "φ" in run.reason


def test_relaxation_that_is_no_number_is_refused():
    with pytest.raises(ValueError, match="gamma"):
        cd.solve(two_blocks(cd.LinearLayer(1e5)), "chord", gamma=lambda k: 0.6 if k < 2 else math.nan)


@pytest.mark.parametrize("criterion", ["residual", "change"])
@pytest.mark.parametrize(("residual", "change"), [(math.nan, 0.0), (0.0, math.nan), (math.inf, 0.0), (0.0, math.inf)])
def test_no_rule_is_met_by_what_is_no_number(criterion, residual, change):
    last = Record(1, 0.6, change, residual, 0.0, 1.0, 0.0, 1.0, 2, 0.0)
    rule = StoppingCriterion(1e-3, criterion, 10, 10)
    if criterion == "residual" and math.isfinite(residual):
        residual = change  # this rule does not ask for the change
    assert not rule.distance(residual, last) <= 1.0


def test_search_along_a_line_that_leaves_the_law():
    """F = −t − log(1 − t): its slope t/(1−t) − 1/2 … vanishes where 1/(1 − t) = 3/2; beyond 1 there is no energy."""
    slope = lambda t: 1 / (1 - t) - 1.5 if t < 1 else math.nan  # noqa: E731
    assert minimise_along(slope) == pytest.approx(1 / 3, rel=1e-3)  # the search's own accuracy
    scaled = lambda t: slope(t / 300)  # noqa: E731
    assert minimise_along(scaled) == pytest.approx(100, rel=1e-3)
    assert 0 < minimise_along(lambda t: -1.0 if t < 1e-3 else math.nan) <= 1e-3


@pytest.mark.parametrize("local_solver", ["condensed", "assembled", "multigrid", "auto"])
@pytest.mark.parametrize("method", ["auto", "chord", "newton-krylov"])
def test_contact_faces_held_on_both_sides(local_solver, method):
    """No unknowns are left at the contact: the pressure is that of the interference, p = k δ."""
    lower = cd.Body("lower", cd.rectangle((0, 0), (4, 1), (8, 4)), STEEL, supports=[cd.Fixed("top", "bottom")])
    upper = cd.Body(
        "upper", cd.rectangle((0, 1), (4, 2), (8, 4)), STEEL,
        supports=[cd.Fixed("bottom")], loads=[cd.Pressure("top", 10.0)],
    )  # fmt: skip
    scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.LinearLayer(1e5), gap=-1e-5)])
    solution = cd.solve(scene, method, local_solver=local_solver)
    assert solution.contact().pressure == pytest.approx(1.0, rel=1e-9)  # gaps are measured to 1e-16 of 1e-5
    assert solution.imbalance < 1e-12


def test_nothing_at_work():
    """No load, no contact, nothing prescribed: zero, converged, without a division by zero."""
    solution = cd.solve(two_blocks(cd.LinearLayer(1e5), gap=1.0, load=0.0))
    assert solution.converged
    assert solution.residual == solution.imbalance == 0.0


@pytest.mark.parametrize("method", ["auto", "chord", "anderson"])
def test_the_last_residual_is_in_the_history(method):
    run = cd.solve(two_blocks(cd.PowerLayer(4e-6, 1.1), gap=lambda x: 1e-5 * x[0] ** 2), method, tolerance=1e-8)
    assert run.history.residual[-1] <= 1e-8
    assert np.all(run.history.residual[:-1] > 1e-8)
    # Both are of the same iterate, one from the unknowns at the contact and one from all; rounding of sums.
    assert run.residual == pytest.approx(run.history.residual[-1], rel=1e-3, abs=1e-13)
    assert run.history.energy[-1] == run.energy
    assert run.history.contact[-1] == pytest.approx(run.contact().area, rel=1e-14)


def test_press_fit_is_in_balance():
    """Of a ring pressed onto a shaft every force balances itself: its resultant is rounding, not the measure."""
    shaft = cd.Body(
        "shaft", cd.rectangle((0.5, 0), (1, 1), (4, 8)), STEEL, kinematics="axisymmetric",
        supports=[cd.Symmetry("bottom")],
    )  # fmt: skip
    hub = cd.Body(
        "hub", cd.rectangle((1, 0), (2, 1), (8, 8)), STEEL, kinematics="axisymmetric", supports=[cd.Symmetry("bottom")]
    )
    contact = cd.Contact((shaft, "right"), (hub, "left"), cd.LinearLayer(1e7), gap=-1e-3)
    solution = cd.solve(cd.Scene([shaft, hub], [contact]))
    assert solution.contact().force > 1.0
    assert solution.imbalance < 1e-10
    loose = cd.solve(two_blocks(cd.PowerLayer(4e-6, 1.1)), "chord", max_iterations=1, on_failure="return")
    assert loose.imbalance > 1e-3  # what is not in balance shows


def footing(e: float, degree: int | None) -> cd.Scene:
    """A block 2 wide on a foundation, its load's resultant at x = e; the outermost default point lies at 0.989."""
    base = cd.Body(
        "ground", cd.rectangle((-3, -1), (3, 0), (30, 2), shape="quadrilateral"), cd.Isotropic(1e9, 0.0),
        supports=[cd.Fixed("bottom")],
    )  # fmt: skip
    load = cd.Traction("top", lambda x: np.array([0 * x[0], -50 * (1 + 3 * e * x[0])]))
    mesh = cd.rectangle((-1, 0), (1, 1), (40, 4), shape="quadrilateral")
    block = cd.Body("block", mesh, cd.Isotropic(1e9, 0.0), loads=[load])
    law = cd.LinearLayer(1e6)
    return cd.Scene([base, block], [cd.Contact((block, "bottom"), (base, "top"), law, quadrature_degree=degree)])


def test_load_beyond_the_outermost_integration_point():
    with pytest.raises(cd.NoEquilibriumError, match="quadrature_degree"):
        cd.solve(footing(0.995, None))
    solution = cd.solve(footing(0.995, 30))  # as the message says
    # p_max = 2 N / (3 (b/2 − e)) at the edge; the outermost point lies 1.7 % of the contact length inside of it.
    assert solution.contact().pressure.max() == pytest.approx(2 * 100 / (3 * 0.005), rel=0.05)
    with pytest.raises(cd.NoEquilibriumError) as beyond:
        cd.solve(footing(1.005, None))
    assert "quadrature_degree" not in str(beyond.value)


@pytest.mark.parametrize(("kinematics", "degree"), [("axisymmetric", 2), ("axisymmetric", 3), ("plane strain", 3)])
def test_multigrid_of_high_degree(kinematics, degree):
    """Newton's steps with multigrid arrive, with about the solves that a ring's plane section takes."""
    counts = []
    for kind in {kinematics, "plane strain"}:
        slide = [] if kind == "axisymmetric" else [cd.Symmetry("left")]
        parts = {"degree": degree, "kinematics": kind}
        lower = cd.Body(
            "lower", cd.rectangle((0.5, 0), (4.4, 0.5), (10, 10)), STEEL, supports=[*slide, cd.Symmetry("bottom")],
            **parts,
        )  # fmt: skip
        upper = cd.Body(
            "upper", cd.rectangle((0.5, 0.5), (4.4, 1.8), (10, 11)), STEEL, supports=slide,
            loads=[cd.Pressure("top", 10.0)], **parts,
        )  # fmt: skip
        scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.PowerLayer(4e-6, 1.1))])
        run = cd.solve(scene, local_solver="multigrid", max_iterations=10)
        assert run.contact().pressure == pytest.approx(10.0, rel=1e-6)  # uniform; the tolerance and what φ makes of it
        counts.append(run.history[-1].body_solves)
    assert max(counts) < 2 * min(counts)


def test_nearly_incompressible_with_multigrid():
    material = cd.Isotropic(2.1e5, 0.4999)
    lower = cd.Body(
        "lower", cd.box((0, 0, 0), (1, 1, 0.5), (3, 3, 2)), material, degree=2, supports=[cd.Fixed("bottom")]
    )
    upper = cd.Body(
        "upper", cd.box((0, 0, 0.5), (1, 1, 1.2), (3, 3, 2)), material, degree=2, loads=[cd.Pressure("top", 10.0)]
    )
    scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.PowerLayer(4e-6, 1.1))])
    run = cd.solve(scene, local_solver="multigrid", max_iterations=10)
    other = cd.solve(scene, local_solver="condensed")
    assert run.contact().pressure == pytest.approx(other.contact().pressure, rel=1e-6)
