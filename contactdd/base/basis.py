"""What basix gives on reference cells, as arrays of floats: quadrature rules, and the values of basis functions."""

from __future__ import annotations

from typing import Any

import basix
import numpy as np

from .arrays import Floats


def quadrature_rule(cell: basix.CellType, degree: int) -> tuple[Floats, Floats]:
    """Points (n, dim) and weights (n,) on the reference cell that integrate polynomials of the degree exactly."""
    points, weights = basix.make_quadrature(cell, degree)
    return np.asarray(points), np.asarray(weights)


def basis_values(element: Any, points: Floats) -> Floats:
    """The functions of a scalar element at points (n, dim) of its reference cell, (n, functions)."""
    return np.asarray(element.tabulate(0, points))[0, :, :, 0]
