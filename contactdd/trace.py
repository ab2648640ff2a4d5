"""Displacements at points of boundary facets: coordinates, normals, areas and the basis functions' values there.

Only normal displacements and normal tractions cross a contact. This file makes the sparse operator u ↦ u·n at any
points of any boundary facets: every element, degree and dimension by the same lines.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import basix
import numpy as np
import scipy
from dolfinx import fem
from dolfinx import mesh as dmesh
from numpy.typing import NDArray

from . import compat
from .isometry import Isometry

Floats = NDArray[np.float64]


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
    frame, local = _reference_facets(compat.coordinate_map(domain).cell_type), entities[:, 1]
    reference = frame.to_cell(local, points)
    x, edges = _map(domain, entities[:, 0], reference)
    # Nanson's formula: the reference normal times the area becomes det J J⁻ᵀN, J's cofactors times N.
    cofactors = _cofactors(edges)
    mapped = np.matmul(frame.normals[local][:, None], cofactors)[:, 0]
    length, determinant = np.sqrt(_dot(mapped, mapped)), _dot(edges[:, 0], cofactors[:, 0])
    normal = mapped / np.copysign(length, determinant)[:, None]
    return FacetPoints(entities[:, 0], reference, x, normal, frame.areas[local] * length)


def surface_points(domain: dmesh.Mesh, entities: NDArray[np.int32], points: Floats) -> FacetPoints:
    """The same points (p, dim − 1) of the reference facet on each of the facets `entities` (n, 2), facet by facet."""
    return facet_points(domain, np.repeat(entities, len(points), axis=0), np.tile(points, (len(entities), 1)))


def facet_map(domain: dmesh.Mesh, entities: NDArray[np.int32], points: Floats) -> tuple[Floats, Floats]:
    """x (n, dim) and its derivatives (n, dim, dim − 1) by the reference facet's coordinates, one point per facet."""
    frame, local = _reference_facets(compat.coordinate_map(domain).cell_type), entities[:, 1]
    x, edges = _map(domain, entities[:, 0], frame.to_cell(local, points))
    return x, np.swapaxes(np.matmul(frame.axes[local], edges), 1, 2)


def facet_corners(domain: dmesh.Mesh, entities: NDArray[np.int32]) -> Floats:
    """The corners of facets in order around each, (n, corners, dim)."""
    frame = _reference_facets(compat.coordinate_map(domain).cell_type)
    # The first of a cell's geometry nodes are its vertices.
    nodes = compat.geometry_dofmap(domain)[entities[:, :1], frame.corners[entities[:, 1]]]
    return domain.geometry.x[nodes][:, :, : domain.topology.dim]


def facet_type(domain: dmesh.Mesh) -> basix.CellType:
    """The shape of the mesh's facets."""
    return basix.cell.subentity_types(compat.coordinate_map(domain).cell_type)[domain.topology.dim - 1][0]


def normal_trace(
    space: fem.FunctionSpace, points: FacetPoints, normal: Floats | None = None
) -> scipy.sparse.csr_matrix:
    """The sparse operator from the degrees of freedom of `space` to u·n at the points, (n, dofs).

    normal: (n, dim), another direction than the outward normal.
    """
    direction = points.normal if normal is None else normal
    basis = space.element.basix_element.tabulate(0, points.reference)[0, :, :, 0]
    dofmap = space.dofmap
    dim, count = dofmap.bs, dofmap.index_map.size_local + dofmap.index_map.num_ghosts
    # Exact zeros (inner nodes, the components along a flat surface) must not become unknowns of the contact.
    seen = np.flatnonzero(np.abs(basis) > 1e-14)
    point, node = np.divmod(seen, basis.shape[1])
    values = basis.ravel()[seen][:, None] * direction[point]
    pair, component = np.nonzero(np.abs(values) > 1e-14)
    columns = dofmap.list[points.cells[point], node][pair] * dim + component
    ends = np.searchsorted(point[pair], np.arange(len(basis) + 1))
    entries = (values[pair, component], columns.astype(np.int32), ends.astype(np.int32))
    operator = scipy.sparse.csr_matrix(entries, shape=(len(basis), dim * count))
    operator.sort_indices()
    return operator


@dataclass(frozen=True)
class _ReferenceFacets:
    """The facets of the reference cell: corners (f, c) the vertices in order around each, origins (f, dim), axes
    (f, dim − 1, dim), outward normals (f, dim), areas (f,) per unit of the reference facet."""

    corners: NDArray[np.intp]
    origins: Floats
    axes: Floats
    normals: Floats
    areas: Floats

    def to_cell(self, local: NDArray[np.int32], points: Floats) -> Floats:
        """Coordinates in the reference cell of points (n, dim − 1) of its facets `local` (n,)."""
        return self.origins[local] + np.matmul(points[:, None], self.axes[local])[:, 0]


@cache
def _reference_facets(cell: basix.CellType) -> _ReferenceFacets:
    vertices = np.asarray(basix.geometry(cell))
    dim = vertices.shape[1]
    facets = np.array(basix.topology(cell)[dim - 1])
    around = [0, 1, 3, 2] if facets.shape[1] == 4 else list(range(facets.shape[1]))  # basix counts row by row
    normals = np.asarray(basix.cell.facet_outward_normals(cell)).reshape(-1, dim)
    origins = vertices[facets[:, 0]]
    axes = vertices[facets[:, 1:dim]] - origins[:, None]
    areas = np.linalg.norm(axes[:, 0], axis=1) if dim == 2 else np.linalg.norm(np.cross(axes[:, 0], axes[:, 1]), axis=1)
    return _ReferenceFacets(facets[:, around], origins, axes, normals, areas)


def _map(domain: dmesh.Mesh, cells: NDArray[np.int32], reference: Floats) -> tuple[Floats, Floats]:
    """x (n, dim) and its derivatives by each reference coordinate, (n, dim, dim) the rows of Jᵀ, at points of the
    reference cell, one per cell."""
    table = compat.coordinate_map(domain).tabulate(1, reference)[:, :, :, 0]
    nodes = domain.geometry.x[compat.geometry_dofmap(domain)[cells]][:, :, : domain.topology.dim]
    # Seen from a corner of the cell, a small cell far from the origin loses no digits of its shape.
    corner = nodes[:, :1]
    # One product for all: the point itself, and the derivatives by the dim reference coordinates.
    mapped = np.matmul(table.transpose(1, 0, 2), nodes - corner)
    return mapped[:, 0] + corner[:, 0], mapped[:, 1:]


def _dot(a: Floats, b: Floats) -> Floats:
    """The scalar products of n vectors, (n, dim) each."""
    return np.einsum("ij,ij->i", a, b)


def _cofactors(rows: Floats) -> Floats:
    """The cofactors of matrices (n, dim, dim): row i times row j of them is the determinant if i = j, else zero."""
    if rows.shape[1] == 2:
        return rows[:, ::-1, ::-1] * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return np.cross(rows[:, [1, 2, 0]], rows[:, [2, 0, 1]])
