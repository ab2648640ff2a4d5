"""Supports: which displacements are prescribed, and springs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from .admissible import AdmissibleSpace
from .errors import one_of, positive
from .field import Field, coefficient, evaluate, refuse_no_field
from .material import Number
from .parameter import fixed_number
from .trace import surface_points

if TYPE_CHECKING:
    from .body import Body

Floats = NDArray[np.float64]
#: One prescribed component: nodes (n,), a unit direction (dim,) and the values (n,) of u·direction at the nodes.
Condition = tuple[NDArray[np.int32], Floats, Floats]


@dataclass(frozen=True)
class Fixed:
    """No displacement at all on the named surfaces, eq. (5)."""

    surfaces: tuple[str, ...]

    def __init__(self, *surfaces: str) -> None:
        object.__setattr__(self, "surfaces", surfaces)

    def conditions(self, body: Body) -> Iterator[Condition]:
        for surface in self.surfaces:
            nodes = surface_nodes(body, surface)
            for axis in np.eye(body.mesh.dim):
                yield nodes, axis, np.zeros(len(nodes))


@dataclass(frozen=True)
class Symmetry:
    """No normal displacement and no shear on the named surfaces, each of which has to be flat."""

    surfaces: tuple[str, ...]

    def __init__(self, *surfaces: str) -> None:
        object.__setattr__(self, "surfaces", surfaces)

    def conditions(self, body: Body) -> Iterator[Condition]:
        for surface, normal in _plane_normals(body, self.surfaces):
            nodes = surface_nodes(body, surface)
            yield nodes, normal, np.zeros(len(nodes))


@dataclass(frozen=True)
class Displacement:
    """Prescribed displacements on a named surface: one value per coordinate, None where it is free.

    A value is a number, a function of the coordinates x (3, points) or a `Parameter`.
    """

    surface: str
    values: Sequence[Field | None]

    def __post_init__(self) -> None:
        if not isinstance(self.values, list | tuple | np.ndarray):
            raise TypeError(f"values = {self.values!r}: expected a list, one entry per coordinate (None where free)")
        for value in self.values:
            if value is not None:
                refuse_no_field("displacement", value)

    def conditions(self, body: Body) -> Iterator[Condition]:
        if len(self.values) != body.mesh.dim:
            raise ValueError(f"values = {self.values!r}: expected {body.mesh.dim} entries (None where free)")
        nodes = surface_nodes(body, self.surface)
        x = body.space.tabulate_dof_coordinates()[nodes].T
        for axis, value in zip(np.eye(body.mesh.dim), self.values, strict=True):
            if value is not None:
                yield nodes, axis, evaluate("displacement", value, x)


@dataclass(frozen=True)
class Spring:
    """An elastic foundation on a named surface: it answers a displacement u with the traction −k u.

    stiffness: k > 0 (stress / length), a number or a function of the coordinates x (3, points), nowhere negative;
    direction: None (all directions alike), "normal", or the one direction (dim,) that it resists. A body that only
    springs hold loses digits as they get softer than itself; at 1e-8 of its stiffness a solve no longer converges.
    """

    surface: str
    stiffness: Number
    direction: str | Sequence[float] | None = None

    def __post_init__(self) -> None:
        fixed_number("stiffness", self.stiffness)
        if not callable(self.stiffness):
            positive("stiffness", self.stiffness)
        if isinstance(self.direction, str):
            one_of("direction", self.direction, ("normal",))

    def conditions(self, body: Body) -> Iterator[Condition]:
        return iter(())

    def form(self, body: Body, u: Any, v: Any) -> ufl.Form:
        """∫ k u·v ds, or ∫ k (u·e)(v·e) ds along one direction e."""
        value = self._values if callable(self.stiffness) else self.stiffness
        k = coefficient("stiffness", value, body.mesh.domain, (), body.degree + 2)
        if self.direction is None:
            return body.over_surface(k * ufl.dot(u, v), self.surface)
        e = ufl.FacetNormal(body.mesh.domain) if isinstance(self.direction, str) else self._direction(body)
        return body.over_surface(k * ufl.dot(u, e) * ufl.dot(v, e), self.surface)

    def _values(self, x: Floats) -> Floats:
        values = evaluate("stiffness", self.stiffness, x)
        if values.min() < -1e-12 * np.abs(values).max():  # coordinates that are zero but for rounding are
            worst = int(np.argmin(values))
            raise ValueError(f"stiffness = {values[worst]:g} at x = {x[:, worst]}: expected numbers >= 0")
        return values

    def _direction(self, body: Body) -> fem.Constant:
        direction = np.asarray(self.direction, dtype=float)
        if direction.shape != (body.mesh.dim,) or not 0.0 < np.linalg.norm(direction) < np.inf:
            raise ValueError(
                f"direction = {self.direction!r}: expected 'normal' or a vector of {body.mesh.dim} numbers"
            )
        return fem.Constant(body.mesh.domain, direction / np.linalg.norm(direction))


Support = Fixed | Symmetry | Displacement | Spring


def surface_nodes(body: Body, surface: str) -> NDArray[np.int32]:
    """The nodes (blocks of degrees of freedom) of a body on one of its named surfaces."""
    return fem.locate_dofs_topological(body.space, body.mesh.dim - 1, body.mesh.facets(surface))


def admissible_space(body: Body) -> AdmissibleSpace:
    """The displacements that the supports of the body allow."""
    dim, nodes = body.mesh.dim, body.space.dofmap.index_map.size_local
    conditions = [condition for support in body.supports for condition in support.conditions(body)]
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
        return AdmissibleSpace(offset.ravel(), np.flatnonzero(~fixed))
    blocks = {node: _node_space(body, fixed[node], offset[node], rows) for node, rows in tilted.items()}
    return AdmissibleSpace(offset.ravel(), None, _assemble(fixed, blocks))


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
    if body.kinematics.ring:
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


def _plane_normals(body: Body, surfaces: Sequence[str]) -> Iterator[tuple[str, Floats]]:
    """The flat surfaces by name, each with its outward normal; a curved one is refused."""
    if not surfaces:
        return
    entities = [body.mesh.entities(surface) for surface in surfaces]
    middle = np.full((1, body.mesh.dim - 1), 0.5 if body.mesh.dim == 2 else 1 / 3)
    normals = surface_points(body.mesh.domain, np.concatenate(entities), middle).normal
    end = 0
    for surface, pairs in zip(surfaces, entities, strict=True):
        start, end = end, end + len(pairs)
        total = normals[start:end].sum(axis=0)
        mean = total / max(float(np.sqrt(total @ total)), 1e-300)
        if np.abs(normals[start:end] - mean).max() > 1e-8:  # a file may have rounded coordinates to eight digits
            raise ValueError(
                f"surface = {surface!r} of body {body.name!r}: expected a flat surface for a symmetry plane"
            )
        yield surface, np.where(np.abs(mean) < 1e-8, 0.0, mean)
