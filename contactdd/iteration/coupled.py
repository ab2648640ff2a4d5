"""The step (17), (26), (27) that is not decomposed: one linear system for all bodies, the reference for the others."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from ..base.arrays import Floats
from ..base.sparse import entry_positions, product_map
from ..local.factor import Factor
from ..local.problem import Solver
from ..local.remote import as_matrix
from ..system.block_diagonal import BlockDiagonal
from ..system.ensemble import Ensemble


class CoupledSystem:
    """A + Σ ∫ φ [u_αn + u_βn][v_αn + v_βn] in the unknowns of all bodies, factored anew for every φ: a `step.Step`."""

    def __init__(self, ensemble: Ensemble, note: str = "") -> None:
        self._ensemble = ensemble
        self.body_solves, self.note = 0, note

    def correct(self, phi: Mapping[int, Floats], residual: Floats, scale: float) -> Floats:
        self.body_solves += len(self._ensemble.problems)  # each body takes part once
        fixed = self._ensemble.rigid.fixing_dofs(phi, residual, scale)
        weights = self._ensemble.weights * self._ensemble.at_all_points(phi)
        return (self._solve_dense if self._ensemble.dense else self._solve_sparse)(weights, residual, fixed)

    def _solve_dense(self, weights: Floats, rhs: Floats, fixed: NDArray[np.intp]) -> Floats:
        # BLAS and LAPACK count by columns and need one triangle only.
        matrix = np.array(self._ensemble.stiffness).T
        approach = self._ensemble.normal_approach
        if isinstance(approach, np.ndarray):
            root = np.sqrt(weights)[:, None] * approach
            matrix = scipy.linalg.blas.dsyrk(1.0, root.T, beta=1.0, c=matrix, overwrite_c=True)
        else:
            positions, entries = self._map
            matrix.T.ravel()[positions] += entries @ weights
        matrix[fixed, fixed] += self._ensemble.rigid.stiffness_scale
        _, solution, info = scipy.linalg.lapack.dposv(matrix, rhs, overwrite_a=True)
        if info != 0:
            raise np.linalg.LinAlgError("the coupled system is not positive definite")
        return solution

    def _solve_sparse(self, weights: Floats, rhs: Floats, fixed: NDArray[np.intp]) -> Floats:
        held = np.zeros(len(rhs))
        held[fixed] = self._ensemble.rigid.stiffness_scale
        return self._sparse.solver(weights, held)(rhs)

    @cached_property
    def _sparse(self) -> SparseSystem:
        return SparseSystem(self._ensemble)

    @cached_property
    def _map(self) -> tuple[NDArray[np.intp], scipy.sparse.csr_matrix]:
        """The positions of the contacts' terms in the dense matrix, and the operator from weights times φ to them."""
        return product_map(self._ensemble.normal_approach, np.ones(len(self._ensemble.weights)))


class SparseSystem:
    """The sparse matrix of all bodies and contacts, whose entries stay where they are: what is found out about its
    sparsity is kept from step to step."""

    def __init__(self, ensemble: Ensemble) -> None:
        self._approach = scipy.sparse.csr_matrix(ensemble.normal_approach)
        stiffness = BlockDiagonal([as_matrix(problem.stiffness) for problem in ensemble.problems]).tocsr()
        diagonal = scipy.sparse.eye(ensemble.size).tocsr()
        self._matrix = (_ones(stiffness) + _ones(abs(self._approach).T @ abs(self._approach)) + diagonal).tocsr()
        self._stiffness = np.zeros(self._matrix.nnz)
        self._stiffness[entry_positions(self._matrix, stiffness)] = stiffness.data
        self._diagonal = entry_positions(self._matrix, diagonal)
        self._factor: Factor | None = None

    def solver(self, weights: Floats, held: Floats) -> Solver:
        """The inverse of the matrix; weights: (points,) φ times the areas; held: (unknowns,) added to the diagonal."""
        weighted = self._approach.copy()
        weighted.data *= np.repeat(weights, np.diff(weighted.indptr))
        contacts = scipy.sparse.csr_matrix(self._approach.T @ weighted)  # without the entries that vanish
        values = self._stiffness.copy()
        values[self._diagonal] += held
        values[entry_positions(self._matrix, contacts)] += contacts.data
        if self._factor is None:
            self._matrix.data = values
            self._factor = Factor(self._matrix)
        else:
            self._factor.update(values)
        return self._factor.solve


def _ones(matrix: scipy.sparse.csr_matrix) -> scipy.sparse.csr_matrix:
    """A one wherever the matrix has an entry."""
    matrix = matrix.tocsr()
    return scipy.sparse.csr_matrix((np.ones(matrix.nnz), matrix.indices, matrix.indptr), shape=matrix.shape)
