"""One body's linear problem (22) on its own: what a decomposed step solves, independently for every body.

A subproblem works with some vector of unknowns y of its body and hides which. `Subproblem` keeps every free
displacement and reassembles and refactors its matrix at each step, the plain reading of the method.
`CondensedSubproblem` keeps only the displacements that the contacts touch; the inside is eliminated once.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import ufl
from dolfinx import fem
from numpy.typing import NDArray
from scipy.linalg import lapack

from . import compat
from .body import Body
from .errors import LooseBodyError
from .factor import Factor
from .interface import Interface, Side
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
        self.rigid_modes, self._mode_names = self._free_rigid_modes()
        self._set_up_stability()
        self._factor: Factor | None = None

    @property
    def size(self) -> int:
        """The number of unknowns."""
        return len(self.load)

    def energy(self, y: Floats) -> float:
        """½ a(u, u) − l(u)."""
        return float(0.5 * y @ (self.stiffness @ y) - self.load @ y) + self.constant

    def residual(self, y: Floats, tractions: Mapping[int, Floats]) -> Floats:
        """−F₁'(u; ·): loads and contact forces (weighted tractions g⁻ by interface) less the elastic forces."""
        forces = self.load - self.stiffness @ y
        for port in self.ports:
            forces += port.trace.T @ tractions[port.interface]
        return forces

    def correct(self, phi: Mapping[int, Floats], residual: Floats) -> Floats:
        """ũ − u of (22): the solution of a(δ, v) + ∫ φ δ_n v_n = residual.

        phi: the Robin coefficient at the points of each interface. Raises LooseBodyError where nothing holds the body.
        """
        self.check_held(phi)
        return self._solve(phi, residual)

    def check_held(self, phi: Mapping[int, Floats]) -> None:
        """Raise LooseBodyError if supports and Robin terms leave a rigid motion of the body free."""
        motion = self.free_motion(phi)
        if motion is not None:
            raise LooseBodyError(self.body.name, motion)

    def free_motion(self, phi: Mapping[int, Floats]) -> str | None:
        """The rigid motion that nothing resists, in words, or None."""
        count = self.rigid_modes.shape[1]
        if count == 0:
            return None
        held = self._mode_stiffness.copy()
        for port, modes in zip(self.ports, self._port_modes, strict=True):
            held += np.einsum("pi,p,pj->ij", modes, port.side.transfer @ phi[port.interface], modes, optimize=False)
        values, vectors = (held[0], np.ones((1, 1))) if count == 1 else np.linalg.eigh(held)
        # Below this the Robin term is lost in the rounding of the stiffness.
        if values[0] > 1e-14 * self._largest_stiffness:
            return None
        return self.body.kinematics.describe(self._mode_names @ vectors[:, 0])

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

    def _solve(self, phi: Mapping[int, Floats], residual: Floats) -> Floats:
        values = self._system_values(phi)
        if self._factor is None:
            matrix = self.stiffness.copy()
            matrix.data = values
            self._factor = Factor(matrix)
        else:
            self._factor.update(values)
        return self._factor.solve(residual)

    def _system_values(self, phi: Mapping[int, Floats]) -> Floats:
        """The entries of A + Φ at the places of the stiffness matrix."""
        values = self.stiffness.data.copy()
        for port in self.ports:
            surface = port.side.surface
            term = surface.robin.matrix(surface.average @ (port.side.transfer @ phi[port.interface]))
            term = (self.basis.T @ term @ self.basis).tocsr()
            values[_places(self.stiffness, term)] += term.data
        return values

    def _free_rigid_modes(self) -> tuple[Floats, Floats]:
        """The rigid motions that the supports allow: orthonormal in the unknowns, and their coefficients."""
        body = self.body
        modes = body.kinematics.rigid_modes(body.space.tabulate_dof_coordinates())
        modes = modes.reshape(-1, modes.shape[-1])
        allowed = self.basis.T @ modes
        left_over = modes - self.basis @ allowed
        _, singular, right = np.linalg.svd(left_over, full_matrices=False)
        free = right[singular <= 1e-8 * np.linalg.norm(modes)].T
        if free.shape[1] == 0:
            return np.zeros((self.size, 0)), free
        orthonormal, triangle = np.linalg.qr(allowed @ free)
        return orthonormal, free @ np.linalg.inv(triangle)

    def _set_up_stability(self) -> None:
        modes = self.rigid_modes
        self._mode_stiffness = modes.T @ (self.stiffness @ modes)
        self._largest_stiffness = float(self.stiffness.diagonal().max(initial=0.0))
        # The elastic energy of a rigid motion is zero but for rounding; what a spring adds is not.
        self._mode_stiffness[np.abs(self._mode_stiffness) < 1e-10 * self._largest_stiffness] = 0.0
        self._port_modes = [
            np.sqrt(port.side.surface.weights)[:, None] * (port.robin_trace @ modes) for port in self.ports
        ]


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
        orthonormal, triangle = np.linalg.qr(inner.rigid_modes[self.kept])
        self.rigid_modes, self._mode_names = orthonormal, inner._mode_names @ np.linalg.inv(triangle)
        self._set_up_stability()
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

    def _solve(self, phi: Mapping[int, Floats], residual: Floats) -> Floats:
        matrix = self.stiffness.copy()
        for port, (places, weights) in zip(self.ports, self._robin, strict=True):
            matrix.ravel()[places] += weights @ phi[port.interface]
        _, solution, info = lapack.dposv(matrix, residual, overwrite_a=True)
        if info != 0:
            raise LooseBodyError(self.body.name, "some motion")
        return solution

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
    kept = np.unique(np.concatenate([port.robin_trace.indices for port in problem.ports]))
    if _hold(problem.rigid_modes[kept]):
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
