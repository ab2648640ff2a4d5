"""Displacements at points of boundary facets: coordinates, normals, areas and the basis functions' values there.

Only normal displacements and normal tractions cross a contact. This file makes the sparse operator u ↦ u·n at any
points of any boundary facets: every element, degree and dimension by the same lines.
"""

from __future__ import annotations

from dataclasses import dataclass

import basix
import numpy as np
import scipy.sparse as sp
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
    reference, normal, area = _to_reference_cell(domain, entities[:, 1], points)
    element = compat.coordinate_map(domain)
    table = element.tabulate(1, reference)[:, :, :, 0]
    corners = domain.geometry.x[compat.geometry_dofmap(domain)[entities[:, 0]]][:, :, : domain.topology.dim]
    jacobian = np.einsum("jpn,pni->pij", table[1:], corners)
    # Nanson's formula: the reference normal and area become J⁻ᵀN and |det J| |J⁻ᵀN|.
    mapped = np.linalg.solve(np.swapaxes(jacobian, 1, 2), normal[:, :, None])[:, :, 0]
    length = np.linalg.norm(mapped, axis=1)
    return FacetPoints(
        entities[:, 0],
        reference,
        np.einsum("pn,pni->pi", table[0], corners),
        mapped / length[:, None],
        area * length * np.abs(np.linalg.det(jacobian)),
    )


def normal_trace(space: fem.FunctionSpace, points: FacetPoints, normal: Floats | None = None) -> sp.csr_matrix:
    """The sparse operator from the degrees of freedom of `space` to u·n at the points, (n, dofs).

    normal: (n, dim), another direction than the outward normal.
    """
    direction = points.normal if normal is None else normal
    basis = space.element.basix_element.tabulate(0, points.reference)[0, :, :, 0]
    dim, dofmap = space.dofmap.bs, space.dofmap
    values = basis[:, :, None] * direction[:, None, :]
    # Exact zeros (inner nodes, the components along a flat surface) must not become unknowns of the contact.
    values[np.abs(values) < 1e-14] = 0.0
    columns = dofmap.list[points.cells][:, :, None] * dim + np.arange(dim)
    rows = np.repeat(np.arange(len(basis)), values[0].size if len(basis) else 0)
    size = dim * (dofmap.index_map.size_local + dofmap.index_map.num_ghosts)
    operator = sp.csr_matrix((values.ravel(), (rows, columns.ravel())), shape=(len(basis), size))
    operator.eliminate_zeros()
    return operator


def _to_reference_cell(
    domain: dmesh.Mesh, local_facets: NDArray[np.int32], points: Floats
) -> tuple[Floats, Floats, Floats]:
    """Points, outward normals and facet areas in the reference cell."""
    cell = compat.coordinate_map(domain).cell_type
    dim = domain.topology.dim
    vertices, facets = basix.geometry(cell), basix.topology(cell)[dim - 1]
    normals = np.asarray(basix.cell.facet_outward_normals(cell)).reshape(-1, dim)
    origins = np.array([vertices[facet[0]] for facet in facets])
    axes = np.array([[vertices[facet[1 + i]] - vertices[facet[0]] for i in range(dim - 1)] for facet in facets])
    areas = np.linalg.norm(axes[:, 0], axis=1) if dim == 2 else np.linalg.norm(np.cross(axes[:, 0], axes[:, 1]), axis=1)
    reference = origins[local_facets] + np.einsum("pi,pij->pj", points, axes[local_facets])
    return reference, normals[local_facets], areas[local_facets]
