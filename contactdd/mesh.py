"""A mesh whose boundary surfaces have names."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import basix
import numpy as np
from dolfinx import mesh as dmesh
from mpi4py import MPI
from numpy.typing import NDArray

from .base import compat
from .base.checks import as_count, as_floats, check_choice, finite
from .base.facets import facet_corners, facet_entities
from .base.isometry import Isometry, isometry_between, reflection, translation

Marker = Callable[[NDArray[np.float64]], NDArray[np.bool_]]


#: The cells of a structured mesh along one axis: how many equal ones, or where they end.
Cells = int | Sequence[float] | NDArray[np.float64]


@dataclass(frozen=True)
class Mesh:
    """A dolfinx mesh and the boundary facets of each named surface.

    domain: the dolfinx mesh (plane or solid, any cell type); surfaces: {name: sorted facet indices}.
    Raises ValueError for a mesh spread over several ranks, for coordinates that are not finite, for cells that are
    degenerate, inverted or fold over their neighbours, and for a surface without facets or with facets inside the body.
    """

    domain: dmesh.Mesh
    surfaces: Mapping[str, NDArray[np.int32]]

    def __post_init__(self) -> None:
        ranks = self.domain.comm.size
        if ranks > 1:
            raise ValueError(
                f"domain: the mesh is spread over {ranks} ranks; expected a mesh on one (made on MPI.COMM_SELF). "
                "Ranks share a scene's bodies: Scene(bodies, contacts, comm=MPI.COMM_WORLD)"
            )
        _check_cells(self.domain)
        for name, facets in self.surfaces.items():
            _check_surface(self.domain, name, facets)

    @property
    def dim(self) -> int:
        """The topological dimension, 2 or 3."""
        return self.domain.topology.dim

    @property
    def cells(self) -> int:
        """How many cells there are."""
        return self.domain.topology.index_map(self.dim).size_local

    @property
    def size(self) -> float:
        """The longest side of the mesh's bounding box."""
        return float(np.ptp(self.domain.geometry.x, axis=0).max())

    def facets(self, surface: str) -> NDArray[np.int32]:
        """The facet indices of a named surface; a name that is not there is refused with the list of those that are."""
        if not isinstance(surface, str) or surface not in self.surfaces:
            known = _listed(list(self.surfaces))
            raise ValueError(f"surface = {surface!r}: the mesh has no surface of that name (it has {known})")
        return self.surfaces[surface]

    def entities(self, surface: str) -> NDArray[np.int32]:
        """(cell, local facet) of each facet of a named surface, (facets, 2)."""
        self.facets(surface)  # refuses an unknown name
        return self._entities[surface]

    @cached_property
    def _entities(self) -> dict[str, NDArray[np.int32]]:
        if not self.surfaces:
            return {}
        ends = np.cumsum([len(facets) for facets in self.surfaces.values()])
        pairs = facet_entities(self.domain, np.concatenate(list(self.surfaces.values())))
        return dict(zip(self.surfaces, np.split(pairs, ends[:-1]), strict=True))

    def with_surfaces(self, **markers: Marker) -> Mesh:
        """The same mesh with more named surfaces, each given by a function x (3, points) -> bool of boundary facets."""
        return Mesh(self.domain, {**self.surfaces, **_mark(self.domain, markers)})

    def isometry_from(self, other: Mesh) -> Isometry | None:
        """The motion or mirror image that takes another mesh's nodes to this one's, one by one; None if there is none.

        Both have to have the same cells, numbered alike, and the same named surfaces.
        """
        if not (self.surfaces is other.surfaces or _same_surfaces(self.surfaces, other.surfaces)):
            return None
        ours, theirs = (compat.geometry_dofmap(mesh.domain) for mesh in (self, other))
        if ours.shape != theirs.shape or self.domain.topology.cell_name() != other.domain.topology.cell_name():
            return None
        isometry = isometry_between(other.domain.geometry.x[:, : self.dim], self.domain.geometry.x[:, : self.dim])
        return isometry if isometry is not None and np.array_equal(ours, theirs) else None

    def moved(self, offset: Sequence[float]) -> Mesh:
        """A copy of the mesh, moved by `offset` (dim,). It has the same cells, facets and named surfaces."""
        by = as_floats("offset", offset, f"{self.dim} finite numbers")
        if by.shape != (self.dim,) or not np.all(np.isfinite(by)):
            raise ValueError(f"offset = {offset!r}: expected {self.dim} finite numbers")
        return self._copy(translation(by), f"offset = {offset!r}")

    def mirrored(self, axis: str, at: float) -> Mesh:
        """The mirror image of the mesh in the plane `axis` = `at`, where `axis` is "x", "y" or, of a solid, "z".

        It has the same cells, facets and named surfaces: what was on the left and is now on the right is still "left".
        """
        axes = ("x", "y", "z")[: self.dim]
        place = axes.index(check_choice("axis", axis, axes))
        return self._copy(reflection(self.dim, place, finite("at", at)), f"at = {at!r}")

    def _copy(self, isometry: Isometry, asked: str) -> Mesh:
        """The image of the mesh, which shares its topology."""
        x = self.domain.geometry.x[:, : self.dim]
        image = isometry(x)
        # Its cells are as good as those of this mesh, unless rounding has moved their corners.
        if not np.abs(isometry.signs * (image - isometry.offset) - x).max() <= 1e-10 * self.size:
            raise ValueError(f"{asked}: so far away a mesh of the size {self.size:g} loses the digits of its shape")
        return Mesh._sound(compat.with_coordinates(self.domain, image), self.surfaces, self._entities)

    @classmethod
    def _sound(
        cls, domain: dmesh.Mesh, surfaces: Mapping[str, NDArray[np.int32]], entities: dict[str, NDArray[np.int32]]
    ) -> Mesh:
        """A mesh in which nothing has to be looked for that could be refused."""
        mesh = object.__new__(cls)
        vars(mesh).update(domain=domain, surfaces=surfaces, _entities=entities)
        return mesh

    def __repr__(self) -> str:
        counts = ", ".join(f"{name}: {len(facets)}" for name, facets in self.surfaces.items())
        return f"Mesh({self.cells} {self.domain.topology.cell_name()}s; facets {counts})"


