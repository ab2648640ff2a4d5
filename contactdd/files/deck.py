"""Decks of Abaqus and CalculiX (.inp): nodes, elements, sets and surfaces.

All other keywords are passed over, and so are shells, beams, springs and the like.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..base.arrays import Floats, Integers
from .contents import Block, Contents, in_order
from .kinds import CORNERS, EDGES, SIDES, Kind, edge_order

#: Elements of continua by the letters of their type. Plane ones: plane strain, plane stress, of revolution, heat.
PLANE = ("CPE", "CPS", "CAX", "CPEG", "CGAX", "DC2D", "DCAX", "AC2D")
SOLID = ("C3D", "DC3D", "AC3D", "F3D", "D3")
SHAPES = {
    2: {3: "triangle", 4: "quadrilateral", 6: "triangle", 8: "quadrilateral", 9: "quadrilateral"},
    3: {
        4: "tetrahedron",
        5: "pyramid",
        6: "prism",
        8: "hexahedron",
        10: "tetrahedron",
        13: "pyramid",
        15: "prism",
        20: "hexahedron",
        27: "hexahedron",
    },
}

#: The ends of the edges, in the order in which a deck counts the nodes in their middles.
DECK_EDGES: dict[str, tuple[tuple[int, int], ...]] = {
    "triangle": EDGES["triangle"],
    "quadrilateral": EDGES["quadrilateral"],
    "tetrahedron": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    "hexahedron": (
        *((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6)),
        *((6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
    ),
}

#: Which nodes of a 27-node hexahedron of a deck, after the edges', are gmsh's: the deck's are the middle of the cell,
#: then of the sides S1 to S6.
DECK_MIDDLES = (1, 3, 6, 4, 5, 2, 0)


@dataclass
class Deck:
    """What has been read: nodes, elements by kind, sets by name as they stand in the deck."""

    source: str
    parts: int = 0
    numbers: list[int] = field(default_factory=list)
    x: list[list[float]] = field(default_factory=list)
    elements: dict[tuple[int, Kind], list[list[int]]] = field(default_factory=dict)
    others: set[str] = field(default_factory=set)
    sets: dict[str, dict[str, list[str | int]]] = field(default_factory=lambda: {"NSET": {}, "ELSET": {}})
    surfaces: dict[str, list[tuple[str, str]]] = field(default_factory=dict)
    node_surfaces: dict[str, list[str]] = field(default_factory=dict)


@dataclass(frozen=True)
class Card:
    """A keyword with its parameters, in capitals, and the lines of data under it."""

    keyword: str
    parameters: dict[str, str]
    lines: Sequence[str]


def read(path: Path, dim: int | None) -> Contents:
    """The contents of a deck. Names are in capitals, since decks do not tell them from small letters."""
    deck, _ = parsed(path)
    return contents(deck, max_dim(deck) if dim is None else dim)


def parsed(path: Path) -> tuple[Deck, list[Card]]:
    """The nodes, elements and sets of a deck, and all of its cards."""
    deck, cards = Deck(f"path = {str(path)!r}: the deck"), list(_cards(_lines(path, ())))
    for card in cards:
        _take(deck, card)
    return deck, cards


def max_dim(deck: Deck) -> int:
    """The dimension of the elements, 3 if there are solid ones."""
    dims = {each for each, _ in deck.elements}
    if not dims:
        others = f" (it has {', '.join(sorted(deck.others))})" if deck.others else ""
        raise ValueError(f"{deck.source} has no elements of the plane, of revolution or of space{others}")
    return max(dims)


# ------------------------------------------------------------------------------------------------------ the text


def _lines(path: Path, outer: tuple[Path, ...]) -> Iterator[str]:
    """The lines of a deck without comments, those of included files in their place."""
    if path in outer:
        raise ValueError(f"path = {str(path)!r}: the deck includes itself")
    if not path.is_file():
        raise ValueError(f"path = {str(outer[-1])!r}: the deck includes {path.name!r}, which is not there")
    for line in path.read_text(encoding="latin-1").splitlines():
        include = re.match(r"\s*\*\s*INCLUDE\s*,\s*INPUT\s*=\s*\"?([^,\"]+)", line, re.IGNORECASE)
        if include:
            yield from _lines(path.parent / include[1].strip(), (*outer, path))
        elif line.strip() and not line.lstrip().startswith("**"):
            yield line.strip()


def _cards(lines: Iterator[str]) -> Iterator[Card]:
    """The keywords of a deck, each with its data. A line of keywords that ends in a comma goes on in the next."""
    head, data = "", list[str]()
    for line in lines:
        if head.endswith(",") and not data and not line.startswith("*"):
            head += line
        elif line.startswith("*"):
            if head:
                yield _card(head, data)
            head, data = line, []
        else:
            data.append(line)
    if head:
        yield _card(head, data)


def _card(head: str, data: Sequence[str]) -> Card:
    keyword, *rest = (part.strip() for part in head[1:].split(","))
    pairs = (part.partition("=") for part in rest if part)
    parameters = {name.strip().upper().replace(" ", ""): value.strip().strip('"').upper() for name, _, value in pairs}
    return Card(re.sub(r"\s+", "", keyword).upper(), parameters, data)


def fields(line: str) -> list[str]:
    return [part.strip() for part in line.split(",")]


def number_of(word: str) -> float:
    """A real number, also one with Fortran's D for its exponent."""
    return float(word.upper().replace("D", "E"))


