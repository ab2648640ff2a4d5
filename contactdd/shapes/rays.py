"""Where rays enter a shape that is given by a function."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..base.arrays import Floats

#: How many places along a ray are looked at: what is thinner than this part of its reach may be missed.
PLACES = 129


def entry(level: Callable[[Floats], Floats], x: Floats, direction: Floats, reach: Floats) -> Floats:
    """The distances (n,) along rays at which a level set becomes negative, of several that next to the point.

    level: from points (n, dim) to values (n,), not a number where there is nothing; reach: (n,) how far along a ray to
    look, to both sides. Infinite for rays that enter nothing. Bisection, down to rounding.
    """
    places = np.linspace(-1.0, 1.0, PLACES) * reach[:, None]
    points = x[:, None] + places[:, :, None] * direction[:, None]
    values = level(points.reshape(-1, x.shape[1])).reshape(places.shape)
    entering = (values[:, :-1] > 0.0) & (values[:, 1:] <= 0.0)
    middle = np.abs(places[:, :-1] + places[:, 1:])
    first = np.where(entering, middle, np.inf).argmin(axis=1)
    rows = np.arange(len(x))
    low, high = places[rows, first], places[rows, first + 1]
    for _ in range(60):
        half = 0.5 * (low + high)
        outside = level(x + half[:, None] * direction) > 0.0
        low, high = np.where(outside, half, low), np.where(outside, high, half)
    return np.where(entering.any(axis=1), high, np.inf)
