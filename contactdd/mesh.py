"""A mesh whose boundary surfaces have names."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import basix
import numpy as np
from dolfinx import mesh as dmesh
from numpy.typing import NDArray

from .base import compat
from .base.arrays import Floats, Integers
from .base.checks import as_count, as_floats, check_choice, finite, listed
from .base.conformity import hanging_nodes, pieces, ring_edges
from .base.facets import facet_corners, facet_entities, facet_nodes
from .base.isometry import Isometry, isometry_between, reflection, rounded, translation
from .base.refinement import Split, split

Marker = Callable[[NDArray[np.float64]], NDArray[np.bool_]]


#: The cells of a structured mesh along one axis: the number of equal ones, or the coordinates of their ends.
Cells = int | Sequence[float] | NDArray[np.float64]


@dataclass(frozen=True)
class Mesh:
    """A dolfinx mesh and the boundary facets of each named surface.

    Args:
        domain: The dolfinx mesh (plane or solid, any cell type), on one rank; coordinates are lengths.
        surfaces: {name: sorted indices of boundary facets, (facets,)}.
        left_out: {name: why} of groups that a file has but that are no surfaces, for whoever asks for one.
        subdomains: {name: sorted indices of cells, (cells,)}: the parts of the body that may have their own materials.

    Raises:
        TypeError: `domain` is no dolfinx mesh, or facet indices are no whole numbers.
        ValueError: The mesh is spread over several ranks; coordinates are not finite; cells are degenerate, inverted or
            folded over their neighbours; there are hanging nodes; a surface has no facets, or facets that are not there
            or inside the body; a subdomain has cells that are not there.

    Example:
        >>> import contactdd as cd
        >>> mesh = cd.rectangle((0, 0), (2, 1), (4, 2))
        >>> mesh
        Mesh(16 triangles; facets left: 2, right: 2, bottom: 4, top: 4)
        >>> mesh.moved((0, 1)).with_surfaces(corner=lambda x: (x[0] > 1.4) & (x[1] > 1.9)).facets("corner").shape
        (1,)
    """

    domain: dmesh.Mesh
    surfaces: Mapping[str, NDArray[np.int32]]
    left_out: Mapping[str, str] = field(default_factory=dict)
    subdomains: Mapping[str, NDArray[np.int32]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not isinstance(self.domain, dmesh.Mesh):
            raise TypeError(f"domain = {self.domain!r}: expected a dolfinx mesh")
        ranks = self.domain.comm.size
        if ranks > 1:
            raise ValueError(
                f"domain: the mesh is spread over {ranks} ranks; expected a mesh on one (made on MPI.COMM_SELF). "
                "Ranks share a scene's bodies: Scene(bodies, contacts, comm=MPI.COMM_WORLD)"
            )
        _check_cells(self.domain)
        for name, facets in self.surfaces.items():
            _check_surface(self.domain, name, facets)
        for name, cells in self.subdomains.items():
            _check_subdomain(self.cells, name, cells)

    @property
    def dim(self) -> int:
        """The topological dimension, 2 or 3."""
        return self.domain.topology.dim

    @property
    def cells(self) -> int:
        """The number of cells."""
        return self.domain.topology.index_map(self.dim).size_local

    @property
    def size(self) -> float:
        """The longest side of the mesh's bounding box."""
        return float(self.extent.max())

    @cached_property
    def extent(self) -> NDArray[np.float64]:
        """The sides of the mesh's bounding box, (dim,) (length)."""
        return np.ptp(self.domain.geometry.x[:, : self.dim], axis=0)

    def facets(self, surface: str) -> NDArray[np.int32]:
        """The facet indices of a named surface, sorted, (facets,).

        Args:
            surface: The name of the surface.

        Raises:
            ValueError: There is no surface of that name (the message lists those there are), or the group of that name
                is no surface (the message says why).
        """
        if isinstance(surface, str) and surface in self.left_out:
            raise ValueError(f"surface = {surface!r}: {self.left_out[surface]}; expected a part of the boundary")
        if not isinstance(surface, str) or surface not in self.surfaces:
            known = listed(self.surfaces)
            raise ValueError(f"surface = {surface!r}: the mesh has no surface of that name (it has {known})")
        return self.surfaces[surface]

    def entities(self, surface: str) -> NDArray[np.int32]:
        """The (cell, local facet) of each facet of a named surface, (facets, 2).

        Args:
            surface: The name of the surface; refused as by `facets`.
        """
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
        """The same mesh with more named surfaces.

        Args:
            markers: Name = function of coordinates x (3, points) (length) to bool (points,); the surface consists of
                the boundary facets whose vertices are all marked.

        Raises:
            TypeError: A marker is no function.
            ValueError: A marker returns something else, or marks no facet.
        """
        left_out = {name: why for name, why in self.left_out.items() if name not in markers}
        marked = _mark(self.domain, markers)
        for name, facets in marked.items():
            _check_surface(self.domain, name, facets)
        mesh = Mesh._sound(self.domain, {**self.surfaces, **marked}, None, left_out, self.subdomains)
        vars(mesh).update(self._pieces_known())
        return mesh

    def with_subdomains(self, **markers: Marker) -> Mesh:
        """The same mesh with more named parts, for materials of their own: `Body(..., material={"steel": ..., ...})`.

        Args:
            markers: Name = function of the coordinates x (3, cells) of the cells' middles (length) to bool (cells,).

        Raises:
            TypeError: A marker is no function.
            ValueError: A marker returns something else, or marks no cell.

        Example:
            >>> import contactdd as cd
            >>> mesh = cd.rectangle((0, 0), (2, 1), (4, 2)).with_subdomains(core=lambda x: x[0] > 1)
            >>> len(mesh.subdomains["core"])
            8
        """
        x = self.middles.T
        found = {name: np.flatnonzero(_checked(name, marker)(x)).astype(np.int32) for name, marker in markers.items()}
        mesh = Mesh(self.domain, self.surfaces, self.left_out, {**self.subdomains, **found})
        vars(mesh).update(self._pieces_known())
        return mesh

    @property
    def middles(self) -> Floats:
        """The means of the cells' nodes, (cells, 3)."""
        return np.asarray(self.domain.geometry.x[compat.geometry_dofmap(self.domain)].mean(axis=1))

    @cached_property
    def piece_of_cell(self) -> Integers:
        """The number of the piece that each cell belongs to, (cells,); different pieces share no node."""
        corners = np.asarray(basix.geometry(compat.coordinate_map(self.domain).cell_type)).shape[0]
        return pieces(compat.geometry_dofmap(self.domain)[:, :corners])

    def _pieces_known(self) -> dict[str, Any]:
        """The cached properties that a mesh of the same cells can take over."""
        return {name: value for name, value in vars(self).items() if name == "piece_of_cell"}

    def refined(self, cells: Sequence[int] | NDArray[Any] | None = None) -> Mesh:
        """The mesh with smaller cells where they are wanted, and the same named surfaces.

        All edges of the cells are cut in two, and as many of their neighbours as it takes for cells to meet corner to
        corner. Curved cells are cut along their curves: the body keeps its shape.

        Args:
            cells: The indices of the cells, or whether each is one, (cells,); by default all.

        Raises:
            ValueError: The cells are no triangles or tetrahedra, or there are no such cells.

        Example:
            >>> import contactdd as cd
            >>> mesh = cd.rectangle((0, 0), (1, 1), (2, 2))
            >>> mesh.refined()
            Mesh(32 triangles; facets left: 4, right: 4, bottom: 4, top: 4)
            >>> mesh.cells < mesh.refined([0]).cells < 32
            True
        """
        self.refuse_other_than_simplices()
        made = split(self.domain, None if cells is None else self._chosen(cells))
        entities = {name: _descendants(made, pairs) for name, pairs in self._entities.items()}
        made.domain.topology.create_connectivity(self.dim, self.dim - 1)
        made.domain.topology.create_connectivity(self.dim - 1, self.dim)
        of_cell = made.domain.topology.connectivity(self.dim, self.dim - 1).array.reshape(len(made.parents), -1)
        facets = {name: of_cell[pairs[:, 0], pairs[:, 1]] for name, pairs in entities.items()}
        order = {name: np.argsort(each) for name, each in facets.items()}
        surfaces = {name: each[order[name]].astype(np.int32) for name, each in facets.items()}
        sorted_pairs = {name: pairs[order[name]] for name, pairs in entities.items()}
        parts = {n: np.flatnonzero(np.isin(made.parents, c)).astype(np.int32) for n, c in self.subdomains.items()}
        finer = Mesh._sound(made.domain, surfaces, sorted_pairs, self.left_out, parts)
        vars(finer).update(_split=(self, made))
        return finer

    def refuse_other_than_simplices(self) -> None:
        """Refuse a mesh that cannot be refined in places.

        Raises:
            ValueError: Its cells are no triangles or tetrahedra.
        """
        shape = self.domain.topology.cell_name()
        if shape not in ("triangle", "tetrahedron"):
            raise ValueError(
                f"the mesh is one of {shape}s, which cannot be refined in places; expected triangles or tetrahedra, or "
                "a new mesh with more cells"
            )

    @property
    def refined_from(self) -> tuple[Mesh, Split] | None:
        """The mesh that this one refines, and how its cells lie in those of that; None if it was made otherwise."""
        return vars(self).get("_split")

    def _chosen(self, cells: Sequence[int] | NDArray[Any]) -> Integers:
        """The indices of cells, sorted, that are given by indices or by truth values."""
        given = np.asarray(cells)
        wanted = f"indices from 0 to {self.cells - 1}, or truth values of {self.cells} cells"
        if given.ndim != 1 or given.dtype.kind not in "biu" or (given.dtype.kind == "b" and len(given) != self.cells):
            raise ValueError(f"cells = {cells!r}: expected {wanted}")
        chosen = np.flatnonzero(given) if given.dtype.kind == "b" else np.unique(given)
        if len(chosen) == 0 or chosen[0] < 0 or chosen[-1] >= self.cells:
            raise ValueError(f"cells = {cells!r}: expected {wanted}")
        return chosen.astype(np.int32)

    def pieces(self) -> list[Mesh]:
        """The pieces that share no node, each a mesh with those of the named surfaces that it has a part of.

        A mesh in one piece gives itself. The pieces are in the order of their first cells in the dolfinx mesh.
        """
        return _pieces(self) if self.piece_of_cell.max() > 0 else [self]

    def isometry_from(self, other: Mesh) -> Isometry | None:
        """The motion or mirror image that takes another mesh's nodes to this one's, one by one; None if there is none.

        Both have to have the same cells, numbered alike, and the same named surfaces.

        Args:
            other: The mesh of which this one may be an image.
        """
        return self.nodes_isometry_from(other) if self.same_surfaces(other) else None

    def same_surfaces(self, other: Mesh) -> bool:
        """Whether another mesh, of cells numbered alike, has the same named surfaces.

        Args:
            other: The mesh.
        """
        return self.surfaces is other.surfaces or _same_surfaces(self.surfaces, other.surfaces)

    def nodes_isometry_from(self, other: Mesh) -> Isometry | None:
        """The same as `isometry_from`, whatever surfaces are named.

        Args:
            other: The mesh of which this one may be an image.
        """
        if not self._same_cells(other):
            return None
        return isometry_between(other.domain.geometry.x[:, : self.dim], self.domain.geometry.x[:, : self.dim])

    @cached_property
    def fingerprint(self) -> int:
        """A number that all copies of the mesh share, moved or mirrored, and other meshes hardly."""
        x = self.domain.geometry.x[:, : self.dim]
        return hash((self.cells, x.shape, rounded(np.abs(x - x[0]), self.size)))

    def _same_cells(self, other: Mesh) -> bool:
        """Whether both have the same cells, numbered alike, between nodes that may lie elsewhere."""
        if self.domain.topology._cpp_object is other.domain.topology._cpp_object:  # as `moved` and `mirrored` share it
            return True
        ours, theirs = (compat.geometry_dofmap(mesh.domain) for mesh in (self, other))
        return self.domain.topology.cell_name() == other.domain.topology.cell_name() and np.array_equal(ours, theirs)

    def moved(self, offset: Sequence[float]) -> Mesh:
        """A copy of the mesh elsewhere, with the same cells, facets and named surfaces.

        Args:
            offset: The translation, (dim,) (length).

        Raises:
            ValueError: The offset is no such vector, or so large that rounding would change the cells' shape.
        """
        by = as_floats("offset", offset, f"{self.dim} finite numbers")
        if by.shape != (self.dim,) or not np.all(np.isfinite(by)):
            raise ValueError(f"offset = {offset!r}: expected {self.dim} finite numbers")
        return self._copy(translation(by), f"offset = {offset!r}")

    def mirrored(self, axis: str, at: float) -> Mesh:
        """The mirror image of the mesh in the plane `axis` = `at`.

        It has the same cells, facets and named surfaces: what was on the left and is now on the right is still "left".

        Args:
            axis: "x", "y" or, of a solid, "z": the normal of the plane.
            at: The plane's coordinate on that axis (length).

        Raises:
            ValueError: There is no such axis, or the plane is so far away that rounding would change the cells' shape.
        """
        axes = ("x", "y", "z")[: self.dim]
        direction = axes.index(check_choice("axis", axis, axes))
        return self._copy(reflection(self.dim, direction, finite("at", at)), f"at = {at!r}")

    def _copy(self, isometry: Isometry, asked: str) -> Mesh:
        """The image of the mesh, which shares its topology."""
        x = self.domain.geometry.x[:, : self.dim]
        image = isometry(x)
        # Its cells are as good as those of this mesh, unless rounding has moved their corners.
        if not np.abs(isometry.signs * (image - isometry.offset) - x).max() <= 1e-10 * self.size:
            raise ValueError(f"{asked}: so far away a mesh of the size {self.size:g} loses the digits of its shape")
        domain = compat.with_coordinates(self.domain, image)
        copy = Mesh._sound(domain, self.surfaces, self._entities, self.left_out, self.subdomains)
        vars(copy).update(self._pieces_known(), extent=self.extent)
        return copy

    @classmethod
    def _sound(
        cls,
        domain: dmesh.Mesh,
        surfaces: Mapping[str, NDArray[np.int32]],
        entities: dict[str, NDArray[np.int32]] | None,
        left_out: Mapping[str, str],
        subdomains: Mapping[str, NDArray[np.int32]],
    ) -> Mesh:
        """A mesh that is known to be valid, made without the checks; entities: of the surfaces, None if not known."""
        mesh = object.__new__(cls)
        vars(mesh).update(domain=domain, surfaces=surfaces, left_out=left_out, subdomains=subdomains)
        if entities is not None:
            vars(mesh).update(_entities=entities)
        return mesh

    def __reduce__(self) -> tuple[Any, ...]:
        raise TypeError(
            "a mesh, and what is made with it, can't be pickled or copied deeply, since dolfinx keeps it; expected a "
            "function that makes the scene anew, a cd.Parameter for other loads, or scene.with_layer(...)"
        )

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

    Args:
        lower_left: The corner of the smallest coordinates, (x, y) (length).
        upper_right: The opposite corner (length).
        cells: Along x and y, each a number of equal cells or, for a graded mesh, the coordinates of their ends.
        shape: "triangle" or "quadrilateral".
        diagonal: How each cell is cut into triangles: "left", "right" (in two) or "crossed" (in four).

    Returns:
        The mesh, of degree 1.

    Raises:
        TypeError, ValueError: The corners do not span a rectangle, `cells` is neither, or a choice is not listed here.

    Example:
        >>> rectangle((0, 0), (1, 1), ([0, 0.25, 1], 3), shape="quadrilateral")
        Mesh(6 quadrilaterals; facets left: 3, right: 3, bottom: 2, top: 2)
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
    """A structured mesh of a box with the surfaces left and right (x), front and back (y), bottom and top (z).

    Args:
        lower: The corner of the smallest coordinates, (x, y, z) (length).
        upper: The opposite corner (length).
        cells: Along x, y and z, each a number of equal cells or the coordinates of their ends, as of a `rectangle`.
        shape: "tetrahedron" (six in each cell) or "hexahedron".

    Returns:
        The mesh, of degree 1.

    Raises:
        TypeError, ValueError: The corners do not span a box, `cells` is neither, or `shape` is not listed here.

    Example:
        >>> box((0, 0, 0), (2, 1, 1), (2, 1, 1), shape="hexahedron")
        Mesh(2 hexahedrons; facets left: 1, right: 1, front: 2, back: 2, bottom: 2, top: 2)
    """
    check_choice("shape", shape, ("tetrahedron", "hexahedron"))
    corners, lines = _grid(lower, upper, cells, 3)
    counts = [len(line) - 1 for line in lines]
    domain = compat.structured(corners, counts, dmesh.CellType[shape], dmesh.DiagonalType.right)
    return _structured(domain, corners, lines, (("left", "right"), ("front", "back"), ("bottom", "top")))


