"""What a contact asks of a shape: where rays enter it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from ..base.arrays import Floats
from ..base.checks import as_floats


class Shape(ABC):
    """The shape of a rigid body, in the coordinates of the scene.

    Attributes:
        dim: The number of coordinates: 2 in the plane and of bodies of revolution (the radius and the axis), else 3.
        centre: (dim,) the point about which the body turns if no other is given (length).
    """

    dim: int
    centre: Floats

    @abstractmethod
    def distance(self, x: Floats, direction: Floats) -> Floats:
        """The distances (n,) along rays to where they enter the shape (length).

        Negative where a point lies inside; infinite for a ray that meets nothing.

        Args:
            x: (n, dim) points.
            direction: (n, dim) unit vectors.
        """


def as_point(name: str, value: Any) -> Floats:
    """`value` as coordinates (2,) or (3,)."""
    point = as_floats(name, value, "2 or 3 finite numbers")
    if point.shape not in ((2,), (3,)) or not np.all(np.isfinite(point)):
        raise ValueError(f"{name} = {value!r}: expected 2 or 3 finite numbers")
    return point


def as_direction(name: str, value: Any, dim: int) -> Floats:
    """`value` as a unit vector (dim,)."""
    vector = as_floats(name, value, f"{dim} numbers, not all zero")
    length = float(np.linalg.norm(vector))
    if vector.shape != (dim,) or not 0.0 < length < np.inf:
        raise ValueError(f"{name} = {value!r}: expected {dim} numbers, not all zero")
    return vector / length


def upwards(dim: int) -> Floats:
    """The unit vector along the last coordinate."""
    return np.eye(dim)[-1]


def dot(a: Floats, b: Floats) -> Floats:
    """The scalar products of vectors, along their last axis."""
    return np.sum(a * b, axis=-1)
