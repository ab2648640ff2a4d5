"""The format of a file, from its first bytes, and advice for formats that are not read here."""

from __future__ import annotations

import re
from pathlib import Path

#: The beginning of a file of each format, compared in this order with its first bytes after blanks.
BEGINNINGS: tuple[tuple[str, str], ...] = (
    ("gmsh mesh", r"\$(MeshFormat|NOD|Comments|PhysicalNames)\b"),
    ("Medit mesh", r"MeshVersionFormatted"),
    ("MFEM mesh", r"MFEM (NURBS |INLINE )?(NC )?mesh"),
    ("GetFEM mesh", r"(%.*\n\s*)*BEGIN (POINTS LIST|MESH STRUCTURE)|%\s*GETFEM"),
    ("GiD mesh", r"(#.*\n\s*)*(MESH|mesh|Mesh)\b.*(dimension|DIMENSION|Dimension)"),
    ("STEP file", r"ISO-10303-21"),
    ("VTK file", r"# vtk DataFile|<(\?xml[^>]*>\s*<)?VTKFile"),
    ("XML file", r"<\?xml|<dolfin|<Xdmf"),
    ("HDF5 file", "\x89HDF"),
    ("LS-DYNA deck", r"(\$.*\n\s*)*\*KEYWORD"),
    ("Abaqus or CalculiX deck", r"\*\*|\*[A-Za-z]"),
    ("universal file", r"-1\s*\n\s*\d+\s*\n"),
    ("FreeFem mesh", r"\d+ +\d+ +\d+\s*\n\s*[-+.\deE]+ +[-+.\deE]+ +[-+.\deE]+( +[-+.\deE]+)?\s*\n"),
    ("STL file", r"solid\b.*\n\s*facet"),
    ("Nastran deck", r"(\$.*\n\s*)*(SOL\b|CEND|BEGIN BULK|ID |INIT |NASTRAN |GRID|CTRIA3|CORD2R|MAT1)"),
)

#: Formats known by the end of the file's name, where its first bytes are not characteristic.
ENDINGS = {
    ".geo": "gmsh script",
    ".bdf": "Nastran deck",
    ".nas": "Nastran deck",
    ".dat": "Nastran deck",
    ".stl": "STL file",
    ".inp": "Abaqus or CalculiX deck",
    ".unv": "universal file",
    ".med": "MED file",
    ".mmed": "MED file",
    ".rmed": "MED file",
}

#: Advice on files that cannot be read here.
WAYS = {
    "Medit mesh": "open it in gmsh and save it as .msh",
    "MFEM mesh": "MFEM's PrintVTK and meshio, or the gmsh mesh that it was made from, give a .msh file",
    "GetFEM mesh": "export it to .msh with GetFEM",
    "GiD mesh": "export it from GiD as .msh of gmsh or as a deck of Abaqus",
    "VTK file": "meshio converts it to .msh (names are lost; with_surfaces gives new ones)",
    "XML file": "dolfinx' XDMFFile reads those of its own, and cd.from_dolfinx takes the mesh and its tags",
    "HDF5 file": "meshio converts MED and some others to .msh of gmsh",
    "LS-DYNA deck": "save it as a deck of Abaqus or as .msh of gmsh",
    "FreeFem mesh": 'savegmsh of FreeFem, load "gmsh", writes .msh of gmsh',
    "STL file": "cd.read_geometry meshes its inside",
    "STEP file": "cd.read_geometry meshes it",
}


def format_of(path: Path) -> str:
    """The name of a file's format, "empty" or "unknown".

    Raises FileNotFoundError where there is no such file.
    """
    if not path.is_file():
        raise FileNotFoundError(f"path = {str(path)!r}: no such file")
    with path.open("rb") as file:
        beginning = file.read(4096).decode("latin-1").removeprefix("ï»¿").lstrip()
    if not beginning:
        return "empty"
    ending = path.suffix.lower()
    found = next((name for name, start in BEGINNINGS if re.match(start, beginning)), None)
    if found == "HDF5 file" and ENDINGS.get(ending) == "MED file":
        return "MED file"
    if found is None and "\0" in beginning and ENDINGS.get(ending) not in ("STL file", "MED file"):
        return "unknown"
    return found or ENDINGS.get(ending, "unknown")


def refuse(path: Path, found: str, reader: str, able: str) -> ValueError:
    """The error about a file in a format that a reader does not read, with what to do."""
    if found in ("empty", "unknown"):
        what = "an empty file" if found == "empty" else "a file in no known format"
        return ValueError(f"path = {str(path)!r}: {what}; {reader} reads {able}")
    way = WAYS.get(found, "cd.read_mesh reads it")
    return ValueError(f"path = {str(path)!r}: the format is {found}; {reader} reads {able}. What to do: {way}")
