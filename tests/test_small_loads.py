"""Hard contact under loads that press surfaces in by less than the rounding of the way that they came."""

from __future__ import annotations

import pytest
from test_pressures import ground, plate, solved, waves

import contactdd as cd


@pytest.mark.parametrize("force", [1e-8, 1e-9, 1e-10])
def test_the_highest_point_alone_bears_a_small_load(force):
    found = solved([ground(16), plate(force)], cd.HardContact())
    result = found.contact()
    assert result.force == pytest.approx(force, rel=1e-9)  # the residual is 1e-10 of it
    assert (result.pressure > 0).sum() == 1
    assert result.gap.min() > -1e-17  # the way is some 1e-3


@pytest.mark.parametrize("away", [1.0, 100.0])
def test_a_long_way_to_the_contact(away):
    """The pressures do not tell how far the plate was away."""
    near, far = (solved([ground(16), plate()], cd.HardContact(), gap=lambda x, d=d: d + waves(x)) for d in (0.0, away))
    # Heights are rounded to 1e-16 of the way, and between points 1/16 apart bent by a stiffness of some 1e3 · 16.
    rounding = 2e-16 * away * 1e3 * 16
    assert far.contact().pressure == pytest.approx(near.contact().pressure, abs=10 * rounding)
