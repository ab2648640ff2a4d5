"""Contact detection: facets of two surfaces that may lie opposite each other, by a bounding-volume tree over each.

Sound and, but for a few near misses, tight: no pair of facets that overlaps along its common normal is left out,
however unlike the facets' sizes, curved the surfaces or wide the gap between them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import TINY, Floats, Indices

#: Facets face each other if the angle between one's normal and the other's inward normal is below this.
FACING = np.pi / 3

#: Pairs of facets up to which all are looked at: a tree has more to do before it begins.
FEW = 2000


@dataclass(frozen=True)
class _Level:
    """Blocks of facets: their boxes low, high (n, dim), the axis (n, dim) and half angle (n,) of the normals' cone."""

    low: Floats
    high: Floats
    axis: Floats
    angle: Floats

    def of(self, places: Indices) -> _Level:
        """Some of the blocks."""
        return _Level(self.low[places], self.high[places], self.axis[places], self.angle[places])

    def parents(self) -> _Level:
        """The blocks of two neighbours each."""
        starts = np.arange(0, len(self.angle), 2)
        axis = _units(np.add.reduceat(self.axis, starts))
        above = np.repeat(axis, 2, axis=0)[: len(self.axis)]
        angle = angle_between(self.axis, above) + self.angle
        angle[~np.any(above, axis=1)] = np.pi  # opposite axes have no middle
        return _Level(
            np.minimum.reduceat(self.low, starts),
            np.maximum.reduceat(self.high, starts),
            axis,
            np.maximum.reduceat(angle, starts),
        )


def facing_pairs(
    first: Floats, first_normals: Floats, second: Floats, second_normals: Floats, reach: float
) -> tuple[Indices, Indices]:
    """The pairs of facets that may overlap, as two arrays of their places.

    first, second: (n, corners, dim); normals: (n, dim) outward units; reach: how far apart partners may be.
    """
    leaves = [
        _Level(c.min(axis=1), c.max(axis=1), n, np.zeros(len(c)))
        for c, n in ((first, first_normals), (second, second_normals))
    ]
    if len(first) * len(second) <= FEW:
        i, j = np.divmod(np.arange(len(first) * len(second)), len(second))
        may = _may_overlap(leaves[0], i, leaves[1], j, reach)
        return i[may], j[may]
    orders = [_curve_order(corners.mean(axis=1)) for corners in (first, second)]
    trees = [_tree(level.of(order)) for level, order in zip(leaves, orders, strict=True)]
    i = j = np.zeros(1, dtype=np.intp)
    for level in reversed(range(max(len(tree) for tree in trees))):
        here = [tree[min(level, len(tree) - 1)] for tree in trees]
        if level < max(len(tree) for tree in trees) - 1:
            i, j = _children(i, j, [level < len(tree) - 1 for tree in trees], [len(blocks.angle) for blocks in here])
        may = _may_overlap(here[0], i, here[1], j, reach)
        i, j = i[may], j[may]
    return orders[0][i], orders[1][j]


def angle_between(a: Floats, b: Floats) -> Floats:
    """The angles between unit vectors (n, dim), without the cancellation of arccos."""
    return 2 * np.arctan2(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1))


def _may_overlap(first: _Level, i: Indices, second: _Level, j: Indices, reach: float) -> NDArray[np.bool_]:
    """Whether any line along a common normal of facets of both blocks can meet both, no longer than `reach`."""
    low, high = second.low[j] - first.high[i], second.high[j] - first.low[i]
    offset, radius = 0.5 * (low + high), 0.5 * np.linalg.norm(high - low, axis=1)
    distance = np.linalg.norm(offset, axis=1)
    opening = angle_between(first.axis[i], -second.axis[j])
    spread = first.angle[i] + second.angle[j]
    # Common normals stay within `spread` of the middle one, the offset of overlapping facets within `radius` of them.
    middle = _units(first.axis[i] - second.axis[j])
    along = np.sum(offset * middle, axis=1)
    across = np.linalg.norm(offset - along[:, None] * middle, axis=1)
    tilt = np.arctan2(across, np.abs(along))
    least = np.where(spread < 1.0, distance * np.sin(np.clip(tilt - spread, 0.0, None)), 0.0)
    return (opening - spread <= FACING) & (distance <= reach + radius) & (least <= radius)


def _children(i: Indices, j: Indices, split: Sequence[bool], counts: Sequence[int]) -> tuple[Indices, Indices]:
    """The pairs of the blocks' halves; a tree that has no finer level keeps its blocks."""
    for side in (0, 1):
        if split[side]:
            parent = np.repeat((i, j)[side], 2)
            child = 2 * parent + np.tile([0, 1], len(parent) // 2)
            other = np.repeat((j, i)[side], 2)
            there = child < counts[side]
            i, j = (child[there], other[there]) if side == 0 else (other[there], child[there])
    return i, j


def _tree(leaves: _Level) -> list[_Level]:
    """The levels from the facets to the one block of all."""
    levels = [leaves]
    while len(levels[-1].angle) > 1:
        levels.append(levels[-1].parents())
    return levels


def _curve_order(points: Floats) -> Indices:
    """An order of the points (n, dim) along Morton's space-filling curve: neighbours in it are neighbours in space."""
    bits = 16
    extent = max(float(np.ptp(points, axis=0).max()), TINY)
    cells = ((points - points.min(axis=0)) / extent * (2**bits - 1)).astype(np.int64)
    dim = points.shape[1]
    code = np.zeros(len(points), dtype=np.int64)
    for bit in range(bits):
        for axis in range(dim):
            code |= ((cells[:, axis] >> bit) & 1) << (dim * bit + axis)
    return np.argsort(code, kind="stable")


def _units(vectors: Floats) -> Floats:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), TINY)
