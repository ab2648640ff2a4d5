"""The existence of an equilibrium.

F₁ is convex, so it has no minimum exactly where some motion lowers it for ever: a rigid motion on which the loads do
work, that causes no elastic force and closes no gap. A linear programme finds such a motion or excludes it.
"""

from __future__ import annotations

import numpy as np
import scipy

from ..base.arrays import TINY, Floats
from ..errors import LooseBodyError
from ..interface.discretise import Interface, discretise
from ..layer import LinearLayer
from .ensemble import Ensemble

#: Largest resultant of loads in balance, relative to the loads: room for rounding and for no real load.
BALANCED = 1e-9


#: The degree of Gauss points whose outermost lie within 0.6 % of a facet's length from its end.
NEAR_EDGES = 30


#: Advice where the loads' resultant passes between the outermost integration points and the edge.
AT_THE_EDGE = (
    "; the load lies so near the contact's edge that no integration point is as far out: expected a larger "
    "quadrature_degree of the contact, or a finer mesh at its edge"
)


def unbounded_motion(ensemble: Ensemble) -> LooseBodyError | None:
    """The error that describes a motion along which loads move bodies for ever; None if there is no such motion."""
    motions = ensemble.rigid
    count = motions.modes.shape[1]
    if count == 0 or ensemble.load_size == 0.0:
        return None
    # Motions that springs resist are bounded.
    free = scipy.linalg.null_space(motions.elastic, rcond=1e-12) if np.any(motions.elastic) else np.eye(count)
    work = free.T @ _work_of_loads(ensemble)
    if free.shape[1] == 0 or np.abs(work).max() <= BALANCED * ensemble.load_size:
        return None
    contacts = list(zip(ensemble.interfaces, motions.contacts, strict=True))
    closes = np.vstack([_resisted(i, contact.rows) for i, contact in contacts]) @ free
    motion = _way_out(work, closes)
    if motion is None:
        return None
    # The outermost integration points lie inside of the outermost facets: the contact's edge is not among them.
    near = [_resisted(i, c.rows if i.layer.bonded else _rows_near_edges(ensemble, i)) for i, c in contacts]
    at_the_edge = _way_out(work, np.vstack(near) @ free) is None
    return motions.loose(free @ motion, AT_THE_EDGE if at_the_edge else "")


def _resisted(interface: Interface, rows: Floats) -> Floats:
    """The approaches of rigid motions (points, motions) that a contact resists; a bond resists their opposites too."""
    return np.vstack([rows, -rows]) if interface.layer.bonded else rows


def _way_out(work: Floats, closes: Floats) -> Floats | None:
    """A motion on which the loads do work (motions,) and that closes no gap (points, motions), or None."""
    work, closes = work / np.abs(work).max(), closes / np.abs(closes).max(initial=TINY)
    # Mostly some pressures balance the loads, which is cheaper to see.
    if scipy.optimize.nnls(closes.T, work)[1] < 1e-10:
        return None
    nothing = np.zeros(len(closes))
    found = scipy.optimize.linprog(-work, A_ub=closes, b_ub=nothing, bounds=[(-1.0, 1.0)] * len(work))
    # The programme is solved to about 1e-7; a load that nothing balances does work of the order of one.
    if not found.success or -found.fun < 1e-6:
        return None
    return _least_motion(work, closes, found.x)


def _rows_near_edges(ensemble: Ensemble, interface: Interface) -> Floats:
    """√weight times the normal approach of rigid motions at points very near the facets' edges, (points, motions)."""
    first, second = interface.sides
    contact = interface.contact.resampled(NEAR_EDGES).with_layer(LinearLayer(1.0))  # the law is not asked for
    fine = discretise(contact, (first.body, second.body), interface.facets)
    owners = ensemble.rigid.owners
    parts = [np.zeros((len(fine.weights), owner.coefficients.shape[1])) for owner in owners]
    for side in fine.sides:
        modes = ensemble.problems[side.body].dofs.rigid_displacements(owners[side.body].coefficients)
        parts[side.body] = parts[side.body] + side.trace @ modes
    return np.sqrt(fine.weights)[:, None] * np.hstack(parts)


def _work_of_loads(ensemble: Ensemble) -> Floats:
    """The work of the loads on the bodies' free rigid motions, (motions,); stresses and what is prescribed do none."""
    parts = []
    for problem, owner in zip(ensemble.problems, ensemble.rigid.owners, strict=True):
        parts.append(problem.dofs.rigid_displacements(owner.coefficients).T @ problem.dofs.load)
    return np.concatenate(parts)


def _least_motion(work: Floats, closes: Floats, motion: Floats) -> Floats:
    """The smallest of the motions that do as much work and close no gap: bodies that need not move stay.

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
