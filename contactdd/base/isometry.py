"""Motions along the axes and mirror images in planes across them: how one mesh is a copy of another."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arrays import Floats

#: Coordinates of copies differ by this part of the largest of them: twice their own rounding.
ROUNDING = 2e-15


@dataclass(frozen=True, eq=False)
class Isometry:
    """The map x ↦ signs · x + offset, component by component.

    signs: (dim,) of 1 and −1; offset: (dim,) a length.
    """

    signs: Floats
    offset: Floats

    def __call__(self, x: Floats) -> Floats:
        """The images (n, dim) of points x (n, dim)."""
        return self.signs * x + self.offset

    @property
    def mirrors(self) -> bool:
        """Whether any component is mirrored."""
        return bool(np.any(self.signs < 0.0))

    @property
    def inverse(self) -> Isometry:
        """From the images back to the points."""
        return Isometry(self.signs, -self.signs * self.offset)

    def after(self, first: Isometry) -> Isometry:
        """The isometry x ↦ self(first(x))."""
        return Isometry(self.signs * first.signs, self.signs * first.offset + self.offset)


def translation(offset: Floats) -> Isometry:
    """x ↦ x + offset, offset (dim,)."""
    return Isometry(np.ones(len(offset)), offset)


def reflection(dim: int, axis: int, at: float) -> Isometry:
    """The mirror image in the plane x[axis] = at."""
    across = np.arange(dim) == axis
    return Isometry(np.where(across, -1.0, 1.0), np.where(across, 2.0 * at, 0.0))


def isometry_between(x: Floats, y: Floats) -> Isometry | None:
    """The isometry that takes points x (n, dim) to y (n, dim), one by one, to the rounding of their coordinates."""
    if x.shape != y.shape:
        return None
    # Seen from the first point every component is the same, or, mirrored, the opposite.
    here, there = x - x[0], y - y[0]
    signs = np.where(np.einsum("ni,ni->i", here, there) < 0.0, -1.0, 1.0)
    rounding = ROUNDING * max(float(np.abs(x).max()), float(np.abs(y).max()))
    if np.abs(there - signs * here).max() > rounding:
        return None
    return Isometry(signs, y[0] - signs * x[0])


def rounded(lengths: Floats, size: float) -> bytes:
    """Lengths in units of a small part of `size`, rounded: a key that their own rounding hardly changes.

    The unit is not round, so that no usual length lies between two multiples.
    """
    return np.rint(lengths * (123456.7 / size)).astype(np.int64).tobytes()


def turned(tensor: Floats, signs: Floats) -> Floats:
    """C_ijkl (dim, dim, dim, dim) of a material after the axes with the sign −1 were mirrored."""
    pairs = signs[:, None] * signs
    return tensor * pairs[:, :, None, None] * pairs
