"""Linear elastic materials: the stiffness of Hooke's law (2) in Voigt's notation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .errors import finite, positive

#: Voigt's order of the tensor components; shear strains count twice (engineering strains).
VOIGT = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))


@dataclass(frozen=True)
class Isotropic:
    """An isotropic material: Young's modulus E > 0 (stress units), Poisson's ratio -1 < nu < 0.5."""

    E: float
    nu: float

    def __post_init__(self) -> None:
        positive("E", self.E)
        if not -1.0 < finite("nu", self.nu) < 0.5:
            raise ValueError(f"nu = {self.nu!r}: expected -1 < nu < 0.5")

    @property
    def lame(self) -> tuple[float, float]:
        """Lamé's constants λ and μ."""
        return self.E * self.nu / ((1 + self.nu) * (1 - 2 * self.nu)), self.E / (2 * (1 + self.nu))

    def stiffness(self) -> NDArray[np.float64]:
        """C as a 6 × 6 matrix (stress units): stresses = C @ engineering strains, in the order of `VOIGT`."""
        lam, mu = self.lame
        matrix = np.diag([2 * mu] * 3 + [mu] * 3)
        matrix[:3, :3] += lam
        return matrix
