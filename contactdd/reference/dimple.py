"""The dimple between two blocks: pressure and gap over the contact, semi-analytic."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import RectBivariateSpline
from scipy.optimize import brentq

from ..base.arrays import Floats
from ..base.checks import positive
from ..layer import PowerLayer
from .equation import ContactEquation
from .groove import surface_compliance
from .moduli import oedometric_modulus

#: Grid points that the spline of the closing is continued by beyond each side, where it is even.
BEYOND = 4


@dataclass(frozen=True)
class Dimple:
    """The solution of the dimple problem.

    Attributes:
        side: The side of the square contact (length).
        b: The dimple's radius (length).
        r0: Its depth (length).
        layer: The law.
        approach: The mean approach of the two outer faces (length).
    """

    side: float
    b: float
    r0: float
    layer: PowerLayer
    approach: float
    _closing: Any = field(repr=False, compare=False)  # a spline of the approach of the contact faces

    def gap(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """The deformed gap z, negative where the layer is compressed (length).

        Args:
            x, y: Coordinates in [0, side], of shapes that broadcast.

        Raises:
            ValueError: A point lies outside.
        """
        x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
        for name, values in (("x", x), ("y", y)):
            if np.any((values < 0) | (values > self.side)):
                raise ValueError(f"{name} = {values!r}: expected coordinates in [0, {self.side}]")
        return dimple_shape(x, y, self.b, self.r0) - self._closing(x, y, grid=False)

    def pressure(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """The contact pressure, 0 where the gap is open (stress).

        Args:
            x, y: Coordinates in [0, side], of shapes that broadcast.

        Raises:
            ValueError: A point lies outside.
        """
        return np.abs(self.layer.contact_stress(self.gap(x, y)))

    @property
    def contact_edge(self) -> float:
        """The x on the axis y = 0 from which on the faces touch (length); 0 if they touch everywhere."""
        if self.gap(0.0, 0.0) <= 0:
            return 0.0
        return float(brentq(lambda x: float(self.gap(x, 0.0)), 0, self.b, xtol=1e-14 * self.side))


@lru_cache(maxsize=8)
def dimple(
    *,
    side: float = 1.0,
    height: float = 0.5,
    b: float = 0.5,
    r0: float = 2.5e-4,
    E: float = 2.1e5,
    nu: float = 0.3,
    q: float = 10.0,
    B: float = 4e-6,
    a: float = 1.1,
    points: int = 256,
) -> Dimple:
    """The semi-analytic solution of a round dimple about the corner of two blocks between smooth walls.

    The gap is r₀ {[1 − (x² + y²)/b²]⁺}^(3/2). A pressure cos(kπx/side) cos(lπy/side) is a sum of plane waves of the
    wave number κ = π √(k² + l²)/side, each in plane strain, so that the faces bulge in proportion to it with the
    compliance of `surface_compliance` at κ: the contact is one scalar equation on the square. With the defaults the
    pressure is good to 2e-5 (L2 norm), with 2048 points to 4e-7.

    Args:
        side: The side of the blocks' square cross section (length).
        height: The height of each (length).
        b: The dimple's radius (length).
        r0: Its depth (length).
        E: Young's modulus of both (stress).
        nu: Their Poisson's ratio.
        q: The pressure on the outer faces (stress).
        B: The compliance of the layer ``|w| = B σ^a`` (length / stress^a).
        a: Its exponent.
        points: The number of collocation points along a side.

    Raises:
        RuntimeError: The iteration doesn't converge.
        TypeError, ValueError: An argument is out of range.

    Example:
        >>> import contactdd as cd
        >>> answer = cd.reference.dimple(points=64)
        >>> print(f"{answer.contact_edge:.3f} {float(answer.pressure(1.0, 1.0)):.3f}")
        0.318 9.711
    """
    side, b, r0, q = positive("side", side), positive("b", b), positive("r0", r0), positive("q", q)
    height, modulus, layer = positive("height", height), oedometric_modulus(E, nu), PowerLayer(B, a)
    if not isinstance(points, int) or points < 8:
        raise ValueError(f"points = {points!r}: expected an integer >= 8")
    k = np.pi / side * np.arange(points)
    waves = np.hypot(k[:, None], k)
    waves[0, 0] = 1.0
    compliance = 2 * surface_compliance(waves, height, E, nu)
    compliance[0, 0] = 0.0
    x = (np.arange(points) + 0.5) * side / points
    d = dimple_shape(x[:, None], x, b, r0)
    equation = ContactEquation(layer, q, d, compliance)
    s, c = equation.solve()
    closing = _even_spline(x, equation.compression(s, c) + d, side)
    return Dimple(side, b, r0, layer, approach=c + 2 * q * height / modulus, _closing=closing)


def dimple_shape(x: Floats, y: Floats, b: float, r0: float) -> Floats:
    """d(x, y) = r₀ {[1 − (x² + y²)/b²]⁺}^(3/2)."""
    return r0 * np.maximum(1 - (x**2 + y**2) / b**2, 0) ** 1.5


def _even_spline(x: Floats, values: Floats, side: float) -> RectBivariateSpline:
    """The cubic spline of values on the midpoints x of a square, even about its sides."""
    count, near = len(x), np.arange(BEYOND)
    at = np.concatenate([near[::-1], np.arange(count), count - 1 - near])
    beyond = np.concatenate([-x[:BEYOND][::-1], x, 2 * side - x[-BEYOND:][::-1]])
    return RectBivariateSpline(beyond, beyond, values[np.ix_(at, at)], kx=3, ky=3)
