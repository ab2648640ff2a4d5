"""The iteration itself: φ^k, the bodies' corrections, the relaxation, until the stopping rule or an honest end."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..base.arrays import Floats
from ..base.ranks import Ranks
from ..errors import LooseBodyError
from ..history import History, Record
from ..scheme import Scheme
from ..system.ensemble import Ensemble, Forces, norm
from ..system.equilibrium import BALANCED, unbounded_motion
from ..system.state import State
from .anderson import Anderson
from .line_search import minimise_along
from .step import Step
from .stopping import PROGRESS, StoppingCriterion, Termination

Observer = Callable[[Record], bool]


#: Where the slope of the energy is less than this part of the layers' work, differences of that work are too rough.
CANCELLED = 1e-8


@dataclass(frozen=True)
class Snapshot:
    """An iterate between two iterations, with all that the next one needs.

    state: the iterate; forces: those at it; done: how many iterations led to it; memory: of Anderson's method.
    """

    state: State
    forces: Forces
    done: int
    memory: Sequence[Floats]


class Run:
    """One run: the iterate `state` and the `history`; `snapshot` is the last complete iterate at any moment.

    linear: the linear problem of an iteration; history, memory: of an earlier run that this one goes on from.
    """

    def __init__(
        self,
        ensemble: Ensemble,
        ranks: Ranks,
        scheme: Scheme,
        linear: Step,
        state: State,
        history: History | None = None,
        memory: Sequence[Floats] = (),
    ) -> None:
        self.ensemble, self.scheme, self.state = ensemble, scheme, state
        self.history = History() if history is None else history
        self.anderson = Anderson() if scheme.accelerated else None
        if self.anderson is not None:
            self.anderson.memory = memory
        self._ranks, self._linear = ranks, linear
        self._size = max(problem.length for problem in ensemble.problems)
        stiffest = ensemble.rigid.stiffness_scale  # and the φ that is as stiff as that
        self._stiffest = [stiffest / interface.weights for interface in ensemble.interfaces]
        self._first_force = 0.0
        self._at_nodes = False
        self._began = time.process_time()
        self.snapshot = self._complete(ensemble.forces(state))

    def iterate(self, gammas: Iterator[float | None], rule: StoppingCriterion, observe: Observer) -> Termination:
        """Iterate to the end, from where the history ends.

        gammas: γ^0, γ^1, …, None where it is to be searched; observe: told of every iteration, ends the run by
        returning True.
        """
        done, self._at_nodes = len(self.history), rule.criterion == "change"
        gammas = itertools.islice(gammas, done, None)
        last = self.history[-1] if done else None
        best, best_at = self._best_so_far(rule)
        for k in range(done, max(done, rule.most) + 1):  # k iterations are done
            if not self._bounded():
                return self._ending(
                    "diverged", f"displacements exceed the bodies' size a hundred times in iteration {k}"
                )
            forces = self.snapshot.forces
            scale = self._scale(forces)
            residual = self._ranks.agree(norm(forces.residual) / scale if scale > 0.0 else 0.0)
            distance = rule.distance(residual, last)
            reached = f"residual {residual:.2e}" + (f", change {last.change:.2e}" if last else "")
            if distance <= 1.0:
                return self._arrived(f"{reached} after {k} iterations", residual * scale)
            if distance < PROGRESS * best:
                best, best_at = distance, k
            elif k - best_at >= rule.patience:
                return self._ending("stalled", f"no progress in {rule.patience} iterations: {reached}")
            if k >= rule.most:
                break
            try:
                last = self._iteration(k + 1, next(gammas), forces, scale, residual)
            except LooseBodyError as error:
                return self._ending("diverged", f"{error} in iteration {k + 1}")
            except np.linalg.LinAlgError as error:
                return self._ending("stalled", f"{error} in iteration {k + 1}")
            except StopIteration:
                return Termination("iteration limit", f"gamma ended after {k} values: {reached}")
            self.history.append(last)
            self.snapshot = self._complete(self.ensemble.forces(self.state))
            if self._ranks.agree(observe(last)):
                return Termination("stopped", f"as asked in iteration {k + 1}")
        return self._ending("iteration limit", f"{reached} after {k} iterations")

    def _complete(self, forces: Forces) -> Snapshot:
        """The iterate, its history complete."""
        return Snapshot(self.state, forces, len(self.history), [] if self.anderson is None else self.anderson.memory)

    def _best_so_far(self, rule: StoppingCriterion) -> tuple[float, int]:
        """The smallest distance in the history, and after how many iterations it was reached."""
        best, best_at, last = np.inf, 0, None
        for done, record in enumerate(self.history):
            distance = rule.distance(record.residual, last)
            if distance < PROGRESS * best:
                best, best_at = distance, done
            last = record
        return best, best_at

    def _iteration(self, k: int, gamma: float | None, forces: Forces, scale: float, residual: float) -> Record:
        """The iteration k (16), (25), and its record.

        gamma: None where it is to be searched; forces, scale, residual: those of the present iterate, the residual
        relative to the scale.
        """
        state, phi = self.state, self._coefficients()
        energy = self.ensemble.energy(state, forces.elastic)
        survive = gamma is None or self.anderson is not None
        correction, phi, note = self._correction(phi, forces.residual, scale, survive)
        length = self._search(correction, forces) if gamma is None else gamma
        if self.anderson is None:
            step = length * correction
        else:
            step, restart = self._accelerated(correction, forces, length, energy)
            note = ", ".join(filter(None, (note, restart)))
        interfaces = self.ensemble.interfaces
        contact = sum(float(i.weights @ (z < 0)) for i, z in zip(interfaces, state.gaps, strict=True))
        step = self._ranks.agree(step)
        self.state = self._moved(step)
        return Record(
            iteration=k,
            gamma=length,
            change=self.ensemble.change(step, self.state.unknowns, self._at_nodes),
            residual=residual,
            energy=energy,
            contact=contact,
            phi_min=min(float(values.min()) for values in phi.values()),
            phi_max=max(float(values.max()) for values in phi.values()),
            body_solves=self._linear.body_solves,
            seconds=time.process_time() - self._began,
            note=", ".join(filter(None, (self._linear.note if k == 1 else "", note))),
        )

    def _coefficients(self) -> dict[int, Floats]:
        """φ^k at the points of every interface."""
        phi, state = {}, self.state
        for index, interface in enumerate(self.ensemble.interfaces):
            z, before = state.gaps[index], state.previous_gaps[index]
            values = self.scheme.phi(interface.contact.layer, z, before, interface.x.T)
            # A law with g'(0) = ∞ would drown the bodies' stiffness; this much more of it is rigid enough.
            phi[index] = np.minimum(values, 1e8 * self._stiffest[index])
        return phi

    def _correction(
        self, phi: dict[int, Floats], residual: Floats, scale: float, survive: bool
    ) -> tuple[Floats, dict[int, Floats], str]:
        """ũ − u of all bodies, the coefficient that was used, and a note on it.

        A contact that opens for a moment leaves bodies that nothing holds. Where the energy watches over the step
        (survive), they are then held by a soft Robin term everywhere: the step still lowers the energy.
        """
        try:
            return self._linear.correct(phi, residual, scale), phi, ""
        except LooseBodyError:
            if not survive or self._escape is not None:
                raise
        phi = self._softened(phi, residual)
        return self._linear.correct(phi, residual, scale), phi, "open: held by a soft Robin term"

    @cached_property
    def _escape(self) -> LooseBodyError | None:
        """What moves for ever where there is no equilibrium."""
        return unbounded_motion(self.ensemble.load, self.ensemble.rigid)

    def _softened(self, phi: dict[int, Floats], residual: Floats) -> dict[int, Floats]:
        """φ with a soft Robin term wherever it is softer.

        It is the unbalanced forces over the contacts' area and the largest gap: a body moves by about that gap. It is
        no stiffer than the bodies, for the next step goes further, but not lost in the rounding of what is stiffest.
        """
        forces = max(float(np.abs(part).sum()) for part in self.ensemble.split(residual))
        area = float(self.ensemble.weights.sum())
        gap = max(float(np.abs(z).max()) for z in self.state.gaps)
        soft = forces / area / (gap if gap > 1e-12 * self._size else self._size)  # coordinates are no better than that
        soft = max(soft, 1e-10 * max(float(values.max()) for values in phi.values()))
        return {index: np.maximum(values, np.minimum(soft, self._stiffest[index])) for index, values in phi.items()}

    def _accelerated(self, correction: Floats, forces: Forces, gamma: float, energy: float) -> tuple[Floats, str]:
        """Anderson's step, or the best plain one where that would raise the energy."""
        step = self.anderson.step(self.state.unknowns, correction, gamma)
        reached = self.ensemble.energy(self._moved(step))
        # Near the solution energies differ by less than their own rounding.
        if np.isfinite(reached) and reached <= energy + 1e-12 * abs(energy):
            return step, ""
        self.anderson.restart()
        return self._search(correction, forces) * correction, "restarted: the energy would have risen"

    def _moved(self, step: Floats) -> State:
        """u^{k+1}, eqs. (23), (33), (37)."""
        unknowns = self.state.unknowns + step
        deformation = self.state.deformation + self.ensemble.deformation(step)
        return State(unknowns, deformation, self.ensemble.gaps(unknowns), self.state.gaps)

    def _scale(self, forces: Forces) -> float:
        """The size of the forces at work: loads and contact forces, or the first residual where there are none."""
        if forces.size > 0.0:
            return forces.size
        self._first_force = max(self._first_force, norm(forces.residual))
        return self._first_force

    def _search(self, correction: Floats, forces: Forces) -> float:
        """γ^k that minimises F₁ along the correction.

        The slope takes the growth of the layers' work; near the minimum, where that cancels, by divided differences.
        """
        descent = float(forces.residual @ correction)
        deformation = self.ensemble.deformation(correction)
        elastic = float(deformation @ (self.ensemble.stiffness @ deformation))
        moves = self.ensemble.closing @ correction
        works = moves * forces.tractions
        work, cancels = float(works.sum()), descent < CANCELLED * float(np.abs(works).sum())
        parts = zip(self.ensemble.interfaces, self.state.gaps, self.ensemble.by_interface(moves), strict=True)
        contacts = [(i.contact.layer, z, move, i.weights * move) for i, z, move in parts]

        def growth(t: float) -> float:
            """How much more the layers resist the correction at t than at 0."""
            if cancels:
                return t * sum(float((w * m) @ layer.divided_difference(z - t * m, z)) for layer, z, m, w in contacts)
            return work - sum(float(w @ layer.contact_stress(z - t * m)) for layer, z, m, w in contacts)

        return minimise_along(lambda t: t * elastic + growth(t) - descent if t else -descent)

    def _bounded(self) -> bool:
        """Whether the displacements are finite and not absurd."""
        return bool(np.abs(self.state.unknowns).max() < 100 * self._size)  # false also of what is not a number

    def _arrived(self, reason: str, residual: float) -> Termination:
        """The end of a run that has met its rule; residual: ‖F₁'‖, not relative.

        Along a motion that lowers the energy for ever contact forces do no negative work. So the residual is at least
        what the loads do there, and a small one excludes such a motion; a coarse rule has to ask for it.
        """
        if residual <= BALANCED * self.ensemble.load_size:
            return Termination("converged", reason)
        return self._ending("converged", reason)

    def _ending(self, status: str, reason: str) -> Termination:
        """The end of a run for this reason, unless there is a deeper one: no equilibrium."""
        way = self._escape
        return Termination(status, reason) if way is None else Termination("no equilibrium", str(way), way)
