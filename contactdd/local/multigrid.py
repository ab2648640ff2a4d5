"""A body too large to factor: its problem by conjugate gradients with algebraic multigrid, set up once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy
from petsc4py import PETSc

from ..base.arrays import Floats, Indices, Operator
from ..base.sparse import entry_positions
from .discrete import DiscreteBody
from .problem import ContactTrace, Fields, Solver, contact_traces, free_fixing_dofs, nodal_operator, refreshed_traces
from .rigid import RigidMotions
from .task import LocalTask

#: Stiffness of the Robin term that enforces a start's displacements, over that of the body's surface.
STIFF_START = 1e3


#: An option of PETSc: the products Pᵀ A P as (Pᵀ A) P, in two thirds of the time of what PETSc does otherwise.
PRODUCTS = "matptap_via", "rap"


class MultigridProblem:
    """A + Φ in all free displacements; nothing is factored, memory grows with the unknowns."""

    factor_free = True

    def __init__(self, task: LocalTask) -> None:
        self.name, self.length = task.body.name, task.body.mesh.size
        self.dofs = task.discrete
        own = self.dofs.stiffness.operator
        self.stiffness: Operator = task.collective(own)
        self.traces: Sequence[ContactTrace] = contact_traces(task.sides, self.dofs.space)
        self.rigid = self.dofs.rigid_motions(self.traces)
        self._robin = _RobinSystem(self.dofs, own, self.traces, self.rigid)
        if isinstance(task.original, MultigridProblem):
            self._robin.share_with(task.original._robin, self.dofs.mirrored(task.signs))

    def refreshed(self, dofs: Any) -> MultigridProblem:
        other = copy(self)
        other.dofs = dofs
        other.traces = refreshed_traces(self.traces, dofs.space)
        return other

    @property
    def load(self) -> Floats:
        return self.dofs.free_load

    @property
    def constant(self) -> float:
        return self.dofs.constant

    @property
    def size(self) -> int:
        return len(self.dofs.free_load)

    @property
    def nodal_trace(self) -> scipy.sparse.csr_matrix:
        return self.dofs.space.columns(nodal_operator(self.traces))

    @property
    def nodal_offset(self) -> Floats:
        return self.dofs.space.prescribed(nodal_operator(self.traces))

    def correct(self, phi: Mapping[int, Floats], residual: Floats, scale: float) -> Floats:
        return self._robin.solve(phi, residual, self.rigid.fixing_dofs(phi, residual, scale))

    def robin_solver(self, phi: Mapping[int, Floats]) -> Solver:
        """One multigrid cycle: symmetric and linear, as a preconditioner has to be."""
        return self._robin.multigrid(phi).cycle

    def low_modes(self, phi: Mapping[int, Floats], below: float) -> Floats:
        return np.zeros((self.size, 0))

    def start(self, normal_displacement: Mapping[int, Floats]) -> Floats:
        """Unknowns near the given u_n: held there by a Robin term a thousand times stiffer than the body's surface."""
        stiff, rhs = {}, self.load.copy()
        for trace in self.traces:
            surface, given = trace.side.surface, normal_displacement[trace.interface]
            area = float(surface.weights.sum())
            stiff[trace.interface] = np.full(len(given), STIFF_START * self.rigid.stiffness_scale / area)
            rhs += trace.robin_trace.T @ (surface.weights * (trace.side.transfer @ (given * stiff[trace.interface])))
        return self._robin.solve(stiff, rhs, np.zeros(0, dtype=np.intp))

    def restrict(self, u: Floats) -> Floats:
        return self.dofs.restrict(u)

    def displacement(self, y: Floats) -> Floats:
        return self.dofs.displacement(y)

    def seen(self, y: Floats, operator: scipy.sparse.csr_matrix) -> Floats | None:
        return operator @ self.dofs.displacement(y)

    def fields(self, y: Floats, deformation: Floats) -> Fields:
        moved = self.dofs.moved(self.rigid, y)
        return self.dofs.fields(self.displacement(y), self.dofs.strained(deformation), moved)