def _same_surfaces(some: Mapping[str, NDArray[np.int32]], others: Mapping[str, NDArray[np.int32]]) -> bool:
    """Whether meshes numbered alike have the same named surfaces."""
    return some.keys() == others.keys() and all(np.array_equal(some[name], others[name]) for name in some)


def rectangle(
    lower_left: Sequence[float],
    upper_right: Sequence[float],
    cells: tuple[Cells, Cells],
    *,
    shape: str = "triangle",
    diagonal: str = "right",
) -> Mesh:
    """A structured mesh of a rectangle with the surfaces left, right, bottom and top.

    cells: along x and y, each a number of equal cells or, for a graded mesh, the coordinates of their ends; shape:
    "triangle" (each cell cut in two along `diagonal`: "left", "right" or "crossed") or "quadrilateral".
    """
    check_choice("shape", shape, ("triangle", "quadrilateral"))
    check_choice("diagonal", diagonal, ("left", "right", "crossed"))
    corners, lines = _grid(lower_left, upper_right, cells, 2)
    counts = [len(line) - 1 for line in lines]
    domain = compat.structured(corners, counts, dmesh.CellType[shape], dmesh.DiagonalType[diagonal])
    return _structured(domain, corners, lines, (("left", "right"), ("bottom", "top")))


def box(
    lower: Sequence[float], upper: Sequence[float], cells: tuple[Cells, Cells, Cells], *, shape: str = "tetrahedron"
) -> Mesh:
    """A structured mesh of a box: left/right (x), front/back (y), bottom/top (z); "tetrahedron" or "hexahedron".

    cells: along x, y and z, as for a `rectangle`.
    """
    check_choice("shape", shape, ("tetrahedron", "hexahedron"))
    corners, lines = _grid(lower, upper, cells, 3)
    counts = [len(line) - 1 for line in lines]
    domain = compat.structured(corners, counts, dmesh.CellType[shape], dmesh.DiagonalType.right)
    return _structured(domain, corners, lines, (("left", "right"), ("front", "back"), ("bottom", "top")))


def from_dolfinx(domain: dmesh.Mesh, **markers: Marker) -> Mesh:
    """A mesh made with dolfinx, its surfaces given as functions x (3, points) -> bool of boundary facets."""
    if not isinstance(domain, dmesh.Mesh):
        raise TypeError(f"domain = {domain!r}: expected a dolfinx mesh")
    return Mesh(domain, _mark(domain, markers))


