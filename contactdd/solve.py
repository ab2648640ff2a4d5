"""The driver: independent linear solves per body, then the relaxation, until the stopping rule holds."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .coupled import CoupledSystem
from .errors import LooseBodyError, NotConvergedError, one_of, positive
from .history import History, Record
from .line_search import minimise_along
from .progress import Progress
from .scene import Scene
from .scheme import Scheme, find_scheme
from .solution import Solution
from .subproblem import Subproblem

Floats = NDArray[np.float64]
Gamma = float | Iterable[float] | Callable[[int], float] | str

#: Iterations after which a run has to have come closer, or it is called stalled.
STALL_WINDOW = 250


@dataclass
class State:
    """The iterate: the bodies' unknowns, the gaps z^k and z^{k−1}."""

    unknowns: list[Floats]
    gaps: list[Floats]
    previous_gaps: list[Floats]


def solve(
    scene: Scene,
    method: str | Scheme = "chord",
    *,
    gamma: Gamma = 0.6,
    tolerance: float = 1e-8,
    criterion: str = "residual",
    max_iterations: int = 5000,
    start: float | Solution | None = None,
    previous: float | None = None,
    local_solver: str = "condensed",
    callback: Callable[[Record], bool | None] | None = None,
    progress: bool | None = None,
    on_failure: str = "raise",
) -> Solution:
    """Solve the contact problem (15) of a scene.

    method: "one-point" (22), "chord" (32), "kurchatov" (36), "neumann", "robin", the coupled "newton" (17),
        "newton-chord" (26), "newton-kurchatov" (27), or a `Scheme`.
    gamma: the relaxation γ > 0: a number, a sequence, a function of the iteration, or "search" for the minimum of F₁.
    tolerance, criterion: "residual" asks for ‖F₁'(u)‖ relative to the forces at work; "change" is the paper's rule,
        ‖u_n^{k+1} − u_n^k‖₂ ≤ tolerance ‖u_n^{k+1}‖₂ for every body.
    start: u_n at all contact points (length), a `Solution` to go on from, or None: every contact carries the mean load.
    previous: u_n of the iterate before the start, for the two-point methods (by default the start itself).
    local_solver: "condensed" (each body seen from its contacts) or "assembled" (reassemble and refactor every time).
    callback: called with each iteration's `Record`; the run ends when it returns True.
    progress: show a progress bar; by default when somebody watches.
    on_failure: "raise" NotConvergedError, or "return" the solution with its status.
    """
    scheme = find_scheme(method)
    positive("tolerance", tolerance)
    if int(max_iterations) != max_iterations or max_iterations < 1:
        raise ValueError(f"max_iterations = {max_iterations!r}: expected a whole number >= 1")
    one_of("criterion", criterion, ("residual", "change"))
    one_of("on_failure", on_failure, ("raise", "return"))
    relaxation = _relaxation(gamma)
    problems = scene.subproblems(local_solver)
    run = _Run(scene, scheme, problems, _start(scene, problems, start, previous))
    with Progress(progress, tolerance, criterion) as bar:
        status, reason = run.iterate(relaxation, tolerance, criterion, max_iterations, callback, bar)
    solution = Solution(scene, problems, run.state.unknowns, run.history, status, reason, scheme.name)
    if status not in ("converged", "stopped") and on_failure == "raise":
        raise NotConvergedError(status, reason, solution)
    return solution


