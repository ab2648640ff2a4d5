"""Columns in series with layers, and a rigid parabola on a layer: scalar equations, solved to rounding."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq
from scipy.special import beta

from ..base.arrays import Floats
from ..base.checks import finite, positive
from ..layer import Layer, PowerLayer
from .moduli import oedometric_modulus


@dataclass(frozen=True)
class UniformCompression:
    """The state of two equal blocks pressed flat on each other.

    Attributes:
        pressure: The contact pressure (stress).
        compression: The layers' w ≤ 0 (length).
        shortening: The shortening of each body (length).
        approach: The approach of the outer faces (length).
    """

    pressure: float
    compression: float
    shortening: float
    approach: float


def uniform_compression(q: float, h: float, E: float, nu: float, B: float, a: float) -> UniformCompression:
    """The uniform compression of two equal blocks with a power layer between them, exact on every mesh.

    σ_n = −q everywhere ("Known answers" of the model; the paper's groove with r0 = 0).

    Args:
        q: The pressure on the outer faces (stress).
        h: The height of each block (length).
        E: Young's modulus of both (stress).
        nu: Their Poisson's ratio; the sides are held against sliding out.
        B: The compliance of the layer ``|w| = B σ^a`` (length / stress^a).
        a: Its exponent.

    Raises:
        TypeError, ValueError: An argument is no positive number, or ν lies outside of (−1, 0.5).

    Example:
        >>> found = uniform_compression(q=10.0, h=1.0, E=2.1e5, nu=0.3, B=4e-6, a=1.1)
        >>> print(f"{found.compression:.4e} {found.approach:.4e}")
        -5.0357e-05 1.2111e-04
    """
    layer, q = PowerLayer(B, a), positive("q", q)
    shortening = q * positive("h", h) / oedometric_modulus(E, nu)
    w = float(layer.compression(-q))
    return UniformCompression(pressure=q, compression=w, shortening=shortening, approach=2 * shortening - w)


@dataclass(frozen=True)
class ColumnStack:
    """The state of a stack of columns pressed by its ends.

    Attributes:
        pressure: The pressure in every contact, ≥ 0 (stress).
        compressions: The compressions w ≤ 0 of the layers (length).
        shortenings: The shortenings of the columns (length).
    """

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
    """The stack of n columns (ν = 0) with n − 1 layers and gaps, its ends brought together.

    ``p Σ H_i/E_i + Σ |w_j(p)| = closure − Σ gaps`` ("Known answers"), to rounding; p = 0 if the right side is ≤ 0.

    Args:
        heights: (n,) The heights of the columns (length).
        moduli: (n,) Young's moduli (stress).
        layers: (n − 1,) The laws between neighbours.
        gaps: (n − 1,) The gaps between neighbours before they are moved (length).
        closure: The distance by which the ends are brought together (length).

    Raises:
        TypeError, ValueError: An argument is out of range, or the lengths of the lists do not fit.

    Example:
        >>> from contactdd.layer import LinearLayer
        >>> column_stack([1.0, 1.0], [100.0, 100.0], [LinearLayer(50.0)], [0.01], closure=0.05).pressure
        1.0
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
    """The contact of a rigid parabola with a layer on a rigid base.

    Attributes:
        approach: The depth of the vertex below the layer's surface (length).
        R: The radius of its vertex (length).
        layer: The law.
        half_width: The half width of the contact, or its radius (length).
        peak_pressure: The pressure under the vertex (stress).
        force: The force of the paraboloid; of the plane parabola per unit length (force / length).
    """

    approach: float
    R: float
    layer: PowerLayer
    half_width: float
    peak_pressure: float
    force: float

    def pressure(self, x: ArrayLike) -> Floats:
        """The pressure p = (w/B)^(1/a) with w = approach − x²/(2R); 0 outside of the contact.

        Args:
            x: Distances from the middle (length), of any shape.
        """
        z = np.asarray(x, dtype=float) ** 2 / (2 * self.R) - self.approach
        return np.abs(self.layer.contact_stress(z))


def rigid_parabola_on_layer(
    approach: float, R: float, B: float, a: float, axisymmetric: bool = False
) -> ParabolaOnLayer:
    """The contact of a rigid parabola x²/(2R), plane or of revolution, with a layer on a rigid base.

    With b = √(2 R approach), p₀ = (approach/B)^(1/a) and n = 1/a the force is p₀ b Beta(½, n + 1) in the plane and
    p₀ π b² / (n + 1) axisymmetrically, from ∫ (1 − t²)^n dt and ∫ (1 − t²)^n 2π t dt.

    Args:
        approach: The depth to which the vertex is pressed (length).
        R: The radius of the vertex (length).
        B: The compliance of the layer ``|w| = B σ^a`` (length / stress^a).
        a: Its exponent.
        axisymmetric: Whether it is a paraboloid.

    Raises:
        TypeError, ValueError: An argument is no positive number.

    Example:
        >>> round(rigid_parabola_on_layer(0.5, R=1.0, B=1.0, a=1.0, axisymmetric=True).force, 6)  # π R δ²/B
        0.785398
    """
    approach, R, layer = positive("approach", approach), positive("R", R), PowerLayer(B, a)
    half_width, peak, n = math.sqrt(2 * R * approach), -float(layer.stress(-approach)), 1 / layer.a
    area = math.pi * half_width**2 / (n + 1) if axisymmetric else half_width * float(beta(0.5, n + 1))
    return ParabolaOnLayer(approach, R, layer, half_width, peak, force=peak * area)
