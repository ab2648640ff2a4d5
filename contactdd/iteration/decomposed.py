"""The decomposed step (22): every body is solved on its own."""

from __future__ import annotations

import numpy as np

from ..base.arrays import Floats
from ..base.ranks import Ranks
from ..system.ensemble import Ensemble
from ..system.state import Phi


class Decomposed:
    """Every body on its own, eq. (22): nothing but φ and g⁻ at the contacts passes between them."""

    def __init__(self, ensemble: Ensemble, ranks: Ranks) -> None:
        self._ensemble, self._ranks = ensemble, ranks
        self.body_solves, self.note = 0, ""

    def correct(self, phi: Phi, residual: Floats, scale: float) -> Floats:
        problems, forces = self._ensemble.problems, self._ensemble.split(residual)
        self.body_solves += len(problems)
        return np.concatenate(self._ranks.each(lambda i: problems[i].correct(self._of(i, phi), forces[i], scale)))

    def _of(self, body_index: int, phi: Phi) -> Phi:
        """The coefficient that a body sees, where the two bodies of a contact have rows of their own."""
        if all(values.ndim == 1 for values in phi.values()):
            return phi
        return {index: self._row(index, values, body_index) for index, values in phi.items()}

    def _row(self, index: int, values: Floats, body_index: int) -> Floats:
        """The row (points,) of a body; of a contact that it has no part in any will do."""
        second = self._ensemble.interfaces[index].sides[1].body == body_index
        return values if values.ndim == 1 else values[int(second)]
