"""Newton's system (17) by conjugate gradients whose every step solves the bodies independently."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
import scipy

from ..base.arrays import Floats
from ..base.ranks import Ranks
from ..base.sparse import along_diagonal
from ..local.problem import Solver
from ..system.ensemble import Ensemble
from ..system.state import Phi

#: Steps in which the preconditioned residual may rise before it falls again. It is the energy that falls with every
#: step: under multigrid of elements of high degree, or nearly incompressible, the residual rises for more than 25.
PATIENCE = 100


#: The same where all these steps together lower the energy by less than the part NO_GAIN of it: the error in the
#: energy's norm is then some 1e-7, far below what a Newton correction needs.
IMPATIENCE, NO_GAIN = 25, 1e-14


class Krylov:
    """The coupled system by conjugate gradients, preconditioned by the bodies' own solves and a coarse space.

    The coarse space holds what the bodies' solves see badly: their rigid motions and the lowest modes of
    S v = λ (S + Φ) v, in which the interface moves as a wave and the layer hardly notices.
    """

    #: Modes below this are put into the coarse space; 0.2 bounds the condition of the rest by about 10.
    LOWEST = 0.2
    #: Reduction of the residual of each Newton correction by the Krylov method: with 1e-4 bodies take a quarter more
    #: solves, with 1e-2 Newton's method a step more.
    FORCING = 1e-3

    def __init__(self, ensemble: Ensemble, ranks: Ranks, note: str = "") -> None:
        self._ensemble, self._ranks = ensemble, ranks
        self.body_solves, self.note = 0, note

    def correct(self, phi: Phi, residual: Floats, scale: float) -> Floats:
        rigid = self._ensemble.rigid
        rigid.fixing_dofs(phi, residual, scale)  # only its check
        # On free motions only rounding does work: it is removed from the forces, and the motions from the steps.
        free = np.linalg.qr(rigid.free_displacements(phi))[0]
        rhs = residual - free @ (free.T @ residual)
        coarse = self._coarse_space(phi)
        image = self._ensemble.tangent(phi, coarse)
        inverse = pseudo_inverse(coarse.T @ image, rigid.stiffness_scale)
        held = self._held(phi)

        def precondition(vector: Floats) -> Floats:
            corrections = self._precondition(held, vector)
            return corrections - free @ (free.T @ corrections)

        def project(vector: Floats) -> Floats:
            return vector - coarse @ (inverse @ (image.T @ vector))

        start = coarse @ (inverse @ (coarse.T @ rhs))
        return deflated_conjugate_gradients(
            lambda vector: self._ensemble.tangent(phi, vector),
            precondition,
            project,
            rhs,
            start,
            self.FORCING,
        )

    def _held(self, phi: Phi) -> dict[int, Solver]:
        """(S + Φ)⁻¹ of each body that this rank holds, by its index: factors stay where they are made."""
        held = {}

        def make(body_index: int) -> None:
            held[body_index] = self._ensemble.problems[body_index].robin_solver(phi)

        self._ranks.each(make)
        return held

    def _precondition(self, held: Mapping[int, Solver], vector: Floats) -> Floats:
        """(S + Φ)⁻¹ of every body, independently."""
        forces = self._ensemble.split(vector)
        self.body_solves += len(forces)
        return np.concatenate(self._ranks.each(lambda i: held[i](forces[i])))

    def _coarse_space(self, phi: Phi) -> Floats:
        """Rigid motions and lowest modes, orthonormal, (all unknowns, modes)."""

        def of(body_index: int) -> Floats:
            problem = self._ensemble.problems[body_index]
            modes = np.hstack([problem.rigid.modes, problem.low_modes(phi, self.LOWEST)])
            return scipy.linalg.orth(modes, rcond=1e-10) if modes.shape[1] else modes

        return along_diagonal(self._ranks.each(of))


def deflated_conjugate_gradients(
    apply: Callable[[Floats], Floats],
    precondition: Callable[[Floats], Floats],
    project: Callable[[Floats], Floats],
    rhs: Floats,
    start: Floats,
    reduction: float,
    most: int = 500,
    patience: int = PATIENCE,
) -> Floats:
    """The solution of a positive (semi)definite system whose coarse part `start` has solved already.

    apply: the matrix times a vector; project: takes the coarse space out of a search direction. Ends when the
    preconditioned residual has fallen to the part `reduction` of what it was at the start, or for `patience` steps not
    at all, as where only rounding is left; every iterate lowers the energy, so that it is a descent direction whenever
    it ends. `patience` is shorter where the energy no longer falls, for then only rounding is left.
    """
    solution, residual = start.copy(), rhs - apply(start)
    preconditioned = precondition(residual)
    direction = project(preconditioned)
    square = residual @ preconditioned
    # Rounding of the coarse solve is all that is left where the coarse space holds the solution.
    goal = max(square * reduction**2, 1e-28 * abs(rhs @ start))
    best, best_at, smallest = solution.copy(), 0, square
    energy, gains = abs(rhs @ start), [math.inf] * IMPATIENCE
    for step in range(most):
        if square < smallest:
            best, best_at, smallest = solution.copy(), step, square
        if square <= goal or step - best_at >= patience:
            break
        if step - best_at >= IMPATIENCE and sum(gains[-IMPATIENCE:]) <= NO_GAIN * energy:
            break
        image = apply(direction)
        curvature = direction @ image
        if curvature <= 0.0:  # nothing but rounding is left
            break
        length = square / curvature
        gains.append(float(length * square))
        energy += gains[-1]
        solution += length * direction
        residual -= length * image
        preconditioned = precondition(residual)
        square, before = residual @ preconditioned, square
        direction = project(preconditioned) + (square / before) * direction
    return solution if square < smallest else best


def pseudo_inverse(matrix: Floats, largest: float) -> Floats:
    """The pseudo-inverse of a symmetric matrix, whose null space are motions of all bodies that nothing resists.

    largest: the stiffness in whose rounding such motions' resistance is lost.
    """
    values, vectors = np.linalg.eigh(matrix)
    kept = values > 1e-14 * max(largest, values.max(initial=0.0))
    return (vectors[:, kept] / values[kept]) @ vectors[:, kept].T
