"""Load programmes: a parameter runs, matrices are kept, every step is the solve that it would be on its own."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import LAYER, STEEL, block, groove, stack

import contactdd as cd
from contactdd.local import assembled

NEWTON = {"method": "newton", "gamma": "search", "tolerance": 1e-11}
# Both runs end at residuals of 1e-11; the layer is stiffer than the bodies, but by less than a hundred.
SAME = 1e-8


def scene(load=10.0, gap=groove, approach=None):
    """The paper's groove on a coarse grid; pressed by `load`, or by moving the top face by −`approach`."""
    top = [] if approach is None else [cd.Displacement("top", (None, approach))]
    loads = [cd.Pressure("top", load)] if approach is None else []
    lower = block("lower", 0, (16, 4), supports=[cd.Symmetry("bottom")])
    upper = block("upper", 1, (16, 4), cd.Isotropic(7e4, 0.2), supports=top, loads=loads)
    return stack([lower, upper], gap=gap)


def differ(found, expected):
    """The largest relative difference of two solutions' pressures, displacements and energies."""
    pairs = [(found.contact().pressure, expected.contact().pressure), (found.energy, expected.energy)]
    pairs += [(found.contact(degree=9).gap, expected.contact(degree=9).gap)]
    pairs += [(found.displacement(b).x.array, expected.displacement(b).x.array) for b in ("lower", "upper")]
    pairs += [(found.forces("lower")["supports"][1], expected.forces("lower")["supports"][1])]
    return max(float(np.abs(a - b).max() / np.abs(b).max()) for a, b in (map(np.atleast_1d, pair) for pair in pairs))


PROGRAMMES = {
    "load": (lambda q: scene(load=q), lambda q: scene(load=q), [1.0, 5.0, 20.0, 80.0, 3.0]),
    "approach": (lambda d: scene(approach=d), lambda d: scene(approach=d), [-1e-4, -5e-4, -2e-4]),
    "gap": (lambda g: scene(gap=g), lambda g: scene(gap=g), [0.0, 1e-4, -1e-4]),
    "depth": (
        lambda s: scene(gap=s.field(lambda s, x: s * groove(x))),
        lambda s: scene(gap=lambda x: s * groove(x)),
        [0.0, 0.5, 2.0],
    ),
    "moving load": (
        lambda s: scene(load=s.field(lambda s, x: 10 * np.exp(-((x[0] - s) ** 2)))),
        lambda s: scene(load=lambda x: 10 * np.exp(-((x[0] - s) ** 2))),
        [0.0, 2.0, 4.0],
    ),
}


@pytest.mark.parametrize("local_solver", ["condensed", "assembled"])
@pytest.mark.parametrize("name", PROGRAMMES)
def test_every_step_is_the_solve_on_its_own(name, local_solver):
    follow, fixed, values = PROGRAMMES[name]
    parameter = cd.Parameter(values[-1])
    path = cd.programme(follow(parameter), parameter, values, local_solver=local_solver, **NEWTON)
    assert path.converged
    assert path.values == values
    for value, found in zip(values, path.solutions, strict=True):
        assert differ(found, cd.solve(fixed(value), local_solver=local_solver, **NEWTON)) < SAME


def test_decomposed_steps_are_the_same_too():
    q = cd.Parameter(0.0)
    path = cd.programme(scene(load=q), q, [2.0, 10.0, 40.0], method="chord", tolerance=1e-10)
    for value, found in zip(path.values, path.solutions, strict=True):
        assert differ(found, cd.solve(scene(load=value), **NEWTON)) < 1e-7  # residuals of 1e-10


def test_matrices_are_kept_and_a_warm_start_is_one(monkeypatch):
    q = cd.Parameter(10.0)
    of = scene(load=q)
    cold = cd.solve(of, "chord")
    before = [(p.stiffness, p.dofs.stiffness.full, p.rigid) for p in of.local_problems("condensed")]
    monkeypatch.setattr(assembled, "Factor", None)  # nothing may be factored again
    path = cd.programme(of, q, [10.05, 10.1], start=cold, method="chord")
    after = [(p.stiffness, p.dofs.stiffness.full, p.rigid) for p in of.local_problems("condensed")]
    assert all(a is b for old, new in zip(before, after, strict=True) for a, b in zip(old, new, strict=True))
    # The steps are 200 times smaller than the load, the rate is the same: ln 200 / ln(1e8) of the iterations less.
    assert all(step.iterations < 0.85 * cold.iterations for step in path.solutions)


def test_solving_after_a_change_needs_nothing_else():
    q = cd.Parameter(10.0)
    of = scene(load=q)
    first = cd.solve(of, **NEWTON)
    q.value = 20.0
    assert differ(cd.solve(of, **NEWTON), cd.solve(scene(load=20.0), **NEWTON)) < SAME
    # The solution found before is still that of its own load.
    assert differ(first, cd.solve(scene(load=10.0), **NEWTON)) < SAME


