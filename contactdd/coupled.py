"""The not decomposed step: one linear system for all bodies, the reference for the decomposed ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from numpy.typing import NDArray

from .factor import Factor
from .interface import Interface
from .rigid import joint_motions
from .subproblem import Subproblem

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
                self._stiffness = sp.block_diag([sp.csr_matrix(block) for block in blocks], format="csr")
        self._sums = [self._sum_of_traces(index) for index in range(len(interfaces))]
        self.rigid = joint_motions(problems, interfaces)

    def correct(self, phi: Mapping[int, Floats], residuals: Sequence[Floats], scale: float) -> list[Floats]:
        """The Newton correction of every body's unknowns.

        phi: the coefficient at the points of each interface; scale: the size of the forces at work. Raises
        LooseBodyError where nothing holds the bodies.
        """
        matrix, rhs = self._stiffness, np.concatenate(residuals)
        ground = np.zeros(len(rhs))
        ground[self.rigid.ground(phi, rhs, scale)] = self.rigid.largest
        for index, total in enumerate(self._sums):
            term = total.T @ sp.diags(self._interfaces[index].weights * phi[index]) @ total
            matrix = matrix + (term.toarray() if self._dense else term)
        if self._dense:
            matrix[np.diag_indices(len(rhs))] += ground
            correction = scipy.linalg.solve(matrix, rhs, assume_a="pos", overwrite_a=True)
        else:
            correction = Factor((matrix + sp.diags(ground)).tocsr()).solve(rhs)
        return np.split(correction, self._ends[:-1])

    def apply(self, phi: Mapping[int, Floats], unknowns: Floats) -> Floats:
        """The system times a vector."""
        parts = np.split(unknowns, self._ends[:-1])
        result = np.concatenate([p.stiffness @ p.deformation(y) for p, y in zip(self._problems, parts, strict=True)])
        for index, total in enumerate(self._sums):
            result += total.T @ (self._interfaces[index].weights * phi[index] * (total @ unknowns))
        return result

    def _sum_of_traces(self, index: int) -> sp.csr_matrix:
        """The operator from all unknowns to u_αn + u_βn at the points of an interface."""
        points = len(self._interfaces[index].weights)
        blocks = []
        for problem in self._problems:
            traces = [port.trace for port in problem.ports if port.interface == index]
            blocks.append(sum(traces[1:], traces[0]) if traces else sp.csr_matrix((points, problem.size)))
        return sp.hstack(blocks, format="csr")
