"""The not decomposed step: one linear system for all bodies, the reference for the decomposed ones."""

from __future__ import annotations

import itertools
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
#: Products, points times unknowns squared, up to which a contact's term is a product of full matrices: finding out
#: where its entries are would take as long as some ten such products.
LARGEST_PRODUCT = 4_000_000


class CoupledSystem:
    """A + Σ ∫ φ [u_αn + u_βn][v_αn + v_βn], in the unknowns of all bodies one after another.

    rigid: the free rigid motions of the bodies together; factored: whether `correct` will be asked for.
    """

    def __init__(
        self, problems: Sequence[Subproblem], interfaces: Sequence[Interface], *, factored: bool = True
    ) -> None:
        self._problems, self._interfaces = problems, interfaces
        ends = list(itertools.accumulate(problem.size for problem in problems))
        self._parts = [slice(end - problem.size, end) for problem, end in zip(problems, ends, strict=True)]
        self._size = ends[-1]
        condensed = all(isinstance(problem.stiffness, np.ndarray) for problem in problems)
        self._dense = condensed and self._size <= LARGEST_DENSE
        if factored:
            self._stiffness = self._dense_stiffness() if self._dense else self._sparse_stiffness()
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
        return [correction[part] for part in self._parts]

    def _solve_dense(self, phi: Mapping[int, Floats], rhs: Floats, ground: NDArray[np.intp]) -> Floats:
        # BLAS and LAPACK count by columns and need one triangle only.
        matrix = self._stiffness.copy().T
        for index, interface in enumerate(self._interfaces):
            if index in self._maps:
                places, entries = self._maps[index]
                matrix.T.ravel()[places] += entries @ phi[index]
            else:
                root = np.sqrt(interface.weights * phi[index])[:, None] * self._sums[index]
                matrix = scipy.linalg.blas.dsyrk(1.0, root.T, beta=1.0, c=matrix, overwrite_c=True)
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

    def _dense_stiffness(self) -> Floats:
        stiffness = np.zeros((self._size, self._size))
        for problem, part in zip(self._problems, self._parts, strict=True):
            stiffness[part, part] = problem.stiffness
        return stiffness

    def _sparse_stiffness(self) -> scipy.sparse.csr_matrix:
        blocks = [scipy.sparse.csr_matrix(problem.stiffness) for problem in self._problems]
        return scipy.sparse.block_diag(blocks, format="csr")

    @cached_property
    def _maps(self) -> dict[int, tuple[NDArray[np.intp], scipy.sparse.csr_matrix]]:
        """Where the terms of contacts with sparse traces stand in the dense matrix, and from φ to their entries."""
        return {
            index: product_map(total, self._interfaces[index].weights)
            for index, total in enumerate(self._sums)
            if not isinstance(total, np.ndarray)
        }

    def apply(self, phi: Mapping[int, Floats], unknowns: Floats) -> Floats:
        """The system times a vector."""
        parts = zip(self._problems, self._parts, strict=True)
        result = np.concatenate([p.stiffness @ p.deformation(unknowns[part]) for p, part in parts])
        for index, total in enumerate(self._sums):
            result += total.T @ (self._interfaces[index].weights * phi[index] * (total @ unknowns))
        return result

    def _sum_of_traces(self, index: int) -> Floats | scipy.sparse.csr_matrix:
        """The operator from all unknowns to u_αn + u_βn at the points of an interface; a full matrix where small."""
        points = len(self._interfaces[index].weights)
        ports = [(place, port) for place, p in enumerate(self._problems) for port in p.ports if port.interface == index]
        if self._dense and points * self._size**2 <= LARGEST_PRODUCT:
            total = np.zeros((points, self._size))
            for place, port in ports:
                total[:, self._parts[place]] += port.trace
            return total
        blocks = [scipy.sparse.csr_matrix((points, problem.size)) for problem in self._problems]
        for place, port in ports:
            blocks[place] = scipy.sparse.csr_matrix(port.trace)
        return scipy.sparse.hstack(blocks, format="csr")