def from_dolfinx(
    domain: dmesh.Mesh,
    facet_tags: Any = None,
    *,
    names: Mapping[str, int | Sequence[int]] | None = None,
    cell_tags: Any = None,
    subdomains: Mapping[str, int | Sequence[int]] | None = None,
    **markers: Marker,
) -> Mesh:
    """A mesh made with dolfinx, with its boundary surfaces named, and the parts that have materials of their own.

    Args:
        domain: A dolfinx mesh on one rank.
        facet_tags: The dolfinx `MeshTags` of facets.
        names: {name: tag, or tags} of the surfaces; by default each tag is named by its number ("2").
        cell_tags: The dolfinx `MeshTags` of cells.
        subdomains: {name: tag, or tags} of the parts of the body; by default each tag is named by its number.
        markers: More surfaces, name = function of coordinates x (3, points) to bool, as of `Mesh.with_surfaces`.

    Returns:
        The mesh. Tags of facets inside the body are left out, and refused when they are asked for.

    Raises:
        TypeError: `domain` is no dolfinx mesh, or `facet_tags` or `cell_tags` no MeshTags.
        ValueError: No facet or cell has a tag, or `Mesh` refuses the mesh.

    Example:
        >>> from dolfinx.mesh import create_unit_square
        >>> from mpi4py import MPI
        >>> square = create_unit_square(MPI.COMM_SELF, 2, 2)
        >>> from_dolfinx(square, bottom=lambda x: x[1] < 1e-10)
        Mesh(8 triangles; facets bottom: 2)
    """
    if not isinstance(domain, dmesh.Mesh):
        raise TypeError(f"domain = {domain!r}: expected a dolfinx mesh")
    groups, left_out = _tagged(domain, facet_tags, names)
    parts = {
        name: _with_tags(cell_tags, wanted)
        for name, wanted in _named_tags(domain.topology.dim, cell_tags, subdomains, ("cell_tags", "subdomains")).items()
    }
    return Mesh(domain, {**groups, **_mark(domain, markers)}, left_out, parts)


