"""The groove between two strips: pressure and gap along the contact, semi-analytic, and the strips' compliance."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np
from numpy.polynomial.chebyshev import chebval
from numpy.typing import ArrayLike
from scipy.fft import dct
from scipy.optimize import brentq, minimize_scalar

from ..base.arrays import Floats
from ..base.checks import positive
from ..layer import PowerLayer
from .equation import ContactEquation
from .moduli import oedometric_modulus, plane_modulus


@dataclass(frozen=True)
class Groove:
    """The solution of the groove problem; peak and edge are computed when first asked for.

    Attributes:
        length: The length of the contact (length).
        b: The groove's half width (length).
        r0: Its depth (length).
        layer: The law.
        approach: The mean approach of the two outer faces (length).
        elastic_energy: The energy of both bodies, their uniform compression included (stress · length², per unit
            thickness).
        layer_energy: The energy of the layer (the same unit).
    """

    length: float
    b: float
    r0: float
    layer: PowerLayer
    approach: float
    elastic_energy: float
    layer_energy: float
    _closing: Floats = field(repr=False, compare=False)  # cosine coefficients of the approach of the contact faces

    def gap(self, x: ArrayLike) -> Floats:
        """The deformed gap z, negative where the layer is compressed (length).

        Args:
            x: Points in [0, length], of any shape.

        Raises:
            ValueError: A point lies outside.
        """
        x = np.asarray(x, dtype=float)
        if np.any((x < 0) | (x > self.length)):
            raise ValueError(f"x = {x!r}: expected points in [0, {self.length}]")
        return groove_shape(x, self.b, self.r0) - chebval(np.cos(np.pi * x / self.length), self._closing)

    def pressure(self, x: ArrayLike) -> Floats:
        """The contact pressure, 0 where the gap is open (stress).

        Args:
            x: Points in [0, length], of any shape.

        Raises:
            ValueError: A point lies outside.
        """
        return np.abs(self.layer.contact_stress(self.gap(x)))

    @cached_property
    def peak_x(self) -> float:
        """The x of the highest contact pressure (length)."""
        x = np.linspace(0, self.length, 4097)
        peak = int(np.argmin(self.gap(x)))
        around = x[max(peak - 1, 0)], x[min(peak + 1, x.size - 1)]
        return float(minimize_scalar(self.gap, bounds=around, method="bounded", options={"xatol": 1e-9}).x)

    @cached_property
    def peak_pressure(self) -> float:
        """The highest contact pressure (stress)."""
        return float(self.pressure(self.peak_x))

    @cached_property
    def contact_edge(self) -> float:
        """The x from which on the faces touch (length); 0 if they touch everywhere."""
        if self.gap(0.0) <= 0:
            return 0.0
        return float(brentq(self.gap, 0, self.peak_x, xtol=1e-14 * self.length))


@lru_cache(maxsize=32)
def groove(
    *,
    length: float = 4.0,
    height: float = 1.0,
    b: float = 1.0,
    r0: float = 5e-4,
    E: float = 2.1e5,
    nu: float = 0.3,
    q: float = 10.0,
    B: float = 4e-6,
    a: float = 1.1,
    points: int = 2**14,
) -> Groove:
    """The semi-analytic solution of the paper's groove between two rectangles; its data by default (cm, MPa).

    Because of the symmetric sides a pressure cos(kπx/length) bulges the face in proportion, see `surface_compliance`:
    the contact is one scalar equation on [0, length], solved by collocation in `points` midpoints. With the defaults
    the peak pressure is good to 1e-8, the contact edge to 1e-7; the error falls as points^-1.9, because the pressure
    rises from the edge like a power 1/a.

    Args:
        length: The length of the rectangles (length).
        height: The height of each (length).
        b: The groove's half width (length).
        r0: Its depth (length).
        E: Young's modulus of both (stress).
        nu: Their Poisson's ratio.
        q: The pressure on the outer faces (stress).
        B: The compliance of the layer ``|w| = B σ^a`` (length / stress^a).
        a: Its exponent.
        points: The number of collocation points.

    Raises:
        RuntimeError: The iteration doesn't converge, which may happen with layers a million times stiffer than the
            paper's.
        TypeError, ValueError: An argument is out of range.
    """
    length, b, r0, q = positive("length", length), positive("b", b), positive("r0", r0), positive("q", q)
    height, modulus, layer = positive("height", height), oedometric_modulus(E, nu), PowerLayer(B, a)
    if not isinstance(points, int) or points < 2:
        raise ValueError(f"points = {points!r}: expected an integer >= 2")
    compliance = np.append(0.0, surface_compliance(np.pi / length * np.arange(1, points), height, E, nu))
    x = (np.arange(points) + 0.5) * length / points
    equation = ContactEquation(layer, q, groove_shape(x, b, r0), 2 * compliance)
    s, c = equation.solve()

    harmonics = dct(s) / points
    w = equation.compression(s, c)
    uniform = q**2 * height * length / modulus
    return Groove(
        length,
        b,
        r0,
        layer,
        approach=c + 2 * q * height / modulus,
        elastic_energy=uniform + 0.5 * length * float(compliance @ harmonics**2),
        layer_energy=length * float(layer.energy(-w).mean()),
        _closing=np.append(c, (-2 * compliance * harmonics)[1:]),
    )


def surface_compliance(wavenumber: ArrayLike, height: float, E: float, nu: float) -> Floats:
    """The compliance C of an elastic layer's face: u_n = C cos(κx) under the pressure cos(κx) (length / stress).

    No shear on either face, no harmonic pressure on the other one, plane strain:
    C = 2(1 − ν²)/(Eκ) · (sinh κh cosh κh + κh) / (sinh² κh − κ²h²). It tends to the half-plane's 2(1 − ν²)/(Eκ) for
    κh → ∞ and to the plate's 12(1 − ν²)/(E κ⁴h³) for κh → 0.

    Args:
        wavenumber: The wave numbers κ > 0 (1 / length), of any shape.
        height: The layer's height h (length).
        E: Young's modulus (stress).
        nu: Poisson's ratio.

    Raises:
        TypeError, ValueError: An argument isn't positive, or ν lies outside of (−1, 0.5).

    Example:
        >>> round(float(surface_compliance(100.0, height=1.0, E=2.0, nu=0.0)), 12)  # 2/(E κ), the half-plane's
        0.01
    """
    wavenumber = np.asarray(wavenumber, dtype=float)
    if not np.all(wavenumber > 0):
        raise ValueError(f"wavenumber = {wavenumber!r}: expected numbers > 0")
    kh = wavenumber * positive("height", height)
    # Numerator and denominator times 4 exp(-2κh), so that nothing overflows.
    decay, slender = np.exp(-2 * kh), 2 * kh * np.exp(-kh)
    shape = (1 - decay**2 + 4 * kh * decay) / ((1 - decay - slender) * (1 - decay + slender))
    return 2 / (plane_modulus(E, nu) * wavenumber) * shape


def groove_shape(x: Floats, b: float, r0: float) -> Floats:
    """d(x) = r₀ {[1 - (x/b)²]⁺}^(3/2)."""
    return r0 * np.maximum(1 - (x / b) ** 2, 0) ** 1.5
