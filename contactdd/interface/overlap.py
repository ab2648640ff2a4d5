"""The common refinement of two surfaces: where a facet of one and a facet of the other overlap, a segment.

Facets are seen along the normal that both share, n = (n_α − n_β)/|n_α − n_β|, in the plane across it. Nothing tells the
two surfaces apart: exchanged, they give the same segments. Everything here is geometry of arrays; no mesh is known.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Indices
from ..base.facets import cross

#: Overlaps smaller than this part of the smaller facet are rounding, not contact.
NEGLIGIBLE = 1e-12


#: Corners of an overlap closer than this, relative to the smaller facet's size, are one.
MERGED = 1e-11


@dataclass(frozen=True)
class Segments:
    """n integration points on the segments of pairs of facets.

    pair: (n,) the pair each belongs to; line: (n, dim) a point of the line along the common normal on which the
    partners lie; weight: (n,) area across the normal.
    """

    pair: Indices
    line: Floats
    weight: Floats


def common_normals(first: Floats, second: Floats) -> Floats:
    """The common normals of facing outward normals (n, dim), pointing out of the first."""
    difference = first - second
    return difference / np.linalg.norm(difference, axis=1, keepdims=True)


def segments(first: Floats, second: Floats, normal: Floats, points: Floats, weights: Floats) -> Segments:
    """The segments of n pairs of facets, with the quadrature `points` (q, dim − 1), `weights` on each simplex of them.

    first, second: (n, corners, dim) in order around each facet; normal: (n, dim) the common normals.
    """
    middle = 0.5 * (first.mean(axis=1) + second.mean(axis=1))
    axes = axes_across(normal)
    seen = [np.einsum("pci,pki->pck", corners - middle[:, None], axes) for corners in (first, second)]
    pair, simplices = (_overlaps_of_intervals if first.shape[2] == 2 else _overlaps_of_polygons)(*seen)
    edges = simplices[:, 1:] - simplices[:, :1]
    across = simplices[:, :1] + np.einsum("qk,skj->sqj", points, edges)
    # The determinant is the area per unit of the reference simplex, which is what quadrature weights refer to.
    area = np.abs(np.linalg.det(edges))
    pair = np.repeat(pair, len(weights))
    line = middle[pair] + np.einsum("pk,pki->pi", across.reshape(-1, points.shape[1]), axes[pair])
    return Segments(pair, line, (area[:, None] * weights).ravel())


def meet_line(
    surface: Callable[[Floats], tuple[Floats, Floats]],
    line: Floats,
    direction: Floats,
    start: Floats,
    within: float = np.inf,
) -> Floats:
    """The intersections of curved facets with lines, in the facets' coordinates (n, dim − 1).

    surface: from the facets' coordinates to points (n, dim) and tangents (n, dim, dim − 1); within: the
    largest distance from the start. Newton's iteration.
    """
    local = start
    for _ in range(20):
        x, tangents = surface(local)
        matrix = np.concatenate([tangents, -direction[:, :, None]], axis=2)
        offset = line - x
        step = np.linalg.solve(matrix, offset[:, :, None])[:, :-1, 0]
        local = local + step if within == np.inf else np.clip(local + step, start - within, start + within)
        if np.abs(step).max(initial=0.0) < 1e-8:  # the error is then this step's square
            break
    return local


def _overlaps_of_intervals(first: Floats, second: Floats) -> tuple[Indices, Floats]:
    """The overlaps of pairs of intervals (n, 2, 1): the pairs that have one, and the overlaps (m, 2, 1)."""
    low = np.maximum(first.min(axis=1), second.min(axis=1))
    high = np.minimum(first.max(axis=1), second.max(axis=1))
    shorter = np.minimum(np.ptp(first, axis=1), np.ptp(second, axis=1))
    pair = np.flatnonzero((high - low > NEGLIGIBLE * shorter)[:, 0])
    return pair, np.stack([low[pair], high[pair]], axis=1)


def _overlaps_of_polygons(first: Floats, second: Floats) -> tuple[Indices, Floats]:
    """The overlaps of pairs of convex polygons (n, corners, 2), cut into triangles: the pair of each, the triangles.

    The cut goes from the middle of the overlap to its corners, so that it does not depend on which polygon is first.
    """
    first, second = _counter_clockwise(first), _counter_clockwise(second)
    boxes = (first.max(axis=1) > second.min(axis=1)) & (second.max(axis=1) > first.min(axis=1))
    pair = np.flatnonzero(boxes.all(axis=1))
    if len(pair) == 0:
        return pair, np.zeros((0, 3, 2))
    first, second = first[pair], second[pair]
    smaller = np.minimum(_areas(first), _areas(second))
    polygon, count = _without_rounding(*_clip(first, second), smaller)
    centre = polygon.sum(axis=1) / np.maximum(count, 1)[:, None]
    positions = np.arange(polygon.shape[1])
    triangles = np.stack([np.broadcast_to(centre[:, None], polygon.shape), polygon, _next(polygon, count)], axis=2)
    whole = count == 3  # a triangle needs no cut
    triangles[whole, 0] = polygon[whole, :3]
    used = (positions < count[:, None]) & ~(whole[:, None] & (positions > 0))
    used &= _areas(triangles) > NEGLIGIBLE * smaller[:, None]
    owner, corner = np.nonzero(used)
    return pair[owner], triangles[owner, corner]


def _clip(polygons: Floats, windows: Floats) -> tuple[Floats, Indices]:
    """Sutherland and Hodgman's clipping of n convex polygons (n, c, 2) by convex windows (n, d, 2), all at once.

    Returns the corners, padded with zeros to (n, c + d, 2), and how many each polygon has.
    """
    polygon, count = polygons, np.asarray(np.full(len(polygons), polygons.shape[1]))
    for start, end in zip(np.moveaxis(windows, 1, 0), np.moveaxis(np.roll(windows, -1, axis=1), 1, 0), strict=True):
        there = np.arange(polygon.shape[1]) < count[:, None]
        edge = end - start
        inside = edge[:, None, 0] * (polygon[:, :, 1] - start[:, None, 1])
        inside -= edge[:, None, 1] * (polygon[:, :, 0] - start[:, None, 0])
        inside_next = _next(inside, count)
        crossing = inside * inside_next < 0.0
        part = inside / np.where(crossing, inside - inside_next, 1.0)
        cut = polygon + part[:, :, None] * (_next(polygon, count) - polygon)
        # Every corner inside stays, followed by the cut of its edge.
        corners = np.stack([polygon, cut], axis=2).reshape(len(polygon), -1, 2)
        kept = np.stack([there & (inside >= 0.0), there & crossing], axis=2).reshape(len(polygon), -1)
        polygon, count = _packed(corners, kept, polygon.shape[1] + 1)  # more corners are slivers of rounding
    return polygon, count


def _without_rounding(polygons: Floats, count: Indices, areas: Floats) -> tuple[Floats, Indices]:
    """The polygons without corners that only rounding has made: doubled ones, then those in the middle of an edge.

    Where edges of both surfaces lie on each other it is chance whether such corners appear. areas: (n,) to compare to.
    """
    positions = np.arange(polygons.shape[1])
    for doubled in (True, False):
        ends = _next(polygons, count)
        if doubled:
            kept = np.linalg.norm(ends - polygons, axis=2) > MERGED * np.sqrt(areas)[:, None]
        else:
            preceding = np.where(positions > 0, positions - 1, np.maximum(count, 1)[:, None] - 1)
            starts = np.take_along_axis(polygons, preceding[:, :, None], axis=1)
            kept = _areas(np.stack([starts, polygons, ends], axis=2)) > NEGLIGIBLE * areas[:, None]
        polygons, count = _packed(polygons, kept & (positions < count[:, None]), len(positions))
    return polygons, count


def _next(values: Floats, count: Indices) -> Floats:
    """The values (n, corners, ...) at each polygon's corners, shifted to the next corner around it."""
    positions = np.arange(values.shape[1])
    following = np.where(positions + 1 < count[:, None], positions + 1, 0)
    return values[np.arange(len(values))[:, None], following]