def from_arrays(
    cells: Integers,
    x: Floats,
    element: Any,
    surfaces: Mapping[str, Integers],
    left_out: Mapping[str, str],
    subdomains: Mapping[str, Integers] | None = None,
) -> Mesh:
    """The mesh of given cells, which must be valid, with its named surfaces.

    Args:
        cells: (cells, nodes) The nodes of each cell, in the order of the coordinate element.
        x: (nodes, dim) The nodes' coordinates (length).
        element: The coordinate element.
        surfaces: {name: (facets, 2) the cell and local facet of each facet}.
        left_out: {name: why} of groups that are no surfaces.
        subdomains: {name: indices of given cells}.
    """
    domain = compat.from_arrays(cells, np.ascontiguousarray(x), element)
    dim = domain.topology.dim
    domain.topology.create_connectivity(dim, dim - 1)
    of_cell = domain.topology.connectivity(dim, dim - 1).array.reshape(len(cells), -1)
    new = np.argsort(domain.topology.original_cell_index)  # dolfinx's number of each given cell
    facets = {name: np.unique(of_cell[new[pairs[:, 0]], pairs[:, 1]]) for name, pairs in surfaces.items()}
    parts = {name: np.sort(new[each]).astype(np.int32) for name, each in (subdomains or {}).items()}
    return Mesh(domain, facets, left_out, parts)


