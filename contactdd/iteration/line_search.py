"""The step length that minimises the convex energy F₁ (13) along a correction."""

from __future__ import annotations

from collections.abc import Callable

import scipy

#: The step need not be exact: a thousandth of it is far below what it changes in the next correction.
ACCURACY = 1e-3


def minimise_along(slope: Callable[[float], float], largest: float = 2.0**20) -> float:
    """The t > 0 at which the slope of a convex function along a descent direction vanishes.

    slope: dF₁/dt, which never decreases and is negative at 0. The largest step tried is returned if it stays negative.
    """
    start, upper = slope(0.0), 1.0
    if start >= 0.0:  # at the minimum to rounding
        return 1.0
    end = slope(upper)
    if abs(end) <= ACCURACY * abs(start):  # Newton's step, as always near the end
        return 1.0
    while end < 0.0:
        if upper >= largest:
            return upper
        upper *= 2.0
        end = slope(upper)
    known = {0.0: start, upper: end}  # brentq asks for them again
    found = scipy.optimize.brentq(lambda t: known[t] if t in known else slope(t), 0.0, upper, xtol=1e-12, rtol=ACCURACY)
    return float(found)
