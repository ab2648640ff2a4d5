"""Bulk data of Nastran (.bdf, .nas, .dat): nodes and elements; properties' numbers name bodies and surfaces.

Fields of 8, of 16 and between commas; continued lines; numbers such as 1.5-3. All other entries are passed over.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..base.arrays import Integers
from .contents import Block, Contents, in_order, merged
from .kinds import CORNERS, EDGES, Kind, edge_order

#: The dimension of the elements, and their shape; two-node ones are sides of plane cells.
ELEMENTS = {
    "CTRIA3": (2, "triangle"),
    "CTRIAR": (2, "triangle"),
    "CTRIA6": (2, "triangle"),
    "CQUAD4": (2, "quadrilateral"),
    "CQUADR": (2, "quadrilateral"),
    "CQUAD8": (2, "quadrilateral"),
    "CTETRA": (3, "tetrahedron"),
    "CPYRAM": (3, "pyramid"),
    "CPENTA": (3, "prism"),
    "CHEXA": (3, "hexahedron"),
    "CBAR": (1, "interval"),
    "CBEAM": (1, "interval"),
    "CROD": (1, "interval"),
}
#: The nodes of elements of second order.
FULL = {
    "triangle": 6,
    "quadrilateral": 8,
    "tetrahedron": 10,
    "pyramid": 13,
    "prism": 15,
    "hexahedron": 20,
}
#: The ends of the edges, in the order in which Nastran counts the nodes in their middles.
NASTRAN_EDGES: dict[str, tuple[tuple[int, int], ...]] = {
    "triangle": EDGES["triangle"],
    "quadrilateral": EDGES["quadrilateral"],
    "tetrahedron": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    "hexahedron": (
        *((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 5)),
        *((2, 6), (3, 7), (4, 5), (5, 6), (6, 7), (7, 4)),
    ),
}


@dataclass
class _Bulk:
    """What has been read: nodes, and elements (number, property, nodes) by dimension and kind."""

    source: str
    numbers: list[int] = field(default_factory=list)
    x: list[list[float]] = field(default_factory=list)
    elements: dict[tuple[int, Kind], list[tuple[int, int, list[int]]]] = field(default_factory=dict)


def read(path: Path, dim: int | None) -> Contents:
    """The contents of a file of bulk data."""
    bulk = _Bulk(f"path = {str(path)!r}: the file")
    for entry in _entries(path):
        try:
            _take(bulk, entry)
        except (ValueError, IndexError) as error:
            if str(error).startswith("path"):
                raise
            raise ValueError(f"{bulk.source} has an entry that cannot be read ({error}): {entry[:4]}") from None
    dims = [each for each, _ in bulk.elements if each > 1]
    if not dims:
        raise ValueError(f"{bulk.source} has no elements of the plane or of space")
    return _contents(bulk, max(dims) if dim is None else dim)


def _entries(path: Path) -> Iterator[list[str]]:
    """The entries: the name and all fields, continued lines put together."""
    entry: list[str] = []
    for line in path.read_text(encoding="latin-1").expandtabs(8).splitlines():
        text = line.split("$")[0].rstrip()
        if not text.strip():
            continue
        name, fields = _fields(text)
        if entry and (not name or name[0] in "+*"):
            entry += fields
            continue
        if entry:
            yield entry
        entry = [name.rstrip("*"), *fields]
    if entry:
        yield entry


def _fields(text: str) -> tuple[str, list[str]]:
    """The first field of a line, and those of data, as many as the line has room for."""
    if "," in text:
        name, *fields = (part.strip() for part in text.split(","))
        return name.upper(), (fields + [""] * 8)[:8]
    name = text[:8].strip().upper()
    width, count = (16, 4) if "*" in name else (8, 8)
    return name, [text[8 + width * i : 8 + width * (i + 1)].strip() for i in range(count)]


def _number(text: str) -> float:
    """A real number, also one with an exponent without its letter; nothing is zero."""
    return float(re.sub(r"(?<=[\d.])([+-]\d+)$", r"E\1", text.upper().replace("D", "E"))) if text else 0.0


def _take(bulk: _Bulk, entry: list[str]) -> None:
    """Put a node or an element into what has been read."""
    name, *fields = entry
    if name == "INCLUDE":
        raise ValueError(f"{bulk.source} includes another; expected one file that has all")
    if name in ("GRID", "GRDSET") and fields[1] not in ("", "0"):
        raise ValueError(f"{bulk.source} has nodes in the coordinate system {fields[1]}; expected the basic one, 0")
    if name == "GRID":
        bulk.numbers.append(int(fields[0]))
        bulk.x.append([_number(text) for text in fields[2:5]])
    elif name in ELEMENTS:
        dim, shape = ELEMENTS[name]
        most = CORNERS[shape] if name[-1] in "34R" else FULL.get(shape, 2)  # angles and offsets may follow
        nodes = [int(text) if text else 0 for text in fields[2 : 2 + most]]
        corners = CORNERS[shape]
        middles = [node for node in nodes[corners:] if node]
        if middles and len(middles) != most - corners:
            raise ValueError(f"{bulk.source} has the element {fields[0]}, which lacks some of the nodes of its edges")
        number, group = int(fields[0]), int(fields[1] or fields[0])
        kind = Kind(shape, most if middles else corners)
        bulk.elements.setdefault((dim, kind), []).append((number, group, nodes[: kind.nodes]))


def _contents(bulk: _Bulk, dim: int) -> Contents:
    numbers, x = in_order(bulk.source, np.array(bulk.numbers, dtype=np.int64), np.array(bulk.x).reshape(-1, 3))
    cells = {kind: rows for (each, kind), rows in bulk.elements.items() if each == dim}
    sides = {kind: rows for (each, kind), rows in bulk.elements.items() if each == dim - 1}
    bodies = merged(pair for rows in cells.values() for pair in _by_property(rows, [row[0] for row in rows]))
    surfaces: dict[str, list[Integers]] = {}
    for kind, rows in sides.items():
        for name, corners in _by_property(rows, [row[2][: kind.corners] for row in rows]):
            surfaces.setdefault(name, []).append(corners)
    blocks = [_block(kind, rows) for kind, rows in cells.items()]
    return Contents(bulk.source, dim, numbers, x, blocks, bodies, True, surfaces)


def _by_property(rows: list[tuple[int, int, list[int]]], values: list[Any]) -> Iterator[tuple[str, Integers]]:
    """The values of elements, one each, by the number of their property."""
    groups, array = np.array([group for _, group, _ in rows]), np.array(values, dtype=np.int64)
    for group in np.unique(groups):
        yield str(group), array[groups == group]


def _block(kind: Kind, rows: list[tuple[int, int, list[int]]]) -> Block:
    """Elements with their nodes in gmsh's order."""
    nodes = np.array([each for _, _, each in rows], dtype=np.int64)
    if kind.nodes > kind.corners and kind.shape in NASTRAN_EDGES:
        order = kind.corners + edge_order(kind.shape, NASTRAN_EDGES[kind.shape])
        nodes = nodes[:, [*range(kind.corners), *order]]
    return Block(kind, np.array([number for number, _, _ in rows], dtype=np.int64), nodes)
