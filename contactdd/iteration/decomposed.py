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
        return np.concatenate(self._ranks.each(lambda i: problems[i].correct(phi, forces[i], scale)))
