"""Meshes of triangles whose nodes have moved, so that cells vary smoothly in size and are of good shape."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from dolfinx import mesh as dmesh
from numpy.typing import NDArray

from .base import compat
from .base.arrays import Floats, Integers
from .base.facets import facet_corners, facet_entities, facet_nodes
from .base.triangles import areas, inner_edges, rails, relaxed, snapped
from .mesh import Mesh

#: Flips and moves in turns: more make the error smaller by a hundredth only.
ROUNDS, SWEEPS = 5, 5
#: Passes of means over neighbours that take the noise out of wanted sizes.
PASSES = 5
#: Nodes of points are found to this part of the mesh's size.
NEAR = 1e-9


def smooths(mesh: Mesh) -> bool:
    """Whether a mesh is one of straight plane triangles, the only ones that can be smoothed."""
    element = compat.coordinate_map(mesh.domain)
    return mesh.domain.topology.cell_name() == "triangle" and element.degree == 1


def smoothed(mesh: Mesh, sizes: Floats, held: Floats, ends: Floats) -> Mesh:
    """A mesh of as many cells, with the same outline, parts and named surfaces, its cells of the wanted relative sizes.

    Args:
        mesh: Straight plane triangles.
        sizes: The sizes (cells,) that cells are wanted to have in relation to each other (length).
        held: Points (k, 2) of the outline where nodes stay (length).
        ends: Points (e, 2) of the outline where there shall be nodes (length).
    """
    x, cells = mesh.domain.geometry.x[:, :2], compat.geometry_dofmap(mesh.domain)
    edges, kinds = _outline(mesh, cells)
    outer = np.unique(edges)
    stay = outer[_nearest(x[outer], held, NEAR * mesh.size)]
    x, moved = snapped(x, cells, rails(x, edges, kinds, stay), ends)
    fixed = rails(x, edges, kinds, np.concatenate([stay, moved]))
    parts = _parts(mesh)
    x, made = relaxed(x, cells, parts, _density(x, cells, sizes), fixed, rounds=ROUNDS, sweeps=SWEEPS)
    return _made(mesh, x, made)


def outline_points(mesh: Mesh, but: Sequence[str]) -> Floats:
    """The corners (k, 2) of the outline's facets that do not belong to some named surfaces (length)."""
    facets = dmesh.exterior_facet_indices(mesh.domain.topology)
    others = np.setdiff1d(facets, np.concatenate([np.zeros(0, dtype=np.int32), *map(mesh.facets, but)]))
    return facet_corners(mesh.domain, facet_entities(mesh.domain, others.astype(np.int32))).reshape(-1, 2)


def _outline(mesh: Mesh, cells: Integers) -> tuple[Integers, Integers]:
    """The edges (k, 2) that no node may leave, and their kinds: by the names of surfaces, or between which parts."""
    one, two = inner_edges(cells)
    parts = _parts(mesh)
    between = parts[one // 3] != parts[two // 3]
    outer = np.setdiff1d(np.arange(cells.size), np.concatenate([one, two]))
    names = np.zeros(cells.size, dtype=np.int64)
    for index, name in enumerate(mesh.surfaces):
        cell, facet = mesh.entities(name).T
        names[3 * cell + facet] += 1 << index
    pairs = np.sort([parts[one // 3], parts[two // 3]], axis=0)[:, between]
    inside = -1 - pairs[0] * (int(parts.max()) + 1) - pairs[1]
    places = np.concatenate([outer, one[between]])
    ends = [cells[places // 3, (places % 3 + step) % 3] for step in (1, 2)]
    return np.stack(ends, axis=1), np.concatenate([names[outer], inside])


def _parts(mesh: Mesh) -> Integers:
    """A number for each cell, the same for cells of the same subdomains."""
    numbers = np.zeros(mesh.cells, dtype=np.int64)
    for index, cells in enumerate(mesh.subdomains.values()):
        numbers[cells] += 1 << index
    return np.unique(numbers, return_inverse=True)[1].reshape(-1)


def _nearest(x: Floats, points: Floats, within: float) -> Integers:
    """The nodes (n, 2) that lie nearest to each of the points, but for points that are further away than that."""
    distances = np.linalg.norm(points[:, None] - x, axis=2)
    near = distances.min(axis=1, initial=np.inf) <= within
    return np.unique(distances[near].argmin(axis=1))


def _density(x: Floats, cells: Integers, sizes: Floats) -> Floats:
    """The weights (n,) of centroids with which cells become of the wanted sizes h: h⁻⁴, smoothed from cell to cell."""
    area, logarithm = np.repeat(np.abs(areas(x, cells)), 3), np.log(sizes / sizes.max())
    for _ in range(PASSES):
        sums = [np.bincount(cells.ravel(), area * each, len(x)) for each in (np.repeat(logarithm, 3), 1.0)]
        at_nodes = sums[0] / sums[1]
        logarithm = at_nodes[cells].mean(axis=1)
    return np.asarray(np.exp(-4.0 * at_nodes))


def _made(mesh: Mesh, x: Floats, cells: Integers) -> Mesh:
    """The mesh of these nodes and cells, with the named surfaces and parts of another of the same outline."""
    domain = compat.from_arrays(cells, x, compat.coordinate_element("triangle", 1))
    domain.topology.create_connectivity(1, 2)
    facets = dmesh.exterior_facet_indices(domain.topology)
    nodes = np.asarray(domain.geometry.input_global_indices)[facet_nodes(domain, facet_entities(domain, facets))]
    here, n = _keys(nodes, len(x)), len(x)
    named = {name: _keys(facet_nodes(mesh.domain, mesh.entities(name)), n) for name in mesh.surfaces}
    surfaces = {name: facets[np.isin(here, keys)] for name, keys in named.items()}
    order = np.asarray(domain.topology.original_cell_index)
    parts = {name: np.flatnonzero(np.isin(order, own)).astype(np.int32) for name, own in mesh.subdomains.items()}
    return Mesh(domain, surfaces, mesh.left_out, parts)


def _keys(nodes: NDArray[np.int32], n: int) -> Integers:
    """A number for each pair of nodes (k, 2), whatever their order."""
    ends = np.sort(nodes.astype(np.int64), axis=1)
    return np.asarray(ends[:, 0] * n + ends[:, 1])