def inside_the_body(facets: int) -> str:
    """The reason why a group of facets inside the body is no surface."""
    return f"{facets} facets of that group are inside the body, between cells"


def _tagged(
    domain: dmesh.Mesh, tags: Any, names: Mapping[str, int | Sequence[int]] | None
) -> tuple[dict[str, NDArray[np.int32]], dict[str, str]]:
    """The surfaces given by tags of facets, and the reasons why other tags give none."""
    surfaces, left_out = {}, {}
    for name, wanted in _named_tags(domain.topology.dim - 1, tags, names, ("facet_tags", "names")).items():
        facets = _with_tags(tags, wanted)
        within = _within(domain, facets)
        if within:
            left_out[name] = inside_the_body(within)
        else:
            surfaces[name] = facets
    return surfaces, left_out


def _named_tags(
    dim: int, tags: Any, names: Mapping[str, int | Sequence[int]] | None, arguments: tuple[str, str]
) -> dict[str, list[int]]:
    """The tags of each name, checked; dim: of the tagged entities; arguments: the names of tags and names."""
    tags_name, names_name = arguments
    of = tags_name.removesuffix("_tags")
    if tags is None:
        if names is not None:
            raise ValueError(f"{names_name} = {names!r}: expected {tags_name} beside them")
        return {}
    if not isinstance(tags, dmesh.MeshTags):
        raise TypeError(f"{tags_name} = {tags!r}: expected MeshTags of dolfinx")
    if tags.dim != dim:
        raise ValueError(f"{tags_name}: tags of entities of dimension {tags.dim}; expected {dim}, the {of}s'")
    known = [int(tag) for tag in np.unique(tags.values)]
    if names is None:
        return {str(tag): [tag] for tag in known}
    chosen = {name: _tags(names_name, name, tag) for name, tag in names.items()}
    for name, wanted in chosen.items():
        missing = [tag for tag in wanted if tag not in known]
        if missing:
            raise ValueError(f"{names_name}: {name!r} is the tag {missing[0]}, which no {of} has (there are {known})")
    return chosen


