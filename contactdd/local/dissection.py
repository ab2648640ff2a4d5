"""Nested dissection: a body's cells cut into halves, and these again, so that unknowns are eliminated part by part.

What lies between the two halves of a part is eliminated once both are condensed to their boundaries (the multifrontal
method), by dense algebra throughout.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Indices, Integers

#: Nodes up to which the cells of a part are not cut further.
LEAF = 100


#: How far a cut may lie from the middle, as a part of the cells, where fewer nodes lie between the halves.
SHIFT = 0.15


@dataclass(frozen=True)
class Part:
    """Some cells of a body, by their numbers or as the two halves (numbers of earlier parts) that they fell into.

    first, last: the places in the order of elimination of what is eliminated here; boundary: of what is left.
    """

    cells: Indices
    halves: tuple[int, ...]
    first: int
    last: int
    boundary: Indices


@dataclass(frozen=True)
class Dissection:
    """The order in which unknowns are eliminated, those that are kept last, and the parts of the body, halves first."""

    order: Indices
    parts: list[Part]

    @classmethod
    def of(cls, cells: NDArray[np.int32], middles: Floats, nodes: Indices, kept: Indices) -> Dissection:
        """The dissection of cells given by their nodes (cells, n) and middles (cells, dim).

        nodes: of every unknown; kept: unknowns that are not eliminated.
        """
        tree = _Tree(cells, middles, int(cells.max()) + 1)
        owner = tree.owner[nodes]
        owner[kept] = len(tree.halves)
        # Along a separator, what a part touches is in one piece: the cells are in the order of the parts.
        order = np.lexsort((nodes, tree.first_cell[nodes], owner))
        order[len(order) - len(kept) :] = kept
        place = np.empty(len(order), dtype=np.intp)
        place[order] = np.arange(len(order))
        ends = np.searchsorted(owner[order], np.arange(len(tree.halves) + 1))
        by_node = np.argsort(nodes, kind="stable")
        node_ends = np.searchsorted(nodes[by_node], np.arange(len(tree.owner) + 1))
        parts: list[Part] = []
        for number, (group, halves) in enumerate(zip(tree.groups, tree.halves, strict=True)):
            if halves:
                around = np.union1d(*(parts[half].boundary for half in halves))
            else:
                here = np.unique(cells[group])
                around = np.sort(place[by_node[_ranges(node_ends[here], node_ends[here + 1])]])
            last = int(ends[number + 1])
            parts.append(Part(group, halves, int(ends[number]), last, around[np.searchsorted(around, last) :]))
        return cls(order, parts)


class _Tree:
    """The parts of cells in the order of elimination: their halves, cells and the nodes that belong to them."""

    def __init__(self, cells: NDArray[np.int32], middles: Floats, nodes: int) -> None:
        self._cells, self._middles = cells, middles
        self.owner = np.full(nodes, -1)  # the number of the part that eliminates each node
        self.halves: list[tuple[int, ...]] = []
        self.groups: list[Indices] = []
        self._first, self._last = np.empty(nodes, dtype=np.intp), np.empty(nodes, dtype=np.intp)
        self._cut(np.arange(len(cells)))
        whole = [group for group, halves in zip(self.groups, self.halves, strict=True) if not halves]
        self.first_cell = np.zeros(nodes, dtype=np.intp)
        ranks = np.repeat(np.arange(len(cells)), cells.shape[1])
        self.first_cell[cells[np.concatenate(whole)].ravel()[::-1]] = ranks[::-1]

    def _cut(self, group: Indices) -> int:
        """The number of a part, after its halves are numbered."""
        halves: tuple[int, ...] = ()
        group, here, first, last = self._lined_up(group)
        if len(here) > LEAF and len(group) > 1:
            cut = _best_cut(len(group), first, last)
            here = here[(first < cut) & (last >= cut)]
            self.owner[here] = len(self._cells)  # some part's, from now on
            halves = self._cut(group[:cut]), self._cut(group[cut:])
        self.halves.append(halves)
        self.groups.append(group)
        self.owner[here] = len(self.halves) - 1
        return len(self.halves) - 1

    def _lined_up(self, group: Indices) -> tuple[Indices, Indices, Indices, Indices]:
        """Cells along their longest direction, their nodes that belong to no part yet, and the first and last cells of
        each of these in that line."""
        middles = self._middles[group]
        group = group[np.argsort(middles[:, np.argmax(np.ptp(middles, axis=0))], kind="stable")]
        nodes: Integers = self._cells[group].ravel()
        ranks = np.repeat(np.arange(len(group)), self._cells.shape[1])
        open_ = self.owner[nodes] < 0
        nodes, ranks = nodes[open_], ranks[open_]
        self._last[nodes] = np.arange(len(nodes))
        self._first[nodes[::-1]] = ranks[::-1]
        ends = np.sort(self._last[nodes[self._last[nodes] == np.arange(len(nodes))]])
        here = nodes[ends]
        return group, here, self._first[here], ranks[ends]


def _best_cut(count: int, first: Indices, last: Indices) -> int:
    """After how many of the cells in line to cut: near the middle, where few nodes have cells on both sides."""
    crossing = np.cumsum(np.bincount(first + 1, minlength=count + 2) - np.bincount(last + 1, minlength=count + 2))
    low = max(1, int((0.5 - SHIFT) * count))
    cuts = np.arange(low, max(low + 1, count - low + 1))
    return int(cuts[np.argmin(crossing[cuts] * (1 + np.abs(cuts / count - 0.5)))])


def _ranges(first: Indices, last: Indices) -> Indices:
    """The numbers of several ranges, one after the other."""
    counts = last - first
    return np.repeat(first - np.cumsum(counts) + counts, counts) + np.arange(int(counts.sum()))
