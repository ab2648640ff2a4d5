"""A body without a mesh, by dense algebra on its own degrees of freedom."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Any

import numpy as np
import scipy

from ..base.arrays import Floats
from ..meshless import MeshlessBody
from .dense import DenseSystem
from .problem import ContactTrace, Fields, Solver, contact_traces, nodal_operator, refreshed_traces, rigid_motions
from .rigid import RigidMotions, allowed_motions
from .space import AdmissibleSpace
from .task import LocalTask


class MeshlessDofs:
    """The degrees of freedom of a body without a mesh: u = Z y + u₀, its load and its rigid motions."""

    def __init__(self, body: MeshlessBody) -> None:
        self.body = body
        given = _sized("prescribed()", body.prescribed(), body)
        self.space = AdmissibleSpace(np.where(np.isnan(given), 0.0, given), np.flatnonzero(np.isnan(given)))
        self.load = _finite("load()", _sized("load()", body.load(), body), body)

    @property
    def prescribed(self) -> bool:
        return self.space.has_offset

    @property
    def load_size(self) -> float:
        return float(np.linalg.norm(self.body.resultant(self.load)))

    def refreshed(self) -> MeshlessDofs:
        return MeshlessDofs(self.body)

    def displacement(self, y: Floats) -> Floats:
        return self.space.extended(y) + self.space.offset

    def restrict(self, u: Floats) -> Floats:
        """The unknowns of a displacement in all degrees of freedom."""
        return self.space.restricted(u - self.space.offset)

    def fields(self, y: Floats, deformation: Floats, stiffness: Any) -> Fields:
        """The body's solution by the stiffness between all degrees of freedom, as of `LocalProblem.fields`."""
        u, deformed = self.displacement(y), self.displacement(deformation)
        elastic = stiffness @ deformed
        return Fields(u, elastic, np.zeros_like(u), 0.5 * float(deformed @ elastic))

    def rigid_motions(self, traces: Sequence[ContactTrace], stiffness_scale: float) -> RigidMotions:
        """The rigid motions that what is prescribed allows, with what each contact adds to their stiffness."""
        body = self.body
        modes, coefficients = body.rigid_motions()
        allowed, combined = allowed_motions(modes, self.space)
        springs, combined = np.zeros_like(allowed), coefficients @ combined
        return rigid_motions(body.name, body.kinematics, traces, allowed, combined, springs, stiffness_scale)

    def free_forces(self, forces: Floats) -> Floats:
        return self.space.restricted(forces)

    def reactions(self, forces: Floats) -> Floats:
        return forces - self.space.extended(self.space.restricted(forces))

    def resultant(self, forces: Floats) -> Floats:
        return self.body.resultant(forces)

    def rigid_displacements(self, coefficients: Floats) -> Floats:
        modes, own = self.body.rigid_motions()
        return modes @ np.linalg.lstsq(own, coefficients, rcond=None)[0]


class MeshlessProblem:
    """The local problem of a body without a mesh: its stiffness between the free degrees of freedom."""

    factor_free = False

    def __init__(self, task: LocalTask) -> None:
        body: MeshlessBody = task.body
        self.name, self.length = body.name, body.length
        matrix = np.asarray(body.stiffness(), dtype=float)
        if matrix.shape != (body.size, body.size) or not np.all(np.isfinite(matrix)):
            raise ValueError(f"stiffness() of body {body.name!r}: expected finite numbers ({body.size}, {body.size})")
        self._matrix = matrix
        self.dofs = MeshlessDofs(body)
        space = self.dofs.space
        self.stiffness = matrix[np.ix_(space.free_dofs, space.free_dofs)]
        self.traces = contact_traces(task.sides, space)
        self.rigid = self.dofs.rigid_motions(self.traces, float(matrix.diagonal().max(initial=0.0)))
        self._system = DenseSystem(self.name, self.stiffness, self.traces, self.rigid)
        self._set_loads()

    def refreshed(self, dofs: Any) -> MeshlessProblem:
        other = copy(self)
        other.dofs = self.dofs.refreshed()
        if not np.array_equal(other.dofs.space.free_dofs, self.dofs.space.free_dofs):
            raise ValueError(f"prescribed() of body {self.name!r}: other degrees of freedom are free than before")
        other.traces = refreshed_traces(self.traces, other.dofs.space)
        other._system = replace(self._system, traces=other.traces)
        other._set_loads()
        return other

    def _set_loads(self) -> None:
        """Set what follows from the loads and prescribed values."""
        offset, load = self.dofs.space.offset, self.dofs.load
        prescribed = self._matrix @ offset
        self.load = self.dofs.space.restricted(load - prescribed)
        self.constant = float(0.5 * offset @ prescribed - load @ offset)

    @property
    def size(self) -> int:
        return len(self.load)

    @property
    def nodal_trace(self) -> scipy.sparse.csr_matrix:
        return self.dofs.space.columns(nodal_operator(self.traces))

    @property
    def nodal_offset(self) -> Floats:
        return self.dofs.space.prescribed(nodal_operator(self.traces))

    def correct(self, phi: Mapping[int, Floats], residual: Floats, scale: float) -> Floats:
        return self._system.correct(phi, residual, scale)

    def robin_solver(self, phi: Mapping[int, Floats]) -> Solver:
        return self._system.robin_solver(phi)

    def low_modes(self, phi: Mapping[int, Floats], below: float) -> Floats:
        return self._system.low_modes(phi, below)

    def start(self, normal_displacement: Mapping[int, Floats]) -> Floats:
        return self._system.start(normal_displacement)

    def restrict(self, u: Floats) -> Floats:
        return self.dofs.restrict(u)

    def displacement(self, y: Floats) -> Floats:
        return self.dofs.displacement(y)

    def seen(self, y: Floats, operator: scipy.sparse.csr_matrix) -> Floats | None:
        return operator @ self.dofs.displacement(y)

    def fields(self, y: Floats, deformation: Floats) -> Fields:
        return self.dofs.fields(y, deformation, self._matrix)


def _sized(what: str, values: Floats, body: MeshlessBody) -> Floats:
    """`values` as an array (dofs,)."""
    array = np.asarray(values, dtype=float)
    if array.shape != (body.size,):
        raise ValueError(f"{what} of body {body.name!r}: shape {array.shape}; expected ({body.size},)")
    return array


def _finite(what: str, values: Floats, body: MeshlessBody) -> Floats:
    if not np.all(np.isfinite(values)):
        raise ValueError(f"{what} of body {body.name!r} = {values!r}: expected finite numbers")
    return values
