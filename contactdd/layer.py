"""Nonlinear Winkler layers: the law σ_n = g(w) of stress and compression, eqs (7), (8), (10), (14).

The sign convention is the paper's: w < 0 and σ_n < 0 in compression. Stresses and lengths are in the
user's own consistent set of units. A law is described by what it does in compression; for w > 0, which
contact never asks for, g is the odd extension g(-w) = -g(w).

Every method takes scalars or arrays of any shape, works element by element, returns a float64 array of
that shape and hands NaN on: a diverging iteration must be noticed, not be read as an open gap.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from .base.arrays import Floats
from .base.checks import as_floats, positive

Function = Callable[[Floats], ArrayLike]


class Layer(ABC):
    """A layer law: σ_n = g(w) with g(0) = 0 and g strictly increasing, eq. (7).

    A subclass gives five functions of the magnitudes c = -w ≥ 0, compression, and p = -g(w) ≥ 0, pressure.
    """

    @abstractmethod
    def _pressure(self, c: Floats) -> Floats:
        """p(c) = -g(-c)."""

    @abstractmethod
    def _slope(self, c: Floats) -> Floats:
        """p'(c) = g'(-c)."""

    @abstractmethod
    def _secant(self, deep: Floats, shallow: Floats) -> Floats:
        """[p(deep) - p(shallow)] / (deep - shallow) for deep ≥ shallow > 0, and p' where they are equal."""

    @abstractmethod
    def _energy(self, c: Floats) -> Floats:
        """The integral of p from 0 to c."""

    @abstractmethod
    def _depth(self, p: Floats) -> Floats:
        """The compression c with p(c) = p."""

    def stress(self, w: ArrayLike) -> Floats:
        """g(w) for every w (stress)."""
        w = np.asarray(w, dtype=float)
        return np.asarray(np.copysign(self._pressure(np.abs(w)), w))

    def derivative(self, w: ArrayLike) -> Floats:
        """g'(w) of the law itself (stress / length); may be 0 or inf at w = 0."""
        return np.asarray(self._slope(np.abs(np.asarray(w, dtype=float))))

    def contact_stress(self, z: ArrayLike) -> Floats:
        """g⁻(z), the contact stress at the gap z: g(z) where z < 0, else 0 (stress, ≤ 0), eq. (14)."""
        z = np.asarray(z, dtype=float)
        return np.asarray(0.0 - self._pressure(np.maximum(-z, 0.0)))  # p(0) = 0; less it, not minus it: no -0

    def contact_derivative(self, z: ArrayLike) -> Floats:
        """χ g'(z), χ = 1 where z < 0, else 0 (stress / length, ≥ 0), eqs (17)-(19)."""
        return self._where_closed(z, self._slope)

    def energy(self, z: ArrayLike) -> Floats:
        """The integral of g⁻ from 0 to z, the density of J (stress · length, ≥ 0); 0 where z ≥ 0."""
        return self._where_closed(z, self._energy)

    def divided_difference(self, y: ArrayLike, z: ArrayLike) -> Floats:
        """[g⁻(y) - g⁻(z)] / (y - z) of eqs (26), (27), (32), (36) (stress / length, ≥ 0).

        Free of cancellation: as y → z it tends to χ g'(z), which is also the value at y = z. Symmetric
        to the last bit. `y` and `z` broadcast.
        """
        y, z = np.asarray(y, dtype=float), np.asarray(z, dtype=float)
        low, high = np.minimum(y, z), np.maximum(y, z)
        open_ = high >= 0
        both_closed, across = ~open_, open_ & (low < 0)  # so written, NaN counts as closed and is handed on
        quotient = np.zeros(low.shape)
        if both_closed.any():
            quotient[both_closed] = self._secant(-low[both_closed], -high[both_closed])
        if across.any():
            quotient[across] = self._pressure(-low[across]) / (high[across] - low[across])
        return quotient

    def compression(self, stress: ArrayLike) -> Floats:
        """The w ≤ 0 with g(w) = stress (length).

        Raises ValueError if a stress is positive: a layer carries no tension.
        """
        stress = np.asarray(stress, dtype=float)
        if np.any(stress > 0):
            raise ValueError(f"stress = {stress.max():g}: expected stress <= 0 (compression)")
        return np.asarray(-self._depth(np.abs(stress)))

    def _where_closed(self, z: ArrayLike, function: Callable[[Floats], Floats]) -> Floats:
        """function(-z) where z < 0 or NaN, else 0; open points aren't evaluated, as g'(0) may be infinite."""
        z = np.asarray(z, dtype=float)
        closed = ~(z >= 0)
        values = np.zeros(z.shape)
        values[closed] = function(-z[closed])
        return values