class _Run:
    """One run of the driver: its state and its history."""

    def __init__(self, scene: Scene, scheme: Scheme, problems: Sequence[Subproblem], state: State) -> None:
        self.scene, self.scheme, self.problems, self.state = scene, scheme, problems, state
        self.history = History()
        self.points = [interface.x.T for interface in scene.interfaces]
        self.coupled = None if scheme.decomposed else CoupledSystem(problems, scene.interfaces)
        self.size = max(float(np.ptp(body.mesh.domain.geometry.x, axis=0).max()) for body in scene.bodies)
        self.began = time.process_time()

    def iterate(
        self,
        relaxation: Iterator[float | None],
        tolerance: float,
        criterion: str,
        max_iterations: int,
        callback: Callable[[Record], bool | None] | None,
        bar: Progress,
    ) -> tuple[str, str]:
        """Iterate to the end; the status and the reason in words."""
        best, best_at = np.inf, 0
        for k in range(1, max_iterations + 1):
            tractions = self.scene.tractions(self.state.gaps)
            residuals = self.residuals(tractions)
            scale = self.scale(tractions)
            residual = norm(residuals) / scale if scale > 0.0 else 0.0
            if criterion == "residual" and residual <= tolerance:
                return "converged", f"residual {residual:.2e} after {k - 1} iterations"
            try:
                record = self.step(k, next(relaxation), residuals, scale)
            except LooseBodyError as error:
                return "diverged", f"{error} in iteration {k}"
            except StopIteration:
                return "iteration limit", f"gamma ended after {k - 1} values at residual {residual:.2e}"
            self.history.append(record)
            bar.update(record)
            if callback is not None and callback(record):
                return "stopped", f"by the callback in iteration {k}"
            measure = record.change if criterion == "change" else residual
            if criterion == "change" and record.change <= tolerance:
                return "converged", f"change {record.change:.2e} after {k} iterations"
            if not self.bounded():
                return "diverged", f"displacements exceed the bodies' size a hundred times in iteration {k}"
            if measure < 0.99 * best:
                best, best_at = measure, k
            elif k - best_at >= STALL_WINDOW:
                return (
                    "stalled",
                    f"no progress in {STALL_WINDOW} iterations; {criterion} {measure:.2e} at best {best:.2e}",
                )
        return "iteration limit", f"{criterion} {measure:.2e} after {max_iterations} iterations"

    def step(self, k: int, gamma: float | None, residuals: list[Floats], scale: float) -> Record:
        """One iteration (16): φ^k, the corrections ũ − u^k, the relaxation."""
        state, phi = self.state, {}
        for index, interface in enumerate(self.scene.interfaces):
            z, z_previous = state.gaps[index], state.previous_gaps[index]
            phi[index] = self.scheme.coefficient(interface.contact.layer, z, z_previous, self.points[index])
        energy = self.scene.energy(self.problems, state.unknowns, state.gaps)
        if self.coupled is None:
            corrections = [p.correct(phi, r, scale) for p, r in zip(self.problems, residuals, strict=True)]
        else:
            corrections = self.coupled.correct(phi, residuals, scale)
        if gamma is None:
            gamma = self.search(corrections, residuals)
        contact = sum(float(i.weights[z < 0].sum()) for i, z in zip(self.scene.interfaces, state.gaps, strict=True))
        self.state = self.relaxed(corrections, gamma)
        return Record(
            iteration=k,
            gamma=gamma,
            change=self.change(corrections, gamma),
            residual=norm(residuals) / scale,
            energy=energy,
            contact=contact,
            phi_min=min(float(values.min()) for values in phi.values()),
            phi_max=max(float(values.max()) for values in phi.values()),
            seconds=time.process_time() - self.began,
        )

    def relaxed(self, corrections: Sequence[Floats], gamma: float) -> State:
        """u^{k+1} = γ ũ + (1 − γ) u^k, eqs. (23), (33), (37)."""
        unknowns = [y + gamma * delta for y, delta in zip(self.state.unknowns, corrections, strict=True)]
        return State(unknowns, self.scene.gaps(self.problems, unknowns), self.state.gaps)

    def residuals(self, tractions: list[Floats]) -> list[Floats]:
        return [p.residual(y, tractions) for p, y in zip(self.problems, self.state.unknowns, strict=True)]

    def scale(self, tractions: list[Floats]) -> float:
        """The size of the forces at work: loads and contact forces."""
        forces = [problem.load for problem in self.problems]
        forces += [port.trace.T @ tractions[port.interface] for problem in self.problems for port in problem.ports]
        return norm(forces)

    def search(self, corrections: Sequence[Floats], residuals: Sequence[Floats]) -> float:
        """γ^k that minimises F₁ along the corrections.

        The slope is written with divided differences, so that nothing cancels near the minimum.
        """
        descent = sum(float(r @ delta) for r, delta in zip(residuals, corrections, strict=True))
        elastic = sum(float(d @ (p.stiffness @ d)) for p, d in zip(self.problems, corrections, strict=True))
        moves = self.scene.closing(self.problems, corrections)
        contacts = [
            (interface.contact.layer, z, move, interface.weights * move**2)
            for interface, z, move in zip(self.scene.interfaces, self.state.gaps, moves, strict=True)
        ]

        def slope(t: float) -> float:
            layers = sum(float(w @ layer.divided_difference(z - t * m, z)) for layer, z, m, w in contacts)
            return t * (elastic + layers) - descent

        return minimise_along(slope)

    def change(self, corrections: Sequence[Floats], gamma: float) -> float:
        """The paper's measure of change, the largest over the bodies. To be called after the relaxation."""
        largest = 0.0
        for problem, delta, y in zip(self.problems, corrections, self.state.unknowns, strict=True):
            moved = np.linalg.norm(problem.nodal_trace @ (gamma * delta))
            size = np.linalg.norm(problem.nodal_trace @ y + problem.nodal_offset)
            largest = max(largest, float(moved / size) if size > 0.0 else float(moved > 0.0))
        return largest

    def bounded(self) -> bool:
        """Whether the displacements are finite and not absurd."""
        return all(
            bool(np.all(np.isfinite(z))) and float(np.abs(z - interface.gap).max()) < 100 * self.size
            for z, interface in zip(self.state.gaps, self.scene.interfaces, strict=True)
        )


