"""Two blocks with a round dimple between them, about a corner: the problem in space that studies share.

Blocks 1 × 1 × 0.5 between smooth walls, pressed by q; the gap is 2.5e-4 (1 − r²/0.25)₊^1.5. Cells are named as
`kind:degree:nx:nz:grading`, such as Q:1:16:8:1: nx × nx × nz of a block, hexahedra (Q) or tetrahedra (P), whose
heights grow by the factor `grading` from the contact on.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import contactdd as cd
from contactdd.reference.dimple import dimple_shape

HEIGHT, LOAD = 0.5, 10.0
RADIUS, DEPTH = 0.5, 2.5e-4  # of the dimple
STEEL = cd.Isotropic(E=2.1e5, nu=0.3)
LAYER = cd.PowerLayer(B=4e-6, a=1.1)
TOLERANCE = 1e-8


def gap(x: np.ndarray) -> np.ndarray:
    """The dimple."""
    return dimple_shape(x[0], x[1], RADIUS, DEPTH)


@dataclass(frozen=True)
class Cells:
    """The cells of a block."""

    kind: str
    degree: int
    across: int
    high: int
    grading: float

    @classmethod
    def named(cls, name: str) -> Cells:
        kind, degree, across, high, grading = name.split(":")
        return cls(kind, int(degree), int(across), int(high), float(grading))

    @property
    def shape(self) -> str:
        return "hexahedron" if self.kind == "Q" else "tetrahedron"

    @property
    def ends(self) -> tuple[np.ndarray, np.ndarray]:
        """The ends of the cells across, and by their distance from the contact."""
        heights = self.grading ** np.arange(self.high)
        return np.linspace(0, 1, self.across + 1), HEIGHT * np.r_[0, np.cumsum(heights) / heights.sum()]


def scene(cells: Cells) -> cd.Scene:
    """The blocks, each with a mesh of its own; nothing is shared."""
    x, z = cells.ends
    sides = [cd.Symmetry("left", "right", "front", "back")]
    lower, upper = (
        cd.Body(
            name,
            cd.box(corner, end, (x, x, heights), shape=cells.shape),
            cd.Isotropic(STEEL.E * factor, STEEL.nu),
            supports=sides,
            loads=[cd.Pressure(side, LOAD)],
            degree=cells.degree,
        )
        for name, corner, end, heights, side, factor in (
            ("lower", (0, 0, -HEIGHT), (1, 1, 0), -z[::-1], "bottom", 1.0),
            ("upper", (0, 0, 0), (1, 1, HEIGHT), z, "top", 1.0 + 1e-12),  # as good as equal, but no copy
        )
    )
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), LAYER, gap=gap)])
