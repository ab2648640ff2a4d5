"""A body without a mesh whose stiffness is diagonal in Fourier's basis: nothing is factored, no matrix is stored."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from typing import Any

import numpy as np
import scipy

from ..base.arrays import Floats
from ..base.sparse import stacked
from ..base.spectral import SpectralStiffness
from .meshless import MeshlessDofs
from .problem import Fields, Solver, contact_traces, nodal_operator, refreshed_traces
from .task import LocalTask

#: The relative accuracy of a body's own solve: below what the outer iterations ask for.
ACCURACY = 1e-12

#: Iterations after which a body's own solve has failed.
MOST = 2000


class SpectralProblem:
    """K + Φ of a surface on a periodic grid, by conjugate gradients and fast Fourier transforms."""

    factor_free = True

    def __init__(self, task: LocalTask, matrix: SpectralStiffness) -> None:
        body = task.body
        self.name, self.length = body.name, body.length
        self._matrix = matrix
        self.dofs = MeshlessDofs(body)
        space = self.dofs.space
        self.stiffness: Any = matrix if space.size == matrix.shape[0] else matrix.without_translation()
        if space.size != self.stiffness.shape[0]:
            raise ValueError(f"prescribed() of body {body.name!r}: expected the translation alone, if anything")
        self.traces = contact_traces(task.sides, space)
        self.rigid = self.dofs.rigid_motions(self.traces, self.stiffness.largest)

    def refreshed(self, dofs: Any) -> SpectralProblem:
        other = copy(self)
        other.dofs = self.dofs.refreshed()
        other.traces = refreshed_traces(self.traces, other.dofs.space)
        return other

    @property
    def load(self) -> Floats:
        return self.dofs.space.restricted(self.dofs.load)  # a prescribed translation meets no stiffness

    @property
    def constant(self) -> float:
        return -float(self.dofs.load @ self.dofs.space.offset)

    @property
    def size(self) -> int:
        return self.stiffness.shape[0]

    @property
    def nodal_trace(self) -> scipy.sparse.csr_matrix:
        return self.dofs.space.columns(nodal_operator(self.traces))

    @property
    def nodal_offset(self) -> Floats:
        return self.dofs.space.prescribed(nodal_operator(self.traces))

    def correct(self, phi: Mapping[int, Floats], residual: Floats, scale: float) -> Floats:
        held = np.zeros(self.size)
        held[self.rigid.fixing_dofs(phi, residual, scale)] = self.rigid.stiffness_scale
        terms = [(trace.robin_trace, trace.surface_stiffness(phi)) for trace in self.traces]

        def apply(y: Floats) -> Floats:
            return self.stiffness @ y + held * y + sum(trace.T @ (w * (trace @ y)) for trace, w in terms)

        shape = self.stiffness.shape
        solution, failed = scipy.sparse.linalg.cg(
            scipy.sparse.linalg.LinearOperator(shape, apply, dtype=float),
            residual,
            rtol=ACCURACY,
            maxiter=MOST,
            M=scipy.sparse.linalg.LinearOperator(shape, self.robin_solver(phi), dtype=float),
        )
        if failed:
            raise np.linalg.LinAlgError(f"body {self.name!r}: the iterations of its own problem do not converge")
        return solution

    def robin_solver(self, phi: Mapping[int, Floats]) -> Solver:
        """The inverse for an even coefficient, the mean of φ in series with the body's shortest waves.

        Symmetric and linear, as a preconditioner has to be. Beyond their stiffness it does not matter how large φ is,
        which without a bound may be at a few points only.
        """
        phi_areas = np.concatenate([trace.surface_stiffness(phi) for trace in self.traces])
        largest, tiny = self.stiffness.largest, np.finfo(float).eps * self.stiffness.largest
        places = self.size - int(self.stiffness.translation)
        even = float(np.sum(phi_areas * largest / (phi_areas + largest))) / places
        return lambda y: self.stiffness.shifted_inverse(y, max(even, tiny), max(float(phi_areas.sum()), tiny))

    def low_modes(self, phi: Mapping[int, Floats], below: float) -> Floats:
        return np.zeros((self.size, 0))

    def start(self, normal_displacement: Mapping[int, Floats]) -> Floats:
        values = np.concatenate([normal_displacement[trace.interface] - trace.offset for trace in self.traces])
        rows = stacked([trace.trace for trace in self.traces])
        return scipy.sparse.linalg.lsqr(rows, values, atol=1e-12, btol=1e-12)[0]

    def restrict(self, u: Floats) -> Floats:
        return self.dofs.restrict(u)

    def displacement(self, y: Floats) -> Floats:
        return self.dofs.displacement(y)

    def seen(self, y: Floats, operator: scipy.sparse.csr_matrix) -> Floats | None:
        return operator @ self.dofs.displacement(y)

    def fields(self, y: Floats, deformation: Floats) -> Fields:
        return self.dofs.fields(y, deformation, self._matrix)
