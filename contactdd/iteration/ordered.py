"""The decomposed step with the bodies in an order: each is solved with the displacements of those before it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from ..base.arrays import Floats
from ..base.checks import listed
from ..base.ranks import Ranks
from ..system.ensemble import Ensemble
from ..system.state import Phi


class Ordered:
    """One sweep over groups of bodies: block Gauss–Seidel for the coupled problem with φ (multiplicative Schwarz).

    Bodies of one group are solved at once, as all are in the parallel methods (block Jacobi, additive Schwarz).
    """

    def __init__(self, ensemble: Ensemble, ranks: Ranks, groups: Sequence[Sequence[str]]) -> None:
        self._ensemble, self._ranks = ensemble, ranks
        self.body_solves, self.note = 0, ""
        names = [problem.name for problem in ensemble.problems]
        if sorted(name for group in groups for name in group) != sorted(names):
            raise ValueError(f"order = {[list(group) for group in groups]}: expected each of {listed(names)} once")
        self._groups = [[names.index(name) for name in group] for group in groups]

    def correct(self, phi: Phi, residual: Floats, scale: float) -> Floats:
        correction = np.zeros_like(residual)
        for group in self._groups:
            forces = self._ensemble.split(residual - self._ensemble.tangent(phi, correction))
            parts = self._ranks.each(partial(self._solved, phi, forces, scale, group))
            self.body_solves += len(group)
            correction = correction + np.concatenate(parts)
        return correction

    def _solved(self, phi: Phi, forces: Sequence[Floats], scale: float, group: Sequence[int], index: int) -> Floats:
        """The correction of one body, nothing if it is not in the group."""
        problem = self._ensemble.problems[index]
        return problem.correct(phi, forces[index], scale) if index in group else np.zeros_like(forces[index])
