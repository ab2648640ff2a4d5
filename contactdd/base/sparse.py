"""Sparse matrices of fixed sparsity whose values change: where entries stand, and maps from values to entries."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy
from numpy.typing import NDArray

from .arrays import Floats, Operator, slices


def stacked(operators: Sequence[Operator]) -> Operator:
    """Operators one below the other, dense if they all are."""
    if all(isinstance(operator, np.ndarray) for operator in operators):
        return np.vstack(operators)
    return scipy.sparse.vstack([scipy.sparse.csr_matrix(operator) for operator in operators]).tocsr()


def along_diagonal(blocks: Sequence[Floats]) -> Floats:
    """The matrix with dense blocks along its diagonal: SciPy's own takes ten times as long over two small ones."""
    rows, columns = (slices(block.shape[axis] for block in blocks) for axis in (0, 1))
    matrix = np.zeros((rows[-1].stop, columns[-1].stop))
    for block, row, column in zip(blocks, rows, columns, strict=True):
        matrix[row, column] = block
    return matrix


def product_map(trace: Operator, weights: Floats) -> tuple[NDArray[np.intp], scipy.sparse.csr_matrix]:
    """The positions of the entries of traceᵀ diag(weights φ) trace in the flattened matrix, and the operator from φ.

    For values that change in every step at positions that never do.
    """
    trace = scipy.sparse.csr_matrix(trace)
    counts = np.diff(trace.indptr)
    point = np.repeat(np.arange(len(counts)), counts**2)
    start = np.repeat(trace.indptr[:-1], counts**2)
    local = np.arange(len(point)) - np.repeat(np.cumsum(counts**2) - counts**2, counts**2)
    i, j = start + local // counts[point], start + local % counts[point]
    positions, entry = np.unique(trace.indices[i] * np.int64(trace.shape[1]) + trace.indices[j], return_inverse=True)
    values = trace.data[i] * trace.data[j] * weights[point]
    return positions, scipy.sparse.csr_matrix((values, (entry, point)), shape=(len(positions), len(counts)))


def entry_positions(matrix: scipy.sparse.csr_matrix, term: scipy.sparse.csr_matrix) -> NDArray[np.intp]:
    """The positions in matrix.data of the entries of a matrix whose sparsity is contained in it."""
    matrix.sort_indices()
    term.sort_indices()

    def keys(m: scipy.sparse.csr_matrix) -> NDArray[np.int64]:
        return np.repeat(np.arange(m.shape[0], dtype=np.int64), np.diff(m.indptr)) * m.shape[1] + m.indices

    return np.searchsorted(keys(matrix), keys(term))
