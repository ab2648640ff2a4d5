"""One body's linear problem (22) on its own: what a decomposed step solves, independently for every body.

A subproblem works with some vector of unknowns y of its body and hides which. `Subproblem` keeps every free
displacement and reassembles and refactors its matrix at each step, the plain reading of the method.
`CondensedSubproblem` keeps only the displacements that the contacts touch; the inside is eliminated once.
`RemoteSubproblem` is one whose inside another rank holds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy
from mpi4py import MPI
from numpy.typing import NDArray

from .admissible import AdmissibleSpace
from .body import Body
from .copies import loaded_alike
from .elimination import Elimination, Image, eliminate_cellwise, eliminate_whole
from .factor import Factor
from .forms import load_vector
from .interface import Interface, Side
from .matrices import Matrices
from .rigid import Owner, Resistance, RigidMotions, allowed_motions, orthonormal, pivots
from .support import admissible_space

if TYPE_CHECKING:
    from .admissible import Operator

Floats = NDArray[np.float64]
#: From forces (unknowns,) to the unknowns that they cause (unknowns,).
Solver = Callable[[Floats], Floats]
#: What other ranks need to know of a condensed problem: the kept unknowns, S, the load on them, the constant of the
#: energy, the load on all degrees of freedom, and the rigid motions with their coefficients and springs.
Shared = tuple[NDArray[np.intp], Floats, Floats, float, Floats, tuple[Floats, Floats, Floats]]


@dataclass(frozen=True)
class Port:
    """Where one interface meets the unknowns of a body.

    interface: its place in the scene; side: the body's side of it; trace (points, unknowns), offset (points,): u_n at
    its points is trace @ y + offset; robin_trace: u_n of the unknowns at the integration points of the body's own
    surface.
    """

    interface: int
    side: Side
    trace: Operator
    offset: Floats
    robin_trace: Operator


@dataclass(frozen=True)
class Fields:
    """A body's solution in all degrees of freedom.

    displacement: (dofs,); elastic_forces: (dofs,) a(u, ·), of the deformation only, see `start.State`; spring_forces:
    (dofs,) those of elastic foundations; elastic_energy: ½ a(u, u).
    """

    displacement: Floats
    elastic_forces: Floats
    spring_forces: Floats
    elastic_energy: float


class Subproblem:
    """a(ũ, v) + ∫ φ ũ_n v_n = l(v) + ∫ φ u_n v_n + ∫ g⁻ v_n of one body, in the unknowns y of u = Z y + u₀.

    original: the problem of a body that this one is a copy of, and the signs between them (`copies`).
    """

    def __init__(
        self,
        body: Body,
        place: int,
        interfaces: Sequence[Interface],
        original: tuple[Subproblem, Floats] | None = None,
    ) -> None:
        self.body = body
        self.sides = sides(place, interfaces)
        self._factor: Factor | None = None
        if original is not None:
            self._set_as_copy(*original)
            return
        self.space = admissible_space(body)
        self.matrices = Matrices(body, self.space)
        self.motions = allowed_motions(body.rigid_modes(), self.space)
        self._set_loads()

    def _set_as_copy(self, original: Subproblem, signs: Floats) -> None:
        """What follows from the problem of a body that this one is a copy of."""
        self.space = original.space
        self.matrices = Matrices(self.body, self.space)
        modes, coefficients = original.motions
        turned = self.mirrored(signs)
        self.motions = turned[:, None] * modes, self.body.kinematics.mirrored_modes(signs)[:, None] * coefficients
        if loaded_alike(original.body, self.body):
            self.full_load = np.tile(signs, len(original.full_load) // len(signs)) * original.full_load
            self.load, self.constant = turned * original.load, original.constant
        else:
            self._set_loads()

    def mirrored(self, signs: Floats) -> Floats:
        """By what the unknowns change (unknowns,) if the displacement's components change by `signs` (dim,)."""
        return signs[self.space.free % len(signs)]

    @cached_property
    def stiffness(self) -> Operator:
        """a(u, v) in the unknowns."""
        return self.matrices.reduced

    @cached_property
    def ports(self) -> list[Port]:
        """Where the interfaces meet the unknowns."""
        return [
            Port(
                index,
                side,
                self.space.columns(side.trace),
                self.space.prescribed(side.trace),
                self.space.columns(side.surface.trace),
            )
            for index, side in self.sides
        ]

    @cached_property
    def rigid(self) -> RigidMotions:
        """The rigid motions that the supports leave free."""
        return self._rigid_motions(*self.motions, self.spring_forces)

    @property
    def spring_forces(self) -> Floats:
        """The forces with which springs answer the rigid motions, (unknowns, motions)."""
        modes = self.motions[0]
        if not self.matrices.has_springs:
            return np.zeros_like(modes)
        return self.space.restricted(self.matrices.springs @ self.space.extended(modes))

    def refreshed(self) -> Subproblem:
        """The same problem for the present loads and prescribed displacements; all matrices are shared."""
        other = copy(self)
        other.space = replace(self.space, offset=admissible_space(self.body).offset)
        if "ports" in vars(self):
            other.ports = [replace(port, offset=other.space.prescribed(port.side.trace)) for port in self.ports]
        other._set_loads()
        return other

    def _set_loads(self) -> None:
        """What follows from the loads and prescribed displacements."""
        self.full_load = load_vector(self.body)
        offset = self.space.offset
        prescribed = self.matrices.forces(offset) if self.space.has_offset else np.zeros_like(offset)
        self.load = self.space.restricted(self.full_load - prescribed)
        self.constant = float(0.5 * offset @ prescribed - self.full_load @ offset)

    @cached_property
    def nodal_trace(self) -> scipy.sparse.csr_matrix:
        """u_n at the nodes of all contact surfaces from the unknowns, but for `nodal_offset`."""
        return self.space.columns(self._nodal)

    @property
    def nodal_offset(self) -> Floats:
        """u_n at the nodes of all contact surfaces of the prescribed displacements."""
        return self.space.prescribed(self._nodal)

    @cached_property
    def _nodal(self) -> scipy.sparse.csr_matrix:
        """u_n at the nodes of all contact surfaces, from all degrees of freedom."""
        return scipy.sparse.vstack([side.surface.nodal_trace for _, side in self.sides]).tocsr()

    @property
    def size(self) -> int:
        """The number of unknowns."""
        return len(self.load)

    def correct(self, phi: Mapping[int, Floats], residual: Floats, scale: float) -> Floats:
        """ũ − u of (22): the solution of a(δ, v) + ∫ φ δ_n v_n = residual.

        phi: the Robin coefficient at the points of each interface; scale: the size of the forces at work. Raises
        LooseBodyError where nothing holds the body.
        """
        ground = self.rigid.ground(phi, residual, scale)
        return self._solver(phi, ground)(residual)

    def held(self, phi: Mapping[int, Floats]) -> Solver:
        """(A + Φ)⁻¹, with any motion held that is free: the body's part of a preconditioner.

        All that depends on φ alone is done here, once for however many forces. To be used before the body is asked for
        a solve with another φ.
        """
        return self._solver(phi, pivots(self.rigid.modes @ self.rigid.free(phi)))

    def low_modes(self, phi: Mapping[int, Floats], below: float) -> Floats:
        """The modes of A v = λ (A + Φ) v with λ < below, (unknowns, modes): none where A is too large to ask."""
        return np.zeros((self.size, 0))

    def displacement(self, y: Floats) -> Floats:
        """All degrees of freedom of the displacement."""
        return self.space.extended(y) + self.space.offset

    def seen(self, y: Floats, operator: scipy.sparse.csr_matrix) -> Floats | None:
        """operator @ displacement(y) where the unknowns alone tell it, else None; operator: on all dofs."""
        return operator @ (self.space.extended(y) + self.space.offset)

    def fields(self, y: Floats, deformation: Floats) -> Fields:
        """What the solution tells of the body."""
        u, deformed = self.displacement(y), self.displacement(deformation)
        elastic = self.matrices.forces(deformed)
        return Fields(u, elastic, self.matrices.spring_forces(u), 0.5 * float(deformed @ elastic))

    def restrict(self, u: Floats) -> Floats:
        """The unknowns of the admissible displacement closest to u."""
        return self.space.restricted(u - self.space.offset)

    def start(self, normal_displacement: Mapping[int, Floats]) -> Floats:
        """Unknowns with (nearly) the given u_n at the points of each interface and the inside in equilibrium."""
        condensed = CondensedSubproblem(self)
        return self.restrict(condensed.displacement(condensed.start(normal_displacement)))

    def _solver(self, phi: Mapping[int, Floats], ground: NDArray[np.intp]) -> Solver:
        """(A + Φ)⁻¹ with these unknowns held, factored; an assembled body has room for one factor only."""
        values = self._system_values(phi)
        values[self._diagonal[ground]] += self.rigid.largest
        if self._factor is None:
            matrix = self.stiffness.copy()
            matrix.data = values
            self._factor = Factor(matrix)
        else:
            self._factor.update(values)
        return self._factor.solve

    @cached_property
    def _diagonal(self) -> NDArray[np.intp]:
        """Where the diagonal stands among the entries of the stiffness matrix."""
        return _places(self.stiffness, scipy.sparse.eye(self.size, format="csr"))

    def _system_values(self, phi: Mapping[int, Floats]) -> Floats:
        """The entries of A + Φ at the places of the stiffness matrix."""
        values = self.stiffness.data.copy()
        for port in self.ports:
            surface = port.side.surface
            term = surface.robin.matrix(surface.mean(port.side.transfer @ phi[port.interface]))
            term = self.space.within(term)
            values[_places(self.stiffness, term)] += term.data
        return values

    def _rigid_motions(self, modes: Floats, coefficients: Floats, springs: Floats) -> RigidMotions:
        """The rigid motions with these columns of unknowns, of coefficients and of forces of springs."""
        contacts = [
            Resistance(
                port.interface,
                np.sqrt(port.side.surface.weights)[:, None] * (port.robin_trace @ modes),
                port.side.transfer,
            )
            for port in self.ports
        ]
        owner = Owner(self.body.name, self.body.kinematics, coefficients)
        return RigidMotions(modes, springs, contacts, [owner], float(self.stiffness.diagonal().max(initial=0.0)))


