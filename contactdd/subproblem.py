"""One body's linear problem (22) on its own: what a decomposed step solves, independently for every body.

A subproblem works with some vector of unknowns y of its body and hides which. `Subproblem` keeps every free
displacement and reassembles and refactors its matrix at each step, the plain reading of the method.
`CondensedSubproblem` keeps only the displacements that the contacts touch; the inside is eliminated once.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg
import scipy.sparse as sp
import ufl
from dolfinx import fem
from numpy.typing import NDArray
from scipy.linalg import lapack

from . import compat
from .body import Body
from .factor import Factor
from .interface import Interface, Side
from .rigid import Owner, Resistance, RigidMotions, allowed_motions, orthonormal, pivots, spring_stiffness
from .support import affine_space

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Port:
    """Where one interface meets the unknowns of a body.

    interface: its place in the scene; trace, offset: u_n at its points is trace @ y + offset; robin_trace: u_n of
    the unknowns at the integration points of the body's own surface.
    """

    interface: int
    side: Side
    trace: sp.csr_matrix
    offset: Floats
    robin_trace: sp.csr_matrix


class Subproblem:
    """a(ũ, v) + ∫ φ ũ_n v_n = l(v) + ∫ φ u_n v_n + ∫ g⁻ v_n of one body, in the unknowns y of u = Z y + u₀."""

    def __init__(self, body: Body, place: int, interfaces: Sequence[Interface]) -> None:
        self.body = body
        self.basis, self.fixed = affine_space(body)
        u, v = ufl.TrialFunction(body.space), ufl.TestFunction(body.space)
        full = fem.assemble_matrix(compat.form(body.elastic_form(u, v))).to_scipy().tocsr()
        load = body.load_form(v)
        self.full_stiffness = full
        self.full_load = np.zeros(full.shape[0]) if load is None else fem.assemble_vector(compat.form(load)).array
        self.stiffness = (self.basis.T @ full @ self.basis).tocsr()
        self.load = self.basis.T @ (self.full_load - full @ self.fixed)
        self.constant = 0.5 * self.fixed @ (full @ self.fixed) - self.full_load @ self.fixed
        self.ports = [
            Port(
                index,
                side,
                (side.trace @ self.basis).tocsr(),
                side.trace @ self.fixed,
                (side.surface.trace @ self.basis).tocsr(),
            )
            for index, interface in enumerate(interfaces)
            for side in interface.sides
            if side.body == place
        ]
        nodal = sp.vstack([port.side.surface.nodal_trace for port in self.ports]).tocsr()
        self.nodal_trace, self.nodal_offset = (nodal @ self.basis).tocsr(), nodal @ self.fixed
        modes = body.kinematics.rigid_modes(body.space.tabulate_dof_coordinates())
        self.rigid = self._rigid_motions(*allowed_motions(modes.reshape(-1, modes.shape[-1]), self.basis))
        self._factor: Factor | None = None

    @property
    def size(self) -> int:
        """The number of unknowns."""
        return len(self.load)

    def deformation(self, y: Floats) -> Floats:
        """The unknowns without the rigid motion of a floating body: what elastic forces come from."""
        return y - self.rigid.modes @ (self.rigid.modes.T @ y) if self.rigid.floating else y

    def energy(self, y: Floats, deformation: Floats) -> float:
        """½ a(u, u) − l(u)."""
        return float(0.5 * deformation @ (self.stiffness @ deformation) - self.load @ y) + self.constant

    def residual(self, deformation: Floats, tractions: Mapping[int, Floats]) -> Floats:
        """−F₁'(u; ·): loads and contact forces (weighted tractions g⁻ by interface) less the elastic forces."""
        forces = self.load - self.stiffness @ deformation
        for port in self.ports:
            forces += port.trace.T @ tractions[port.interface]
        return forces

    def correct(self, phi: Mapping[int, Floats], residual: Floats, scale: float) -> Floats:
        """ũ − u of (22): the solution of a(δ, v) + ∫ φ δ_n v_n = residual.

        phi: the Robin coefficient at the points of each interface; scale: the size of the forces at work. Raises
        LooseBodyError where nothing holds the body.
        """
        ground = self.rigid.ground(phi, residual, scale)
        return self._solve(phi, residual, ground)

    def solve_held(self, phi: Mapping[int, Floats], forces: Floats) -> Floats:
        """(A + Φ)⁻¹ times forces, with any motion held that is free: the body's part of a preconditioner."""
        return self._solve(phi, forces, pivots(self.rigid.modes @ self.rigid.free(phi)))

    def low_modes(self, phi: Mapping[int, Floats], below: float) -> Floats:
        """The modes of A v = λ (A + Φ) v with λ < below, (unknowns, modes): none where A is too large to ask."""
        return np.zeros((self.size, 0))

    def displacement(self, y: Floats) -> Floats:
        """All degrees of freedom of the displacement."""
        return self.basis @ y + self.fixed

    def restrict(self, u: Floats) -> Floats:
        """The unknowns of the admissible displacement closest to u."""
        return self.basis.T @ (u - self.fixed)

    def start(self, normal_displacement: Mapping[int, Floats]) -> Floats:
        """Unknowns with (nearly) the given u_n at the points of each interface and the inside in equilibrium."""
        condensed = CondensedSubproblem(self)
        return self.restrict(condensed.displacement(condensed.start(normal_displacement)))

    def _solve(self, phi: Mapping[int, Floats], residual: Floats, ground: NDArray[np.intp]) -> Floats:
        values = self._system_values(phi)
        values[self._diagonal[ground]] += self.rigid.largest
        if self._factor is None:
            matrix = self.stiffness.copy()
            matrix.data = values
            self._factor = Factor(matrix)
        else:
            self._factor.update(values)
        return self._factor.solve(residual)

    @cached_property
    def _diagonal(self) -> NDArray[np.intp]:
        """Where the diagonal stands among the entries of the stiffness matrix."""
        return _places(self.stiffness, sp.eye(self.size, format="csr"))

    def _system_values(self, phi: Mapping[int, Floats]) -> Floats:
        """The entries of A + Φ at the places of the stiffness matrix."""
        values = self.stiffness.data.copy()
        for port in self.ports:
            surface = port.side.surface
            term = surface.robin.matrix(surface.average @ (port.side.transfer @ phi[port.interface]))
            term = (self.basis.T @ term @ self.basis).tocsr()
            values[_places(self.stiffness, term)] += term.data
        return values

    def _rigid_motions(self, modes: Floats, coefficients: Floats) -> RigidMotions:
        contacts = [
            Resistance(
                port.interface,
                np.sqrt(port.side.surface.weights)[:, None] * (port.robin_trace @ modes),
                port.side.transfer,
            )
            for port in self.ports
        ]
        owner = Owner(self.body.name, self.body.kinematics, coefficients)
        return RigidMotions(modes, *spring_stiffness(modes, self.stiffness), contacts, [owner])


