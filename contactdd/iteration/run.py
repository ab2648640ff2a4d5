"""The iteration itself: φ^k, the bodies' corrections, the relaxation, until the stopping rule or an honest end."""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..base.arrays import Floats, norm
from ..base.ranks import Ranks
from ..contact_sides import ContactSides, sides_of_contacts
from ..errors import LooseBodyError
from ..history import History, Record
from ..interface.discretise import Interface
from ..relaxation import Correction, Relaxation
from ..scheme import Scheme
from ..system.ensemble import Ensemble, Forces, joined
from ..system.equilibrium import BALANCED, unbounded_motion
from ..system.state import State
from .anderson import Anderson
from .line_search import minimise_along
from .step import Step
from .stopping import PROGRESS, NotANumberError, StoppingCriterion, Termination

Observer = Callable[[Record], bool]


#: Largest displacement of a solution over the size of the largest body and the prescribed displacements.
ABSURD = 100.0


#: The rounding of a sum of some hundred elastic forces, as a part of their size; and the largest residual that may be
#: taken for it.
ROUNDING, SMALL = 2e-15, 1e-8


#: Halvings of a line search's step that would end at a law's pole.
SHORTER = 4


#: Largest φ over the bodies' own stiffness: at g'(0) = ∞ the bodies' digits would be lost.
RIGID = 1e8


#: Where the slope of the energy is less than this part of the layers' work, it is found by divided differences.
CANCELLED = 1e-8


#: The coordinates that pointwise coefficients do not look at.
NO_PLACES: Floats = np.zeros((0, 0))


