"""Plane triangles of good shape and wanted sizes, from plain arrays: edges are flipped and nodes moved, in turns.

Halved cells have the sizes 1, 1/2, 1/4 … and right angles. Where their nodes become the centroids of the cells around,
weighted by density, sizes vary smoothly and triangles become nearly equilateral: the same number of linear ones has an
error that is smaller by a third, and more.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .arrays import Floats, Integers

#: Flips are decided by more than rounding, so that a mesh and its mirror image become alike.
ROUNDING = 1e-9
#: Boundary edges go straight on where the sine of the angle between them is less.
STRAIGHT = 1e-8
#: How far a node is moved to a point, by the length of the edge on that side.
REACH = 0.6
#: The part of its area that a triangle keeps at least in one move.
KEPT = 0.1


@dataclass(frozen=True)
class Rails:
    """The nodes that are not free.

    fixed: (n,) bool, those that stay; sliding: (s,) those between two neighbours (s, 2) on a straight line.
    """

    fixed: NDArray[np.bool_]
    sliding: Integers
    neighbours: Integers


def rails(x: Floats, edges: Integers, kinds: Integers, held: Integers) -> Rails:
    """The nodes of edges (k, 2) that none may leave: they slide where two of one kind (k,) meet in a straight line.

    x: (n, 2) the nodes; held: those that stay whatever their edges are.
    """
    node, other, kind = edges.ravel(), edges[:, ::-1].ravel(), np.repeat(kinds, 2)
    order = np.argsort(node, kind="stable")
    count = np.bincount(node, minlength=len(x))
    pairs = np.flatnonzero(count == 2)
    first = (np.cumsum(count) - count)[pairs]
    one, two = order[first], order[first + 1]
    u, v = x[pairs] - x[other[one]], x[other[two]] - x[pairs]
    straight = (np.abs(_cross(u, v)) < STRAIGHT * _lengths(u) * _lengths(v)) & ((u * v).sum(axis=1) > 0)
    free = straight & (kind[one] == kind[two]) & ~np.isin(pairs, held)
    fixed = count > 0
    fixed[pairs[free]] = False
    return Rails(fixed, pairs[free], np.stack([other[one], other[two]], axis=1)[free])


def snapped(x: Floats, cells: Integers, held: Rails, points: Floats) -> tuple[Floats, Integers]:
    """The nodes, those nearest to points (e, 2) moved beside these along their lines, and which of them moved."""
    to, found = x.copy(), []
    for point in points:
        if len(held.sliding) == 0:
            break
        place = np.linalg.norm(x[held.sliding] - point, axis=1).argmin()
        node, (before, after) = held.sliding[place], x[held.neighbours[place]]
        along = (after - before) / _lengths(after - before)
        step = float((point - x[node]) @ along)
        if -REACH * _lengths(x[node] - before) < step < REACH * _lengths(after - x[node]):
            to[node] = x[node] + step * along
            found.append(node)
    return _not_inverted(x, to, cells), np.array(found, dtype=np.int64)


def relaxed(
    x: Floats, cells: Integers, parts: Integers, density: Floats, held: Rails, *, rounds: int, sweeps: int
) -> tuple[Floats, Integers]:
    """The nodes (n, 2) and triangles (m, 3) after some rounds of flips and sweeps of moves; cells keep their numbers.

    parts: (m,) the part of each triangle, whose boundary stays; density: (n,) of cells per area, at the nodes.
    """
    cells = flipped(x, _turned_alike(x, cells), parts)
    for _ in range(rounds):
        for _ in range(sweeps):
            x = _moved(x, cells, density, held)
        cells = flipped(x, cells, parts)
    return x, cells


def _turned_alike(x: Floats, cells: Integers) -> Integers:
    """The triangles with corners that go round as those of the first one do, in a mirror image too."""
    cells, area = np.array(cells, dtype=np.int64), areas(x, cells)
    other = area * area[0] < 0
    cells[other, 1:] = cells[other, :0:-1]
    return cells


def inner_edges(cells: Integers) -> tuple[Integers, Integers]:
    """The places in `cells.ravel()` of the corners on both sides of every edge between two triangles, (edges,) each."""
    ends = np.sort(cells[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
    key = ends[:, 0].astype(np.int64) * (int(cells.max()) + 1) + ends[:, 1]
    order = np.argsort(key, kind="stable")
    twice = key[order][1:] == key[order][:-1]
    return order[:-1][twice], order[1:][twice]


def flipped(x: Floats, cells: Integers, parts: Integers) -> Integers:
    """The triangles after flips of all edges whose opposite angles are together more than π, but between parts.

    The corners of all go round alike.
    """
    cells = cells.copy()
    for _ in range(50):  # each makes the least angles larger, so that they end; the last ones are of no importance
        one, two = inner_edges(cells)
        same = parts[one // 3] == parts[two // 3]
        one, two = one[same], two[same]
        cotangents = _cotangents(x, cells).ravel()
        worth = cotangents[one] + cotangents[two]
        flips = worth < -ROUNDING
        if not flips.any():
            break
        _flip(cells, *_independent(one[flips], two[flips], worth[flips], len(cells)))
    return cells


def _independent(one: Integers, two: Integers, worth: Floats, count: int) -> tuple[Integers, Integers]:
    """Of the flips those that are worth most in both of their triangles."""
    rank = np.empty(len(worth), dtype=np.int64)
    rank[np.argsort(np.round(worth, 6), kind="stable")] = np.arange(len(worth))
    best = np.full(count, len(worth))
    np.minimum.at(best, one // 3, rank)
    np.minimum.at(best, two // 3, rank)
    chosen = (rank == best[one // 3]) & (rank == best[two // 3])
    return one[chosen], two[chosen]


def _flip(cells: Integers, one: Integers, two: Integers) -> None:
    """(p, u, v) and (q, v, u) become (p, u, q) and (q, v, p)."""
    p, q = cells.ravel()[one], cells.ravel()[two]
    cells[one // 3, (one % 3 + 2) % 3] = q
    cells[two // 3, (two % 3 + 2) % 3] = p


def _cotangents(x: Floats, cells: Integers) -> Floats:
    """The cotangents of all angles, (m, 3)."""
    corners = x[cells]
    to_next, to_last = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    return np.asarray((to_next * to_last).sum(axis=2) / np.abs(_cross(to_next, to_last)))


def _moved(x: Floats, cells: Integers, density: Floats, held: Rails) -> Floats:
    """The nodes at the centroids around them, of triangles or, of those that slide, of edges."""
    n, weight = len(x), np.repeat(np.abs(areas(x, cells)) * density[cells].mean(axis=1), 3)
    middles = np.repeat(x[cells].mean(axis=1), 3, axis=0)
    sums = [np.bincount(cells.ravel(), weight * each, n) for each in (*middles.T, 1.0)]
    to = np.stack(sums[:2], axis=1) / sums[2][:, None]
    to[held.fixed] = x[held.fixed]
    beside, here = x[held.neighbours], x[held.sliding, None]
    lengths = _lengths(beside - here) * (density[held.neighbours] + density[held.sliding, None])
    to[held.sliding] = (lengths[..., None] * 0.5 * (beside + here)).sum(axis=1) / lengths.sum(axis=1)[:, None]
    return _not_inverted(x, to, cells)


def _not_inverted(x: Floats, to: Floats, cells: Integers) -> Floats:
    """The nodes at their new places, but of triangles that would lose their area."""
    before = areas(x, cells)
    while (lost := areas(to, cells) / before < KEPT).any():
        to[cells[lost]] = x[cells[lost]]
    return to


def areas(x: Floats, cells: Integers) -> Floats:
    """The areas (m,) of triangles, positive where their corners go round to the left."""
    corners = x[cells]
    return 0.5 * _cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _cross(u: Floats, v: Floats) -> Floats:
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])


def _lengths(u: Floats) -> Floats:
    return np.hypot(u[..., 0], u[..., 1])
