"""Hertz' contact of cylinders and spheres."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.checks import positive
from .moduli import _contact_modulus, _is_infinite

# --------------------------------------------------------------------------------------------- Hertz


@dataclass(frozen=True)
class HertzCylinder:
    """Contact of parallel cylinders: half_width (length), peak_pressure (stress)."""

    half_width: float
    peak_pressure: float

    def pressure(self, x: ArrayLike) -> Floats:
        """The contact pressure at the distance x from the middle line (stress)."""
        return _ellipse(x, self.half_width, self.peak_pressure)


@dataclass(frozen=True)
class HertzSphere:
    """Contact of spheres: radius of the contact, approach (length), peak_pressure (stress)."""

    radius: float
    approach: float
    peak_pressure: float

    def pressure(self, r: ArrayLike) -> Floats:
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


def _ellipse(x: ArrayLike, half_width: float, peak: float) -> Floats:
    """peak √(1 - x²/half_width²), 0 outside."""
    return np.asarray(peak * np.sqrt(np.maximum(1 - (np.asarray(x, dtype=float) / half_width) ** 2, 0)))


def _relative_radius(R1: float, R2: float) -> float:
    """R with 1/R = 1/R1 + 1/R2."""
    return 1 / (1 / positive("R1", R1) + (0 if _is_infinite(R2) else 1 / positive("R2", R2)))