class CondensedSubproblem(Subproblem):
    """The same problem seen from the displacements that the contacts touch; the inside is eliminated once.

    The stiffness becomes the dense Schur complement S, a step costs one dense Cholesky factorisation of S + Φ, and
    the inside is recovered when the displacement is asked for.

    comm: the ranks that eliminate the inside together; all of them have made the same inner problem. others: problems
    whose factorisation is shared where it is the same, that of an identical body. original: the problem of a body that
    this one is a copy of, and the signs between them.
    """

    def __init__(
        self,
        inner: Subproblem,
        comm: MPI.Comm = MPI.COMM_SELF,
        others: Sequence[CondensedSubproblem] = (),
        original: tuple[CondensedSubproblem, Floats] | None = None,
    ) -> None:
        self.body, self.matrices, self.sides = inner.body, inner.matrices, inner.sides
        self.kept = _touched(inner)
        self._set_inner(inner)
        self.ports = kept_ports(self.sides, self.space, self.kept)
        if original is not None and np.array_equal(self.kept, original[0].kept):
            self._set_as_copy(*original)
            return
        self._inside = _eliminated(inner, self.kept, comm, [other._inside for other in others])
        self.stiffness = self._inside.complement
        self._keep_springs()
        self._set_loads()

    def _set_as_copy(self, original: CondensedSubproblem, signs: Floats) -> None:
        """What follows from the problem of a body that this one is a copy of."""
        turned = self._inner.mirrored(signs)
        self._inside: Elimination = Image(original._inside, turned, self.kept)
        kept = turned[self.kept]
        self.stiffness = kept[:, None] * original.stiffness * kept
        modes, (owner,) = original.rigid.modes, original.rigid.owners
        coefficients = self.body.kinematics.mirrored_modes(signs)[:, None] * owner.coefficients
        self.rigid = self._rigid_motions(kept[:, None] * modes, coefficients, np.zeros_like(modes))
        if loaded_alike(original.body, self.body):
            self.load, self.constant = kept * original.load, original.constant
        else:
            self._set_loads()

    def refreshed_for(self, inner: Subproblem) -> CondensedSubproblem:
        """The same condensed problem for `inner` with other loads and prescribed displacements."""
        other = copy(self)
        other._set_inner(inner)
        other.ports = [replace(port, offset=other.space.prescribed(port.side.trace)) for port in self.ports]
        other._set_loads()
        return other

    def _set_inner(self, inner: Subproblem) -> None:
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
        ground = pivots(self.rigid.modes @ self.rigid.free(phi))
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