def _with_tags(tags: Any, wanted: Sequence[int]) -> NDArray[np.int32]:
    """The sorted indices of the entities that have one of the tags."""
    return np.unique(tags.indices[np.isin(tags.values, wanted)]).astype(np.int32)


def _tags(argument: str, name: str, tags: Any) -> list[int]:
    """One tag or several as a list."""
    each = np.atleast_1d(np.asarray(tags))
    if not isinstance(name, str) or each.ndim != 1 or each.dtype.kind not in "iu":
        raise TypeError(f"{argument}: {name!r} is {tags!r}; expected a name and its whole number or numbers")
    return [int(tag) for tag in each]


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
    return [low, high], [_line(*ends) for ends in zip(low, high, cells, strict=True)]


def _line(start: float, end: float, cells: Cells) -> NDArray[np.float64]:
    """The coordinates at which the cells along one axis end."""
    if np.ndim(cells) == 0:
        count = as_count("cells", cells, "a whole number >= 1, or the coordinates of the cells' ends")
        return np.asarray(np.linspace(start, end, count + 1), dtype=float)
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
    mesh = Mesh._sound(domain, surfaces, entities, {}, {}) if sound else Mesh(domain, surfaces)
    vars(mesh).update(piece_of_cell=np.zeros(mesh.cells, dtype=np.int64))  # one piece, without a look at the cells
    return mesh