@dataclass(frozen=True)
class PowerLayer(Layer):
    """The paper's layer g(w) = B^(-1/a) sgn(w) |w|^(1/a), that is |w| = B |σ_n|^a.

    B > 0 has the unit length / stress^a; a > 0 has none. g'(0) is infinite for a > 1, 1/B for a = 1
    and 0 for a < 1. Raises TypeError or ValueError if B or a isn't a positive finite number.

    >>> layer = PowerLayer(B=4e-6, a=1.1)
    >>> print(f"{layer.compression(-10.0):.4e}")
    -5.0357e-05
    """

    B: float
    a: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "B", positive("B", self.B))
        object.__setattr__(self, "a", positive("a", self.a))

    def _pressure(self, c: Floats) -> Floats:
        return (c / self.B) ** (1 / self.a)

    def _slope(self, c: Floats) -> Floats:
        at_zero = math.inf if self.a > 1 else 1 / self.B if self.a == 1 else 0.0
        chord = np.full(np.shape(c), self.a * at_zero)
        np.divide(self._pressure(c), c, out=chord, where=c != 0)
        return chord / self.a

    def _secant(self, deep: Floats, shallow: Floats) -> Floats:
        # With r = shallow/deep the quotient is p(deep)/deep · (1 - r^(1/a)) / (1 - r). Near r = 1 log r
        # comes from 1 - r, which subtracts without rounding; near r = 0 from r, which 1 - r has forgotten.
        # The least drop that there is, 1e-30, leaves the quotient its limit 1/a at r = 1.
        ratio, drop = shallow / deep, np.maximum((deep - shallow) / deep, 1e-30)
        with np.errstate(divide="ignore"):  # log 0 = -inf is right: a ratio that underflowed
            log_ratio = np.where(ratio < 0.5, np.log(ratio), np.log1p(-drop))
        return self._pressure(deep) / deep * (-np.expm1(log_ratio / self.a) / drop)

    def _energy(self, c: Floats) -> Floats:
        return self.a / (self.a + 1) * c * self._pressure(c)

    def _depth(self, p: Floats) -> Floats:
        return self.B * p**self.a


@dataclass(frozen=True)
class LinearLayer(Layer):
    """The linear layer g(w) = stiffness · w (stiffness > 0, stress / length).

    With a stiffness well above that of the bodies it is the usual penalty law for contact without layers.
    Raises TypeError or ValueError if the stiffness isn't a positive finite number.

    >>> LinearLayer(stiffness=2.0).contact_stress([-3.0, 3.0])
    array([-6.,  0.])
    """

    stiffness: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "stiffness", positive("stiffness", self.stiffness))

    def _pressure(self, c: Floats) -> Floats:
        return self.stiffness * c

    def _slope(self, c: Floats) -> Floats:
        return np.where(np.isnan(c), c, self.stiffness)

    def _secant(self, deep: Floats, shallow: Floats) -> Floats:
        return self._slope(deep)

    def _energy(self, c: Floats) -> Floats:
        return 0.5 * self.stiffness * c**2

    def _depth(self, p: Floats) -> Floats:
        return p / self.stiffness


