"""Static condensation: the inside of a body eliminated, so that only the unknowns that its contacts touch are left.

`SparseCondensation` eliminates it at once by MUMPS, `DenseCondensation` and `SmallCondensation` by LAPACK, and
`multifrontal.MultifrontalCondensation` a large solid part by part.
`ElementCondensation`, for elements of high degree, first eliminates what lies inside of every cell, many small dense
problems alike, and hands the rest to one of them. `MirroredCondensation` takes over the condensation of a body of which
this one is a moved or mirrored copy.
"""

from __future__ import annotations

from functools import cached_property
from typing import Protocol

import numpy as np
import scipy
from mpi4py import MPI

from ..base.arrays import Floats, Indices
from .affine import AffineCells, cell_nodes
from .dissection import Dissection
from .factor import Factor, SpreadFactor
from .multifrontal import MultifrontalCondensation, dense_sum, stiffness_of_cells
from .space import AdmissibleSpace


class Condensation(Protocol):
    """A body's stiffness K with its unknowns parted into those that are kept, c, and those that are eliminated, e."""

    @property
    def schur_complement(self) -> Floats:
        """S = K_cc − K_ce K_ee⁻¹ K_ec, dense (kept, kept)."""
        ...

    def condense_load(self, forces: Floats) -> tuple[Floats, float]:
        """The condensed forces f_c − K_ce K_ee⁻¹ f_e on the kept unknowns, and the others' work f_e · K_ee⁻¹ f_e."""
        ...

    def recover(self, kept: Floats, forces: Floats) -> Floats:
        """All unknowns: the kept ones as given, the others in equilibrium with them and with the forces."""
        ...


class SparseCondensation:
    """Everything eliminated at once, by this rank or by those of `comm` together."""

    def __init__(self, matrix: scipy.sparse.csr_matrix, kept: Indices, comm: MPI.Comm = MPI.COMM_SELF) -> None:
        self._matrix, self._kept = matrix, kept
        self._factor = Factor(matrix, kept) if comm.size == 1 else SpreadFactor(matrix, kept, comm)

    @property
    def schur_complement(self) -> Floats:
        return self._factor.schur_complement

    def condense_load(self, forces: Floats) -> tuple[Floats, float]:
        response = self._response(forces)
        return (forces - self._matrix @ response)[self._kept], float(response @ forces)

    def recover(self, kept: Floats, forces: Floats) -> Floats:
        y = np.zeros(len(forces))
        y[self._kept] = kept
        return y + self._response(forces - self._matrix @ y)

    def _response(self, forces: Floats) -> Floats:
        """K_ee⁻¹ f_e, and nothing on the kept unknowns."""
        rhs = forces.copy()
        rhs[self._kept] = 0.0
        response = self._factor.solve(rhs)
        response[self._kept] = 0.0
        return response


class DenseCondensation:
    """A small dense matrix whose last unknowns are kept, by LAPACK: MUMPS has more to do before it begins."""

    def __init__(self, matrix: Floats, kept: int) -> None:
        self._size = size = len(matrix) - kept
        lower = _cholesky(matrix[:size, :size].T)
        self._half = scipy.linalg.blas.dtrsm(1.0, lower, matrix[size:, :size].T, lower=1)  # L⁻¹ K_ec, K_ee = L Lᵀ
        self._packed = scipy.linalg.lapack.dtrttp(lower, uplo="L")[0]
        self.schur_complement = matrix[size:, size:] - self._half.T @ self._half

    def condense_load(self, forces: Floats) -> tuple[Floats, float]:
        half = self._triangular(forces[: self._size])
        return forces[self._size :] - half @ self._half, float(half @ half)

    def recover(self, kept: Floats, forces: Floats) -> Floats:
        half = self._triangular(forces[: self._size]) - self._half @ kept
        return np.concatenate([self._triangular(half, transposed=True), kept])

    def _triangular(self, rhs: Floats, transposed: bool = False) -> Floats:
        """L⁻¹ b, or L⁻ᵀ b."""
        if self._size == 0:  # which BLAS would refuse
            return rhs
        return scipy.linalg.blas.dtpsv(self._size, self._packed, rhs, lower=1, trans=transposed)


