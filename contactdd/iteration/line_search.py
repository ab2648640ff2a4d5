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


#: Evaluations by which a step is found as a rule.
USUAL = 20


#: By how much a step that may go much too far is shortened at a time, and where that ends.
STEEP, SHORTEST = 2.0**12, 2.0**-1000


def minimise_along(slope: Callable[[float], float], curvature: float = 0.0, largest: float = 2.0**20) -> float:
    """The t > 0 at which the slope of a convex function along a descent direction vanishes.

    slope: dF₁/dt, which never decreases and is negative at 0; no finite number where the energy is infinite, as beyond
    a law's pole. curvature: a lower bound of d²F₁/dt². The largest step tried is returned if the slope stays negative.
    """
    start, lower, upper = slope(0.0), 0.0, 1.0
    if not start < 0.0:  # at the minimum to rounding
        return 1.0
    end = slope(upper)
    near = end <= ACCURACY * curvature  # a thousandth of the start is not, where slopes fall by powers of ten
    if abs(end) <= ACCURACY * abs(start) and (near or slope(0.5) <= 0.0):  # Newton's step, as always near the end
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
    known[upper] = end
    if lower == 0.0:
        found, converged = _root(slope, known, lower, upper, USUAL)
        if converged:
            return found
    # A law that grows by powers of ten along the step, as an exponential one, ends the search far below 1.
    while lower == 0.0 and upper > SHORTEST:
        shorter = upper / STEEP
        known[shorter] = answer = slope(shorter)
        if answer < -ROUNDING * abs(start):
            lower = shorter
        else:
            upper, end = shorter, answer
    return upper if end <= 0.0 else _root(slope, known, lower, upper, HALVINGS)[0]  # to rounding


def _root(
    slope: Callable[[float], float], known: dict[float, float], lower: float, upper: float, most: int
) -> tuple[float, bool]:
    """The zero of a slope between two steps, and whether it was found by so many evaluations at most.

    known: slopes that are not to be found again.
    """

    def answer(t: float) -> float:
        return known[t] if t in known else slope(t)

    found, search = scipy.optimize.brentq(
        answer, lower, upper, xtol=SHORTEST, rtol=ACCURACY, maxiter=most, full_output=True, disp=False
    )
    return float(found), bool(search.converged)
