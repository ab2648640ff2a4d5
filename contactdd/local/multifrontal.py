"""Static condensation by halves of halves of a body's cells: dense algebra of LAPACK's along a `Dissection`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from ..base.arrays import Floats, Indices
from .dissection import Dissection, Part

#: What adds a part's own stiffness to its matrices: the part, the place of each unknown in them, and these.
OwnStiffness = Callable[[Part, NDArray[np.intp], "Front"], None]

#: The mean length of the pieces of an index from which matrices are added piece by piece.
LONG = 12


class Pool:
    """Memory that matrices use one after the other: new memory costs more than the arithmetic with it."""

    def __init__(self) -> None:
        self._free: list[Floats] = []

    def zeros(self, size: int) -> Floats:
        """A matrix (size, size) of zeros, by columns."""
        fitting = [buffer for buffer in self._free if len(buffer) >= size**2]
        if fitting:
            best = min(fitting, key=len)
            self._free = [buffer for buffer in self._free if buffer is not best]
            best[: size**2] = 0.0
        else:
            best = np.zeros(size**2)
        return best[: size**2].reshape((size, size), order="F")

    def give_back(self, matrix: Floats) -> None:
        """Take a matrix's memory for others."""
        buffer = matrix
        while isinstance(buffer.base, np.ndarray):
            buffer = buffer.base
        self._free.append(buffer)


@dataclass
class Front:
    """A part's stiffness, stored by columns: of what it eliminates, between boundary and that, and of the boundary."""

    inner: Floats
    coupling: Floats
    outer: Floats

    @classmethod
    def empty(cls, inner: int, outer: int, pool: Pool) -> Front:
        return cls(np.zeros((inner, inner), order="F"), np.zeros((outer, inner), order="F"), pool.zeros(outer))

    def add(self, block: Floats, at: Indices) -> None:
        """Add a symmetric block, of whose entries those below the diagonal count, at increasing places."""
        size = len(self.inner)
        split = int(np.searchsorted(at, size))
        inner, outer = at[:split], at[split:] - size
        _add(self.inner, block[:split, :split], inner, inner, lower=True)
        _add(self.coupling, block[split:, :split], outer, inner)
        _add(self.outer, block[split:, split:], outer, outer, lower=True)

    def set_entries(self, rows: Indices, columns: Indices, values: Floats) -> None:
        """Set entries, those of `coupling` with rows of the boundary."""
        size = len(self.inner)
        inside, outside = rows < size, columns >= size
        between = ~inside & ~outside
        self.inner[rows[inside], columns[inside]] = values[inside]
        self.coupling[rows[between] - size, columns[between]] = values[between]
        self.outer[rows[outside] - size, columns[outside] - size] = values[outside]

    def eliminate(self) -> None:
        """Turn the matrices into L, C L⁻ᵀ and the Schur complement, of which the lower triangle counts."""
        if len(self.inner) == 0:
            return
        self.inner, info = scipy.linalg.lapack.dpotrf(self.inner, lower=1, clean=0, overwrite_a=1)
        if info != 0:
            raise np.linalg.LinAlgError("the matrix of the eliminated unknowns is not positive definite")
        if len(self.outer) == 0:
            return
        blas = scipy.linalg.blas
        self.coupling = blas.dtrsm(1.0, self.inner, self.coupling, side=1, lower=1, trans_a=1, overwrite_b=1)
        self.outer = blas.dsyrk(-1.0, self.coupling, beta=1.0, c=self.outer, lower=1, overwrite_c=1)

    def triangular(self, rhs: Floats, transposed: bool = False) -> Floats:
        """L⁻¹ b, or L⁻ᵀ b."""
        return scipy.linalg.blas.dtrsv(self.inner, rhs, lower=1, trans=transposed)