def _move(domain: dmesh.Mesh, lines: list[NDArray[np.float64]]) -> None:
    """Move the nodes of a structured mesh of equal cells to the given coordinates."""
    x = domain.geometry.x
    for axis, line in enumerate(lines):
        cells = len(line) - 1
        # The number of the grid line through each node, halves for the middles of crossed cells.
        number = np.rint((x[:, axis] - line[0]) * (2 * cells / (line[-1] - line[0]))) / 2
        x[:, axis] = np.interp(number, np.arange(cells + 1), line)


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
    """A marker whose values are checked before dolfinx gets them: its own messages would not name the marker."""
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
    """Refuse coordinates that are not finite, and cells in which no displacement could be computed."""
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
    _refuse_hanging_nodes(domain)


def _refuse_hanging_nodes(domain: dmesh.Mesh) -> None:
    """Refuse nodes in the middle of a neighbour's edge: displacements would gape there."""
    entities = facet_entities(domain, dmesh.exterior_facet_indices(domain.topology))
    hanging = hanging_nodes(ring_edges(facet_nodes(domain, entities)), domain.geometry.x)
    if len(hanging):
        at = domain.geometry.x[hanging[0]][: domain.topology.dim]
        raise ValueError(
            f"mesh: {len(hanging)} hanging nodes, one of them at {at}, lie in the middle of a neighbour's edge; "
            "expected cells that meet corner to corner"
        )


