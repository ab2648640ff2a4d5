"""A body assembled and factored anew in every step: the plain reading of the method, its Robin term in UFL."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import scipy

from ..base.arrays import Floats, Indices, Operator
from ..base.sparse import entry_positions
from ..interface.robin import RobinTerm
from .condensed import condensed_start
from .discrete import DiscreteBody
from .factor import Factor
from .problem import (
    ContactTrace,
    Fields,
    Solver,
    contact_traces,
    free_fixing_dofs,
    nodal_operator,
    refreshed_traces,
)
from .task import LocalTask


class AssembledProblem:
    """A + Φ in all free displacements, reassembled and refactored for every φ."""

    factor_free = False

    def __init__(self, task: LocalTask) -> None:
        self.name, self.length = task.body.name, task.body.mesh.size
        self.dofs = task.discrete
        self.matrix = self.dofs.stiffness.reduced
        self.stiffness: Operator = self.matrix
        self.traces: Sequence[ContactTrace] = contact_traces(task.sides, self.dofs.space)
        self.rigid = self.dofs.rigid_motions(self.traces)
        self._robin = _RobinSystem(self.dofs, self.matrix, self.traces)

    def refreshed(self, dofs: Any) -> AssembledProblem:
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
        fixed = self.rigid.fixing_dofs(phi, residual, scale)
        return self._robin.solver(phi, fixed, self.rigid.stiffness_scale)(residual)

    def robin_solver(self, phi: Mapping[int, Floats]) -> Solver:
        return self._robin.solver(phi, free_fixing_dofs(self.rigid, phi), self.rigid.stiffness_scale)

    def low_modes(self, phi: Mapping[int, Floats], below: float) -> Floats:
        return np.zeros((self.size, 0))

    def start(self, normal_displacement: Mapping[int, Floats]) -> Floats:
        return condensed_start(self.dofs, [(t.interface, t.side) for t in self.traces], normal_displacement)

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
    """The matrix A + Φ, whose sparsity never changes, and its one factorisation, refreshed for every φ."""

    dofs: DiscreteBody
    matrix: scipy.sparse.csr_matrix
    traces: Sequence[ContactTrace]
    _factor: Factor | None = field(default=None, init=False)

    def solver(self, phi: Mapping[int, Floats], fixed: Indices, stiffness_scale: float) -> Solver:
        """(A + Φ)⁻¹ with these unknowns fixed, factored; there is room for one factor only."""
        values = self._values(phi)
        values[self._diagonal[fixed]] += stiffness_scale
        if self._factor is None:
            matrix = self.matrix.copy()
            matrix.data = values
            self._factor = Factor(matrix)
        else:
            self._factor.update(values)
        return self._factor.solve

    def _values(self, phi: Mapping[int, Floats]) -> Floats:
        """The entries of A + Φ at the positions of the stiffness matrix."""
        values = self.matrix.data.copy()
        for trace, robin in zip(self.traces, self._robin_terms, strict=True):
            own = trace.side.surface.mean(trace.side.transfer @ phi[trace.interface])
            term = self.dofs.space.within(robin.matrix(own))
            values[entry_positions(self.matrix, term)] += term.data
        return values

    @cached_property
    def _robin_terms(self) -> list[RobinTerm]:
        """The Robin terms in UFL."""
        return [RobinTerm(trace.side.meshed) for trace in self.traces]

    @cached_property
    def _diagonal(self) -> Indices:
        """The positions of the diagonal among the entries of the stiffness matrix."""
        return entry_positions(self.matrix, scipy.sparse.eye(self.matrix.shape[0], format="csr"))
