"""The groove between two strips: pressure and gap along the contact, semi-analytic, and the strips' compliance."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np
from numpy.polynomial.chebyshev import chebval
from numpy.typing import ArrayLike, NDArray
from scipy.fft import dct, idct
from scipy.optimize import brentq, minimize_scalar
from scipy.sparse.linalg import LinearOperator, cg

from ..base.arrays import Floats
from ..base.checks import positive
from ..layer import Layer, PowerLayer
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
    equation = _GrooveEquation(layer, q, groove_shape(x, b, r0), 2 * compliance)
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


@dataclass(frozen=True)
class _GrooveEquation:
    """w = c - d - K s with p(w) = q + s, in the midpoints of a uniform grid.

    w is the layer's compression counted positive, s the pressure's deviation from its mean q, and
    K s = 2 C s the bulge of both faces; unknown are s and the number c. Equivalently, the convex energy
    ½⟨s, K s⟩ + ⟨∫ p dw⟩ - q c is least.
    """

    layer: Layer
    q: float
    d: Floats
    compliance: Floats

    def solve(self, most_steps: int = 100) -> tuple[Floats, float]:
        """s and c, by a semismooth Newton method with a line search on the energy."""
        s, c = np.zeros_like(self.d), self._closing_of_rigid_bodies()
        previous = math.inf
        for _ in range(most_steps):
            w = self.compression(s, c)
            error = float(np.sqrt(np.mean(self._imbalance(s, w) ** 2))) / self.q
            # Where the layer is hard, rounding of w ends the progress before 1e-12.
            if error < 1e-12 or (error < 1e-7 and error > previous / 2):
                return s, c
            previous = error
            ds, dc = self._newton_direction(s, w)
            step = self._step_length(s, w, ds, dc - self._bulge(ds))
            s, c = s + step * ds, c + step * dc
        raise RuntimeError(f"the groove's equation didn't converge: relative residual {error:g}, expected < 1e-7")

    def compression(self, s: Floats, c: float) -> Floats:
        return c - self.d - self._bulge(s)

    def _closing_of_rigid_bodies(self) -> float:
        upper = self.d.max() - float(self.layer.compression(-self.q))
        return brentq(lambda c: self._pressure(c - self.d).mean() - self.q, 0, upper, xtol=1e-15 * upper)

    def _pressure(self, w: Floats) -> Floats:
        return -self.layer.contact_stress(-w)

    def _bulge(self, s: Floats) -> Floats:
        return _apply_in_cosines(self.compliance, s)

    def _imbalance(self, s: Floats, w: Floats) -> Floats:
        return self._pressure(w) - self.q - s

    def _newton_direction(self, s: Floats, w: Floats) -> tuple[Floats, float]:
        """ds and dc. The pressure changes by dp = p'(w) dw on the contact only, and ds = dp + imbalance."""
        contact, imbalance = w > 0, self._imbalance(s, w)
        from_imbalance = self._pressure_change(-self._bulge(imbalance), w, contact)
        from_closing = self._pressure_change(np.ones_like(w), w, contact)
        dc = -(imbalance.sum() + from_imbalance.sum()) / from_closing.sum()
        return from_imbalance + dc * from_closing + imbalance, dc

    def _pressure_change(self, closing: Floats, w: Floats, contact: NDArray[np.bool_]) -> Floats:
        """The dp, 0 off the contact, with dp/p'(w) + K dp = closing on it; conjugate gradients."""
        # A circulant preconditioner, with the layer's typical softness; where the layer is much softer still
        # (at the edge, a < 1) its own stiffness takes over.
        softness = 1 / self.layer.contact_derivative(-w[contact])
        typical = np.median(softness)
        damping = np.sqrt(typical / np.maximum(softness, typical))
        dp = np.zeros_like(w)

        def in_cosines(factors: Floats, values: Floats) -> Floats:
            dp[contact] = values
            return _apply_in_cosines(factors, dp)[contact]

        def operator(values: Floats) -> Floats:
            return softness * values + in_cosines(self.compliance, values)

        def preconditioner(values: Floats) -> Floats:
            return damping * in_cosines(1 / (self.compliance + typical), damping * values)

        shape = (softness.size, softness.size)
        dp[contact] = cg(
            LinearOperator(shape, operator, dtype=float),
            closing[contact],
            rtol=1e-12,
            maxiter=1000,
            M=LinearOperator(shape, preconditioner, dtype=float),
        )[0]
        return dp

    def _step_length(self, s: Floats, w: Floats, ds: Floats, dw: Floats) -> float:
        """1, or the zero in (0, 1) of the energy's slope along the direction if a full step overshoots."""

        def slope(t: float) -> float:
            return float(np.mean(self._imbalance(s + t * ds, w + t * dw) * dw))

        if slope(1.0) <= 0.5 * abs(slope(0.0)):
            return 1.0
        return brentq(slope, 0, 1, xtol=1e-9, rtol=1e-2)


def _apply_in_cosines(factors: Floats, values: Floats) -> Floats:
    return idct(factors * dct(values, norm="ortho"), norm="ortho")
