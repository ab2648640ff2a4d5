"""A soft coating in logarithmic strain, which nothing presses through."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.arrays import Floats
from ..base.checks import positive_values
from .calculus import log_of_rest, power_series, ratio, relative_log1p
from .limited import STEEP, LimitedLayer

#: [(1 - s) log(1 - s) + s] / s² = Σ s^k / ((k + 1)(k + 2)), enough of it for s < 0.05.
_EXCESS = tuple(1 / ((k + 1) * (k + 2)) for k in range(14))


@dataclass(frozen=True)
class LogarithmicLayer(LimitedLayer):
    """The layer of a coating whose stress goes with its logarithmic strain: p = -M log(1 - c/h).

    M/h is its stiffness at rest; at c = h it is pressed through, and the pressure is infinite. Closer to that than
    1e-10 h, at 23 M, the law goes on straight.

    Source: Hencky's law for a sheet under uniaxial strain; for small c/h it is the elastic foundation, K. L. Johnson,
    Contact Mechanics (1985), section 5.8.

    Args:
        modulus: M, the stress over the strain of a sheet that can't bulge sideways (stress).
        thickness: h (length).

    Raises:
        TypeError, ValueError: An argument is no positive finite number.

    Example:
        >>> round(float(LogarithmicLayer(modulus=1e3, thickness=1e-3).contact_stress(-5e-4)), 3)
        -693.147
    """

    modulus: float
    thickness: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "modulus", positive_values("modulus", self.modulus))
        object.__setattr__(self, "thickness", positive_values("thickness", self.thickness))

    @property
    def compression_limit(self) -> float | Floats:
        return self.thickness * (1 - 1 / STEEP)

    def _rest(self, c: Floats) -> Floats:
        """1 - c/h, which h - c gives without cancellation."""
        return ratio(self.thickness - c, self.thickness)

    def _known_pressure(self, c: Floats) -> Floats:
        return -self.modulus * log_of_rest(ratio(c, self.thickness), self._rest(c))

    def _known_slope(self, c: Floats) -> Floats:
        return ratio(self.modulus, self.thickness - c)

    def _known_secant(self, deep: Floats, shallow: Floats) -> Floats:
        left = self.thickness - deep
        return self.modulus / left * relative_log1p((deep - shallow) / left)

    def _known_energy(self, c: Floats) -> Floats:
        s, rest = ratio(c, self.thickness), self._rest(c)
        small = s**2 * power_series(_EXCESS, np.minimum(s, 0.05))
        return self.modulus * self.thickness * np.where(s < 0.05, small, rest * log_of_rest(s, rest) + s)

    def _known_depth(self, p: Floats) -> Floats:
        return -self.thickness * np.expm1(-p / self.modulus)