def _descendants(made: Split, pairs: NDArray[np.int32]) -> NDArray[np.int32]:
    """The (cell, local facet) of a finer mesh's facets that lie in facets of the coarser one, given alike."""
    per_cell = made.facets.shape[1]
    ours = np.isin(made.parents[:, None] * per_cell + made.facets, pairs[:, 0] * per_cell + pairs[:, 1])
    return np.argwhere(ours & (made.facets >= 0)).astype(np.int32)


def _others(mesh: Mesh, surfaces: Mapping[str, Any]) -> dict[str, str]:
    """The surfaces and groups of a mesh that one of its pieces has no part of, and the reasons."""
    missing = {name: "no facet of it belongs to this piece" for name in mesh.surfaces if name not in surfaces}
    return {**mesh.left_out, **missing}


def _pieces(mesh: Mesh) -> list[Mesh]:
    """Each piece as a mesh of its own."""
    dofmap, element = compat.geometry_dofmap(mesh.domain), mesh.domain.ufl_domain().ufl_coordinate_element()
    found = []
    for number in range(int(mesh.piece_of_cell.max()) + 1):
        cells = np.flatnonzero(mesh.piece_of_cell == number)
        nodes, local = np.unique(dofmap[cells], return_inverse=True)
        ours = {name: pairs[np.isin(pairs[:, 0], cells)] for name, pairs in mesh._entities.items()}
        surfaces = {
            name: np.column_stack([np.searchsorted(cells, pairs[:, 0]), pairs[:, 1]])
            for name, pairs in ours.items()
            if len(pairs)
        }
        x, rows = mesh.domain.geometry.x[nodes, : mesh.dim], local.reshape(len(cells), -1).astype(np.int64)
        parts = {name: np.flatnonzero(np.isin(cells, each)) for name, each in mesh.subdomains.items()}
        parts = {name: each for name, each in parts.items() if len(each)}
        found.append(from_arrays(rows, x, element, surfaces, _others(mesh, surfaces), parts))
    return found


def _folded(domain: dmesh.Mesh) -> NDArray[np.bool_]:
    """The mask (cells,) of cells on the same side of a facet as their neighbour there; of each pair the first."""
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
    if np.ndim(facets) != 1 or np.asarray(facets).dtype.kind not in "iu":
        raise TypeError(f"surface {name!r}: expected the indices of its facets, an array (facets,) of whole numbers")
    inside = _within(domain, facets, name)
    if inside:
        raise ValueError(f"surface {name!r}: {inside} of its {len(facets)} facets are inside the body")


def _check_subdomain(count: int, name: str, cells: NDArray[np.int32]) -> None:
    array = np.asarray(cells)
    if array.ndim != 1 or len(array) == 0 or array.dtype.kind not in "iu":
        raise ValueError(f"subdomain {name!r}: expected the indices of its cells, an array (cells,) of whole numbers")
    if array.min() < 0 or array.max() >= count:
        wrong = array[(array < 0) | (array >= count)][0]
        raise ValueError(f"subdomain {name!r}: the cell {wrong} is not there; expected indices from 0 to {count - 1}")


def _within(domain: dmesh.Mesh, facets: NDArray[np.int32], name: str = "") -> int:
    """The number of facets inside the body; refuses indices that no facet has."""
    dim = domain.topology.dim
    domain.topology.create_connectivity(dim - 1, dim)
    cells = np.diff(domain.topology.connectivity(dim - 1, dim).offsets)
    strange = (facets < 0) | (facets >= len(cells))
    if np.any(strange):
        raise ValueError(
            f"surface {name!r}: the facet {facets[strange][0]} is not there; expected indices from 0 to "
            f"{len(cells) - 1}"
        )
    return int(np.sum(cells[facets] != 1))