def from_gmsh(model: Any, dim: int = 2, *, body: str | None = None) -> Mesh:
    """The mesh of the current gmsh model, its surfaces named by the physical groups of dimension `dim` - 1.

    body: the physical group of dimension `dim` to take where the model has several (by default all cells in groups).
    Raises ValueError where a group that is needed is missing.
    """
    groups = {model.getPhysicalName(d, tag): (d, tag) for d, tag in model.getPhysicalGroups()}
    bodies = [name for name, (d, _) in groups.items() if d == dim]
    if not bodies:
        raise ValueError(f"the gmsh model has no physical group of dimension {dim}: no cells would be exported")
    if body is not None and body not in bodies:
        raise ValueError(f"body = {body!r}: expected a physical group of dimension {dim}, one of {_listed(bodies)}")
    if not any(d == dim - 1 for d, _ in groups.values()):
        raise ValueError(f"the gmsh model has no physical group of dimension {dim - 1}: no surface would have a name")
    if body is not None:
        _keep_only(model, dim, groups[body])
    domain, _, facet_tags, names = compat.gmsh_model_to_mesh(model, MPI.COMM_SELF, 0, dim)
    surfaces = {name: np.sort(facet_tags.find(tag)) for name, (group_dim, tag) in names.items() if group_dim == dim - 1}
    return Mesh(domain, {name: facets for name, facets in surfaces.items() if len(facets)})


def read_gmsh(path: str | Path, dim: int = 2, *, body: str | None = None, order: int = 1, **parameters: float) -> Mesh:
    """The mesh in a .msh file, or of a .geo script with its ONELAB numbers "Parameters/…" set to `parameters`.

    body: see `from_gmsh`; order: of the geometry, 2 for curved cells. What a script makes is kept in the user's cache
    (`mesh_cache`) and made anew when the script, the parameters or the order change.
    """
    import gmsh

    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"path = {str(path)!r}: no such file")
    if path.suffix != ".geo" and (parameters or order != 1):
        raise ValueError(f"path = {str(path)!r}: parameters and order are for .geo scripts; a .msh file has its own")
    gmsh.initialize(["contactdd", "-v", "2"], interruptible=False)
    try:
        gmsh.open(str(_meshed(gmsh, path, dim, order, parameters) if path.suffix == ".geo" else path))
        return from_gmsh(gmsh.model, dim, body=body)
    finally:
        gmsh.finalize()


