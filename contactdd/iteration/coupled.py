"""The step (17), (26), (27) that is not decomposed: one linear system for all bodies, the reference for the others."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from ..base.arrays import Floats
from ..base.sparse import product_map
from ..local.factor import Factor
from ..local.remote import as_matrix
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
        held, approach = np.zeros(len(rhs)), self._ensemble.normal_approach
        held[fixed] = self._ensemble.rigid.stiffness_scale
        contacts = approach.T @ scipy.sparse.diags(weights) @ approach
        return Factor((self._stiffness + scipy.sparse.diags(held) + contacts).tocsr()).solve(rhs)

    @cached_property
    def _stiffness(self) -> scipy.sparse.csr_matrix:
        """The stiffness of all bodies."""
        blocks = [scipy.sparse.csr_matrix(as_matrix(problem.stiffness)) for problem in self._ensemble.problems]
        return scipy.sparse.block_diag(blocks, format="csr")

    @cached_property
    def _map(self) -> tuple[NDArray[np.intp], scipy.sparse.csr_matrix]:
        """The positions of the contacts' terms in the dense matrix, and the operator from weights times φ to them."""
        return product_map(self._ensemble.normal_approach, np.ones(len(self._ensemble.weights)))
