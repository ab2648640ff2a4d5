"""The displacements u = Z y + u₀ that the supports of a body allow, y its unknowns.

Z has orthonormal columns. Mostly it only selects the free degrees of freedom; where a support is tilted it mixes some.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy
from numpy.typing import NDArray

from ..base.arrays import Floats, Indices, Operator

if TYPE_CHECKING:
    from ..body import Body


#: Entries up to which a dense product is faster than a sparse one.
SMALL = 2**14


#: Prescribed displacements that differ from a rigid motion by no more than this part of them are one: the rounding of a
#: least-squares fit, and of functions that users write.
RIGID = 1e-13


@dataclass(frozen=True)
class AdmissibleSpace:
    """u = Z y + u₀.

    offset: (dofs,) u₀; free: (unknowns,) the degrees of freedom that Z selects, in order, or None where it mixes some;
    mixing: then Z itself, (dofs, unknowns); carried: (dofs,) the rigid motion in u₀, None where nothing is prescribed.

    u₀ is what is prescribed, and a rigid motion elsewhere: the one that comes closest to what is prescribed. It meets
    no elastic force, and y does not have to make up for it.
    """

    offset: Floats
    free: Indices | None
    mixing: scipy.sparse.csr_matrix | None = None
    carried: Floats | None = None

    @property
    def free_dofs(self) -> Indices:
        """The degrees of freedom that Z selects; only of a Z that does not mix any."""
        if self.free is None:
            raise ValueError("free: tilted supports mix degrees of freedom")
        return self.free

    @cached_property
    def basis(self) -> scipy.sparse.csr_matrix:
        """Z, (dofs, unknowns)."""
        if self.mixing is not None:
            return self.mixing
        ends = np.searchsorted(self.free_dofs, np.arange(len(self.offset) + 1))
        entries = (np.ones(self.size), np.arange(self.size), ends)
        return scipy.sparse.csr_matrix(entries, shape=(len(self.offset), self.size))

    @property
    def size(self) -> int:
        """The number of unknowns."""
        return self.mixing.shape[1] if self.mixing is not None else len(self.free_dofs)

    @cached_property
    def numbers(self) -> NDArray[np.int32]:
        """The unknown at every degree of freedom, −1 where it is prescribed; of a Z that only selects."""
        return self._numbered(np.arange(self.size))

    @cached_property
    def has_offset(self) -> bool:
        """Whether anything else than zero is prescribed."""
        return bool(np.any(self.offset))

    @property
    def straining(self) -> Floats:
        """The part of u₀ that is no rigid motion, (dofs,)."""
        return self.offset if self.carried is None else self.offset - self.carried

    def extended(self, y: Floats) -> Floats:
        """Z y, (dofs,) or (dofs, n)."""
        if self.mixing is not None:
            return self.mixing @ y
        u = np.zeros((len(self.offset), *y.shape[1:]))
        u[self.free_dofs] = y
        return u

    def restricted(self, forces: Floats) -> Floats:
        """Zᵀ f of forces (dofs,) or (dofs, n)."""
        return self.mixing.T @ forces if self.mixing is not None else forces[self.free_dofs]

    def prevented(self, u: Floats) -> Floats:
        """The components of displacements u (dofs, n) that violate the supports; zero rows are dropped."""
        if self.mixing is not None:
            rest = u - self.extended(self.restricted(u))
            return rest[np.any(rest, axis=1)]
        held = np.ones(len(self.offset), dtype=bool)
        held[self.free_dofs] = False
        return u[held]

    def prescribed(self, operator: scipy.sparse.csr_matrix) -> Floats:
        """operator @ u₀; operator: on all degrees of freedom."""
        return operator @ self.offset if self.has_offset else np.zeros(operator.shape[0])

    def columns(self, matrix: scipy.sparse.csr_matrix) -> scipy.sparse.csr_matrix:
        """matrix @ Z."""
        return (matrix @ self.mixing).tocsr() if self.mixing is not None else matrix[:, self.free]

    def within(self, matrix: scipy.sparse.csr_matrix) -> scipy.sparse.csr_matrix:
        """Zᵀ @ matrix @ Z."""
        if self.mixing is not None:
            return (self.mixing.T @ matrix @ self.mixing).tocsr()
        return _renumbered(matrix[self.free_dofs], self.numbers, self.size)

    def unknowns_at(self, dofs: Indices) -> Indices:
        """The unknowns on which some degrees of freedom depend, in order."""
        if self.mixing is not None:
            return np.unique(self.mixing[dofs].indices)
        marked = np.zeros(len(self.offset), dtype=bool)
        marked[dofs] = True
        return np.flatnonzero(marked[self.free_dofs])

    def nodes(self, dim: int) -> Indices:
        """The node to which each unknown belongs; dim: degrees of freedom of a node."""
        if self.mixing is None:
            return self.free_dofs // dim
        by_column = self.mixing.tocsc()
        return by_column.indices[by_column.indptr[:-1]] // dim

    def columns_of(self, kept: Indices, small: int) -> Callable[[scipy.sparse.csr_matrix], Operator]:
        """From operators on all degrees of freedom to those on the kept unknowns.

        They are dense where Z only selects and they have no more entries than `small`.
        """
        if self.mixing is not None:
            some = self.mixing[:, kept]
            return lambda operator: (operator @ some).tocsr()
        numbers = self._numbered(kept)

        def chosen(operator: scipy.sparse.csr_matrix) -> Operator:
            shape = operator.shape[0], len(kept)
            if shape[0] * shape[1] > small:
                return _renumbered(operator, numbers, len(kept))
            columns = numbers[operator.indices]
            present = columns >= 0
            rows = np.repeat(np.arange(shape[0]), np.diff(operator.indptr))[present]
            dense = np.zeros(shape)
            dense[rows, columns[present]] = operator.data[present]
            return dense

        return chosen

    def _numbered(self, unknowns: Indices) -> NDArray[np.int32]:
        """The position of every degree of freedom among given unknowns, −1 where it is none of them."""
        numbers = np.full(len(self.offset), -1, dtype=np.int32)
        numbers[self.free_dofs[unknowns]] = np.arange(len(unknowns), dtype=np.int32)
        return numbers


def _renumbered(matrix: scipy.sparse.csr_matrix, numbers: NDArray[np.int32], count: int) -> scipy.sparse.csr_matrix:
    """The columns of a matrix that have a number, not −1, as `count` columns; their order in the rows stays.

    SciPy's own way looks for repeated ones.
    """
    columns = numbers[matrix.indices]
    present = columns >= 0
    ends = np.concatenate([[0], np.cumsum(present)])[matrix.indptr]
    return scipy.sparse.csr_matrix((matrix.data[present], columns[present], ends), shape=(matrix.shape[0], count))


def admissible_space(body: Body) -> AdmissibleSpace:
    """The displacements that the supports of the body allow."""
    dim, nodes = body.mesh.dim, body.space.dofmap.index_map.size_local
    conditions = [condition for support in body.supports for condition in support.conditions(body.elements)]
    fixed, offset = np.zeros((nodes, dim), dtype=bool), np.zeros((nodes, dim))
    tilted: dict[int, list[tuple[Floats, float]]] = {}
    for where, direction, values in conditions:
        axis = int(np.argmax(np.abs(direction)))
        if abs(direction[axis]) > 1 - 1e-12:
            values = values * np.sign(direction[axis])
            again = fixed[where, axis]
            if np.any(again):
                # Functions differ by the rounding of their values elsewhere too, where they cross zero here.
                largest = max(np.abs(values).max(), np.abs(offset[:, axis]).max())
                _refuse_conflict(body, again & (np.abs(offset[where, axis] - values) > 1e-12 * largest))
            fixed[where, axis], offset[where, axis] = True, values
        else:
            for node, value in zip(where, values, strict=True):
                tilted.setdefault(int(node), []).append((direction, float(value)))
    _refuse_open_axis(body, fixed)
    if not tilted:
        return _carried_along(body, AdmissibleSpace(offset.ravel(), np.flatnonzero(~fixed)))
    blocks = {node: _node_space(body, fixed[node], offset[node], rows) for node, rows in tilted.items()}
    return _carried_along(body, AdmissibleSpace(offset.ravel(), None, _assemble(fixed, blocks)))


def _carried_along(body: Body, space: AdmissibleSpace) -> AdmissibleSpace:
    """The same space, with the rigid motion closest to the prescribed displacements (least squares) in u₀."""
    if not space.has_offset:
        return space
    modes = body.rigid_modes()
    *prevented, prescribed = space.prevented(np.column_stack([modes, space.offset])).T
    carried = modes @ np.linalg.lstsq(np.transpose(prevented), prescribed, rcond=1e-10)[0]
    offset = space.offset + space.extended(space.restricted(carried))
    if np.abs(offset - carried).max() <= RIGID * np.abs(offset).max():
        carried = offset  # what is left would only be the rounding of the fit
    return replace(space, offset=offset, carried=carried)


def _node_space(body: Body, fixed: NDArray[np.bool_], offset: Floats, rows: list[tuple[Floats, float]]) -> Floats:
    """The free directions of a node with tilted conditions (dim, free); writes the node's offset in place."""
    axes = np.eye(len(fixed))[fixed]
    directions = np.vstack([axes, *(direction for direction, _ in rows)])
    values = np.concatenate([offset[fixed], [value for _, value in rows]])
    _, singular, right = np.linalg.svd(directions)
    rank = int(np.sum(singular > 1e-8))
    offset[:] = np.linalg.lstsq(directions, values, rcond=1e-8)[0]
    _refuse_conflict(body, np.abs(directions @ offset - values) > 1e-10 * np.abs(values).max(initial=1e-300))
    return right[rank:].T


