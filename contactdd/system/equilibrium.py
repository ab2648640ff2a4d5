"""The existence of an equilibrium.

F₁ is convex, so it has no minimum exactly where some motion lowers it for ever: a rigid motion on which the loads do
work, that causes no elastic force and closes no gap. A linear programme finds such a motion or excludes it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy
from numpy.typing import NDArray

from ..base.arrays import TINY, Floats, Operator
from ..base.sparse import stacked
from ..errors import LooseBodyError
from ..interface.discretise import Interface, discretise
from ..layer import LinearLayer
from ..local.remote import work_of_loads
from .ensemble import Ensemble
from .joint_motions import Coupling, joint_rows, least_squares

#: Largest resultant of loads in balance, relative to the loads: room for rounding and for no real load.
BALANCED = 1e-9


#: Work of the loads that forces leave undone, as a part of the largest: rounding.
UNBALANCED = 1e-10


#: Changes of guessed forces; near an equilibrium the first is enough.
GUESSES = 8


#: The degree of Gauss points whose outermost lie within 0.6 % of a facet's length from its end.
NEAR_EDGES = 30


#: Advice where the loads' resultant passes between the outermost integration points and the edge.
AT_THE_EDGE = (
    "; the load lies so near the contact's edge that no integration point is as far out: expected a larger "
    "quadrature_degree of the contact, or a finer mesh at its edge"
)


def unbounded_motion(ensemble: Ensemble, tractions: Floats | None = None) -> LooseBodyError | None:
    """The error that describes a motion along which loads move bodies for ever; None if there is no such motion.

    tractions: contact stresses times areas, at all points, that nearly balance the loads, as a first guess.
    """
    motions = ensemble.rigid
    if motions.count == 0 or ensemble.load_size == 0.0:
        return None
    free = motions.unbounded
    work = free.T @ _work_of_loads(ensemble)
    if free.shape[1] == 0 or np.abs(work).max() <= BALANCED * ensemble.load_size:
        return None
    rows, bonded = motions.rows, _bonded(ensemble, [len(i.weights) for i in ensemble.interfaces])
    guess = None if tractions is None else -tractions / np.sqrt(ensemble.weights)
    if guess is not None and np.any(bonded):
        guess = np.concatenate([guess, -guess[bonded]])
    motion = _way_out(work, _resisted(rows, bonded) @ free, guess)
    if motion is None:
        return None
    # The outermost integration points lie inside of the outermost facets: the contact's edge is not among them.
    contacts = zip(ensemble.interfaces, ensemble.points, strict=True)
    near = [rows[part] if i.layer.bonded else joint_rows([_near_edges(ensemble, i)], motions) for i, part in contacts]
    resisted = _resisted(stacked(near), _bonded(ensemble, [each.shape[0] for each in near]))
    at_the_edge = _way_out(work, resisted @ free) is None
    return motions.loose(free @ motion, AT_THE_EDGE if at_the_edge else "")


def _bonded(ensemble: Ensemble, points: Sequence[int]) -> NDArray[np.bool_]:
    """Whether surfaces are bonded, at so many points of each contact, (all points,)."""
    return np.repeat([bool(interface.layer.bonded) for interface in ensemble.interfaces], points)


def _resisted(rows: Operator, bonded: NDArray[np.bool_]) -> Operator:
    """The approaches of rigid motions (points, motions) that contacts resist; bonds resist their opposites too."""
    return stacked([rows, -rows[bonded]]) if np.any(bonded) else rows


def _way_out(work: Floats, closes: Operator, guess: Floats | None = None) -> Floats | None:
    """A motion on which the loads do work (motions,) and that closes no gap (points, motions), or None.

    guess: forces (points,) that nearly do as much work.
    """
    size = np.abs(work).max()
    work = work / size
    # Mostly some pressures balance the loads, which is cheaper to see.
    if _balanced(work, closes, None if guess is None else guess / size):
        return None
    closes = closes / max(float(abs(closes).max()) if min(closes.shape) else 0.0, TINY)
    nothing = np.zeros(closes.shape[0])
    found = scipy.optimize.linprog(-work, A_ub=closes, b_ub=nothing, bounds=[(-1.0, 1.0)] * len(work))
    # The programme is solved to about 1e-7; a load that nothing balances does work of the order of one.
    if not found.success or -found.fun < 1e-6:
        return None
    return _least_motion(work, scipy.sparse.csr_matrix(closes), found.x)


def _balanced(work: Floats, closes: Operator, guess: Floats | None) -> bool:
    """Whether it is plain that forces at the points, none of which pulls, do the work of the loads (motions,).

    Where motions are many, only forces like the guess are tried: each is changed in proportion to itself.
    """
    if isinstance(closes, np.ndarray):
        closes = closes / np.abs(closes).max(initial=TINY)
        return bool(scipy.optimize.nnls(closes.T, work)[1] < UNBALANCED)
    if guess is None:
        return False
    forces: Floats = np.maximum(guess, 0.0)
    for _ in range(GUESSES):
        missing = work - closes.T @ forces
        if np.linalg.norm(missing) < UNBALANCED:
            return True
        change = closes @ least_squares(closes, forces, missing)
        shorter = min(1.0, 0.9 / max(-float(change.min()), 0.9))
        forces = forces * (1.0 + shorter * change)
    return False


def _near_edges(ensemble: Ensemble, interface: Interface) -> Coupling:
    """What an interface does to rigid motions at points very near the facets' edges."""
    first, second = interface.sides
    contact = interface.contact.resampled(NEAR_EDGES).with_layer(LinearLayer(1.0))  # the law is not asked for
    fine = discretise(contact, (first.body, second.body), interface.facets)
    rows: dict[int, Floats] = {}
    for side in fine.sides:
        owner = ensemble.rigid.owners[side.body]
        modes = ensemble.problems[side.body].dofs.rigid_displacements(owner.coefficients)
        rows[side.body] = np.sqrt(fine.weights)[:, None] * (side.trace @ modes)
    return Coupling(rows)


def _work_of_loads(ensemble: Ensemble) -> Floats:
    """The work of the loads on the bodies' free rigid motions, (motions,); stresses and what is prescribed do none."""
    pairs = zip(ensemble.problems, ensemble.rigid.owners, strict=True)
    return np.concatenate([work_of_loads(problem.dofs, owner.coefficients) for problem, owner in pairs])


def _least_motion(work: Floats, closes: scipy.sparse.csr_matrix, motion: Floats) -> Floats:
    """The smallest of the motions that do as much work and close no gap: bodies that need not move stay.

    work: (motions,) of the loads; closes: (points, motions); motion: one of them. A linear programme for its
    parts forwards and backwards.
    """
    count, row = len(work), scipy.sparse.csr_matrix(work)
    rows = [scipy.sparse.hstack([closes, -closes]), scipy.sparse.hstack([-row, row])]
    most = np.append(np.zeros(closes.shape[0]), -work @ motion)
    found = scipy.optimize.linprog(np.ones(2 * count), A_ub=scipy.sparse.vstack(rows), b_ub=most)
    return found.x[:count] - found.x[count:] if found.success else motion
