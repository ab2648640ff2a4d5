"""All bodies of a scene as one: a single vector y of unknowns, the energy F₁ (13) and the forces −F₁' that it gives."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from ..base.arrays import Floats, Operator, norm, slices
from ..base.ranks import Ranks
from ..base.sparse import along_diagonal
from ..base.spectral import SpectralStiffness
from ..interface.discretise import Interface
from ..layer import Layer
from ..local.problem import ContactTrace, LocalProblem
from ..local.remote import load_sizes
from ..local.rigid import RigidMotions
from ..local.stiffness import SelectedStiffness
from .block_diagonal import BlockDiagonal, OwnedBlocks
from .joint_motions import ManyMotions, joint_motions
from .state import State

#: Unknowns up to which matrices of all bodies are dense: one product, or one Cholesky factorisation, beats many of the
#: bodies' blocks.
LARGEST_DENSE = 600


#: Products, points times unknowns squared, up to which the contacts' term is a product of full matrices in any case.
LARGEST_PRODUCT = 4_000_000


#: Cost of one entry of the map that is made instead where rows have few entries, in units of such products: finding its
#: position takes 40 ns, a product 0.03 ns in about eight steps. Measured numbers of products per entry: above 900 for
#: stacks of plane bodies, below 40 for solids of degree 1 to 5.
PRODUCTS_PER_ENTRY = 150


#: The part of the loads of eigenstrains that counts among the forces at work: they balance themselves, and may be far
#: larger than what presses contacts together; but nothing comes closer than their rounding.
STRAINING = 1e-3


#: Entries up to which the map may take more memory than the full matrix, some hundred bytes each: tens of MB.
LARGEST_MAP = 500_000


@dataclass(frozen=True)
class Forces:
    """The forces at an iterate.

    tractions: (points,) g⁻(z) times the areas; elastic: (unknowns,) A y; residual: (unknowns,) −F₁',
    loads and contact forces less the elastic ones; size: √(‖loads‖² + ‖contact forces‖²).
    """

    tractions: Floats
    elastic: Floats
    residual: Floats
    size: float


class Ensemble:
    """The bodies' problems and the contacts between them, in the unknowns y of all bodies one after another.

    parts: the slice of each body's unknowns in y; points: the slice of each interface's points among all of them;
    weights: (points,) areas; size: the number of unknowns; load: (unknowns,), load_size its norm; dense: True on one
    rank if every body's stiffness is dense and the total is at most LARGEST_DENSE; stiffness: of all bodies, dense
    then, on several ranks each body's where it is held; normal_approach: (points, unknowns) the operator from y to
    u_αn + u_βn, dense then where its products are cheap.
    """

    def __init__(
        self, problems: Sequence[LocalProblem], interfaces: Sequence[Interface], ranks: Ranks | None = None
    ) -> None:
        self.problems, self.interfaces = problems, interfaces
        self._apart = None if ranks is None or ranks.alone else ranks
        self.parts = slices(problem.size for problem in problems)
        self.points = slices(len(interface.weights) for interface in interfaces)
        self.size = self.parts[-1].stop
        self.weights = np.concatenate([interface.weights for interface in interfaces])
        self.load = np.concatenate([problem.load for problem in problems])
        sizes = np.array([load_sizes(problem.dofs) for problem in problems])
        self.load_size, self._acting_size, self._straining_size = np.sqrt((sizes**2).sum(axis=0)).tolist()
        small = self._apart is None and self.size <= LARGEST_DENSE
        self.dense = small and all(isinstance(p.stiffness, np.ndarray) for p in problems)
        self.stiffness = self._stiffness()
        self.normal_approach = self._normal_approach()
        self._onto_unknowns = self.normal_approach.T
        self._initial_gaps = self._undeformed_gaps()
        motions = [p.rigid for p in problems]
        self._moves = any(each.modes.shape[1] for each in motions)
        self._motions = self._along_diagonal([each.modes for each in motions])
        self._onto_motions = self._motions.T
        self._sprung = any(np.any(each.springs) for each in motions)
        self._springs: Any = self._along_diagonal([each.springs for each in motions]) if self._sprung else None
        self._constant = sum(problem.constant for problem in problems)

    def _stiffness(self) -> Operator | BlockDiagonal | OwnedBlocks:
        """The stiffness of all bodies."""
        if self._apart is None:
            return self._along_diagonal([problem.stiffness for problem in self.problems])
        return OwnedBlocks(self._apart, self._block, self.parts)

    def _block(self, body_index: int) -> Operator:
        """The stiffness of a body that this rank holds."""
        return self.problems[body_index].stiffness

    def stiffness_matrix(self) -> scipy.sparse.csr_matrix:
        """The stiffness of all bodies as one sparse matrix, on every rank."""
        bodies = range(len(self.problems))
        each = [self._matrix(body) for body in bodies] if self._apart is None else self._apart.each(self._matrix)
        return BlockDiagonal(each).tocsr()

    def _matrix(self, body_index: int) -> Operator:
        """The stiffness of a body that this rank holds, as a matrix."""
        stiffness: Any = self._block(body_index)
        if isinstance(stiffness, SpectralStiffness):
            return stiffness.toarray()
        return stiffness.matrix if isinstance(stiffness, SelectedStiffness) else stiffness

    @cached_property
    def rigid(self) -> RigidMotions | ManyMotions:
        """The free rigid motions of all bodies together."""
        modes = BlockDiagonal([problem.rigid.modes for problem in self.problems])
        return joint_motions(self.problems, self.by_interface(self.weights), modes)

    def split(self, y: Floats) -> list[Floats]:
        """Every body's part of y."""
        return [y[part] for part in self.parts]

    def by_interface(self, values: Floats) -> list[Floats]:
        """Every interface's part of values at all points."""
        return [values[part] for part in self.points]

    def gaps(self, y: Floats) -> list[Floats]:
        """The deformed gaps z = d − u_αn − u_βn at the points of every interface."""
        return self.by_interface(self._initial_gaps - self.normal_approach @ y)

    def shifted(self, shifts: Sequence[Floats]) -> Ensemble:
        """The same bodies with gaps reduced by lengths (points,) for every interface; everything else is shared."""
        other = copy(self)
        other._initial_gaps = self._undeformed_gaps() - np.concatenate(shifts)
        return other

    def deformation(self, y: Floats) -> Floats:
        """y without the bodies' free rigid motions, from which stresses follow."""
        return y - self._motions @ (self._onto_motions @ y) if self._moves else y

    def elastic_forces(self, y: Floats, deformation: Floats) -> Floats:
        """The elastic forces A y: of the deformation, and of springs; (unknowns,) or (unknowns, n)."""
        forces = self.stiffness @ deformation
        return forces + self._springs @ (self._onto_motions @ y) if self._sprung else forces

    def elastic_work(self, y: Floats, deformation: Floats, forces: Floats) -> float:
        """A(y, y), forces: A y. Stresses do no work on a rigid motion, whatever their rounding would do."""
        work = float(deformation @ forces)
        return work + float((self._onto_motions @ y) @ (self._springs.T @ y)) if self._sprung else work

    def forces(self, state: State) -> Forces:
        """The forces at an iterate: −F₁' and its parts."""
        tractions = self.tractions(state)
        contact = self._onto_unknowns @ tractions
        elastic = self.elastic_forces(state.unknowns, state.deformation)
        return Forces(tractions, elastic, self.load + contact - elastic, self.at_work(norm(contact)))

    def at_work(self, contact: float) -> float:
        """The size of the forces at work, √(‖loads‖² + ‖contact forces‖²) on what is not prescribed.

        Eigenstrains are no such loads, but for the part `STRAINING`. Where there is nothing: the size of the forces
        that prescribed displacements cause. contact: ‖contact forces‖.
        """
        size = max(math.hypot(self._acting_size, contact), STRAINING * self._straining_size)
        return norm(self.load) if size == 0.0 else size

    def tractions(self, state: State) -> Floats:
        """The contact stresses g⁻(z) times the areas, at all points."""
        return self.weights * self.by_law(lambda law, z: law.contact_stress(z), joined(state.gaps))

    def energy(self, state: State, elastic: Floats | None = None) -> float:
        """F₁ = ½ A(u, u) − L(u) + J(u), eq. (13); elastic: the elastic forces, where they are known."""
        y, deformation = state.unknowns, state.deformation
        forces = self.elastic_forces(y, deformation) if elastic is None else elastic
        bodies = 0.5 * self.elastic_work(y, deformation, forces) - float(self.load @ y) + self._constant
        return bodies + self.layer_energy(state)

    def layer_energy(self, state: State) -> float:
        """J = Σ ∫ ∫₀^z g⁻."""
        return float(self.weights @ self.by_law(lambda law, z: law.energy(z), joined(state.gaps)))

    def by_law(self, function: Callable[..., Floats], *values: Floats) -> Floats:
        """function(law, values) at all points, of values (points,) there; it has to treat the points alike."""
        if len(self.laws) == 1:
            return function(self.laws[0][0], *values)
        return np.concatenate([function(law, *(each[part] for each in values)) for law, part in self.laws])

    @cached_property
    def laws(self) -> list[tuple[Layer, slice]]:
        """The layers' laws, and the points at which each holds: contacts of the same law in a row are taken as one."""
        found: list[tuple[Layer, slice]] = []
        for interface, part in zip(self.interfaces, self.points, strict=True):
            if found and found[-1][0] is interface.layer:
                part = slice(found.pop()[1].start, part.stop)
            found.append((interface.layer, part))
        return found

    def tangent(self, phi: Mapping[int, Floats], y: Floats) -> Floats:
        """A y + Σ ∫ φ [y_αn + y_βn][v_αn + v_βn], the coupled system of (17), (26), (27) times y.

        phi: the coefficient at the points of each interface; y: (unknowns,) or (unknowns, n).
        """
        return self.elastic_forces(y, self.deformation(y)) + self.contact_forces(phi, y)

    def contact_forces(self, phi: Mapping[int, Floats], y: Any) -> Any:
        """The contacts' part of `tangent`; y may be sparse."""
        approach, stiffness = self.normal_approach @ y, self.weights * self.at_all_points(phi)
        if scipy.sparse.issparse(approach):
            return self._onto_unknowns @ (scipy.sparse.diags(stiffness) @ approach)
        return self._onto_unknowns @ (stiffness * approach.T).T

    def at_all_points(self, phi: Mapping[int, Floats]) -> Floats:
        """A coefficient given by interface, at all points."""
        return joined([phi[index] for index in range(len(self.interfaces))])

    def change(self, step: Floats, y: Floats, at_nodes: bool) -> float:
        """The largest over the bodies of ‖u_n of the step‖₂ / ‖u_n of y‖₂, at the contacts' points or nodes."""
        trace, offset, starts = self._nodal_traces if at_nodes else self._traces
        u_n = trace @ np.column_stack([step, y])
        u_n[:, 1] += offset
        moved, size = np.sqrt(np.add.reduceat(u_n * u_n, starts)).T.tolist()
        parts = [m / s if s != 0.0 else float(m != 0.0) for m, s in zip(moved, size, strict=True)]
        return max(parts) if all(map(math.isfinite, parts)) else math.nan  # max() passes over what is not a number

    @cached_property
    def _traces(self) -> tuple[Operator | BlockDiagonal, Floats, NDArray[np.intp]]:
        """From y to every body's u_n at the points of its contacts, the prescribed part, and where each body begins."""
        offsets = [np.concatenate([port.offset for port in problem.traces]) for problem in self.problems]
        ports = [port for problem in self.problems for port in problem.traces]
        if not self.dense or not all(isinstance(port.trace, np.ndarray) for port in ports):
            return self._stacked_traces, np.concatenate(offsets), _starts(offsets)
        traces = [np.vstack([port.trace for port in problem.traces]) for problem in self.problems]
        return self._along_diagonal(traces), np.concatenate(offsets), _starts(offsets)

    @cached_property
    def _nodal_traces(self) -> tuple[Operator | BlockDiagonal, Floats, NDArray[np.intp]]:
        """The same at the nodes of the contact surfaces."""
        offsets = [problem.nodal_offset for problem in self.problems]
        traces = BlockDiagonal([problem.nodal_trace for problem in self.problems])
        return traces, np.concatenate(offsets), _starts(offsets)

    def _along_diagonal(self, blocks: Sequence[Operator]) -> Floats | BlockDiagonal:
        """The matrix with the bodies' blocks along its diagonal, dense if they all are and are small together."""
        dense = [block for block in blocks if isinstance(block, np.ndarray)]
        return along_diagonal(dense) if self.dense and len(dense) == len(blocks) else BlockDiagonal(blocks)

    def _normal_approach(self) -> Operator:
        """The operator from y to u_αn + u_βn at all points."""
        shape = (len(self.weights), self.size)
        ports = [(part, port) for part, p in zip(self.parts, self.problems, strict=True) for port in p.traces]
        if self.dense and self._full_product(shape, [port for _, port in ports]):
            total = np.zeros(shape)
            for part, port in ports:
                total[self.points[port.interface], part] += port.trace
            return total
        parts = [self.points[port.interface] for _, port in ports]
        points = np.concatenate([np.arange(part.start, part.stop) for part in parts])
        entries = np.ones(len(points)), (points, np.arange(len(points)))
        approach = scipy.sparse.csr_matrix(entries, shape=(shape[0], len(points))) @ self._stacked_traces
        approach.sort_indices()
        return approach

    @cached_property
    def _stacked_traces(self) -> scipy.sparse.csr_matrix:
        """The first of these as a sparse matrix."""
        pairs = zip(self.parts, self.problems, strict=True)
        traces = [(part.start, scipy.sparse.csr_matrix(port.trace)) for part, p in pairs for port in p.traces]
        starts = np.cumsum(np.concatenate([[0], *(np.diff(trace.indptr) for _, trace in traces)]))
        columns = np.concatenate([start + trace.indices for start, trace in traces])
        entries = (np.concatenate([trace.data for _, trace in traces]), columns, starts)
        return scipy.sparse.csr_matrix(entries, shape=(len(starts) - 1, self.size))

    def _full_product(self, shape: tuple[int, int], ports: Sequence[ContactTrace]) -> bool:
        """Whether the contacts' term is best a product of full matrices: not where its map is quicker, and small."""
        products = shape[0] * shape[1] ** 2
        if products <= LARGEST_PRODUCT:
            return True
        counts = np.zeros(shape[0], dtype=np.int64)  # the entries of each row
        for port in ports:
            counts[self.points[port.interface]] += np.diff(scipy.sparse.csr_matrix(port.trace).indptr)
        entries = int(counts @ counts)
        small = entries <= max(LARGEST_MAP, shape[0] * shape[1] // 12)  # 8 bytes for each of a full matrix
        return not small or products <= PRODUCTS_PER_ENTRY * entries

    def _undeformed_gaps(self) -> Floats:
        """The initial gaps d less the normal approach by prescribed displacements, at all points."""
        gaps = np.concatenate([interface.gap for interface in self.interfaces])
        for problem in self.problems:
            for port in problem.traces:
                gaps[self.points[port.interface]] -= port.offset
        return gaps


def joined(parts: Sequence[Floats]) -> Floats:
    """Parts one after another."""
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _starts(parts: Sequence[Floats]) -> NDArray[np.intp]:
    """The index at which each of the parts begins."""
    return np.array([part.start for part in slices(map(len, parts))])
