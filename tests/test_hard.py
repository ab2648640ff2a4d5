"""Hard scenes: `auto` arrives or says why it cannot, no method claims what is not so."""

from __future__ import annotations

import json

import hard_cases
import hard_scenes
import limits
import numpy as np
import pytest

import contactdd as cd

SOLVABLE = {case.name: case for case in hard_scenes.solvable()}
UNSOLVABLE = {case.name: case for case in hard_scenes.unsolvable()}
LAWLESS = {case.name: case for case in hard_scenes.lawless()}
#: Methods whose every step the energy watches over.
GLOBAL = ("auto", "newton-krylov", "newton", "newton-chord", "newton-kurchatov")


def run(case: hard_scenes.Case, method: str, **options) -> cd.Solution:
    start = case.start if case.before is None else cd.solve(case.before())
    options = {"local_solver": case.local_solver} | options
    return cd.solve(case.build(), method, start=start, on_failure="return", **options)


def test_there_are_enough_scenes():
    assert len(SOLVABLE) >= 90
    assert len(UNSOLVABLE) >= 14
    assert len(SOLVABLE | UNSOLVABLE | LAWLESS) == len(hard_scenes.all_cases())


@pytest.mark.parametrize("name", SOLVABLE)
def test_auto_arrives(name):
    """At the right place: a coupled solution found in another way, or a closed form."""
    case = SOLVABLE[name]
    solution = run(case, "auto", max_iterations=40)
    assert solution.converged, solution.reason
    assert solution.residual <= 1e-10
    exact = hard_cases.coupled_solution(case.build())
    assert hard_cases.error(solution, exact, case.pressure) < (case.error or hard_cases.LARGEST_ERROR)


@pytest.mark.parametrize("name", [n for n in SOLVABLE if n not in ("stack of 32", "stack of 64")])
def test_newton_krylov_arrives(name):
    """Every linear problem by independent solves of the bodies."""
    assert run(SOLVABLE[name], "newton-krylov", max_iterations=40).converged


@pytest.mark.parametrize("method", ["auto", "newton-krylov"])
def test_count_does_not_grow_with_the_number_of_bodies(method):
    few, many = (run(SOLVABLE[f"stack of {n}"], method) for n in (2, 64))
    assert many.iterations <= 2 * few.iterations
    # Solves of one body in one step: at most twice those in a stack of two.
    assert many.history.body_solves[-1] / 64 / many.iterations <= 2 * few.history.body_solves[-1] / 2 / few.iterations


@pytest.mark.parametrize(
    "name",
    [
        "E ratio 1e-06",
        "layer 1e+03 times as stiff",
        "a = 10",
        "random start",
        "heights 1:50",
        "a body between two others",
        "first step opens everything",
        "all contact lost at the end",
        "load divided by 1e4, warm start",
        "stack of 4",
        "settlement that reaches nothing",
        "whole scene turned by 0.1",
        "coating with 5 % left",
        "soft springs sideways, E/k = 1e6",
        "rigid cylinder without a mesh",
        "hard contact",
    ],
)
def test_no_method_claims_what_is_not_so(name):
    """All methods: what converged is at the coupled solution, what did not says so."""
    verdict = hard_cases.judge(hard_cases.study(SOLVABLE[name]))
    assert verdict == {"scenes": 1, "runs": len(hard_cases.METHODS), "false convergence": 0, "false refusal": 0,
                       "auto ends otherwise than it must": 0}  # fmt: skip


@pytest.mark.long
def test_demo(tmp_path):
    """The whole table."""
    hard_cases.main(["--out", str(tmp_path)])
    rows = json.loads((tmp_path / "summary.json").read_text())
    verdict = hard_cases.judge([hard_cases.Outcome(**row) for row in rows])
    scenes = len(hard_scenes.all_cases())
    assert (verdict.pop("scenes"), verdict.pop("runs")) == (scenes, scenes * len(hard_cases.METHODS))
    assert set(verdict.values()) == {0}
    assert (tmp_path / "methods.png").stat().st_size > 5000


@pytest.mark.long
def test_demo_of_limits(tmp_path):
    limits.main(["--out", str(tmp_path)])
    summary = json.loads((tmp_path / "summary.json").read_text())
    gammas, ratios = summary["gammas"], summary["ratios"]
    soft, hard = ratios.index(1e-4), ratios.index(1e4)
    for column in limits.METHODS:  # no method arrives beside a soft upper body, all do beside a stiff one
        assert not any(isinstance(count, int) for count in summary["by_ratio"][column][soft])
        assert isinstance(summary["by_ratio"][column][hard][gammas.index(0.6)], int)
        assert summary["by_ratio"][column][hard][gammas.index(1.0)] == limits.DIVERGED
        best = [min([c for c in row if isinstance(c, int)], default=limits.MOST) for row in summary["by_count"][column]]
        assert best[-1] == limits.MOST > best[0]  # more bodies, slower
    for row in summary["theory"]:
        assert row["measured"] == pytest.approx(row["predicted"], rel=5e-4)  # three digits
    assert all((tmp_path / name).stat().st_size > 5000 for name in ("moduli.png", "bodies.png"))


