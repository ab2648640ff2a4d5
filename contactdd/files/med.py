"""MED files of Salome and code_aster, which are HDF5: nodes, elements, and groups as families of either.

Names are filled up to 80 characters with blanks or zeros. Corners of solid cells go around the other way than gmsh's.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Integers
from .contents import Block, Contents, merged
from .deck import DECK_EDGES
from .kinds import EDGES, HEXAHEDRON_FACES, Kind

#: The dimension and kind of the elements by the name of their geometry.
KINDS = {
    "SE2": (1, Kind("interval", 2)),
    "SE3": (1, Kind("interval", 3)),
    "SE4": (1, Kind("interval", 4)),
    "TR3": (2, Kind("triangle", 3)),
    "TR6": (2, Kind("triangle", 6)),
    "TR7": (2, Kind("triangle", 7)),
    "QU4": (2, Kind("quadrilateral", 4)),
    "QU8": (2, Kind("quadrilateral", 8)),
    "QU9": (2, Kind("quadrilateral", 9)),
    "TE4": (3, Kind("tetrahedron", 4)),
    "T10": (3, Kind("tetrahedron", 10)),
    "PY5": (3, Kind("pyramid", 5)),
    "P13": (3, Kind("pyramid", 13)),
    "PE6": (3, Kind("prism", 6)),
    "P15": (3, Kind("prism", 15)),
    "P18": (3, Kind("prism", 18)),
    "HE8": (3, Kind("hexahedron", 8)),
    "H20": (3, Kind("hexahedron", 20)),
    "H27": (3, Kind("hexahedron", 27)),
}

#: The corners of solid cells in gmsh's order.
TURNED = {"tetrahedron": (0, 2, 1, 3), "hexahedron": (0, 3, 2, 1, 4, 7, 6, 5)}

#: The corners between which the further nodes of solid cells lie.
BETWEEN: dict[str, tuple[tuple[int, ...], ...]] = {
    "tetrahedron": DECK_EDGES["tetrahedron"],
    "hexahedron": (
        *DECK_EDGES["hexahedron"],
        *((0, 1, 2, 3), (0, 1, 4, 5), (1, 2, 5, 6), (2, 3, 6, 7), (3, 0, 7, 4), (4, 5, 6, 7)),
        tuple(range(8)),
    ),
}


def read(path: Path, dim: int | None) -> Contents:
    """The contents of the one mesh in a MED file of any version."""
    source = f"path = {str(path)!r}: the file"
    try:
        import h5py
    except ImportError:
        raise ValueError(
            f"path = {str(path)!r}: the format is MED file, which needs h5py; expected it installed "
            "(pip install h5py, on Debian python3-h5py), or the mesh saved as .unv or .msh"
        ) from None
    try:
        with h5py.File(path) as file:
            return _contents(source, file, dim)
    except (OSError, KeyError) as error:  # KeyError: what every MED file has is missing
        raise ValueError(f"{source} cannot be read as MED ({error})") from None


def _contents(source: str, file: Any, dim: int | None) -> Contents:
    name, mesh = _only(source, file["ENS_MAA"])
    x = _points(mesh["NOE"])
    families = file["FAS"].get(name, {})
    of_cells, of_nodes = _groups(families.get("ELEME", {})), _groups(families.get("NOEUD", {}))
    elements = list(_elements(source, mesh["MAI"]))
    dim = max([2, *(each for each, _, _ in elements)]) if dim is None else dim
    bodies = merged((group, block.numbers[ours]) for group, block, ours in _in_groups(elements, of_cells, dim))
    surfaces: dict[str, list[Integers]] = {}
    for group, block, ours in _in_groups(elements, of_cells, dim - 1):
        surfaces.setdefault(group, []).append(block.nodes[ours, : block.kind.corners])
    numbers, family = np.arange(1, len(x) + 1), _families(mesh["NOE"], len(x))
    sets = {group: numbers[np.isin(family, members)] for group, members in of_nodes.items()}
    blocks = [block for each, block, _ in elements if each == dim]
    return Contents(source, dim, numbers, x, blocks, bodies, True, surfaces, sets)


def _in_groups(
    elements: Sequence[tuple[int, Block, Integers]], groups: Mapping[str, Sequence[int]], dim: int
) -> Iterator[tuple[str, Block, NDArray[np.bool_]]]:
    """Each group that has elements of a dimension in a block: its name, the block and the mask of its elements."""
    for each, block, family in elements:
        for name, members in groups.items() if each == dim else ():
            ours = np.isin(family, members)
            if np.any(ours):
                yield name, block, ours


def _only(source: str, meshes: Any) -> tuple[str, Any]:
    """The name of the only mesh, and what it holds at its first step: files before version 3 have no steps."""
    if len(meshes) != 1:
        raise ValueError(f"{source} has {len(meshes)} meshes: {', '.join(meshes)}; expected one")
    ((name, mesh),) = meshes.items()
    if mesh.attrs.get("TYP", 0) == 1:
        raise ValueError(f"{source} has the mesh {name!r} on a grid; expected one of elements")
    return name, mesh if "NOE" in mesh else mesh[min(mesh, default="NOE")]


def _points(nodes: Any) -> Floats:
    """The coordinates (nodes, 3); those of one direction stand together in the file."""
    x = nodes["COO"][:].reshape(-1, int(nodes["COO"].attrs["NBR"])).T
    return np.hstack([x, np.zeros((len(x), 3 - x.shape[1]))])


def _families(of: Any, count: int) -> Integers:
    return of["FAM"][:] if "FAM" in of else np.zeros(count, dtype=np.int64)


def _groups(families: Any) -> dict[str, list[int]]:
    """The numbers of the families in each group."""
    found: dict[str, list[int]] = {}
    for family in families.values():
        for name in family["GRO/NOM"][:] if "GRO" in family else ():
            found.setdefault(_text(np.asarray(name, dtype=np.int8).tobytes()), []).append(int(family.attrs["NUM"]))
    return found


def _text(name: bytes) -> str:
    name = name.rstrip(b"\0 ")
    try:
        return name.decode()
    except UnicodeDecodeError:
        return name.decode("latin-1")


def _elements(source: str, kinds: Any) -> Iterator[tuple[int, Block, Integers]]:
    """The dimension, the elements and their families, of each kind; all are numbered through."""
    first = 1
    for geometry, of in kinds.items():
        if geometry == "PO1":
            continue
        if geometry not in KINDS:
            raise ValueError(f"{source} has elements of the geometry {geometry}, which are not known here")
        dim, kind = KINDS[geometry]
        nodes = of["NOD"][:].reshape(kind.nodes, -1).T.astype(np.int64)
        numbers = np.arange(first, first + len(nodes))
        first += len(nodes)
        yield dim, Block(kind, numbers, nodes[:, _order(kind)]), _families(of, len(nodes))


def _order(kind: Kind) -> list[int]:
    """The places of a cell's nodes in gmsh's order."""
    if kind.shape not in TURNED:
        return list(range(kind.nodes))
    corners = TURNED[kind.shape]
    solid = [*EDGES[kind.shape], *(HEXAHEDRON_FACES if kind.shape == "hexahedron" else ()), tuple(range(kind.corners))]
    theirs = [set(each) for each in BETWEEN[kind.shape]]
    middles = [theirs.index({corners[corner] for corner in each}) for each in solid[: kind.nodes - kind.corners]]
    return [*corners, *(kind.corners + place for place in middles)]
