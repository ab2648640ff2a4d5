"""A body condensed once to the displacements that its contacts touch (Schur complement)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property

import numpy as np
import scipy
from mpi4py import MPI
from numpy.typing import NDArray

from ..base.arrays import Floats
from ..base.sparse import product_map, stacked
from .assembled import AssembledProblem
from .condensation import Condensation, MirroredCondensation, condense_by_elements, condense_sparse
from .copies import loaded_alike
from .problem import Shared, Solver, contact_traces
from .rigid import orthonormal, select_fixing_dofs


class CondensedProblem(AssembledProblem):
    """The same problem seen from the displacements that the contacts touch; the inside is eliminated once.

    The stiffness becomes the dense Schur complement S, a step costs one dense Cholesky factorisation of S + Φ, and
    the inside is recovered when the displacement is asked for.

    comm: the ranks that eliminate the inside together; all of them have made the same inner problem. others: problems
    whose factorisation is shared where it is the same, that of an identical body. original: the problem of a body that
    this one is a copy of, and the signs between them.
    """

    def __init__(
        self,
        inner: AssembledProblem,
        comm: MPI.Comm = MPI.COMM_SELF,
        others: Sequence[CondensedProblem] = (),
        original: tuple[CondensedProblem, Floats] | None = None,
    ) -> None:
        self.body, self.matrices, self.sides = inner.body, inner.matrices, inner.sides
        self.kept = _touched(inner)
        self._set_inner(inner)
        self.ports = contact_traces(self.sides, self.space, self.kept)
        if original is not None and np.array_equal(self.kept, original[0].kept):
            self._set_as_copy(*original)
            return
        self._inside = _eliminated(inner, self.kept, comm, [other._inside for other in others])
        self.stiffness = self._inside.complement
        self._keep_springs()
        self._set_loads()

    def _set_as_copy(self, original: CondensedProblem, signs: Floats) -> None:
        """What follows from the problem of a body that this one is a copy of."""
        turned = self._inner.mirrored(signs)
        self._inside: Condensation = MirroredCondensation(original._inside, turned, self.kept)
        kept = turned[self.kept]
        self.stiffness = kept[:, None] * original.stiffness * kept
        modes, (owner,) = original.rigid.modes, original.rigid.owners
        coefficients = self.body.kinematics.mirrored_modes(signs)[:, None] * owner.coefficients
        self.rigid = self._rigid_motions(kept[:, None] * modes, coefficients, np.zeros_like(modes))
        if loaded_alike(original.body, self.body):
            self.load, self.constant = kept * original.load, original.constant
        else:
            self._set_loads()

    def refreshed_for(self, inner: AssembledProblem) -> CondensedProblem:
        """The same condensed problem for `inner` with other loads and prescribed displacements."""
        other = copy(self)
        other._set_inner(inner)
        other.ports = [replace(port, offset=other.space.prescribed(port.side.trace)) for port in self.ports]
        other._set_loads()
        return other

    def _set_inner(self, inner: AssembledProblem) -> None:
        self._inner = inner
        self.space, self.full_load = inner.space, inner.full_load

    def _keep_springs(self) -> None:
        """Find the rigid motions, and take the rounding of the elimination out of the elastic forces that they meet.

        They must meet none but those of springs; else a floating body's forces balance only to the rounding of many
        thousand sums, and soft springs are lost in it.
        """
        modes, coefficients = self._inner.motions
        springs = self._inner.spring_forces
        if np.any(springs):
            springs = np.column_stack([self._inside.reduced(force)[0] for force in springs.T])
        else:
            springs = np.zeros((len(self.kept), springs.shape[1]))
        q, coefficients, springs = orthonormal(modes[self.kept], coefficients, springs)
        self.rigid = self._rigid_motions(q, coefficients, springs)
        wrong = q.T @ self.stiffness - springs.T
        self.stiffness = self.stiffness - q @ wrong - wrong.T @ q.T + q @ (wrong @ q) @ q.T

    def _set_loads(self) -> None:
        """The loads on the kept unknowns, their work on rigid motions to the last digit what it was on all of them."""
        inner = self._inner
        self.load, done = self._inside.reduced(inner.load)
        self.constant = inner.constant - 0.5 * done
        modes = inner.motions[0]
        if modes.shape[1] > 0:
            work = modes.T @ inner.load
            springs = inner.spring_forces
            if np.any(springs):
                inside = self._inside.extended(np.zeros(len(self.kept)), inner.load)
                work -= springs.T @ inside
            kept, q = modes[self.kept], self.rigid.modes
            self.load += q @ np.linalg.solve(kept.T @ q, work - kept.T @ self.load)

    def shared(self) -> Shared:
        """What other ranks need to know of the problem."""
        motions = self.rigid.modes, self.rigid.owners[0].coefficients, self.rigid.springs
        return self.kept, self.stiffness, self.load, self.constant, self.full_load, motions

    def displacement(self, y: Floats) -> Floats:
        return self._inner.displacement(self._inside.extended(y, self._inner.load))

    def _strained(self, deformation: Floats, springs: Floats | None = None) -> Floats:
        load = self._inner.load if springs is None else self._inner.load - springs
        return self._inner._strained(self._inside.extended(deformation, load))

    def seen(self, y: Floats, operator: scipy.sparse.csr_matrix) -> Floats | None:
        unknowns = np.full(self.space.size, np.nan)  # the inside is not known, nor is what depends on it
        unknowns[self.kept] = y
        seen = super().seen(unknowns, operator)
        return None if np.isnan(seen).any() else seen

    @cached_property
    def nodal_trace(self) -> scipy.sparse.csr_matrix:
        return self.space.columns(self._nodal)[:, self.kept]

    def restrict(self, u: Floats) -> Floats:
        return super().restrict(u)[self.kept]

    def start(self, normal_displacement: Mapping[int, Floats]) -> Floats:
        values = np.concatenate([normal_displacement[port.interface] - port.offset for port in self.ports])
        rows = stacked([port.trace for port in self.ports])
        if isinstance(rows, np.ndarray):
            return np.linalg.lstsq(rows, values, rcond=1e-12)[0]
        return scipy.sparse.linalg.lsqr(rows, values, atol=1e-15, btol=1e-15)[0]

    def low_modes(self, phi: Mapping[int, Floats], below: float) -> Floats:
        matrix = self._system(phi)
        ground = select_fixing_dofs(self.rigid.modes @ self.rigid.free(phi))
        matrix[ground, ground] += self.rigid.largest
        return scipy.linalg.eigh(self.stiffness, matrix, subset_by_value=(-np.inf, below))[1]

    @cached_property
    def _robin(self) -> list[tuple[NDArray[np.intp], scipy.sparse.csr_matrix]]:
        """Where the Robin terms stand in the matrix, and the operators from φ to their entries."""
        maps = [product_map(port.robin_trace, port.side.surface.weights) for port in self.ports]
        return [(places, (m @ port.side.transfer).tocsr()) for port, (places, m) in zip(self.ports, maps, strict=True)]

    def _system(self, phi: Mapping[int, Floats]) -> Floats:
        """S + Φ."""
        matrix = self.stiffness.copy()
        for port, (places, weights) in zip(self.ports, self._robin, strict=True):
            matrix.ravel()[places] += weights @ phi[port.interface]
        return matrix

    def _solver(self, phi: Mapping[int, Floats], ground: NDArray[np.intp]) -> Solver:
        if self.size == 0:  # supports hold all that the contacts touch, which LAPACK would refuse
            return np.copy
        matrix = self._system(phi)
        matrix[ground, ground] += self.rigid.largest
        factor, info = scipy.linalg.lapack.dpotrf(matrix.T, lower=True, clean=False, overwrite_a=True)
        if info != 0:
            raise np.linalg.LinAlgError(f"body {self.body.name!r}: S + Φ is not positive definite")
        return lambda forces: scipy.linalg.lapack.dpotrs(factor, forces, lower=True)[0]


def _touched(problem: AssembledProblem) -> NDArray[np.intp]:
    """The unknowns that a contact's normal displacements depend on and, where a body could still move rigidly with
    all of them held, every unknown of the same nodes: the inside must be a well-posed problem."""
    space = problem.space
    traces = {id(trace): trace for _, side in problem.sides for trace in (side.trace, side.surface.trace)}
    dofs = np.concatenate([trace.indices for trace in traces.values()])
    kept = space.unknowns_at(dofs)
    if _hold(problem.motions[0][kept]):
        return kept
    dim = problem.body.mesh.dim
    nodes = np.unique(dofs // dim)  # also those at which a support holds all that the contact would touch
    return space.unknowns_at((nodes[:, None] * dim + np.arange(dim)).ravel())


def _eliminated(
    problem: AssembledProblem, kept: NDArray[np.intp], comm: MPI.Comm, others: Sequence[Condensation]
) -> Condensation:
    """A body's inside eliminated: cell by cell first where many unknowns lie inside of alike cells."""
    matrices, space = problem.matrices, problem.space
    if comm.size == 1 and space.free is not None and not matrices.has_springs and matrices.cells is not None:
        return condense_by_elements(matrices.cells, space, kept, others)
    return condense_sparse(problem.stiffness, kept, comm, others)


def _hold(modes: Floats) -> bool:
    """Whether no combination of rigid modes vanishes at the given unknowns."""
    if modes.shape[1] <= 1:
        return bool(modes.any(axis=0).all())
    singular = np.linalg.svd(modes, compute_uv=False)
    return len(singular) == modes.shape[1] and singular[-1] > 1e-8 * singular[0]
