"""The not decomposed step: one linear system for all bodies, the reference for the decomposed ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from numpy.typing import NDArray

from .errors import LooseBodyError
from .factor import Factor
from .interface import Interface
from .subproblem import Subproblem

Floats = NDArray[np.float64]


class CoupledSystem:
    """A + Σ ∫ φ [u_αn + u_βn][v_αn + v_βn], in the unknowns of all bodies one after another."""

    def __init__(self, problems: Sequence[Subproblem], interfaces: Sequence[Interface]) -> None:
        self._problems, self._interfaces = problems, interfaces
        self._ends = np.cumsum([problem.size for problem in problems])
        self._dense = all(isinstance(problem.stiffness, np.ndarray) for problem in problems)
        blocks = [problem.stiffness for problem in problems]
        self._stiffness = scipy.linalg.block_diag(*blocks) if self._dense else sp.block_diag(blocks, format="csr")
        self._sums = [self._sum_of_traces(index) for index in range(len(interfaces))]
        self._modes = scipy.linalg.block_diag(*(problem.rigid_modes for problem in problems))
        self._mode_sums = [total @ self._modes for total in self._sums]

    def correct(self, phi: Mapping[int, Floats], residuals: Sequence[Floats]) -> list[Floats]:
        """The Newton correction of every body's unknowns. Raises LooseBodyError where something moves freely."""
        self.check_held(phi)
        matrix, rhs = self._stiffness, np.concatenate(residuals)
        for index, total in enumerate(self._sums):
            term = total.T @ sp.diags(self._interfaces[index].weights * phi[index]) @ total
            matrix = matrix + (term.toarray() if self._dense else term)
        if self._dense:
            correction = scipy.linalg.solve(matrix, rhs, assume_a="pos", overwrite_a=True)
        else:
            correction = Factor(matrix.tocsr()).solve(rhs)
        return np.split(correction, self._ends[:-1])

    def check_held(self, phi: Mapping[int, Floats]) -> None:
        """Raise LooseBodyError if some rigid motion of the bodies together meets no resistance."""
        if self._modes.shape[1] == 0:
            return
        held = scipy.linalg.block_diag(*(problem._mode_stiffness for problem in self._problems))
        for index, modes in enumerate(self._mode_sums):
            held += modes.T @ ((self._interfaces[index].weights * phi[index])[:, None] * modes)
        values, vectors = np.linalg.eigh(held)
        if values[0] > 1e-14 * max(problem._largest_stiffness for problem in self._problems):
            return
        ends = np.cumsum([problem.rigid_modes.shape[1] for problem in self._problems])
        parts = np.split(vectors[:, 0], ends[:-1])
        worst = int(np.argmax([np.linalg.norm(part) for part in parts]))
        problem = self._problems[worst]
        raise LooseBodyError(problem.body.name, problem.body.kinematics.describe(problem._mode_names @ parts[worst]))

    def _sum_of_traces(self, index: int) -> sp.csr_matrix:
        """The operator from all unknowns to u_αn + u_βn at the points of an interface."""
        points = len(self._interfaces[index].weights)
        blocks = []
        for problem in self._problems:
            traces = [port.trace for port in problem.ports if port.interface == index]
            blocks.append(sum(traces[1:], traces[0]) if traces else sp.csr_matrix((points, problem.size)))
        return sp.hstack(blocks, format="csr")
