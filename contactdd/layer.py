"""Nonlinear Winkler layers: the law σ_n = g(w) of stress and compression, eqs (7), (8), (10), (14).

The sign convention is the paper's: w < 0 and σ_n < 0 in compression. Stresses and lengths are in the
user's own consistent set of units. A law is described by what it does in compression; for w > 0, which
only bonds ask for, g is the odd extension g(-w) = -g(w).

Every method takes scalars or arrays of any shape, works element by element, returns a float64 array of
that shape and hands NaN on: a diverging iteration must be noticed, not be read as an open gap.

Here are the contract and the paper's laws, power and linear; the folder `layers` has the others.
"""

from __future__ import annotations

import math
import warnings
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .base.arrays import Floats
from .base.checks import as_bool, finite, positive, positive_values


class Layer(ABC):
    """A layer law: σ_n = g(w) with g(0) = 0 and g strictly increasing, eq. (7).

    A subclass gives five functions of the magnitudes c = -w ≥ 0, compression, and p = -g(w) ≥ 0, pressure:
    `_pressure`, `_slope`, `_secant`, `_energy` and `_depth`.

    Example:
        >>> import contactdd as cd
        >>> layer = cd.PowerLayer(B=0.5, a=1.0)
        >>> layer.contact_stress([-2.0, 1.0]), layer.energy(-2.0), layer.divided_difference(-2.0, 2.0)
        (array([-4.,  0.]), array(4.), array(1.))
    """

    #: Whether the layer carries tension: its contact stress is g(z) for all z.
    bonded: ClassVar[bool] = False

    @property
    def remembers(self) -> bool:
        """Whether the law depends on what was before: `after` gives another one."""
        return False

    def after(self, z: Floats) -> Layer:
        """The law once the gaps (n,) at its points have been reached; itself, where it does not depend on that.

        Args:
            z: The gaps (length).
        """
        return self

    @property
    def sliding(self) -> Layer | None:
        """The law of the tangential displacement along the contact, None where nothing resists it."""
        return None

    @property
    def clearance(self) -> float | Floats:
        """The distance of the surfaces at which the law begins (length), 0 for most laws.

        A contact subtracts it from its gap, so that the pressure begins at z = 0.
        """
        return 0.0

    @property
    def compression_limit(self) -> float | Floats:
        """The compression up to which the law is known (length), inf for most laws.

        Beyond a table's end, or just before a pole, the law goes on straight; a solution that has passed this limit
        says so.
        """
        return math.inf

    def at(self, x: Floats) -> Layer:
        """The law at points of a contact: itself, where it is the same everywhere.

        Args:
            x: (dim, n) The coordinates of the points (length).
        """
        return self

    def _among(self, chosen: NDArray[np.bool_]) -> Layer:
        """The law at some of its points; itself, where it is the same everywhere."""
        return self

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
        """The stress g(w) for every w (stress).

        Args:
            w: The compressions, negative in compression (length).
        """
        w = np.asarray(w, dtype=float)
        return np.asarray(np.copysign(self._pressure(np.abs(w)), w))

    def derivative(self, w: ArrayLike) -> Floats:
        """The derivative g'(w) of the law itself (stress / length), which may be 0 or inf at w = 0.

        Args:
            w: The compressions, negative in compression (length).
        """
        return np.asarray(self._slope(np.abs(np.asarray(w, dtype=float))))

    def contact_stress(self, z: ArrayLike) -> Floats:
        """The contact stress g⁻(z): g(z) where z < 0, else 0 (stress, ≤ 0), eq. (14).

        Args:
            z: The gaps (length).
        """
        z = np.asarray(z, dtype=float)
        return np.asarray(0.0 - self._pressure(np.maximum(-z, 0.0)))  # p(0) = 0; less it, not minus it: no -0

    def contact_derivative(self, z: ArrayLike) -> Floats:
        """The derivative χ g'(z) of the contact stress, χ = 1 where z < 0, else 0 (stress / length, ≥ 0), (17)-(19).

        Args:
            z: The gaps (length).
        """
        return self._where_closed(z, lambda law, c: law._slope(c))

    def energy(self, z: ArrayLike) -> Floats:
        """The integral of g⁻ from 0 to z, the density of J (stress · length, ≥ 0); 0 where z ≥ 0.

        Args:
            z: The gaps (length).
        """
        return self._where_closed(z, lambda law, c: law._energy(c))

    def divided_difference(self, y: ArrayLike, z: ArrayLike) -> Floats:
        """The divided difference [g⁻(y) - g⁻(z)] / (y - z) of (26), (27), (32), (36) (stress / length, ≥ 0).

        Free of cancellation: as y → z it tends to χ g'(z), which is also the value at y = z. Symmetric to the last bit.

        Args:
            y, z: The gaps (length), which broadcast.
        """
        y, z = np.asarray(y, dtype=float), np.asarray(z, dtype=float)
        low, high = np.minimum(y, z), np.maximum(y, z)
        open_ = high >= 0
        both_closed, across = ~open_, open_ & (low < 0)  # so written, NaN counts as closed and is handed on
        quotient = np.zeros(low.shape)
        if both_closed.any():
            quotient[both_closed] = self._among(both_closed)._secant(-low[both_closed], -high[both_closed])
        if across.any():
            quotient[across] = self._among(across)._pressure(-low[across]) / (high[across] - low[across])
        return quotient

    def compression(self, stress: ArrayLike) -> Floats:
        """The compression w ≤ 0 with g(w) = stress (length).

        Args:
            stress: The contact stresses, ≤ 0 (stress).

        Raises:
            ValueError: A stress is positive: a layer carries no tension.
        """
        stress = np.asarray(stress, dtype=float)
        if np.any(stress > 0):
            raise ValueError(f"stress = {stress.max():g}: expected stress <= 0 (compression)")
        return np.asarray(-self._depth(np.abs(stress)))

    def _where_closed(self, z: ArrayLike, function: Callable[[Layer, Floats], Floats]) -> Floats:
        """function(law, -z) where z < 0 or NaN, else 0; open points aren't evaluated, as g'(0) may be infinite."""
        z = np.asarray(z, dtype=float)
        closed = ~(z >= 0)
        values = np.zeros(z.shape)
        values[closed] = function(self._among(closed), -z[closed])
        return values