@dataclass
class _RobinSystem:
    """A + Φ by conjugate gradients. PETSc's GAMG with the rigid motions as near-null space is the preconditioner.

    It belongs to the coefficient φ for which it was set up and is made anew only when φ as a whole has become something
    else.
    """

    dofs: DiscreteBody
    matrix: Operator
    traces: Sequence[ContactTrace]
    rigid: RigidMotions
    _own: _Made | None = field(default=None, init=False)
    _signs: Floats | float = field(default=1.0, init=False)
    _sharing: list[_RobinSystem] = field(default_factory=list, init=False)

    #: By how much the total Robin stiffness may change before the multigrid is set up again.
    DRIFT = 4.0
    #: The relative accuracy of a body's own solve: below what the outer iterations ask for.
    ACCURACY = 1e-12
    #: Iterations after which a body's own solve has failed.
    MOST = 2000

    def solve(self, phi: Mapping[int, Floats], forces: Floats, fixed: Indices) -> Floats:
        """(A + Φ)⁻¹ times forces with these unknowns fixed."""
        held = np.zeros(len(forces))
        held[fixed] = self.rigid.stiffness_scale
        terms = [(trace.robin_trace, trace.surface_stiffness(phi)) for trace in self.traces]

        def apply(y: Floats) -> Floats:
            return self.matrix @ y + held * y + sum(trace.T @ (w * (trace @ y)) for trace, w in terms)

        solution, failed = scipy.sparse.linalg.cg(
            scipy.sparse.linalg.LinearOperator(self.matrix.shape, apply, dtype=float),
            forces,
            rtol=self.ACCURACY,
            maxiter=self.MOST,
            M=scipy.sparse.linalg.LinearOperator(self.matrix.shape, self.multigrid(phi).cycle, dtype=float),
        )
        if failed:
            raise np.linalg.LinAlgError(f"body {self.dofs.body.name!r}: the multigrid iterations do not converge")
        return solution

    def share_with(self, original: _RobinSystem, signs: Floats) -> None:
        """Use what is set up for a body that this one copies, and the other way round; signs: between the unknowns."""
        self._signs = signs * original._signs
        self._sharing = original._sharing = original._sharing or [original]
        self._sharing.append(self)

    def multigrid(self, phi: Mapping[int, Floats]) -> Multigrid | _Turned:
        """The multigrid for A + Φ, or one that is near enough: this body's own, or that of a copy of it."""
        total = sum(float(trace.surface_stiffness(phi).sum()) for trace in self.traces)
        for other in (self, *self._sharing):
            made = other._own
            if made is not None and made.total / self.DRIFT <= total <= made.total * self.DRIFT:
                return made.multigrid if other is self else _Turned(made.multigrid, self._signs * other._signs)
        self._own = _Made(total, self._set_up(phi))
        return self._own.multigrid

    def _set_up(self, phi: Mapping[int, Floats]) -> Multigrid:
        """The multigrid for A + Φ, with any motion fixed that is free."""
        basis, held = self.dofs.space.basis, np.zeros(self.dofs.space.size)
        held[free_fixing_dofs(self.rigid, phi)] = self.rigid.stiffness_scale
        added = basis @ scipy.sparse.diags(held) @ basis.T
        for trace in self.traces:
            stiffness, own = scipy.sparse.diags(trace.surface_stiffness(phi)), trace.side.surface.trace
            added = added + own.T @ stiffness @ own
        return Multigrid(self.dofs, added.tocsr(), self.rigid.stiffness_scale)


@dataclass(frozen=True)
class _Made:
    """A multigrid and the total Robin stiffness for which it was set up."""

    total: float
    multigrid: Multigrid


@dataclass(frozen=True)
class _Turned:
    """The cycle of a copy of a body, from that of the body; signs: ±1 between their unknowns."""

    multigrid: Multigrid
    signs: Floats | float

    def cycle(self, forces: Floats) -> Floats:
        return self.signs * self.multigrid.cycle(self.signs * forces)