class RemoteSubproblem(CondensedSubproblem):
    """A body that another rank holds, seen from its contacts: all of the condensed problem but the inside."""

    def __init__(self, body: Body, place: int, interfaces: Sequence[Interface], shared: Shared) -> None:
        self.body = body
        self.space = admissible_space(body)
        self.kept, self.stiffness, self.load, self.constant, self.full_load, motions = shared
        self.sides = sides(place, interfaces)
        self.ports = kept_ports(self.sides, self.space, self.kept)
        self.rigid = self._rigid_motions(*motions)


def sides(place: int, interfaces: Sequence[Interface]) -> list[tuple[int, Side]]:
    """The sides of interfaces at which the body at a place of the scene lies, each with its interface's place."""
    return [
        (index, side) for index, interface in enumerate(interfaces) for side in interface.sides if side.body == place
    ]


def kept_ports(sides: Sequence[tuple[int, Side]], space: AdmissibleSpace, kept: NDArray[np.intp]) -> list[Port]:
    """Where the interfaces meet the kept unknowns."""
    some, found = space.columns_of(kept), []
    for index, side in sides:
        trace = some(side.trace)
        robin_trace = trace if side.surface.trace is side.trace else some(side.surface.trace)
        found.append(Port(index, side, trace, space.prescribed(side.trace), robin_trace))
    return found


