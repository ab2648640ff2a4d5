"""Meshes from files: the format is told by how the file begins, and each has its reader."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from warnings import warn

from ..base.checks import as_count, positive
from ..errors import ContactWarning
from ..mesh import Marker, Mesh
from .contents import Contents, KindError
from .formats import format_of, refuse

GMSH = ".msh files of gmsh 2 and 4 and .geo scripts"
ALL = f"{GMSH}, decks of Abaqus and CalculiX (.inp), universal files (.unv), bulk data of Nastran (.bdf), MED files"


def read_gmsh(
    path: str | Path, dim: int | None = None, *, body: str | None = None, order: int = 1, **parameters: float
) -> Mesh:
    """The mesh in a .msh file, or of a .geo script with its ONELAB numbers "Parameters/…" set to `parameters`.

    What a script makes is kept in the user's cache (`mesh_cache`) and made anew when the script, a file that it names,
    the parameters or the order change.

    Args:
        path: The path of a .msh file of gmsh 2 or 4, or of a .geo script.
        dim: 2 or 3; by default 3 if there are solid cells.
        body: The physical group of cells to take, see `from_gmsh`.
        order: The degree of the geometry made from a script, 2 for curved cells.
        parameters: Numbers that the script declares under "Parameters/".

    Returns:
        The mesh, with a surface for each physical group of facets.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: The file is in another format, which is named before gmsh sees it, or `from_gmsh` refuses it.

    Example:
        >>> cd.read_gmsh("punch.geo", order=2, radius=12.5)  # doctest: +SKIP
    """
    path = Path(path)
    found = format_of(path)
    if found not in ("gmsh mesh", "gmsh script"):
        raise refuse(path, found, "cd.read_gmsh", GMSH)
    return _contents(path, found, dim, order, parameters).mesh(body)


def read_mesh(
    path: str | Path, body: str | None = None, *, dim: int | None = None, order: int = 1, **parameters: float
) -> Mesh:
    r"""The mesh of a body in a file of gmsh, Abaqus, CalculiX, Nastran or Salome, with its named surfaces.

    The quadrilaterals of a body that has triangles too are cut into triangles, straight prisms and pyramids and what is
    beside them into tetrahedra, with a warning.

    Args:
        path: The path of the file; its first bytes tell the format.
        body: The group of cells to take: a physical group of gmsh, an ``*ELSET`` of a deck (in capitals), a group of
            elements, the number of a property of Nastran ("3"). By default all cells; of gmsh's files those in groups,
            if there are such.
        dim: 2 or 3; by default 3 if there are solid cells.
        order: The degree of the geometry made from a .geo script.
        parameters: Numbers of a .geo script.

    Returns:
        The mesh, with a surface for each named group of facets.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: The format is not read here (the message says what to do); there is no such group; the cells are of
            several kinds, or none that can be computed with; groups of facets belong to no cell.

    Example:
        >>> import tempfile, pathlib
        >>> path = pathlib.Path(tempfile.mkdtemp(), "square.inp")
        >>> nodes = "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n"
        >>> cells = "*ELEMENT, TYPE=CPE4, ELSET=block\n9, 1, 2, 3, 4\n"
        >>> _ = path.write_text(nodes + cells + "*SURFACE, NAME=top\n9, S3\n")
        >>> read_mesh(path, "BLOCK")
        Mesh(1 quadrilaterals; facets TOP: 1)
    """
    path = Path(path)
    return _contents(path, format_of(path), dim, order, parameters).mesh(body)


def read_bodies(path: str | Path, *, dim: int | None = None, order: int = 1, **parameters: float) -> dict[str, Mesh]:
    """The meshes of all groups of cells in a file, {name: mesh}; see `read_mesh`.

    Groups may overlap: which of them are the bodies is yours to choose. `Mesh.pieces` separates bodies that share a
    group. A group whose cells are of several kinds, or of one that cannot be computed with, is left out with a warning
    that says so.

    Args:
        path: The path of the file; its first bytes tell the format.
        dim: 2 or 3; by default 3 if there are solid cells.
        order: The degree of the geometry made from a .geo script.
        parameters: Numbers of a .geo script.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: There are no groups of cells; `read_mesh` refuses one for another reason, or all for this one.
    """
    path = Path(path)
    found = _contents(path, format_of(path), dim, order, parameters)
    if not found.bodies:
        raise ValueError(f"path = {str(path)!r}: the file has no groups of cells; cd.read_mesh reads it as one mesh")
    bodies, left_out = {}, list[KindError]()
    for name in found.bodies:
        try:
            bodies[name] = found.mesh(name)
        except KindError as error:
            left_out.append(error)
    if not bodies:
        raise left_out[0]
    for reason in left_out:
        warn(f"left out: {reason}", ContactWarning, stacklevel=2)
    return bodies


def read_geometry(path: str | Path, size: float, *, order: int = 1, **markers: Marker) -> Mesh:
    """The mesh of the inside of a geometry: a STEP file (.step, .stp), or a closed surface of triangles (.stl).

    Solids of an assembly that are not glued are pieces of the mesh: `mesh.pieces()` gives one for each.

    Args:
        path: The path of the file; its first bytes tell the format.
        size: The size of the cells (length; of a STEP file in mm, whatever its own unit), which are tetrahedra.
        order: The degree of the geometry, 2 for curved cells; an .stl has flat facets whatever it is.
        markers: The named surfaces, name = function of coordinates x (3, points) (length) to bool (points,), as of
            `Mesh.with_surfaces`.

    Returns:
        The mesh.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: It is no geometry, gmsh cannot mesh it, or a marker marks no facet.

    Example:
        >>> cd.read_geometry("bracket.step", 2.0, foot=lambda x: x[2] < 1e-6)  # doctest: +SKIP
    """
    path, length = Path(path), positive("size", size)
    found = format_of(path)
    if found not in ("STEP file", "STL file"):
        raise refuse(path, found, "cd.read_geometry", "STEP and STL files")
    from . import gmsh

    mesh = gmsh.meshed(path, length, as_count("order", order), found).mesh()
    return mesh.with_surfaces(**markers) if markers else mesh


def _contents(path: Path, found: str, dim: int | None, order: int, parameters: Mapping[str, float]) -> Contents:
    """The nodes, cells and groups of a file in one of the formats that are read here."""
    if dim not in (None, 2, 3):
        raise ValueError(f"dim = {dim!r}: expected 2 or 3")
    if found in ("gmsh mesh", "gmsh script"):
        from . import gmsh

        return gmsh.read(path, dim, found == "gmsh script", as_count("order", order), parameters)
    if parameters or order != 1:
        raise ValueError(f"path = {str(path)!r}: parameters and order are for .geo scripts")
    if found == "Abaqus or CalculiX deck":
        from . import deck

        return deck.read(path, dim)
    if found == "universal file":
        from . import universal

        return universal.read(path, dim)
    if found == "Nastran deck":
        from . import nastran

        return nastran.read(path, dim)
    if found == "MED file":
        from . import med

        return med.read(path, dim)
    raise refuse(path, found, "cd.read_mesh", ALL)
