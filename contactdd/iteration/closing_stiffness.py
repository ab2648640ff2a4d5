"""The normal stiffness of a contact: its force's derivative by the approach of its bodies, from the tangent (17)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..base.arrays import Floats
from ..base.ranks import Ranks
from ..scheme import SCHEMES
from ..system.ensemble import Ensemble, norm
from .step import find_step

#: The residual of the linear problem, relative to its right-hand side, that counts as solved: rounding of large scenes.
SOLVED = 1e-12


def closing_stiffness(ensemble: Ensemble, ranks: Ranks, gaps: Sequence[Floats], contact_index: int) -> float:
    """dF/dδ of a contact, given by its index: δ is a uniform reduction of its gap d, all loads are kept.

    With W = w χ g'(z) and C y = u_αn + u_βn the tangent gives (A + Cᵀ W C) dy = −Cᵀ W 1 dδ, dF = 1ᵀ W (1 dδ + C dy).
    """
    contacts = zip(ensemble.interfaces, gaps, strict=True)
    phi = {index: interface.layer.contact_derivative(z) for index, (interface, z) in enumerate(contacts)}
    weights = ensemble.weights * ensemble.at_all_points(phi)
    own = np.zeros(len(weights))
    own[ensemble.points[contact_index]] = 1.0
    rhs = -(ensemble.normal_approach.T @ (weights * own))
    if not np.any(rhs):
        return float(own @ weights)  # open, or nothing that could move
    step, left, before = find_step(SCHEMES["auto"], ensemble, ranks), rhs, np.inf
    y: Floats = np.zeros(len(rhs))
    # A direct solve is exact at once, Krylov's method comes closer until rounding ends that.
    while SOLVED * norm(rhs) < norm(left) < 0.5 * before:
        before = norm(left)
        y = y + ranks.agree(step.correct(phi, left, norm(rhs)))
        left = rhs - ensemble.tangent(phi, y)
    return float(own @ (weights * (own + ensemble.normal_approach @ y)))