class CustomLayer(Layer):
    """A layer whose law g the user gives as a function of arrays; it is evaluated at w ≤ 0 only.

    `derivative` and `energy` are functions of w ≤ 0 too, g'(w) and the integral of g from 0 to w;
    `inverse` takes stress ≤ 0 to w. What isn't given is computed from g:

    - derivative by eighth-order central differences (relative error 1e-11 for smooth g, 1e-2 at a kink);
    - energy by tanh-sinh quadrature, which doesn't mind an infinite slope at w = 0 (1e-13 for smooth g);
    - inverse by bisection, to rounding.

    With the derivative given and g smooth the divided difference is good to 1e-13. `compression_range`
    (length) is the largest compression expected; g is sampled from there down ten decades.

    Raises TypeError if an argument isn't callable, and ValueError if g isn't finite and strictly
    increasing with g(0) = 0 at the samples, eq. (7), or if most of them contradict a given derivative,
    energy, inverse.

    >>> layer = CustomLayer(lambda w: w + w**3, derivative=lambda w: 1 + 3 * w**2, name="cubic")
    >>> layer
    CustomLayer(name='cubic', compression_range=1.0)
    >>> float(layer.contact_stress(-2.0))
    -10.0
    """

    def __init__(
        self,
        g: Function,
        derivative: Function | None = None,
        energy: Function | None = None,
        inverse: Function | None = None,
        name: str = "custom",
        compression_range: float = 1.0,
    ) -> None:
        optional = {"derivative": derivative, "energy": energy, "inverse": inverse}
        for argument, value in {"g": g, **optional}.items():
            if not (callable(value) or (value is None and argument != "g")):
                raise TypeError(f"{argument} = {value!r}: expected a function of an array")
        self.name = name
        self.compression_range = positive("compression_range", compression_range)
        self._g, self._derivative, self._stored, self._inverse = g, derivative, energy, inverse
        self._check_law()
        self._check_given_parts()

    def __repr__(self) -> str:
        return f"CustomLayer(name={self.name!r}, compression_range={self.compression_range!r})"

    def _pressure(self, c: Floats) -> Floats:
        return -np.asarray(self._g(-c), dtype=float)

    def _slope(self, c: Floats) -> Floats:
        if self._derivative is not None:
            return np.asarray(self._derivative(-c), dtype=float)
        # At c = 0 a relative step has no meaning; the law close by stands in for it.
        return _central_derivative(self._pressure, np.where(c == 0, 1e-10 * self.compression_range, c))

    def _secant(self, deep: Floats, shallow: Floats) -> Floats:
        p_deep, width = self._pressure(deep), deep - shallow
        rise = p_deep - self._pressure(shallow)
        # Where either difference exceeds a tenth the quotient loses one digit. Elsewhere the law's
        # singularities are many widths away, and eight Gauss points average its slope to rounding.
        near = ~((width >= 0.1 * deep) | (rise >= 0.1 * p_deep))
        quotient = np.divide(rise, width, out=np.zeros_like(rise), where=~near)
        points = shallow[near, None] + width[near, None] * _GAUSS_POINTS
        quotient[near] = self._slope(points) @ _GAUSS_WEIGHTS
        return quotient

    def _energy(self, c: Floats) -> Floats:
        if self._stored is not None:
            return np.asarray(self._stored(-c), dtype=float)
        return _integral_from_zero(self._pressure, c)

    def _depth(self, p: Floats) -> Floats:
        if self._inverse is not None:
            return -np.asarray(self._inverse(-p), dtype=float)
        return _solve_increasing(self._pressure, p, np.full(p.shape, _TINY), self._upper_bound(p))

    def _upper_bound(self, p: Floats) -> Floats:
        """Compressions where the pressure is at least p: compression_range, doubled while the law rises."""
        upper = np.full(p.shape, self.compression_range)
        short = (reached := self._pressure(upper)) < p
        while short.any():
            upper[short] *= 2
            further = self._pressure(upper)
            if not np.all(further[short] > reached[short]):
                raise ValueError(f"stress = {-p[short].max():g}: expected a stress that {self!r} reaches")
            short, reached = further < p, further
        return upper

    def _samples(self) -> Floats:
        return self.compression_range * np.logspace(-10, 0, 301)

    def _check_law(self) -> None:
        c = np.concatenate(([0.0], self._samples()))
        p = -_on_arrays("g", self._g, -c)
        if p[0] != 0:
            raise ValueError(f"g = {self._g!r}: g(0) = {-p[0]:g}, expected g(0) = 0, eq. (7)")
        wrong = ~(np.isfinite(p[1:]) & (np.diff(p) > 0))
        if wrong.any():
            i = int(np.argmax(wrong))
            raise ValueError(
                f"g = {self._g!r}: g is {-p[i]:g} at w = {-c[i]:g}, {-p[i + 1]:g} at w = {-c[i + 1]:g}; "
                f"expected finite and strictly increasing down to w = {-c[-1]:g}, eq. (7)"
            )

    def _check_given_parts(self) -> None:
        c = self._samples()
        p = self._pressure(c)
        given = {"derivative": self._derivative, "energy": self._stored, "inverse": self._inverse}
        for name, function in given.items():
            if function is not None:
                _on_arrays(name, function, -(p if name == "inverse" else c))
        if self._stored is not None:
            _check_agreement("energy", self._energy(c), _integral_from_zero(self._pressure, c))
        if self._inverse is not None:
            _check_agreement("inverse", -self._depth(p), -c)
        if self._derivative is not None:
            slope = self._slope(c)
            _check_agreement("derivative", slope, _central_derivative(self._pressure, c))
            if not np.all(slope >= 0.0):
                i = int(np.argmin(np.where(np.isnan(slope), -np.inf, slope)))
                raise ValueError(f"derivative: {slope[i]:g} at w = {-c[i]:g}; expected numbers >= 0, as g increases")


