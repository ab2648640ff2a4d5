"""The groove between half-planes without layers, in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.checks import positive
from .groove import groove_shape
from .moduli import plane_modulus


@dataclass(frozen=True)
class HalfPlaneGroove:
    """The groove d(x) = r0 {[1 − (x/b)²]⁺}^(3/2) between two half-planes without layers.

    Attributes:
        q: The pressure far away (stress).
        b: The groove's half width (length).
        r0: Its depth (length).
        closing_pressure: The pressure q_c that closes the groove (stress).
        open_half_width: The half width a* of the part that stays open, 0 if the groove is closed (length).
        closed: Whether q ≥ q_c.
    """

    q: float
    b: float
    r0: float
    closing_pressure: float
    open_half_width: float
    closed: bool

    def gap(self, x: ArrayLike) -> Floats:
        """The gap r0 (a*/b)³ (1 − x²/a*²)^(3/2) that stays open on ``|x| < a*``, else 0 (length).

        Args:
            x: Coordinates along the contact (length), of any shape.
        """
        x = np.asarray(x, dtype=float)
        if self.closed:
            return np.zeros(x.shape)
        shape = groove_shape(x, self.open_half_width, self.r0)
        return np.asarray((self.open_half_width / self.b) ** 3 * shape)

    def pressure(self, x: ArrayLike) -> Floats:
        """The contact pressure at any x (stress).

        The bulge of the half-planes is the Hilbert transform of the pressure's deviation from q, so that closing a
        groove (b, r0) changes it by 2 q_c P(x/b), P(ξ) = ξ² − ½ in the groove, ``ξ² − ½ − |ξ| √(ξ² − 1)`` beside it.
        The part that stays open is a groove (a*, r0 (a*/b)³), which is subtracted again.

        Args:
            x: Coordinates along the contact (length), of any shape.
        """
        distance: Floats = np.abs(np.asarray(x, dtype=float))
        closed = _closing_shape(np.asarray(distance / self.b))
        if self.closed:
            return np.asarray(self.q + 2 * self.closing_pressure * closed)
        share = (self.open_half_width / self.b) ** 2
        still_open = share * _closing_shape(np.asarray(distance / self.open_half_width))
        pressure = self.q + 2 * self.closing_pressure * (closed - still_open)
        return np.where(distance <= self.open_half_width, 0.0, pressure)


def groove_half_planes(
    *, q: float = 10.0, E: float = 2.1e5, nu: float = 0.3, b: float = 1.0, r0: float = 5e-4
) -> HalfPlaneGroove:
    """The groove between half-planes far below and above, without layers ("Known answers").

    E* = E / (2(1 − ν²)), q_c = ¾ E* r0/b, a* = b √(1 − q/q_c).

    Args:
        q: The pressure far away (stress).
        E: Young's modulus of both (stress).
        nu: Their Poisson's ratio.
        b: The groove's half width (length).
        r0: Its depth (length).

    Raises:
        TypeError, ValueError: An argument is out of range.

    Example:
        >>> print(f"{groove_half_planes().closing_pressure:.2f}")
        43.27
    """
    q, b, r0 = positive("q", q), positive("b", b), positive("r0", r0)
    closing_pressure = 0.375 * plane_modulus(E, nu) * r0 / b
    open_half_width = b * math.sqrt(max(1 - q / closing_pressure, 0))
    return HalfPlaneGroove(q, b, r0, closing_pressure, open_half_width, closed=q >= closing_pressure)


def _closing_shape(xi: Any) -> Floats:
    """P(ξ) of `HalfPlaneGroove.pressure` for ξ ≥ 0, without cancellation far away."""
    beside = xi / (xi + np.sqrt(np.maximum(xi**2 - 1, 0)) + (xi == 0))
    return np.where(xi <= 1, xi**2, beside) - 0.5
