"""Displacements at points of boundary facets: coordinates, normals, areas and the basis functions' values there.

Only normal displacements and normal tractions cross a contact. This file makes the sparse operator u ↦ u·n at any
points of any boundary facets: every element, degree and dimension by the same lines.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import basix
import numpy as np
import scipy
from dolfinx import fem
from dolfinx import mesh as dmesh
from numpy.typing import NDArray

from . import compat

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
    x, jacobian = _map(domain, entities[:, 0], reference)
    # Nanson's formula: the reference normal and area become J⁻ᵀN and |det J| |J⁻ᵀN|.
    mapped = np.linalg.solve(np.swapaxes(jacobian, 1, 2), frame.normals[local][:, :, None])[:, :, 0]
    length = np.linalg.norm(mapped, axis=1)
    area = frame.areas[local] * length * np.abs(np.linalg.det(jacobian))
    return FacetPoints(entities[:, 0], reference, x, mapped / length[:, None], area)


def facet_map(domain: dmesh.Mesh, entities: NDArray[np.int32], points: Floats) -> tuple[Floats, Floats]:
    """x (n, dim) and its derivatives (n, dim, dim − 1) by the reference facet's coordinates, one point per facet."""
    frame, local = _reference_facets(compat.coordinate_map(domain).cell_type), entities[:, 1]
    x, jacobian = _map(domain, entities[:, 0], frame.to_cell(local, points))
    return x, np.matmul(jacobian, np.swapaxes(frame.axes[local], 1, 2))


def facet_corners(domain: dmesh.Mesh, entities: NDArray[np.int32]) -> Floats:
    """The corners of facets in order around each, (n, corners, dim)."""
    vertices = np.asarray(basix.geometry(facet_type(domain)))
    around = [0, 1, 3, 2] if len(vertices) == 4 else list(range(len(vertices)))  # basix counts row by row
    x, _ = facet_map(domain, np.repeat(entities, len(vertices), axis=0), np.tile(vertices[around], (len(entities), 1)))
    return x.reshape(len(entities), len(vertices), -1)


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
    dim, dofmap = space.dofmap.bs, space.dofmap
    values = (basis[:, :, None] * direction[:, None, :]).reshape(len(basis), -1)
    # Exact zeros (inner nodes, the components along a flat surface) must not become unknowns of the contact.
    seen = np.abs(values) > 1e-14
    columns = (dofmap.list[points.cells][:, :, None] * dim + np.arange(dim)).reshape(values.shape)
    size = dim * (dofmap.index_map.size_local + dofmap.index_map.num_ghosts)
    ends = np.concatenate([[0], np.cumsum(np.count_nonzero(seen, axis=1))])
    operator = scipy.sparse.csr_matrix((values[seen], columns[seen], ends), shape=(len(basis), size))
    operator.sort_indices()
    return operator


@dataclass(frozen=True)
class _ReferenceFacets:
    """The facets of the reference cell: origins (f, dim), axes (f, dim − 1, dim), outward normals (f, dim), areas (f,)
    per unit of the reference facet."""

    origins: Floats
    axes: Floats
    normals: Floats
    areas: Floats

    def to_cell(self, local: NDArray[np.int32], points: Floats) -> Floats:
        """Coordinates in the reference cell of points (n, dim − 1) of its facets `local` (n,)."""
        return self.origins[local] + np.einsum("pi,pij->pj", points, self.axes[local])


@cache
def _reference_facets(cell: basix.CellType) -> _ReferenceFacets:
    vertices = np.asarray(basix.geometry(cell))
    dim = vertices.shape[1]
    facets = basix.topology(cell)[dim - 1]
    normals = np.asarray(basix.cell.facet_outward_normals(cell)).reshape(-1, dim)
    origins = np.array([vertices[facet[0]] for facet in facets])
    axes = np.array([[vertices[facet[1 + i]] - vertices[facet[0]] for i in range(dim - 1)] for facet in facets])
    areas = np.linalg.norm(axes[:, 0], axis=1) if dim == 2 else np.linalg.norm(np.cross(axes[:, 0], axes[:, 1]), axis=1)
    return _ReferenceFacets(origins, axes, normals, areas)


def _map(domain: dmesh.Mesh, cells: NDArray[np.int32], reference: Floats) -> tuple[Floats, Floats]:
    """x (n, dim) and the Jacobian (n, dim, dim) at points of the reference cell, one per cell."""
    table = compat.coordinate_map(domain).tabulate(1, reference)[:, :, :, 0]
    nodes = domain.geometry.x[compat.geometry_dofmap(domain)[cells]][:, :, : domain.topology.dim]
    # Seen from a corner of the cell, a small cell far from the origin loses no digits of its shape.
    corner = nodes[:, :1]
    # One product for all: the derivatives by the dim reference coordinates, and the point itself.
    mapped = np.matmul(np.swapaxes(nodes - corner, 1, 2), np.ascontiguousarray(np.moveaxis(table, 0, 2)))
    return mapped[:, :, 0] + corner[:, 0], mapped[:, :, 1:]
