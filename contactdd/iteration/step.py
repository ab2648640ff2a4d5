"""The linear problems of one iteration: apart for every body, coupled and solved directly, or coupled and solved by a
Krylov method whose every step solves the bodies apart. `find_step` chooses among them.
"""

from __future__ import annotations

from typing import Protocol

from ..base.arrays import Floats
from ..base.ranks import Ranks
from ..local.spectral import SpectralProblem
from ..scheme import Scheme
from ..system.ensemble import Ensemble
from ..system.state import Phi
from .coupled import CoupledSystem
from .decomposed import Decomposed
from .krylov import Krylov

#: "auto" factors the coupled matrix if it has at most LARGEST_DIRECT² entries, counting one dense block per body.
LARGEST_DIRECT = 6000


class Step(Protocol):
    """One kind of linear problem.

    body_solves: the number of solves of single bodies so far; note: the reason for this kind, where it was chosen.
    """

    body_solves: int
    note: str

    def correct(self, phi: Phi, residual: Floats, scale: float) -> Floats:
        """The correction of the unknowns of all bodies.

        phi: the coefficient at the points of each interface; residual: −F₁'; scale: the size of the forces at work.
        Raises LooseBodyError where forces do work on a free motion.
        """
        ...


def find_step(scheme: Scheme, ensemble: Ensemble, ranks: Ranks) -> Step:
    """The kind of linear problem of a scheme; of "auto" the one that suits the scene."""
    problems = ensemble.problems
    if scheme.order is not None:
        from .ordered import Ordered

        return Ordered(ensemble, ranks, scheme.groups)
    if scheme.step == "decomposed":
        return Decomposed(ensemble, ranks)
    if scheme.step == "auto" and any(isinstance(problem, SpectralProblem) for problem in problems):
        from .pressures import Pressures, surface_of

        surface = surface_of(ensemble)
        if surface is not None:
            return Pressures(ensemble, surface, f"auto: Newton in {len(ensemble.weights)} pressures")
    entries = sum(problem.size**2 for problem in problems)
    small = entries <= LARGEST_DIRECT**2 and not any(problem.factor_free for problem in problems)
    if scheme.step == "direct" or (scheme.step == "auto" and small):
        note = f"auto: coupled Newton, {ensemble.size} unknowns factored" if scheme.step == "auto" else ""
        return CoupledSystem(ensemble, note)
    note = f"auto: Newton with Krylov steps, {ensemble.size} unknowns" if scheme.step == "auto" else ""
    return Krylov(ensemble, ranks, note)