def norm(vectors: Sequence[Floats]) -> float:
    """The Euclidean norm of several vectors together."""
    return float(np.sqrt(sum(float(v @ v) for v in vectors)))


def _relaxation(gamma: Gamma) -> Iterator[float | None]:
    """γ^0, γ^1, … of whatever the user gave; None where it is to be searched."""
    if isinstance(gamma, str):
        one_of("gamma", gamma, ("search",))
        return iter(lambda: None, 0)
    if callable(gamma):
        return (positive("gamma", gamma(k)) for k in range(10**9))
    if np.ndim(gamma) > 0:
        values = [positive("gamma", value) for value in gamma]
        return iter(values)
    number = positive("gamma", gamma)
    return iter(lambda: number, None)


def _start(
    scene: Scene, problems: Sequence[Subproblem], start: float | Solution | None, previous: float | None
) -> State:
    """The first iterate and the one before it."""
    if isinstance(start, Solution):
        unknowns = [p.restrict(start.displacement(p.body.name).x.array) for p in problems]
    elif start is not None:
        given = {index: np.full(len(i.weights), float(start)) for index, i in enumerate(scene.interfaces)}
        unknowns = [problem.start(given) for problem in problems]
    else:
        given = _mean_load_displacements(scene, problems)
        unknowns = [problem.start(given) for problem in problems]
    gaps = scene.gaps(problems, unknowns)
    before = gaps if previous is None else [i.gap - 2.0 * float(previous) for i in scene.interfaces]
    return State(unknowns, gaps, before)


def _mean_load_displacements(scene: Scene, problems: Sequence[Subproblem]) -> dict[int, Floats]:
    """u_n that closes every contact until it carries the largest mean load of a body on its contacts."""
    stress = 0.0
    for problem in problems:
        area = sum(float(scene.interfaces[port.interface].weights.sum()) for port in problem.ports)
        resultant = problem.full_load.reshape(-1, problem.body.mesh.dim).sum(axis=0)
        stress = max(stress, float(np.linalg.norm(resultant)) / area)
    compression = [float(contact.layer.compression(np.array(-stress))) for contact in scene.contacts]
    return {index: 0.5 * (i.gap - w) for index, (i, w) in enumerate(zip(scene.interfaces, compression, strict=True))}
