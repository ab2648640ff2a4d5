"""A shape given by the height of its surface: as a function, or by measured points."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.checks import as_floats, check_choice
from .rays import entry
from .shape import Shape

#: From one or two arrays of coordinates (points,) to heights (points,).
Height = Callable[..., ArrayLike]


class Profile(Shape):
    """The body above (or below) a surface given by its height over the other coordinates.

    In the plane y(x), or x(y) along the axis 0; of a body of revolution z(r), or r(z) along the axis 0, which is a
    shaft or a sleeve; in space z(x, y). Where the height is not a number there is nothing.

    Args:
        height: A function of the other coordinates, an array (points,) each, that gives heights (points,) (length); or
            measured points: (n, 2) of a line in the plane, (coordinate, height) in any order.
        dim: 2 or 3.
        axis: The coordinate along which the height is counted, by default the last.
        body: "above" the surface or "below" it.
        interpolation: Between points: "smooth" (monotone cubic, no new extrema) or "linear".

    Raises:
        TypeError, ValueError: An argument is none of these.

    Example:
        >>> parabola = Profile(lambda x: x**2 / 2)
        >>> parabola.distance(np.array([[1.0, 0.0]]), np.array([[0.0, 1.0]]))
        array([0.5])
    """

    def __init__(
        self,
        height: Height | ArrayLike,
        dim: int = 2,
        *,
        axis: int = -1,
        body: str = "above",
        interpolation: str = "smooth",
    ) -> None:
        if dim not in (2, 3):
            raise ValueError(f"dim = {dim!r}: expected 2 or 3")
        if axis not in range(-1, dim):
            raise ValueError(f"axis = {axis!r}: expected a coordinate from 0 to {dim - 1}, or -1 for the last")
        check_choice("body", body, ("above", "below"))
        check_choice("interpolation", interpolation, ("smooth", "linear"))
        if not callable(height) and dim == 3:
            raise TypeError("height of dim = 3: expected a function of two coordinates; see Profile.on_grid")
        self.dim, self.body = dim, body
        self.axis = int(axis) % dim
        self.height: Height = height if callable(height) else _line(height, interpolation)
        self.centre = np.zeros(dim)

    @classmethod
    def on_grid(cls, x: ArrayLike, y: ArrayLike, height: ArrayLike, **options: Any) -> Profile:
        """The profile in space through heights on a grid, with cubic splines between.

        Args:
            x: (nx,) increasing coordinates (length).
            y: (ny,) increasing coordinates (length).
            height: (nx, ny) heights (length).
            options: `axis`, `body`.

        Raises:
            TypeError, ValueError: The arrays do not fit.
        """
        x, y = _increasing("x", x), _increasing("y", y)
        heights = as_floats("height", height, "finite numbers")
        if heights.shape != (len(x), len(y)) or not np.all(np.isfinite(heights)):
            raise ValueError(f"height of shape {heights.shape}: expected finite numbers ({len(x)}, {len(y)})")
        degree = min(3, len(x) - 1, len(y) - 1)
        spline = scipy.interpolate.RectBivariateSpline(x, y, heights, kx=degree, ky=degree)

        def inside(a: Floats, b: Floats) -> Floats:
            there = (a >= x[0]) & (a <= x[-1]) & (b >= y[0]) & (b <= y[-1])
            return np.where(there, spline(a, b, grid=False), np.nan)

        return cls(inside, 3, **options)

    def __repr__(self) -> str:
        return f"Profile({self.height!r}, {self.dim}, axis={self.axis}, body={self.body!r})"

    def distance(self, x: Floats, direction: Floats) -> Floats:
        drop, speed = self._outside(x), np.abs(direction[:, self.axis])
        # Straight along the height no search is needed; else the surface is looked for about where it would be level.
        straight = speed > 1 - 1e-14
        facing = direction[:, self.axis] * self._up > 0
        found = np.where(facing & ~np.isnan(drop), drop, np.inf)
        slanted = np.flatnonzero(~straight)
        if len(slanted):
            reach = 4 * np.abs(drop) / np.maximum(speed, 0.1)
            reach = np.where(np.isnan(reach), np.nanmax(reach, initial=0.0), reach)[slanted]
            found[slanted] = entry(self._outside, x[slanted], direction[slanted], reach)
        return found

    @property
    def _up(self) -> float:
        """The sign of the way into the body along the axis."""
        return 1.0 if self.body == "above" else -1.0

    def _outside(self, x: Floats) -> Floats:
        """How far points (n, dim) are out of the body along the axis, (n,); not a number where there is nothing."""
        others = [x[:, i] for i in range(self.dim) if i != self.axis]
        height = as_floats("height", self.height(*others), "numbers")
        try:
            height = np.broadcast_to(height, len(x))
        except ValueError:
            raise ValueError(f"height: expected values of shape ({len(x)},), got {height.shape}") from None
        return np.asarray(self._up * (height - x[:, self.axis]))


def _line(points: ArrayLike, interpolation: str) -> Height:
    """The height through points (n, 2), not a number beyond them."""
    array = as_floats("height", points, "a function, or points (n, 2)")
    if array.ndim != 2 or array.shape[1] != 2 or len(array) < 2 or not np.all(np.isfinite(array)):
        raise ValueError(f"height of shape {array.shape}: expected a function, or at least two finite points (n, 2)")
    array = array[np.argsort(array[:, 0], kind="stable")]
    places, heights = _increasing("height[:, 0]", array[:, 0]), array[:, 1]
    if interpolation == "linear":
        return lambda at: np.interp(at, places, heights, left=np.nan, right=np.nan)
    smooth = scipy.interpolate.PchipInterpolator(places, heights, extrapolate=False)
    return lambda at: smooth(at)


def _increasing(name: str, values: ArrayLike) -> Floats:
    array = as_floats(name, values, "increasing numbers")
    if array.ndim != 1 or len(array) < 2 or not np.all(np.isfinite(array)) or not np.all(np.diff(array) > 0):
        raise ValueError(f"{name}: expected at least two finite numbers, each larger than the one before")
    return array
