"""The free rigid motions of all bodies together: one small dense matrix, or sparse where there are many bodies.

Both kinds answer the same questions. The dense one is `local.rigid.RigidMotions`, as for a single body; the sparse one
asks a Cholesky factorisation whether anything is free, and only then looks for what is (`base.null_space`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from ..base.arrays import TINY, Floats, Indices, Operator, slices
from ..base.null_space import NullSpace, Rows, compressed, null_space
from ..base.ranks import Ranks
from ..base.sparse import along_diagonal
from ..errors import LooseBodyError
from ..local.factor import Factor
from ..local.problem import LocalProblem, Solver
from ..local.rigid import Owner, Resistance, RigidMotions, loose_body, select_fixing_dofs
from .block_diagonal import BlockDiagonal

#: Motions up to which dense algebra is quicker.
LARGEST_DENSE = 100


#: The part of the largest stiffness that is added where least squares leave motions undetermined.
REGULAR = 1e-12


#: Solutions of a regularised system are improved so often: each time by some digits.
REFINEMENTS = 2


@dataclass(frozen=True)
class Coupling:
    """One contact's resistance to the motions of the bodies on its sides.

    rows: by body, (points, motions of the body) √weight u_n of each motion.
    """

    rows: Rows

    @cached_property
    def beside(self) -> Floats:
        """The bodies' rows beside each other, (points, motions of them all)."""
        return np.hstack(list(self.rows.values()))

    def columns(self, parts: Sequence[slice]) -> Indices:
        """The motions of `beside` among all motions, of which `parts` are the bodies'."""
        return np.concatenate([np.arange(parts[body].start, parts[body].stop) for body in self.rows])


def joint_motions(
    problems: Sequence[LocalProblem], weights: Sequence[Floats], modes: BlockDiagonal
) -> RigidMotions | ManyMotions:
    """The free rigid motions of all bodies; a contact resists those that change its gap.

    weights: the areas at the points of each interface; modes: from the motions' coefficients to all unknowns.
    """
    couplings = _couplings(problems, weights)
    motions = [problem.rigid for problem in problems]
    if sum(each.count for each in motions) > LARGEST_DENSE:
        return ManyMotions(motions, couplings, modes)
    parts = slices(each.count for each in motions)
    contacts = [Resistance(index, _dense(coupling, parts)) for index, coupling in enumerate(couplings)]
    owners = [owner for each in motions for owner in each.owners]
    dense, springs = along_diagonal([m.modes for m in motions]), along_diagonal([m.springs for m in motions])
    return RigidMotions(dense, springs, contacts, owners, max(each.stiffness_scale for each in motions))


def _couplings(problems: Sequence[LocalProblem], weights: Sequence[Floats]) -> list[Coupling]:
    """What each interface does to the motions of the bodies on its sides."""
    roots = [np.sqrt(each)[:, None] for each in weights]
    rows: list[dict[int, Floats]] = [{} for _ in weights]
    for body, problem in enumerate(problems):
        for trace in problem.traces:
            rows[trace.interface][body] = roots[trace.interface] * (trace.trace @ problem.rigid.modes)
    return [Coupling(each) for each in rows]


def joint_rows(couplings: Sequence[Coupling], motions: RigidMotions | ManyMotions) -> Operator:
    """√weight u_n of all bodies' motions at all points of couplings, (points, motions), sparse where they are many."""
    parts = slices(owner.coefficients.shape[1] for owner in motions.owners)
    if isinstance(motions, ManyMotions):
        return _sparse(couplings, parts)
    return np.vstack([_dense(coupling, parts) for coupling in couplings])


def _dense(coupling: Coupling, parts: Sequence[slice]) -> Floats:
    rows = np.zeros((len(coupling.beside), parts[-1].stop))
    for body, part in coupling.rows.items():
        rows[:, parts[body]] = part
    return rows


def _sparse(couplings: Sequence[Coupling], parts: Sequence[slice]) -> scipy.sparse.csr_matrix:
    columns = np.concatenate([np.tile(c.columns(parts), len(c.beside)) for c in couplings])
    counts = np.concatenate([np.full(len(c.beside), c.beside.shape[1]) for c in couplings])
    data = np.concatenate([c.beside.ravel() for c in couplings])
    starts = np.concatenate([[0], np.cumsum(counts)])
    return scipy.sparse.csr_matrix((data, columns, starts), shape=(len(counts), parts[-1].stop))


