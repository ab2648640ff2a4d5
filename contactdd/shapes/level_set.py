"""A shape given as where a function is negative."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.checks import positive
from ..field import evaluate
from .rays import entry
from .shape import Shape, as_point


class LevelSet(Shape):
    """The body where a function of the coordinates is negative.

    Args:
        function: From the coordinates x (dim, points) to values (points,), negative inside of the body and positive
            outside; any will do that changes sign at its surface.
        centre: (dim,) the point about which it turns (length).
        reach: How far from a contact's points the surface is looked for (length); what is thinner than a sixtieth of
            it may be overlooked.

    Raises:
        TypeError, ValueError: An argument is none of these.

    Example:
        >>> ellipse = LevelSet(lambda x: (x[0] / 2) ** 2 + (x[1] - 1) ** 2 - 1, centre=(0, 1), reach=4)
        >>> print(ellipse.distance(np.array([[1.0, 0.0]]), np.array([[0.0, 1.0]])).round(6))
        [0.133975]
    """

    def __init__(self, function: Callable[[Floats], ArrayLike], centre: ArrayLike, reach: float) -> None:
        if not callable(function):
            raise TypeError(f"function = {function!r}: expected a function of the coordinates x (dim, points)")
        self.centre = as_point("centre", centre)
        self.dim = len(self.centre)
        self.function, self.reach = function, positive("reach", reach)

    def __repr__(self) -> str:
        return f"LevelSet({self.function!r}, {self.centre.tolist()})"

    def distance(self, x: Floats, direction: Floats) -> Floats:
        return entry(lambda at: evaluate("function", self.function, at.T), x, direction, np.full(len(x), self.reach))
