"""The normal stiffness of a contact: its force's derivative by the approach of its bodies, from the tangent (17)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..base.arrays import Floats
from ..base.ranks import Ranks
from ..system.ensemble import Ensemble
from .tangent import contact_stiffnesses, tangent_response


def closing_stiffness(ensemble: Ensemble, ranks: Ranks, gaps: Sequence[Floats], contact_index: int) -> float:
    """dF/dδ of a contact, given by its index: δ is a uniform reduction of its gap d, all loads are kept.

    With W = w χ g'(z) and C y = u_αn + u_βn the tangent gives (A + Cᵀ W C) dy = −Cᵀ W 1 dδ, dF = 1ᵀ W (1 dδ + C dy).
    """
    phi = contact_stiffnesses(ensemble, gaps)
    weights = ensemble.weights * ensemble.at_all_points(phi)
    own = np.zeros(len(weights))
    own[ensemble.points[contact_index]] = 1.0
    rhs = -(ensemble.normal_approach.T @ (weights * own))
    if not np.any(rhs):
        return float(own @ weights)  # open, or nothing that could move
    y = tangent_response(ensemble, ranks, phi, rhs)
    return float(own @ (weights * (own + ensemble.normal_approach @ y)))