def mesh_cache() -> Path:
    """The folder of the meshes made from scripts: contactdd/meshes in $XDG_CACHE_HOME or ~/.cache."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "contactdd" / "meshes"


def _meshed(gmsh: Any, script: Path, dim: int, order: int, parameters: Mapping[str, float]) -> Path:
    """The .msh file of a script, from the cache or made now."""
    text = script.read_text()
    if not text.endswith("\n"):
        raise ValueError(
            f"path = {str(script)!r}: expected a line break at the end, without which gmsh cuts the last line"
        )
    values = {name: finite(name, value) for name, value in sorted(parameters.items())}
    recipe = json.dumps([text, values, dim, order, gmsh.__version__])
    target = mesh_cache() / f"{script.stem}-{hashlib.sha256(recipe.encode()).hexdigest()[:16]}.msh"
    if not target.is_file():
        gmsh.open(str(script))
        known = [name.removeprefix("Parameters/") for name in gmsh.onelab.getNames("Parameters/.*")]
        for name, value in values.items():
            if name not in known:
                raise ValueError(f"{name} = {value!r}: {script.name} has no such parameter (it has {_listed(known)})")
            gmsh.onelab.setNumber(f"Parameters/{name}", [value])
        gmsh.clear()
        gmsh.open(str(script))
        gmsh.model.mesh.generate(dim)
        gmsh.model.mesh.setOrder(order)
        target.parent.mkdir(parents=True, exist_ok=True)
        # Written aside and moved, so that a run that is interrupted or runs beside another leaves no half file.
        unfinished = target.with_name(f"{os.getpid()}-{target.name}")
        gmsh.write(str(unfinished))
        unfinished.replace(target)
        gmsh.clear()
    return target


def _keep_only(model: Any, dim: int, group: tuple[int, int]) -> None:
    """Take all out of a gmsh model but the cells of one physical group and what is around them."""
    kept = {int(entity) for entity in model.getEntitiesForPhysicalGroup(*group)}
    model.removeEntities([(d, tag) for d, tag in model.getEntities(dim) if tag not in kept], recursive=True)
    model.mesh.renumberNodes()
    model.mesh.renumberElements()


def _listed(names: Sequence[str]) -> str:
    return ", ".join(repr(name) for name in sorted(names)) or "none"


def _grid(
    lower: Sequence[float], upper: Sequence[float], cells: Sequence[Cells], dim: int
) -> tuple[list[NDArray[np.float64]], list[NDArray[np.float64]]]:
    """The two corners of a structured mesh, and along each axis the coordinates at which its cells end."""
    low, high = (as_floats("corner", corner, f"a point of {dim} finite coordinates") for corner in (lower, upper))
    if low.shape != (dim,) or high.shape != (dim,) or not np.all((-np.inf < low) & (low < high) & (high < np.inf)):
        raise ValueError(
            f"corners {lower!r}, {upper!r}: expected two points of {dim} finite coordinates, the second larger"
        )
    if not isinstance(cells, list | tuple | np.ndarray) or len(cells) != dim:
        raise ValueError(f"cells = {cells!r}: expected {dim} entries")
    return [low, high], [_line(*ends, count) for *ends, count in zip(low, high, cells, strict=True)]


def _line(start: float, end: float, cells: Cells) -> NDArray[np.float64]:
    """Where the cells along one axis end."""
    if np.ndim(cells) == 0:
        count = as_count("cells", cells, "a whole number >= 1, or the coordinates of the cells' ends")
        return np.linspace(start, end, count + 1)
    line = as_floats("cells", cells, f"increasing coordinates from {start} to {end}")
    tolerance = 1e-10 * (end - start)
    if (
        line.ndim != 1
        or len(line) < 2
        or not np.all(line[1:] > line[:-1])
        or not max(abs(line[0] - start), abs(line[-1] - end)) <= tolerance
    ):
        raise ValueError(f"cells = {cells!r}: expected increasing coordinates from {start} to {end}")
    return line


def _structured(
    domain: dmesh.Mesh,
    corners: list[NDArray[np.float64]],
    lines: list[NDArray[np.float64]],
    names: Sequence[tuple[str, str]],
) -> Mesh:
    """The mesh of equal cells with its nodes moved to the given coordinates and its sides named."""
    _move(domain, lines)
    surfaces, entities = _sides(domain, corners, names)
    steps = np.concatenate([line[1:] - line[:-1] for line in lines])
    shortest = steps.min()
    # Boxes that are not flat, and not so small that they are lost in the rounding of coordinates, are good cells.
    sound = shortest > 1e-4 * steps.max() and shortest > 1e-8 * np.abs(corners).max()
    return Mesh._sound(domain, surfaces, entities) if sound else Mesh(domain, surfaces)


def _move(domain: dmesh.Mesh, lines: list[NDArray[np.float64]]) -> None:
    """Move the nodes of a structured mesh of equal cells to the given coordinates."""
    x = domain.geometry.x
    for axis, line in enumerate(lines):
        cells = len(line) - 1
        # Which line a node is on, halves for the middles of crossed cells
        place = np.rint((x[:, axis] - line[0]) * (2 * cells / (line[-1] - line[0]))) / 2
        x[:, axis] = np.interp(place, np.arange(cells + 1), line)


def _sides(
    domain: dmesh.Mesh, corners: list[NDArray[np.float64]], names: Sequence[tuple[str, str]]
) -> tuple[dict[str, NDArray[np.int32]], dict[str, NDArray[np.int32]]]:
    """The facets on the sides of a box and their (cell, local facet); `names`: its lower and upper side by axis."""
    dim = domain.topology.dim
    domain.topology.create_connectivity(dim - 1, dim)
    facets = dmesh.exterior_facet_indices(domain.topology)  # sorted
    entities = facet_entities(domain, facets)
    x = facet_corners(domain, entities)
    tolerance = 1e-10 * max(corners[1] - corners[0])  # coordinates of a structured mesh, to rounding
    on_side = np.abs(x - np.array(corners)[:, None, None]).max(axis=2) <= tolerance
    where = {name: on_side[end, :, axis] for axis, pair in enumerate(names) for end, name in enumerate(pair)}
    return {name: facets[here] for name, here in where.items()}, {name: entities[here] for name, here in where.items()}


def _mark(domain: dmesh.Mesh, markers: Mapping[str, Marker]) -> dict[str, NDArray[np.int32]]:
    dim = domain.topology.dim
    domain.topology.create_connectivity(dim - 1, dim)
    checked = {name: _checked(name, marker) for name, marker in markers.items()}
    return {name: np.sort(dmesh.locate_entities_boundary(domain, dim - 1, marker)) for name, marker in checked.items()}


def _checked(name: str, marker: Marker) -> Marker:
    """A marker whose answer is looked at before dolfinx gets it, which would say little of what is wrong."""
    if not callable(marker):
        raise TypeError(f"{name} = {marker!r}: expected a function x (3, points) -> bool")

    def checked(x: NDArray[np.float64]) -> NDArray[np.bool_]:
        where = np.asarray(marker(x))
        if where.shape != x.shape[1:] or where.dtype.kind not in "biu":
            found = f"{where.dtype} of shape {where.shape}"
            raise ValueError(f"{name}: the function returned {found}; expected bool of shape {x.shape[1:]}")
        return where.astype(bool)

    return checked


def _check_cells(domain: dmesh.Mesh) -> None:
    """Refuse coordinates that are not numbers, and cells that no displacement could be computed in."""
    dim, x = domain.topology.dim, domain.geometry.x
    if not np.all(np.isfinite(x)):
        bad = int(np.argmin(np.isfinite(x).all(axis=1)))
        raise ValueError(f"mesh: node {bad} has coordinates {x[bad]}; expected finite numbers")
    if domain.geometry.dim != dim:
        raise ValueError(
            f"mesh: {dim}-dimensional cells in {domain.geometry.dim} dimensions; expected the same of both"
        )
    volumes = _volumes(domain)
    size = np.ptp(x[compat.geometry_dofmap(domain)], axis=1).max(axis=1)
    ratio = np.abs(volumes).min(axis=0) / size**dim
    # A cell this flat has lost all digits of its stiffness.
    _refuse_cells(domain, ratio < 1e-12, "degenerate (of no volume)")
    _refuse_cells(domain, np.ptp(np.sign(volumes), axis=0) > 0, "inverted (their map turns inside out)")
    _refuse_cells(domain, _folded(domain), "folded over a neighbour (inverted)")


def _folded(domain: dmesh.Mesh) -> NDArray[np.bool_]:
    """Which cells (cells,) lie on the same side of a facet as their neighbour there; of each two the first."""
    dim, x = domain.topology.dim, domain.geometry.x
    middles = x[compat.geometry_dofmap(domain)].mean(axis=1)[:, :dim]
    where = np.zeros(len(middles), dtype=bool)
    domain.topology.create_connectivity(dim - 1, dim)
    cells = domain.topology.connectivity(dim - 1, dim)
    inner = np.flatnonzero(np.diff(cells.offsets) == 2).astype(np.int32)
    if len(inner) == 0:  # dolfinx divides by their number
        return where
    corners = x[dmesh.entities_to_geometry(domain, dim - 1, inner, False).reshape(len(inner), -1)][:, :, :dim]
    edges = [corners[:, i] - corners[:, 0] for i in range(1, dim)]
    offsets = [middles[cells.array[cells.offsets[inner] + k]] - corners[:, 0] for k in (0, 1)]
    sides = [_determinants(np.moveaxis(np.stack([*edges, offset]), 2, 1)) for offset in offsets]
    folded = inner[sides[0] * sides[1] >= 0.0]
    where[cells.array[cells.offsets[folded]]] = True
    return where


def _volumes(domain: dmesh.Mesh) -> NDArray[np.float64]:
    """The determinants of the cells' maps at their corners and middle, (points, cells)."""
    element = compat.coordinate_map(domain)
    corners = np.asarray(basix.geometry(element.cell_type))
    affine = element.degree == 1 and len(corners) == domain.topology.dim + 1
    points = corners[:1] if affine else np.vstack([corners, corners.mean(axis=0)])
    table = element.tabulate(1, points)[1:, :, :, 0]
    nodes = domain.geometry.x[compat.geometry_dofmap(domain)][:, :, : domain.topology.dim]
    return _determinants(
        np.stack([np.stack([rows @ nodes[:, :, i].T for i in range(nodes.shape[2])]) for rows in table])
    )


def _determinants(m: NDArray[np.float64]) -> NDArray[np.float64]:
    """The determinants of matrices (dim, dim, ...)."""
    if len(m) == 2:
        return m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0]
    return np.sum(m[0] * np.cross(m[1], m[2], axis=0), axis=0)


def _refuse_cells(domain: dmesh.Mesh, bad: NDArray[np.bool_], what: str) -> None:
    if np.any(bad):
        middle = domain.geometry.x[compat.geometry_dofmap(domain)[int(np.argmax(bad))]].mean(axis=0)
        raise ValueError(f"mesh: {int(bad.sum())} cells are {what}, one of them around {middle[: domain.topology.dim]}")


def _check_surface(domain: dmesh.Mesh, name: str, facets: NDArray[np.int32]) -> None:
    if len(facets) == 0:
        raise ValueError(f"surface {name!r} has no facets: no facet of the boundary is where it should be")
    dim = domain.topology.dim
    domain.topology.create_connectivity(dim - 1, dim)
    inside = int(np.sum(np.diff(domain.topology.connectivity(dim - 1, dim).offsets)[facets] != 1))
    if inside:
        raise ValueError(f"surface {name!r}: {inside} of its {len(facets)} facets are inside the body")
