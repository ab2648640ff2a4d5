"""The groove problem as every package gets it: the same data, meshes, law, start and stopping rule."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# The paper's data: lengths in cm, stresses in MPa.
LENGTH, HEIGHT, GROOVE, DEPTH, LOAD = 4.0, 1.0, 1.0, 5e-4, 10.0
YOUNG, POISSON = 2.1e5, 0.3
LAME, SHEAR = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), YOUNG / (2 * (1 + POISSON))
SOFTNESS, EXPONENT = 4e-6, 1.1  # B and a of the layer

#: When Newton's method ends: the residual relative to the loads.
TOLERANCE = 1e-8
#: Where the contact begins, to three digits (a coarse run tells): where graded meshes are fine.
EDGE = 0.511


@dataclass(frozen=True)
class Grid:
    """The cells of either body: their ends along x, and their ends in the distance y from the contact."""

    name: str
    x: Floats
    y: Floats

    @cached_property
    def points(self) -> tuple[Floats, Floats]:
        """Nine Gauss points on each facet of the contact, and their weights: where p(x) is asked for."""
        reference, weights = np.polynomial.legendre.leggauss(9)
        half, middle = 0.5 * np.diff(self.x), 0.5 * (self.x[1:] + self.x[:-1])
        return (middle[:, None] + half[:, None] * reference).ravel(), (half[:, None] * weights).ravel()


@dataclass(frozen=True)
class Answer:
    """What a package found: the pressure at `Grid.points`, its number of unknowns and of Newton steps."""

    pressure: Floats
    unknowns: int
    steps: int


def uniform(nx: int, ny: int) -> Grid:
    """nx × ny equal cells per body."""
    return Grid(f"uniform {nx}×{ny}", np.linspace(0.0, LENGTH, nx + 1), np.linspace(0.0, HEIGHT, ny + 1))


def graded(left: int, middle: int, right: int, layers: int, ratio: float, depth_ratio: float) -> Grid:
    """Cells that shrink by `ratio` towards both edges, x = 0.511 of the contact and x = 1 of the groove, and by
    `depth_ratio` towards the contact; so many to the left of the edges, between them, to the right, and in depth."""
    x = np.concatenate(
        [
            _towards(EDGE, 0.0, left, ratio)[::-1],
            _towards_both(EDGE, GROOVE, middle, ratio)[1:-1],
            _towards(GROOVE, LENGTH, right, ratio),
        ]
    )
    y = _towards(0.0, HEIGHT, layers, depth_ratio)
    return Grid(f"graded {len(x) - 1}×{layers}", x, y)


def gap(x: Floats) -> Floats:
    """d(x)."""
    return DEPTH * np.maximum(1.0 - (x / GROOVE) ** 2, 0.0) ** 1.5


def pressure(z: Floats) -> Floats:
    """−g⁻(z)."""
    return (np.maximum(-z, 0.0) / SOFTNESS) ** (1.0 / EXPONENT)


def stiffness(z: Floats) -> Floats:
    """χ g'(z)."""
    c = np.maximum(-z, 0.0)
    return np.divide(pressure(z), EXPONENT * c, out=np.zeros_like(c), where=c > 0.0)


#: How far the upper body starts below its place: as if the contact carried the mean pressure with no groove.
START = SOFTNESS * LOAD**EXPONENT


def advance(
    u: Floats, correction: Floats, before: Floats, residual: Callable[[Floats], Floats]
) -> tuple[Floats, Floats]:
    """A full Newton step or, where the energy would rise, one to where its slope about vanishes; the residual there."""
    downhill, t, low, high = before @ correction, 1.0, 0.0, 1.0
    for _ in range(10):
        now = residual(u + t * correction)
        slope = now @ correction
        if abs(slope) <= 0.5 * downhill:
            break
        low, high = (t, high) if slope > 0 else (low, t)
        if low == high:
            break
        t = 0.5 * (low + high)
    return u + t * correction, now


def _towards(start: float, end: float, cells: int, ratio: float) -> Floats:
    sizes = float(ratio) ** np.arange(cells)
    return start + (end - start) * np.concatenate([[0.0], np.cumsum(sizes) / sizes.sum()])


def _towards_both(start: float, end: float, cells: int, ratio: float) -> Floats:
    distance = np.minimum(np.arange(cells), np.arange(cells)[::-1])
    sizes = float(ratio) ** distance
    return start + (end - start) * np.concatenate([[0.0], np.cumsum(sizes) / sizes.sum()])
