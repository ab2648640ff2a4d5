"""The influence of forces on contact pressures: the adjoint problem of the tangent (17), which is symmetric."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..base.arrays import Floats
from ..base.ranks import Ranks
from ..system.ensemble import Ensemble
from .tangent import contact_stiffnesses, tangent_response


def influence(ensemble: Ensemble, ranks: Ranks, gaps: Sequence[Floats], factors: Sequence[Floats]) -> list[Floats]:
    """The displacements z (dofs,) of every body by which forces F change Σ ∫ f p: by F·z.

    factors: f (points,) at every interface. With W = w χ g'(z) pressures change by W C dy, (A + Cᵀ W C) dy = F: the
    tangent is symmetric, and (A + Cᵀ W C) z = Cᵀ W f.
    """
    phi = contact_stiffnesses(ensemble, gaps)
    weighted = ensemble.weights * ensemble.at_all_points(phi) * np.concatenate(factors)
    y = tangent_response(ensemble, ranks, phi, ensemble.normal_approach.T @ weighted)

    def of(body_index: int) -> Floats:
        """Without the loads and what supports prescribe, which do not belong to z."""
        problem, own = ensemble.problems[body_index], y[ensemble.parts[body_index]]
        moved: Floats = problem.displacement(own) - problem.displacement(np.zeros(len(own)))
        return moved

    return ranks.each(of)
