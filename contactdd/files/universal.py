"""Universal files (.unv) of I-deas, Salome and others: nodes, elements and named groups."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..base.arrays import Integers
from .contents import Block, Contents, in_order, merged
from .kinds import CORNERS, EDGES, Kind

NODES, NODES_IN_A_LINE, ELEMENTS = ("2411", "781"), ("15",), ("2412", "780")
GROUPS = ("2429", "2430", "2432", "2435", "2452", "2467", "2477")

#: Elements with a record of their own about the cross section.
BEAMS = (11, 21, 22, 23, 24)

#: Element types by their number: for plane ones and shells the last digit tells the shape.
FLAT = {1: Kind("triangle", 3), 2: Kind("triangle", 6), 4: Kind("quadrilateral", 4), 5: Kind("quadrilateral", 8)}
SOLID = {
    111: Kind("tetrahedron", 4),
    112: Kind("prism", 6),
    113: Kind("prism", 15),
    115: Kind("hexahedron", 8),
    116: Kind("hexahedron", 20),
    118: Kind("tetrahedron", 10),
}
LINES = {2: Kind("interval", 2), 3: Kind("interval", 3)}

#: Cells of second order go around each layer from corner to middle to corner: the corners that a node lies between.
AROUND: dict[Kind, tuple[tuple[int, ...], ...]] = {
    Kind("interval", 3): ((0,), (0, 1), (1,)),
    Kind("triangle", 6): ((0,), (0, 1), (1,), (1, 2), (2,), (2, 0)),
    Kind("quadrilateral", 8): ((0,), (0, 1), (1,), (1, 2), (2,), (2, 3), (3,), (3, 0)),
    Kind("tetrahedron", 10): ((0,), (0, 1), (1,), (1, 2), (2,), (2, 0), (0, 3), (1, 3), (2, 3), (3,)),
    Kind("hexahedron", 20): (
        *((0,), (0, 1), (1,), (1, 2), (2,), (2, 3), (3,), (3, 0)),
        *((0, 4), (1, 5), (2, 6), (3, 7)),
        *((4,), (4, 5), (5,), (5, 6), (6,), (6, 7), (7,), (7, 4)),
    ),
}


@dataclass
class _Read:
    """What has been read: nodes, elements by dimension and kind, groups of nodes (code 7) and elements (code 8)."""

    numbers: list[int] = field(default_factory=list)
    x: list[list[float]] = field(default_factory=list)
    elements: dict[tuple[int, Kind], list[list[int]]] = field(default_factory=dict)
    groups: list[tuple[str, list[int], list[int]]] = field(default_factory=list)


def read(path: Path, dim: int | None) -> Contents:
    """The contents of a universal file; datasets of other numbers are passed over."""
    source, found = f"path = {str(path)!r}: the file", _Read()
    for number, lines in _datasets(path.read_text(encoding="latin-1").splitlines()):
        try:
            _take(found, number, lines)
        except (ValueError, IndexError) as error:
            raise ValueError(f"{source} has a dataset {number} that cannot be read ({error})") from None
    dims = [each for each, _ in found.elements]
    return _contents(source, found, max([2, *dims]) if dim is None else dim)


def _datasets(lines: Sequence[str]) -> Iterator[tuple[str, list[str]]]:
    """The number and the lines of each dataset, which lines of −1 enclose."""
    inside: list[str] | None = None
    for line in lines:
        if line.strip() == "-1":
            if inside:
                yield inside[0].strip(), inside[1:]
            inside = [] if inside is None else None
        elif inside is not None:
            inside.append(line)


def _take(found: _Read, number: str, lines: list[str]) -> None:
    if number in NODES:
        for first, second in zip(lines[::2], lines[1::2], strict=True):
            found.numbers.append(int(first.split()[0]))
            found.x.append(_floats(second.split()))
    elif number in NODES_IN_A_LINE:
        for line in lines:
            found.numbers.append(int(line.split()[0]))
            found.x.append(_floats(line.split()[4:7]))
    elif number in ELEMENTS:
        _elements(found, iter(lines))
    elif number in GROUPS:
        _groups(found, iter(lines))


def _floats(words: Sequence[str]) -> list[float]:
    x = [float(word.upper().replace("D", "E")) for word in words]
    if len(x) != 3:
        raise ValueError(f"expected three coordinates, not {len(x)}")
    return x


def _elements(found: _Read, lines: Iterator[str]) -> None:
    for line in lines:
        number, code, *_, count = (int(word) for word in line.split()[:6])
        if code in BEAMS:
            next(lines, "")
        nodes: list[int] = []
        while len(nodes) < count:
            nodes += [int(word) for word in next(lines, "no more lines").split()]
        dim, kind = _kind(code, count)
        if kind is not None:
            found.elements.setdefault((dim, kind), []).append([number, *nodes])


def _kind(code: int, count: int) -> tuple[int, Kind | None]:
    """The dimension and kind of an element type; None for springs, masses and the like."""
    if code in BEAMS:
        return 1, LINES.get(count)
    dim = 2 if 40 < code < 100 else 3 if 110 < code < 120 else 0
    kind = FLAT.get(code % 10) if dim == 2 else SOLID.get(code)
    if dim and (kind is None or kind.nodes != count):
        raise ValueError(f"elements of type {code} with {count} nodes are not known here")
    return dim, kind


def _groups(found: _Read, lines: Iterator[str]) -> None:
    for line in lines:
        count, name = int(line.split()[-1]), next(lines, "").strip()
        entries: list[int] = []
        while len(entries) < 4 * count:
            entries += [int(word) for word in next(lines, "no more lines").split()]
        pairs = list(zip(entries[::4], entries[1::4], strict=True))
        of = {code: [number for each, number in pairs if each == code] for code in (7, 8)}
        found.groups.append((name or line.split()[0], of[7], of[8]))


def _contents(source: str, found: _Read, dim: int) -> Contents:
    blocks: dict[int, list[Block]] = {each: [] for each in (1, 2, 3)}
    for (each, kind), rows in found.elements.items():
        blocks[each].append(_block(kind, np.array(rows, dtype=np.int64)))
    cells = np.concatenate([np.zeros(0, dtype=np.int64), *(block.numbers for block in blocks[dim])])
    bodies = merged((name, np.intersect1d(elements, cells)) for name, _, elements in found.groups)
    sets = merged((name, np.array(nodes, dtype=np.int64)) for name, nodes, _ in found.groups)
    surfaces: dict[str, list[Integers]] = {}
    for name, _, elements in found.groups:
        for block in blocks[dim - 1]:
            corners = block.nodes[np.isin(block.numbers, elements), : block.kind.corners]
            if len(corners):
                surfaces.setdefault(name.strip(), []).append(corners)
    bodies, sets = ({name: each for name, each in groups.items() if len(each)} for groups in (bodies, sets))
    numbers, x = in_order(source, np.array(found.numbers), np.array(found.x, dtype=float).reshape(-1, 3))
    return Contents(source, dim, numbers, x, blocks[dim], bodies, True, surfaces, sets)


def _block(kind: Kind, rows: Integers) -> Block:
    """Elements with their nodes in gmsh's order."""
    nodes = rows[:, 1:]
    if kind in AROUND:
        places = {frozenset(between): place for place, between in enumerate(AROUND[kind])}
        corners = [frozenset([corner]) for corner in range(CORNERS[kind.shape])]
        edges = [frozenset(edge) for edge in EDGES.get(kind.shape, ((0, 1),))]
        nodes = nodes[:, [places[each] for each in corners + edges]]
    return Block(kind, rows[:, 0], nodes)
