"""Exponential laws: with stiffness that grows with the pressure, as of rough surfaces, and Abaqus' form."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..base.arrays import Floats
from ..base.checks import finite, positive, positive_values
from .calculus import inverse, power_series, ratio, relative_expm1
from .limited import LimitedLayer

#: Decay lengths after which an exponential that has no end is cut: e^-40 = 4e-18 of its pressure at no separation.
ENDLESS = 40.0


#: Decay lengths after which an exponential goes on straight, well before its square overflows.
OVERFLOW = 300.0


#: (e^s - 1 - s) / s² = Σ s^k / (k + 2)!, enough of it for s < 0.1.
_EXCESS = tuple(1 / math.factorial(k + 2) for k in range(12))


#: [(s - 1) e^s + 1 - s²/2] / s³ = Σ s^k / ((k + 1)! (k + 3)), enough of it for s < 0.5.
_OVERCLOSURE_ENERGY = tuple(1 / (math.factorial(k + 1) * (k + 3)) for k in range(15))


@dataclass(frozen=True)
class ExponentialLayer(LimitedLayer):
    """The layer p = p₀ (e^(c/w₀) - 1): its stiffness is (p + p₀) / w₀.

    Beyond c = 300 w₀, where a double overflows soon, the law goes on straight.

    Source: R. E. Goodman, Methods of Geological Engineering (1976), and the laws named by its constructors.

    Args:
        p0: p₀, the scale of the pressure (stress).
        w0: w₀, the compression over which the stiffness grows e-fold (length).
        clearance: The distance of the surfaces at which the law begins (length, 0 by default); see `Layer`.

    Raises:
        TypeError, ValueError: `p0` or `w0` is no positive finite number, or `clearance` no finite one.

    Example:
        >>> round(float(ExponentialLayer(p0=2.0, w0=1e-3).contact_stress(-1e-3)), 6)
        -3.436564
    """

    p0: float
    w0: float
    clearance: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "p0", positive_values("p0", self.p0))
        object.__setattr__(self, "w0", positive_values("w0", self.w0))
        if not isinstance(self.clearance, np.ndarray):
            object.__setattr__(self, "clearance", finite("clearance", self.clearance))

    @classmethod
    def of_separation(cls, p0: float, decay: float) -> ExponentialLayer:
        """The layer p = p₀ e^(-u/u₀) of the separation u, stiffness p/u₀: rough surfaces, measured or computed.

        It has no end; here it begins at u = 40 u₀, where 4e-18 p₀ is left, and that is its clearance.

        Source: B. N. J. Persson, Relation between interfacial separation and load, Phys. Rev. Lett. 99 (2007), 125502.

        Args:
            p0: The pressure at u = 0 (stress).
            decay: u₀ (length): by the slope of a measured log p against u, or about 0.4 to 0.5 of the combined rms
                height of the roughness (Persson), when p₀ = β E* with β about 0.4.

        Raises:
            TypeError, ValueError: An argument is no positive finite number.

        Example:
            >>> ExponentialLayer.of_separation(p0=5.0, decay=1e-3).clearance
            0.04
        """
        p0, decay = positive("p0", p0), positive("decay", decay)
        return cls(p0 * math.exp(-ENDLESS), decay, ENDLESS * decay)

    @classmethod
    def calculix(cls, p0: float, c0: float) -> ExponentialLayer:
        """The layer of CalculiX' PRESSURE-OVERCLOSURE=EXPONENTIAL: p₀ at no clearance, a hundredth of it at c₀.

        p = p₀ e^(β d) with the overclosure d and β = log(100)/c₀.

        Source: CalculiX CrunchiX user's manual, ``*SURFACE BEHAVIOR``.

        Args:
            p0: The pressure at no clearance (stress).
            c0: The clearance at which a hundredth of that pressure is left (length).

        Raises:
            TypeError, ValueError: An argument is no positive finite number.
        """
        return cls.of_separation(positive("p0", p0), positive("c0", c0) / math.log(100.0))

    @classmethod
    def greenwood_williamson(cls, modulus: float, density: float, radius: float, deviation: float) -> ExponentialLayer:
        """The layer of a rough surface whose summits' heights are distributed exponentially.

        p = √π η E* R^(1/2) σ^(3/2) e^(-u/σ), u the separation from the summits' mean plane.

        Source: J. A. Greenwood, J. B. P. Williamson, Contact of nominally flat surfaces, Proc. R. Soc. A 295 (1966),
        300-319, section 3.

        Args:
            modulus: E*, 1/E* = (1 - ν₁²)/E₁ + (1 - ν₂²)/E₂ (stress).
            density: η, the number of summits per area (1/length²).
            radius: R, the radius of the summits (length).
            deviation: σ, the decay length of the distribution of their heights (length).

        Raises:
            TypeError, ValueError: An argument is no positive finite number.
        """
        modulus, density = positive("modulus", modulus), positive("density", density)
        radius, deviation = positive("radius", radius), positive("deviation", deviation)
        return cls.of_separation(math.sqrt(math.pi * radius * deviation) * density * modulus * deviation, deviation)

    @property
    def compression_limit(self) -> float | Floats:
        return OVERFLOW * self.w0

    def _known_pressure(self, c: Floats) -> Floats:
        return self.p0 * np.expm1(c / self.w0)

    def _known_slope(self, c: Floats) -> Floats:
        return self.p0 / self.w0 * np.exp(c / self.w0)

    def _known_secant(self, deep: Floats, shallow: Floats) -> Floats:
        return self._known_slope(shallow) * relative_expm1(ratio(deep - shallow, self.w0))

    def _known_energy(self, c: Floats) -> Floats:
        s = ratio(c, self.w0)
        small = s**2 * power_series(_EXCESS, np.minimum(s, 0.1))
        return self.p0 * self.w0 * np.where(s < 0.1, small, np.expm1(s) - s)

    def _known_depth(self, p: Floats) -> Floats:
        return self.w0 * np.log1p(p / self.p0)


@dataclass(frozen=True)
class OverclosureLayer(LimitedLayer):
    """The layer of Abaqus' exponential pressure-overclosure: p = p₀/(e - 1) s (e^s - 1), s = 1 + d/c₀.

    d is the overclosure: the pressure begins at the clearance c₀, and is p₀ where the surfaces touch. Its compression
    counts from there, s = c/c₀. Beyond s = 300 it goes on straight.

    Source: Abaqus Theory Guide, small-sliding interaction, "softened" contact.

    Args:
        p0: The pressure where the surfaces touch (stress).
        c0: The clearance at which the pressure begins (length); `Contact` subtracts it from the gap.

    Raises:
        TypeError, ValueError: An argument is no positive finite number.

    Example:
        >>> layer = OverclosureLayer(p0=5.0, c0=1e-3)
        >>> layer.clearance, layer.contact_stress([-1e-3, -2e-3]).round(4)
        (0.001, array([ -5.    , -37.1828]))
    """

    p0: float
    c0: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "p0", positive_values("p0", self.p0))
        object.__setattr__(self, "c0", positive_values("c0", self.c0))

    @property
    def clearance(self) -> float | Floats:
        return self.c0

    @property
    def compression_limit(self) -> float | Floats:
        return OVERFLOW * self.c0

    @property
    def _factor(self) -> float | Floats:
        return self.p0 / math.expm1(1.0)

    def _known_pressure(self, c: Floats) -> Floats:
        s = ratio(c, self.c0)
        return self._factor * s * np.expm1(s)

    def _known_slope(self, c: Floats) -> Floats:
        s = ratio(c, self.c0)
        return self._factor / self.c0 * (np.expm1(s) + s * np.exp(s))

    def _known_secant(self, deep: Floats, shallow: Floats) -> Floats:
        # The product rule for divided differences: of s (e^s - 1), all terms are positive.
        s, t = ratio(deep, self.c0), ratio(shallow, self.c0)
        growth = np.exp(t) * relative_expm1(ratio(deep - shallow, self.c0))
        return self._factor / self.c0 * (np.expm1(s) + t * growth)

    def _known_energy(self, c: Floats) -> Floats:
        s = ratio(c, self.c0)
        small = s**3 * power_series(_OVERCLOSURE_ENERGY, np.minimum(s, 0.5))
        return self._factor * self.c0 * np.where(s < 0.5, small, (s - 1) * np.exp(s) + 1 - s**2 / 2)

    def _known_depth(self, p: Floats) -> Floats:
        return inverse(self._known_pressure, self._known_slope, p, self.compression_limit)
