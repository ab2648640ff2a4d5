"""Rough surfaces known at scattered points, whose heights are a contact's gap."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from .base.arrays import Floats
from .base.checks import as_floats

#: Points this part of the distance to the middle beyond the outermost are their rounding.
SLACK = 1e-9


class ScatteredHeights:
    """The gap under a rough surface known at scattered points: how far it lies below the highest of them.

    Given as the `gap` of a `Contact`. Heights are linear between the points, in space over their Delaunay triangles;
    beyond the points the surface is not known, and refused. Heights on a grid are `SurfaceHeights`.

    Args:
        points: (n,) coordinates x along a line, or (n, 2) coordinates x and y, all different (length).
        heights: (n,) counted out of the body (length).

    Attributes:
        heights: As given.

    Raises:
        TypeError, ValueError: An argument is none of these, or the points lie on a line in their plane.

    Example:
        >>> gap = ScatteredHeights([0.0, 1.0, 3.0], [0.0, 2.0, 1.0])
        >>> gap(np.array([[0.5, 1.0, 2.0], [9.0, 9.0, 9.0]]))
        array([1. , 0. , 0.5])
    """

    def __init__(self, points: ArrayLike, heights: ArrayLike) -> None:
        self.points = as_floats("points", points, "finite numbers (n,) or (n, 2)")
        self.heights = as_floats("heights", heights, "finite numbers (n,)")
        shape = self.points.shape
        if shape not in ((len(self.points),), (len(self.points), 2)) or len(shape) + 1 > len(self.points):
            raise ValueError(f"points of shape {shape}: expected (n,) with two points or more, or (n, 2) with three")
        if self.heights.shape != shape[:1]:
            raise ValueError(f"heights of shape {self.heights.shape}: expected {shape[:1]}, one for each point")
        if not np.all(np.isfinite(self.points)) or not np.all(np.isfinite(self.heights)):
            raise ValueError("points, heights: expected finite numbers")
        places, counts = np.unique(self.points, axis=0, return_counts=True)
        if counts.max() > 1:
            raise ValueError(f"points: {places[np.argmax(counts)]} is there {counts.max()} times; expected it once")
        depths = self.heights.max() - self.heights
        self._depth = _along(self.points, depths) if len(shape) == 1 else _between(self.points, depths)

    def __repr__(self) -> str:
        return f"ScatteredHeights({len(self.heights)} points)"

    def __call__(self, x: Floats) -> Floats:
        """The gaps (n,) at points (length).

        Args:
            x: (dim, n) coordinates, of which the first, or the first two, count (length).

        Raises:
            ValueError: A point lies beyond the surface's own.
        """
        at = x[0] if self.points.ndim == 1 else x[:2].T
        middle = 0.5 * (self.points.min(axis=0) + self.points.max(axis=0))
        found = self._depth(at)
        beyond = np.isnan(found)
        found[beyond] = self._depth(middle + (1 - SLACK) * (at[beyond] - middle))
        if np.any(np.isnan(found)):
            worst = int(np.argmax(np.isnan(found)))
            raise ValueError(f"{self!r}: not known at x = {x[:, worst]}; expected places between the points")
        return found


def _along(points: Floats, depths: Floats) -> Callable[[Floats], Floats]:
    """The depth along a line, not a number beyond its ends."""
    order = np.argsort(points)
    return lambda at: np.interp(at, points[order], depths[order], left=np.nan, right=np.nan)


def _between(points: Floats, depths: Floats) -> Callable[[Floats], Floats]:
    """The depth over a plane, not a number beyond the points' hull."""
    from scipy.interpolate import LinearNDInterpolator
    from scipy.spatial import QhullError

    try:
        return LinearNDInterpolator(points, depths)
    except QhullError:
        raise ValueError(f"points: the {len(points)} lie on a line; expected some beside it") from None
