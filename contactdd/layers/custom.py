"""A layer by the user's own function."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.checks import positive
from .calculus import TINY, central_derivative, integral_from_zero, mean_slope, solve_increasing
from .limited import STEEP, LimitedLayer

Function = Callable[[Floats], ArrayLike]


class CustomLayer(LimitedLayer):
    """A layer with the user's own law g, a function of arrays, which is evaluated at w ≤ 0 only.

    Functions that are not given are computed from g:

    - the derivative by eighth-order central differences (relative error 1e-11 for smooth g, 1e-2 at a kink);
    - the energy by tanh-sinh quadrature, which allows an infinite slope at w = 0 (1e-13 for smooth g);
    - the inverse by bisection, to rounding.

    With the derivative given and g smooth the divided difference is good to 1e-13. Beyond `compression_range` the law
    may have a pole, where it becomes infinite or is no number any more: just before it, where g is 1e10 times stiffer
    than at `compression_range`, the law goes on straight (`compression_limit`).

    Args:
        g: The law, a function of compressions w ≤ 0 (length) to stresses g(w) ≤ 0 of the same shape.
        derivative: g'(w) ≥ 0 (stress / length), a function of w ≤ 0.
        energy: The integral of g from 0 to w (stress · length), a function of w ≤ 0.
        inverse: The w ≤ 0 with g(w) = stress, a function of stress ≤ 0.
        name: The name of the law in texts.
        compression_range: The largest compression expected (length); g is checked from there down ten decades.

    Raises:
        TypeError: An argument is no function of arrays.
        ValueError: At the samples g is not finite and strictly increasing with g(0) = 0, eq. (7), or most of them
            contradict a given derivative, energy or inverse.

    Example:
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
        self._pole = math.inf  # until the law is known to be one
        self._check_law()
        self._check_given_parts()
        self._pole = self._find_pole()

    def __repr__(self) -> str:
        return f"CustomLayer(name={self.name!r}, compression_range={self.compression_range!r})"

    @cached_property
    def compression_limit(self) -> float:
        if math.isinf(self._pole):
            return math.inf
        low, high = self.compression_range, self._pole
        steepest = STEEP * self._chord(low)
        for _ in range(100):  # to neighbouring doubles
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self._chord(middle) <= steepest else (low, middle)
        return low

    def _known_pressure(self, c: Floats) -> Floats:
        return -np.asarray(self._g(-c), dtype=float)

    def _chord(self, c: float) -> float:
        """The slope just above c, short of the pole."""
        near = np.array([c, c - 1e-3 * min(c, self._pole - c)])
        with np.errstate(all="ignore"):
            p = self._known_pressure(near)
            return float((p[0] - p[1]) / (near[0] - near[1]))

    def _find_pole(self) -> float:
        """The compression where g, having steepened, is no longer finite and increasing; inf if there is none."""
        with np.errstate(all="ignore"):
            good = self.compression_range * 2.0 ** np.arange(64)
            p = np.array([self._at_or_nan(c) for c in good])
            wrong = ~(np.isfinite(p[1:]) & (p[1:] >= p[:-1]))
            if not wrong.any():
                return math.inf
            low, high = good[int(np.argmax(wrong))], good[int(np.argmax(wrong)) + 1]
            floor = p[int(np.argmax(wrong))]
            for _ in range(60):
                middle = 0.5 * (low + high)
                reached = self._at_or_nan(middle)
                low, high = (middle, high) if np.isfinite(reached) and reached >= floor else (low, middle)
        return float(high) if self._chord(low - 1e-6 * (low - good[0])) > 10 * self._chord(good[0]) else math.inf

    def _at_or_nan(self, c: float) -> float:
        """The pressure beyond compression_range, where g may not care to be asked."""
        try:
            return float(self._known_pressure(np.array([c]))[0])
        except (ArithmeticError, ValueError):
            return math.nan

    def _known_slope(self, c: Floats) -> Floats:
        if self._derivative is not None:
            return np.asarray(self._derivative(-c), dtype=float)
        # At c = 0 a relative step has no meaning; the law close by stands in for it.
        nonzero = np.where(c == 0, 1e-10 * self.compression_range, c)
        return central_derivative(self._known_pressure, nonzero, self._pole)

    def _known_secant(self, deep: Floats, shallow: Floats) -> Floats:
        p_deep, width = self._known_pressure(deep), deep - shallow
        rise = p_deep - self._known_pressure(shallow)
        # Where either difference exceeds a tenth the quotient loses one digit. Elsewhere the law's
        # singularities are many widths away, and eight Gauss points average its slope to rounding.
        near = ~((width > 0) & ((width >= 0.1 * deep) | (rise >= 0.1 * p_deep)))
        quotient = np.divide(rise, width, out=np.zeros_like(rise), where=~near)
        quotient[near] = mean_slope(self._known_slope, shallow[near], width[near])
        return quotient

    def _known_energy(self, c: Floats) -> Floats:
        if self._stored is not None:
            return np.asarray(self._stored(-c), dtype=float)
        return integral_from_zero(self._known_pressure, c)

    def _known_depth(self, p: Floats) -> Floats:
        if self._inverse is not None:
            return -np.asarray(self._inverse(-p), dtype=float)
        return solve_increasing(self._known_pressure, p, np.full(p.shape, TINY), self._upper_bound(p))

    def _upper_bound(self, p: Floats) -> Floats:
        """Compressions where the pressure is at least p: compression_range, doubled while it rises, or the limit."""
        if math.isfinite(self.compression_limit):
            return np.full(p.shape, self.compression_limit)
        upper = np.full(p.shape, self.compression_range)
        short = (reached := self._known_pressure(upper)) < p
        while short.any():
            upper[short] *= 2
            further = self._known_pressure(upper)
            if not np.all(further[short] > reached[short]):
                raise ValueError(
                    f"stress = {-p[short].max():g}: expected a stress that {self!r} reaches; beyond its "
                    f"compression_range it rises to {reached[short].max():g} only"
                )
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
                f"g = {self._g!r}: g is {-p[i]:g} at w = {-c[i]:g}, {-p[i + 1]:g} at w = {-c[i + 1]:g}; expected "
                f"finite and strictly increasing, eq. (7), down to w = -compression_range = {-c[-1]:g}; a law with a "
                "pole needs a compression_range short of it"
            )

    def _check_given_parts(self) -> None:
        c = self._samples()
        p = self._known_pressure(c)
        given = {"derivative": self._derivative, "energy": self._stored, "inverse": self._inverse}
        for name, function in given.items():
            if function is not None:
                _on_arrays(name, function, -(p if name == "inverse" else c))
        if self._stored is not None:
            _check_agreement("energy", self._known_energy(c), integral_from_zero(self._known_pressure, c))
        if self._inverse is not None:
            _check_agreement("inverse", -self._known_depth(p), -c)
        if self._derivative is not None:
            slope = self._known_slope(c)
            _check_agreement("derivative", slope, central_derivative(self._known_pressure, c))
            if not np.all(slope >= 0.0):
                i = int(np.argmin(np.where(np.isnan(slope), -np.inf, slope)))
                raise ValueError(f"derivative: {slope[i]:g} at w = {-c[i]:g}; expected numbers >= 0, as g increases")


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


def _check_agreement(argument: str, given: Floats, implied: Floats) -> None:
    """Raise ValueError unless most of the given values are within 0.1 % of those that g implies.

    Most, not all: next to a kink of g the implied derivative is off.
    """
    if not np.median(np.abs(given - implied) / np.abs(implied)) < 1e-3:
        raise ValueError(
            f"{argument}: {given[-1]:g} at the largest compression sampled, expected {implied[-1]:g} as of g"
        )
