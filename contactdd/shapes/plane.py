"""Flat shapes: a half-plane or half-space, and the flat end of a punch."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.checks import positive
from .shape import Shape, as_direction, as_point, dot, upwards


class Plane(Shape):
    """A flat face that never ends; the body lies behind it.

    Args:
        point: (dim,) any of its points (length).
        normal: (dim,) out of the body, towards what it touches.

    Raises:
        TypeError, ValueError: An argument is none of these.

    Example:
        >>> Plane((0, 2), (0, -1)).distance(np.array([[5.0, 0.0]]), np.array([[0.0, 1.0]]))
        array([2.])
    """

    def __init__(self, point: ArrayLike, normal: ArrayLike) -> None:
        self.centre = as_point("point", point)
        self.dim = len(self.centre)
        self.normal = as_direction("normal", normal, self.dim)

    def __repr__(self) -> str:
        return f"Plane({self.centre.tolist()}, {self.normal.tolist()})"

    def distance(self, x: Floats, direction: Floats) -> Floats:
        return plane_distance(x, direction, self.centre, self.normal)


class FlatPunch(Shape):
    """A punch with a flat end and a sharp edge: a cylinder, in the plane a strip.

    The pressure of elastic bodies is singular at its edge; meshes should have nodes there, and the rule "gauss": of a
    hard contact and with "mortar" a node at the edge, half of whose surroundings are opposite nothing, carries nothing.
    A rounded edge is a `Profile`.

    Args:
        centre: (dim,) the middle of its end (length); on the axis of a body of revolution.
        radius: Of the end, in the plane its half width (length).
        axis: (dim,) from its end into the punch, by default along the last coordinate.

    Raises:
        TypeError, ValueError: An argument is none of these.
    """

    def __init__(self, centre: ArrayLike, radius: float, axis: ArrayLike | None = None) -> None:
        self.centre = as_point("centre", centre)
        self.dim = len(self.centre)
        self.radius = positive("radius", radius)
        self.axis = upwards(self.dim) if axis is None else as_direction("axis", axis, self.dim)

    def __repr__(self) -> str:
        return f"FlatPunch({self.centre.tolist()}, {self.radius:g})"

    def distance(self, x: Floats, direction: Floats) -> Floats:
        found = plane_distance(x, direction, self.centre, -self.axis)
        there: Any = x + np.where(np.isfinite(found), found, 0.0)[:, None] * direction - self.centre
        aside = there - dot(there, self.axis)[:, None] * self.axis
        # A node on the edge belongs to the end whatever the last bit of its coordinates is.
        return np.where(np.linalg.norm(aside, axis=1) <= self.radius * (1 + 1e-12), found, np.inf)


def plane_distance(x: Floats, direction: Floats, point: Floats, normal: Floats) -> Floats:
    """The distances (n,) along rays to a plane, infinite where they do not run against its normal."""
    against = -dot(direction, normal)
    facing = against > 1e-12  # beyond that rays run along the plane
    return np.where(facing, dot(x - point, normal) / np.where(facing, against, 1.0), np.inf)
