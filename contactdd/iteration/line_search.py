"""The step length that minimises the convex energy F₁ (13) along a correction."""

from __future__ import annotations

import math
from collections.abc import Callable

import scipy

#: The step need not be exact: a thousandth of it is far below what it changes in the next correction.
ACCURACY = 1e-3


#: Halvings that find where the energy is finite: the numbers up to 2^20 differ by no less than 2^-60 of them.
HALVINGS = 80


#: Slopes are differences of works; less than this part of the first slope is their rounding.
ROUNDING = 1e-15


#: By how much a step that may go much too far is shortened at a time, and where that ends.
STEEP, SHORTEST = 2.0**12, 2.0**-1000


def minimise_along(slope: Callable[[float], float], largest: float = 2.0**20) -> float:
    """The t > 0 at which the slope of a convex function along a descent direction vanishes.

    slope: dF₁/dt, which never decreases and is negative at 0; no finite number where the energy is infinite, as beyond
    a law's pole. The largest step tried is returned if it stays negative.
    """
    start, lower, upper = slope(0.0), 0.0, 1.0
    if not start < 0.0:  # at the minimum to rounding
        return 1.0
    end = slope(upper)
    if abs(end) <= ACCURACY * abs(start) and (end <= 0.0 or slope(0.5) <= 0.0):  # Newton's step, as always near the end
        return 1.0
    known = {0.0: start}
    while end < 0.0:
        if upper >= largest:
            return upper
        known[upper], lower = end, upper
        upper *= 2.0
        end = slope(upper)
    for _ in range(HALVINGS):
        if math.isfinite(end):
            break
        middle = 0.5 * (lower + upper)
        answer = slope(middle)
        if answer < 0.0:
            known[middle], lower = answer, middle
        else:
            upper, end = middle, answer
    if not math.isfinite(end):  # the slope is negative up to the pole itself
        return lower
    # A law that grows by powers of ten along the step, as an exponential one, ends the search far below 1.
    while lower == 0.0 and upper > SHORTEST:
        answer = slope(shorter := upper / STEEP)
        if answer < -ROUNDING * abs(start):
            known[shorter], lower = answer, shorter
        else:
            upper, end = shorter, answer
    if end <= 0.0:  # to rounding
        return upper
    known[upper] = end  # brentq asks for them again
    found = scipy.optimize.brentq(
        lambda t: known[t] if t in known else slope(t), lower, upper, xtol=1e-12 * upper, rtol=ACCURACY
    )
    return float(found)
