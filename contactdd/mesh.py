"""A mesh whose boundary surfaces have names."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from dolfinx import mesh as dmesh
from mpi4py import MPI
from numpy.typing import NDArray

from . import compat
from .errors import one_of

Marker = Callable[[NDArray[np.float64]], NDArray[np.bool_]]


@dataclass(frozen=True)
class Mesh:
    """A dolfinx mesh and the boundary facets of each named surface.

    domain: the dolfinx mesh (plane or solid, any cell type); surfaces: {name: sorted facet indices}.
    """

    domain: dmesh.Mesh
    surfaces: Mapping[str, NDArray[np.int32]]

    @property
    def dim(self) -> int:
        """The topological dimension, 2 or 3."""
        return self.domain.topology.dim

    @property
    def cells(self) -> int:
        return self.domain.topology.index_map(self.dim).size_local

    @property
    def size(self) -> float:
        """The longest side of the mesh's bounding box."""
        return float(np.ptp(self.domain.geometry.x, axis=0).max())

    def facets(self, surface: str) -> NDArray[np.int32]:
        """The facet indices of a named surface; a name that is not there is refused with the list of those that are."""
        if surface not in self.surfaces:
            known = ", ".join(repr(name) for name in sorted(self.surfaces)) or "none"
            raise ValueError(f"surface = {surface!r}: the mesh has no surface of that name (it has {known})")
        return self.surfaces[surface]

    def with_surfaces(self, **markers: Marker) -> Mesh:
        """The same mesh with more named surfaces, each given by a function x (3, points) -> bool of boundary facets."""
        return Mesh(self.domain, {**self.surfaces, **_mark(self.domain, markers)})

    def __repr__(self) -> str:
        counts = ", ".join(f"{name}: {len(facets)}" for name, facets in self.surfaces.items())
        return f"Mesh({self.cells} {self.domain.topology.cell_name()}s; facets {counts})"


def rectangle(
    lower_left: Sequence[float],
    upper_right: Sequence[float],
    cells: tuple[int, int],
    *,
    shape: str = "triangle",
    diagonal: str = "right",
) -> Mesh:
    """A structured mesh of a rectangle with the surfaces left, right, bottom and top.

    cells: how many along x and y; shape: "triangle" (each cell cut in two along `diagonal`: "left", "right" or
    "crossed") or "quadrilateral".
    """
    one_of("shape", shape, ("triangle", "quadrilateral"))
    one_of("diagonal", diagonal, ("left", "right", "crossed"))
    corners = _corners(lower_left, upper_right, cells, 2)
    domain = dmesh.create_rectangle(
        MPI.COMM_SELF, corners, list(cells), dmesh.CellType[shape], diagonal=dmesh.DiagonalType[diagonal]
    )
    return Mesh(domain, _mark(domain, _box_sides(corners, (("left", "right"), ("bottom", "top")))))


def box(
    lower: Sequence[float], upper: Sequence[float], cells: tuple[int, int, int], *, shape: str = "tetrahedron"
) -> Mesh:
    """A structured mesh of a box: left/right (x), front/back (y), bottom/top (z); "tetrahedron" or "hexahedron"."""
    one_of("shape", shape, ("tetrahedron", "hexahedron"))
    corners = _corners(lower, upper, cells, 3)
    domain = dmesh.create_box(MPI.COMM_SELF, corners, list(cells), dmesh.CellType[shape])
    return Mesh(domain, _mark(domain, _box_sides(corners, (("left", "right"), ("front", "back"), ("bottom", "top")))))


def from_dolfinx(domain: dmesh.Mesh, **markers: Marker) -> Mesh:
    """A mesh made with dolfinx, its surfaces given as functions x (3, points) -> bool of boundary facets."""
    return Mesh(domain, {}).with_surfaces(**markers)


def from_gmsh(model: Any, dim: int = 2) -> Mesh:
    """The mesh of the current gmsh model, its surfaces named by the physical groups of dimension `dim` - 1.

    The cells must be in physical groups too (gmsh exports nothing else).
    """
    domain, _, facet_tags, names = compat.gmsh_model_to_mesh(model, MPI.COMM_SELF, 0, dim)
    surfaces = {name: np.sort(facet_tags.find(tag)) for name, (group_dim, tag) in names.items() if group_dim == dim - 1}
    return Mesh(domain, surfaces)


def read_gmsh(path: str | Path, dim: int = 2, **parameters: float) -> Mesh:
    """Read a .msh file, or mesh a .geo script with its ONELAB constants set to `parameters`."""
    import gmsh

    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"path = {str(path)!r}: no such file")
    gmsh.initialize(["contactdd", "-v", "2"], interruptible=False)
    try:
        for name, value in parameters.items():
            gmsh.onelab.setNumber(f"Parameters/{name}", [value])
        gmsh.open(str(path))
        if path.suffix == ".geo":
            gmsh.model.mesh.generate(dim)
        return from_gmsh(gmsh.model, dim)
    finally:
        gmsh.finalize()


def _corners(
    lower: Sequence[float], upper: Sequence[float], cells: Sequence[int], dim: int
) -> list[NDArray[np.float64]]:
    low, high = np.asarray(lower, dtype=float), np.asarray(upper, dtype=float)
    if low.shape != (dim,) or high.shape != (dim,) or not np.all(high > low):
        raise ValueError(f"corners {lower!r}, {upper!r}: expected two points of {dim} coordinates, the second larger")
    if len(cells) != dim or any(int(count) != count or count < 1 for count in cells):
        raise ValueError(f"cells = {cells!r}: expected {dim} whole numbers >= 1")
    return [low, high]


def _box_sides(corners: list[NDArray[np.float64]], names: Sequence[tuple[str, str]]) -> dict[str, Marker]:
    tolerance = 1e-10 * float(np.max(corners[1] - corners[0]))  # coordinates of a structured mesh, to rounding

    def on_plane(axis: int, value: float) -> Marker:
        return lambda x: np.abs(x[axis] - value) <= tolerance

    return {
        name: on_plane(axis, corner[axis])
        for axis, pair in enumerate(names)
        for name, corner in zip(pair, corners, strict=True)
    }


def _mark(domain: dmesh.Mesh, markers: Mapping[str, Marker]) -> dict[str, NDArray[np.int32]]:
    dim = domain.topology.dim
    domain.topology.create_connectivity(dim - 1, dim)
    return {name: np.sort(dmesh.locate_entities_boundary(domain, dim - 1, marker)) for name, marker in markers.items()}
