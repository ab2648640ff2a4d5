"""Random scenes: what converges is right by equations written anew, and what should converge does.

`./run python3 tests/random_scenes.py --seed N` tells more of one of them; with `--count` it runs any number.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import random_scenes
from monolithic import Monolithic

import contactdd as cd

#: In which the scenes of KINDS, the methods and the local solvers all come.
SEEDS = range(60)


@pytest.mark.parametrize("seed", SEEDS)
def test_random_scene(seed):
    """Equilibrium of all bodies, gaps, the law, action = reaction, and a second method."""
    outcome = random_scenes.run(seed)
    assert not outcome.fault, f"seed {seed}: {outcome}"


def test_every_kind_is_among_them():
    trials = [random_scenes.trial(seed) for seed in SEEDS]
    assert len({made.kind for made, _, _ in trials}) >= 11
    assert {method for _, method, _ in trials} >= set(random_scenes.SURE)
    assert {solver for _, _, solver in trials} == {"auto", "condensed", "assembled", "multigrid"}


class Wrong:
    """A solution whose contact results are not quite those found."""

    def __init__(self, solution: cd.Solution, **factors: float) -> None:
        self._solution, self._factors = solution, factors

    def __getattr__(self, name: str):
        return getattr(self._solution, name)

    def contact(self, index: int, **options) -> cd.ContactResult:
        result = self._solution.contact(index, **options)
        return replace(result, **{name: factor * getattr(result, name) for name, factor in self._factors.items()})


@pytest.mark.parametrize(
    ("what", "names"),
    [
        ("pointwise_pressure", ("residual", "law")),
        ("weights", ("residual", "area", "reaction")),
        ("gap", ("gap",)),
        ("normal", ("residual", "reaction")),
    ],
)
@pytest.mark.parametrize("seed", [3, 5, 7])
def test_the_check_sees_a_millionth(seed, what, names):
    """A result that is off by 1e-6 in one thing alone is refused for the reasons that it should be."""
    made, _, _ = random_scenes.trial(seed)
    monolithic = Monolithic(made.scene, made.forms, made.laws, made.curved)
    solution = cd.solve(made.scene)
    assert not random_scenes.faults(monolithic.check(solution))
    found = monolithic.check(Wrong(solution, **{what: 1 + 1e-6}))
    assert all(name in random_scenes.faults(found) for name in names), found


def test_the_check_sees_another_stiffness():
    """A body softer by a millionth."""
    made, _, _ = random_scenes.trial(3)
    for form in made.forms.values():
        form.tensor = form.tensor * (1 - 1e-6)
    monolithic = Monolithic(made.scene, made.forms, made.laws, made.curved)
    assert "residual" in random_scenes.faults(monolithic.check(cd.solve(made.scene)))
    assert np.all([form.stiffness.shape[0] == form.body.dofs for form in made.forms.values()])
