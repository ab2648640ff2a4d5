"""A meshed body that deforms in a few given ways only: rigid, by modes, or by a fitted basis (Ritz's method)."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import replace
from typing import Any

import numpy as np
import scipy

from ..base.arrays import Floats
from ..base.checks import as_floats
from .dense import DenseSystem
from .discrete import DiscreteBody
from .problem import ContactTrace, Fields, Solver, nodal_operator, refreshed_traces, rigid_motions
from .rigid import orthonormal
from .space import AdmissibleSpace
from .task import LocalTask

#: Singular values below this part of the largest are combinations that the supports allow, or that are none.
NEGLIGIBLE = 1e-10


class ReducedProblem:
    """The local problem of a body whose displacements are combinations of given ones, those that its supports allow.

    A rigid body is `ReducedProblem(task, task.body.rigid_modes())`.

    Args:
        task: The body with its contacts, as a local solver is given them.
        basis: (dofs, n) Displacements in all degrees of freedom of the body (length, in any scale).

    Raises:
        TypeError, ValueError: The basis is no array of finite numbers with a row for each degree of freedom.

    Example:
        >>> import contactdd as cd
        >>> def rigid(task: cd.LocalTask) -> cd.LocalProblem:
        ...     return cd.ReducedProblem(task, task.body.rigid_modes())
        >>> mesh = cd.rectangle((0, 0), (2, 1), (2, 1))
        >>> body = cd.Body("punch", mesh, cd.Isotropic(E=2e5, nu=0.3), local_solver=rigid)
    """

    factor_free = False

    def __init__(self, task: LocalTask, basis: Floats) -> None:
        self.name, self.length, discrete = task.body.name, task.body.mesh.size, task.discrete
        space = discrete.space
        given = as_floats("basis", basis, "finite numbers (dofs, n)")
        if given.ndim != 2 or len(given) != len(space.offset) or not np.all(np.isfinite(given)):
            raise ValueError(f"basis of shape {given.shape}: expected finite numbers ({len(space.offset)}, n)")
        self._basis = _admissible(space, given)
        self.dofs = ReducedDofs(discrete, self._basis)
        traces = [(index, side, space.columns(side.trace)) for index, side in task.sides]
        self.traces = [
            ContactTrace(
                index,
                side,
                trace @ self._basis,
                space.prescribed(side.trace),
                space.columns(side.surface.trace) @ self._basis,
            )
            for index, side, trace in traces
        ]
        full = discrete.stiffness.reduced
        self.stiffness = self._basis.T @ (full @ self._basis)
        scale = float(full.diagonal().max(initial=0.0))  # of the body, which a rigid one has too
        self.rigid = rigid_motions(self.name, task.body.kinematics, self.traces, *self._motions(), scale)
        self._system = DenseSystem(self.name, self.stiffness, self.traces, self.rigid)

    def _motions(self) -> tuple[Floats, Floats, Floats]:
        """The body's rigid motions that are combinations of the basis: unknowns, coefficients, spring forces."""
        discrete = self.dofs.discrete
        modes, coefficients = discrete.motions
        unknowns = self._basis.T @ modes
        _, singular, right = np.linalg.svd(modes - self._basis @ unknowns, full_matrices=False)
        inside = right[singular <= NEGLIGIBLE].T
        if inside.shape[1] == 0:
            return np.zeros((self.size, 0)), coefficients[:, :0], np.zeros((self.size, 0))
        return orthonormal(unknowns @ inside, coefficients @ inside, self._basis.T @ discrete.spring_forces @ inside)

    def refreshed(self, dofs: Any) -> ReducedProblem:
        other = copy(self)
        other.dofs = ReducedDofs(dofs, self._basis)
        other.traces = refreshed_traces(self.traces, dofs.space)
        other._system = replace(self._system, traces=other.traces)
        return other

    @property
    def load(self) -> Floats:
        return self._basis.T @ self.dofs.discrete.free_load

    @property
    def constant(self) -> float:
        return self.dofs.discrete.constant

    @property
    def size(self) -> int:
        return self._basis.shape[1]

    @property
    def nodal_trace(self) -> scipy.sparse.csr_matrix:
        return scipy.sparse.csr_matrix(self.dofs.discrete.space.columns(nodal_operator(self.traces)) @ self._basis)

    @property
    def nodal_offset(self) -> Floats:
        return self.dofs.discrete.space.prescribed(nodal_operator(self.traces))

    def correct(self, phi: Mapping[int, Floats], residual: Floats, scale: float) -> Floats:
        return self._system.correct(phi, residual, scale)

    def robin_solver(self, phi: Mapping[int, Floats]) -> Solver:
        return self._system.robin_solver(phi)

    def low_modes(self, phi: Mapping[int, Floats], below: float) -> Floats:
        return self._system.low_modes(phi, below)

    def start(self, normal_displacement: Mapping[int, Floats]) -> Floats:
        return self._system.start(normal_displacement)

    def restrict(self, u: Floats) -> Floats:
        return self._basis.T @ self.dofs.discrete.restrict(u)

    def displacement(self, y: Floats) -> Floats:
        return self.dofs.discrete.displacement(self._basis @ y)

    def seen(self, y: Floats, operator: scipy.sparse.csr_matrix) -> Floats | None:
        return operator @ self.displacement(y)

    def fields(self, y: Floats, deformation: Floats) -> Fields:
        discrete = self.dofs.discrete
        moved = discrete.moved(self.rigid, y)
        return discrete.fields(self.displacement(y), discrete.strained(self._basis @ deformation), moved)


class ReducedDofs:
    """A meshed body in all its degrees of freedom, of which only some combinations are free."""

    def __init__(self, discrete: DiscreteBody, basis: Floats) -> None:
        self.discrete, self._basis = discrete, basis

    @property
    def load(self) -> Floats:
        return self.discrete.load

    @property
    def prescribed(self) -> bool:
        return self.discrete.prescribed

    @property
    def load_size(self) -> float:
        return self.discrete.load_size

    def free_forces(self, forces: Floats) -> Floats:
        return self._basis.T @ self.discrete.free_forces(forces)

    def reactions(self, forces: Floats) -> Floats:
        """The forces of supports and of the constraints on the body's shape, which have no resultant of their own."""
        return forces - self.discrete.space.extended(self._basis @ self.free_forces(forces))

    def resultant(self, forces: Floats) -> Floats:
        return self.discrete.resultant(forces)

    def rigid_displacements(self, coefficients: Floats) -> Floats:
        return self.discrete.rigid_displacements(coefficients)


def _admissible(space: AdmissibleSpace, basis: Floats) -> Floats:
    """An orthonormal basis (unknowns, m) of the combinations of displacements (dofs, n) that the supports allow."""
    scale = np.linalg.norm(basis, axis=0)
    basis = basis / np.where(scale > 0.0, scale, 1.0)
    prevented = np.concatenate([space.prevented(basis), np.zeros((basis.shape[1],) * 2)])
    _, singular, right = np.linalg.svd(prevented, full_matrices=False)
    allowed = space.restricted(basis @ right[singular <= NEGLIGIBLE].T)
    left, singular, _ = np.linalg.svd(allowed, full_matrices=False)
    return left[:, singular > NEGLIGIBLE * singular.max(initial=0.0)]
