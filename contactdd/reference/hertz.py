"""Hertz' contact of cylinders and spheres."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.checks import positive
from .moduli import contact_modulus, is_infinite


@dataclass(frozen=True)
class HertzCylinder:
    """Hertz' contact of parallel cylinders.

    Attributes:
        half_width: The half width of the contact (length).
        peak_pressure: The pressure in its middle (stress).
    """

    half_width: float
    peak_pressure: float

    def pressure(self, x: ArrayLike) -> Floats:
        """The contact pressure (stress); 0 outside of the contact.

        Args:
            x: Distances from the middle line (length), of any shape.
        """
        return _ellipse(x, self.half_width, self.peak_pressure)


@dataclass(frozen=True)
class HertzSphere:
    """Hertz' contact of spheres.

    Attributes:
        radius: The radius of the contact (length).
        approach: The approach of points far from it (length).
        peak_pressure: The pressure in its middle (stress).
    """

    radius: float
    approach: float
    peak_pressure: float

    def pressure(self, r: ArrayLike) -> Floats:
        """The contact pressure (stress); 0 outside of the contact.

        Args:
            r: Distances from the axis (length), of any shape.
        """
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
    """The contact of two cylinders, or of a cylinder and a plane, pressed together.

    Johnson, Contact Mechanics, §4.2(c): half-width² = 4 P R / (π E*), peak = 2 P / (π half-width).

    Args:
        load_per_length: The load P per unit length (force / length).
        R1: Radius of the first body (length).
        E1: Its Young's modulus (stress).
        nu1: Its Poisson's ratio.
        R2: Radius of the second body, inf for a plane.
        E2: Its Young's modulus, inf for a rigid body.
        nu2: Its Poisson's ratio.

    Raises:
        TypeError, ValueError: An argument is out of range.

    Example:
        >>> found = hertz_cylinder(35e3, R1=50.0, E1=210e3, nu1=0.3, E2=70e3, nu2=0.3)
        >>> print(f"{found.half_width:.4f} {found.peak_pressure:.2f}")
        6.2146 3585.36
    """
    load, radius = positive("load_per_length", load_per_length), _relative_radius(R1, R2)
    half_width = math.sqrt(4 * load * radius / (math.pi * contact_modulus(E1, nu1, E2, nu2)))
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
    """The contact of two spheres, or of a sphere and a plane, pressed together.

    Johnson, Contact Mechanics, §4.2(a): radius³ = 3 F R / (4 E*), approach = radius²/R, peak = 3 F / (2π radius²).

    Args:
        force: The force F.
        R1: Radius of the first body (length).
        E1: Its Young's modulus (stress).
        nu1: Its Poisson's ratio.
        R2: Radius of the second body, inf for a plane.
        E2: Its Young's modulus, inf for a rigid body.
        nu2: Its Poisson's ratio.

    Raises:
        TypeError, ValueError: An argument is out of range.

    Example:
        >>> found = hertz_sphere(1e3, R1=50.0, E1=20e3, nu1=0.0)
        >>> print(f"{found.radius:.4f} {found.approach:.4f}")
        1.2331 0.0304
    """
    force, relative = positive("force", force), _relative_radius(R1, R2)
    radius = float(np.cbrt(0.75 * force * relative / contact_modulus(E1, nu1, E2, nu2)))
    peak = 1.5 * force / (math.pi * radius**2)
    return HertzSphere(radius, approach=radius**2 / relative, peak_pressure=peak)


def _ellipse(x: ArrayLike, half_width: float, peak: float) -> Floats:
    """peak √(1 - x²/half_width²), 0 outside."""
    return np.asarray(peak * np.sqrt(np.maximum(1 - (np.asarray(x, dtype=float) / half_width) ** 2, 0)))


def _relative_radius(R1: float, R2: float) -> float:
    """R with 1/R = 1/R1 + 1/R2."""
    return 1 / (1 / positive("R1", R1) + (0 if is_infinite(R2) else 1 / positive("R2", R2)))
