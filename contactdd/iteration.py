"""The iteration itself: φ^k, the bodies' corrections, the relaxation, until the stopping rule or an honest end."""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .anderson import Anderson
from .equilibrium import BALANCED, escape
from .errors import LooseBodyError
from .history import History, Record
from .line_search import minimise_along
from .multigrid import MultigridSubproblem
from .scene import Scene
from .scheme import Scheme
from .start import State
from .step import Apart, Direct, Krylov, Step
from .subproblem import Subproblem

Floats = NDArray[np.float64]
Observer = Callable[[Record], bool]

#: Contact unknowns of a body up to which "auto" factors the coupled system, or as many in more bodies as make no more
#: entries: those of one body are all coupled, those of different ones only across their contacts.
LARGEST_DIRECT = 6000
#: Where the slope of the energy is less than this part of the layers' work, differences of that work are too rough.
CANCELLED = 1e-8
#: What a measure has to fall to for the run to have come closer.
PROGRESS = 0.99


@dataclass(frozen=True)
class Rule:
    """When a run ends.

    tolerance: of the criterion, "residual" or "change"; most: iterations; patience: iterations without any progress
    after which the run is called stalled.
    """

    tolerance: float
    criterion: str
    most: int
    patience: int

    #: The residual may be this many times the change that the step would have made without its relaxation: over the
    #: whole of Table 1 it is up to 0.91; where the change is small for another reason it is many times as large.
    EXPLAINED = 2.0
    #: Above this no residual is small, however small γ.
    LARGE = 0.1

    def distance(self, residual: float, last: Record | None) -> float:
        """How far a run is from its goal, 1 at the goal: by its residual now and the change of its last iteration.

        A small change alone proves nothing: a small γ makes small steps from anywhere, and a body that drifts away
        makes them relatively small. So the residual must be what the change without its relaxation explains.
        """
        if self.criterion == "residual":
            return residual / self.tolerance
        if last is None:
            return np.inf
        explained = min(self.EXPLAINED * self.tolerance / min(last.gamma, 1.0), self.LARGE)
        return max(last.change / self.tolerance, residual / explained)


@dataclass(frozen=True)
class Ending:
    """How a run ended: its status, the reason in words, and what moves for ever where there is no equilibrium."""

    status: str
    reason: str
    escape: LooseBodyError | None = None