class SmallCondensation:
    """The same of a small sparse matrix. kept: the unknowns that stay, some but not all."""

    #: Unknowns up to which LAPACK is quicker: with 30 of them six times, with 300 not by much.
    LARGEST = 300

    def __init__(self, matrix: scipy.sparse.csr_matrix, kept: Indices) -> None:
        others = np.ones(matrix.shape[0], dtype=bool)
        others[kept] = False
        self._order = np.concatenate([np.flatnonzero(others), kept])
        self._dense = DenseCondensation(matrix.toarray()[self._order[:, None], self._order], len(kept))

    @property
    def schur_complement(self) -> Floats:
        return self._dense.schur_complement

    def condense_load(self, forces: Floats) -> tuple[Floats, float]:
        return self._dense.condense_load(forces[self._order])

    def recover(self, kept: Floats, forces: Floats) -> Floats:
        y = np.empty(len(forces))
        y[self._order] = self._dense.recover(kept, forces[self._order])
        return y


class ElementCondensation:
    """The inside of every cell eliminated first, all cells at once by dense algebra, then the rest, the skeleton.

    space: which degrees of freedom are the unknowns; kept: those unknowns that stay, none of them inside of a cell.
    """

    #: Unknowns up to which the skeleton's matrix is dense.
    SMALL = 400
    #: Unknowns from which that of a solid is dissected.
    DISSECTED = 4000

    def __init__(self, cells: AffineCells, space: AdmissibleSpace, kept: Indices) -> None:
        self.cells, self.space, self.kept = cells, space, kept
        unknown = space.numbers
        self._inner, outer = unknown[cells.dofs(cells.inner)], unknown[cells.dofs(cells.outer)].ravel()
        is_outer = np.zeros(space.size, dtype=bool)
        is_outer[outer[outer >= 0]] = True
        is_outer[kept] = False
        self._skeleton = np.concatenate([np.flatnonzero(is_outer), kept])
        size = len(self._skeleton)
        number = np.full(space.size + 1, size)  # which also is the number of what is prescribed, at the last place
        number[self._skeleton] = np.arange(size)
        self._positions = number[outer]
        first, *others = (self._complements(part) for part in cells.parts())
        blocks = np.concatenate([first, *others]) if others else first  # mostly all at once, and large
        self._rest: Condensation
        if size <= self.SMALL:
            self._rest = DenseCondensation(dense_sum(blocks, self._positions, size), len(kept))
        elif cells.dim == 3 and size >= self.DISSECTED:
            nodes = space.free_dofs[self._skeleton] // cells.dim
            middles = cell_nodes(cells.mesh).mean(axis=1)
            dissection = Dissection.of(cells.nodes[:, cells.outer], middles, nodes, number[kept])
            own = stiffness_of_cells(blocks, self._positions.reshape(len(blocks), -1), dissection)
            self._rest = MultifrontalCondensation(dissection, len(kept), own)
        else:
            self._rest = SparseCondensation(_sparse_sum(blocks, self._gather), number[kept])

    @property
    def schur_complement(self) -> Floats:
        return self._rest.schur_complement

    def condense_load(self, forces: Floats) -> tuple[Floats, float]:
        on_skeleton, work = self._onto_skeleton(forces)
        reduced, rest = self._rest.condense_load(on_skeleton)
        return reduced, work + rest

    def recover(self, kept: Floats, forces: Floats) -> Floats:
        y = np.empty(len(forces))
        y[self._skeleton] = self._rest.recover(kept, self._onto_skeleton(forces)[0])
        around = (self._gather @ y[self._skeleton]).reshape(len(self._inner), -1, 1)
        inner = forces[self._inner][:, :, None]
        for part in self.cells.parts():
            matrix, coupling = self._inside(part)
            y[self._inner[part]] = np.linalg.solve(matrix, inner[part] - coupling @ around[part])[:, :, 0]
        return y

    @cached_property
    def _gather(self) -> scipy.sparse.csr_matrix:
        """P, from the skeleton's unknowns to those around all cells, (cells · outer, skeleton); 0 if prescribed."""
        present = self._positions < len(self._skeleton)
        ends = np.concatenate([[0], np.cumsum(present)])
        entries = (np.ones(int(ends[-1])), self._positions[present], ends)
        return scipy.sparse.csr_matrix(entries, shape=(len(self._positions), len(self._skeleton)))

    def _complements(self, part: slice) -> Floats:
        """The Schur complements of some cells in the unknowns around them, (cells, outer, outer)."""
        around = self.cells.block(self.cells.integrals.outer, part)
        for block, matrix, coupling in zip(around, *self._inside(part), strict=True):
            half = _half(matrix.T, coupling.T)
            block -= half @ half.T
        return around

    def _onto_skeleton(self, forces: Floats) -> tuple[Floats, float]:
        """The condensed forces on the skeleton, and the work of the forces inside of the cells."""
        inner, on_skeleton, work = forces[self._inner], forces[self._skeleton], 0.0
        if not np.any(inner):
            return on_skeleton, work
        passed_on = np.empty((len(inner), self.cells.dim * len(self.cells.outer)))
        for part in self.cells.parts():
            matrix, coupling = self._inside(part)
            response = np.linalg.solve(matrix, inner[part][:, :, None])
            passed_on[part] = (np.swapaxes(coupling, 1, 2) @ response)[:, :, 0]
            work += float(np.sum(response[:, :, 0] * inner[part]))
        return on_skeleton - self._gather.T @ passed_on.ravel(), work

    def _inside(self, part: slice) -> tuple[Floats, Floats]:
        """The stiffness inside some cells, and between inside and around."""
        integrals = self.cells.integrals
        return self.cells.block(integrals.inner, part), self.cells.block(integrals.coupling, part)


