"""Shapes that a quadratic equation describes: cylinders, spheres and cones."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import TINY, Floats
from ..base.checks import as_bool, finite, positive
from .shape import Shape, as_direction, as_point, dot, upwards


class Sphere(Shape):
    """A sphere, or the hollow of that form in a body around it.

    Args:
        centre: (dim,) in space; on the axis, (0, z), of a body of revolution (length).
        radius: Its radius (length).
        hollow: Whether the body lies outside, as a ball's seat does.

    Raises:
        TypeError, ValueError: An argument is none of these.

    Example:
        >>> Sphere((0, 2), 1).distance(np.array([[0.0, 0.0], [5.0, 0.0]]), np.array([[0.0, 1.0], [0.0, 1.0]]))
        array([ 1., inf])
    """

    def __init__(self, centre: ArrayLike, radius: float, *, hollow: bool = False) -> None:
        self.centre = as_point("centre", centre)
        self.dim = len(self.centre)
        self.radius, self.hollow = positive("radius", radius), as_bool("hollow", hollow)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.centre.tolist()}, {self.radius:g})"

    def distance(self, x: Floats, direction: Floats) -> Floats:
        return self._distance(x - self.centre, direction)

    def _distance(self, offset: Floats, direction: Floats) -> Floats:
        """|offset + t direction| = radius; the smaller root is where a ray enters, the larger where it leaves."""
        first, second = _roots(
            dot(direction, direction), 2 * dot(offset, direction), dot(offset, offset) - self.radius**2
        )
        return second if self.hollow else first


class Cylinder(Sphere):
    """A cylinder, in the plane a circle, or the bore of that form in a body around it.

    Args:
        centre: (dim,) a point of its axis (length).
        radius: Its radius (length).
        axis: (3,) in space its direction.
        hollow: Whether the body lies outside, as a bearing does.

    Raises:
        TypeError, ValueError: An argument is none of these.
    """

    def __init__(
        self, centre: ArrayLike, radius: float, axis: ArrayLike | None = None, *, hollow: bool = False
    ) -> None:
        super().__init__(centre, radius, hollow=hollow)
        if (axis is None) != (self.dim == 2):
            raise ValueError(f"axis = {axis!r} of a cylinder in {self.dim} dimensions: expected one in space only")
        self.axis = None if axis is None else as_direction("axis", axis, 3)

    def distance(self, x: Floats, direction: Floats) -> Floats:
        return self._distance(self._across(x - self.centre), self._across(direction))

    def _across(self, vectors: Floats) -> Floats:
        """The part of vectors (n, dim) across the axis."""
        return vectors if self.axis is None else vectors - dot(vectors, self.axis)[:, None] * self.axis


class Cone(Shape):
    """A cone, in the plane a wedge.

    Args:
        tip: (dim,) its tip (length); on the axis of a body of revolution.
        half_angle: Between its axis and its side (radians), above 0 and below π/2.
        axis: (dim,) from the tip into the cone, by default along the last coordinate.

    Raises:
        TypeError, ValueError: An argument is none of these.
    """

    def __init__(self, tip: ArrayLike, half_angle: float, axis: ArrayLike | None = None) -> None:
        self.centre = as_point("tip", tip)
        self.dim = len(self.centre)
        self.half_angle = finite("half_angle", half_angle)
        if not 0.0 < self.half_angle < math.pi / 2:
            raise ValueError(f"half_angle = {half_angle!r}: expected radians above 0 and below π/2")
        self.axis = upwards(self.dim) if axis is None else as_direction("axis", axis, self.dim)

    def __repr__(self) -> str:
        return f"Cone({self.centre.tolist()}, {self.half_angle:g})"

    def distance(self, x: Floats, direction: Floats) -> Floats:
        # (A·q)² = cos²α |q|² with A·q ≥ 0 for q = x + t direction − tip; of both roots that where the ray enters.
        offset, squared = x - self.centre, math.cos(self.half_angle) ** 2
        along, speed = dot(offset, self.axis), dot(direction, self.axis)
        roots = _roots(
            speed**2 - squared,
            2 * (along * speed - squared * dot(offset, direction)),
            along**2 - squared * dot(offset, offset),
        )
        return np.minimum(*(self._if_entering(root, offset, direction) for root in roots))

    def _if_entering(self, t: Floats, offset: Floats, direction: Floats) -> Floats:
        """The roots at which rays come into the cone, and not into its other half beyond the tip; else infinity."""
        q = offset + np.where(np.isfinite(t), t, 0.0)[:, None] * direction
        length = np.linalg.norm(q, axis=1)
        ahead = dot(q, self.axis) >= -1e-12 * np.linalg.norm(offset, axis=1)
        outward = math.cos(self.half_angle) * dot(q, direction) / np.maximum(length, TINY)
        return np.where(ahead & (dot(direction, self.axis) > outward), t, np.inf)


def _roots(a: Floats, b: Floats, c: Floats) -> tuple[Floats, Floats]:
    """Both roots of a t² + b t + c = 0, infinite where there is none; the smaller first where a > 0.

    Without cancellation: one root from the sum of what has the same sign, the other from their product c/a. A root
    that is double but for rounding counts: rays touch a tip or a side.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        discriminant = b**2 - 4 * a * c
        grazing = np.abs(discriminant) <= 1e-15 * (b**2 + np.abs(4 * a * c))
        root = np.sqrt(np.where(grazing, 0.0, discriminant))
        half = -0.5 * (b + np.where(b < 0, -1.0, 1.0) * root)
        one, other = half / a, c / half
        first, second = np.where(b < 0, other, one), np.where(b < 0, one, other)
    return np.where(np.isfinite(first), first, np.inf), np.where(np.isfinite(second), second, np.inf)
