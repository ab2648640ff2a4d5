"""Inverses, derivatives and integrals of laws that have them in no closed form; sums of series that don't cancel."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..base.arrays import Floats

#: Where the bisection of a compression's logarithm begins.
TINY = 1e-300


def power_series(coefficients: Sequence[float], s: Floats) -> Floats:
    """Σ coefficients[k] s^k."""
    total = np.zeros_like(s)
    for coefficient in reversed(coefficients):
        total = total * s + coefficient
    return total


def ratio(value: float | Floats, unit: float | Floats) -> Floats:
    """value / unit; NumPy's hints forget what floats they are where one is a number of Python's."""
    return np.asarray(value / unit)


def log_of_rest(s: Floats, rest: Floats) -> Floats:
    """log(1 - s), from s where it is small and from rest = 1 - s, known without cancellation, where it isn't."""
    return np.where(s < 0.5, np.log1p(-np.minimum(s, 0.5)), np.log(np.minimum(rest, 1.0)))


def relative_log1p(x: Floats) -> Floats:
    """log(1 + x) / x, 1 at x = 0."""
    return np.divide(np.log1p(x), x, out=np.ones_like(x), where=x != 0)


def relative_expm1(x: Floats) -> Floats:
    """(eˣ - 1) / x, 1 at x = 0."""
    return np.divide(np.expm1(x), x, out=np.ones_like(x), where=x != 0)


def central_derivative(function: Callable[[Floats], Floats], c: Floats, pole: float = np.inf) -> Floats:
    """function'(c) for c > 0, increasing functions, by eighth-order central differences.

    The step is 1/64 of the length over which the law changes: c, or less where it steepens towards a pole.
    """
    p, before = function(c), function(c * (1 - 1e-6))
    scale = np.divide(p * 1e-6 * c, p - before, out=c.copy(), where=p > before)
    step = np.minimum(np.minimum(c, scale), pole - c) / 64
    differences = [function(c + k * step) - function(c - k * step) for k in (1, 2, 3, 4)]
    return np.tensordot([4 / 5, -1 / 5, 4 / 105, -1 / 280], differences, axes=1) / step


def integral_from_zero(function: Callable[[Floats], Floats], c: Floats) -> Floats:
    """The integral of function from 0 to c, by tanh-sinh quadrature."""
    return c * (function(c[..., None] * _TANH_SINH_POINTS) @ _TANH_SINH_WEIGHTS)


def mean_slope(slope: Callable[[Floats], Floats], shallow: Floats, width: Floats) -> Floats:
    """The mean of a slope from shallow to shallow + width by eight Gauss points, (n,)."""
    return slope(shallow[..., None] + width[..., None] * _GAUSS_POINTS) @ _GAUSS_WEIGHTS


def solve_increasing(function: Callable[[Floats], Floats], target: Floats, lower: Floats, upper: Floats) -> Floats:
    """The c in [lower, upper], lower > 0, with function(c) = target, by bisection of log c.

    0 where the target is 0, NaN where it is NaN.
    """
    for _ in range(72):  # 2^-72 log(1e308 / 1e-300) is below the rounding of c
        middle = np.sqrt(lower) * np.sqrt(upper)
        above = function(middle) >= target
        lower, upper = np.where(above, lower, middle), np.where(above, middle, upper)
    return np.where(target > 0, upper, target)


def solve_by_newton(
    function: Callable[[Floats], tuple[Floats, Floats]], target: Floats, lower: Floats, start: Floats, upper: Floats
) -> Floats:
    """The x in [lower, upper], lower > 0, at which an increasing function is target > 0, to rounding; NaN where it is.

    Newton's method in the logarithms of both, in which powers are straight; where a step leaves the bounds, bisection.

    Args:
        function: its value, > 0, and slope at x.
    """
    x, last, found = start, np.full(np.shape(start), np.inf), np.isnan(target)
    for _ in range(NEWTON_STEPS):
        value, slope = function(x)
        above = value >= target
        lower, upper = np.where(above, lower, x), np.where(above, x, upper)
        with np.errstate(all="ignore"):  # where it is flat the step is no number, and outside the bounds
            better = x * np.exp(np.log(target / value) * value / (slope * x))
        inside = (better >= lower * (1 - NEAR)) & (better <= upper * (1 + NEAR))  # but for rounding
        better = np.where(inside, np.clip(better, lower, upper), np.sqrt(lower) * np.sqrt(upper))
        # Where the function is steep x tells that it is found, where it is flat its value.
        off = np.minimum(np.abs(better - x) / x, np.abs(value - target) / target)
        found = found | (off <= ROUNDING) | ((off < NEAR) & (off > 0.5 * last))
        x = np.where(found, x, better)
        if np.all(found):
            break
        last = off
    return x


def inverse(
    pressure: Callable[[Floats], Floats], slope: Callable[[Floats], Floats], p: Floats, limit: float | Floats
) -> Floats:
    """The c in [0, limit] with pressure(c) = p of an increasing function with p(0) = 0, by `solve_by_newton`."""
    upper = np.broadcast_to(limit, p.shape)
    wanted = np.where(p > 0, p, pressure(upper))
    c = solve_by_newton(lambda c: (pressure(c), slope(c)), wanted, np.full(p.shape, TINY), upper, upper)
    return np.where(p > 0, c, p)


#: So many that bisection in all but the last ten leaves 1e-12 of the logarithm between 1e-300 and 1: to rounding then.
NEWTON_STEPS = 60


#: Two roundings of a double.
ROUNDING = 4.5e-16


#: So near only the function's own rounding keeps Newton's method from getting nearer.
NEAR = 1e-13


def _tanh_sinh(step: float = 1 / 16, end: float = 3.5) -> tuple[Floats, Floats]:
    """Points and weights on [0, 1] that don't mind a singularity at either end."""
    t = np.arange(-end, end + step / 2, step)
    points = 1 / (1 + np.exp(-np.pi * np.sinh(t)))
    return points, step * np.pi * np.cosh(t) * points / (1 + np.exp(np.pi * np.sinh(t)))


_TANH_SINH_POINTS, _TANH_SINH_WEIGHTS = _tanh_sinh()


_GAUSS_POINTS, _GAUSS_WEIGHTS = np.array([[0.5], [0.0]]) + 0.5 * np.array(np.polynomial.legendre.leggauss(8))
