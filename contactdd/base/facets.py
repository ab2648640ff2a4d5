"""Displacements at points of boundary facets: coordinates, normals, areas and the basis functions' values there.

Only normal displacements and normal tractions cross a contact. This file makes the sparse operator u ↦ u·n at any
points of any boundary facets: every element, degree and dimension by the same lines.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cache
from typing import Any

import basix
import numpy as np
from dolfinx import mesh as dmesh
from numpy.typing import NDArray

from . import compat
from .arrays import Floats
from .isometry import Isometry


@dataclass(frozen=True)
class FacetPoints:
    """n points on boundary facets.

    cells: (n,) the cell of each; reference: (n, dim) its coordinates in the reference cell; x: (n, dim); normal:
    (n, dim) outward units; area: (n,) the facet's area there per unit of the reference facet.
    """

    cells: NDArray[np.int32]
    reference: Floats
    x: Floats
    normal: Floats
    area: Floats

    def kept(self, places: NDArray[np.intp]) -> FacetPoints:
        """Some of the points."""
        return FacetPoints(*(getattr(self, field.name)[places] for field in fields(self)))

    def turned(self, isometry: Isometry) -> FacetPoints:
        """The same points on a copy of the mesh."""
        return replace(self, x=isometry(self.x), normal=isometry.signs * self.normal)


def facet_entities(domain: dmesh.Mesh, facets: NDArray[np.int32]) -> NDArray[np.int32]:
    """(cell, local facet) of each boundary facet, shape (facets, 2)."""
    dim = domain.topology.dim
    domain.topology.create_connectivity(dim - 1, dim)
    domain.topology.create_connectivity(dim, dim - 1)
    facet_cells, cell_facets = domain.topology.connectivity(dim - 1, dim), domain.topology.connectivity(dim, dim - 1)
    cells = facet_cells.array[facet_cells.offsets[facets]]
    per_cell = cell_facets.offsets[1] - cell_facets.offsets[0]
    local = np.argmax(cell_facets.array.reshape(-1, per_cell)[cells] == facets[:, None], axis=1)
    return np.column_stack([cells, local]).astype(np.int32)


def facet_points(domain: dmesh.Mesh, entities: NDArray[np.int32], points: Floats) -> FacetPoints:
    """One point on each of the facets `entities` (n, 2), at the reference facet's coordinates `points` (n, dim - 1)."""
    reference, table = _tabulated(compat.coordinate_map(domain), entities[:, 1], points)
    return _facet_points(domain, entities[:, 0], reference[:, None], table[:, None])


def surface_points(domain: dmesh.Mesh, entities: NDArray[np.int32], points: Floats) -> FacetPoints:
    """The same points (p, dim − 1) of the reference facet on each of the facets `entities` (n, 2), facet by facet."""
    reference, table = _rule_table(compat.coordinate_map(domain), points.tobytes())
    cells, local = entities.T
    return _facet_points(domain, cells, reference[local], table[local])


def facet_map(domain: dmesh.Mesh, entities: NDArray[np.int32], points: Floats) -> tuple[Floats, Floats]:
    """x (n, dim) and its derivatives (n, dim, dim − 1) by the reference facet's coordinates, one point per facet."""
    _, table = _tabulated(compat.coordinate_map(domain), entities[:, 1], points)
    x, derivatives = _map(domain, entities[:, 0], table[:, None])
    return x, np.swapaxes(derivatives[:, :-1], 1, 2)


def facet_corners(domain: dmesh.Mesh, entities: NDArray[np.int32]) -> Floats:
    """The corners of facets in order around each, (n, corners, dim)."""
    return domain.geometry.x[facet_nodes(domain, entities)][:, :, : domain.topology.dim]


def facet_nodes(domain: dmesh.Mesh, entities: NDArray[np.int32]) -> NDArray[np.int32]:
    """The geometry nodes at the corners of facets in order around each, (n, corners)."""
    frame = _reference_facets(compat.coordinate_map(domain).cell_type)
    # The first of a cell's geometry nodes are its vertices.
    return compat.geometry_dofmap(domain)[entities[:, :1], frame.corners[entities[:, 1]]]


def dot(a: Floats, b: Floats) -> Floats:
    """The scalar products of vectors (..., dim) that broadcast."""
    return np.einsum("...i,...i->...", a, b)


def cross(a: Floats, b: Floats) -> Floats:
    """The vector products of vectors (n, 3): NumPy's own has more to do before it begins."""
    (a0, a1, a2), (b0, b1, b2) = a.T, b.T
    return np.stack([a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0], axis=1)


