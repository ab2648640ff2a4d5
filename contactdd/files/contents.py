"""Nodes, cells and named groups as arrays, whatever program wrote them, and the meshes that they make."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from warnings import warn

import numpy as np
from numpy.typing import NDArray

from ..base import compat
from ..base.arrays import Floats, Integers
from ..base.checks import listed
from ..base.conformity import numbered, side_corners
from ..errors import ContactWarning
from ..mesh import Mesh, from_arrays, inside_the_body
from . import simplices
from .kinds import DEGREES, SERENDIPITY, SIDES, Kind, completed


@dataclass(frozen=True)
class Block:
    """Cells of one kind: their numbers (cells,) and the numbers of their nodes (cells, nodes) in gmsh's order."""

    kind: Kind
    numbers: Integers
    nodes: Integers


class KindError(ValueError):
    """Cells of several kinds in a body, or of one that cannot be computed with."""


@dataclass(frozen=True)
class Contents:
    """The nodes, cells and groups that a file or a model holds.

    source: its name in messages; dim: the dimension of the cells; numbers: (nodes,) increasing; x: (nodes, 3); blocks:
    the cells; bodies: {name: numbers of cells}; all_cells: whether cells in no group are taken too where no group is
    asked for; surfaces: {name: corner nodes of facets, arrays (facets, corners)}; node_sets: {name: numbers of nodes},
    each the surface of those outer facets whose corners are all in it.
    """

    source: str
    dim: int
    numbers: Integers
    x: Floats
    blocks: Sequence[Block]
    bodies: Mapping[str, Integers] = field(default_factory=dict)
    all_cells: bool = False
    surfaces: Mapping[str, Sequence[Integers]] = field(default_factory=dict)
    node_sets: Mapping[str, Integers] = field(default_factory=dict)

    def mesh(self, body: str | None = None) -> Mesh:
        """The mesh of one group of cells, by default of all cells in groups, or of all where there are no groups.

        Raises ValueError where the cells cannot be computed with: before dolfinx is called, which does not check.
        """
        blocks = self._blocks(body)
        whose = "" if body is None else f" in the group {body!r}"
        kinds = {block.kind for block in blocks}
        simplex = simplices.simplex_of(kinds)
        if simplex is None:
            return self._made(blocks, whose)
        if self.dim == 3:
            self._check_cuts(blocks)
        cut = self._in_triangles if self.dim == 2 else self._in_tetrahedra
        mesh = cut._made(cut._blocks(body), whose)
        warn(
            f"{self.source} has {_listed(kinds)}{whose}, which are cut into {simplex}: a body here has cells of one "
            "kind, and no prisms or pyramids",
            ContactWarning,
            stacklevel=3,
        )
        return mesh

    def _made(self, blocks: Sequence[Block], whose: str) -> Mesh:
        """The mesh of cells of one kind."""
        kind, nodes, subdomains = self._cells(blocks, whose)
        self._check_nodes(kind, nodes)
        kind, nodes, x = completed(kind, np.searchsorted(self.numbers, nodes), self.x)
        nodes = nodes[:, compat.from_gmsh_order(*kind)]
        corners = nodes[:, : kind.corners]
        facets, owners = self._facets(kind, corners)
        used, cells = np.unique(nodes, return_inverse=True)
        x, cells = x[used], cells.reshape(nodes.shape)
        self._check_coordinates(used, x)
        surfaces, left_out = self._surfaces(facets, owners, kind)
        element = compat.coordinate_element(kind.shape, DEGREES[kind])
        return from_arrays(cells, x[:, : self.dim], element, surfaces, left_out, subdomains)

    def _blocks(self, body: str | None) -> list[Block]:
        """The cells of a body."""
        if body is not None and body not in self.bodies:
            raise ValueError(
                f"body = {body!r}: {self.source} has no such group of cells (it has {listed(self.bodies)})"
            )
        chosen = self._chosen(body)
        wanted = [np.isin(block.numbers, chosen) for block in self.blocks]
        blocks = [
            Block(each.kind, each.numbers[ours], each.nodes[ours])
            for each, ours in zip(self.blocks, wanted, strict=True)
            if np.any(ours)
        ]
        if not blocks:
            raise ValueError(f"{self.source} has no cells of dimension {self.dim}")
        return blocks

    def _cells(self, blocks: Sequence[Block], whose: str) -> tuple[Kind, Integers, dict[str, Integers]]:
        """The kind and nodes of cells, each cell once, and which of them are in each group."""
        self._check_kinds([block.kind for block in blocks], whose)
        kind = blocks[0].kind
        nodes, numbers = (np.concatenate([getattr(each, part) for each in blocks]) for part in ("nodes", "numbers"))
        # A cell in several groups is one cell, also where the file has it once for each.
        _, first, same = np.unique(np.sort(nodes, axis=1), axis=0, return_index=True, return_inverse=True)
        place = np.argsort(np.argsort(first))[same.ravel()]  # of each given cell among those kept, in the file's order
        parts = {name: np.unique(place[np.isin(numbers, group)]) for name, group in self.bodies.items()}
        return kind, nodes[np.sort(first)], {name: cells for name, cells in parts.items() if len(cells)}

    def _chosen(self, body: str | None) -> Integers:
        """The numbers of a body's cells."""
        if body is not None:
            return self.bodies[body]
        everything = self.all_cells or not self.bodies
        groups = [block.numbers for block in self.blocks] if everything else list(self.bodies.values())
        return np.unique(np.concatenate(groups)) if len(groups) else np.zeros(0, dtype=np.int64)

    def _check_kinds(self, kinds: Sequence[Kind], whose: str) -> None:
        names = _listed(kinds)
        if len(set(kinds)) > 1:
            raise KindError(
                f"{self.source} has cells of several kinds{whose}: {names}; expected one kind in a body. Mesh it with "
                "one kind, or give each a group of its own and read them as two bodies"
            )
        if kinds[0] not in DEGREES and kinds[0] not in SERENDIPITY:
            able = ", ".join(str(kind) for kind in (*DEGREES, *SERENDIPITY) if _dim(kind) == self.dim)
            raise KindError(f"{self.source} has {names}{whose}, which cannot be computed with; mesh it with {able}")

    @cached_property
    def _in_triangles(self) -> Contents:
        """The same contents with every quadrilateral of degree 1 or 2 cut into two triangles of its degree."""
        blocks, x, numbers = [], self.x, self.numbers
        for block in self.blocks:
            for degree, kinds in simplices.QUADRILATERALS.items():
                if block.kind in kinds:
                    self._check_nodes(block.kind, block.nodes)
                    _, places, x = completed(block.kind, np.searchsorted(self.numbers, block.nodes), x)
                    numbers = np.concatenate([numbers, numbers[-1] + 1 + np.arange(len(x) - len(numbers))])
                    block = Block(
                        simplices.TRIANGLES[degree], np.repeat(block.numbers, 2), numbers[simplices.halves(places, x)]
                    )
            blocks.append(block)
        return replace(self, numbers=numbers, x=x, blocks=blocks)

    @cached_property
    def _in_tetrahedra(self) -> Contents:
        """The same contents with every solid cell of degree 1 cut into tetrahedra, and the groups of its sides."""
        blocks = []
        for block in self.blocks:
            if block.kind in simplices.SOLIDS:
                cells, owners = simplices.tetrahedra(block.kind, block.nodes)
                block = Block(simplices.TETRAHEDRA, block.numbers[owners], cells)
            blocks.append(block)
        sides = self._sides([block for block in self.blocks if block.kind in simplices.SOLIDS])[4]
        surfaces = {
            name: [part for array in arrays for part in self._cut_sides(name, array, sides)]
            for name, arrays in self.surfaces.items()
        }
        return replace(self, blocks=blocks, surfaces=surfaces)

    def _cut_sides(self, name: str, nodes: Integers, sides: Integers) -> list[Integers]:
        """The facets of a group, cut in two where they are among the sides of four corners."""
        if nodes.shape[1] != 4:
            return [nodes]
        ours = _matches(np.sort(self._places(name, nodes), axis=1), sides)
        return [simplices.side_halves(nodes[ours]), np.delete(nodes, ours, axis=0)]

    def _check_cuts(self, blocks: Sequence[Block]) -> None:
        """Refuse cells whose tetrahedra would lie outside them, or not meet side to side."""
        for block in blocks:
            self._check_nodes(block.kind, block.nodes)
            if block.kind in simplices.SOLIDS:
                cells, owners = simplices.tetrahedra(block.kind, block.nodes)
                bad = simplices.turned_over(self.x[np.searchsorted(self.numbers, cells)], owners)
                if bad:
                    raise KindError(f"{self.source}: {bad} of the {block.kind} are too distorted to be cut")
        sides = self._sides(blocks)
        alone = numbered(sides[4])
        outer = sides[4][np.bincount(alone)[alone] == 1]
        parts = np.concatenate([np.delete(outer, corner, axis=1) for corner in range(4)])
        bad = len(_matches(sides.get(3, parts[:0]), parts))
        if bad:
            raise KindError(
                f"{self.source}: {bad} triangular sides of cells lie on a side of four corners; expected cells that "
                "meet side to side"
            )

    def _check_nodes(self, kind: Kind, nodes: Integers) -> None:
        """Refuse cells whose nodes are not there or not all different, and nodes that hang."""
        there = np.isin(nodes, self.numbers)
        if not np.all(there):
            raise ValueError(f"{self.source}: a cell has the node {nodes[~there][0]}, which is not there")
        repeated = np.any(np.diff(np.sort(nodes, axis=1), axis=1) == 0, axis=1)
        if np.any(repeated):
            raise ValueError(
                f"{self.source}: {int(repeated.sum())} of the {kind} have a node twice (degenerate), one of them the "
                f"nodes {nodes[int(np.argmax(repeated))].tolist()}; expected {kind.nodes} different ones"
            )
        hanging = np.intersect1d(nodes[:, : kind.corners], nodes[:, kind.corners :])
        if len(hanging):
            at = self.x[np.searchsorted(self.numbers, hanging[0])]
            raise ValueError(
                f"{self.source}: {len(hanging)} hanging nodes, each a corner of one cell and the middle of an edge or "
                f"face of another, one of them at {at[: self.dim]}; expected cells that meet corner to corner"
            )

    def _check_coordinates(self, used: Integers, x: Floats) -> None:
        if not np.all(np.isfinite(x)):
            bad = int(np.argmin(np.isfinite(x).all(axis=1)))
            name = self.numbers[used[bad]] if used[bad] < len(self.numbers) else used[bad]
            raise ValueError(f"{self.source}: node {name} has coordinates {x[bad]}; expected finite numbers")
        if self.dim == 2 and np.ptp(x[:, 2]) > 1e-8 * np.ptp(x, axis=0).max():  # files round coordinates
            raise ValueError(
                f"{self.source}: the plane cells reach from z = {x[:, 2].min():g} to {x[:, 2].max():g}; expected a "
                "mesh in a plane z = constant"
            )

    def _facets(self, kind: Kind, corners: Integers) -> tuple[Integers, Integers]:
        """The sorted corners of every cell's facets, (cells · facets, corners), and a number of each."""
        facets = side_corners(kind.shape, corners, self.dim - 1)
        facets = facets.reshape(-1, facets.shape[2])
        numbers = numbered(facets)
        counts = np.bincount(numbers)
        if counts.max() > 2:
            bad = int(np.argmax(counts[numbers] > 2))
            raise ValueError(
                f"{self.source}: {int(np.sum(counts > 2))} facets have more than two cells, one of them at "
                f"{self.x[facets[bad]].mean(axis=0)[: self.dim]}; expected cells that do not lie on each other"
            )
        return facets, numbers

    def _surfaces(self, facets: Integers, numbers: Integers, kind: Kind) -> tuple[dict[str, Integers], dict[str, str]]:
        """The (cell, local facet) of each facet of a surface, (facets, 2), and why other groups are no surfaces.

        A group with facets inside the body is none: its name is kept for whoever asks for it.
        """
        outer = np.bincount(numbers)[numbers] == 1
        ours = np.zeros(len(self.x), dtype=bool)  # the nodes of this body: most groups of a file of many are elsewhere
        ours[facets] = True
        per_cell = len(SIDES[kind.shape])
        surfaces, left_out = {}, {}
        for name, rows in self._groups(facets, outer):
            places = _matches(facets, rows[ours[rows].all(axis=1)])
            within = len(np.unique(numbers[places[~outer[places]]]))
            if within:
                left_out[name] = inside_the_body(within)
            elif len(places):
                surfaces[name] = np.column_stack([places // per_cell, places % per_cell])
            elif name in self.surfaces:
                left_out[name] = "no facet of that group belongs to this body"
            else:
                left_out[name] = "no outer facet of this body has all its corners in that set of nodes"
        return surfaces, left_out

    def _groups(self, facets: Integers, outer: NDArray[np.bool_]) -> Iterator[tuple[str, Integers]]:
        """The sorted corners (facets, corners), as places in x, of each group of facets."""
        for name, arrays in self._sides_in_groups.items():
            rows = [array for array in arrays if array.shape[1] == facets.shape[1]]
            yield name, np.concatenate(rows) if rows else facets[:0]
        for name, nodes in self.node_sets.items():
            if name not in self.surfaces:
                within = np.isin(facets, np.searchsorted(self.numbers, np.intersect1d(nodes, self.numbers)))
                yield name, facets[outer & within.all(axis=1)]

    @cached_property
    def _sides_in_groups(self) -> dict[str, list[Integers]]:
        """The sorted corners, as places in x, of the facets of each group, all of them sides of cells."""
        found = {}
        for name, arrays in self.surfaces.items():
            found[name] = [np.sort(self._places(name, array), axis=1) for array in arrays if len(array)]
            strange = sum(int(np.sum(~self._on_cells(array))) for array in found[name])
            if strange:
                total = sum(len(array) for array in found[name])
                raise ValueError(
                    f"{self.source}: {strange} of the {total} facets of the group {name!r} belong to no cell"
                )
        return found

    def _places(self, name: str, nodes: Integers) -> Integers:
        there = np.isin(nodes, self.numbers)
        if not np.all(there):
            raise ValueError(f"{self.source}: the group {name!r} has the node {nodes[~there][0]}, which is not there")
        return np.searchsorted(self.numbers, nodes)

    def _on_cells(self, rows: Integers) -> NDArray[np.bool_]:
        """The mask of facets (facets, corners) that are the side of a cell, whatever its kind and group."""
        all_sides = self._all_sides.get(rows.shape[1])
        if all_sides is None:
            return np.zeros(len(rows), dtype=bool)
        near = all_sides[np.isin(all_sides, rows).all(axis=1)]
        numbers = numbered(np.concatenate([near, rows]))
        return np.isin(numbers[len(near) :], numbers[: len(near)])

    @cached_property
    def _all_sides(self) -> dict[int, Integers]:
        """The sides of all cells, see `_sides`."""
        return self._sides(self.blocks)

    def _sides(self, blocks: Sequence[Block]) -> dict[int, Integers]:
        """The sorted corners, as places in x, of the sides of cells by their number of corners."""
        found: dict[int, list[Integers]] = {}
        for block in blocks:
            for side in SIDES[block.kind.shape]:
                rows = np.searchsorted(self.numbers, block.nodes[:, side])
                found.setdefault(len(side), []).append(np.sort(rows, axis=1))
        return {count: np.concatenate(rows) for count, rows in found.items()}


def merged(groups: Iterator[tuple[str, Integers]]) -> dict[str, Integers]:
    """Groups of numbers by name, stripped of blanks; those of one name are one."""
    found: dict[str, list[Integers]] = {}
    for name, numbers in groups:
        found.setdefault(name.strip(), []).append(numbers)
    return {name: np.unique(np.concatenate(each)) for name, each in found.items()}


def _matches(facets: Integers, rows: Integers) -> Integers:
    """The places in `facets` (n, corners) of those that are among `rows` (m, corners), all of sorted corners."""
    near = np.flatnonzero(np.isin(facets, rows).all(axis=1)) if len(rows) else np.zeros(0, dtype=np.intp)
    if len(near) == 0:
        return near
    numbers = numbered(np.concatenate([facets[near], rows]))
    return near[np.isin(numbers[: len(near)], numbers[len(near) :])]


def _listed(kinds: Iterable[Kind]) -> str:
    return " and ".join(sorted({str(kind) for kind in kinds}))


def _dim(kind: Kind) -> int:
    return 2 if kind.shape in ("triangle", "quadrilateral") else 3


def in_order(source: str, numbers: NDArray[np.int64], x: Floats) -> tuple[Integers, Floats]:
    """The numbers of nodes in increasing order, each once, and their coordinates (nodes, 3)."""
    ordered, first = np.unique(np.asarray(numbers, dtype=np.int64), return_index=True)
    if len(ordered) < len(numbers):
        twice = np.setdiff1d(np.arange(len(numbers)), first)
        for place in twice:
            if not np.array_equal(x[place], x[first[np.searchsorted(ordered, numbers[place])]], equal_nan=True):
                raise ValueError(f"{source}: the node {numbers[place]} is there twice, at different places")
    return ordered, x[first]
