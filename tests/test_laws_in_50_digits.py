"""All five functions of a law against its pressure in 50 digits, whose derivative and integral mpmath finds."""

from __future__ import annotations

from itertools import pairwise

import mpmath
import numpy as np
import pytest

import contactdd as cd
from contactdd.layers.halved import half

mp, number = mpmath.mp, mpmath.mpf
HERE = np.array([[0.25], [0.0]])
POINTS = [0.02, 0.05, 0.08, 0.1], [2.0, 8.0, 22.0, 40.0]
TABLE = cd.TableLayer(*POINTS, smooth=False)
KNOTS = [(number(c), number(p)) for c, p in zip((0.0, *POINTS[0]), (0.0, *POINTS[1]), strict=True)]


def power(B, a):
    return lambda c: (c / number(B)) ** (1 / number(a))


def straight(c):
    """The table's lines, the last one going on."""
    inner = [i for i in range(1, len(KNOTS) - 1) if KNOTS[i][0] <= c]
    (c0, p0), (c1, p1) = KNOTS[len(inner)], KNOTS[len(inner) + 1]
    return p0 + (p1 - p0) * (c - c0) / (c1 - c0)


def smooth(c):
    """The table's monotone cubic after Fritsch and Butland, with the three-point formula at its ends."""
    widths = [b[0] - a[0] for a, b in pairwise(KNOTS)]
    chords = [(b[1] - a[1]) / (b[0] - a[0]) for a, b in pairwise(KNOTS)]
    slopes = [end(widths[0], widths[1], chords[0], chords[1])]
    for h, g, left, right in zip(widths, widths[1:], chords, chords[1:], strict=False):
        slopes.append(3 * (h + g) / ((2 * g + h) / left + (g + 2 * h) / right))
    slopes.append(end(widths[-1], widths[-2], chords[-1], chords[-2]))
    i = len([k for k in range(1, len(KNOTS) - 1) if KNOTS[k][0] <= c])
    t, h, (p0, p1) = (c - KNOTS[i][0]) / widths[i], widths[i], (KNOTS[i][1], KNOTS[i + 1][1])
    rise = t**2 * (3 - 2 * t)
    return p0 + (p1 - p0) * rise + h * t * (1 - t) * ((1 - t) * slopes[i] - t * slopes[i + 1])


def end(h, g, chord, inner):
    slope = ((2 * h + g) * chord - h * inner) / (h + g)
    return chord / 2 if slope <= 0 else min(slope, 3 * chord)


def series(B, a, K, V):
    """Of a power law and a hyperbola, whose compressions at a pressure are known; by bisection, then Newton's steps."""

    def excess(p, c):
        return number(B) * p ** number(a) + p / (number(K) + p / number(V)) - c

    return lambda c: mp.findroot(lambda p: excess(p, c), (c * number("1e-9"), c * number(K)), solver="anderson")


def unloaded(c):
    """From the closure 0.08 straight down by 2000, and upwards from there the table; c counts from what stays."""
    top, p = KNOTS[3]
    return 2000 * c if 2000 * c <= p else straight(c + top - p / 2000)


SET = KNOTS[3][0] - KNOTS[3][1] / 2000
GASKET = cd.GasketLayer(TABLE, 2000.0).remembering(HERE, [0.08])
FOUNDATION = number(10) * (1 - number("0.25")) / ((1 + number("0.25")) * (1 - 2 * number("0.25"))) / number("0.5")

