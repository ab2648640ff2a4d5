"""The conformity of meshes, from plain arrays: shared facets, loose pieces, hanging nodes.

Corners of cells are counted as basix counts them.
"""

from __future__ import annotations

from collections.abc import Iterator

import basix
import numpy as np

from .arrays import Floats, Integers


def side_corners(cell: str, corners: Integers, dim: int) -> Integers:
    """The corners, in increasing order, of every cell's sides of a dimension: (cells, sides, corners of a side)."""
    sides = np.array(basix.topology(basix.CellType[cell])[dim])
    return np.sort(corners[:, sides], axis=2)


def numbered(rows: Integers) -> Integers:
    """A number (n,) for each of n rows, the same for equal rows, counted from 0 in lexicographic order."""
    order = np.lexsort(rows.T[::-1])
    in_order = rows[order]
    numbers = np.empty(len(rows), dtype=np.int64)
    numbers[order] = np.concatenate([[0], np.cumsum(np.any(in_order[1:] != in_order[:-1], axis=1))])[: len(rows)]
    return numbers


def pieces(corners: Integers) -> Integers:
    """For each cell (cells, corners) the number of the piece that it belongs to; different pieces share no corner."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    cells, each = corners.shape
    links = coo_matrix(
        (np.ones(corners.size, dtype=bool), (np.repeat(np.arange(cells), each), cells + corners.ravel())),
        shape=(cells + int(corners.max()) + 1,) * 2,
    )
    _, labels = connected_components(links, directed=False)
    return np.unique(labels[:cells], return_inverse=True)[1].reshape(-1)


def ring_edges(rings: Integers) -> Integers:
    """The edges (edges, 2), each once, of facets whose corners (facets, corners) are in order around each."""
    if rings.shape[1] == 2:
        return np.unique(np.sort(rings, axis=1), axis=0)
    ends = np.stack([rings, np.roll(rings, -1, axis=1)], axis=2).reshape(-1, 2)
    return np.unique(np.sort(ends, axis=1), axis=0)


def hanging_nodes(edges: Integers, x: Floats) -> Integers:
    """The nodes in the middle of an edge of the boundary whose two ends they join; edges: (edges, 2), x: (nodes, 3).

    A hanging node lies on an outer edge of a cell, and outer edges of smaller cells run over it from one end to the
    other. Nodes of a crack or of a body that only touches lie there too, but end elsewhere.
    """
    from scipy.spatial import cKDTree

    nodes = np.unique(edges)
    tree = cKDTree(x[nodes])
    start, end = x[edges[:, 0]], x[edges[:, 1]]
    length = np.linalg.norm(end - start, axis=1)
    middle, reach = 0.5 * (start + end), 0.5 * length * (1 + 1e-9)
    crowded = np.flatnonzero(tree.query_ball_point(middle, reach, return_length=True) > 2)
    found: set[int] = set()
    known: set[tuple[int, int]] = set()
    for edge, near in zip(crowded, tree.query_ball_point(middle[crowded], reach[crowded]), strict=True):
        inside = _between(x, edges[edge], nodes[near])
        if len(inside):
            known = known or {(int(a), int(b)) for a, b in edges}
            found.update(_chain(inside, edges[edge], known))
    return np.array(sorted(found), dtype=np.int64)


def _between(x: Floats, edge: Integers, nodes: Integers) -> Integers:
    """Those of some nodes that lie inside an edge, from its start to its end."""
    along = x[edge[1]] - x[edge[0]]
    offset = x[nodes] - x[edge[0]]
    position = offset @ along / (along @ along)
    away = np.linalg.norm(offset - position[:, None] * along, axis=1)
    # Files may have rounded coordinates to seven digits.
    inside = (away <= 1e-6 * np.linalg.norm(along)) & (position > 1e-6) & (position < 1 - 1e-6)
    return nodes[inside][np.argsort(position[inside])]


def _chain(inside: Integers, edge: Integers, known: set[tuple[int, int]]) -> Iterator[int]:
    """The nodes inside an edge, in order, by which known edges lead from its start to its end."""
    start, end = (int(node) for node in edge)
    reached = {start: [start]}
    for node in [int(node) for node in inside] + [end]:
        for last in list(reached):
            if last != node and (min(last, node), max(last, node)) in known and (last, node) != (start, end):
                reached[node] = reached[last] + [node]
    yield from reached.get(end, [])[1:-1]