class CondensedSubproblem(Subproblem):
    """The same problem seen from the displacements that the contacts touch; the inside is eliminated once.

    The stiffness becomes the dense Schur complement S, a step costs one dense Cholesky factorisation of S + Φ, and
    the inside is recovered when the displacement is asked for.
    """

    def __init__(self, inner: Subproblem) -> None:
        self.body, self.basis, self.fixed = inner.body, inner.basis, inner.fixed
        self.full_stiffness, self.full_load, self.constant = inner.full_stiffness, inner.full_load, inner.constant
        self._inner = inner
        self.kept = _touched(inner)
        self.eliminated = np.setdiff1d(np.arange(inner.size), self.kept)
        self._inside = Factor(inner.stiffness, schur=self.kept)
        self.stiffness = self._inside.complement
        inside = self._solve_inside(np.zeros(len(self.kept)))
        self.load = (inner.load - inner.stiffness @ inside)[self.kept]
        self.constant += float(0.5 * inside @ (inner.stiffness @ inside) - inner.load @ inside)
        self.ports = [
            Port(p.interface, p.side, p.trace[:, self.kept], p.offset, p.robin_trace[:, self.kept]) for p in inner.ports
        ]
        self.nodal_trace, self.nodal_offset = inner.nodal_trace[:, self.kept], inner.nodal_offset
        motions = orthonormal(inner.rigid.modes[self.kept], inner.rigid.owners[0].coefficients)
        self._balance(motions[0], inner.rigid.modes.T @ inner.load, inner.rigid.modes[self.kept])
        self.rigid = self._rigid_motions(*motions)
        self._robin = [_robin_map(port) for port in self.ports]

    def displacement(self, y: Floats) -> Floats:
        return self._inner.displacement(self._solve_inside(y))

    def restrict(self, u: Floats) -> Floats:
        return self._inner.restrict(u)[self.kept]

    def start(self, normal_displacement: Mapping[int, Floats]) -> Floats:
        rows, values = [], []
        for port in self.ports:
            rows.append(port.trace)
            values.append(normal_displacement[port.interface] - port.offset)
        return sp.linalg.lsqr(sp.vstack(rows), np.concatenate(values), atol=1e-15, btol=1e-15)[0]

    def low_modes(self, phi: Mapping[int, Floats], below: float) -> Floats:
        matrix = self._system(phi)
        ground = pivots(self.rigid.modes @ self.rigid.free(phi))
        matrix[ground, ground] += self.rigid.largest
        return scipy.linalg.eigh(self.stiffness, matrix, subset_by_value=(-np.inf, below))[1]

    def _system(self, phi: Mapping[int, Floats]) -> Floats:
        """S + Φ."""
        matrix = self.stiffness.copy()
        for port, (places, weights) in zip(self.ports, self._robin, strict=True):
            matrix.ravel()[places] += weights @ phi[port.interface]
        return matrix

    def _solve(self, phi: Mapping[int, Floats], residual: Floats, ground: NDArray[np.intp]) -> Floats:
        matrix = self._system(phi)
        matrix[ground, ground] += self.rigid.largest
        _, solution, info = lapack.dposv(matrix, residual, overwrite_a=True)
        if info != 0:
            raise np.linalg.LinAlgError(f"body {self.body.name!r}: S + Φ is not positive definite")
        return solution

    def _balance(self, motions: Floats, work: Floats, modes: Floats) -> None:
        """Take the rounding of the elimination out of what the free rigid motions feel.

        They must meet no elastic force, and the loads must do the work on them (motions,) that they did before; else
        a floating body's forces balance only to the rounding of many thousand sums.
        """
        springs = motions.T @ self.stiffness @ motions
        if motions.shape[1] == 0 or np.abs(springs).max() > 1e-10 * self.stiffness.diagonal().max():
            return
        felt = motions.T @ self.stiffness
        self.stiffness = self.stiffness - motions @ felt - felt.T @ motions.T + motions @ (felt @ motions) @ motions.T
        self.load += np.linalg.lstsq(modes.T, work - modes.T @ self.load, rcond=None)[0]

    def _solve_inside(self, kept: Floats) -> Floats:
        """All unknowns of the inner problem: the given kept ones, the others in equilibrium with them."""
        y = np.zeros(self._inner.size)
        y[self.kept] = kept
        rhs = self._inner.load - self._inner.stiffness @ y
        rhs[self.kept] = 0.0
        y[self.eliminated] = self._inside.solve(rhs)[self.eliminated]
        return y


