"""The schemes: the Robin coefficient φ^k of each, and the way to solve its linear problem.

All are G^k(u^{k+1}, v) = G^k(u^k, v) − γ^k F₁'(u^k, v), (16) and (25). They differ in φ^k and in G^k: a decomposed
scheme keeps φ (u_αn v_αn + u_βn v_βn), so that every body is solved on its own; a coupled one keeps the product of
sums φ (u_αn + u_βn)(v_αn + v_βn).
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .base.arrays import Floats
from .base.checks import as_bool, as_floats, check_choice, positional
from .contact_sides import ContactSides
from .layer import Layer

#: A 0/1 function ψ of the gaps z (n,) and the points x (dim, n): where the Robin condition is set.
Subset = Callable[[Floats, Floats], Floats]


#: The ways to solve the linear problem of a scheme.
STEPS = ("decomposed", "direct", "krylov", "auto")


#: φ from the layer, the gaps z^k and z^{k−1} (n,), the points x (dim, n) and, if it takes them, the contact's sides.
Coefficient = Callable[..., Floats]


#: What a coefficient takes.
TAKEN = "(layer, z, z_previous, x) or (layer, z, z_previous, x, sides)"


@dataclass(frozen=True)
class Scheme:
    """A scheme: its Robin coefficient φ, and how the linear problem of each iteration is solved.

    Attributes:
        name: The name, as in `SCHEMES`.
        coefficient: φ >= 0 (n,) (stress / length), a function of the layer, the gaps z^k and z^{k−1} (n,) (length) and
            the points x (dim, n); if it takes a fifth argument, that is the `ContactSides`: the contact, both bodies.
            Of a decomposed scheme without an order it may be (2, n), a row for each body of the contact.
        step: "decomposed" (one problem per body), "direct" (the coupled matrix factored), "krylov" (the coupled problem
            by conjugate gradients, preconditioned by the bodies' own problems) or "auto" (direct or Krylov, by size).
        equation: The equation of the paper.
        accelerated: Whether Anderson's method mixes the iterates.
        order: Of a decomposed scheme the names of all bodies, each solved with the displacements of those before it
            (the alternating method); names in a list of their own are solved at once. By default all are.

    Raises:
        TypeError, ValueError: A field is none of these.

    Example:
        >>> import contactdd as cd
        >>> secant = cd.Scheme("secant", lambda law, z, old, x: law.divided_difference(old, z), "direct", "(26)")
        >>> secant.phi(cd.LinearLayer(50.0), np.array([-0.1, 0.2]), np.array([-0.2, 0.1]), np.zeros((2, 2)))
        array([50.,  0.])
        >>> alternating = cd.Scheme("alternating", secant.coefficient, "decomposed", "", order=["lower", "upper"])
    """

    name: str
    coefficient: Coefficient = field(repr=False)
    step: str
    equation: str
    accelerated: bool = False
    order: Sequence[str | Sequence[str]] | None = None

    def __post_init__(self) -> None:
        for name in ("name", "equation"):
            if not isinstance(getattr(self, name), str):
                raise TypeError(f"{name} = {getattr(self, name)!r}: expected a text")
        if not callable(self.coefficient):
            raise TypeError(f"coefficient = {self.coefficient!r}: expected a function {TAKEN} -> φ")
        taken = positional(self.coefficient)
        if taken not in (4, 5, None):
            raise TypeError(
                f"coefficient = {self.coefficient!r}: it takes {taken} arguments; expected a function {TAKEN} -> φ"
            )
        if self.step == "apart":
            warnings.warn('step = "apart" is now called "decomposed"', DeprecationWarning, stacklevel=3)
            object.__setattr__(self, "step", "decomposed")
        check_choice("step", self.step, STEPS)
        as_bool("accelerated", self.accelerated)
        if self.order is not None and (not self.decomposed or isinstance(self.order, str)):
            raise ValueError(f'order = {self.order!r}: expected a list of names of bodies, with step = "decomposed"')
        if self.order is not None:
            order = tuple(each if isinstance(each, str) else tuple(each) for each in self.order)
            object.__setattr__(self, "order", order)

    @property
    def groups(self) -> list[list[str]]:
        """The names of the bodies that are solved at once, one list after another; empty if all are."""
        return [[each] if isinstance(each, str) else list(each) for each in self.order or ()]

    @cached_property
    def two_sided(self) -> bool:
        """Whether the coefficient sees the bodies on both sides."""
        return self.coefficient not in COEFFICIENTS and positional(self.coefficient) == 5

    def phi(self, layer: Layer, z: Floats, z_previous: Floats, x: Floats, sides: ContactSides | None = None) -> Floats:
        """The Robin coefficient φ at the points of a contact, (n,) or (2, n), a row a body (stress / length).

        Args:
            layer: The layer law.
            z: z^k (n,), the gaps of the present iterate (length).
            z_previous: z^{k−1} (n,), those of the iterate before (length).
            x: (dim, n) The coordinates of the points (length).
            sides: The contact and both bodies, which a two-sided coefficient takes.

        Raises:
            TypeError, ValueError: The user's own coefficient gives anything but n numbers >= 0.
        """
        seen = (layer, z, z_previous, x)
        values = self.coefficient(*seen, sides) if self.two_sided else self.coefficient(*seen)
        return values if self.coefficient in COEFFICIENTS else self._checked(values, z)

    def _checked(self, values: ArrayLike, z: Floats) -> Floats:
        """The values of a user's coefficient, refused unless they are a number >= 0 at every point."""
        phi = as_floats("phi", values, f"an array of {len(z)} numbers")
        able = [z.shape, (2, len(z))] if self.decomposed and self.order is None else [z.shape]
        if phi.shape not in able:
            expected = " or ".join(map(str, able))
            raise ValueError(
                f"scheme {self.name!r}: φ has the shape {phi.shape} at {len(z)} points; expected {expected}"
            )
        wrong = ~(phi >= 0.0) & np.isfinite(z)  # where the gap is no number, φ need not be one
        if np.any(wrong):
            at = np.unravel_index(int(np.argmax(wrong)), wrong.shape)
            raise ValueError(f"scheme {self.name!r}: φ = {phi[at]:g} where the gap is {z[at[-1]]:g}; expected φ >= 0")
        return phi

    @property
    def pointwise(self) -> bool:
        """Whether the coefficient at a point is known to depend on nothing but the law and the gaps there."""
        return self.coefficient in POINTWISE

    @property
    def decomposed(self) -> bool:
        """Whether an iteration is one solve of each body by itself, relaxed."""
        return self.step == "decomposed"


def semismooth(layer: Layer, z: Floats, z_previous: Floats, x: Floats) -> Floats:
    """φ = χ g'(z), χ = 1 where z < 0: (17), and (18) with (19)."""
    return layer.contact_derivative(z)


def nowhere(layer: Layer, z: Floats, z_previous: Floats, x: Floats) -> Floats:
    """φ = 0, ψ ≡ 0: the parallel Neumann scheme."""
    return np.zeros_like(z)


def everywhere(layer: Layer, z: Floats, z_previous: Floats, x: Floats) -> Floats:
    """φ = g'(z), ψ ≡ 1: Robin conditions on open parts as well."""
    phi = layer.derivative(z)
    bounded = np.isfinite(phi)
    # A power law with a > 1 is infinitely stiff at w = 0; the stiffest finite neighbour stands in for it.
    return np.where(bounded, phi, phi[bounded].max(initial=0.0))


def chord(layer: Layer, z: Floats, z_previous: Floats, x: Floats) -> Floats:
    """φ = [g⁻(z^{k−1}) − g⁻(z^k)] / [z^{k−1} − z^k]: (26), (32)."""
    return layer.divided_difference(z_previous, z)


def kurchatov(layer: Layer, z: Floats, z_previous: Floats, x: Floats) -> Floats:
    """φ = [g⁻(z^{k−1}) − g⁻(2z^k − z^{k−1})] / [2 (z^{k−1} − z^k)]: (27), (36)."""
    return layer.divided_difference(z_previous, 2 * z - z_previous)


def one_point(psi: Subset) -> Scheme:
    """The decomposed one-point scheme (22) with your own subset: φ = ψ g'(z).

    Args:
        psi: ψ, a function of the gaps z (n,) (length) and the points x (dim, n) to 0 or 1 at each point, (n,): where
            the Robin condition is set.

    Raises:
        TypeError: `psi` is no function. What it returns is checked in each iteration.

    Example:
        >>> import contactdd as cd
        >>> scheme = cd.one_point(lambda z, x: z < 0.01)
        >>> scheme.phi(cd.LinearLayer(50.0), np.array([-0.1, 0.005, 0.2]), np.zeros(3), np.zeros((2, 3)))
        array([50., 50.,  0.])
    """

    if not callable(psi):
        raise TypeError(f"psi = {psi!r}: expected a function (z, x) -> 0 or 1 at every point")

    def coefficient(layer: Layer, z: Floats, z_previous: Floats, x: Floats) -> Floats:
        return np.where(_subset(psi(z, x), z), everywhere(layer, z, z_previous, x), 0.0)

    return Scheme("one-point, own ψ", coefficient, "decomposed", "(22)")


def _subset(values: ArrayLike, z: Floats) -> NDArray[np.bool_]:
    """The mask (n,) of the points where ψ = 1."""
    psi = as_floats("psi", values, "0 or 1 at every point")
    if psi.shape not in ((), z.shape):
        raise ValueError(f"psi: shape {psi.shape} at {len(z)} points; expected {z.shape}")
    if not np.all((psi == 0.0) | (psi == 1.0)):
        raise ValueError(f"psi: {psi[(psi != 0.0) & (psi != 1.0)].flat[0]:g} at a point; expected 0 or 1")
    return np.broadcast_to(psi == 1.0, z.shape)


#: The coefficients of the schemes here, whose values need no check.
COEFFICIENTS = (semismooth, nowhere, everywhere, chord, kurchatov)


#: Those of them that look at the law and the gaps at each point alone.
POINTWISE = (semismooth, nowhere, chord, kurchatov)


SCHEMES = {
    scheme.name: scheme
    for scheme in (
        Scheme("neumann", nowhere, "decomposed", "(22), ψ ≡ 0"),
        Scheme("robin", everywhere, "decomposed", "(22), ψ ≡ 1"),
        Scheme("one-point", semismooth, "decomposed", "(22), ψ = χ"),
        Scheme("chord", chord, "decomposed", "(32)"),
        Scheme("kurchatov", kurchatov, "decomposed", "(36)"),
        Scheme("newton", semismooth, "direct", "(17)"),
        Scheme("newton-chord", chord, "direct", "(26)"),
        Scheme("newton-kurchatov", kurchatov, "direct", "(27)"),
        Scheme("anderson", chord, "decomposed", "(32)", accelerated=True),
        Scheme("newton-krylov", semismooth, "krylov", "(17)"),
        Scheme("auto", semismooth, "auto", "(17)"),
    )
}


def find_scheme(method: str | Scheme) -> Scheme:
    """The scheme of that name; a `Scheme` is itself."""
    if isinstance(method, Scheme):
        return method
    if not isinstance(method, str) or method not in SCHEMES:
        raise ValueError(f"method = {method!r}: expected one of {', '.join(map(repr, SCHEMES))} or a Scheme")
    return SCHEMES[method]
