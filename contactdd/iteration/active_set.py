"""Hard contact of surfaces that are known by how they answer to pressures: the set of points that press.

These points are held together, all others are free; those that pull are let go, those that overlap are held, until none
does. With a multiplier λ for the pressure that is Newton's method for λ = [λ − k z]⁺, whatever k > 0 (M. Hintermüller,
K. Ito, K. Kunisch, SIAM J. Optim. 13, 2003).
"""

from __future__ import annotations

import time
from collections.abc import Iterator

import numpy as np

from ..base.arrays import Floats, norm
from ..base.ranks import Ranks
from ..errors import LooseBodyError
from ..history import History, Record
from ..relaxation import Relaxation
from ..scheme import Scheme
from ..system.ensemble import Ensemble, Forces
from ..system.equilibrium import unbounded_motion
from ..system.state import State
from .pressures import Pressures
from .run import Observer
from .stopping import PROGRESS, StoppingCriterion, Termination

#: Gaps that are at most this part of the largest displacement are closed.
ROUNDING = 4 * np.finfo(float).eps


class ActiveSetRun:
    """One run with a hard contact: the iterate `state`, whose shifts are the pressures over k, and the `history`."""

    def __init__(self, ensemble: Ensemble, ranks: Ranks, scheme: Scheme, linear: Pressures, state: State) -> None:
        self.ensemble, self.scheme, self.history = ensemble, scheme, History()
        self._ranks, self._linear = ranks, linear
        self._began = time.process_time()
        self._onto_unknowns = ensemble.normal_approach.T
        self._stiffness = float(ensemble.interfaces[0].layer.stiffness)  # type: ignore[attr-defined]  # of a hard one
        known = state.shifts[0] if state.shifts else np.zeros_like(ensemble.weights)
        self._forces = self._stiffness * ensemble.weights * known
        self._pressing = known > 0.0 if state.shifts else np.ones(len(known), dtype=bool)
        self.state, self._reached = self._moved(state.unknowns)

    def iterate(self, gammas: Iterator[Relaxation], rule: StoppingCriterion, observe: Observer) -> Termination:
        """Iterate to the end; see `Run.iterate`. There is nothing to relax."""
        last, best, best_at = None, np.inf, 0
        residual = self._residual
        for k in range(rule.most + 1):
            reached = f"residual {residual:.2e} after {k} iterations, {np.count_nonzero(self._forces > 0)} points press"
            distance = rule.distance(residual, last)
            if distance <= 1.0:
                return Termination("converged", reached)
            if distance < PROGRESS * best:
                best, best_at = distance, k
            if k == rule.most or k - best_at >= rule.patience:
                return self._ending("iteration limit" if k == rule.most else "stalled", reached)
            try:
                last = self._iteration(k + 1)
            except LooseBodyError as error:
                return self._ending("stalled", f"{error} in iteration {k + 1}")
            residual = last.residual
            if self._ranks.agree(observe(last)):
                return Termination("stopped", f"as asked in iteration {k + 1}")
        raise AssertionError("the last iteration ends the run")

    def _iteration(self, k: int) -> Record:
        """The iteration k: its record."""
        before, here = self.state, self._reached
        known = np.where(self._pressing, np.maximum(self._forces, 0.0), 0.0)
        residual = self.ensemble.load - here.elastic - self._onto_unknowns @ known
        gaps = before.gaps[0] + before.shifts[0]
        step, change = map(self._ranks.agree, self._linear.held(self._pressing, gaps, residual, here.size))
        self._forces = known + change
        self.state, self._reached = self._moved(before.unknowns + step)
        # Held points are closed but for rounding: only those that are free can overlap.
        self._pressing = np.where(self._pressing, self._forces > 0.0, self.state.gaps[0] < 0.0)
        record = Record(
            iteration=k,
            gamma=1.0,
            change=self.ensemble.change(step, self.state.unknowns, False),
            residual=self._residual,
            energy=self.ensemble.energy(self.state, self._reached.elastic),
            contact=float(self.ensemble.weights @ (self._forces > 0.0)),
            phi_min=self._stiffness,
            phi_max=self._stiffness,
            body_solves=self._linear.body_solves,
            seconds=time.process_time() - self._began,
            note=self._linear.note if k == 1 else "",
        )
        self.history.append(record)
        return record

    def _moved(self, unknowns: Floats) -> tuple[State, Forces]:
        """The iterate with these unknowns and the pressures that there are, and the forces of the augmented Lagrangian.

        They balance where p ≥ 0, z ≥ 0 and p z = 0.
        """
        shifts = np.maximum(self._forces, 0.0) / (self._stiffness * self.ensemble.weights)
        shifted = self.ensemble.shifted([shifts])
        (found,) = shifted.gaps(unknowns)
        # The rounding of motions far larger than what they press in would be forces larger than a small load.
        closed = np.abs(found + shifts) <= ROUNDING * np.abs(unknowns).max(initial=0.0)
        gaps = [np.where(closed, -shifts, found)]
        state = State(unknowns, self.ensemble.deformation(unknowns), gaps, gaps, [shifts])
        return state, shifted.forces(state)

    @property
    def _residual(self) -> float:
        """The forces that do not balance, relative to those at work."""
        size = norm(self._reached.residual)
        return float(self._ranks.agree(size / self._reached.size if self._reached.size > 0.0 else size))

    def _ending(self, status: str, reason: str) -> Termination:
        """The end of a run for this reason, unless there is a deeper one: no equilibrium."""
        way = unbounded_motion(self.ensemble, -np.maximum(self._forces, 0.0))
        return Termination(status, reason) if way is None else Termination("no equilibrium", str(way), way)
