"""Where Newton's methods start: undeformed, floating bodies moved together."""

from __future__ import annotations

import numpy as np
import pytest
import scenes

import contactdd as cd
from contactdd.system import start
from contactdd.system.ensemble import Ensemble

STEEL = cd.Isotropic(2.1e5, 0.3)


def pair(distance: float, supports: list[object], load: float = 10.0) -> cd.Scene:
    """A block that is held under one that is `supports`, so far above it."""
    lower = cd.Body("lower", cd.rectangle((0, 0), (2, 1), (4, 2)), STEEL, supports=[cd.Fixed("bottom")])
    mesh = cd.rectangle((0, 1 + distance), (2, 2 + distance), (4, 2))
    upper = cd.Body("upper", mesh, STEEL, supports=supports, loads=[cd.Pressure("top", load)] if load else [])
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), scenes.LAYER)])


def test_floating_bodies_are_pressed_together():
    scene = scenes.paper()
    ensemble = Ensemble(scene.local_problems("condensed"), scene.interfaces)
    state = start.rigidly_closed(ensemble)
    # 10 MPa on the whole contact: the law of the layer says how deep.
    assert state.gaps[0].min() == pytest.approx(-4e-6 * 10**1.1, rel=1e-12)
    assert np.abs(state.deformation).max() < 1e-14 * np.abs(state.unknowns).max()
    # Both move by as much, as nothing tells them apart.
    parts = zip(ensemble.problems, ensemble.split(state.unknowns), strict=True)
    below, above = (problem.traces[0].trace @ y for problem, y in parts)
    assert below == pytest.approx(above, rel=1e-12)


@pytest.mark.parametrize("distance", [0.3, 0.0, -0.01])
def test_only_what_floats_is_moved(distance):
    scene = pair(distance, [cd.Symmetry("left", "right")])
    ensemble = Ensemble(scene.local_problems("condensed"), scene.interfaces)
    state = start.rigidly_closed(ensemble)
    assert np.all(state.unknowns[ensemble.parts[0]] == 0.0)
    assert state.gaps[0] == pytest.approx(-4e-6 * 10**1.1, rel=1e-9)  # 1e-13 of the distance
    solution = cd.solve(scene)
    assert solution.contact().force == pytest.approx(20.0, rel=1e-9)
    assert solution.iterations <= 3


@pytest.mark.parametrize(
    ("supports", "load"),
    [
        ([cd.Fixed("top")], 0.0),
        ([cd.Displacement("top", (0.0, -0.1))], 0.0),
        ([cd.Symmetry("left", "right")], 0.0),  # nothing presses
        ([cd.Symmetry("left", "right"), cd.Spring("top", 10.0)], 10.0),
    ],
)
def test_what_is_held_or_not_pressed_stays(supports, load):
    scene = pair(0.05, supports, load)
    ensemble = Ensemble(scene.local_problems("condensed"), scene.interfaces)
    state = start.rigidly_closed(ensemble)
    assert np.all(state.unknowns == 0.0)


def columns(prescribed: float, tilt: float = 0.0) -> cd.Scene:
    """Three columns with layers of unlike stiffness between them; the upper end is moved by that much."""
    layers = [cd.LinearLayer(1e4), cd.LinearLayer(3e4)]
    bodies = []
    for i in range(3):
        mesh = cd.rectangle((0, i), (1, i + 1), (2, 2))
        supports = [cd.Symmetry("left")]
        if i == 0:
            supports.append(cd.Fixed("bottom"))
        if i == 2:
            supports.append(cd.Displacement("top", (None, lambda x: prescribed + tilt * x[0])))
        bodies.append(cd.Body(f"column {i}", mesh, STEEL, supports=supports))
    pairs = zip(bodies[:-1], bodies[1:], layers, strict=True)
    return cd.Scene(bodies, [cd.Contact((a, "top"), (b, "bottom"), layer) for a, b, layer in pairs])


@pytest.mark.parametrize("local_solver", ["condensed", "assembled"])
def test_what_is_moved_presses_evenly(local_solver):
    """Of rigid columns on linear layers the start is the equilibrium: springs in a row share the force."""
    scene = columns(-4e-3)
    state = start.rigidly_closed(Ensemble(scene.local_problems(local_solver), scene.interfaces))
    first, second = (z.mean() for z in state.gaps)
    assert first + second == pytest.approx(-4e-3, rel=1e-12)
    assert 1e4 * first == pytest.approx(3e4 * second, rel=1e-9)  # rounding; linear layers need no second look
    assert cd.solve(scene, local_solver=local_solver).iterations <= 3


def test_what_is_pulled_away_or_turned_is_carried_along():
    assert cd.solve(columns(1e-3)).contact().force == 0.0
    tilted = cd.solve(columns(-4e-3, tilt=1e-3))
    assert tilted.iterations <= 4
    assert tilted.imbalance < 1e-9