def settled(
    problems: Sequence[LocalProblem],
    motions: RigidMotions | ManyMotions,
    displacements: Mapping[int, Floats],
    ranks: Ranks,
) -> dict[int, Floats]:
    """The displacements (dofs,) of the bodies that this rank holds, of all that differ by unresisted motions the
    smallest. Collective."""
    if motions.count == 0 or motions.unresisted.shape[1] == 0:
        return dict(displacements)
    parts = motions.by_owner(motions.unresisted)
    moves = {index: _moves(problems[index], motions.owners[index], parts[index]) for index in displacements}

    def reduced(index: int) -> tuple[Indices, Floats]:
        """A body's part of the least squares in as few rows as it has columns: the motions, and the displacement."""
        there, moved = moves[index]
        return there, np.asarray(np.linalg.qr(np.column_stack([moved, displacements[index]]), mode="r"))

    rows, count = ranks.each(reduced), motions.unresisted.shape[1]
    of_motions = [_spread(there, triangle[:, :-1], count) for there, triangle in rows]
    values = np.concatenate([triangle[:, -1] for _, triangle in rows])
    if isinstance(motions, RigidMotions):
        drift = np.linalg.lstsq(scipy.sparse.vstack(of_motions).toarray(), values, rcond=None)[0]
    else:
        matrix = scipy.sparse.vstack(of_motions).tocsr()
        drift = least_squares(matrix, np.ones(len(values)), matrix.T @ values)
    return {index: u - moves[index][1] @ drift[moves[index][0]] for index, u in displacements.items()}


def _moves(problem: LocalProblem, owner: Owner, part: Operator) -> tuple[Indices, Floats]:
    """The unresisted motions that move a body, and its displacements in them, (dofs, motions)."""
    part = scipy.sparse.csr_matrix(part)
    there = np.unique(part.indices)  # of many motions few move a body
    return there, problem.dofs.rigid_displacements(owner.coefficients @ part[:, there].toarray())


def _spread(there: Indices, columns: Floats, count: int) -> scipy.sparse.csr_matrix:
    """Columns (rows, n) at their places among `count`."""
    ends = np.arange(len(columns) + 1) * len(there)
    return scipy.sparse.csr_matrix((columns.ravel(), np.tile(there, len(columns)), ends), shape=(len(columns), count))


