"""A body of several materials, each in a named part of its mesh."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .base.arrays import Floats
from .base.checks import listed
from .material import Material
from .mesh import Mesh


class PiecewiseMaterial(Material):
    """Materials by the subdomains of a mesh, which have to cover it, each cell once.

    materials: {subdomain: material}.
    """

    checked = True

    def __init__(self, materials: Mapping[str, Material], mesh: Mesh) -> None:
        for name, material in materials.items():
            if not isinstance(material, Material):
                raise TypeError(f"material: {name!r} is {material!r}; expected a material, such as cd.Isotropic(E, nu)")
            if name not in mesh.subdomains:
                raise ValueError(f"material: the mesh has no subdomain {name!r} (it has {listed(mesh.subdomains)})")
        self.materials = dict(materials)
        self._part = np.full(mesh.cells, -1)
        for number, name in enumerate(self.materials):
            taken = self._part[mesh.subdomains[name]] >= 0
            if np.any(taken):
                raise ValueError(f"material: {int(taken.sum())} cells of {name!r} are in another subdomain, too")
            self._part[mesh.subdomains[name]] = number
        bare = self._part < 0
        if np.any(bare):
            middle = mesh.middles[int(np.argmax(bare)), : mesh.dim]
            raise ValueError(
                f"material: {int(bare.sum())} cells, one of them around {middle}, are in none of the subdomains "
                f"{listed(self.materials)}; expected a material for every cell"
            )

    @property
    def varies(self) -> bool:
        return True

    def within(self, cells: NDArray[np.int32]) -> _Sampled:
        return _Sampled(self, np.asarray(cells))

    def given(self) -> list[Any]:
        return [each for material in self.materials.values() for each in material.given()]

    def stiffness(self, x: Floats | None = None) -> Floats:
        raise ValueError(f"{self!r}: its values depend on the cell; expected material.within(cells)")

    def _stiffness(self, x: Floats) -> Floats:
        raise NotImplementedError

    def __repr__(self) -> str:
        return "{" + ", ".join(f"{name!r}: {material!r}" for name, material in self.materials.items()) + "}"


class _Sampled(Material):
    """Materials by subdomains, at points of which the cells are known."""

    checked = True

    def __init__(self, whole: PiecewiseMaterial, cells: NDArray[np.int32]) -> None:
        self._whole, self._cells = whole, cells

    @property
    def varies(self) -> bool:
        return True

    def _stiffness(self, x: Floats) -> Floats:
        part, found = self._whole._part[self._cells], np.empty((x.shape[1], 6, 6))
        for number, material in enumerate(self._whole.materials.values()):
            here = part == number
            if np.any(here):
                found[here] = material.within(self._cells[here]).stiffness(x[:, here])
        return found
