"""The coupled linear system: its ways of assembly agree, its free motions are its null space."""

from __future__ import annotations

import numpy as np
import pytest

import contactdd as cd
from contactdd import coupled
from contactdd.coupled import CoupledSystem
from contactdd.errors import LooseBodyError
from contactdd.line_search import minimise_along
from contactdd.rigid import pivots

STEEL = cd.Isotropic(2.1e5, 0.3)


def stack(lower: list, upper: list) -> cd.Scene:
    """Two blocks with the given supports, one on the other."""
    meshes = cd.rectangle((0, 0), (3, 1), (4, 2)), cd.rectangle((0, 1), (3, 2), (4, 2), diagonal="left")
    bodies = [
        cd.Body(name, mesh, STEEL, supports=supports)
        for name, mesh, supports in zip(("lower", "upper"), meshes, (lower, upper), strict=True)
    ]
    return cd.Scene(bodies, [cd.Contact((bodies[0], "top"), (bodies[1], "bottom"), cd.LinearLayer(1e5))])


def matrix(system: CoupledSystem, phi: dict) -> np.ndarray:
    return np.column_stack([system.apply(phi, column) for column in np.eye(len(system.rigid.modes))])


@pytest.mark.parametrize("way", ["full product", "sparse product", "sparse factor", "all unknowns"])
def test_ways_of_assembly(way, monkeypatch):
    """The correction solves the system that `apply` multiplies with, however the contact's term is found."""
    if way == "sparse product":
        monkeypatch.setattr(coupled, "LARGEST_PRODUCT", 0)
    if way == "sparse factor":
        monkeypatch.setattr(coupled, "LARGEST_DENSE", 0)
    scene = stack([cd.Fixed("bottom")], [cd.Symmetry("left")])
    problems = scene.subproblems("assembled" if way == "all unknowns" else "condensed")
    system = CoupledSystem(problems, scene.interfaces)
    assert isinstance(system._sums[0], np.ndarray) == (way == "full product")
    random = np.random.default_rng(1)
    phi = {0: 1e5 * random.random(len(scene.interfaces[0].weights))}
    residuals = [random.random(problem.size) for problem in problems]
    for _ in range(2):  # nothing of the first φ is left in the second
        found = np.concatenate(system.correct(phi, residuals, 1.0))
        expected = np.concatenate(residuals)
        assert system.apply(phi, found) == pytest.approx(expected, abs=1e-9)
        phi = {0: phi[0][::-1]}


SUPPORTS = {
    "held": ([cd.Fixed("bottom")], [cd.Fixed("top")], 0, 0),
    "one floats": ([cd.Fixed("bottom")], [cd.Symmetry("left", "right")], 1, 0),
    "both float": ([cd.Symmetry("left")], [cd.Symmetry("left")], 2, 1),
    "one may slide": ([cd.Fixed("bottom")], [], 3, 1),
    "nothing holds": ([], [], 6, 4),
    "a spring": ([cd.Symmetry("left"), cd.Spring("bottom", 10.0)], [cd.Symmetry("left")], 1, 0),
    "a soft spring": ([cd.Symmetry("left"), cd.Spring("bottom", 1e-4)], [cd.Symmetry("left")], 1, 0),
}


@pytest.mark.parametrize("supports", SUPPORTS)
def test_free_motions_are_the_null_space(supports):
    lower, upper, open_, closed = SUPPORTS[supports]
    scene = stack(lower, upper)
    system = CoupledSystem(scene.subproblems("condensed"), scene.interfaces)
    rigid, ones = system.rigid, np.ones(len(scene.interfaces[0].weights))
    for phi, count in ((0.0 * ones, open_), (1e5 * ones, closed), (1e9 * ones, closed)):
        free = rigid.free({0: phi})
        assert free.shape[1] == count
        assert free.T @ free == pytest.approx(np.eye(count), abs=1e-12)
        assert np.abs(matrix(system, {0: phi}) @ rigid.modes @ free).max(initial=0.0) <= 1e-10 * rigid.largest
        ground = pivots(rigid.modes @ free)
        held = matrix(system, {0: phi})
        held[ground, ground] += rigid.largest
        assert np.linalg.eigvalsh(held)[0] > 0.0


def test_a_body_that_turns_about_the_only_closed_point():
    """A pressure on one point holds a body there, and not against turning: found though most motions are held."""
    scene = stack([cd.Fixed("bottom")], [])
    system = CoupledSystem(scene.subproblems("condensed"), scene.interfaces)
    phi = np.zeros(len(scene.interfaces[0].weights))
    phi[3] = 1e5
    free = system.rigid.free({0: phi})
    assert free.shape[1] == 2
    assert np.abs(system._sums[0][3] @ system.rigid.modes @ free).max() < 1e-12
    forces = system.rigid.modes @ free[:, 0]
    with pytest.raises(LooseBodyError, match="upper"):
        system.rigid.ground({0: phi}, forces, 1.0)


@pytest.mark.parametrize("zero", [1e-3, 0.3, 1.0, 5.0, 700.0])
def test_line_search_finds_the_zero_and_asks_once(zero):
    asked = []

    def slope(t: float) -> float:
        asked.append(t)
        return (t - zero) ** 3 + 0.1 * (t - zero)

    assert minimise_along(slope) == pytest.approx(zero, rel=2e-3)
    assert len(set(asked)) == len(asked)


def test_line_search_that_never_turns():
    assert minimise_along(lambda t: -1.0, largest=64.0) == 64.0
    assert minimise_along(lambda t: t) == 1.0
