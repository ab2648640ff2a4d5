"""The inverse of a matrix of NGSolve, or what approximates it, as the groove's and the dimple's peers precondition.

Ways: "sparsecholesky", NGSolve's own factor; "cholmod", that of SuiteSparse with METIS (scikit-sparse); "pyamg",
smoothed aggregation with the rigid motions.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import ngsolve as ng
import numpy as np
import scipy.sparse


def inverted(matrix: Any, free: Any, way: str, rigid: Callable[[], np.ndarray] | None = None) -> Any:
    """The inverse in the free unknowns; rigid: makes the rigid motions (unknowns, n), which "pyamg" needs."""
    if way == "sparsecholesky":
        return matrix.Inverse(free, way)
    kept = np.flatnonzero(np.array(list(free)))
    rows, columns, values = map(np.asarray, matrix.COO())
    lower = scipy.sparse.csr_matrix((values, (rows, columns)), shape=(matrix.height,) * 2)[kept][:, kept]
    lower = scipy.sparse.tril(lower).tocsr()
    solve = _by_pyamg(lower, rigid()[kept]) if way == "pyamg" else _by_cholmod(lower)
    return _Outer(matrix.height, kept, solve)


def _by_cholmod(lower: Any) -> Callable[[np.ndarray], np.ndarray]:
    """The solver of a symmetric matrix, given by its lower triangle."""
    from sksparse.cholmod import cho_factor

    return cho_factor(scipy.sparse.csc_array(lower), lower=True, order="metis", supernodal_mode="supernodal").solve


def _by_pyamg(lower: Any, rigid: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """A cycle for a symmetric matrix, given by its lower triangle."""
    import pyamg

    full = (lower + scipy.sparse.tril(lower, -1).T).tocsr()
    smoother = ("gauss_seidel", {"sweep": "symmetric"})
    made = pyamg.smoothed_aggregation_solver(full, B=rigid, presmoother=smoother, postsmoother=smoother, max_coarse=300)
    return made.aspreconditioner(cycle="V").matvec


class _Outer(ng.BaseMatrix):
    """A solver of SciPy's world on the kept unknowns."""

    def __init__(self, size: int, kept: np.ndarray, solve: Callable[[np.ndarray], np.ndarray]) -> None:
        super().__init__()
        self._size, self._kept, self._solve = size, kept, solve

    def Mult(self, x: Any, y: Any) -> None:
        y[:] = 0
        y.FV().NumPy()[self._kept] = self._solve(x.FV().NumPy()[self._kept])

    def Height(self) -> int:
        return self._size

    def Width(self) -> int:
        return self._size

    def IsComplex(self) -> bool:
        return False

    def CreateRowVector(self) -> Any:
        return ng.BaseVector(self._size)

    def CreateColVector(self) -> Any:
        return ng.BaseVector(self._size)