class Multigrid:
    """One cycle of algebraic multigrid for a body's stiffness and what is added to it, (dofs, dofs).

    It is set up in all displacements, the prescribed ones held by a diagonal: so that every node has all its
    components, as the aggregation of nodes wants.
    """

    def __init__(self, dofs: DiscreteBody, added: scipy.sparse.csr_matrix, stiffness_scale: float) -> None:
        self._space, body = dofs.space, dofs.body
        self._nothing_to_do = dofs.space.size == 0  # all is held: GAMG would get a matrix of zeros, and crash
        if self._nothing_to_do:
            return
        blocks = _held_blocks(dofs, added, stiffness_scale)
        self._matrix = _petsc(blocks.tocsr(), body.mesh.dim)
        motions = body.kinematics.mesh_motions(body.space.tabulate_dof_coordinates())
        orthonormal = np.linalg.qr(motions.reshape(-1, motions.shape[2]))[0]
        vectors = [PETSc.Vec().createWithArray(column.copy(), comm=PETSc.COMM_SELF) for column in orthonormal.T]
        self._matrix.setNearNullSpace(PETSc.NullSpace().create(vectors=vectors, comm=PETSc.COMM_SELF))
        self._pc = PETSc.PC().create(PETSc.COMM_SELF)
        self._pc.setOperators(self._matrix)
        self._pc.setType("gamg")
        _set_up(self._pc)
        if self._pc.getMGLevels() > 1:  # products with blocks take half the time
            finest, blocked = self._pc.getMGSmoother(self._pc.getMGLevels() - 1), _petsc(blocks, body.mesh.dim)
            finest.setOperators(blocked, blocked)
            finest.setUp()
        self._rhs, self._solution = self._matrix.createVecs()

    def cycle(self, forces: Floats) -> Floats:
        if self._nothing_to_do:
            return np.zeros_like(forces)
        self._rhs.array[:] = self._space.extended(forces)
        self._pc.apply(self._rhs, self._solution)
        return self._space.restricted(self._solution.array)


def _held_blocks(dofs: DiscreteBody, added: scipy.sparse.csr_matrix, stiffness_scale: float) -> scipy.sparse.bsr_matrix:
    """The stiffness and what is added to it in all degrees of freedom, those that are prescribed held by a diagonal."""
    space, dim = dofs.space, dofs.body.mesh.dim
    if space.free is None:
        basis = space.basis
        inside = dofs.stiffness.reduced + basis.T @ added @ basis
        outside = scipy.sparse.eye(basis.shape[0], format="csr") - basis @ basis.T
        return (basis @ inside @ basis.T + stiffness_scale * outside).tobsr((dim, dim))
    free = np.zeros(len(space.offset))
    free[space.free] = 1.0
    selected = scipy.sparse.diags(free)
    added = (selected @ added @ selected + scipy.sparse.diags(stiffness_scale * (1.0 - free))).tobsr((dim, dim))
    matrix, node = dofs.stiffness.blocks, free.reshape(-1, dim)
    values = matrix.data * node[np.repeat(np.arange(len(node)), np.diff(matrix.indptr))][:, :, None]
    values *= node[matrix.indices][:, None]
    values[entry_positions(_pattern(matrix), _pattern(added))] += added.data
    return scipy.sparse.bsr_matrix((values, matrix.indices, matrix.indptr), shape=matrix.shape)


def _pattern(matrix: scipy.sparse.bsr_matrix) -> scipy.sparse.csr_matrix:
    """The numbers of a matrix's blocks as the entries of one of nodes."""
    matrix.sort_indices()
    entries = (np.arange(len(matrix.data)), matrix.indices, matrix.indptr)
    return scipy.sparse.csr_matrix(entries, shape=(len(matrix.indptr) - 1,) * 2)


def _set_up(pc: PETSc.PC) -> None:
    """Set up, with products of matrices made in the way that is quicker, if the user asks for no other."""
    options, (name, way) = PETSc.Options(), PRODUCTS
    if options.hasName(name):
        pc.setUp()
        return
    options[name] = way
    try:
        pc.setUp()
    finally:
        options.delValue(name)


def _petsc(matrix: scipy.sparse.csr_matrix | scipy.sparse.bsr_matrix, dim: int) -> PETSc.Mat:
    """The same symmetric positive definite matrix in PETSc; dim: components of a node."""
    arrays = (matrix.indptr.astype(PETSc.IntType, copy=False), matrix.indices.astype(PETSc.IntType, copy=False))
    make = PETSc.Mat().createBAIJ if isinstance(matrix, scipy.sparse.bsr_matrix) else PETSc.Mat().createAIJ
    made = make(matrix.shape, bsize=dim, csr=(*arrays, matrix.data), comm=PETSc.COMM_SELF)
    made.setOption(PETSc.Mat.Option.SPD, True)
    return made
