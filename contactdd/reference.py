"""Known answers: closed-form and semi-analytic contact solutions to test against.

Lengths and stresses are in the user's own consistent set of units. Plane problems are plane strain,
with forces and energies per unit thickness. Pressures are positive in compression. Arguments out of
range are refused with a TypeError or ValueError that names them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np
from numpy.polynomial.chebyshev import chebval
from numpy.typing import ArrayLike, NDArray
from scipy.fft import dct, idct
from scipy.optimize import brentq, minimize_scalar
from scipy.sparse.linalg import LinearOperator, cg
from scipy.special import beta

from .errors import finite, positive
from .layer import Layer, PowerLayer

__all__ = [
    "ColumnStack",
    "Groove",
    "HalfPlaneGroove",
    "HertzCylinder",
    "HertzSphere",
    "ParabolaOnLayer",
    "UniformCompression",
    "column_stack",
    "groove",
    "groove_half_planes",
    "hertz_cylinder",
    "hertz_sphere",
    "rigid_parabola_on_layer",
    "surface_compliance",
    "uniform_compression",
]

Array = NDArray[np.float64]


# ------------------------------------------------------------------------------- uniform compression


@dataclass(frozen=True)
class UniformCompression:
    """Two equal blocks pressed flat on each other.

    pressure (stress); compression, the layers' w ≤ 0 (length); shortening of each body (length);
    approach of the outer faces (length).
    """

    pressure: float
    compression: float
    shortening: float
    approach: float


def uniform_compression(q: float, h: float, E: float, nu: float, B: float, a: float) -> UniformCompression:
    """Two blocks of height h under the pressure q, sides held against sliding out, layer |w| = B σ^a between.

    Exact on every mesh: σ_n = -q everywhere ("Known answers" of the model; the paper's groove with r0 = 0).
    """
    layer, q = PowerLayer(B, a), positive("q", q)
    shortening = q * positive("h", h) / _oedometric_modulus(E, nu)
    w = float(layer.compression(-q))
    return UniformCompression(pressure=q, compression=w, shortening=shortening, approach=2 * shortening - w)


# -------------------------------------------------------------------------------- the paper's groove


@dataclass(frozen=True)
class Groove:
    """The solved groove problem.

    approach: of the two outer faces, on average (length). elastic_energy: of both bodies, their
    uniform compression included; layer_energy (both stress · length² per unit thickness). The rest is
    worked out when asked for.
    """

    length: float
    b: float
    r0: float
    layer: PowerLayer
    approach: float
    elastic_energy: float
    layer_energy: float
    _closing: Array = field(repr=False, compare=False)  # cosine coefficients of the approach of the contact faces

    def gap(self, x: ArrayLike) -> Array:
        """The deformed gap z at x in [0, length]; negative where the layer is compressed (length)."""
        x = np.asarray(x, dtype=float)
        if np.any((x < 0) | (x > self.length)):
            raise ValueError(f"x = {x!r}: expected points in [0, {self.length}]")
        return _groove_shape(x, self.b, self.r0) - chebval(np.cos(np.pi * x / self.length), self._closing)

    def pressure(self, x: ArrayLike) -> Array:
        """The contact pressure at x in [0, length], 0 where the gap is open (stress)."""
        return np.abs(self.layer.contact_stress(self.gap(x)))

    @cached_property
    def peak_x(self) -> float:
        """Where the contact pressure is highest."""
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
        """The x from which on the faces touch; 0 if they touch everywhere."""
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
    """The paper's groove between two rectangles pressed by q through a layer; its data by default (cm, MPa).

    Because of the symmetric sides a pressure cos(kπx/length) bulges the face in proportion, see
    `surface_compliance`: the contact is one scalar equation on [0, length], solved by collocation in
    `points` midpoints. With the defaults the peak pressure is good to 1e-8, the contact edge to 1e-7; the
    error falls as points^-1.9, because the pressure rises from the edge like a power 1/a.

    Raises RuntimeError if the iteration doesn't converge, which may happen with layers a million times
    stiffer than the paper's, and ValueError or TypeError for arguments out of range.
    """
    length, b, r0, q = positive("length", length), positive("b", b), positive("r0", r0), positive("q", q)
    height, modulus, layer = positive("height", height), _oedometric_modulus(E, nu), PowerLayer(B, a)
    if not isinstance(points, int) or points < 2:
        raise ValueError(f"points = {points!r}: expected an integer >= 2")
    compliance = np.append(0.0, surface_compliance(np.pi / length * np.arange(1, points), height, E, nu))
    x = (np.arange(points) + 0.5) * length / points
    equation = _GrooveEquation(layer, q, _groove_shape(x, b, r0), 2 * compliance)
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


def surface_compliance(wavenumber: ArrayLike, height: float, E: float, nu: float) -> Array:
    """C with u_n = C cos(κx) under the pressure cos(κx) on the face of an elastic layer (length / stress).

    No shear on either face, no harmonic pressure on the other one, plane strain. With κ = wavenumber > 0
    (1 / length), C = 2(1 - ν²)/(Eκ) · (sinh κh cosh κh + κh) / (sinh² κh - κ²h²). It tends to the
    half-plane's 2(1 - ν²)/(Eκ) for κh → ∞ and to the plate's 12(1 - ν²)/(E κ⁴h³) for κh → 0.

    Raises TypeError or ValueError for arguments that aren't positive, or ν outside (-1, 0.5).
    """
    wavenumber = np.asarray(wavenumber, dtype=float)
    if not np.all(wavenumber > 0):
        raise ValueError(f"wavenumber = {wavenumber!r}: expected numbers > 0")
    kh = wavenumber * positive("height", height)
    # Numerator and denominator times 4 exp(-2κh), so that nothing overflows.
    decay, slender = np.exp(-2 * kh), 2 * kh * np.exp(-kh)
    shape = (1 - decay**2 + 4 * kh * decay) / ((1 - decay - slender) * (1 - decay + slender))
    return 2 / (_plane_modulus(E, nu) * wavenumber) * shape


def _groove_shape(x: Array, b: float, r0: float) -> Array:
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
    d: Array
    compliance: Array

    def solve(self, most_steps: int = 100) -> tuple[Array, float]:
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

    def compression(self, s: Array, c: float) -> Array:
        return c - self.d - self._bulge(s)

    def _closing_of_rigid_bodies(self) -> float:
        upper = self.d.max() - float(self.layer.compression(-self.q))
        return brentq(lambda c: self._pressure(c - self.d).mean() - self.q, 0, upper, xtol=1e-15 * upper)

    def _pressure(self, w: Array) -> Array:
        return -self.layer.contact_stress(-w)

    def _bulge(self, s: Array) -> Array:
        return _apply_in_cosines(self.compliance, s)

    def _imbalance(self, s: Array, w: Array) -> Array:
        return self._pressure(w) - self.q - s

    def _newton_direction(self, s: Array, w: Array) -> tuple[Array, float]:
        """ds and dc. The pressure changes by dp = p'(w) dw on the contact only, and ds = dp + imbalance."""
        contact, imbalance = w > 0, self._imbalance(s, w)
        from_imbalance = self._pressure_change(-self._bulge(imbalance), w, contact)
        from_closing = self._pressure_change(np.ones_like(w), w, contact)
        dc = -(imbalance.sum() + from_imbalance.sum()) / from_closing.sum()
        return from_imbalance + dc * from_closing + imbalance, dc

    def _pressure_change(self, closing: Array, w: Array, contact: NDArray[np.bool_]) -> Array:
        """The dp, 0 off the contact, with dp/p'(w) + K dp = closing on it; conjugate gradients."""
        # A circulant preconditioner, with the layer's typical softness; where the layer is much softer still
        # (at the edge, a < 1) its own stiffness takes over.
        softness = 1 / self.layer.contact_derivative(-w[contact])
        typical = np.median(softness)
        damping = np.sqrt(typical / np.maximum(softness, typical))
        dp = np.zeros_like(w)

        def in_cosines(factors: Array, values: Array) -> Array:
            dp[contact] = values
            return _apply_in_cosines(factors, dp)[contact]

        def operator(values: Array) -> Array:
            return softness * values + in_cosines(self.compliance, values)

        def preconditioner(values: Array) -> Array:
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

    def _step_length(self, s: Array, w: Array, ds: Array, dw: Array) -> float:
        """1, or the zero in (0, 1) of the energy's slope along the direction if a full step overshoots."""

        def slope(t: float) -> float:
            return float(np.mean(self._imbalance(s + t * ds, w + t * dw) * dw))

        if slope(1.0) <= 0.5 * abs(slope(0.0)):
            return 1.0
        return brentq(slope, 0, 1, xtol=1e-9, rtol=1e-2)


def _apply_in_cosines(factors: Array, values: Array) -> Array:
    return idct(factors * dct(values, norm="ortho"), norm="ortho")


# ---------------------------------------------------- the groove between half-planes, without layers


@dataclass(frozen=True)
class HalfPlaneGroove:
    """The groove d(x) = r0 {[1 - (x/b)²]⁺}^(3/2) between two half-planes without layers.

    closing_pressure: the q_c that closes it (stress); open_half_width: a*, 0 if closed (length);
    closed: whether q ≥ q_c.
    """

    q: float
    b: float
    r0: float
    closing_pressure: float
    open_half_width: float
    closed: bool

    def gap(self, x: ArrayLike) -> Array:
        """The gap r0 (a*/b)³ (1 - x²/a*²)^(3/2) that stays open on |x| < a*, else 0 (length)."""
        x = np.asarray(x, dtype=float)
        if self.closed:
            return np.zeros(x.shape)
        shape = _groove_shape(x, self.open_half_width, self.r0)
        return np.asarray((self.open_half_width / self.b) ** 3 * shape)

    def pressure(self, x: ArrayLike) -> Array:
        """The contact pressure at any x (stress).

        The bulge of the half-planes is the Hilbert transform of the pressure's deviation from q, so
        that closing a groove (b, r0) changes it by 2 q_c P(x/b), P(ξ) = ξ² - ½ in the groove, ξ² - ½ -
        |ξ| √(ξ² - 1) beside it. What stays open is a groove (a*, r0 (a*/b)³), to be taken off again.
        """
        x = np.abs(np.asarray(x, dtype=float))
        closed = _closing_shape(x / self.b)
        if self.closed:
            return np.asarray(self.q + 2 * self.closing_pressure * closed)
        share = (self.open_half_width / self.b) ** 2
        still_open = share * _closing_shape(x / self.open_half_width)
        pressure = self.q + 2 * self.closing_pressure * (closed - still_open)
        return np.where(x <= self.open_half_width, 0.0, pressure)


def groove_half_planes(
    *, q: float = 10.0, E: float = 2.1e5, nu: float = 0.3, b: float = 1.0, r0: float = 5e-4
) -> HalfPlaneGroove:
    """The groove between half-planes far below and above, pressed by q, without layers ("Known answers").

    E* = E / (2(1 - ν²)), q_c = ¾ E* r0/b, a* = b √(1 - q/q_c).
    """
    q, b, r0 = positive("q", q), positive("b", b), positive("r0", r0)
    closing_pressure = 0.375 * _plane_modulus(E, nu) * r0 / b
    open_half_width = b * math.sqrt(max(1 - q / closing_pressure, 0))
    return HalfPlaneGroove(q, b, r0, closing_pressure, open_half_width, closed=q >= closing_pressure)


def _closing_shape(xi: Array) -> Array:
    """P(ξ) of `HalfPlaneGroove.pressure` for ξ ≥ 0, without cancellation far away."""
    beside = xi / (xi + np.sqrt(np.maximum(xi**2 - 1, 0)) + (xi == 0))
    return np.where(xi <= 1, xi**2, beside) - 0.5


# --------------------------------------------------------------------------------------------- Hertz


@dataclass(frozen=True)
class HertzCylinder:
    """Contact of parallel cylinders: half_width (length), peak_pressure (stress)."""

    half_width: float
    peak_pressure: float

    def pressure(self, x: ArrayLike) -> Array:
        """The contact pressure at the distance x from the middle line (stress)."""
        return _ellipse(x, self.half_width, self.peak_pressure)


@dataclass(frozen=True)
class HertzSphere:
    """Contact of spheres: radius of the contact, approach (length), peak_pressure (stress)."""

    radius: float
    approach: float
    peak_pressure: float

    def pressure(self, r: ArrayLike) -> Array:
        """The contact pressure at the distance r from the axis (stress)."""
        return _ellipse(r, self.radius, self.peak_pressure)


def hertz_cylinder(
    load_per_length: float,
    R1: float,
    E1: float,
    nu1: float,
    R2: float = math.inf,
    E2: float = math.inf,
    nu2: float = 0.0,
) -> HertzCylinder:
    """Two cylinders, or a cylinder and a plane (R2 = inf), pressed together; E2 = inf is a rigid second body.

    Johnson, Contact Mechanics, §4.2(c): half-width² = 4 P R / (π E*), peak = 2 P / (π half-width).
    """
    load, radius = positive("load_per_length", load_per_length), _relative_radius(R1, R2)
    half_width = math.sqrt(4 * load * radius / (math.pi * _contact_modulus(E1, nu1, E2, nu2)))
    return HertzCylinder(half_width, peak_pressure=2 * load / (math.pi * half_width))


def hertz_sphere(
    force: float,
    R1: float,
    E1: float,
    nu1: float,
    R2: float = math.inf,
    E2: float = math.inf,
    nu2: float = 0.0,
) -> HertzSphere:
    """Two spheres, or a sphere and a plane (R2 = inf), pressed together; E2 = inf is a rigid second body.

    Johnson, Contact Mechanics, §4.2(a): radius³ = 3 F R / (4 E*), approach = radius²/R,
    peak = 3 F / (2π radius²).
    """
    force, relative = positive("force", force), _relative_radius(R1, R2)
    radius = float(np.cbrt(0.75 * force * relative / _contact_modulus(E1, nu1, E2, nu2)))
    peak = 1.5 * force / (math.pi * radius**2)
    return HertzSphere(radius, approach=radius**2 / relative, peak_pressure=peak)


def _ellipse(x: ArrayLike, half_width: float, peak: float) -> Array:
    """peak √(1 - x²/half_width²), 0 outside."""
    return np.asarray(peak * np.sqrt(np.maximum(1 - (np.asarray(x, dtype=float) / half_width) ** 2, 0)))


def _relative_radius(R1: float, R2: float) -> float:
    """R with 1/R = 1/R1 + 1/R2."""
    return 1 / (1 / positive("R1", R1) + (0 if _is_infinite(R2) else 1 / positive("R2", R2)))


def _contact_modulus(E1: float, nu1: float, E2: float, nu2: float) -> float:
    """E* with 1/E* = (1 - ν1²)/E1 + (1 - ν2²)/E2."""
    first = (1 - _poisson("nu1", nu1) ** 2) / positive("E1", E1)
    return 1 / (first + (0 if _is_infinite(E2) else (1 - _poisson("nu2", nu2) ** 2) / positive("E2", E2)))


# ----------------------------------------------------------------------------------- scalar problems


@dataclass(frozen=True)
class ColumnStack:
    """A stack of columns: pressure ≥ 0, compressions w ≤ 0 of the layers, shortenings of the bodies."""

    pressure: float
    compressions: tuple[float, ...]
    shortenings: tuple[float, ...]


def column_stack(
    heights: Sequence[float],
    moduli: Sequence[float],
    layers: Sequence[Layer],
    gaps: Sequence[float],
    closure: float,
) -> ColumnStack:
    """n columns (ν = 0) in a row, n - 1 layers and gaps between, the ends brought together by `closure`.

    p Σ H_i/E_i + Σ |w_j(p)| = closure - Σ gaps ("Known answers"), to rounding; p = 0 if that is ≤ 0.
    """
    heights = [positive(f"heights[{i}]", height) for i, height in enumerate(heights)]
    moduli = [positive(f"moduli[{i}]", modulus) for i, modulus in enumerate(moduli)]
    gaps = [finite(f"gaps[{j}]", gap) for j, gap in enumerate(gaps)]
    _check_stack(len(heights), moduli, layers, gaps)
    slack = finite("closure", closure) - math.fsum(gaps)
    softness = [height / modulus for height, modulus in zip(heights, moduli, strict=True)]
    pressure = _stack_pressure(math.fsum(softness), layers, slack) if slack > 0 else 0.0
    return ColumnStack(
        pressure,
        compressions=tuple(float(layer.compression(-pressure)) for layer in layers),
        shortenings=tuple(pressure * soft for soft in softness),
    )


def _stack_pressure(softness: float, layers: Sequence[Layer], slack: float) -> float:
    """p > 0 with p · softness + Σ |w_j(p)| = slack > 0: bracketing, then Newton steps down to rounding."""

    def excess(p: float) -> float:
        return math.fsum([p * softness, -slack, *(-float(layer.compression(-p)) for layer in layers)])

    # No body and no layer is shortened by more than the whole slack.
    upper = min([slack / softness, *(-float(layer.stress(-slack)) for layer in layers)])
    p = brentq(excess, 0, upper * (1 + 1e-12), xtol=5e-324, maxiter=2000)
    for _ in range(2):
        slopes = (float(layer.contact_derivative(layer.compression(-p))) for layer in layers)
        p -= excess(p) / (softness + math.fsum(1 / slope for slope in slopes))
    return p


def _check_stack(bodies: int, moduli: list[float], layers: Sequence[Layer], gaps: list[float]) -> None:
    for name, values, count in (
        ("moduli", moduli, bodies),
        ("layers", layers, bodies - 1),
        ("gaps", gaps, bodies - 1),
    ):
        if len(values) != count:
            raise ValueError(f"{name} = {values!r}: expected {count} values for {bodies} heights")
    for j, layer in enumerate(layers):
        if not isinstance(layer, Layer):
            raise TypeError(f"layers[{j}] = {layer!r}: expected a Layer")


@dataclass(frozen=True)
class ParabolaOnLayer:
    """A rigid parabola on a layer: half_width of the contact (length), peak_pressure (stress), and the force.

    The force is per unit length for the plane parabola, the whole one for the paraboloid.
    """

    approach: float
    R: float
    layer: PowerLayer
    half_width: float
    peak_pressure: float
    force: float

    def pressure(self, x: ArrayLike) -> Array:
        """p = (w/B)^(1/a), w = approach - x²/(2R), at the distance x from the middle; 0 outside (stress)."""
        z = np.asarray(x, dtype=float) ** 2 / (2 * self.R) - self.approach
        return np.abs(self.layer.contact_stress(z))


def rigid_parabola_on_layer(
    approach: float, R: float, B: float, a: float, axisymmetric: bool = False
) -> ParabolaOnLayer:
    """A rigid parabola x²/(2R), plane or of revolution, pressed by `approach` into a layer on a rigid base.

    With b = √(2 R approach), p₀ = (approach/B)^(1/a) and n = 1/a the force is p₀ b Beta(½, n + 1) in
    the plane and p₀ π b² / (n + 1) axisymmetrically, from ∫ (1 - t²)^n dt and ∫ (1 - t²)^n 2π t dt.
    """
    approach, R, layer = positive("approach", approach), positive("R", R), PowerLayer(B, a)
    half_width, peak, n = math.sqrt(2 * R * approach), -float(layer.stress(-approach)), 1 / layer.a
    area = math.pi * half_width**2 / (n + 1) if axisymmetric else half_width * float(beta(0.5, n + 1))
    return ParabolaOnLayer(approach, R, layer, half_width, peak, force=peak * area)


# --------------------------------------------------------------------------------- elastic constants


def _plane_modulus(E: float, nu: float) -> float:
    """E / (1 - ν²)."""
    return positive("E", E) / (1 - _poisson("nu", nu) ** 2)


def _oedometric_modulus(E: float, nu: float) -> float:
    """E (1 - ν) / [(1 + ν)(1 - 2ν)], compression with the sides held."""
    nu = _poisson("nu", nu)
    return positive("E", E) * (1 - nu) / ((1 + nu) * (1 - 2 * nu))


def _poisson(name: str, value: float) -> float:
    """`value` as a float, refused unless -1 < value < 0.5."""
    value = finite(name, value)
    if not -1 < value < 0.5:
        raise ValueError(f"{name} = {value!r}: expected a Poisson's ratio in (-1, 0.5)")
    return value


def _is_infinite(value: float) -> bool:
    """Whether `value` is +inf, which stands for a plane (radius) or a rigid body (modulus)."""
    return isinstance(value, float) and value > 0 and math.isinf(value)
