"""Sparse symmetric positive definite systems by MUMPS through PETSc, with Schur complements."""

from __future__ import annotations

import ctypes
from functools import cache

import numpy as np
import scipy
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from ..base.arrays import Floats


class Factor:
    """The Cholesky factorisation of a symmetric positive definite matrix, refreshed for new values at its places.

    With `schur`, the indices c of some unknowns, only the others (i) are eliminated: `schur_complement` is
    S = K_cc − K_ci K_ii⁻¹ K_ic, and `solve` works on the inner system K_ii x_i = b_i.
    """

    def __init__(self, matrix: scipy.sparse.csr_matrix, schur: NDArray[np.intp] | None = None) -> None:
        matrix.sort_indices()
        self._csr = (
            *(each.astype(PETSc.IntType, copy=False) for each in (matrix.indptr, matrix.indices)),
            matrix.data.copy(),
        )
        self._matrix = PETSc.Mat().createAIJWithArrays(matrix.shape, self._csr, comm=PETSc.COMM_SELF)
        self._size = 0 if schur is None else len(schur)
        self._nothing_to_do = self._size == matrix.shape[0]  # MUMPS refuses to eliminate nothing
        if self._nothing_to_do:
            return
        if self._size == 0:
            schur = None  # and it refuses to keep nothing
        self._pc = _mumps(self._matrix)
        self._pc.setFactorSetUpSolverType()
        if schur is not None:
            self._set_schur(schur)
            # MUMPS' estimate of its workspace is too small where few unknowns are eliminated; it is a percentage.
            self._pc.getFactorMatrix().setMumpsIcntl(14, 1000 if matrix.shape[0] < 1000 else 50)
        _factor(self._pc)
        if schur is not None:
            self._pc.getFactorMatrix().setMumpsIcntl(26, 0)  # from now on solve with the inner matrix only
        self._rhs, self._solution = self._matrix.createVecs()

    def update(self, values: Floats) -> None:
        """Factor again with other values at the same places; the symbolic factorisation is kept."""
        self._csr[2][:] = values
        if self._nothing_to_do:
            return
        self._matrix.assemble()
        self._pc.setOperators(self._matrix)
        _factor(self._pc)

    def solve(self, rhs: Floats) -> Floats:
        """The solution for one right-hand side (unknowns,); with Schur unknowns, of the inner system only."""
        if self._nothing_to_do:
            return np.zeros_like(rhs)
        self._rhs.array[:] = rhs
        self._pc.apply(self._rhs, self._solution)
        return self._solution.array.copy()

    @property
    def schur_complement(self) -> Floats:
        """The Schur complement, dense (c, c)."""
        if self._nothing_to_do:
            return scipy.sparse.csr_matrix(self._csr[::-1], shape=(self._size, self._size)).toarray()
        if self._size == 0:
            return np.zeros((0, 0))
        library, matrix, status = _petsc(), ctypes.c_void_p(), ctypes.c_int(-1)
        _check(library.MatFactorCreateSchurComplement(self._handle(), ctypes.byref(matrix), ctypes.byref(status)))
        pointer = ctypes.POINTER(ctypes.c_double)()
        _check(library.MatDenseGetArrayRead(matrix, ctypes.byref(pointer)))
        dense = np.ctypeslib.as_array(pointer, shape=(self._size**2,)).reshape(self._size, -1).copy()
        _check(library.MatDenseRestoreArrayRead(matrix, ctypes.byref(pointer)))
        _check(library.MatDestroy(ctypes.byref(matrix)))
        # MUMPS fills one triangle of a symmetric complement.
        lower, upper = np.tril(dense, -1), np.triu(dense, 1)
        half = lower if np.any(lower) else upper.T
        return half + half.T + np.diag(np.diag(dense))

    def _handle(self) -> ctypes.c_void_p:
        return ctypes.c_void_p(self._pc.getFactorMatrix().handle)

    def _set_schur(self, schur: NDArray[np.intp]) -> None:
        """petsc4py has no call for MatFactorSetSchurIS, so the library is asked itself."""
        indices = PETSc.IS().createGeneral(np.asarray(schur, dtype=PETSc.IntType), comm=PETSc.COMM_SELF)
        _check(_petsc().MatFactorSetSchurIS(self._handle(), ctypes.c_void_p(indices.handle)))


