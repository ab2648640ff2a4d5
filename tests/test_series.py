"""Layers in series: how often each layer's inverse is asked for, and how accurate the inverse of a table is."""

from __future__ import annotations

import numpy as np
import pytest

import contactdd as cd
from contactdd.layers import calculus

SHEET = {"compressions": [0.05, 0.1, 0.2, 0.3, 0.4], "pressures": [2.0, 6.0, 20.0, 45.0, 90.0]}
PARTNERS = {
    "line": cd.LinearLayer(1e4),
    "soft power": cd.PowerLayer(1e-3, 2.0),
    "stiff power": cd.PowerLayer(4e-3, 0.5),
    "wall": cd.HyperbolicLayer(3e4, 0.2),
    "exponential": cd.ExponentialLayer(5.0, 1e-3),
    "another table": cd.TableLayer([0.1, 0.3], [2.0, 50.0], smooth=False),
}


class Counted(cd.TableLayer):
    """A table that counts how often it is inverted."""

    def _depth(self, p):
        COUNTS.append(p)
        return super()._depth(p)


COUNTS: list[np.ndarray] = []


@pytest.mark.parametrize("partner", PARTNERS.values(), ids=PARTNERS)
def test_few_inverses_are_enough(partner):
    """Newton's method doubles the digits: from bounds within a factor of ten, a dozen steps at all points at once."""
    layer = cd.SeriesLayer(Counted(**SHEET), partner)
    p = np.logspace(-9, 2, 100)
    c = -layer.compression(-p)
    COUNTS.clear()
    found = -layer.contact_stress(-c)
    assert 2 <= len(COUNTS) <= 13
    # Of c's own rounding and its parts'; nine times as much where the exponential is steepest.
    np.testing.assert_allclose(found, p, rtol=5e-15)


@pytest.mark.parametrize("smooth", [True, False])
def test_table_inverts_itself_to_rounding(smooth):
    """At its knots, close to them, close to nothing, and beyond its end."""
    table = cd.TableLayer(**SHEET, smooth=smooth)
    knots = np.array(SHEET["compressions"])
    c = np.concatenate([knots, knots * (1 - 1e-15), knots * (1 + 1e-15), np.logspace(-300, 0, 301)])
    np.testing.assert_allclose(-table.compression(table.contact_stress(-c)), c, rtol=2e-15)
    assert np.isnan(table.compression(np.nan))
    assert table.compression(0.0) == 0.0


@pytest.mark.parametrize(
    "law",
    [cd.GreenwoodWilliamsonLayer(1e5, 300.0, 0.05, 1e-3), cd.OverclosureLayer(5.0, 1e-3)],
    ids=["rough", "overclosure"],
)
def test_laws_without_an_inverse_invert_themselves(law, monkeypatch):
    """From nearly nothing to their end at once, in fewer evaluations than a bisection's 72."""
    c, pressures = law.compression_limit * np.logspace(-12, 0, 100), []
    p, known = -law.contact_stress(-c), type(law)._known_pressure
    monkeypatch.setattr(type(law), "_known_pressure", lambda self, c: pressures.append(c) or known(self, c))
    found = -law.compression(-p)
    assert 2 <= len(pressures) <= 24
    np.testing.assert_allclose(found, c, rtol=1e-14)  # exp(-t²/2) up to t = 8 loses 1.5 digits
    assert np.isnan(law.compression(np.nan))
    assert law.compression(0.0) == 0.0


def test_newton_keeps_between_its_bounds():
    """A root that Newton's method alone would not find: the function is flat at the start, and its step goes astray."""

    def steps(x):
        return 2 + np.tanh(50 * (x - 1)), 50 / np.cosh(50 * (x - 1)) ** 2

    target = np.array([1.5, 2.0, 2.5])
    start = np.full(3, 1.3)
    x = calculus.solve_by_newton(steps, target, np.full(3, 0.5), start, np.full(3, 1.5))
    np.testing.assert_allclose(steps(x)[0], target, rtol=1e-14)
