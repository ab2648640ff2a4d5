"""A body as a small dense matrix: its Robin problem by LAPACK, its low modes, its start from contact surfaces."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from ..base.arrays import Floats, Indices
from ..base.sparse import product_map, stacked
from .problem import ContactTrace, Solver, free_fixing_dofs
from .rigid import RigidMotions
from .space import SMALL


@dataclass(frozen=True)
class DenseSystem:
    """The dense stiffness S + Φ of one body with its Robin terms.

    Attributes:
        name: The body's name.
        stiffness: (unknowns, unknowns) The stiffness S without contacts.
        traces: The actions of the contacts on the unknowns.
        rigid: The free rigid motions.
    """

    name: str
    stiffness: Floats
    traces: Sequence[ContactTrace]
    rigid: RigidMotions

    def correct(self, phi: Mapping[int, Floats], residual: Floats, scale: float) -> Floats:
        """ũ − u of (22); see `LocalProblem.correct`.

        Args:
            phi: The Robin coefficient at the points of each interface (stress / length), by the interfaces' indices.
            residual: (unknowns,) forces.
            scale: The size of the forces at work.

        Raises:
            LooseBodyError: Nothing holds the body against these forces.
        """
        return self._solver(phi, self.rigid.fixing_dofs(phi, residual, scale))(residual)

    def robin_solver(self, phi: Mapping[int, Floats]) -> Solver:
        """(S + Φ)⁻¹; see `LocalProblem.robin_solver`.

        Args:
            phi: The Robin coefficient at the points of each interface (stress / length), by the interfaces' indices.
        """
        return self._solver(phi, free_fixing_dofs(self.rigid, phi))

    def low_modes(self, phi: Mapping[int, Floats], below: float) -> Floats:
        """The lowest modes of S against S + Φ; see `LocalProblem.low_modes`.

        Args:
            phi: The Robin coefficient at the points of each interface (stress / length), by the interfaces' indices.
            below: The bound of their eigenvalues.
        """
        if len(self.stiffness) == 0:
            return np.zeros((0, 0))
        matrix = self._fixed_system(phi, free_fixing_dofs(self.rigid, phi))
        return scipy.linalg.eigh(self.stiffness, matrix, subset_by_value=(-np.inf, below))[1]

    def start(self, normal_displacement: Mapping[int, Floats]) -> Floats:
        """Unknowns near a given u_n; see `LocalProblem.start`.

        Args:
            normal_displacement: u_n (length) at the points of each interface, by the interfaces' indices.
        """
        values = np.concatenate([normal_displacement[trace.interface] - trace.offset for trace in self.traces])
        rows = stacked([trace.trace for trace in self.traces])
        if not isinstance(rows, np.ndarray) and math.prod(rows.shape) <= SMALL:
            rows = rows.toarray()
        if isinstance(rows, np.ndarray):
            return np.linalg.lstsq(rows, values, rcond=1e-12)[0]
        return scipy.sparse.linalg.lsqr(rows, values, atol=1e-15, btol=1e-15)[0]

    @cached_property
    def _robin(self) -> list[tuple[Indices, scipy.sparse.csr_matrix]]:
        """The positions of the Robin terms in the matrix, and the operators from φ to their entries."""
        maps = [product_map(trace.robin_trace, trace.side.surface.weights) for trace in self.traces]
        return [(at, (m @ trace.side.transfer).tocsr()) for trace, (at, m) in zip(self.traces, maps, strict=True)]

    def _system(self, phi: Mapping[int, Floats]) -> Floats:
        """S + Φ."""
        matrix = self.stiffness.copy()
        for trace, (positions, weights) in zip(self.traces, self._robin, strict=True):
            matrix.ravel()[positions] += weights @ phi[trace.interface]
        return matrix

    def _fixed_system(self, phi: Mapping[int, Floats], fixed: Indices) -> Floats:
        """S + Φ with these unknowns fixed."""
        matrix = self._system(phi)
        # A rigid body has no stiffness but that of its contacts.
        matrix[fixed, fixed] += self.rigid.stiffness_scale or matrix.diagonal().max()
        return matrix

    def _solver(self, phi: Mapping[int, Floats], fixed: Indices) -> Solver:
        """(S + Φ)⁻¹ with these unknowns fixed."""
        if len(self.stiffness) == 0:  # supports hold all that the contacts touch, which LAPACK would refuse
            return np.copy
        matrix = self._fixed_system(phi, fixed)
        factor, info = scipy.linalg.lapack.dpotrf(matrix.T, lower=True, clean=False, overwrite_a=True)
        if info != 0:
            raise np.linalg.LinAlgError(f"body {self.name!r}: S + Φ is not positive definite")
        return lambda forces: scipy.linalg.lapack.dpotrs(factor, forces, lower=True)[0]