class SpreadFactor:
    """The same elimination by several ranks together, each with a part of the factor.

    matrix, schur: as for `Factor`, known to every rank of `comm`. MUMPS gives Schur complements on one rank only, so
    the complement is made of solves with the kept unknowns' columns.
    """

    #: Columns that are solved for at once.
    BLOCK = 64

    def __init__(self, matrix: scipy.sparse.csr_matrix, schur: NDArray[np.intp], comm: MPI.Comm) -> None:
        self._comm, self._kept = comm, schur
        self._inner = np.setdiff1d(np.arange(matrix.shape[0]), schur)
        ends = np.linspace(0, len(self._inner), comm.size + 1).astype(int)
        self._first, self._last = ends[comm.rank], ends[comm.rank + 1]
        rows = matrix[self._inner[self._first : self._last]].tocsr()
        own, self._coupling = rows[:, self._inner].tocsr(), rows[:, schur].tocsr()
        self._kept_block = matrix[schur][:, schur].toarray()
        own.sort_indices()
        size = (self._last - self._first, len(self._inner))
        csr = (own.indptr.astype(PETSc.IntType), own.indices.astype(PETSc.IntType), own.data)
        self._matrix = PETSc.Mat().createAIJ((size, size), csr=csr, comm=comm)
        self._pc = _mumps(self._matrix)
        _factor(self._pc)
        self._rhs, self._solution = self._matrix.createVecs()

    def solve(self, rhs: Floats) -> Floats:
        """The solution of the inner system for one right-hand side of all unknowns, known to every rank."""
        self._rhs.array[:] = rhs[self._inner[self._first : self._last]]
        self._pc.apply(self._rhs, self._solution)
        solution = np.zeros(len(rhs))
        solution[self._inner] = np.concatenate(self._comm.allgather(self._solution.array.copy()))
        return solution

    @property
    def schur_complement(self) -> Floats:
        """The Schur complement, dense (c, c), the same on every rank."""
        eliminated = np.empty_like(self._kept_block)
        local, total = self._last - self._first, len(self._inner)
        for start in range(0, len(self._kept), self.BLOCK):
            columns = self._coupling[:, start : start + self.BLOCK].toarray(order="F")
            count = columns.shape[1]
            sizes = ((local, total), (PETSc.DECIDE, count))
            given = PETSc.Mat().createDense(sizes, array=columns, comm=self._comm)
            found = PETSc.Mat().createDense(sizes, comm=self._comm)
            given.assemble()
            found.setUp()
            found.assemble()
            self._pc.getFactorMatrix().matSolve(given, found)
            eliminated[:, start : start + count] = self._coupling.T @ found.getDenseArray()
            given.destroy()
            found.destroy()
        complement = self._kept_block - self._comm.allreduce(eliminated)
        return 0.5 * (complement + complement.T)


def _mumps(matrix: PETSc.Mat) -> PETSc.PC:
    """MUMPS' Cholesky factorisation of a matrix, still to be made."""
    matrix.setOption(PETSc.Mat.Option.SPD, True)
    pc = PETSc.PC().create(matrix.getComm())
    pc.setOperators(matrix)
    pc.setType("cholesky")
    pc.setFactorSolverType("mumps")
    return pc


def _factor(pc: PETSc.PC) -> None:
    """Factor, and notice if that failed: PETSc would go on and return infinities."""
    pc.setUp()
    code = pc.getFactorMatrix().getMumpsInfog(1)
    if code < 0:
        raise np.linalg.LinAlgError(f"MUMPS could not factor the matrix: INFOG(1) = {code}")


@cache
def _petsc() -> ctypes.CDLL:
    """The PETSc library that petsc4py has loaded into this process."""
    with open("/proc/self/maps") as maps:
        for line in maps:
            path = line.split()[-1]
            if "/libpetsc" in path and ".so" in path:
                return ctypes.CDLL(path)
    raise RuntimeError("the PETSc library of petsc4py is not among the loaded libraries")


def _check(error: int) -> None:
    if error:
        raise PETSc.Error(error)
