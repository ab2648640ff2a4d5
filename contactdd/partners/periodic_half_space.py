"""The elastic half-space under pressures that repeat themselves in two directions, by fast Fourier transforms."""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.checks import positive
from ..base.spectral import SpectralStiffness
from ..material import Isotropic
from ..parameter import Parameter
from . import influence
from .elastic_surface import hats
from .half_space import HalfSpace

#: Weights of the interpolation that are the rounding of a point's place.
ROUNDING = 1e-12


class PeriodicHalfSpace(HalfSpace):
    """An elastic half-space under pressures that repeat themselves along both sides of a grid.

    A pressure cos k·x moves it by ``2 cos k·x / (E* |k|)``. No matrix is stored: 512 × 512 points are no trouble, such
    as rough surfaces have, whose heights are a contact's gap. A uniform pressure moves the surface without limit: its
    mean is counted from points at a depth `reference`, as of `PeriodicHalfPlane`, where the half-space is held, moved
    or loaded. Partners without a mesh have to lie, or repeat themselves, above the grid.

    Args:
        name: Unique in a scene.
        material: `Isotropic`, of two numbers.
        size: (2,) both periods (length).
        cells: (2,) how many points there are along each.
        reference: The depth from which mean displacements are counted, by default the larger period (length).
        origin: (3,) the middle of the grid (length).
        normal: (3,) out of the body.
        along: (3,) the direction of the first period, by default the x axis.
        displacement: Of what holds it, along the normal (length): a number, a `Parameter`, or None where it is free.
        force: On one period along the normal (force): a number or a `Parameter`.

    Raises:
        TypeError, ValueError: An argument is none of these.

    Example:
        >>> PeriodicHalfSpace("ground", Isotropic(2.1e5, 0.3), (1, 1), (512, 512)).size
        262145
    """

    most = 2**22

    def __init__(
        self,
        name: str,
        material: Isotropic,
        size: ArrayLike,
        cells: tuple[int, int],
        *,
        reference: float | None = None,
        origin: ArrayLike = (0.0, 0.0, 0.0),
        normal: ArrayLike = (0.0, 0.0, 1.0),
        along: ArrayLike = (1.0, 0.0, 0.0),
        displacement: float | Parameter | None = 0.0,
        force: float | Parameter = 0.0,
    ) -> None:
        super().__init__(
            name,
            material,
            size,
            cells,
            origin=origin,
            normal=normal,
            along=along,
            displacement=displacement,
            force=force,
        )
        self.reference = positive("reference", float(self.extent.max()) if reference is None else reference)

    def stiffness(self) -> SpectralStiffness:
        area = float(np.prod(self.steps))
        return SpectralStiffness(np.asarray(area * self.modulus / self._compliance, dtype=float), self.cells)

    def flexibility(self) -> Floats:
        # The answer to a force at the first place, moved to all others.
        answer = scipy.fft.irfft2(self._compliance, s=self.cells) / (self.modulus * np.prod(self.steps))
        i, j = (index.ravel() for index in np.indices(self.cells))
        away = (i[:, None] - i) % self.cells[0], (j[:, None] - j) % self.cells[1]
        return np.asarray(answer[away])

    def interpolation(self, x: Floats) -> scipy.sparse.csr_matrix:
        own = (x - self.origin) @ self._axes.T
        rows = []
        for at, step, count in zip(own.T, self.steps, self.cells, strict=True):
            nodes = step * np.arange(count + 1)
            rows.append(hats(self.name, np.mod(at + 0.5 * (count - 1) * step, count * step), nodes))
        a, b = rows
        first, second = a.indices.reshape(-1, 2, 1) % self.cells[0], b.indices.reshape(-1, 1, 2) % self.cells[1]
        values = (a.data.reshape(-1, 2, 1) * b.data.reshape(-1, 1, 2)).ravel()
        starts = 4 * np.arange(len(x) + 1)
        entries = (np.where(values > ROUNDING, values, 0.0), (first * self.cells[1] + second).ravel(), starts)
        found = scipy.sparse.csr_matrix(entries, shape=(len(x), len(self.areas)))
        found.eliminate_zeros()  # at the places themselves there is one entry
        return found

    @property
    def _compliance(self) -> Floats:
        """c(k) of all waves for a modulus E* = 1, (nx, ny // 2 + 1)."""
        kx = 2 * np.pi * scipy.fft.fftfreq(self.cells[0], self.steps[0])
        ky = 2 * np.pi * scipy.fft.rfftfreq(self.cells[1], self.steps[1])
        k = np.hypot(kx[:, None], ky)
        return np.where(k > 0, influence.half_plane_wave(np.where(k > 0, k, 1.0)), self.reference)
