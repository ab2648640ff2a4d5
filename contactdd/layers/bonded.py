"""Layers that carry tension: glue, bonds, springs. Their law holds for gaps of both signs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import Floats
from ..base.checks import finite
from ..layer import Layer, LinearLayer


@dataclass(frozen=True, repr=False)
class BondedLayer(Layer):
    """A layer that sticks to both surfaces: σ_n = g(z) where it is compressed, z < 0, and where it is stretched, z > 0.

    Its energy stays convex and its solution the minimum of F₁ (13): a bond of this kind does not break. With a shear
    stiffness k_t it resists sliding too, τ = −k_t s, s the tangential displacement of the first surface relative to the
    second. This adds ½ ∫ k_t s·s to F₁, and φ_t = k_t to the Robin term of each body, whatever the method. Such
    surfaces should coincide before deformation: where they are apart by d, turning together would shear the bond by d
    times the angle.

    Args:
        layer: The law in compression, p = −σ_n of c = −z.
        tension: The law in tension, σ_n of z, given as a layer too; by default that of compression. Both begin at the
            same distance of the surfaces, the clearance of `layer`.
        shear_stiffness: k_t ≥ 0 (stress / length), a number or a function of the coordinates x (dim, n) of the
            contact's points that gives (n,) positive ones; 0 lets the surfaces slide freely.

    Raises:
        TypeError, ValueError: One of them is no layer, carries tension itself or remembers; the shear stiffness is no
            number ≥ 0.

    Example:
        >>> from contactdd.layer import LinearLayer
        >>> glue = BondedLayer(LinearLayer(2.0), tension=LinearLayer(1.0))
        >>> glue.contact_stress([-3.0, 3.0]), glue.energy(3.0), glue.divided_difference(-1.0, 1.0)
        (array([-6.,  3.]), array(4.5), array(1.5))
    """

    layer: Layer
    tension: Layer | None = None
    shear_stiffness: float | Callable[[Floats], Floats] = 0.0

    bonded: ClassVar[bool] = True

    def __post_init__(self) -> None:
        if self.tension is None:
            object.__setattr__(self, "tension", self.layer)
        for name in ("layer", "tension"):
            law = getattr(self, name)
            if not isinstance(law, Layer) or law.bonded or law.remembers:
                raise TypeError(f"{name} = {law!r}: expected a layer that only presses, such as cd.LinearLayer(k)")

        if not callable(self.shear_stiffness) and finite("shear_stiffness", self.shear_stiffness) < 0.0:
            raise ValueError(f"shear_stiffness = {self.shear_stiffness!r}: expected a number >= 0")

    def __repr__(self) -> str:
        shear = "f(x)" if callable(self.shear_stiffness) else repr(self.shear_stiffness)
        return f"BondedLayer({self.layer!r}, tension={self.tension!r}, shear_stiffness={shear})"

    @classmethod
    def adhesive(cls, E: float, nu: float, thickness: float) -> BondedLayer:
        """The layer of a thin elastic adhesive: k = E (1 − ν) / [(1 + ν)(1 − 2ν) h] across it, k_t = E / [2 (1 + ν) h].

        Its edges are free to bulge over about a thickness only: elsewhere the adherends hold it along the joint.

        Source: O. Volkersen, Luftfahrtforschung 15 (1938); M. Goland, E. Reissner, J. Appl. Mech. 11 (1944).

        Args:
            E: Young's modulus (stress).
            nu: Poisson's ratio, between −1 and 0.5.
            thickness: h (length).

        Returns:
            The same linear law in compression and tension, with its shear stiffness.

        Raises:
            TypeError, ValueError: E or thickness is no positive number, or nu out of its range.

        Example:
            >>> glue = BondedLayer.adhesive(E=2500.0, nu=0.25, thickness=0.1)
            >>> round(glue.layer.stiffness), round(glue.shear_stiffness)
            (30000, 10000)
        """
        return cls(LinearLayer.elastic_foundation(E, nu, thickness), shear_stiffness=E / (2 * (1 + nu) * thickness))

    @cached_property
    def sliding(self) -> Layer | None:
        """The law of sliding along any axis, None where nothing resists it."""
        if callable(self.shear_stiffness):
            from .varying import VaryingLayer

            return BondedLayer(VaryingLayer(LinearLayer, stiffness=self.shear_stiffness))
        return BondedLayer(LinearLayer(self.shear_stiffness)) if self.shear_stiffness else None

    @property
    def _stretched(self) -> Layer:
        """The law in tension."""
        return self.layer if self.tension is None else self.tension

    @property
    def clearance(self) -> float | Floats:
        return self.layer.clearance

    @property
    def compression_limit(self) -> float | Floats:
        return self.layer.compression_limit

    @property
    def extension_limit(self) -> float | Floats:
        """The extension up to which the law in tension is known (length), inf for most laws."""
        return self._stretched.compression_limit

    def at(self, x: Floats) -> Layer:
        return self._made_of(self.layer.at(x), self._stretched.at(x))

    def _among(self, chosen: NDArray[np.bool_]) -> Layer:
        return self._made_of(self.layer._among(chosen), self._stretched._among(chosen))

    def _made_of(self, layer: Layer, tension: Layer) -> Layer:
        """The same of other laws; itself where they are the same."""
        same = layer is self.layer and tension is self.tension
        return self if same else BondedLayer(layer, tension, self.shear_stiffness)

    def contact_stress(self, z: ArrayLike) -> Floats:
        z = np.asarray(z, dtype=float)
        pressed, pulled = (law._pressure(np.maximum(c, 0.0)) for law, c in ((self.layer, -z), (self._stretched, z)))
        return np.asarray(np.where(z > 0, pulled, 0.0 - pressed))

    def stress(self, w: ArrayLike) -> Floats:
        return self.contact_stress(w)

    def contact_derivative(self, z: ArrayLike) -> Floats:
        """The derivative g'(z) (stress / length, ≥ 0); at z = 0 that of compression, which may be 0 or inf.

        Args:
            z: The gaps (length).
        """
        z = np.asarray(z, dtype=float)
        return np.asarray(np.where(z > 0, self._stretched._slope(np.maximum(z, 0.0)), self._pressed_slope(z)))

    def derivative(self, w: ArrayLike) -> Floats:
        return self.contact_derivative(w)

    def energy(self, z: ArrayLike) -> Floats:
        """The integral of g from 0 to z, the density of J (stress · length, ≥ 0).

        Args:
            z: The gaps (length).
        """
        z = np.asarray(z, dtype=float)
        pressed, pulled = (law._energy(np.maximum(c, 0.0)) for law, c in ((self.layer, -z), (self._stretched, z)))
        return np.asarray(np.where(z > 0, pulled, pressed))

    def divided_difference(self, y: ArrayLike, z: ArrayLike) -> Floats:
        y, z = np.asarray(y, dtype=float), np.asarray(z, dtype=float)
        low, high = np.minimum(y, z), np.maximum(y, z)
        pressed, pulled = ~(high >= 0), low > 0  # so written, NaN counts as pressed and is handed on
        between = ~pressed & ~pulled
        quotient = np.array(self._pressed_slope(np.zeros(low.shape)))  # where both are 0
        for where, law, deep, shallow in ((pressed, self.layer, -low, -high), (pulled, self._stretched, high, low)):
            if where.any():
                quotient[where] = law._among(where)._secant(deep[where], shallow[where])
        across = between & (high > low)
        if across.any():
            stresses = [self._among(across).contact_stress(end[across]) for end in (low, high)]
            quotient[across] = (stresses[1] - stresses[0]) / (high[across] - low[across])
        return quotient

    def compression(self, stress: ArrayLike) -> Floats:
        """The compression w < 0, or the extension w > 0, with g(w) = stress (length).

        Args:
            stress: The contact stresses, positive in tension (stress).
        """
        stress = np.asarray(stress, dtype=float)
        pressed, pulled = (
            law._depth(np.maximum(p, 0.0)) for law, p in ((self.layer, -stress), (self._stretched, stress))
        )
        return np.asarray(np.where(stress > 0, pulled, 0.0 - pressed))

    def _pressed_slope(self, z: Floats) -> Floats:
        return self.layer._slope(np.maximum(-z, 0.0))

    def _pressure(self, c: Floats) -> Floats:
        return self.layer._pressure(c)

    def _slope(self, c: Floats) -> Floats:
        return self.layer._slope(c)

    def _secant(self, deep: Floats, shallow: Floats) -> Floats:
        return self.layer._secant(deep, shallow)

    def _energy(self, c: Floats) -> Floats:
        return self.layer._energy(c)

    def _depth(self, p: Floats) -> Floats:
        return self.layer._depth(p)
