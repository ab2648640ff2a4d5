"""Fields of a solution as files for ParaView and pyvista."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ..body_result import BodyResult
from ..contact_result import ContactResult
from ..surface_result import SurfaceResult, Surfaces
from .vtu import Grid, SeriesEntry, write_series
from .xdmf import write_surfaces

#: VTK's number of a vertex.
VERTEX = 1


@dataclass(frozen=True)
class Fields:
    """The results of a solution for files: its bodies, and of each contact its name, its points and the surfaces.

    bodies: by name, None for one that another rank writes; contacts: empty where another rank writes them.
    """

    bodies: Mapping[str, BodyResult | None]
    contacts: Sequence[tuple[str, ContactResult, Surfaces]]

    def grids(self) -> dict[str, Grid | None]:
        """The grids by the names of their files, which are unlike also where small and large letters are the same."""
        names: dict[str, Grid | None] = {}
        for name, body in self.bodies.items():
            names[_unused(file_name(name), names)] = None if body is None else _body(body)
        for name, points, surfaces in self.contacts:
            stem = file_name(name)
            names[_unused(f"{stem} points", names)] = _points(points)
            for surface in filter(None, surfaces):
                names[_unused(f"{stem} on {file_name(surface.body)}", names)] = _surface(surface)
        return names


def export(fields: Fields, folder: Path) -> list[Path]:
    """The .vtu files written into a folder, which is made if missing, and contacts.xdmf."""
    folder.mkdir(parents=True, exist_ok=True)
    written = [grid.write(folder / f"{name}.vtu") for name, grid in fields.grids().items() if grid is not None]
    surfaces = [surface for *_, sides in fields.contacts for surface in filter(None, sides)]
    return [*written, *([write_surfaces(folder / "contacts.xdmf", surfaces)] if fields.contacts else [])]


def export_series(steps: Sequence[tuple[Callable[[], Fields], ArrayLike]], folder: Path, name: str) -> list[Path]:
    """The files written of the steps of a load programme, each with its parameter's value: the .pvd file first.

    The fields of a step are made when it is written, so that those of one only are kept at a time. Time is the number
    of the step, since loads may come back. The .pvd file is written by the rank that writes the contacts.
    """
    folder.mkdir(parents=True, exist_ok=True)
    entries, written, first = [], [], False
    for number, (made, value) in enumerate(steps, 1):
        fields = made()
        first = bool(fields.contacts)
        for part, (stem, grid) in enumerate(fields.grids().items()):
            file = f"{stem}.{number:04d}.vtu"
            entries.append(SeriesEntry(float(number), part, stem, file))
            if grid is None:
                continue
            told = {"step": np.array([number]), "parameter": np.ravel(np.asarray(value, dtype=float))}
            marked = Grid(grid.points, grid.cells, grid.cell_type, grid.point_data, grid.cell_data, told)
            written.append(marked.write(folder / file))
    return [*([write_series(folder / f"{file_name(name)}.pvd", entries)] if first else []), *written]


def file_name(name: str) -> str:
    """A name that is safe for a file everywhere: letters, digits, blanks, "-", "_" and "."; others become "-"."""
    safe = re.sub(r"[^\w .-]+", "-", name.replace("–", "-")).strip(" .")
    reserved = re.fullmatch(r"(?i)(con|prn|aux|nul|com\d|lpt\d)(\..*)?", safe)
    return f"_{safe}" if reserved or not safe else safe[:120]


def _unused(name: str, names: Mapping[str, Grid | None]) -> str:
    """The name, with a number where another one would be the same file."""
    taken = {other.casefold() for other in names}
    choices = [name, *(f"{name} {number}" for number in range(2, len(taken) + 3))]
    return next(choice for choice in choices if choice.casefold() not in taken)


def _body(body: BodyResult) -> Grid:
    nodal = {"displacement": body.displacement, "stress": body.stress, "von Mises": body.von_mises}
    return Grid(body.points, body.cells, body.cell_type, nodal, {"stress of cell": body.cell_stress})


def _surface(surface: SurfaceResult) -> Grid:
    values = {
        "pressure": surface.pressure,
        "gap": surface.gap,
        "compression": surface.compression,
        "status": surface.status,
        "closed": surface.closed,
        "covered": surface.covered,
        "area": surface.areas,
    }
    nodal = {"displacement": surface.displacement}
    if surface.projected_pressure is not None:
        nodal["projected pressure"] = surface.projected_pressure
    return Grid(surface.points, surface.cells, surface.cell_type, nodal, values)


def _points(result: ContactResult) -> Grid:
    values = {
        "pressure": result.pressure,
        "gap": result.gap,
        "compression": result.compression,
        "status": np.where(result.closed, 3, 1),
        "normal": result.normal,
        "weight": result.weights,
    }
    known = {
        "initial gap": result.initial_gap,
        "slip": result.slip,
        "shear": result.shear,
        "largest closure": result.largest_closure,
    }
    values |= {name: field for name, field in known.items() if field is not None}
    return Grid(result.x, np.arange(len(result.x))[:, None], VERTEX, values)
