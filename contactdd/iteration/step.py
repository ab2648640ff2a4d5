"""The linear problems of one iteration: apart for every body, coupled and solved directly, or coupled and solved by a
Krylov method whose every step solves the bodies apart. `find_step` chooses among them.
"""

from __future__ import annotations

from typing import Protocol

from ..base.arrays import Floats
from ..base.ranks import Ranks
from ..scheme import Scheme
from ..system.ensemble import Ensemble
from ..system.state import Phi
from .coupled import CoupledSystem
from .decomposed import Decomposed
from .krylov import Krylov

#: Contact unknowns of a body up to which "auto" factors the coupled system, or as many in more bodies as make no more
#: entries: those of one body are all coupled, those of different ones only across their contacts.
LARGEST_DIRECT = 6000


class Step(Protocol):
    """One kind of linear problem.

    body_solves: how many solves of single bodies there have been; note: why this kind, where it was left open.
    """

    body_solves: int
    note: str

    def correct(self, phi: Phi, residual: Floats, scale: float) -> Floats:
        """The correction of the unknowns of all bodies.

        phi: the coefficient at the points of each interface; residual: −F₁'; scale: the size of the forces at work.
        Raises LooseBodyError where a motion is free on which forces do work.
        """
        ...


def find_step(scheme: Scheme, ensemble: Ensemble, ranks: Ranks) -> Step:
    """The kind of linear problem that the scheme asks for, or the one that suits the scene where it leaves it open."""
    problems = ensemble.problems
    if scheme.step == "decomposed":
        return Decomposed(ensemble, ranks)
    entries = sum(problem.size**2 for problem in problems)
    small = entries <= LARGEST_DIRECT**2 and not any(problem.factor_free for problem in problems)
    if scheme.step == "direct" or (scheme.step == "auto" and small):
        note = f"auto: coupled Newton, {ensemble.size} unknowns factored" if scheme.step == "auto" else ""
        return CoupledSystem(ensemble, note)
    note = f"auto: Newton with Krylov steps, {ensemble.size} unknowns" if scheme.step == "auto" else ""
    return Krylov(ensemble, ranks, note)