@dataclass(frozen=True)
class PowerLayer(Layer):
    """The paper's layer g(w) = B^(-1/a) sgn(w) ``|w|``^(1/a), that is ``|w| = B |σ_n|^a``, eqs (8) and (10).

    g'(0) is infinite for a > 1, 1/B for a = 1 and 0 for a < 1.

    Args:
        B: The compliance B > 0 (length / stress^a).
        a: The exponent a > 0 (no unit).

    Raises:
        TypeError, ValueError: An argument is no positive finite number.

    Example:
        >>> layer = PowerLayer(B=4e-6, a=1.1)
        >>> print(f"{layer.compression(-10.0):.4e}")
        -5.0357e-05
    """

    B: float
    a: float

    @classmethod
    def machined_joint(
        cls, c: float, m: float, *, micrometre: float = 1e-3, newton_per_square_millimetre: float = 1.0
    ) -> PowerLayer:
        """The layer of a machined joint from its approach λ = c pᵐ, λ in µm and p in N/mm² as in that literature.

        Source: N. Back, M. Burdekin, A. Cowley, Review of the research on fixed and sliding joints, Proc. 13th MTDR
        Conf. (1973). Older tables have p in kgf/cm²: c there times (1/0.0980665)ᵐ is c here.

        Args:
            c: The joint's compliance, µm / (N/mm²)ᵐ; some 0.2 to 3 for ground, scraped and milled surfaces.
            m: Its exponent, about 0.5.
            micrometre: 1 µm in your unit of length, 1e-3 (mm) by default.
            newton_per_square_millimetre: 1 N/mm² in your unit of stress, 1 by default.

        Returns:
            The power law B = c · µm / (N/mm²)ᵐ, a = m in your units.

        Raises:
            TypeError, ValueError: An argument is no positive finite number.

        Example:
            >>> PowerLayer.machined_joint(c=0.6, m=0.5).compression(-4.0)  # mm at 4 N/mm²
            array(-0.0012)
        """
        c, m = positive("c", c), positive("m", m)
        length = positive("micrometre", micrometre)
        stress = positive("newton_per_square_millimetre", newton_per_square_millimetre)
        return cls(B=c * length / stress**m, a=m)

    def __post_init__(self) -> None:
        object.__setattr__(self, "B", positive_values("B", self.B))
        object.__setattr__(self, "a", positive_values("a", self.a))

    def _pressure(self, c: Floats) -> Floats:
        return (c / self.B) ** (1 / self.a)

    def _slope(self, c: Floats) -> Floats:
        chord = np.full(np.shape(c), self.a * self._slope_at_zero)
        np.divide(self._pressure(c), c, out=chord, where=c != 0)
        return chord / self.a

    @cached_property
    def _slope_at_zero(self) -> Floats:
        return np.where(self.a == 1, 1 / self.B, np.where(self.a > 1, np.inf, 0.0))

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
    """The linear layer g(w) = stiffness · w.

    With a stiffness well above that of the bodies it is the usual penalty law for contact without layers.

    Args:
        stiffness: The stiffness > 0 (stress / length).

    Raises:
        TypeError, ValueError: The stiffness is no positive finite number.

    Example:
        >>> LinearLayer(stiffness=2.0).contact_stress([-3.0, 3.0])
        array([-6.,  0.])
    """

    stiffness: float

    @classmethod
    def elastic_foundation(cls, E: float, nu: float, thickness: float, *, bonded: bool = True) -> LinearLayer:
        """The layer of a thin elastic sheet on a rigid base: p = M c / h.

        M = E (1 - ν) / [(1 + ν)(1 - 2ν)] where the sheet is bonded to its base, E / (1 - ν²) where it slides on it
        (plane strain). It holds where pressures vary over lengths much above h, and for a bonded sheet that is nearly
        incompressible above h √(M/μ), μ its shear modulus: there it bulges sideways instead, and for ν → ½ its
        pressure follows the curvature of the indentation, which no Winkler law does.

        Source: K. L. Johnson, Contact Mechanics (1985), section 5.8.

        Args:
            E: Young's modulus (stress).
            nu: Poisson's ratio, above -1; below 0.5 where bonded, at most 0.5 where it slides.
            thickness: h (length).
            bonded: Whether the sheet is bonded to its rigid base, or slides on it.

        Returns:
            The linear layer of the stiffness M / h.

        Raises:
            TypeError, ValueError: E or thickness is no positive number, or nu is out of its range.

        Warns:
            UserWarning: The sheet is bonded and ν > 0.45.

        Example:
            >>> round(LinearLayer.elastic_foundation(E=10.0, nu=0.25, thickness=2.0).stiffness, 12)
            6.0
        """
        E, thickness = positive("E", E), positive("thickness", thickness)
        modulus = _sheet_modulus(E, finite("nu", nu), as_bool("bonded", bonded))
        if bonded and nu > 0.45:
            warnings.warn(
                f"nu = {nu:g}: a bonded sheet that is nearly incompressible is a Winkler layer only where pressures "
                f"vary over lengths well above {thickness * math.sqrt(modulus * 2 * (1 + nu) / E):.3g}, "
                "thickness · √(M/μ); elsewhere it is much softer, and better meshed as a body",
                stacklevel=2,
            )
        return cls(modulus / thickness)

    def __post_init__(self) -> None:
        object.__setattr__(self, "stiffness", positive_values("stiffness", self.stiffness))

    def _pressure(self, c: Floats) -> Floats:
        return self.stiffness * c

    def _slope(self, c: Floats) -> Floats:
        return np.where(np.isnan(c), c, self.stiffness)

    def _secant(self, deep: Floats, shallow: Floats) -> Floats:
        return self._slope(deep)

    def _energy(self, c: Floats) -> Floats:
        return 0.5 * self.stiffness * c**2

    def _depth(self, p: Floats) -> Floats:
        return np.asarray(p / self.stiffness)


def _sheet_modulus(E: float, nu: float, bonded: bool) -> float:
    """The stress over the mean strain across a thin sheet between rigid faces."""
    if not (-1.0 < nu < 0.5 or (nu == 0.5 and not bonded)):
        expected = "-1 < nu < 0.5" if bonded else "-1 < nu <= 0.5"
        raise ValueError(f"nu = {nu!r}: expected {expected}")
    return E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) if bonded else E / (1 - nu**2)