@dataclass(frozen=True)
class TableLayer(Layer):
    """A measured law: a monotone cubic (PCHIP) through the points, straight beyond the last of them.

    The points are magnitudes: compressions (length) and pressures (stress), both strictly increasing;
    (0, 0) is added if it is missing. The law is continuously differentiable. Where PCHIP would end
    with slope 0, half the slope of the end chord replaces it, because g has to increase, eq. (7).

    Raises ValueError if the points aren't finite, of equal number, strictly increasing and ≥ 0.

    >>> layer = TableLayer(compressions=[1.0, 2.0, 3.0], pressures=[1.0, 4.0, 9.0])
    >>> layer.compression([0.0, -4.0, -9.0])
    array([-0., -2., -3.])
    """

    compressions: Sequence[float]
    pressures: Sequence[float]
    _law: scipy.interpolate.PPoly = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        c, p = _column("compressions", self.compressions), _column("pressures", self.pressures)
        c, p = _with_origin(c, p)
        for name, values in (("compressions", c), ("pressures", p)):
            if not np.all(np.diff(values) > 0):
                raise ValueError(f"{name} = {values.tolist()}: expected strictly increasing values >= 0")
        object.__setattr__(self, "compressions", tuple(c.tolist()))
        object.__setattr__(self, "pressures", tuple(p.tolist()))
        object.__setattr__(self, "_law", _monotone_cubic(c, p))

    def _pressure(self, c: Floats) -> Floats:
        return self._law(c)

    def _slope(self, c: Floats) -> Floats:
        return self._law.derivative()(c)

    def _energy(self, c: Floats) -> Floats:
        return self._law.antiderivative()(c)

    def _secant(self, deep: Floats, shallow: Floats) -> Floats:
        # Summed from knot to knot every term is positive, so nothing cancels.
        knots, table = self._law.x, np.asarray(self.pressures)
        first, last = self._piece(shallow), self._piece(deep)
        same = first == last
        end = np.where(same, deep, knots[first + 1])
        start_secant = self._secant_in_piece(first, end, shallow)
        end_rise = self._secant_in_piece(last, deep, knots[last]) * (deep - knots[last])
        between = table[last] - table[np.minimum(first + 1, table.size - 1)]
        rise = start_secant * (end - shallow) + between + end_rise
        return np.divide(rise, deep - shallow, out=start_secant, where=~same)

    def _depth(self, p: Floats) -> Floats:
        table, knots = np.asarray(self.pressures), self._law.x
        piece = np.clip(np.searchsorted(table, p, side="right") - 1, 0, table.size - 2)
        lower, upper = np.maximum(knots[piece], _TINY), knots[piece + 1]
        inside = _solve_increasing(self._law, np.minimum(p, table[-1]), lower, upper)
        beyond = knots[-2] + (p - table[-1]) / self._law.c[-2, -1]
        return np.where(p > table[-1], beyond, inside)

    def _piece(self, c: Floats) -> NDArray[np.intp]:
        """The index of the polynomial piece c lies in."""
        return np.clip(np.searchsorted(self._law.x, c, side="right") - 1, 0, self._law.x.size - 2)

    def _secant_in_piece(self, piece: NDArray[np.intp], s: Floats, t: Floats) -> Floats:
        """[p(s) - p(t)] / (s - t) for s, t in the same piece, by the cubic's coefficients: no division."""
        s, t = s - self._law.x[piece], t - self._law.x[piece]
        cubic, quadratic, linear = self._law.c[:3, piece]
        return cubic * (s**2 + s * t + t**2) + quadratic * (s + t) + linear


def _on_arrays(name: str, function: Function, values: Floats) -> Floats:
    """function(values), refused unless it takes arrays of any shape and gives real numbers of the same shape."""
    for given in (values, values.reshape(-1, 1)):
        try:
            found = np.asarray(function(given))
        except (TypeError, ValueError) as error:
            hint = "; np.where(...) chooses where `if` cannot" if "truth value" in str(error) else ""
            raise TypeError(f"{name} = {function!r}: expected a function of arrays ({error}{hint})") from error
        if found.dtype.kind not in "biuf":
            raise TypeError(f"{name} = {function!r}: gives {found.dtype} numbers; expected real ones")
        if found.shape != given.shape:
            raise ValueError(f"{name} = {function!r}: maps shape {given.shape} to {found.shape}; expected the same")
    return np.asarray(found, dtype=float).ravel()