class MirroredCondensation:
    """The elimination of a copy: its unknowns times `signs` (±1) are those of the original. kept: as in both."""

    def __init__(self, original: Condensation, signs: Floats, kept: Indices) -> None:
        self.original, self._signs, self._kept = original, signs, signs[kept]

    @property
    def schur_complement(self) -> Floats:
        return self._kept[:, None] * self.original.schur_complement * self._kept

    def condense_load(self, forces: Floats) -> tuple[Floats, float]:
        reduced, work = self.original.condense_load(self._signs * forces)
        return self._kept * reduced, work

    def recover(self, kept: Floats, forces: Floats) -> Floats:
        return self._signs * self.original.recover(self._kept * kept, self._signs * forces)


def _cholesky(matrix: Floats) -> Floats:
    """The factor L of a symmetric matrix K = L Lᵀ stored by columns; entries above the diagonal are not zeroed."""
    lower, info = scipy.linalg.lapack.dpotrf(matrix, lower=1, clean=0)
    if info != 0:
        raise np.linalg.LinAlgError("the matrix of the eliminated unknowns is not positive definite")
    return lower


def _half(matrix: Floats, coupling: Floats) -> Floats:
    """C L⁻ᵀ, whose product with its transpose is C K⁻¹ Cᵀ, from K = L Lᵀ and C, both column by column."""
    return scipy.linalg.blas.dtrsm(1.0, _cholesky(matrix), coupling, side=1, lower=1, trans_a=1)


def _sparse_sum(blocks: Floats, gather: scipy.sparse.csr_matrix) -> scipy.sparse.csr_matrix:
    """Σ Pᵀ B P of the blocks (cells, n, n), P the rows of `gather` (cells · n, unknowns) that belong to a cell."""
    count, size, _ = blocks.shape
    positions = np.arange(count + 1)
    diagonal = scipy.sparse.bsr_matrix((blocks, positions[:-1], positions), shape=(count * size, count * size))
    product = gather.T.tocsr() @ diagonal.tocsr() @ gather
    return product.T.tocsr()  # the same, but every row's entries are in order