@pytest.mark.parametrize("name", UNSOLVABLE)
@pytest.mark.parametrize("method", hard_cases.METHODS)
def test_no_equilibrium_is_named(name, method):
    scheme, options = hard_cases.METHODS[method]
    with pytest.raises(cd.NoEquilibriumError) as caught:
        cd.solve(UNSOLVABLE[name].build(), scheme, **options)
    assert caught.value.body
    assert "translation" in caught.value.motion or "rotation" in caught.value.motion


@pytest.mark.parametrize("name", LAWLESS)
@pytest.mark.parametrize("method", hard_cases.METHODS)
def test_the_end_of_a_law_is_named(name, method):
    """Where the answer lies beyond what a law of the user's knows no method has one, and the law is said to be why."""
    scheme, options = hard_cases.METHODS[method]
    solution = run(LAWLESS[name], scheme, **options)
    assert solution.status == "diverged"
    assert "CustomLayer" in solution.reason


@pytest.mark.parametrize("name", UNSOLVABLE)
@pytest.mark.parametrize("method", ["one-point", "chord", "kurchatov", "anderson"])
def test_the_papers_rule_is_not_fooled(name, method):
    """A change of 1e-3 is soon reached where bodies drift away, or are out of balance by a thousandth."""
    solution = run(UNSOLVABLE[name], method, criterion="change", tolerance=1e-3, max_iterations=200)
    assert solution.status == "no equilibrium"


@pytest.mark.parametrize("gamma", [1e-3, 1e-6])
def test_small_steps_are_not_convergence(gamma):
    """With a tiny γ every change is below the tolerance, anywhere."""
    solution = run(SOLVABLE["stack of 2"], "chord", gamma=gamma, criterion="change", tolerance=1e-3, max_iterations=50)
    assert solution.status == "iteration limit"


@pytest.mark.parametrize("name", ["stack of 4", "load 1e-06 times", "wedge: a corner on a flat", "a = 0.5"])
@pytest.mark.parametrize("method", ["one-point", "chord", "kurchatov", "robin", "anderson"])
def test_a_small_change_is_near_the_solution(name, method):
    """What the paper's rule calls converged is within a hundred times its tolerance; slow modes: 40 times at most."""
    solution = run(SOLVABLE[name], method, gamma=0.6, criterion="change", tolerance=1e-3, max_iterations=300)
    if solution.converged:
        assert solution.residual < 2e-3 / 0.6 * 1.01
        assert hard_cases.error(solution, cd.solve(solution.scene)) < 0.1


@pytest.mark.parametrize(("method", "options"), [hard_cases.METHODS[m] for m in hard_cases.METHODS if "γ" in m])
def test_searched_gamma_survives_an_opening_contact(method, options):
    """Started apart, with nothing held at all, the plain methods diverge and the searched ones go on."""
    case = SOLVABLE["start 1 cm apart"]
    assert run(case, method, max_iterations=300).status == "diverged"
    searched = run(case, method, tolerance=1e-3, **options)
    assert searched.converged
    assert "soft Robin term" in searched.history[0].note


@pytest.mark.parametrize("name", ["E ratio 1e-06", "start 1 cm apart", "first step opens everything", "stack of 16"])
def test_anderson_restarts_and_arrives(name):
    """Where mixing the past would raise the energy the past is forgotten."""
    solution = run(SOLVABLE[name], "anderson", max_iterations=100)
    assert solution.converged
    assert any("restarted" in record.note for record in solution.history)
    if SOLVABLE[name].start == -1.0:
        assert "soft Robin term" in solution.history[0].note


def test_first_step_opens_everything():
    """The scene is what it says: after one full Newton step no contact is closed."""
    case = SOLVABLE["first step opens everything"]
    one = run(case, "newton", gamma=1.0, max_iterations=1)
    assert one.scene.interfaces[0].gap.min() - 2 * case.start < 0  # closed at the start
    assert one.history.contact[0] == one.contact().area == 0


def test_contact_that_is_lost():
    solution = run(SOLVABLE["all contact lost at the end"], "auto")
    assert solution.scene.interfaces[0].gap.min() < 0  # it was closed before the load
    assert solution.contact().area == 0
    assert solution.contact().force == 0


def test_start_as_a_function_of_the_coordinates():
    scene = hard_scenes.two_blocks()
    given = cd.solve(scene, "chord", start=lambda x: 1e-4 * x[0], max_iterations=1, on_failure="return")
    flat = cd.solve(scene, "chord", start=1e-4, max_iterations=1, on_failure="return")
    assert given.history.contact[0] != flat.history.contact[0] or given.history.energy[0] != flat.history.energy[0]
    with pytest.raises(ValueError, match="start"):
        cd.solve(scene, start=lambda x: np.full_like(x[0], np.nan))
    with pytest.raises(ValueError, match="start"):
        cd.solve(scene, start=lambda x: np.zeros(3))


def test_elements_against_locking():
    """Linear triangles cut along one diagonal lock as ν → ½; crossed or quadratic ones do not."""
    one, crossed, quadratic = hard_cases.locking()
    worst, mild = "nu = 0.4999", "nu = 0.3"
    assert one[worst] > 5 * one[mild]
    assert crossed[worst] < 2 * crossed[mild]
    assert quadratic[worst] < 0.5 * crossed[worst]
