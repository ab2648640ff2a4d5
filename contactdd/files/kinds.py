"""Kinds of cells, their nodes in gmsh's order, and how nodes of other programs are brought into it.

Corners are counted around each face, as gmsh, Abaqus and VTK do; the nodes in the middle of edges follow, then those in
the middle of faces and of the cell.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..base.arrays import Floats, Integers


class Kind(NamedTuple):
    """A shape ("triangle", "hexahedron", ...) and the number of a cell's nodes."""

    shape: str
    nodes: int

    def __str__(self) -> str:
        return f"{self.nodes}-node {PLURALS.get(self.shape, self.shape + 's')}"

    @property
    def corners(self) -> int:
        """The number of corners."""
        return CORNERS[self.shape]


PLURALS = {"tetrahedron": "tetrahedra", "hexahedron": "hexahedra"}
CORNERS = {
    "interval": 2,
    "triangle": 3,
    "quadrilateral": 4,
    "tetrahedron": 4,
    "pyramid": 5,
    "prism": 6,
    "hexahedron": 8,
}

#: The corners of each side of a cell, in the order in which Abaqus and CalculiX number them S1, S2, ...
SIDES: dict[str, tuple[tuple[int, ...], ...]] = {
    "triangle": ((0, 1), (1, 2), (2, 0)),
    "quadrilateral": ((0, 1), (1, 2), (2, 3), (3, 0)),
    "tetrahedron": ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)),
    "pyramid": ((0, 1, 2, 3), (0, 4, 1), (1, 4, 2), (2, 4, 3), (3, 4, 0)),
    "prism": ((0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)),
    "hexahedron": ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)),
}

#: The ends of the edges, in the order in which gmsh counts the nodes in their middles.
EDGES: dict[str, tuple[tuple[int, int], ...]] = {
    "triangle": ((0, 1), (1, 2), (2, 0)),
    "quadrilateral": ((0, 1), (1, 2), (2, 3), (3, 0)),
    "tetrahedron": ((0, 1), (1, 2), (2, 0), (3, 0), (3, 2), (3, 1)),
    "hexahedron": (
        *((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3)),
        *((2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)),
    ),
}

#: The faces of a hexahedron, in the order in which gmsh counts the nodes in their middles.
HEXAHEDRON_FACES = ((0, 3, 2, 1), (0, 1, 5, 4), (0, 4, 7, 3), (1, 2, 6, 5), (2, 3, 7, 6), (4, 5, 6, 7))

#: The degree of the map of those cells that can be computed with.
DEGREES = {
    Kind("triangle", 3): 1,
    Kind("triangle", 6): 2,
    Kind("triangle", 10): 3,
    Kind("quadrilateral", 4): 1,
    Kind("quadrilateral", 9): 2,
    Kind("quadrilateral", 16): 3,
    Kind("tetrahedron", 4): 1,
    Kind("tetrahedron", 10): 2,
    Kind("tetrahedron", 20): 3,
    Kind("hexahedron", 8): 1,
    Kind("hexahedron", 27): 2,
}

#: Cells of second order without nodes in the middle of their faces, and those with them.
SERENDIPITY = {
    Kind("quadrilateral", 8): Kind("quadrilateral", 9),
    Kind("hexahedron", 20): Kind("hexahedron", 27),
}


def completed(kind: Kind, nodes: Integers, x: Floats) -> tuple[Kind, Integers, Floats]:
    """Cells of 8 or 20 nodes as cells of 9 or 27, which have the same shape: kind, nodes (cells, n) and x (nodes, 3).

    The new nodes lie where the map of the old ones takes the middles of faces and cells: a middle of a quadrilateral to
    Σ edges / 2 − Σ corners / 4, that of a hexahedron to Σ edges / 4 − Σ corners / 4. Other kinds are left as they are.
    """
    if kind not in SERENDIPITY:
        return kind, nodes, x
    if kind.shape == "quadrilateral":
        # A cell that a file has once for each of its groups has one middle.
        _, first, same = np.unique(np.sort(nodes, axis=1), axis=0, return_index=True, return_inverse=True)
        middles = (0.5 * x[nodes[:, 4:]].sum(axis=1) - 0.25 * x[nodes[:, :4]].sum(axis=1))[first]
        return SERENDIPITY[kind], np.hstack([nodes, len(x) + same.reshape(-1, 1)]), np.concatenate([x, middles])
    faces = nodes[:, np.array(HEXAHEDRON_FACES)].reshape(-1, 4)
    _, first, face = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_inverse=True)
    edges = nodes[:, 8 + _face_edges()].reshape(-1, 4)
    on_faces = (0.5 * x[edges].sum(axis=1) - 0.25 * x[faces].sum(axis=1))[first]
    middles = 0.25 * (x[nodes[:, 8:]].sum(axis=1) - x[nodes[:, :8]].sum(axis=1))
    of_cell = len(x) + len(first) + np.arange(len(nodes))
    nodes = np.hstack([nodes, len(x) + face.reshape(-1, 6), of_cell[:, None]])
    return SERENDIPITY[kind], nodes, np.concatenate([x, on_faces, middles])


def _face_edges() -> Integers:
    """The edges around each face of a hexahedron, (6, 4)."""
    sets = [set(edge) for edge in EDGES["hexahedron"]]
    rounds = [zip(face, face[1:] + face[:1], strict=True) for face in HEXAHEDRON_FACES]
    return np.array([[sets.index({a, b}) for a, b in ends] for ends in rounds])


def edge_order(shape: str, edges: tuple[tuple[int, int], ...]) -> Integers:
    """The order of a program's middle nodes, counted along `edges`, that is gmsh's: `gmsh = theirs[edge_order]`."""
    sets = [set(edge) for edge in edges]
    return np.array([sets.index(set(edge)) for edge in EDGES[shape]])
