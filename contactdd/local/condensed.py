"""A body condensed once to the displacements that its contacts touch: an iteration is of their size."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Any

import numpy as np
import scipy
from mpi4py import MPI

from ..base.arrays import Floats, Indices, components
from ..interface.discretise import InterfaceSide
from .affine import cell_nodes
from .condensation import Condensation, ElementCondensation, MirroredCondensation, SmallCondensation, SparseCondensation
from .copies import loaded_alike
from .dense import DenseSystem
from .discrete import DiscreteBody
from .dissection import Dissection
from .multifrontal import MultifrontalCondensation, stiffness_of_rows
from .problem import Fields, Solver, contact_traces, nodal_operator, refreshed_traces, rigid_motions
from .rigid import orthonormal
from .task import LocalTask

#: Of the largest singular value: below it, a combination of rigid modes vanishes at some unknowns.
VANISHES = 1e-8


#: Unknowns of a solid from which its inside is condensed by parts.
DISSECTED = 8000


class CondensedProblem:
    """S + Φ in the displacements that the contacts touch; the inside is recovered when it is asked for.

    A step costs one dense Cholesky factorisation. A copy of another body takes over its condensation.
    """

    factor_free = False
    condensation: Condensation
    stiffness: Floats
    load: Floats
    constant: float

    def __init__(self, task: LocalTask) -> None:
        self.body, self.dofs = task.body, task.discrete
        self.name, self.length = task.body.name, task.body.mesh.size
        self.kept = touched_unknowns(self.dofs, task.sides)
        self.traces = contact_traces(task.sides, self.dofs.space, self.kept, task.crowded)
        original = task.original
        if isinstance(original, CondensedProblem) and np.array_equal(self.kept, original.kept):
            self._set_as_copy(original, task.signs)
            return
        self.condensation = condense(self.dofs, self.kept, task.comm)
        if task.crowded:
            self.dofs.stiffness.forget()
        self.stiffness = self.condensation.schur_complement
        self._set_motions()
        self._set_loads()

    def _set_as_copy(self, original: CondensedProblem, signs: Floats) -> None:
        """Take over everything from the problem of the body that this one copies, with the signs of mirrored
        components."""
        turned = self.dofs.mirrored(signs)
        self.condensation = MirroredCondensation(original.condensation, turned, self.kept)
        kept = turned[self.kept]
        self.stiffness = kept[:, None] * original.stiffness * kept
        modes, (owner,) = original.rigid.modes, original.rigid.owners
        coefficients = self.body.kinematics.mirrored_modes(signs)[:, None] * owner.coefficients
        self._set_system(kept[:, None] * modes, coefficients, np.zeros_like(modes))
        if loaded_alike(original.body, self.body):
            self.load, self.constant = kept * original.load, original.constant
        else:
            self._set_loads()

    def refreshed(self, dofs: Any) -> CondensedProblem:
        other = copy(self)
        other.dofs = dofs
        other.traces = refreshed_traces(self.traces, dofs.space)
        other.system = replace(self.system, traces=other.traces)
        if "_robin" in vars(self.system):  # does not depend on the offsets
            vars(other.system)["_robin"] = self.system._robin
        other._set_loads()
        return other

    def _set_motions(self) -> None:
        """Find the rigid motions, and take the rounding of the condensation out of the elastic forces that they meet.

        Rigid motions must produce no elastic force except in springs; else a floating body's forces balance only to
        the rounding of many thousand sums, and soft springs are lost in it.
        """
        modes, coefficients = self.dofs.motions
        springs = self.dofs.spring_forces
        if np.any(springs):
            springs = np.column_stack([self.condensation.condense_load(force)[0] for force in springs.T])
        else:
            springs = np.zeros((len(self.kept), springs.shape[1]))
        q, coefficients, springs = orthonormal(modes[self.kept], coefficients, springs)
        wrong = q.T @ self.stiffness - springs.T
        diagonal = self.stiffness.diagonal()
        self.stiffness = self.stiffness - q @ wrong - wrong.T @ q.T + q @ (wrong @ q) @ q.T
        self._set_system(q, coefficients, springs, float(diagonal.max(initial=0.0)))

    def _set_system(self, modes: Floats, coefficients: Floats, springs: Floats, scale: float | None = None) -> None:
        """Set the rigid motions and the dense system."""
        scale = float(self.stiffness.diagonal().max(initial=0.0)) if scale is None else scale
        kinematics = self.body.kinematics
        self.rigid = rigid_motions(self.name, kinematics, self.traces, modes, coefficients, springs, scale)
        self.system = DenseSystem(self.name, self.stiffness, self.traces, self.rigid)

    def _set_loads(self) -> None:
        """Set the condensed loads; their work on rigid motions is corrected to equal that of the full loads exactly."""
        dofs = self.dofs
        self.load, done = self.condensation.condense_load(dofs.free_load)
        self.constant = dofs.constant - 0.5 * done
        modes = dofs.motions[0]
        if modes.shape[1] > 0:
            work = modes.T @ dofs.free_load
            if np.any(dofs.spring_forces):
                work -= dofs.spring_forces.T @ self.condensation.recover(np.zeros(len(self.kept)), dofs.free_load)
            kept, q = modes[self.kept], self.rigid.modes
            self.load += q @ np.linalg.solve(kept.T @ q, work - kept.T @ self.load)

    @property
    def size(self) -> int:
        return len(self.kept)

    @property
    def nodal_trace(self) -> scipy.sparse.csr_matrix:
        return self.dofs.space.columns(nodal_operator(self.traces))[:, self.kept]

    @property
    def nodal_offset(self) -> Floats:
        return self.dofs.space.prescribed(nodal_operator(self.traces))

    def correct(self, phi: Mapping[int, Floats], residual: Floats, scale: float) -> Floats:
        return self.system.correct(phi, residual, scale)

    def robin_solver(self, phi: Mapping[int, Floats]) -> Solver:
        return self.system.robin_solver(phi)

    def low_modes(self, phi: Mapping[int, Floats], below: float) -> Floats:
        return self.system.low_modes(phi, below)

    def start(self, normal_displacement: Mapping[int, Floats]) -> Floats:
        return self.system.start(normal_displacement)

    def restrict(self, u: Floats) -> Floats:
        return self.dofs.restrict(u)[self.kept]

    def displacement(self, y: Floats) -> Floats:
        return self.dofs.displacement(self.condensation.recover(y, self.dofs.free_load))

    def seen(self, y: Floats, operator: scipy.sparse.csr_matrix) -> Floats | None:
        return seen_from(self.dofs, self.kept, y, operator)

    def fields(self, y: Floats, deformation: Floats) -> Fields:
        moved, load = self.dofs.moved(self.rigid, y), self.dofs.free_load
        if moved is not None:  # the inside gives way to the springs
            load = load - self.dofs.free_forces(self.dofs.stiffness.spring_forces(moved))
        strained = self.dofs.strained(self.condensation.recover(deformation, load))
        return self.dofs.fields(self.displacement(y), strained, moved)


def seen_from(dofs: DiscreteBody, kept: Indices, y: Floats, operator: scipy.sparse.csr_matrix) -> Floats | None:
    """operator @ displacement of the kept unknowns, or None if it depends on the inside; operator: on all dofs."""
    unknowns = np.full(dofs.space.size, np.nan)  # the inside is not known, nor is what depends on it
    unknowns[kept] = y
    seen = operator @ dofs.displacement(unknowns)
    return None if np.isnan(seen).any() else seen


def touched_unknowns(dofs: DiscreteBody, sides: Sequence[tuple[int, InterfaceSide]]) -> Indices:
    """The unknowns that a contact's normal displacements depend on and, where a body could still move rigidly with
    all of them held, every unknown of the same nodes: the inside must be a well-posed problem."""
    space = dofs.space
    traces = {id(trace): trace for _, side in sides for trace in (side.trace, side.surface.trace)}
    touched = np.concatenate([trace.indices for trace in traces.values()])
    kept = space.unknowns_at(touched)
    if _hold(dofs.motions[0][kept]):
        return kept
    dim = dofs.body.mesh.dim
    nodes = np.unique(touched // dim)  # also those at which a support holds all that the contact would touch
    return space.unknowns_at(components(nodes, dim))


def condense(dofs: DiscreteBody, kept: Indices, comm: MPI.Comm = MPI.COMM_SELF) -> Condensation:
    """A body's inside condensed: cell by cell first where many unknowns lie inside of alike cells."""
    stiffness, space = dofs.stiffness, dofs.space
    if comm.size == 1 and space.free is not None and not stiffness.has_springs and stiffness.cells is not None:
        return ElementCondensation(stiffness.cells, space, kept)
    if comm.size == 1 and dofs.body.mesh.dim == 3 and space.size >= DISSECTED:
        return _dissected(dofs, kept)
    matrix = space.within(stiffness.full)  # not kept beside its factor
    if comm.size == 1 and 0 < len(kept) < matrix.shape[0] <= SmallCondensation.LARGEST:
        return SmallCondensation(matrix, kept)
    return SparseCondensation(matrix, kept, comm)


