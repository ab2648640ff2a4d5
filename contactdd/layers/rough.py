"""The contact of rough surfaces: summits of one radius whose heights are distributed by Gauss."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..base.arrays import Floats
from ..base.checks import positive_values
from .calculus import inverse, mean_slope, ratio
from .limited import LimitedLayer

#: The separation at which the law begins, in σ: the highest summit of 1e15. Less of the force than rounding is above.
HIGHEST = 8.0


#: The separation down to which the law is taken, in σ: far below its own validity, in which summits are apart.
LOWEST = -4.0


#: The trapezoidal rule's points y, where y⁴/2 has not yet left less than rounding at the lowest separation.
_STEP = 1 / 24


_Y = _STEP * np.arange(1, 90)


@dataclass(frozen=True)
class GreenwoodWilliamsonLayer(LimitedLayer):
    """The layer of a rough surface: p = (4/3) E* η R^(1/2) σ^(3/2) F(u/σ), F(t) = ∫_t^∞ (s - t)^(3/2) φ(s) ds.

    φ is Gauss' distribution, u the separation from the summits' mean plane. The law begins at u = 8σ, which is its
    clearance, with what is left there, 4e-17 in F, taken off; beyond u = -4σ it goes on straight.

    Source: J. A. Greenwood, J. B. P. Williamson, Contact of nominally flat surfaces, Proc. R. Soc. A 295 (1966),
    300-319, eq. (8). For exponential heights see `ExponentialLayer.greenwood_williamson`.

    Args:
        modulus: E*, 1/E* = (1 - ν₁²)/E₁ + (1 - ν₂²)/E₂ (stress).
        density: η, the number of summits per area (1/length²).
        radius: R, the radius of the summits (length).
        deviation: σ, the standard deviation of the summits' heights (length).

    Raises:
        TypeError, ValueError: An argument is no positive finite number.

    Example:
        >>> layer = GreenwoodWilliamsonLayer(modulus=1e5, density=300.0, radius=0.05, deviation=1e-3)
        >>> round(float(layer.contact_stress(1e-3 - layer.clearance)), 4)  # at u = σ
        -21.4022
    """

    modulus: float
    density: float
    radius: float
    deviation: float

    def __post_init__(self) -> None:
        for name in ("modulus", "density", "radius", "deviation"):
            object.__setattr__(self, name, positive_values(name, getattr(self, name)))

    @property
    def clearance(self) -> float | Floats:
        return HIGHEST * self.deviation

    @property
    def compression_limit(self) -> float | Floats:
        return (HIGHEST - LOWEST) * self.deviation

    @property
    def _scale(self) -> float | Floats:
        """The pressure where F = 1."""
        return 4 / 3 * self.modulus * self.density * np.sqrt(self.radius * self.deviation) * self.deviation

    def _known_pressure(self, c: Floats) -> Floats:
        return self._scale * _force(ratio(c, self.deviation))

    def _known_slope(self, c: Floats) -> Floats:
        return self._scale / self.deviation * _stiffness(ratio(c, self.deviation))

    def _known_secant(self, deep: Floats, shallow: Floats) -> Floats:
        s, t = ratio(deep, self.deviation), ratio(shallow, self.deviation)
        far = s - t > _SPAN
        rise = np.divide(_force(s) - _force(t), s - t, out=np.zeros_like(s), where=far)
        return self._scale / self.deviation * np.where(far, rise, mean_slope(_stiffness, t, np.minimum(s - t, _SPAN)))

    def _known_energy(self, c: Floats) -> Floats:
        return self._scale * self.deviation * _work(ratio(c, self.deviation))

    def _known_depth(self, p: Floats) -> Floats:
        return inverse(self._known_pressure, self._known_slope, p, self.compression_limit)


#: Nearer than this points share eight Gauss points; the law changes e-fold over 1/8 at most.
_SPAN = 0.25


def _moment(power: int, t: float | Floats) -> Floats:
    """∫_t^∞ (s - t)^(power/2) φ(s) ds for odd powers.

    With s = t + y² the integrand is even and entire in y: the trapezoidal rule on the whole line is exact to rounding.
    """
    weights = 2 * _STEP / math.sqrt(2 * math.pi) * _Y ** (power + 1)
    return np.exp(-0.5 * (_Y**2 + np.asarray(t)[..., None]) ** 2) @ weights


def _force(s: Floats) -> Floats:
    """F(8 - s) - F(8): near the beginning, where that cancels, by the mean of its slope."""
    near = mean_slope(_stiffness, np.zeros_like(s), np.minimum(s, _SPAN)) * np.minimum(s, _SPAN)
    return np.where(s > _SPAN, _moment(3, HIGHEST - s) - _moment(3, HIGHEST), near)


def _stiffness(s: Floats) -> Floats:
    """-F'(8 - s) = (3/2) ∫ (s - t)^(1/2) φ."""
    return 1.5 * _moment(1, HIGHEST - s)


def _work(s: Floats) -> Floats:
    """The integral of F(8 - s) - F(8) from 0 to s."""
    # Near the beginning ∫ (s - x) F'(x) dx, of which no term is negative.
    width = np.minimum(s, _SPAN)
    near = mean_slope(lambda x: (width[..., None] - x) * _stiffness(x), np.zeros_like(width), width) * width
    far = (_moment(5, HIGHEST - s) - _moment(5, HIGHEST)) / 2.5 - s * _moment(3, HIGHEST)
    return np.where(s > _SPAN, far, near)