#: The law, its pressure in 50 digits, the largest compression that is tried, and where the pressure has kinks.
LAWS = {
    "power": (cd.PowerLayer(4e-6, 1.1), power(4e-6, 1.1), 1e-3, ()),
    "power, soft at rest": (cd.PowerLayer(1e-3, 0.4), power(1e-3, 0.4), 1e-2, ()),
    "linear": (cd.LinearLayer(3e4), lambda c: 3e4 * c, 1.0, ()),
    "foundation": (cd.LinearLayer.elastic_foundation(10.0, 0.25, 0.5), lambda c: FOUNDATION * c, 0.1, ()),
    "machined joint": (cd.PowerLayer.machined_joint(0.75, 0.5), power(0.75e-3, 0.5), 5e-3, ()),
    "straight table": (TABLE, straight, 0.1, [c for c, _ in KNOTS[1:-1]]),
    "smooth table": (cd.TableLayer(*POINTS), smooth, 0.1, [c for c, _ in KNOTS[1:-1]]),
    "series": (
        cd.SeriesLayer(cd.PowerLayer(1e-3, 1.5), cd.HyperbolicLayer(1e3, 0.5)),
        series(1e-3, 1.5, 1e3, 0.5),
        0.4,
        (),
    ),
    "varying": (
        cd.VaryingLayer(cd.PowerLayer, B=lambda x: 1e-6 * (1 + x[0]), a=1.25).at(HERE),
        power(1.25e-6, 1.25),
        1e-3,
        (),
    ),
    "custom": (cd.CustomLayer(lambda w: 50 * np.sinh(20 * w)), lambda c: 50 * mp.sinh(20 * c), 0.2, ()),
    "half at a mirror": (half(cd.PowerLayer(4e-6, 1.1)), lambda c: power(4e-6, 1.1)(2 * c), 1e-3, ()),
    "bond in compression": (cd.BondedLayer(cd.PowerLayer(1e-4, 1.5)), power(1e-4, 1.5), 1e-2, ()),
    "unloaded gasket": (GASKET, unloaded, 0.05, [KNOTS[3][1] / 2000, KNOTS[4][0] - SET]),
}
#: A law given as a function is known by its differences and Gauss points only; sums over a table's knots add roundings.
TOLERANCES = {"custom": 1e-9, "straight table": 1e-12, "smooth table": 1e-12, "unloaded gasket": 1e-12}
every_law = pytest.mark.parametrize("name", LAWS)


def off(value, exact):
    """The relative error of a law's value at one point."""
    return abs(float((number(float(value[0])) - exact) / exact))


def pairs(length):
    """Compressions deep and shallow: unrelated, close, equal."""
    rng = np.random.default_rng(0)
    for k in range(15):
        deep = length * 10.0 ** rng.uniform(-6 if k % 2 else -1, 0)
        yield deep, deep * (rng.uniform(), 1 - 10.0 ** rng.uniform(-15, -2), 1.0)[k % 3]


@pytest.fixture(autouse=True)
def fifty_digits():
    with mpmath.workdps(50):
        yield


@every_law
def test_all_functions(name):
    law, pressure, length, kinks = LAWS[name]
    tolerance = TOLERANCES.get(name, 2e-13)
    for deep, shallow in pairs(length):
        c, d = number(deep), number(shallow)
        inside, z, y = [kink / c for kink in kinks if kink < c], np.array([-deep]), np.array([-shallow])
        slope = mp.diff(pressure, c, h=c * number("1e-20"))
        assert off(-law.contact_stress(z), pressure(c)) < tolerance
        assert off(law.contact_derivative(z), slope) < max(tolerance, 1e-13)
        secant = slope if c == d else (pressure(c) - pressure(d)) / (c - d)
        assert off(law.divided_difference(z, y), secant) < tolerance
        with mpmath.workdps(20):  # the integral needs no more, nor does a root in every point of it
            top = pressure(c)
            energy = c * top * mp.quad(lambda s: pressure(c * s) / top, [0, *inside, 1])  # noqa: B023  # used at once
        assert off(law.energy(z), energy) < max(tolerance, 1e-12)


@every_law
def test_inverse(name):
    """By how much the compression of a pressure is off, to first order."""
    law, pressure, length, _ = LAWS[name]
    for c in length * np.logspace(-5, 0, 9)[:, None]:
        p = -law.contact_stress(-c)
        found = number(float(-law.compression(-p)[0]))
        slope = mp.diff(pressure, found, h=found * number("1e-20"), direction=-1)
        error = (pressure(found) - number(float(p[0]))) / slope / found
        assert abs(float(error)) < TOLERANCES.get(name, 2e-13)