def _numbers(lines: Sequence[str]) -> list[str]:
    """The entries of lines that belong together, empty ones left out."""
    return [part for line in lines for part in fields(line) if part]


# ------------------------------------------------------------------------------------------------------ the cards


def _take(deck: Deck, card: Card) -> None:
    """Put what a keyword gives into the deck."""
    takers = {"NODE": _nodes, "ELEMENT": _elements, "NSET": _set, "ELSET": _set, "SURFACE": _surface}
    deck.parts += card.keyword == "PART"
    if deck.parts > 1 or (card.keyword == "INSTANCE" and card.lines):
        raise ValueError(f"{deck.source} has several parts, or moves one; write it flat, without parts and assemblies")
    if card.keyword in takers:
        try:
            takers[card.keyword](deck, card)
        except (ValueError, IndexError) as error:
            if str(error).startswith("path"):
                raise
            line = card.lines[0] if card.lines else ""
            raise ValueError(f"{deck.source} has a *{card.keyword} that cannot be read ({error}): {line!r}") from None


def _nodes(deck: Deck, card: Card) -> None:
    if card.parameters.get("SYSTEM", "R") not in ("R", ""):
        raise ValueError(f"{deck.source} has nodes in cylindrical coordinates; expected SYSTEM=R")
    new = []
    for line in card.lines:
        number, *words = fields(line)
        new.append(int(number))
        x = [number_of(word) if word else 0.0 for word in words[:3]]
        deck.numbers.append(new[-1])
        deck.x.append(x + [0.0] * (3 - len(x)))
    if "NSET" in card.parameters:
        deck.sets["NSET"].setdefault(card.parameters["NSET"], []).extend(new)


def _elements(deck: Deck, card: Card) -> None:
    found = _kind(card.parameters.get("TYPE", ""))
    if found is None:
        deck.others.add(card.parameters.get("TYPE", "elements without a type"))
        if "ELSET" in card.parameters:
            deck.sets["ELSET"].setdefault(card.parameters["ELSET"], [])
        return
    rows = list(_rows(card.lines, found[1].nodes + 1))
    deck.elements.setdefault(found, []).extend(rows)
    if "ELSET" in card.parameters:
        deck.sets["ELSET"].setdefault(card.parameters["ELSET"], []).extend(row[0] for row in rows)


def _rows(lines: Sequence[str], width: int) -> Iterator[list[int]]:
    """The number and the nodes of each element. Each begins a line and may go on in the next; what is over is left."""
    row: list[int] = []
    for line in lines:
        row += [int(entry) for entry in fields(line) if entry]
        if len(row) >= width:
            yield row[:width]
            row = []
    if row:
        raise ValueError(f"expected {width} numbers for an element, not {len(row)}")


def _kind(name: str) -> tuple[int, Kind] | None:
    """The dimension and kind of an element type such as CPE4R; None for beams, shells, gaps and the like."""
    parts = re.fullmatch(r"([A-Z]+\d?D|CPEG?|CPS|CGAX|DCAX|CAX)(\d+)[A-Z]*", name)
    if not parts:
        return None
    dim, count = 2 if parts[1] in PLANE else 3 if parts[1] in SOLID else 0, int(parts[2])
    if dim and count not in SHAPES[dim]:
        raise ValueError(f"elements of type {name} are not known here")
    return (dim, Kind(SHAPES[dim][count], count)) if dim else None


def _set(deck: Deck, card: Card) -> None:
    name = card.parameters.get(card.keyword)
    if not name:
        raise ValueError(f"expected a name, {card.keyword}=")
    if card.keyword == "NSET" and "ELSET" in card.parameters:
        raise ValueError("the nodes of an ELSET; expected the numbers of the nodes")
    entries = deck.sets[card.keyword].setdefault(name, [])
    if "GENERATE" in card.parameters:
        for line in card.lines:
            first, last, *step = (int(part) for part in fields(line) if part)
            entries.extend(range(first, last + 1, step[0] if step else 1))
    else:
        entries.extend(entry_of(part) for part in _numbers(card.lines))


def entry_of(text: str) -> str | int:
    """The number of a node or an element, or the name of a set."""
    return int(text) if text.lstrip("+-").isdigit() else text.strip('"').upper()


def _surface(deck: Deck, card: Card) -> None:
    name = card.parameters.get("NAME", "")
    if card.parameters.get("TYPE", "ELEMENT") == "NODE":
        deck.node_surfaces.setdefault(name, []).extend(fields(line)[0] for line in card.lines)
    else:
        pairs = [(*fields(line), "")[:2] for line in card.lines]
        deck.surfaces.setdefault(name, []).extend((a, b.upper()) for a, b in pairs)


