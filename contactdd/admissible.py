"""The displacements u = Z y + u₀ that the supports of a body allow, y its unknowns.

Z has orthonormal columns. Mostly it only selects the free degrees of freedom; where a support is tilted it mixes some.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy
from numpy.typing import NDArray

if TYPE_CHECKING:
    #: An operator that is kept dense where it is small.
    Operator = scipy.sparse.csr_matrix | NDArray[np.float64]

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

#: Entries up to which a dense product is faster than a sparse one.
SMALL = 2**14


@dataclass(frozen=True)
class AdmissibleSpace:
    """u = Z y + u₀.

    offset: (dofs,) u₀; free: (unknowns,) the degrees of freedom that Z selects, in order, or None where it mixes some;
    mixing: then Z itself, (dofs, unknowns).
    """

    offset: Floats
    free: Indices | None
    mixing: scipy.sparse.csr_matrix | None = None

    @cached_property
    def basis(self) -> scipy.sparse.csr_matrix:
        """Z, (dofs, unknowns)."""
        if self.free is None:
            return self.mixing
        ends = np.searchsorted(self.free, np.arange(len(self.offset) + 1))
        entries = (np.ones(self.size), np.arange(self.size), ends)
        return scipy.sparse.csr_matrix(entries, shape=(len(self.offset), self.size))

    @property
    def size(self) -> int:
        """The number of unknowns."""
        return self.mixing.shape[1] if self.free is None else len(self.free)

    @cached_property
    def numbers(self) -> NDArray[np.int32]:
        """The unknown at every degree of freedom, −1 where it is prescribed; of a Z that only selects."""
        return self._numbered(np.arange(self.size))

    @cached_property
    def has_offset(self) -> bool:
        """Whether anything else than zero is prescribed."""
        return bool(np.any(self.offset))

    def extended(self, y: Floats) -> Floats:
        """Z y, (dofs,) or (dofs, n)."""
        if self.free is None:
            return self.mixing @ y
        u = np.zeros((len(self.offset), *y.shape[1:]))
        u[self.free] = y
        return u

    def restricted(self, forces: Floats) -> Floats:
        """Zᵀ f of forces (dofs,) or (dofs, n)."""
        return self.mixing.T @ forces if self.free is None else forces[self.free]

    def prevented(self, u: Floats) -> Floats:
        """The rows, but for zero ones, of what displacements (dofs, n) have that the supports do not allow."""
        if self.free is None:
            rest = u - self.extended(self.restricted(u))
            return rest[np.any(rest, axis=1)]
        held = np.ones(len(self.offset), dtype=bool)
        held[self.free] = False
        return u[held]

    def prescribed(self, operator: scipy.sparse.csr_matrix) -> Floats:
        """operator @ u₀; operator: on all degrees of freedom."""
        return operator @ self.offset if self.has_offset else np.zeros(operator.shape[0])

    def columns(self, matrix: scipy.sparse.csr_matrix) -> scipy.sparse.csr_matrix:
        """matrix @ Z."""
        return (matrix @ self.mixing).tocsr() if self.free is None else matrix[:, self.free]

    def within(self, matrix: scipy.sparse.csr_matrix) -> scipy.sparse.csr_matrix:
        """Zᵀ @ matrix @ Z."""
        if self.free is None:
            return (self.mixing.T @ matrix @ self.mixing).tocsr()
        return matrix[self.free][:, self.free]

    def unknowns_at(self, dofs: Indices) -> Indices:
        """The unknowns on which some degrees of freedom depend, in order."""
        if self.free is None:
            return np.unique(self.mixing[dofs].indices)
        marked = np.zeros(len(self.offset), dtype=bool)
        marked[dofs] = True
        return np.flatnonzero(marked[self.free])

    def columns_of(self, kept: Indices) -> Callable[[scipy.sparse.csr_matrix], Operator]:
        """From operators on all degrees of freedom to those on the kept unknowns; dense if small and Z only selects."""
        if self.free is None:
            some = self.mixing[:, kept]
            return lambda operator: (operator @ some).tocsr()
        numbers = self._numbered(kept)

        def chosen(operator: scipy.sparse.csr_matrix) -> Operator:
            shape, columns = (operator.shape[0], len(kept)), numbers[operator.indices]
            present = columns >= 0
            rows = np.repeat(np.arange(shape[0]), np.diff(operator.indptr))[present]
            if shape[0] * shape[1] > SMALL:
                return scipy.sparse.csr_matrix((operator.data[present], (rows, columns[present])), shape=shape)
            dense = np.zeros(shape)
            dense[rows, columns[present]] = operator.data[present]
            return dense

        return chosen

    def _numbered(self, unknowns: Indices) -> NDArray[np.int32]:
        """The place of every degree of freedom's unknown among the given ones, −1 where it has none there."""
        numbers = np.full(len(self.offset), -1, dtype=np.int32)
        numbers[self.free[unknowns]] = np.arange(len(unknowns), dtype=np.int32)
        return numbers