def _dissected(dofs: DiscreteBody, kept: Indices) -> MultifrontalCondensation:
    """The inside of a solid condensed by halves of halves of its cells."""
    body, space, stiffness = dofs.body, dofs.space, dofs.stiffness
    middles = cell_nodes(body.mesh).mean(axis=1)
    dissection = Dissection.of(body.space.dofmap.list, middles, space.nodes(body.mesh.dim), kept)
    mixes = space.free is None
    own = stiffness_of_rows(
        stiffness.reduced if mixes else stiffness.full,
        np.arange(space.size) if mixes else space.free_dofs,
        dissection,
    )
    return MultifrontalCondensation(dissection, len(kept), own)


def condensed_start(
    dofs: DiscreteBody, sides: Sequence[tuple[int, InterfaceSide]], normal_displacement: Mapping[int, Floats]
) -> Floats:
    """All unknowns with (nearly) the given u_n at the contact points and the inside in equilibrium."""
    problem = CondensedProblem(LocalTask(dofs.body, sides, dofs))
    return dofs.restrict(problem.displacement(problem.start(normal_displacement)))


def _hold(modes: Floats) -> bool:
    """Whether no combination of rigid modes vanishes at the given unknowns."""
    if modes.shape[1] <= 1:
        return bool(modes.any(axis=0).all())
    singular = np.linalg.svd(modes, compute_uv=False)
    return len(singular) == modes.shape[1] and bool(singular[-1] > VANISHES * singular[0])