def _packed(corners: Floats, kept: NDArray[np.bool_], size: int) -> tuple[Floats, Indices]:
    """The first `size` corners kept of each polygon, padded with zeros to (n, size, 2), and how many each has."""
    order = np.argsort(~kept, axis=1, kind="stable")[:, :size]
    count = np.minimum(kept.sum(axis=1), size)
    polygons = np.take_along_axis(corners, order[:, :, None], axis=1)
    polygons[np.arange(size) >= count[:, None]] = 0.0
    return polygons, count


def _counter_clockwise(polygons: Floats) -> Floats:
    return np.where((_signed_areas(polygons) < 0.0)[:, None, None], polygons[:, ::-1], polygons)


def _areas(polygons: Floats) -> Floats:
    return np.abs(_signed_areas(polygons))


def _signed_areas(polygons: Floats) -> Floats:
    """The areas of polygons (..., corners, 2)."""
    x, y = polygons[..., 0] - polygons[..., :1, 0], polygons[..., 1] - polygons[..., :1, 1]
    return 0.5 * np.sum(x * np.roll(y, -1, axis=-1) - np.roll(x, -1, axis=-1) * y, axis=-1)


def axes_across(normal: Floats) -> Floats:
    """Orthonormal axes (n, dim − 1, dim) of the planes across unit normals (n, dim)."""
    if normal.shape[1] == 2:
        return np.stack([-normal[:, 1], normal[:, 0]], axis=1)[:, None]
    smallest = np.eye(3)[np.argmin(np.abs(normal), axis=1)]
    first = cross(normal, smallest)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, cross(normal, first)], axis=1)
