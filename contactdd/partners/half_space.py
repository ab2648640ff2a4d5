"""Elastic half-spaces: of a body of revolution, and in space."""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.checks import as_floats
from ..material import Isotropic
from ..parameter import Parameter
from . import influence
from .elastic_surface import ElasticSurface, as_nodes, galerkin, hats


class AxisymmetricHalfSpace(ElasticSurface):
    """An elastic half-space under pressures that are the same all round an axis, linear between radii.

    By Boussinesq's load, integrated over discs. Far away it is held, moved or loaded.

    Args:
        name: Unique in a scene.
        material: `Isotropic`, of two numbers.
        nodes: (N,) increasing radii from 0, as far as there may be contact (length).
        height: The axial coordinate of its surface (length).
        up: Whether its outward normal is (0, 1), else (0, −1).
        displacement: Of what holds it, along the normal (length): a number, a `Parameter`, or None where it is free.
        force: On it along the normal (force): a number or a `Parameter`.

    Raises:
        TypeError, ValueError: An argument is none of these.

    Example:
        >>> AxisymmetricHalfSpace("ground", Isotropic(2.1e5, 0.3), np.linspace(0, 1, 41)).size
        42
    """

    def __init__(
        self,
        name: str,
        material: Isotropic,
        nodes: ArrayLike,
        *,
        height: float = 0.0,
        up: bool = True,
        displacement: float | Parameter | None = 0.0,
        force: float | Parameter = 0.0,
    ) -> None:
        self.nodes = as_nodes("nodes", nodes)
        if self.nodes[0] != 0.0:
            raise ValueError(f"nodes[0] = {self.nodes[0]:g}: expected radii from 0")
        self.length = float(self.nodes[-1])
        normal = (0.0, 1.0 if up else -1.0)
        super().__init__(name, material, "axisymmetric", (0.0, height), normal, displacement, force)

    @property
    def places(self) -> Floats:
        return np.column_stack([self.nodes, np.full(len(self.nodes), self.origin[1])])

    @property
    def areas(self) -> Floats:
        return influence.hat_ring_areas(self.nodes)

    @property
    def spacing(self) -> float:
        return float(np.diff(self.nodes).min())

    def flexibility(self) -> Floats:
        def answer(at: Floats) -> Floats:
            return np.asarray(influence.ring_hats(at, self.nodes) / self.modulus, dtype=float)

        return galerkin(answer, self.nodes, self.areas, weight=lambda r: 2 * np.pi * r)

    def interpolation(self, x: Floats) -> scipy.sparse.csr_matrix:
        return hats(self.name, x[:, 0], self.nodes)


