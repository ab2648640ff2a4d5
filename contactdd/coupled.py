"""The not decomposed step: one linear system for all bodies, the reference for the decomposed ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from numpy.typing import NDArray

from .factor import Factor
from .interface import Interface
from .rigid import Resistance, RigidMotions
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
        self._rigid = self._rigid_motions()

    def correct(self, phi: Mapping[int, Floats], residuals: Sequence[Floats], scale: float) -> list[Floats]:
        """The Newton correction of every body's unknowns.

        phi: the coefficient at the points of each interface; scale: the size of the forces at work. Raises
        LooseBodyError where nothing holds the bodies.
        """
        matrix, rhs = self._stiffness, np.concatenate(residuals)
        ground = np.zeros(len(rhs))
        ground[self._rigid.ground(phi, rhs, scale)] = self._rigid.largest
        for index, total in enumerate(self._sums):
            term = total.T @ sp.diags(self._interfaces[index].weights * phi[index]) @ total
            matrix = matrix + (term.toarray() if self._dense else term)
        if self._dense:
            matrix[np.diag_indices(len(rhs))] += ground
            correction = scipy.linalg.solve(matrix, rhs, assume_a="pos", overwrite_a=True)
        else:
            correction = Factor((matrix + sp.diags(ground)).tocsr()).solve(rhs)
        return np.split(correction, self._ends[:-1])

    def _rigid_motions(self) -> RigidMotions:
        """The rigid motions of all bodies; a contact resists those that change its gap."""
        parts = [problem.rigid for problem in self._problems]
        modes, springs = (scipy.linalg.block_diag(*(getattr(p, name) for p in parts)) for name in ("modes", "springs"))
        contacts = [
            Resistance(index, np.sqrt(interface.weights)[:, None] * (total @ modes))
            for index, (interface, total) in enumerate(zip(self._interfaces, self._sums, strict=True))
        ]
        owners = [part.owners[0] for part in parts]
        return RigidMotions(modes, springs, contacts, owners, max(part.largest for part in parts))

    def _sum_of_traces(self, index: int) -> sp.csr_matrix:
        """The operator from all unknowns to u_αn + u_βn at the points of an interface."""
        points = len(self._interfaces[index].weights)
        blocks = []
        for problem in self._problems:
            traces = [port.trace for port in problem.ports if port.interface == index]
            blocks.append(sum(traces[1:], traces[0]) if traces else sp.csr_matrix((points, problem.size)))
        return sp.hstack(blocks, format="csr")
