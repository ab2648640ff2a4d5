"""The schemes: which Robin coefficient φ^k each of them takes, and whether its step solves the bodies apart.

All are G^k(u^{k+1}, v) = G^k(u^k, v) − γ^k F₁'(u^k, v), (16) and (25). They differ in φ^k and in G^k: a decomposed
scheme keeps φ (u_αn v_αn + u_βn v_βn), so that every body is solved on its own; a coupled one keeps the product of
sums φ (u_αn + u_βn)(v_αn + v_βn).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .base.arrays import Floats
from .layer import Layer

#: A 0/1 function ψ of the gaps z (n,) and the points x (dim, n): where the Robin condition is set.
Subset = Callable[[Floats, Floats], Floats]


#: φ from the layer, the gaps z^k and z^{k−1} (n,) and the points x (dim, n).
Coefficient = Callable[[Layer, Floats, Floats, Floats], Floats]


@dataclass(frozen=True)
class Scheme:
    """A scheme.

    name; coefficient: its φ; step: how the linear problem is solved: "decomposed" (every body on its own), "direct"
    (all coupled), "krylov" (coupled, by solves of the bodies apart) or "auto"; equation: in the paper; accelerated:
    whether Anderson's method mixes the iterates.
    """

    name: str
    coefficient: Coefficient
    step: str
    equation: str
    accelerated: bool = False

    @property
    def decomposed(self) -> bool:
        """Whether an iteration is one solve per body, relaxed."""
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
    """The decomposed one-point scheme (22) with your own subset: φ = ψ g'(z)."""

    def coefficient(layer: Layer, z: Floats, z_previous: Floats, x: Floats) -> Floats:
        return np.where(np.asarray(psi(z, x), dtype=bool), everywhere(layer, z, z_previous, x), 0.0)

    return Scheme("one-point, own ψ", coefficient, "decomposed", "(22)")


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
    if method not in SCHEMES:
        raise ValueError(f"method = {method!r}: expected one of {', '.join(map(repr, SCHEMES))} or a Scheme")
    return SCHEMES[method]