def _column(name: str, values: ArrayLike) -> Floats:
    """`values` as a one-dimensional array of finite numbers; ValueError if they aren't."""
    try:
        column = as_floats(name, values, "a non-empty sequence of finite numbers")
    except (TypeError, ValueError):
        column = np.empty(0)
    if column.ndim != 1 or column.size == 0 or not np.all(np.isfinite(column)):
        raise ValueError(f"{name} = {values!r}: expected a non-empty sequence of finite numbers")
    return column


def _with_origin(c: Floats, p: Floats) -> tuple[Floats, Floats]:
    """The points of a table that begins with (0, 0); ValueError if too few or not in pairs."""
    if c.size != p.size:
        raise ValueError(f"pressures: {p.size} values, expected {c.size}, one for each of compressions")
    if c[0] != 0 or p[0] != 0:
        c, p = np.append(0.0, c), np.append(0.0, p)
    if c.size < 2:
        raise ValueError(f"compressions = {c.tolist()}: expected a point beside (0, 0)")
    return c, p


def _monotone_cubic(c: Floats, p: Floats) -> scipy.interpolate.PPoly:
    """The C¹ monotone cubic through the points, with a last piece that goes on straight."""
    slopes = scipy.interpolate.PchipInterpolator(c, p).derivative()(c)
    chords = np.diff(p) / np.diff(c)
    for end in (0, -1):
        slopes[end] = slopes[end] if slopes[end] > 0 else chords[end] / 2
    law = scipy.interpolate.CubicHermiteSpline(c, p, slopes)
    straight = [[0.0], [0.0], [slopes[-1]], [p[-1]]]
    return scipy.interpolate.PPoly(np.hstack((law.c, straight)), np.append(c, 2 * c[-1]))


def _check_agreement(argument: str, given: Floats, implied: Floats) -> None:
    """Raise ValueError unless most of the given values are within 0.1 % of those that g implies.

    Most, not all: next to a kink of g the implied derivative is off.
    """
    if not np.median(np.abs(given - implied) / np.abs(implied)) < 1e-3:
        raise ValueError(
            f"{argument}: {given[-1]:g} at the largest compression sampled, expected {implied[-1]:g} as of g"
        )


def _central_derivative(function: Callable[[Floats], Floats], c: Floats) -> Floats:
    """function'(c) for c > 0, increasing functions, by eighth-order central differences.

    The step is 1/64 of the length over which the law changes: c, or less where it steepens towards a
    pole.
    """
    p, before = function(c), function(c * (1 - 1e-6))
    scale = np.divide(p * 1e-6 * c, p - before, out=c.copy(), where=p > before)
    step = np.minimum(c, scale) / 64
    differences = [function(c + k * step) - function(c - k * step) for k in (1, 2, 3, 4)]
    return np.tensordot([4 / 5, -1 / 5, 4 / 105, -1 / 280], differences, axes=1) / step


def _integral_from_zero(function: Callable[[Floats], Floats], c: Floats) -> Floats:
    """The integral of function from 0 to c, by tanh-sinh quadrature."""
    return c * (function(c[..., None] * _TANH_SINH_POINTS) @ _TANH_SINH_WEIGHTS)


def _solve_increasing(function: Callable[[Floats], Floats], target: Floats, lower: Floats, upper: Floats) -> Floats:
    """The c in [lower, upper], lower > 0, with function(c) = target, by bisection of log c.

    0 where the target is 0, NaN where it is NaN.
    """
    for _ in range(72):  # 2^-72 log(1e308 / 1e-300) is below the rounding of c
        middle = np.sqrt(lower) * np.sqrt(upper)
        above = function(middle) >= target
        lower, upper = np.where(above, lower, middle), np.where(above, middle, upper)
    return np.where(target > 0, upper, target)


def _tanh_sinh(step: float = 1 / 16, end: float = 3.5) -> tuple[Floats, Floats]:
    """Points and weights on [0, 1] that don't mind a singularity at either end."""
    t = np.arange(-end, end + step / 2, step)
    points = 1 / (1 + np.exp(-np.pi * np.sinh(t)))
    return points, step * np.pi * np.cosh(t) * points / (1 + np.exp(np.pi * np.sinh(t)))


_TINY = 1e-300


_TANH_SINH_POINTS, _TANH_SINH_WEIGHTS = _tanh_sinh()


_GAUSS_POINTS, _GAUSS_WEIGHTS = np.array([[0.5], [0.0]]) + 0.5 * np.array(np.polynomial.legendre.leggauss(8))
