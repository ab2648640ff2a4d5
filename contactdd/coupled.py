"""The not decomposed step: one linear system for all bodies, the reference for the decomposed ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from .factor import Factor
from .interface import Interface
from .rigid import joint_motions
from .subproblem import Subproblem, product_map

Floats = NDArray[np.float64]

#: Unknowns up to which one dense Cholesky factorisation beats a sparse one of the same blocks.
LARGEST_DENSE = 600


class CoupledSystem:
    """A + Σ ∫ φ [u_αn + u_βn][v_αn + v_βn], in the unknowns of all bodies one after another.

    rigid: the free rigid motions of the bodies together; factored: whether `correct` will be asked for.
    """

    def __init__(
        self, problems: Sequence[Subproblem], interfaces: Sequence[Interface], *, factored: bool = True
    ) -> None:
        self._problems, self._interfaces = problems, interfaces
        self._ends = np.cumsum([problem.size for problem in problems])
        condensed = all(isinstance(problem.stiffness, np.ndarray) for problem in problems)
        self._dense = condensed and self._ends[-1] <= LARGEST_DENSE
        if factored:
            blocks = [problem.stiffness for problem in problems]
            if self._dense:
                self._stiffness = scipy.linalg.block_diag(*blocks)
            else:
                self._stiffness = scipy.sparse.block_diag(
                    [scipy.sparse.csr_matrix(block) for block in blocks], format="csr"
                )
        self._sums = [self._sum_of_traces(index) for index in range(len(interfaces))]
        self.rigid = joint_motions(problems, interfaces)

    def correct(self, phi: Mapping[int, Floats], residuals: Sequence[Floats], scale: float) -> list[Floats]:
        """The Newton correction of every body's unknowns.

        phi: the coefficient at the points of each interface; scale: the size of the forces at work. Raises
        LooseBodyError where nothing holds the bodies.
        """
        rhs = np.concatenate(residuals)
        ground = self.rigid.ground(phi, rhs, scale)
        correction = (self._solve_dense if self._dense else self._solve_sparse)(phi, rhs, ground)
        return np.split(correction, self._ends[:-1])

    def _solve_dense(self, phi: Mapping[int, Floats], rhs: Floats, ground: NDArray[np.intp]) -> Floats:
        matrix = self._stiffness.copy()
        for index, (places, weights) in enumerate(self._maps):
            matrix.ravel()[places] += weights @ phi[index]
        matrix[ground, ground] += self.rigid.largest
        _, solution, info = scipy.linalg.lapack.dposv(matrix, rhs, overwrite_a=True)
        if info != 0:
            raise np.linalg.LinAlgError("the coupled system is not positive definite")
        return solution

    def _solve_sparse(self, phi: Mapping[int, Floats], rhs: Floats, ground: NDArray[np.intp]) -> Floats:
        held = np.zeros(len(rhs))
        held[ground] = self.rigid.largest
        matrix = self._stiffness + scipy.sparse.diags(held)
        for index, total in enumerate(self._sums):
            matrix = matrix + total.T @ scipy.sparse.diags(self._interfaces[index].weights * phi[index]) @ total
        return Factor(matrix.tocsr()).solve(rhs)

    @cached_property
    def _maps(self) -> list[tuple[NDArray[np.intp], scipy.sparse.csr_matrix]]:
        """Where the contacts' terms stand in the dense matrix, and the operators from φ to their entries."""
        return [product_map(total, i.weights) for total, i in zip(self._sums, self._interfaces, strict=True)]

    def apply(self, phi: Mapping[int, Floats], unknowns: Floats) -> Floats:
        """The system times a vector."""
        parts = np.split(unknowns, self._ends[:-1])
        result = np.concatenate([p.stiffness @ p.deformation(y) for p, y in zip(self._problems, parts, strict=True)])
        for index, total in enumerate(self._sums):
            result += total.T @ (self._interfaces[index].weights * phi[index] * (total @ unknowns))
        return result

    def _sum_of_traces(self, index: int) -> scipy.sparse.csr_matrix:
        """The operator from all unknowns to u_αn + u_βn at the points of an interface."""
        points = len(self._interfaces[index].weights)
        blocks = []
        for problem in self._problems:
            traces = [port.trace for port in problem.ports if port.interface == index]
            blocks.append(sum(traces[1:], traces[0]) if traces else scipy.sparse.csr_matrix((points, problem.size)))
        return scipy.sparse.hstack(blocks, format="csr")
