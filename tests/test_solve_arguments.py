"""Arguments of `solve` that no run can be made of are refused in words, before anything is assembled."""

from __future__ import annotations

import numpy as np
import pytest
import scenes

import contactdd as cd

STEEL = cd.Isotropic(2.1e5, 0.3)


@pytest.fixture(scope="module")
def scene() -> cd.Scene:
    return scenes.paper("vertex")


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"max_iterations": None}, TypeError, "max_iterations = None"),
        ({"max_iterations": np.inf}, ValueError, "max_iterations = inf"),
        ({"max_iterations": 2.5}, ValueError, "max_iterations = 2.5"),
        ({"gamma": np.array(0.6)}, TypeError, "gamma = array\\(0.6\\): expected a number"),
        ({"gamma": []}, ValueError, "gamma = \\[\\]"),
        ({"gamma": "much"}, ValueError, "gamma = 'much'"),
        ({"callback": 5}, TypeError, "callback = 5"),
        ({"time_limit": -1.0}, ValueError, "time_limit = -1.0"),
        ({"start": "x"}, TypeError, "start = 'x'"),
        ({"previous": 0.0}, ValueError, "previous = 0.0: expected a start"),
        ({"resume": True}, ValueError, "resume = True: expected a checkpoint"),
        ({"checkpoint": 5}, TypeError, "checkpoint = 5"),
        ({"checkpoint": "/nowhere/state.npz"}, ValueError, "checkpoint = '/nowhere/state.npz'"),
    ],
)
def test_refused(options, error, message):
    fresh = scenes.paper("vertex")
    with pytest.raises(error, match=message):
        cd.solve(fresh, **options)
    assert "interfaces" not in vars(fresh)  # nothing was made yet


def test_something_else_than_a_scene():
    with pytest.raises(TypeError, match="scene = 5"):
        cd.solve(5)


def test_start_from_a_solution_on_other_cells(scene):
    with pytest.raises(ValueError, match="start = a solution: its body 'lower' has"):
        cd.solve(scenes.paper("vertex", refine=2), start=cd.solve(scene))


@pytest.mark.parametrize(("method", "degree", "nu"), [("auto", 4, 0.49999), ("anderson", 6, 0.4999999)])
def test_what_rounding_makes_indefinite_ends_in_a_status(method, degree, nu):
    """A sheet a thousand times as long as thick that is nearly incompressible: no digit of its stiffness is left."""
    mesh = cd.rectangle((0, 0), (4, 2e-3), (4, 2))
    sides = [cd.Symmetry("left", "right")]
    lower = cd.Body(
        "sheet", mesh, cd.Isotropic(2.1e5, nu), supports=sides, loads=[cd.Pressure("bottom", 10.0)], degree=degree
    )
    upper = cd.Body(
        "block",
        cd.rectangle((0, 2e-3), (4, 1.002), (3, 2)),
        STEEL,
        supports=sides,
        loads=[cd.Pressure("top", 10.0)],
        degree=2,
    )
    contact = cd.Contact((lower, "top"), (upper, "bottom"), scenes.LAYER, gap=lambda x: 1e-4 * np.cos(x[0]))
    solution = cd.solve(cd.Scene([lower, upper], [contact]), method, on_failure="return", max_iterations=300)
    assert solution.status == "stalled" or solution.residual < 1e-6
    if solution.status == "stalled":
        assert "in iteration" in solution.reason
