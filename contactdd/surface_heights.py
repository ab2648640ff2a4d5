"""Measured or computed rough surfaces, whose heights are a contact's gap."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import scipy
from numpy.typing import ArrayLike

from .base.arrays import Floats
from .base.checks import as_bool, as_floats, positive

#: Coordinates this part of a step beyond the outermost are their rounding.
SLACK = 1e-9


class SurfaceHeights:
    """The gap under a rough surface: how far it lies below its highest point, a function of coordinates.

    Given as the `gap` of a `Contact`. Heights are linear between their places, which are the middles of equal cells
    along x, or x and y, around the point `middle`, as the places of a `PeriodicHalfSpace` are; the outermost half cells
    are even.

    Args:
        heights: (nx,) along a line, or (nx, ny) on a grid, 2 or more each, counted out of the body (length).
        size: The extent of all cells along x, or (2,) along x and y (length).
        middle: Its coordinate x, or (2,) coordinates (length), 0 by default.
        periodic: Whether the surface repeats itself; else it is not known further out, and refused there.

    Attributes:
        heights: As given.

    Raises:
        TypeError, ValueError: An argument is none of these.

    Example:
        >>> gap = SurfaceHeights([0.0, 2.0, 1.0], size=3.0)
        >>> gap(np.array([[-1.0, 0.0, 0.5], [9.0, 9.0, 9.0]]))
        array([2. , 0. , 0.5])
    """

    def __init__(self, heights: ArrayLike, size: ArrayLike, *, middle: ArrayLike = 0.0, periodic: bool = False) -> None:
        self.heights = as_floats("heights", heights, "numbers (nx,) or (nx, ny)")
        shape = self.heights.shape
        if len(shape) not in (1, 2) or min(shape) < 2 or not np.all(np.isfinite(self.heights)):
            raise ValueError(f"heights of shape {shape}: expected finite numbers (nx,) or (nx, ny), 2 or more each")
        self.size, self.middle = _each("size", size, len(shape)), _each("middle", middle, len(shape))
        for extent in self.size:
            positive("size", float(extent))
        self.periodic = as_bool("periodic", periodic)
        self._depths = self.heights.max() - self.heights

    @classmethod
    def read(cls, path: str | Path, *, length_unit: float = 1.0, **options: Any) -> SurfaceHeights:
        """The surface in a file of an instrument, by the package SurfaceTopography, if that is installed.

        Args:
            path: Of any file that it opens, with equal steps and without missing points.
            length_unit: The file's unit of length in yours, such as 1e-3 for µm where you use mm.
            options: `middle`; `periodic`, by default as the file says.

        Raises:
            ImportError: SurfaceTopography is not installed.
            ValueError: Points are missing, or their steps are not equal.
        """
        from SurfaceTopography import open_topography

        with open_topography(str(path)) as reader:
            surface = reader.topography()
        if not surface.is_uniform or surface.has_undefined_data:
            raise ValueError(f"path = {str(path)!r}: expected equal steps and a height at every point")
        unit = positive("length_unit", length_unit)
        heights = np.ma.getdata(surface.heights())
        return cls(
            unit * heights, unit * np.array(surface.physical_sizes), **{"periodic": bool(surface.is_periodic)} | options
        )

    def __repr__(self) -> str:
        return f"SurfaceHeights({' × '.join(map(str, self.heights.shape))}, size={self.size.tolist()})"

    def __call__(self, x: Floats) -> Floats:
        """The gaps (n,) at points (length).

        Args:
            x: (dim, n) coordinates, of which the first, or the first two, count (length).

        Raises:
            ValueError: A point lies beyond a surface that does not repeat itself.
        """
        counts = np.array(self.heights.shape)[:, None]
        at = (x[: len(counts)] - self.middle[:, None]) / self.size[:, None] * counts + 0.5 * counts - 0.5
        beyond = np.any((at < -0.5 - SLACK) | (at > counts - 0.5 + SLACK), axis=0)
        if not self.periodic and np.any(beyond):
            worst = int(np.argmax(beyond))
            raise ValueError(f"{self!r}: not known at x = {x[:, worst]}; expected points on it, or periodic=True")
        mode = "grid-wrap" if self.periodic else "nearest"
        return np.asarray(scipy.ndimage.map_coordinates(self._depths, at, order=1, mode=mode))


def _each(name: str, value: ArrayLike, count: int) -> Floats:
    """`value` as finite numbers (count,)."""
    array = np.atleast_1d(as_floats(name, value, f"{count} finite numbers"))
    array = np.repeat(array, count) if name == "middle" and array.shape == (1,) else array
    if array.shape != (count,) or not np.all(np.isfinite(array)):
        raise ValueError(f"{name} = {value!r}: expected {count} finite numbers")
    return array