@dataclass(frozen=True)
class Measured:
    """The forces at an iterate, the size of those at work, and the residual relative to that."""

    forces: Forces
    scale: float
    residual: float


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
        prescribed = [float(np.abs(t.offset).max(initial=0.0)) for p in ensemble.problems for t in p.traces]
        self._prescribed = max(prescribed, default=0.0)
        self._furthest = ABSURD * (self._size + self._prescribed)
        stiffest = ensemble.rigid.stiffness_scale  # and the φ that is as stiff as that
        self._stiffest = ensemble.by_interface(stiffest / ensemble.weights)
        self._sliding = any(interface.slides is not None for interface in ensemble.interfaces)
        self._first_force = 0.0
        self._at_nodes = False
        self._last_correction: Floats | None = None
        self._began = time.process_time()
        self.snapshot = self._complete(ensemble.forces(state))

    def iterate(self, gammas: Iterator[Relaxation], rule: StoppingCriterion, observe: Observer) -> Termination:
        """Iterate to the end, from where the history ends.

        gammas: γ^0, γ^1, …, see `relaxation`; observe: told of every iteration, ends the run by
        returning True.
        """
        done, self._at_nodes = len(self.history), rule.criterion == "change"
        gammas = itertools.islice(gammas, done, None)
        last = self.history[-1] if done else None
        best, best_at = self._best_so_far(rule)
        try:
            found = self._measured(self.state, self.snapshot.forces)
        except NotANumberError as error:
            return self._ending("diverged", f"{error} after {done} iterations")
        for k in range(done, max(done, rule.most) + 1):  # k iterations are done
            if not self._bounded():
                return self._ending(
                    "diverged", f"displacements exceed the bodies' size a hundred times in iteration {k}"
                )
            distance = rule.distance(found.residual, last)
            reached = f"residual {found.residual:.2e}" + (f", change {last.change:.2e}" if last else "")
            if distance <= 1.0:
                return self._arrived(f"{reached} after {k} iterations", found)
            if self._nothing_at_work(found):
                return self._arrived(f"{reached} after {k} iterations, nothing being at work but rounding", found)
            if distance < PROGRESS * best:
                best, best_at = distance, k
            elif k - best_at >= rule.patience:
                if rule.criterion == "residual" and self._only_rounding(found):
                    return self._arrived(f"{reached}, which is rounding of far larger elastic forces", found)
                return self._ending("stalled", f"no progress in {rule.patience} iterations: {reached}")
            if k >= rule.most:
                break
            try:
                last, found = self._iteration(k + 1, next(gammas), found)
            except (LooseBodyError, NotANumberError) as error:
                return self._ending("diverged", f"{error} in iteration {k + 1}")
            except np.linalg.LinAlgError as error:
                return self._ending("stalled", f"{error} in iteration {k + 1}")
            except StopIteration:
                return Termination("iteration limit", f"gamma ended after {k} values: {reached}")
            self.history.append(last)
            self.snapshot = self._complete(found.forces)
            if self._ranks.agree(observe(last)):
                return Termination("stopped", f"as asked in iteration {k + 1}")
        return self._ending("iteration limit", f"{reached} after {k} iterations")

    def _complete(self, forces: Forces) -> Snapshot:
        """The iterate, its history complete."""
        return Snapshot(self.state, forces, len(self.history), [] if self.anderson is None else self.anderson.memory)

    def _best_so_far(self, rule: StoppingCriterion) -> tuple[float, int]:
        """The smallest distance in the history, and after how many iterations it was reached."""
        best, best_at = np.inf, 0
        for record in self.history:
            distance = rule.distance(record.residual, record)
            if distance < PROGRESS * best:
                best, best_at = distance, record.iteration
        return best, best_at

    def _measured(self, state: State, forces: Forces | None = None) -> Measured:
        """The forces at an iterate, their scale and the relative residual; NotANumberError where one is none."""
        forces = self.ensemble.forces(state) if forces is None else forces
        size = norm(forces.residual)
        finite = math.isfinite(size) and math.isfinite(forces.size)
        reason = self._ranks.any_says("" if finite else self._strange(state))
        if reason:
            raise NotANumberError(reason)
        if forces.size == 0.0 and size <= ROUNDING * self.ensemble.rigid.stiffness_scale * norm(state.unknowns):
            size = 0.0  # nothing is at work, and a rigid motion's rounding is no force
        scale = self._scale(forces.size, size)
        return Measured(forces, scale, self._ranks.agree(size / scale if scale > 0.0 else 0.0))

    def _strange(self, state: State) -> str:
        """The message on what is no finite number at an iterate: a layer's stress, else displacements or forces."""
        for interface, z in zip(self.ensemble.interfaces, state.gaps, strict=True):
            stress = interface.layer.contact_stress(z)
            wrong = np.isfinite(z) & ~np.isfinite(stress)
            if np.any(wrong):
                at = int(np.argmax(wrong))
                return _no_number(interface, f"stress {stress[at]:g} at the gap {z[at]:.6g}")
        return "the displacements or forces are no finite numbers (their squares have to be)"

    def _iteration(self, k: int, gamma: Relaxation, at: Measured) -> tuple[Record, Measured]:
        """The iteration k (16), (25): its record, and the forces at the iterate that it ends with.

        gamma: None where it is to be searched, a function where it is chosen; at: the forces at the present iterate,
        which stays where the next one would be no numbers.
        """
        phi, forces = self._coefficients(), at.forces
        survive = gamma is None or self.anderson is not None
        correction, phi, note = self._correction(phi, forces.residual, at.scale, survive)
        length = self._length(gamma, correction, forces)
        if self.anderson is None:
            step = length * correction
        else:
            step, restart = self._accelerated(self.anderson, correction, forces, length)
            note = ", ".join(filter(None, (note, restart)))
        step, state, found = self._next(self._ranks.agree(step), survive)
        record = Record(
            iteration=k,
            gamma=length,
            change=self.ensemble.change(step, state.unknowns, self._at_nodes),
            residual=found.residual,
            energy=self._energy(state, found.forces),
            contact=self._contact_area(state),
            phi_min=min(float(values.min()) for values in phi.values()),
            phi_max=max(float(values.max()) for values in phi.values()),
            body_solves=self._linear.body_solves,
            seconds=time.process_time() - self._began,
            note=", ".join(filter(None, (self._linear.note if k == 1 else "", note))),
        )
        self.state = state
        return record, found

    def _length(self, gamma: Relaxation, correction: Floats, forces: Forces) -> float:
        """γ^k: given, chosen by a function, or searched."""
        if gamma is None:
            return self._search(correction, forces)
        if not callable(gamma):
            return gamma
        chosen = gamma(Correction(len(self.history), self.history, correction, self._last_correction))
        self._last_correction = correction
        return chosen

    def _next(self, step: Floats, guarded: bool) -> tuple[Floats, State, Measured]:
        """The step, the iterate after it and its forces.

        guarded: whether a shorter step will do where the forces would be no numbers, as at a law's pole.
        """
        for _ in range(SHORTER if guarded else 0):
            state = self._moved(step)
            try:
                return step, state, self._measured(state)
            except NotANumberError:
                step = 0.5 * step
        state = self._moved(step)
        return step, state, self._measured(state)

    def _contact_area(self, state: State) -> float:
        """The area where z < 0, or where surfaces are bonded."""
        contacts = zip(self.ensemble.interfaces, state.gaps, strict=True)
        return sum(float(i.weights @ ((z < 0) | i.layer.bonded)) for i, z in contacts if i.slides is None)

    def _energy(self, state: State, forces: Forces) -> float:
        """F₁ at an iterate; NotANumberError, which names the layer, where it is no finite number."""
        energy = self.ensemble.energy(state, forces.elastic)
        reason = self._ranks.any_says("" if math.isfinite(energy) else self._strange_energy(state))
        if reason:
            raise NotANumberError(reason)
        return energy

    def _strange_energy(self, state: State) -> str:
        """The message on the layer whose energy is no finite number."""
        for interface, z in zip(self.ensemble.interfaces, state.gaps, strict=True):
            density = interface.layer.energy(z)
            if not np.all(np.isfinite(density)):
                at = int(np.argmin(np.isfinite(density)))
                return _no_number(interface, f"energy {density[at]:g} at the gap {z[at]:.6g}")
        return "the energy is no finite number"

    def _coefficients(self) -> dict[int, Floats]:
        """φ^k at the points of every interface, bounded; NotANumberError where it is none."""
        at_once, count = self.scheme.pointwise and not self._sliding, len(self._stiffest)
        found = self._pointwise() if at_once else map(self._of_contact, range(count))
        phi = [np.minimum(values, RIGID * most) for values, most in zip(found, self._stiffest, strict=True)]
        reason = ""
        for interface, values, z in zip(self.ensemble.interfaces, phi, self.state.gaps, strict=True):
            if not reason and not math.isfinite(float(values.sum())):  # what is not a number stays so
                reason = _no_coefficient(interface, values, z)
        reason = self._ranks.any_says(reason)
        if reason:
            raise NotANumberError(reason)
        return dict(enumerate(phi))

    def _of_contact(self, index: int) -> Floats:
        """φ^k of one interface, (points,) or a row for each body."""
        interface, z = self.ensemble.interfaces[index], self.state.gaps[index]
        if interface.slides is not None:  # quadratic: the same in every scheme
            return interface.layer.contact_derivative(z)
        sides = self._sides[index] if self.scheme.two_sided else None
        return self.scheme.phi(interface.layer, z, self.state.previous_gaps[index], interface.x.T, sides)

    def _pointwise(self) -> list[Floats]:
        """The same of all interfaces at once, where it depends on nothing but the law and the gaps at each point."""
        gaps, before = joined(self.state.gaps), joined(self.state.previous_gaps)
        coefficient = self.scheme.coefficient
        values = self.ensemble.by_law(lambda law, z, last: coefficient(law, z, last, NO_PLACES), gaps, before)
        return self.ensemble.by_interface(values)

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
            if not survive or self._unbounded_motion is not None:
                raise
        phi = self._softened(phi, residual)
        return self._linear.correct(phi, residual, scale), phi, "open: held by a soft Robin term"

    @cached_property
    def _sides(self) -> list[ContactSides]:
        """The contacts with their bodies, for coefficients that see them."""
        return sides_of_contacts(self.ensemble.interfaces, self.ensemble.problems)

    @cached_property
    def _unbounded_motion(self) -> LooseBodyError | None:
        """The motion that lowers the energy for ever, where there is no equilibrium."""
        return unbounded_motion(self.ensemble, self.snapshot.forces.tractions)

    def _softened(self, phi: dict[int, Floats], residual: Floats) -> dict[int, Floats]:
        """φ with a soft Robin term wherever it is softer.

        Its stiffness is the unbalanced force per contact area divided by the largest gap, so that a loose body moves by
        about that gap; it is bounded by the bodies' own stiffness above and by rounding below.
        """
        forces = max(float(np.abs(part).sum()) for part in self.ensemble.split(residual))
        area = float(self.ensemble.weights.sum())
        gap = max(float(np.abs(z).max()) for z in self.state.gaps)
        soft = forces / area / (gap if gap > 1e-12 * self._size else self._size)  # coordinates are no better than that
        soft = max(soft, 1e-10 * max(float(values.max()) for values in phi.values()))
        return {index: np.maximum(values, np.minimum(soft, self._stiffest[index])) for index, values in phi.items()}

    def _accelerated(self, anderson: Anderson, correction: Floats, forces: Forces, gamma: float) -> tuple[Floats, str]:
        """Anderson's step, or the best plain one where that would raise the energy."""
        energy = self.history[-1].energy if len(self.history) else self._energy(self.state, forces)
        step = anderson.step(self.state.unknowns, correction, gamma)
        moved = self._moved(step)
        reached = self.ensemble.energy(moved)
        # Near the solution energies differ by less than their own rounding. At a law's pole energies may be finite.
        if reached <= energy + 1e-12 * abs(energy) and math.isfinite(float(self.ensemble.tractions(moved).sum())):
            return step, ""
        anderson.restart()
        return self._search(correction, forces) * correction, "restarted: the energy would have risen"

    def _moved(self, step: Floats) -> State:
        """u^{k+1}, eqs. (23), (33), (37)."""
        unknowns = self.state.unknowns + step
        deformation = self.state.deformation + self.ensemble.deformation(step)
        return State(unknowns, deformation, self._gaps(step, unknowns), self.state.gaps, self.state.shifts)

    def _gaps(self, step: Floats, unknowns: Floats) -> list[Floats]:
        """z^{k+1}, from z^k and the step: to the rounding of the step, where the displacements may be far larger.

        Only a run that comes back from afar has rounded more on its way than the displacements that it comes to.
        """
        if self.state.largest > 2.0 * float(np.abs(unknowns).max(initial=0.0)):
            return self.ensemble.gaps(unknowns)
        moves = self.ensemble.by_interface(self.ensemble.normal_approach @ step)
        return [z - move for z, move in zip(self.state.gaps, moves, strict=True)]

    def _scale(self, at_work: float, residual: float) -> float:
        """The size of the forces at work, or the first residual where there are none."""
        if at_work != 0.0:
            return at_work
        self._first_force = max(self._first_force, residual)
        return self._first_force

    def _search(self, correction: Floats, forces: Forces) -> float:
        """γ^k that minimises F₁ along the correction.

        The slope takes the growth of the layers' work; near the minimum, where that cancels, by divided differences.
        """
        descent = float(forces.residual @ correction)
        deformation = self.ensemble.deformation(correction)
        answer = self.ensemble.elastic_forces(correction, deformation)
        elastic = self.ensemble.elastic_work(correction, deformation, answer)
        moves, gaps = self.ensemble.normal_approach @ correction, joined(self.state.gaps)
        works, weighted = moves * forces.tractions, self.ensemble.weights * moves
        work, cancels = float(works.sum()), descent < CANCELLED * float(np.abs(works).sum())

        def growth(t: float) -> float:
            """The growth of the layers' work on the correction from 0 to t."""
            reached = gaps - t * moves
            if cancels:
                steepness = self.ensemble.by_law(lambda law, y, z: law.divided_difference(y, z), reached, gaps)
                return t * float((weighted * moves) @ steepness)
            return work - float(weighted @ self.ensemble.by_law(lambda law, z: law.contact_stress(z), reached))

        return minimise_along(lambda t: t * elastic + growth(t) - descent if t else -descent, elastic)

    def _bounded(self) -> bool:
        """Whether the displacements are finite and at most a hundred times the largest body."""
        # False also of what is not a number; true where supports hold all that the contacts touch.
        return self.state.largest < self._furthest

    def _only_rounding(self, found: Measured) -> bool:
        """Whether the residual of a run that stands still is small, and the rounding of its elastic forces.

        A body that is bent a lot and pressed a little has elastic forces so large that they cancel no better.
        """
        parts = zip(self.ensemble.problems, self.ensemble.split(self.state.deformation), strict=True)
        elastic = math.hypot(norm(self.ensemble.load), *(p.rigid.stiffness_scale * norm(d) for p, d in parts))
        return found.residual <= SMALL and found.residual * found.scale <= ROUNDING * elastic

    def _nothing_at_work(self, found: Measured) -> bool:
        """Whether there are no loads, and no other forces than the rounding of what is prescribed would cause.

        So it is where prescribed displacements close no contact: bodies in between then lie where they are.
        """
        if self.ensemble.load_size != 0.0:
            return False
        stiffest = max(problem.rigid.stiffness_scale for problem in self.ensemble.problems)
        forces = math.hypot(found.forces.size, norm(found.forces.residual))
        return self._ranks.agree(forces <= ROUNDING * stiffest * self._prescribed)

    def _arrived(self, reason: str, found: Measured) -> Termination:
        """The end of a run that has met its rule.

        Along a motion that lowers the energy for ever contact forces do no negative work. So the residual is at least
        what the loads do there, and a small one excludes such a motion; a coarse rule has to ask for it.
        """
        if not len(self.history):  # later iterates' energies are in their records
            try:
                self._energy(self.state, found.forces)
            except NotANumberError as error:
                return Termination("diverged", f"{error} at the start")
        if found.residual * found.scale <= BALANCED * self.ensemble.load_size:
            return Termination("converged", reason)
        return self._ending("converged", reason)

    def _ending(self, status: str, reason: str) -> Termination:
        """The end of a run for this reason, unless there is a deeper one: no equilibrium."""
        way = self._unbounded_motion
        return Termination(status, reason) if way is None else Termination("no equilibrium", str(way), way)


def _no_coefficient(interface: Interface, phi: Floats, z: Floats) -> str:
    """The message on the first coefficient, (points,) or a row for each body, that is no finite number."""
    at = np.unravel_index(int(np.argmin(np.isfinite(phi))), phi.shape)
    return _no_number(interface, f"coefficient φ {phi[at]:g} at the gap {z[at[-1]]:.6g}")


def _no_number(interface: Interface, what: str) -> str:
    """The message that names the contact and the layer of a quantity that is no finite number."""
    return f"contact {interface.contact.name!r}: its {type(interface.layer).__name__} gives the {what}"