class MultifrontalCondensation:
    """Everything eliminated along a dissection; own: adds the stiffness that belongs to a part."""

    def __init__(self, dissection: Dissection, kept: int, own: OwnStiffness) -> None:
        self._dissection, self._size = dissection, len(dissection.order) - kept
        self._fronts: list[Front] = []
        place, pool = np.empty(len(dissection.order), dtype=np.intp), Pool()
        left: dict[int, Floats] = {}
        for part in dissection.parts:
            eliminated = part.last - part.first
            front = Front.empty(eliminated, len(part.boundary), pool)
            place[part.first : part.last] = np.arange(eliminated)
            place[part.boundary] = eliminated + np.arange(len(part.boundary))
            own(part, place, front)
            for half in part.halves:
                block = left.pop(half)
                front.add(block, place[dissection.parts[half].boundary])
                pool.give_back(block)
            front.eliminate()
            left[len(self._fronts)] = front.outer
            front.outer = np.zeros((0, 0))
            self._fronts.append(front)
        (last,) = left.values()
        self.schur_complement = np.tril(last) + np.tril(last, -1).T

    def condense_load(self, forces: Floats) -> tuple[Floats, float]:
        half = self._down(forces)
        return half[self._size :], float(half[: self._size] @ half[: self._size])

    def recover(self, kept: Floats, forces: Floats) -> Floats:
        half = self._down(forces)
        half[self._size :] = kept
        for part, front in zip(reversed(self._dissection.parts), reversed(self._fronts), strict=True):
            here = slice(part.first, part.last)
            if part.first < part.last:
                half[here] = front.triangular(half[here] - half[part.boundary] @ front.coupling, transposed=True)
        y = np.empty_like(half)
        y[self._dissection.order] = half
        return y

    def _down(self, forces: Floats) -> Floats:
        """L⁻¹ f of what is eliminated and the condensed forces on what is kept, in the order of elimination."""
        half = forces[self._dissection.order]
        for part, front in zip(self._dissection.parts, self._fronts, strict=True):
            if part.first < part.last:
                half[part.first : part.last] = front.triangular(half[part.first : part.last])
                half[part.boundary] -= front.coupling @ half[part.first : part.last]
        return half


def stiffness_of_rows(matrix: scipy.sparse.csr_matrix, rows: Indices, dissection: Dissection) -> OwnStiffness:
    """That of a sparse symmetric matrix, each unknown's row given, other rows and their columns left out.

    A part has the rows of what it eliminates, the last one those kept as well.
    """
    order, everything = dissection.order, dissection.parts[-1]
    columns = np.full(matrix.shape[0], -1)
    columns[rows[order]] = np.arange(len(order))
    chosen = matrix[rows[order]]
    columns = columns[chosen.indices]

    def add(part: Part, place: NDArray[np.intp], front: Front) -> None:
        first, last = part.first, len(order) if part is everything else part.last
        here = slice(chosen.indptr[first], chosen.indptr[last])
        row = np.repeat(np.arange(first, last), np.diff(chosen.indptr[first : last + 1]))
        below = columns[here] >= row
        front.set_entries(place[columns[here][below]], place[row[below]], chosen.data[here][below])

    return add


def stiffness_of_cells(blocks: Floats, unknowns: NDArray[np.intp], dissection: Dissection) -> OwnStiffness:
    """That of cells' matrices (cells, n, n); unknowns: of their rows (cells, n), more than the last if prescribed."""
    columns = np.empty(len(dissection.order) + 1, dtype=np.intp)
    columns[dissection.order], columns[-1] = np.arange(len(dissection.order)), -1

    def add(part: Part, place: NDArray[np.intp], front: Front) -> None:
        if part.halves:
            return
        size, eliminated = len(front.inner) + len(front.outer), len(front.inner)
        rows = columns[unknowns[part.cells]]
        total = dense_sum(blocks[part.cells], np.where(rows < 0, size, place[rows]), size)
        front.inner[:], front.outer[:] = total[:eliminated, :eliminated], total[eliminated:, eliminated:]
        front.coupling[:] = total[eliminated:, :eliminated]

    return add


def dense_sum(blocks: Floats, positions: NDArray[np.intp], size: int) -> Floats:
    """Σ Pᵀ B P of the blocks (cells, n, n), (size, size); positions: of every row of P, `size` where it is zero."""
    rows = positions.reshape(len(blocks), -1)
    flat = (size + 1) * rows[:, :, None] + rows[:, None]
    total = np.asarray(np.bincount(flat.ravel(), blocks.ravel(), (size + 1) ** 2), dtype=float)
    return total.reshape(size + 1, -1)[:size, :size]


def _add(target: Floats, block: Floats, rows: Indices, columns: Indices, lower: bool = False) -> None:
    """Add a block at increasing rows and columns, piece by piece if these are long; lower: only below the diagonal."""
    if len(rows) == 0 or len(columns) == 0:
        return
    pieces, others = _pieces(rows), _pieces(columns)
    if len(rows) * len(columns) < LONG**2 * len(pieces) * len(others):
        target[np.ix_(rows, columns)] += block
        return
    for c, d, column in others:
        for a, b, row in pieces:
            if not lower or b > c:
                target[row : row + b - a, column : column + d - c] += block[a:b, c:d]


def _pieces(places: Indices) -> list[tuple[int, int, int]]:
    """The ends of the pieces in which increasing places follow each other, and the first of these places."""
    ends = np.concatenate([[0], np.flatnonzero(np.diff(places) != 1) + 1, [len(places)]])
    return list(zip(ends[:-1].tolist(), ends[1:].tolist(), places[ends[:-1]].tolist(), strict=True))
