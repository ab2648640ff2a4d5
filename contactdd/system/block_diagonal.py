"""Matrices of the bodies along a diagonal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from ..base.arrays import Floats, Integers, Operator, slices
from ..base.ranks import Ranks


@dataclass(frozen=True)
class BlockDiagonal:
    """Matrices along a diagonal, each of which is applied to its own part of a vector (columns,) or (columns, n)."""

    blocks: Sequence[Operator]

    @property
    def T(self) -> BlockDiagonal:
        return BlockDiagonal([block.T for block in self.blocks])

    @cached_property
    def parts(self) -> list[slice]:
        """The slice of a vector that each block is applied to."""
        return slices(block.shape[1] for block in self.blocks)

    @cached_property
    def rows(self) -> list[slice]:
        """The slice of the product that each block gives."""
        return slices(block.shape[0] for block in self.blocks)

    def __matmul__(self, y: Floats) -> Floats:
        return np.concatenate([block @ y[part] for block, part in zip(self.blocks, self.parts, strict=True)])

    def tocsr(self) -> scipy.sparse.csr_matrix:
        """The same as one sparse matrix, with all entries of dense blocks."""
        parts = [_entries(block) for block in self.blocks]
        columns = [at + part.start for (_, at, _), part in zip(parts, self.parts, strict=True)]
        starts = np.cumsum(np.concatenate([[0], *(counts for _, _, counts in parts)]))
        entries = np.concatenate([data for data, _, _ in parts])
        shape = (self.rows[-1].stop, self.parts[-1].stop)
        return scipy.sparse.csr_matrix((entries, np.concatenate(columns), starts), shape=shape)


@dataclass(frozen=True)
class OwnedBlocks:
    """Square matrices along a diagonal, each of which is applied by the rank that holds its body, for all. Collective.

    block: gives the matrix of a body that this rank holds; parts: the slice of a vector that each is applied to.
    """

    ranks: Ranks
    block: Callable[[int], Operator]
    parts: Sequence[slice]

    def __matmul__(self, y: Floats) -> Floats:
        return np.concatenate(self.ranks.each(lambda index: self.block(index) @ y[self.parts[index]]))


def _entries(block: Operator) -> tuple[Floats, Integers, Integers]:
    """The entries of a matrix row by row, their columns, and how many there are in each row."""
    if isinstance(block, np.ndarray):
        rows, columns = block.shape
        return block.ravel(), np.tile(np.arange(columns), rows), np.full(rows, columns)
    block = scipy.sparse.csr_matrix(block)
    return block.data, block.indices, np.diff(block.indptr)
