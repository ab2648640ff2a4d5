"""Cells cut into triangles or tetrahedra, without new corners, where a body has cells of several kinds.

Sides of four corners are cut from their node of the smallest number, so that cells cut them alike on both sides.
"""

from __future__ import annotations

from collections.abc import Set

import numpy as np

from ..base.arrays import Floats, Integers
from ..base.triangles import areas
from .kinds import SIDES, Kind

TRIANGLES = {1: Kind("triangle", 3), 2: Kind("triangle", 6)}
TETRAHEDRA = Kind("tetrahedron", 4)
#: What is cut: quadrilaterals by their degree, and solid cells.
QUADRILATERALS = {
    1: {Kind("quadrilateral", 4)},
    2: {Kind("quadrilateral", 8), Kind("quadrilateral", 9)},
}
SOLIDS = {Kind("pyramid", 5), Kind("prism", 6), Kind("hexahedron", 8)}

#: The nodes of the two halves of a quadrilateral of 9 nodes, cut from the corner 0 and from the corner 1.
HALVES = (((0, 1, 2, 4, 5, 8), (0, 2, 3, 8, 6, 7)), ((0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 6, 8)))


def simplex_of(kinds: Set[Kind]) -> Kind | None:
    """The kind into which cells of these kinds are cut; None where they are of one kind or cannot be cut."""
    for degree, triangles in TRIANGLES.items():
        others = kinds - {triangles}
        if triangles in kinds and others and others <= QUADRILATERALS[degree]:
            return triangles
    if kinds and kinds <= SOLIDS | {TETRAHEDRA} and kinds not in ({TETRAHEDRA}, {Kind("hexahedron", 8)}):
        return TETRAHEDRA
    return None


def halves(nodes: Integers, x: Floats) -> Integers:
    """The triangles (2 · cells, 3 or 6) of quadrilaterals (cells, 4 or 9), each cut so that its smaller half is larger.

    Where both cuts are alike, as in a square, it is the one through the node of the smallest number.
    """
    both = np.array([[areas(x[:, :2], nodes[:, half[:3]]) for half in cut] for cut in HALVES])
    smaller = (both * np.sign(both[0].sum(axis=0))).min(axis=1)
    alike = np.abs(smaller[0] - smaller[1]) <= 1e-6 * smaller.max(axis=0)
    return _cut(nodes, np.where(alike, _from_first(nodes), smaller[0] > smaller[1]))


def side_halves(nodes: Integers) -> Integers:
    """The triangles (2 · sides, 3) of sides of four corners (sides, 4)."""
    return _cut(nodes, _from_first(nodes))


def tetrahedra(kind: Kind, nodes: Integers) -> tuple[Integers, Integers]:
    """The tetrahedra (n, 4) of solid cells (cells, corners), and the cell of each (n,).

    Each cell is cut from its node of the smallest number towards the sides that do not have it. Where the sides of the
    cell turn alike, all tetrahedra of a cell turn the same way.
    """
    first = np.argmin(nodes, axis=1)
    found, owners = [], []
    for corner in range(kind.corners):
        cells = np.flatnonzero(first == corner)
        for side in SIDES[kind.shape]:
            if corner not in side:
                corners = nodes[cells][:, side]
                triangles, count = (corners, 1) if len(side) == 3 else (side_halves(corners), 2)
                owners.append(np.repeat(cells, count))
                found.append(np.column_stack([triangles, np.repeat(nodes[cells, corner], count)]))
    order = np.argsort(np.concatenate(owners), kind="stable")
    return np.concatenate(found)[order], np.concatenate(owners)[order]


def turned_over(tetrahedra: Floats, owners: Integers) -> int:
    """The number of cells whose tetrahedra, given by their corners (n, 4, 3), do not all turn the same way."""
    volumes = np.linalg.det(tetrahedra[:, 1:] - tetrahedra[:, :1])
    count = owners.max() + 1
    positive, negative = (np.bincount(owners, sign * volumes > 0, minlength=count) for sign in (1, -1))
    return int(np.sum((positive > 0) == (negative > 0)))


def _from_first(nodes: Integers) -> Integers:
    """The mask of those cells or sides of four corners whose cut through the smallest number goes from the corner 0."""
    return np.argmin(nodes[:, :4], axis=1) % 2 == 0


def _cut(nodes: Integers, from_first: Integers) -> Integers:
    count = 3 if nodes.shape[1] == 4 else 6
    one, other = (nodes[:, [half[:count] for half in cut]] for cut in HALVES)
    return np.where(from_first[:, None, None], one, other).reshape(-1, count)