def facet_type(domain: dmesh.Mesh) -> basix.CellType:
    """The shape of the mesh's facets."""
    return basix.cell.subentity_types(compat.coordinate_map(domain).cell_type)[domain.topology.dim - 1][0]


@dataclass(frozen=True)
class _ReferenceFacets:
    """The facets of the reference cell: corners (f, c) the vertices in order around each, origins (f, dim), axes (f,
    dim, dim) those of its dim − 1 coordinates and the outward normal."""

    corners: NDArray[np.intp]
    origins: Floats
    axes: Floats


@cache
def _reference_facets(cell: basix.CellType) -> _ReferenceFacets:
    vertices = np.asarray(basix.geometry(cell))
    dim = vertices.shape[1]
    facets = np.array(basix.topology(cell)[dim - 1])
    around = [0, 1, 3, 2] if facets.shape[1] == 4 else list(range(facets.shape[1]))  # basix counts row by row
    origins = vertices[facets[:, 0]]
    normals = np.asarray(basix.cell.facet_outward_normals(cell)).reshape(-1, 1, dim)
    axes = np.concatenate([vertices[facets[:, 1:dim]] - origins[:, None], normals], axis=1)
    return _ReferenceFacets(facets[:, around], origins, axes)


def _tabulated(element: Any, local: NDArray[np.integer[Any]], points: Floats) -> tuple[Floats, Floats]:
    """Points (n, dim − 1) of the facets `local` (n,) in the reference cell, (n, dim), and a scalar element there: its
    functions and their derivatives along the facet's axes and the outward normal, (n, 1 + dim, nodes)."""
    frame = _reference_facets(element.cell_type)
    axes = frame.axes[local]
    reference = frame.origins[local] + np.matmul(points[:, None], axes[:, :-1])[:, 0]
    table = element.tabulate(1, reference)[:, :, :, 0].transpose(1, 0, 2)
    return reference, np.concatenate([table[:, :1], np.matmul(axes, table[:, 1:])], axis=1)


@cache
def _rule_table(element: Any, rule: bytes) -> tuple[Floats, Floats]:
    """`_tabulated` at a rule's points (as bytes, so that it can be cached), for every facet: (f, p, ...) each."""
    facets, dim = _reference_facets(element.cell_type).origins.shape
    points = np.frombuffer(rule).reshape(-1, dim - 1)
    local = np.repeat(np.arange(facets), len(points))
    reference, table = _tabulated(element, local, np.tile(points, (facets, 1)))
    return reference.reshape(facets, -1, dim), table.reshape(facets, -1, *table.shape[1:])


def _facet_points(domain: dmesh.Mesh, cells: NDArray[np.int32], reference: Floats, table: Floats) -> FacetPoints:
    """From where p points on a facet of each of n cells are in the reference cell, (n, p, dim), and the table there."""
    x, derivatives = _map(domain, cells, table)
    across = _across(derivatives[:, :-1])
    area = np.sqrt(dot(across, across))
    # What is outward in the reference cell is outward in every cell, also in one of negative det J.
    normal = across / np.copysign(area, dot(across, derivatives[:, -1]))[:, None]
    return FacetPoints(np.repeat(cells, reference.shape[1]), reference.reshape(x.shape), x, normal, area)


def _map(domain: dmesh.Mesh, cells: NDArray[np.int32], table: Floats) -> tuple[Floats, Floats]:
    """x (n · p, dim) and its derivatives (n · p, dim, dim), one direction a row, at p points of each of n cells.

    table: (n, p, 1 + dim, nodes) the coordinate element there, as `_tabulated` gives it.
    """
    (n, p, rows, size), dim = table.shape, domain.topology.dim
    nodes = domain.geometry.x[compat.geometry_dofmap(domain)[cells], :dim]
    # Seen from a corner of the cell, a small cell far from the origin loses no digits of its shape.
    corner = nodes[:, :1]
    # One product for all: the points themselves, and the derivatives.
    mapped = np.matmul(table.reshape(n, p * rows, size), nodes - corner).reshape(n, p, rows, dim)
    return (mapped[:, :, 0] + corner).reshape(n * p, dim), mapped[:, :, 1:].reshape(n * p, dim, dim)


def _across(tangents: Floats) -> Floats:
    """The vectors across dim − 1 tangents (n, dim − 1, dim), as long as the area that these span, (n, dim)."""
    if tangents.shape[1] == 1:
        return tangents[:, 0, ::-1] * np.array([1.0, -1.0])
    return cross(tangents[:, 0], tangents[:, 1])