def _touched(problem: Subproblem) -> NDArray[np.intp]:
    """The unknowns that a contact's normal displacements depend on and, where a body could still move rigidly with
    all of them held, every unknown of the same nodes: the inside must be a well-posed problem."""
    kept = np.unique(np.concatenate([t.indices for port in problem.ports for t in (port.trace, port.robin_trace)]))
    if _hold(problem.rigid.modes[kept]):
        return kept
    dim = problem.body.mesh.dim
    selection = problem.basis[:, kept]
    nodes = np.unique(selection.indices if selection.format == "csc" else selection.nonzero()[0]) // dim
    dofs = (nodes[:, None] * dim + np.arange(dim)).ravel()
    return np.unique(problem.basis[dofs].indices)


def _hold(modes: Floats) -> bool:
    """Whether no combination of rigid modes vanishes at the given unknowns."""
    if modes.shape[1] == 0:
        return True
    singular = np.linalg.svd(modes, compute_uv=False)
    return len(singular) == modes.shape[1] and singular[-1] > 1e-8 * singular[0]


def _robin_map(port: Port) -> tuple[NDArray[np.intp], sp.csr_matrix]:
    """Where in the flattened matrix the Robin term stands, and the operator from φ to its entries there."""
    trace = port.robin_trace.tocsr()
    counts = np.diff(trace.indptr)
    point = np.repeat(np.arange(len(counts)), counts**2)
    start = np.repeat(trace.indptr[:-1], counts**2)
    local = np.arange(len(point)) - np.repeat(np.cumsum(counts**2) - counts**2, counts**2)
    i, j = start + local // counts[point], start + local % counts[point]
    places, entry = np.unique(trace.indices[i] * np.int64(trace.shape[1]) + trace.indices[j], return_inverse=True)
    values = trace.data[i] * trace.data[j] * port.side.surface.weights[point]
    weights = sp.csr_matrix((values, (entry, point)), shape=(len(places), len(counts)))
    return places, (weights @ port.side.transfer).tocsr()


def _places(matrix: sp.csr_matrix, term: sp.csr_matrix) -> NDArray[np.intp]:
    """The positions in matrix.data of the entries of a matrix whose sparsity is contained in it."""
    matrix.sort_indices()
    term.sort_indices()

    def keys(m: sp.csr_matrix) -> NDArray[np.int64]:
        return np.repeat(np.arange(m.shape[0], dtype=np.int64), np.diff(m.indptr)) * m.shape[1] + m.indices

    return np.searchsorted(keys(matrix), keys(term))
