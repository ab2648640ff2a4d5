"""The linear problem of the tangent (17): what small forces do to a solution."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..base.arrays import Floats, norm
from ..base.ranks import Ranks
from ..scheme import SCHEMES
from ..system.ensemble import Ensemble
from .step import find_step

#: The residual of the linear problem, relative to its right-hand side, that counts as solved: rounding of large scenes.
SOLVED = 1e-12


def contact_stiffnesses(ensemble: Ensemble, gaps: Sequence[Floats]) -> dict[int, Floats]:
    """χ g'(z) at the points of every interface."""
    contacts = zip(ensemble.interfaces, gaps, strict=True)
    return {index: interface.layer.contact_derivative(z) for index, (interface, z) in enumerate(contacts)}


def tangent_response(ensemble: Ensemble, ranks: Ranks, phi: Mapping[int, Floats], forces: Floats) -> Floats:
    """y with (A + Cᵀ W C) y = forces, W = w φ the contacts' stiffness at their points, C y = u_αn + u_βn."""
    step, left, before = find_step(SCHEMES["auto"], ensemble, ranks), forces, np.inf
    y: Floats = np.zeros(len(forces))
    # A direct solve is exact at once, Krylov's method comes closer until rounding ends that.
    while SOLVED * norm(forces) < norm(left) < 0.5 * before:
        before = norm(left)
        y = y + ranks.agree(step.correct(phi, left, norm(forces)))
        left = forces - ensemble.tangent(phi, y)
    return y
