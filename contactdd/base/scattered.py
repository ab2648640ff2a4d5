"""Values between scattered points of the plane."""

from __future__ import annotations

import numpy as np

from .arrays import Floats


def scattered(x: Floats, values: Floats, at: Floats) -> Floats:
    """Values (m, k) at points (m, 2) from those (n, k) at points x (n, 2): linear between, the nearest's beyond."""
    from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator

    inside = LinearNDInterpolator(x, values)(at)
    return np.where(np.isnan(inside), NearestNDInterpolator(x, values)(at), inside)
