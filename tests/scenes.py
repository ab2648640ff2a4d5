"""The scenes that many tests share: rectangles stacked between walls, and the paper's groove between them.

Lengths in cm, stresses in MPa.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

import contactdd as cd

Floats = NDArray[np.float64]

#: The paper's data.
LENGTH, HEIGHT, HALF_WIDTH, DEPTH, LOAD = 4.0, 1.0, 1.0, 5e-4, 10.0
STEEL = cd.Isotropic(E=2.1e5, nu=0.3)
LAYER = cd.PowerLayer(B=4e-6, a=1.1)


def groove(x: Floats, depth: float = DEPTH, half_width: float = HALF_WIDTH, middle: float = 0.0) -> Floats:
    """d(x) = r₀ {[1 − (x₁ − c)² / b²]⁺}^{3/2}: the paper's groove, of any depth r₀, half-width b and middle c."""
    return depth * np.maximum(1 - ((x[0] - middle) / half_width) ** 2, 0) ** 1.5


def block(
    name: str,
    floor: float,
    cells: tuple[int, int],
    material: cd.Material = STEEL,
    *,
    length: float = LENGTH,
    height: float = HEIGHT,
    supports: Sequence[Any] = (),
    loads: Sequence[Any] = (),
    shape: str = "triangle",
    diagonal: str = "right",
    **options: Any,
) -> cd.Body:
    """A rectangle that stands on y = `floor` between walls that its left and right side slide along."""
    mesh = cd.rectangle((0, floor), (length, floor + height), cells, shape=shape, diagonal=diagonal)
    walls = cd.Symmetry("left", "right")
    return cd.Body(name, mesh, material, supports=[walls, *supports], loads=loads, **options)


def stack(
    bodies: Sequence[cd.Body],
    layer: cd.Layer = LAYER,
    gap: float | Callable[[Floats], Floats] | cd.Parameter = groove,
    comm: Any = None,
    **options: Any,
) -> cd.Scene:
    """Bodies from below upwards, the top of each in contact with the bottom of the next."""
    pairs = pairwise(bodies)
    contacts = [cd.Contact((low, "top"), (high, "bottom"), layer, gap=gap, **options) for low, high in pairs]
    return cd.Scene(bodies, contacts) if comm is None else cd.Scene(bodies, contacts, comm=comm)


def pressed(
    cells: tuple[int, int] = (32, 16), *, gap: Any = groove, layer: cd.Layer = LAYER, load: Any = LOAD,
    quadrature: str = "gauss", **options: Any,
) -> cd.Scene:  # fmt: skip
    """Two equal blocks pressed together from both ends, the upper mesh the lower one's mirror image."""
    lower = block("lower", 0, cells, loads=[cd.Pressure("bottom", load)], **options)
    upper = block("upper", HEIGHT, cells, loads=[cd.Pressure("top", load)], diagonal="left", **options)
    return stack([lower, upper], layer, gap, quadrature=quadrature)


def paper(quadrature: str = "gauss", degree: int = 1, refine: int = 1) -> cd.Scene:
    """The paper's problem on its grid of 32 × 16 cells per body, each cut in two, times `refine`."""
    return pressed((32 * refine, 16 * refine), quadrature=quadrature, degree=degree)