def test_a_function_changed_by_hand_is_read_on_refresh():
    depth = {"scale": 1.0}
    of = scene(gap=lambda x: depth["scale"] * groove(x))
    cd.solve(of, **NEWTON)
    depth["scale"] = 0.5
    of.refresh()
    assert differ(cd.solve(of, **NEWTON), cd.solve(scene(gap=lambda x: 0.5 * groove(x)), **NEWTON)) < SAME


def test_vector_parameter():
    force = cd.Parameter([0.0, -1.0])
    of = scene()
    upper = cd.Body(
        "upper",
        of.bodies[1].mesh,
        STEEL,
        supports=[cd.Symmetry("left", "right")],
        loads=[cd.Resultant("top", force)],
    )
    of = cd.Scene([of.bodies[0], upper], [cd.Contact((of.bodies[0], "top"), (upper, "bottom"), LAYER)])
    path = cd.programme(of, force, [(0.0, -8.0), (0.0, -20.0)], record={"force": lambda s: s.contact().force}, **NEWTON)
    assert path.records["force"] == pytest.approx([8.0, 20.0], rel=1e-9)  # forces balance to the residual


def test_records_are_arrays_and_solutions_need_not_be_kept():
    q = cd.Parameter(1.0)
    path = cd.programme(
        scene(load=q),
        q,
        np.array([1.0, 2.0, 4.0]),
        record={"pressure": lambda s: s.contact().pressure, "area": lambda s: s.contact().area},
        keep_solutions=False,
        **NEWTON,
    )
    assert path.solutions == []
    assert len(path) == 3
    assert path.records["pressure"].shape == (3, 32)
    assert np.all(np.diff(path.records["area"]) >= 0)
    assert "3 steps: converged" in repr(path)


def test_no_load_leaves_nothing_to_start_from():
    """At zero load the contact is open and holds nothing; the next step has to find contact again."""
    q = cd.Parameter(1.0)
    path = cd.programme(scene(load=q, gap=0.0), q, [5.0, 0.0, 5.0], record={"p": lambda s: s.contact().force}, **NEWTON)
    assert path.records["p"] == pytest.approx([20.0, 0.0, 20.0], abs=1e-7)  # residuals of 1e-11 of the loads


def test_a_step_that_fails_keeps_the_steps_before():
    q = cd.Parameter(1.0)
    values = [2.0, 1.0, -1.0, 3.0]  # the third pulls the upper body off
    path = cd.programme(
        scene(load=q), q, values, record={"f": lambda s: s.contact().force}, on_failure="return", **NEWTON
    )
    assert path.values == [2.0, 1.0]
    assert path.status == "no equilibrium"
    assert not path.converged
    assert path.reason.startswith("step 3 of 4, value -1.0: the loads move body 'upper' for ever")
    assert path.failed.status == "no equilibrium"
    assert path.records["f"] == pytest.approx([8.0, 4.0], rel=1e-9)
    with pytest.raises(cd.StepFailedError, match="step 3 of 4") as raised:
        cd.programme(scene(load=q), q, values, **NEWTON)
    assert len(raised.value.path.solutions) == 2


def later_step(parameter, value):
    """Stops a solve after its first iteration once the parameter has reached a value."""
    return {"callback": lambda record: parameter.value >= value}


@pytest.mark.parametrize(
    ("stop", "done"), [(lambda q: later_step(q, 10.0), [5.0]), (lambda q: {"time_limit": 1e-9}, [])]
)
def test_a_step_that_is_stopped_ends_the_path(stop, done):
    """Its last state is far from equilibrium and must not pass for the solution at its value."""
    q = cd.Parameter(1.0)
    options = {"record": {"f": lambda s: s.contact().force}, **NEWTON, **stop(q)}
    path = cd.programme(scene(load=q), q, [5.0, 10.0, 20.0], on_failure="return", **options)
    assert not path.converged
    assert path.status == "stopped"
    assert path.reason == f"step {len(done) + 1} of 3, value {q.value}: as asked in iteration 1"
    assert path.values == done
    assert path.records["f"] == pytest.approx([4 * load for load in done], rel=1e-9)  # forces balance to the residual
    assert path.failed.status == "stopped"
    with pytest.raises(cd.StepFailedError, match=f"stopped: step {len(done) + 1} of 3"):
        cd.programme(scene(load=q), q, [5.0, 10.0, 20.0], **options)


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: cd.programme(scene(), 3.0, [1.0]), TypeError, "parameter = 3.0: expected a cd.Parameter"),
        (lambda: cd.programme(scene(), cd.Parameter(1.0), [1.0]), ValueError, "no load, support or gap .* follows it"),
        (lambda: cd.programme(scene(q := cd.Parameter(1.0)), q, [np.nan]), ValueError, "value = nan"),
        (lambda: cd.programme(scene(q := cd.Parameter(1.0)), q, [1.0], on_failure="stop"), ValueError, "on_failure"),
        (lambda: cd.programme(scene(q := cd.Parameter(1.0)), q, [[1.0, 2.0]]), ValueError, "pressure = .*shape"),
    ],
)
def test_wrong_programmes_are_refused(make, error, message):
    with pytest.raises(error, match=message):
        make()


def test_docstring_examples():
    import doctest

    from contactdd import parameter

    assert doctest.testmod(parameter).failed == 0