class Run:
    """One run: the iterate `state` and the `history`.

    linear: the linear problem of an iteration; history, memory: of an earlier run that this one goes on from.
    """

    def __init__(
        self,
        scene: Scene,
        scheme: Scheme,
        problems: Sequence[Subproblem],
        linear: Step,
        state: State,
        history: History | None = None,
        memory: Sequence[Floats] = (),
    ) -> None:
        self.scene, self.scheme, self.problems, self.linear, self.state = scene, scheme, problems, linear, state
        self.history = History() if history is None else history
        self.anderson = Anderson() if scheme.accelerated else None
        if self.anderson is not None:
            self.anderson.memory = memory
        self._points = [interface.x.T for interface in scene.interfaces]
        self._size = max(body.mesh.size for body in scene.bodies)
        self._loads = norm([problem.load for problem in problems])
        stiffest = max(problem.rigid.largest for problem in problems)  # and the φ that is as stiff as that
        self._stiffest = [stiffest / interface.weights for interface in scene.interfaces]
        self._first_force = 0.0
        self._at_nodes = False
        self._began = time.process_time()

    def iterate(self, gammas: Iterator[float | None], rule: Rule, observe: Observer) -> Ending:
        """Iterate to the end, from where the history ends.

        gammas: γ^0, γ^1, …, None where it is to be searched; observe: told of every iteration, ends the run by
        returning True.
        """
        done, self._at_nodes = len(self.history), rule.criterion == "change"
        gammas = itertools.islice(gammas, done, None)
        last = self.history[-1] if done else None
        best, best_at = self._best_so_far(rule)
        for k in range(done, rule.most + 1):  # k iterations are done
            if not self._bounded():
                return self._ending(
                    "diverged", f"displacements exceed the bodies' size a hundred times in iteration {k}"
                )
            tractions = self.scene.tractions(self.state.gaps)
            contact = self._contact_forces(tractions)
            residuals = self._residuals(contact)
            scale = self._scale(residuals, contact)
            residual = self.scene.ranks.agree(norm(residuals) / scale if scale > 0.0 else 0.0)
            distance = rule.distance(residual, last)
            reached = f"residual {residual:.2e}" + (f", change {last.change:.2e}" if last else "")
            if distance <= 1.0:
                return self._arrived(f"{reached} after {k} iterations", residual * scale)
            if distance < PROGRESS * best:
                best, best_at = distance, k
            elif k - best_at >= rule.patience:
                return self._ending("stalled", f"no progress in {rule.patience} iterations: {reached}")
            if k == rule.most:
                break
            try:
                last = self._iteration(k + 1, next(gammas), tractions, residuals, scale, residual)
            except LooseBodyError as error:
                return self._ending("diverged", f"{error} in iteration {k + 1}")
            except StopIteration:
                return Ending("iteration limit", f"gamma ended after {k} values: {reached}")
            self.history.append(last)
            if observe(last):
                return Ending("stopped", f"as asked in iteration {k + 1}")
        return self._ending("iteration limit", f"{reached} after {rule.most} iterations")

    def _best_so_far(self, rule: Rule) -> tuple[float, int]:
        """The smallest distance in the history, and after how many iterations it was reached."""
        best, best_at, last = np.inf, 0, None
        for done, record in enumerate(self.history):
            distance = rule.distance(record.residual, last)
            if distance < PROGRESS * best:
                best, best_at = distance, done
            last = record
        return best, best_at

    def _iteration(
        self,
        k: int,
        gamma: float | None,
        tractions: list[Floats],
        residuals: list[Floats],
        scale: float,
        residual: float,
    ) -> Record:
        """One iteration (16), (25)."""
        state, phi = self.state, self._coefficients()
        energy = self.scene.energy(self.problems, state)
        corrections, phi, note = self._corrections(
            phi, residuals, scale, survive=gamma is None or self.anderson is not None
        )
        length = self._search(corrections, tractions, residuals) if gamma is None else gamma
        if self.anderson is None:
            steps = [length * delta for delta in corrections]
        else:
            steps, restart = self._accelerated(corrections, tractions, residuals, length, energy)
            note = ", ".join(filter(None, (note, restart)))
        contact = sum(float(i.weights @ (z < 0)) for i, z in zip(self.scene.interfaces, state.gaps, strict=True))
        self.state = self._moved(self.scene.ranks.agree(steps))
        return Record(
            iteration=k,
            gamma=length,
            change=self._change(steps),
            residual=residual,
            energy=energy,
            contact=contact,
            phi_min=min(float(values.min()) for values in phi.values()),
            phi_max=max(float(values.max()) for values in phi.values()),
            body_solves=self.linear.body_solves,
            seconds=time.process_time() - self._began,
            note=", ".join(filter(None, (self.linear.note if k == 1 else "", note))),
        )

    def _coefficients(self) -> dict[int, Floats]:
        """φ^k at the points of every interface."""
        phi, state = {}, self.state
        for index, interface in enumerate(self.scene.interfaces):
            z, before, x = state.gaps[index], state.previous_gaps[index], self._points[index]
            values = self.scheme.coefficient(interface.contact.layer, z, before, x)
            # A law with g'(0) = ∞ would drown the bodies' stiffness; this much more of it is rigid enough.
            phi[index] = np.minimum(values, 1e8 * self._stiffest[index])
        return phi

    def _corrections(
        self, phi: dict[int, Floats], residuals: list[Floats], scale: float, survive: bool
    ) -> tuple[list[Floats], dict[int, Floats], str]:
        """ũ − u of every body, the coefficient that was used, and a note on it.

        A contact that opens for a moment leaves bodies that nothing holds. Where the energy watches over the step
        (survive), they are then held by a soft Robin term everywhere: the step still lowers the energy.
        """
        try:
            return self.linear.correct(phi, residuals, scale), phi, ""
        except LooseBodyError:
            if not survive or self._escape is not None:
                raise
        phi = self._softened(phi, residuals)
        return self.linear.correct(phi, residuals, scale), phi, "open: held by a soft Robin term"

    @cached_property
    def _escape(self) -> LooseBodyError | None:
        """What moves for ever where there is no equilibrium."""
        return escape(self.problems, self.linear.rigid)

    def _softened(self, phi: dict[int, Floats], residuals: list[Floats]) -> dict[int, Floats]:
        """φ with a soft Robin term wherever it is softer.

        It is the unbalanced forces over the contacts' area and the largest gap: a body moves by about that gap. It is
        no stiffer than the bodies, for the next step goes further, but not lost in the rounding of what is stiffest.
        """
        forces = max(float(np.abs(r).sum()) for r in residuals)
        area = sum(float(interface.weights.sum()) for interface in self.scene.interfaces)
        gap = max(float(np.abs(z).max()) for z in self.state.gaps)
        soft = forces / area / (gap if gap > 1e-12 * self._size else self._size)  # coordinates are no better than that
        soft = max(soft, 1e-10 * max(float(values.max()) for values in phi.values()))
        return {index: np.maximum(values, np.minimum(soft, self._stiffest[index])) for index, values in phi.items()}

    def _accelerated(
        self,
        corrections: list[Floats],
        tractions: list[Floats],
        residuals: list[Floats],
        gamma: float,
        energy: float,
    ) -> tuple[list[Floats], str]:
        """Anderson's step, or the best plain one where that would raise the energy."""
        y = np.concatenate(self.state.unknowns)
        ends = np.cumsum([len(part) for part in self.state.unknowns])[:-1]
        steps = np.split(self.anderson.step(y, np.concatenate(corrections), gamma), ends)
        moved = self._moved(steps)
        reached = self.scene.energy(self.problems, moved)
        # Near the solution energies differ by less than their own rounding.
        if np.isfinite(reached) and reached <= energy + 1e-12 * abs(energy):
            return steps, ""
        self.anderson.restart()
        best = self._search(corrections, tractions, residuals)
        return [best * delta for delta in corrections], "restarted: the energy would have risen"

    def _moved(self, steps: Sequence[Floats]) -> State:
        """u^{k+1}, eqs. (23), (33), (37)."""
        unknowns = [y + step for y, step in zip(self.state.unknowns, steps, strict=True)]
        deformations = [
            e + p.deformation(step) for p, e, step in zip(self.problems, self.state.deformations, steps, strict=True)
        ]
        return State(unknowns, deformations, self.scene.gaps(self.problems, unknowns), self.state.gaps)

    def _contact_forces(self, tractions: list[Floats]) -> list[list[Floats]]:
        """What every contact of every body does to its unknowns."""
        return [[port.trace.T @ tractions[port.interface] for port in problem.ports] for problem in self.problems]

    def _residuals(self, contact: list[list[Floats]]) -> list[Floats]:
        """−F₁'(u) of every body: loads and contact forces less the elastic forces."""
        bodies = zip(self.problems, self.state.deformations, contact, strict=True)
        return [sum(forces, p.load - p.stiffness @ deformation) for p, deformation, forces in bodies]

    def _scale(self, residuals: list[Floats], contact: list[list[Floats]]) -> float:
        """The size of the forces at work: loads and contact forces, or the first residual where there are none."""
        size = math.hypot(self._loads, *map(norm, contact))
        if size == 0.0:
            self._first_force = size = max(self._first_force, norm(residuals))
        return size

    def _search(self, corrections: Sequence[Floats], tractions: Sequence[Floats], residuals: Sequence[Floats]) -> float:
        """γ^k that minimises F₁ along the corrections.

        The slope takes the growth of the layers' work; near the minimum, where that cancels, by divided differences.
        """
        descent = sum(float(r @ delta) for r, delta in zip(residuals, corrections, strict=True))
        parts = [p.deformation(delta) for p, delta in zip(self.problems, corrections, strict=True)]
        elastic = sum(float(e @ (p.stiffness @ e)) for p, e in zip(self.problems, parts, strict=True))
        moves = self.scene.closing(self.problems, corrections)
        works = [move * traction for move, traction in zip(moves, tractions, strict=True)]
        work = sum(float(part.sum()) for part in works)
        cancels = descent < CANCELLED * sum(float(np.abs(part).sum()) for part in works)
        contacts = [
            (interface.contact.layer, z, move, interface.weights * move)
            for interface, z, move in zip(self.scene.interfaces, self.state.gaps, moves, strict=True)
        ]

        def growth(t: float) -> float:
            """How much more the layers resist the corrections at t than at 0."""
            if cancels:
                return t * sum(float((w * m) @ layer.divided_difference(z - t * m, z)) for layer, z, m, w in contacts)
            return work - sum(float(w @ layer.contact_stress(z - t * m)) for layer, z, m, w in contacts)

        return minimise_along(lambda t: t * elastic + growth(t) - descent if t else -descent)

    def _change(self, steps: Sequence[Floats]) -> float:
        """The largest relative change of a body's u_n; to be asked after the move."""
        largest = 0.0
        for problem, step, y in zip(self.problems, steps, self.state.unknowns, strict=True):
            moved, size = (math.sqrt(u_n @ u_n) for u_n in problem.normal_displacements(step, y, self._at_nodes))
            largest = max(largest, moved / size if size > 0.0 else float(moved > 0.0))
        return largest

    def _bounded(self) -> bool:
        """Whether the displacements are finite and not absurd."""
        return all(
            bool(np.abs(z - interface.gap).max() < 100 * self._size)  # false also of what is not a number
            for z, interface in zip(self.state.gaps, self.scene.interfaces, strict=True)
        )

    def _arrived(self, reason: str, residual: float) -> Ending:
        """The end of a run that has met its rule; residual: ‖F₁'‖, not relative.

        Along a motion that lowers the energy for ever contact forces do no negative work. So the residual is at least
        what the loads do there, and a small one excludes such a motion; a coarse rule has to ask for it.
        """
        if residual <= BALANCED * self._loads:
            return Ending("converged", reason)
        return self._ending("converged", reason)

    def _ending(self, status: str, reason: str) -> Ending:
        """The end of a run for this reason, unless there is a deeper one: no equilibrium."""
        way = self._escape
        return Ending(status, reason) if way is None else Ending("no equilibrium", str(way), way)


def norm(vectors: Sequence[Floats]) -> float:
    """The Euclidean norm of several vectors together."""
    return math.sqrt(sum(float(v @ v) for v in vectors))


def find_step(scheme: Scheme, problems: Sequence[Subproblem], scene: Scene) -> Step:
    """The kind of linear problem that the scheme asks for, or the one that suits the scene where it leaves it open."""
    if scheme.step == "apart":
        return Apart(problems, scene.interfaces, scene.ranks)
    unknowns = sum(problem.size for problem in problems)
    entries = sum(problem.size**2 for problem in problems)
    small = entries <= LARGEST_DIRECT**2 and not any(isinstance(p, MultigridSubproblem) for p in problems)
    if scheme.step == "direct" or (scheme.step == "auto" and small):
        note = f"auto: coupled Newton, {unknowns} unknowns factored" if scheme.step == "auto" else ""
        return Direct(problems, scene.interfaces, note)
    note = f"auto: Newton with Krylov steps, {unknowns} unknowns" if scheme.step == "auto" else ""
    return Krylov(problems, scene.interfaces, scene.ranks, note)