class HalfSpace(ElasticSurface):
    """An elastic half-space under pressures that are even on each rectangle of a grid.

    By Love's formula for a rectangle of Boussinesq's loads. Far away it is held, moved or loaded. Its matrix is dense:
    3000 rectangles are many; `PeriodicHalfSpace` stores none. Rectangles should be no smaller than the points of a mesh
    that touches them are apart, whose forces would else be needles.

    Args:
        name: Unique in a scene.
        material: `Isotropic`, of two numbers.
        size: (2,) the extents of the grid (length).
        cells: (2,) how many rectangles there are along each.
        origin: (3,) the middle of the grid (length).
        normal: (3,) out of the body.
        along: (3,) the direction of the grid's first extent, by default the x axis.
        displacement: Of what holds it, along the normal (length): a number, a `Parameter`, or None where it is free.
        force: On it along the normal (force): a number or a `Parameter`.

    Raises:
        TypeError, ValueError: An argument is none of these.

    Example:
        >>> HalfSpace("ground", Isotropic(2.1e5, 0.3), (1, 1), (20, 20)).size
        401
    """

    #: The most rectangles: three matrices of 8000² take 1.5 GB, a factorisation half a minute.
    most = 8000

    def __init__(
        self,
        name: str,
        material: Isotropic,
        size: ArrayLike,
        cells: tuple[int, int],
        *,
        origin: ArrayLike = (0.0, 0.0, 0.0),
        normal: ArrayLike = (0.0, 0.0, 1.0),
        along: ArrayLike = (1.0, 0.0, 0.0),
        displacement: float | Parameter | None = 0.0,
        force: float | Parameter = 0.0,
    ) -> None:
        self.extent = as_floats("size", size, "two numbers > 0")
        if self.extent.shape != (2,) or not np.all(np.isfinite(self.extent)) or not np.all(self.extent > 0):
            raise ValueError(f"size = {size!r}: expected two numbers > 0")
        self.cells = _counts(cells)
        if self.cells[0] * self.cells[1] > self.most:
            count = self.cells[0] * self.cells[1]
            raise ValueError(f"cells = {cells!r}: {count} rectangles; expected {self.most} at most")
        self.length = float(self.extent.max())
        self.steps = self.extent / self.cells
        super().__init__(name, material, "solid", origin, normal, displacement, force)
        self._axes = _axes(self.normal, along)

    @property
    def places(self) -> Floats:
        return self.origin + np.stack(np.meshgrid(*self._middles, indexing="ij"), axis=-1).reshape(-1, 2) @ self._axes

    @property
    def areas(self) -> Floats:
        return np.full(self.cells[0] * self.cells[1], float(np.prod(self.steps)))

    def contact_facets(self) -> Floats:
        around = 0.5 * self.steps * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) @ self._axes
        return self.places[:, None] + around

    @property
    def spacing(self) -> float:
        return float(self.steps.min())

    def flexibility(self) -> Floats:
        # Only the distance of two rectangles counts: those of the first one to all others say it all.
        away = [step * np.arange(count) for step, count in zip(self.steps, self.cells, strict=True)]
        table = influence.rectangle(away[0][:, None], away[1], *self.steps) / (self.modulus * np.prod(self.steps))
        i, j = (index.ravel() for index in np.indices(self.cells))
        return np.asarray(table[np.abs(i[:, None] - i), np.abs(j[:, None] - j)])

    def interpolation(self, x: Floats) -> scipy.sparse.csr_matrix:
        # Bilinear between the middles of rectangles, and as in the outermost ones beyond.
        own = (x - self.origin) @ self._axes.T
        beyond = np.abs(own) > 0.5 * self.extent * (1 + 1e-10)
        if np.any(beyond):
            raise ValueError(
                f"body {self.name!r}: a contact reaches to {np.abs(own).max(axis=0)} from the middle of its grid, the "
                f"grid to {0.5 * self.extent}; expected a grid wherever there may be contact"
            )
        a, b = (
            hats(self.name, np.clip(values, middles[0], middles[-1]), middles)
            for values, middles in zip(own.T, self._middles, strict=True)
        )
        # The products of each row's entries: both have two.
        rows = np.repeat(np.arange(len(x)), 4)
        columns = (a.indices.reshape(-1, 2, 1) * self.cells[1] + b.indices.reshape(-1, 1, 2)).ravel()
        values = (a.data.reshape(-1, 2, 1) * b.data.reshape(-1, 1, 2)).ravel()
        return scipy.sparse.csr_matrix((values, (rows, columns)), shape=(len(x), len(self.areas)))

    @property
    def _middles(self) -> tuple[Floats, Floats]:
        """The coordinates of the rectangles' middles along each extent."""
        a, b = (
            step * (np.arange(count) - 0.5 * (count - 1)) for step, count in zip(self.steps, self.cells, strict=True)
        )
        return a, b


def _counts(cells: tuple[int, int]) -> tuple[int, int]:
    array = as_floats("cells", cells, "two whole numbers >= 2")
    if array.shape != (2,) or not np.all(np.isfinite(array)) or np.any(array < 2) or np.any(array != np.round(array)):
        raise ValueError(f"cells = {cells!r}: expected two whole numbers >= 2")
    return int(array[0]), int(array[1])


def _axes(normal: Floats, along: ArrayLike) -> Floats:
    """The directions of both extents of a grid, (2, 3)."""
    given = as_floats("along", along, "three numbers, across the normal")
    if given.shape != (3,) or not np.all(np.isfinite(given)) or np.linalg.norm(np.cross(normal, given)) == 0.0:
        raise ValueError(f"along = {along!r}: expected three numbers, not along the normal")
    first = given - (given @ normal) * normal
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(normal, first)])