class ManyMotions:
    """The motions of many bodies together; see `RigidMotions`, whose questions it answers.

    motions: those of the bodies; couplings: what the interfaces do to them; modes: from their coefficients to all
    unknowns.
    """

    def __init__(self, motions: Sequence[RigidMotions], couplings: Sequence[Coupling], modes: BlockDiagonal) -> None:
        self.owners = [owner for each in motions for owner in each.owners]
        self.stiffness_scale = max(each.stiffness_scale for each in motions)
        self._motions, self._couplings, self._modes = motions, couplings, modes
        self._onto_motions = modes.T
        self._sizes = [each.count for each in motions]
        self._parts = slices(self._sizes)
        self.count = sum(self._sizes)
        self._factor: Factor | None = None

    def displacements(self, coefficients: Floats) -> Floats:
        """The unknowns (unknowns,) of motions given by coefficients."""
        return self._modes @ coefficients

    def by_owner(self, coefficients: scipy.sparse.csc_matrix) -> list[scipy.sparse.csr_matrix]:
        """The parts of coefficients (motions, n), one for each body."""
        coefficients = coefficients.tocsr()
        return [coefficients[part] for part in self._parts]

    @property
    def unresisted(self) -> scipy.sparse.csc_matrix:
        """The kernel motions, (motions, unresisted); none if springs soft enough for the kernel resist any of them."""
        return self._unresisted.vectors

    @cached_property
    def rows(self) -> scipy.sparse.csr_matrix:
        """√weight u_n of each motion at all points, (points, motions)."""
        return _sparse(self._couplings, self._parts)

    @cached_property
    def unsprung(self) -> NDArray[np.bool_]:
        """Which motions no spring answers, (motions,)."""
        return np.concatenate([each.unsprung for each in self._motions])

    @cached_property
    def unbounded(self) -> scipy.sparse.csr_matrix:
        """The motions that no spring resists, as columns of coefficients (motions, unbounded)."""
        largest = max(float(np.abs(each.elastic).max(initial=0.0)) for each in self._motions)
        return BlockDiagonal([each.unresisted_by_springs(largest) for each in self._motions]).tocsr()

    def closest(self, stiffness: Floats, wanted: Floats) -> Floats:
        """The coefficients (motions,) of unsprung motions with about the wanted √weight u_n at all points.

        Those of least squares, with weights `stiffness` (points,); what these leave open stays small.
        """
        coefficients = np.zeros(self.count)
        rows = self.rows[:, self.unsprung]
        coefficients[self.unsprung] = least_squares(rows, stiffness, rows.T @ (stiffness * wanted))
        return coefficients

    def free_displacements(self, phi: Mapping[int, Floats]) -> Floats:
        """The motions free under φ as unknowns, (unknowns, free)."""
        return self._modes @ self._free(phi).vectors.toarray()

    def fixing_dofs(self, phi: Mapping[int, Floats], forces: Floats, scale: float) -> Indices:
        """Unknowns to fix so that no rigid motion remains; see `RigidMotions.fixing_dofs`."""
        free = self._free(phi)
        if free.size == 0:
            return np.zeros(0, dtype=np.intp)
        work = free.vectors.T @ (self._onto_motions @ forces)
        if np.abs(work).max() > 1e-9 * scale:
            raise self.loose(free.vectors @ work)
        of_bodies = zip(self._modes.rows, self._modes.blocks, strict=True)
        fixed = [
            part.start + select_fixing_dofs(modes @ free.directions[body])
            for body, (part, modes) in enumerate(of_bodies)
            if body in free.directions
        ]
        return np.concatenate(fixed)

    def loose(self, motion: Floats, advice: str = "") -> LooseBodyError:
        """The error that names the body which a motion (coefficients) moves most; advice: the end of its message."""
        return loose_body(self.owners, [motion[part] for part in self._parts], advice)

    def _free(self, phi: Mapping[int, Floats]) -> NullSpace:
        """The motions free under φ."""
        values = self._resistance(phi)
        limit = 1e-14 * max(self.stiffness_scale, float(np.abs(values).max()))
        if self._holds(values + self._with_kernel_fixed, limit):
            return self._unresisted
        roots = [
            {body: np.sqrt(phi[index])[:, None] * part for body, part in coupling.rows.items()}
            for index, coupling in enumerate(self._couplings)
        ]
        return null_space([*map(_compressed, roots), *self._spring_rows], self._sizes, limit**0.5)

    @cached_property
    def _unresisted(self) -> NullSpace:
        """The kernel motions, or none if springs soft enough for the kernel resist any of them."""
        values = self._resistance(None)
        if self._holds(values, 1e-14 * float(np.abs(values).max())):
            return NullSpace(scipy.sparse.csc_matrix((self.count, 0)), {})
        kernel = self._kernel
        elastic = BlockDiagonal([each.elastic for each in self._motions]).tocsr()
        resistance = kernel.vectors.T @ elastic @ kernel.vectors
        if kernel.size and np.abs(resistance.data).max(initial=0.0) > 1e-14 * self.stiffness_scale:
            return NullSpace(kernel.vectors[:, :0], {})
        return kernel

    @cached_property
    def _kernel(self) -> NullSpace:
        """The motions that change no gap and meet no spring, whatever φ is."""
        rows = [_compressed(coupling.rows) for coupling in self._couplings]
        for body, each in enumerate(self._motions):
            springs = np.linalg.norm(each.springs, axis=0) / max(self.stiffness_scale, TINY)
            rows.append({body: np.diag(springs)})
        largest = max(float(np.abs(part).max(initial=0.0)) for block in rows for part in block.values())
        return null_space(rows, self._sizes, 1e-10 * largest)

    @cached_property
    def _spring_rows(self) -> list[Rows]:
        """Roots of the stiffness of springs, by body."""
        return [{body: each.spring_root} for body, each in enumerate(self._motions) if np.any(each.springs)]

    @cached_property
    def _columns(self) -> list[Indices]:
        """The motions that each interface resists."""
        return [coupling.columns(self._parts) for coupling in self._couplings]

    @cached_property
    def _pattern(self) -> tuple[NDArray[np.int64], Indices]:
        """The keys (row times number of motions plus column) of the resistance's entries, and its parts' places."""
        own = [np.arange(part.start, part.stop) for part in self._parts]
        keys = [(at[:, None] * self.count + at).ravel() for at in (*self._columns, *own)]
        return np.unique(np.concatenate(keys), return_inverse=True)

    def _assembled(self, blocks: Sequence[Floats]) -> Floats:
        """The entries of the matrix of these blocks, of all interfaces and then all bodies."""
        keys, places = self._pattern
        values = np.concatenate([block.ravel() for block in blocks])
        return np.asarray(np.bincount(places, weights=values, minlength=len(keys)), dtype=float)

    def _resistance(self, phi: Mapping[int, Floats] | None) -> Floats:
        """The entries of the stiffness of contacts and springs against the motions; None: φ = 1."""
        rows = [coupling.beside for coupling in self._couplings]
        if phi is None:
            blocks = [each.T @ each for each in rows]
        else:
            blocks = [(each.T * phi[index]) @ each for index, each in enumerate(rows)]
        return self._assembled(blocks + [each.elastic for each in self._motions])

    @cached_property
    def _with_kernel_fixed(self) -> Floats:
        """What is added to the entries of the resistance to fix the unresisted motions."""
        fixed = self._unresisted.directions
        nothing = [np.zeros((len(at), len(at))) for at in self._columns]
        own: list[Floats] = [np.zeros((size, size)) for size in self._sizes]
        for body, directions in fixed.items():
            own[body] = self.stiffness_scale * (directions @ directions.T)
        return self._assembled(nothing + own)

    def _holds(self, values: Floats, limit: float) -> bool:
        """Whether no eigenvalue of the matrix with these entries is below a limit (or hardly above it).

        By the growth of a vector that is divided by the matrix, which is moved by the limit away from 0.
        """
        try:
            solve = self._factored(values, limit)
        except np.linalg.LinAlgError:
            self._factor = None
            return False
        vector = np.random.default_rng(0).standard_normal(self.count)
        growth = 0.0
        for _ in range(3):
            vector = solve(vector / np.linalg.norm(vector))
            growth = float(np.linalg.norm(vector))
        return growth * limit < 0.25  # false for what is not a number, too

    def _factored(self, values: Floats, limit: float) -> Solver:
        """The inverse of the matrix with these entries and a limit more on its diagonal."""
        keys, _ = self._pattern
        rows, columns = np.divmod(keys, self.count)
        shifted = values + limit * (rows == columns)
        if self._factor is None:
            starts = np.searchsorted(rows, np.arange(self.count + 1))
            self._factor = Factor(scipy.sparse.csr_matrix((shifted, columns, starts), shape=(self.count, self.count)))
        else:
            self._factor.update(shifted)
        return self._factor.solve


def _compressed(rows: Rows) -> Rows:
    """As few rows with the same inner products."""
    beside = compressed(np.hstack(list(rows.values())))
    parts = slices(part.shape[1] for part in rows.values())
    return {body: beside[:, part] for body, part in zip(rows, parts, strict=True)}


def least_squares(rows: scipy.sparse.csr_matrix, weights: Floats, rhs: Floats) -> Floats:
    """x of rowsᵀ diag(weights) rows x = rhs (motions,), small where the rows leave it open."""
    matrix = (rows.T @ scipy.sparse.diags(weights) @ rows).tocsr()
    scale = float(matrix.diagonal().max(initial=0.0)) or 1.0
    factor = Factor((matrix + REGULAR * scale * scipy.sparse.eye(len(rhs), format="csr")).tocsr())
    x = factor.solve(rhs)
    for _ in range(REFINEMENTS):
        x = x + factor.solve(rhs - matrix @ x)
    return x
