"""Simplices cut into smaller ones, and where each of these lies in the one that it was cut from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import basix
import numpy as np
from dolfinx import fem
from dolfinx import mesh as dmesh

from . import compat
from .arrays import Floats, Integers


@dataclass(frozen=True)
class Split:
    """A finer mesh of n cells.

    domain: the dolfinx mesh; parents: (n,) the cell of the coarser mesh that each lies in; facets: (n, facets) the
    local facet of that cell in which each facet lies, −1 for those inside; corners: (n, dim + 1, dim) where the cell's
    corners are in the parent's reference cell.
    """

    domain: dmesh.Mesh
    parents: Integers
    facets: Integers
    corners: Floats


def split(domain: dmesh.Mesh, cells: Integers | None) -> Split:
    """The mesh with all edges of the given triangles or tetrahedra, or of all, cut in two, and what of their neighbours
    has to be cut so that cells meet corner to corner.

    A curved cell is cut in its reference cell: the finer mesh has the same shape, that of the coarser one.
    """
    element = compat.coordinate_map(domain)
    if element.degree == 1:
        return _split_straight(domain, cells)
    straight, order = _straightened(domain)
    places = np.argsort(order)  # where a cell of the curved mesh is in the straight one
    fine = _split_straight(straight, None if cells is None else np.sort(places[cells]).astype(np.int32))
    return _curved(domain, fine, order[fine.parents])


def _split_straight(domain: dmesh.Mesh, cells: Integers | None) -> Split:
    topology, dim = domain.topology, domain.topology.dim
    topology.create_entities(1)
    topology.create_connectivity(dim, 1)
    topology.create_connectivity(1, dim)
    edges = None if cells is None else dmesh.compute_incident_entities(topology, cells.astype(np.int32), dim, 1)
    fine, parents, facets = dmesh.refine(domain, edges, option=dmesh.RefinementOption.parent_cell_and_facet)
    # dolfinx numbers the new cells anew, not what it says of them.
    order = np.asarray(fine.topology.original_cell_index)
    parents = np.asarray(parents, dtype=np.int64)[order]
    facets = np.asarray(facets, dtype=np.int64).reshape(len(order), -1)[order]
    return Split(fine, parents, facets, _corners(domain, fine, parents))


def _corners(domain: dmesh.Mesh, fine: dmesh.Mesh, parents: Integers) -> Floats:
    """The corners of cells in the reference cells of those of a straight mesh in which they lie, (n, dim + 1, dim)."""
    dim = domain.topology.dim
    x = domain.geometry.x[compat.geometry_dofmap(domain)][parents, :, :dim]
    corners = fine.geometry.x[compat.geometry_dofmap(fine)][:, :, :dim]
    edges = np.swapaxes(x[:, 1:] - x[:, :1], 1, 2)
    reference = np.linalg.solve(edges, np.swapaxes(corners - x[:, :1], 1, 2)).swapaxes(1, 2)
    # Cells are cut in the middles of their edges, once or twice: the corners are at eighths.
    return np.rint(8 * reference) / 8


def _straightened(domain: dmesh.Mesh) -> tuple[dmesh.Mesh, Integers]:
    """The mesh of the corners of curved cells, and which of these each of its cells is."""
    element = compat.coordinate_map(domain)
    corners = len(np.asarray(basix.geometry(element.cell_type)))
    nodes, cells = np.unique(compat.geometry_dofmap(domain)[:, :corners], return_inverse=True)
    x = domain.geometry.x[nodes, : domain.topology.dim]
    made = compat.from_arrays(
        cells.reshape(-1, corners).astype(np.int64), x, compat.coordinate_element(element.cell_type.name, 1)
    )
    return made, np.asarray(made.topology.original_cell_index, dtype=np.int64)


def _curved(domain: dmesh.Mesh, fine: Split, parents: Integers) -> Split:
    """A split of the straightened mesh with its cells curved as the parents (n,) are."""
    ufl_element = domain.ufl_domain().ufl_coordinate_element()
    dim = domain.topology.dim
    dofmap = fem.functionspace(fine.domain, ufl_element).dofmap.list
    element = compat.coordinate_map(domain)
    at = within(fine.corners, element.points)
    table = element.tabulate(0, at.reshape(-1, dim))[0, :, :, 0].reshape(*at.shape[:2], -1)
    nodes = domain.geometry.x[compat.geometry_dofmap(domain)[parents], :dim]
    x = np.zeros((int(dofmap.max()) + 1, dim))
    x[dofmap] = np.einsum("npk,nkd->npd", table, nodes)
    made = compat.from_arrays(dofmap.astype(np.int64), x, ufl_element)
    order = np.asarray(made.topology.original_cell_index)
    return Split(made, parents[order], fine.facets[order], fine.corners[order])


def within(corners: Floats, points: Floats) -> Floats:
    """Points (p, dim) of the reference cell in the reference cells of the parents, (n, p, dim)."""
    edges = corners[:, 1:] - corners[:, :1]
    return corners[:, :1] + np.einsum("pk,nkd->npd", points, edges)


def values_within(element: Any, corners: Floats, points: Floats, values: Floats) -> Floats:
    """Functions of the parents at points (p, dim) of their children, (n, p, components).

    element: scalar; values: (n, nodes, components) the degrees of freedom of each child's parent.
    """
    at = within(corners, points)
    table = element.tabulate(0, at.reshape(-1, points.shape[1]))[0, :, :, 0].reshape(*at.shape[:2], -1)
    return np.einsum("npk,nkc->npc", table, values)
