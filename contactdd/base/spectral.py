"""Operators on periodic grids that are diagonal in Fourier's basis: no matrix is stored."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from .arrays import Floats

#: Points up to which the matrix may be asked for: it takes half a gigabyte.
LARGEST_MATRIX = 8000


@dataclass(frozen=True)
class SpectralStiffness:
    """The stiffness between values on a periodic grid, and before them a translation that costs nothing.

    symbol: (nx, ny // 2 + 1) the stiffness of each wave; cells: (nx, ny); translation: whether it is one of the
    unknowns.
    """

    symbol: Floats
    cells: tuple[int, int]
    translation: bool = True

    @property
    def shape(self) -> tuple[int, int]:
        """(unknowns, unknowns)."""
        size = self.cells[0] * self.cells[1] + int(self.translation)
        return size, size

    @property
    def largest(self) -> float:
        """The largest of all stiffnesses."""
        return float(self.symbol.max())

    def without_translation(self) -> SpectralStiffness:
        """The stiffness between the values on the grid alone."""
        return replace(self, translation=False)

    def __matmul__(self, y: Floats) -> Floats:
        return self._filtered(y, self.symbol, 0.0)

    def toarray(self) -> Floats:
        """The matrix, of a small grid.

        Raises:
            ValueError: It would be too large.
        """
        if self.shape[0] > LARGEST_MATRIX:
            raise ValueError(
                f"a matrix of {self.shape[0]} points on a periodic grid: too large to be factored; expected "
                "method='auto' or 'newton-krylov', or at most "
                f"{LARGEST_MATRIX} points"
            )
        return self @ np.eye(self.shape[0])

    def shifted_inverse(self, y: Floats, shift: float, stiffness: float) -> Floats:
        """(K + shift)⁻¹ y on the grid, and y / stiffness of the translation: symmetric and positive definite."""
        return self._filtered(y, np.asarray(1.0 / (self.symbol + shift), dtype=float), 1.0 / stiffness)

    def flexed(self, forces: Floats) -> Floats:
        """K⁻¹ times forces on the grid, and nothing of the translation."""
        return self._filtered(forces, self._compliance, 0.0)

    def in_series(self, y: Floats, compliance: float) -> Floats:
        """(K⁻¹ + compliance)⁻¹ y on the grid, and nothing of the translation."""
        return self._filtered(y, np.asarray(1.0 / (self._compliance + compliance), dtype=float), 0.0)

    @cached_property
    def _compliance(self) -> Floats:
        """K⁻¹ of each wave."""
        return np.asarray(1.0 / self.symbol, dtype=float)

    def _filtered(self, y: Floats, symbol: Floats, factor: float) -> Floats:
        """The waves of y (unknowns,) or (unknowns, n) times a symbol, the translation times a factor."""
        first = int(self.translation)
        grid = np.moveaxis(y[first:].reshape(*self.cells, -1), -1, 0)
        waves = scipy.fft.irfft2(symbol * scipy.fft.rfft2(grid), s=self.cells)
        found = np.moveaxis(waves, 0, -1).reshape(y[first:].shape)
        return np.concatenate([factor * y[:first], found])