# ----------------------------------------------------------------------------------------------- what it comes to


def contents(deck: Deck, dim: int) -> Contents:
    numbers, x = _last_nodes(deck)
    blocks = [
        _block(kind, np.array(rows, dtype=np.int64)) for (each, kind), rows in deck.elements.items() if each == dim
    ]
    cells = np.concatenate([np.zeros(0, dtype=np.int64), *(block.numbers for block in blocks)])
    bodies = {name: np.intersect1d(_members(deck, "ELSET", name), cells) for name in deck.sets["ELSET"]}
    surfaces = _skins(deck, blocks) if dim == 3 else {}
    surfaces |= {name: _faces(deck, name, parts, blocks) for name, parts in deck.surfaces.items()}
    nodes = {name: _members(deck, "NSET", name) for name in deck.sets["NSET"]}
    for name, parts in deck.node_surfaces.items():
        nodes[name] = np.unique(np.concatenate([of_set(deck, "NSET", entry_of(part), ()) for part in parts]))
    bodies = {name: members for name, members in bodies.items() if len(members)}
    return Contents(deck.source, dim, numbers, x, blocks, bodies, True, surfaces, nodes)


def _last_nodes(deck: Deck) -> tuple[Integers, Floats]:
    """The nodes; where one is given twice the later counts, as in the programs."""
    numbers, x = np.array(deck.numbers, dtype=np.int64), np.array(deck.x, dtype=float).reshape(-1, 3)
    ordered, last = np.unique(numbers[::-1], return_index=True)
    return in_order(deck.source, ordered, x[::-1][last])


def _block(kind: Kind, rows: Integers) -> Block:
    """Elements with their nodes in gmsh's order."""
    numbers, nodes = rows[:, 0], rows[:, 1:]
    corners = CORNERS[kind.shape]
    if kind.nodes > corners and kind.shape in DECK_EDGES:
        edges = corners + edge_order(kind.shape, DECK_EDGES[kind.shape])
        middles = DECK_MIDDLES if kind.nodes == 27 else range(kind.nodes - corners - len(edges))
        rest = [corners + len(edges) + place for place in middles]
        nodes = nodes[:, [*range(corners), *edges, *rest]]
    return Block(kind, numbers, nodes)


def _members(deck: Deck, which: str, name: str) -> Integers:
    return np.unique(of_set(deck, which, name, ()))


def of_set(deck: Deck, which: str, entry: str | int, outer: tuple[str | int, ...]) -> Integers:
    """The numbers that an entry stands for: itself, or all in the set of that name."""
    if isinstance(entry, int):
        return np.array([entry], dtype=np.int64)
    if entry not in deck.sets[which] or entry in outer:
        raise ValueError(f"{deck.source} has no {which} {entry!r} that does not contain itself")
    entries = deck.sets[which][entry]
    direct = np.array([each for each in entries if isinstance(each, int)], dtype=np.int64)
    named = [of_set(deck, which, each, (*outer, entry)) for each in entries if isinstance(each, str)]
    return np.concatenate([direct, *named])


def _skins(deck: Deck, solid: Sequence[Block]) -> dict[str, list[Integers]]:
    """The corner nodes of the plane elements on solid ones, by the ELSETs in which gmsh writes groups of faces."""
    plane = [_block(kind, np.array(rows, dtype=np.int64)) for (dim, kind), rows in deck.elements.items() if dim == 2]
    nodes = np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *(block.nodes.ravel() for block in solid)]))
    found: dict[str, list[Integers]] = {}
    for name in deck.sets["ELSET"] if plane else ():
        members = _members(deck, "ELSET", name)
        corners = [block.nodes[np.isin(block.numbers, members), : block.kind.corners] for block in plane]
        if any(map(len, corners)) and all(np.isin(each, nodes).all() for each in corners):
            found[name] = [each for each in corners if len(each)]
    return found


def _faces(deck: Deck, name: str, parts: Sequence[tuple[str, str]], blocks: Sequence[Block]) -> list[Integers]:
    """The corner nodes (n, corners) of the element faces of a *SURFACE."""
    found = []
    for entry, label in parts:
        elements = of_set(deck, "ELSET", entry_of(entry), ())
        for block in blocks:
            nodes = block.nodes[np.isin(block.numbers, elements)]
            if len(nodes):
                found.append(nodes[:, side(deck, name, label, block.kind)])
    return found


def side(deck: Deck, name: str, label: str, kind: Kind) -> list[int]:
    """The corners of the side S1, S2, ... of a cell."""
    sides = SIDES[kind.shape]
    number = int(label[1:]) if re.fullmatch(r"S\d", label) else 0
    if not 1 <= number <= len(sides):
        raise ValueError(
            f"{deck.source}: the *SURFACE {name!r} has the face {label!r} of {kind}; expected S1 to S{len(sides)}"
        )
    return list(sides[number - 1])
