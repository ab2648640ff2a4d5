"""Whether a scene can be in equilibrium at all.

F₁ is convex, so it has no minimum exactly where some motion lowers it for ever: a rigid motion on which the loads do
work, that meets no elastic force and closes no gap. A linear programme finds such a motion or excludes it.
"""

from __future__ import annotations

import numpy as np
import scipy

from ..base.arrays import Floats
from ..errors import LooseBodyError
from .ensemble import Ensemble

#: Loads that are in balance cancel to rounding; this part of them leaves room for that and for no real load.
BALANCED = 1e-9


def unbounded_motion(ensemble: Ensemble) -> LooseBodyError | None:
    """What describes a motion along which the loads move the bodies for ever, or None if there is no such motion."""
    motions = ensemble.rigid
    count = motions.modes.shape[1]
    if count == 0 or ensemble.load_size == 0.0:
        return None
    # Motions that springs resist are no way out.
    free = scipy.linalg.null_space(motions.elastic, rcond=1e-12) if np.any(motions.elastic) else np.eye(count)
    work = free.T @ _work_of_loads(ensemble)
    if free.shape[1] == 0 or np.abs(work).max() <= BALANCED * ensemble.load_size:
        return None
    closes = np.vstack([contact.rows for contact in motions.contacts]) @ free
    work, closes = work / np.abs(work).max(), closes / np.abs(closes).max(initial=np.finfo(float).tiny)
    # Mostly some pressures balance the loads, which is cheaper to see.
    if scipy.optimize.nnls(closes.T, work)[1] < 1e-10:
        return None
    nothing = np.zeros(len(closes))
    found = scipy.optimize.linprog(-work, A_ub=closes, b_ub=nothing, bounds=[(-1.0, 1.0)] * len(work))
    # The programme is solved to about 1e-7; a load that nothing balances does work of the order of one.
    if not found.success or -found.fun < 1e-6:
        return None
    return motions.loose(free @ _least_motion(work, closes, found.x))


def _work_of_loads(ensemble: Ensemble) -> Floats:
    """The work of the loads on the bodies' free rigid motions, (motions,); stresses and what is prescribed do none."""
    parts = []
    for problem, owner in zip(ensemble.problems, ensemble.rigid.owners, strict=True):
        parts.append(owner.coefficients.T @ (problem.body.rigid_modes().T @ problem.full_load))
    return np.concatenate(parts)


def _least_motion(work: Floats, closes: Floats, motion: Floats) -> Floats:
    """Of the motions that do as much work and close no gap that with the least in it: whatever need not move stays.

    work: (motions,) of the loads; closes: (points, motions); motion: one of them. A linear programme for its
    parts forwards and backwards.
    """
    count = len(work)
    found = scipy.optimize.linprog(
        np.ones(2 * count),
        A_ub=np.vstack([np.hstack([closes, -closes]), np.hstack([-work, work])]),
        b_ub=np.append(np.zeros(len(closes)), -work @ motion),
    )
    return found.x[:count] - found.x[count:] if found.success else motion
