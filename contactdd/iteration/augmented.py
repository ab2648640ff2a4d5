"""Hard contact by an augmented Lagrangian: solve with the multipliers held, set them to the pressures, repeat."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..base.arrays import Floats
from ..base.ranks import Ranks
from ..hard_contact import AugmentedLayer
from ..history import History, Record
from ..relaxation import Relaxation
from ..scheme import Scheme
from ..system.ensemble import Ensemble
from ..system.state import State
from .run import Observer, Run
from .step import Step
from .stopping import StoppingCriterion, Termination

#: The last change of the multipliers, and what all later ones would add to it, relative to the largest pressure.
SETTLED = 1e-6

#: Pressures below this part of another contact's are not resolved relative to themselves.
FAINT = 1e-4

#: Updates of the multipliers; each leaves about a tenth of the change before, or they do not settle at all.
MOST_UPDATES = 100

#: Updates in a row that bring the multipliers no closer, after which they never will.
PATIENCE = 12


class AugmentedRun:
    """One run with hard contacts: the iterate `state`, whose shifts are the multipliers over k, and the `history`."""

    def __init__(self, ensemble: Ensemble, ranks: Ranks, scheme: Scheme, linear: Step, state: State) -> None:
        self.ensemble, self.scheme, self.history = ensemble, scheme, History()
        self._ranks, self._linear = ranks, linear
        self.state = self._shifted(state, state.shifts or [np.zeros(len(i.weights)) for i in ensemble.interfaces])

    def iterate(self, gammas: Iterator[Relaxation], rule: StoppingCriterion, observe: Observer) -> Termination:
        """Iterate to the end; see `Run.iterate`."""
        best, best_at, last = np.inf, 0, np.inf
        for update in range(MOST_UPDATES + 1):
            ending = self._inner(gammas, rule, observe, update)
            if ending.status != "converged":
                return ending
            change = self._ranks.agree(self._change())
            reached = f"{ending.reason}; multipliers updated {update} times, change {change:.2e}"
            reached += f", penetration {self.penetration:.2e}"
            if change <= SETTLED and change * remaining(change, last) <= SETTLED:
                return Termination("converged", reached)
            last = change
            if change < 0.9 * best:
                best, best_at = change, update
            elif update - best_at >= PATIENCE:
                break
            self.state = self._shifted(self.state, self._multipliers())
        return Termination("stalled", f"the pressures of hard contacts do not settle: {reached}")

    def _inner(
        self, gammas: Iterator[Relaxation], rule: StoppingCriterion, observe: Observer, update: int
    ) -> Termination:
        """The iterations with the multipliers that there are."""
        done, ensemble = len(self.history), self.ensemble
        run = Run(ensemble.shifted(self.state.shifts), self._ranks, self.scheme, self._linear, self.state)
        told = f"multipliers updated ({update}), penetration {self.penetration:.1e}" if update else ""

        def record(inner: Record) -> bool:
            note = ", ".join(filter(None, (told if inner.iteration == 1 else "", inner.note)))
            self.history.append(replace(inner, iteration=done + inner.iteration, note=note))
            return observe(self.history[-1])

        try:
            return run.iterate(gammas, replace(rule, most=rule.most - done), record)
        finally:
            self.state = run.state

    @property
    def penetration(self) -> float:
        """The largest overlap of hard contacts (length)."""
        state = zip(self.ensemble.interfaces, self.state.gaps, self.state.shifts, strict=True)
        return max(0.0, max(-float((z + s).min()) for i, z, s in state if i.hard))

    def _multipliers(self) -> list[Floats]:
        """The pressures over k, (points,) of each interface: the multipliers' next values."""
        state = zip(self.ensemble.interfaces, self.state.gaps, strict=True)
        return [np.maximum(-z, 0.0) if i.hard else np.zeros_like(z) for i, z in state]

    def _change(self) -> float:
        """By how much the multipliers are not the pressures, relative to the largest pressure of each hard contact.

        A contact that hardly presses beside the others is compared with a part of theirs.
        """
        layers = [interface.layer for interface in self.ensemble.interfaces]
        contacts = zip(layers, self._multipliers(), self.state.shifts, strict=True)
        hard = [(law.stiffness, new, old) for law, new, old in contacts if isinstance(law, AugmentedLayer)]
        changes = np.array([k * np.abs(new - old).max() for k, new, old in hard])
        largest = np.array([k * max(new.max(), old.max()) for k, new, old in hard])
        scales = np.maximum(largest, FAINT * largest.max())
        return float((changes / scales).max()) if np.any(largest) else 0.0

    def _shifted(self, state: State, shifts: list[Floats]) -> State:
        """The same displacements with other multipliers."""
        gaps = self.ensemble.shifted(shifts).gaps(state.unknowns)
        return replace(state, gaps=gaps, previous_gaps=gaps, shifts=shifts)


def remaining(change: float, last: float) -> float:
    """The sum of all later changes of a geometric sequence, in units of the present one: r + r² + …"""
    rate = min(change / last, 0.999) if last > 0.0 else 0.0
    return rate / (1.0 - rate)
