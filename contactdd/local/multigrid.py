"""A body too large to factor: its problem by conjugate gradients with algebraic multigrid, set up once."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import scipy
from numpy.typing import NDArray
from petsc4py import PETSc

from ..base.arrays import Floats
from .assembled import AssembledProblem
from .problem import ContactTrace, Solver
from .rigid import select_fixing_dofs


class MultigridProblem(AssembledProblem):
    """The same problem in all free displacements; nothing is factored, memory grows with the unknowns.

    PETSc's GAMG with the rigid motions as near-null space is the preconditioner. It belongs to the coefficient φ of the
    step for which it was set up and is made anew only when φ as a whole has become something else.
    """

    #: By how much the total Robin stiffness may change before the multigrid is set up again.
    DRIFT = 4.0
    #: The relative accuracy of a body's own solve: below what the outer iterations ask for.
    ACCURACY = 1e-12

    #: The total Robin stiffness that the present multigrid was set up for.
    _made_for: float | None = None

    def start(self, normal_displacement: Mapping[int, Floats]) -> Floats:
        """Unknowns near the given u_n: held there by a Robin term a thousand times stiffer than the body's surface."""
        stiff = {}
        for port in self.ports:
            area = float(port.side.surface.weights.sum())
            stiff[port.interface] = np.full(len(normal_displacement[port.interface]), 1e3 * self.rigid.largest / area)
        rhs = self.load.copy()
        for port in self.ports:
            own = port.side.transfer @ (normal_displacement[port.interface] * stiff[port.interface])
            rhs += port.robin_trace.T @ (port.side.surface.weights * own)
        return self._solver(stiff, np.zeros(0, dtype=np.intp))(rhs)

    def held(self, phi: Mapping[int, Floats]) -> Solver:
        """One multigrid cycle: symmetric and linear, as a preconditioner has to be."""
        self._set_up(phi)
        return self._multigrid.cycle

    def _solver(self, phi: Mapping[int, Floats], ground: NDArray[np.intp]) -> Solver:
        self._set_up(phi)
        return lambda forces: self._iterate(phi, forces, ground)

    def _iterate(self, phi: Mapping[int, Floats], forces: Floats, ground: NDArray[np.intp]) -> Floats:
        """(A + Φ)⁻¹ times forces with these unknowns held, by conjugate gradients."""
        held = np.zeros(self.size)
        held[ground] = self.rigid.largest
        terms = [(port.robin_trace, self._weights(port, phi)) for port in self.ports]

        def apply(y: Floats) -> Floats:
            return self.stiffness @ y + held * y + sum(trace.T @ (w * (trace @ y)) for trace, w in terms)

        shape = (self.size, self.size)
        solution, failed = scipy.sparse.linalg.cg(
            scipy.sparse.linalg.LinearOperator(shape, apply, dtype=float),
            forces,
            rtol=self.ACCURACY,
            maxiter=2000,
            M=scipy.sparse.linalg.LinearOperator(shape, self._multigrid.cycle, dtype=float),
        )
        if failed:
            raise np.linalg.LinAlgError(f"body {self.body.name!r}: the multigrid iterations do not converge")
        return solution

    def _weights(self, port: ContactTrace, phi: Mapping[int, Floats]) -> Floats:
        """φ times the areas at the integration points of the body's own surface."""
        return port.side.surface.weights * (port.side.transfer @ phi[port.interface])

    def _set_up(self, phi: Mapping[int, Floats]) -> None:
        """Make the multigrid for A + Φ unless the present one is near enough."""
        total = sum(float(self._weights(port, phi).sum()) for port in self.ports)
        if self._made_for is not None and self._made_for / self.DRIFT <= total <= self._made_for * self.DRIFT:
            return
        self._made_for = total
        matrix = self.stiffness
        for port in self.ports:
            matrix = matrix + port.robin_trace.T @ scipy.sparse.diags(self._weights(port, phi)) @ port.robin_trace
        held = np.zeros(self.size)
        held[select_fixing_dofs(self.rigid.modes @ self.rigid.free(phi))] = self.rigid.largest
        self._multigrid = Multigrid(self, (matrix + scipy.sparse.diags(held)).tocsr())


class Multigrid:
    """One cycle of algebraic multigrid for a matrix in the unknowns of a body.

    The unknowns are embedded into all displacements, the prescribed ones held by a diagonal: so that every node has
    all its components, as the aggregation of nodes wants.
    """

    def __init__(self, problem: AssembledProblem, matrix: scipy.sparse.csr_matrix) -> None:
        self._basis, dim = problem.space.basis, problem.body.mesh.dim
        self._nothing_to_do = problem.size == 0  # all is held: GAMG would get a matrix of zeros, and crash
        if self._nothing_to_do:
            return
        outside = scipy.sparse.eye(self._basis.shape[0], format="csr") - self._basis @ self._basis.T
        full = (self._basis @ matrix @ self._basis.T + problem.rigid.largest * outside).tocsr()
        full.sort_indices()
        arrays = (full.indptr.astype(PETSc.IntType), full.indices.astype(PETSc.IntType), full.data)
        self._matrix = PETSc.Mat().createAIJ(full.shape, bsize=dim, csr=arrays, comm=PETSc.COMM_SELF)
        self._matrix.setOption(PETSc.Mat.Option.SPD, True)
        body = problem.body
        motions = body.kinematics.mesh_motions(body.space.tabulate_dof_coordinates())
        orthonormal = np.linalg.qr(motions.reshape(-1, motions.shape[2]))[0]
        vectors = [PETSc.Vec().createWithArray(column.copy(), comm=PETSc.COMM_SELF) for column in orthonormal.T]
        self._matrix.setNearNullSpace(PETSc.NullSpace().create(vectors=vectors, comm=PETSc.COMM_SELF))
        self._pc = PETSc.PC().create(PETSc.COMM_SELF)
        self._pc.setOperators(self._matrix)
        self._pc.setType("gamg")
        self._pc.setUp()
        self._rhs, self._solution = self._matrix.createVecs()

    def cycle(self, forces: Floats) -> Floats:
        if self._nothing_to_do:
            return np.zeros_like(forces)
        self._rhs.array[:] = self._basis @ forces
        self._pc.apply(self._rhs, self._solution)
        return self._basis.T @ self._solution.array