def _touched(problem: Subproblem) -> NDArray[np.intp]:
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
    problem: Subproblem, kept: NDArray[np.intp], comm: MPI.Comm, others: Sequence[Elimination]
) -> Elimination:
    """A body's inside eliminated: cell by cell first where many unknowns lie inside of alike cells."""
    matrices, space = problem.matrices, problem.space
    if comm.size == 1 and space.free is not None and not matrices.has_springs and matrices.cells is not None:
        return eliminate_cellwise(matrices.cells, space, kept, others)
    return eliminate_whole(problem.stiffness, kept, comm, others)


def _hold(modes: Floats) -> bool:
    """Whether no combination of rigid modes vanishes at the given unknowns."""
    if modes.shape[1] <= 1:
        return bool(modes.any(axis=0).all())
    singular = np.linalg.svd(modes, compute_uv=False)
    return len(singular) == modes.shape[1] and singular[-1] > 1e-8 * singular[0]


def stacked(operators: Sequence[Operator]) -> Operator:
    """Operators one below the other, dense if they all are."""
    if all(isinstance(operator, np.ndarray) for operator in operators):
        return np.vstack(operators)
    return scipy.sparse.vstack([scipy.sparse.csr_matrix(operator) for operator in operators]).tocsr()


def product_map(trace: Operator, weights: Floats) -> tuple[NDArray[np.intp], scipy.sparse.csr_matrix]:
    """Where the entries of traceᵀ diag(weights φ) trace stand in the flattened matrix, and the operator from φ to them.

    For values that change in every step at places that never do.
    """
    trace = scipy.sparse.csr_matrix(trace)
    counts = np.diff(trace.indptr)
    point = np.repeat(np.arange(len(counts)), counts**2)
    start = np.repeat(trace.indptr[:-1], counts**2)
    local = np.arange(len(point)) - np.repeat(np.cumsum(counts**2) - counts**2, counts**2)
    i, j = start + local // counts[point], start + local % counts[point]
    places, entry = np.unique(trace.indices[i] * np.int64(trace.shape[1]) + trace.indices[j], return_inverse=True)
    values = trace.data[i] * trace.data[j] * weights[point]
    return places, scipy.sparse.csr_matrix((values, (entry, point)), shape=(len(places), len(counts)))


def _places(matrix: scipy.sparse.csr_matrix, term: scipy.sparse.csr_matrix) -> NDArray[np.intp]:
    """The positions in matrix.data of the entries of a matrix whose sparsity is contained in it."""
    matrix.sort_indices()
    term.sort_indices()

    def keys(m: scipy.sparse.csr_matrix) -> NDArray[np.int64]:
        return np.repeat(np.arange(m.shape[0], dtype=np.int64), np.diff(m.indptr)) * m.shape[1] + m.indices

    return np.searchsorted(keys(matrix), keys(term))
