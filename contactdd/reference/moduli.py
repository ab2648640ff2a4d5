"""Elastic moduli, checked."""

from __future__ import annotations

import math

from ..base.checks import finite, positive


def contact_modulus(E1: float, nu1: float, E2: float, nu2: float) -> float:
    """E* with 1/E* = (1 - ν1²)/E1 + (1 - ν2²)/E2."""
    first = (1 - poisson("nu1", nu1) ** 2) / positive("E1", E1)
    return 1 / (first + (0 if is_infinite(E2) else (1 - poisson("nu2", nu2) ** 2) / positive("E2", E2)))


def plane_modulus(E: float, nu: float) -> float:
    """E / (1 - ν²)."""
    return positive("E", E) / (1 - poisson("nu", nu) ** 2)


def oedometric_modulus(E: float, nu: float) -> float:
    """E (1 - ν) / [(1 + ν)(1 - 2ν)], compression with the sides held."""
    nu = poisson("nu", nu)
    return positive("E", E) * (1 - nu) / ((1 + nu) * (1 - 2 * nu))


def poisson(name: str, value: float) -> float:
    """`value` as a float, refused unless -1 < value < 0.5."""
    value = finite(name, value)
    if not -1 < value < 0.5:
        raise ValueError(f"{name} = {value!r}: expected a Poisson's ratio in (-1, 0.5)")
    return value


def is_infinite(value: float) -> bool:
    """Whether `value` is +inf, which stands for a plane (radius) or a rigid body (modulus)."""
    return isinstance(value, float) and value > 0 and math.isinf(value)