def _refuse_conflict(body: Body, conflict: NDArray[np.bool_]) -> None:
    if np.any(conflict):
        raise ValueError(f"supports of body {body.name!r}: two of them prescribe different displacements of one point")


def _refuse_open_axis(body: Body, fixed: NDArray[np.bool_]) -> None:
    """In a body of revolution u_r = 0 on the axis, else the hoop strain u_r/r has no finite energy."""
    if body.kinematics.axisymmetric:
        x = body.space.tabulate_dof_coordinates()
        radius = float(x[:, 0].max())
        loose = (np.abs(x[:, 0]) < 1e-10 * radius) & ~fixed[:, 0]  # file formats round coordinates
        if np.any(loose):
            raise ValueError(
                f"supports of body {body.name!r}: it can open at {x[loose][0]} on the axis r = 0; expected "
                "Symmetry(...) on its surface there"
            )


def _assemble(fixed: NDArray[np.bool_], blocks: dict[int, Floats]) -> scipy.sparse.csr_matrix:
    """Z from the axis-aligned conditions and the nodes' own blocks."""
    dim = fixed.shape[1]
    counts = (~fixed).astype(np.int32)  # entries in each row
    counts[list(blocks)] = 0
    plain = np.flatnonzero(counts)
    for node, block in blocks.items():
        counts[node] = block.shape[1]
    ends = np.concatenate([[0], np.cumsum(counts)], dtype=np.int32)
    columns, values = np.empty(ends[-1], dtype=np.int32), np.ones(ends[-1])
    size = len(plain)
    columns[ends[plain]] = np.arange(size)
    for node, block in blocks.items():
        here, free = slice(ends[node * dim], ends[node * dim + dim]), block.shape[1]
        columns[here], values[here] = np.tile(size + np.arange(free), dim), block.ravel()
        size += free
    return scipy.sparse.csr_matrix((values, columns, ends), shape=(fixed.size, size))
