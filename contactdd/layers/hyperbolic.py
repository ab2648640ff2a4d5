"""The hyperbolic law of rock joints, with its wall: the closure that no pressure exceeds."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from ..base.arrays import Floats
from ..base.checks import positive_values
from .calculus import log_of_rest, power_series, ratio
from .limited import STEEP, LimitedLayer

#: (-log(1 - s) - s) / s² = Σ s^k / (k + 2), enough of it for s < 0.05.
_EXCESS = tuple(1 / (k + 2) for k in range(14))


@dataclass(frozen=True)
class HyperbolicLayer(LimitedLayer):
    """The layer of Barton and Bandis: p = K c / (1 - c/V), the law of joints in rock.

    Closer to the wall than 1e-5 V the law goes on straight, 1e10 times stiffer than at rest.

    Source: S. C. Bandis, A. C. Lumsden, N. R. Barton, Fundamentals of rock joint deformation, Int. J. Rock Mech. Min.
    Sci. 20 (1983), 249-268, eq. (7).

    Args:
        stiffness: K, the normal stiffness at rest (stress / length).
        closure: V, the greatest closure (length), where the pressure is infinite.

    Raises:
        TypeError, ValueError: An argument is no positive finite number.

    Example:
        >>> HyperbolicLayer(stiffness=10.0, closure=0.2).contact_stress([-0.1, -0.15])
        array([-2., -6.])
    """

    stiffness: float
    closure: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "stiffness", positive_values("stiffness", self.stiffness))
        object.__setattr__(self, "closure", positive_values("closure", self.closure))

    @property
    def compression_limit(self) -> float | Floats:
        return self.closure * (1 - 1 / sqrt(STEEP))

    def _rest(self, c: Floats) -> Floats:
        """1 - c/V, which V - c gives without cancellation."""
        return ratio(self.closure - c, self.closure)

    def _known_pressure(self, c: Floats) -> Floats:
        return self.stiffness * c / self._rest(c)

    def _known_slope(self, c: Floats) -> Floats:
        return ratio(self.stiffness, self._rest(c) ** 2)

    def _known_secant(self, deep: Floats, shallow: Floats) -> Floats:
        return ratio(self.stiffness, self._rest(deep) * self._rest(shallow))

    def _known_energy(self, c: Floats) -> Floats:
        s = ratio(c, self.closure)
        small = c**2 * power_series(_EXCESS, np.minimum(s, 0.05))
        return self.stiffness * np.where(s < 0.05, small, self.closure**2 * (-log_of_rest(s, self._rest(c)) - s))

    def _known_depth(self, p: Floats) -> Floats:
        return p / (self.stiffness + p / self.closure)
