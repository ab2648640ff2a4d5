"""A solution as plain data in a folder: arrays (.npz) and their description (.json). Nothing in it is ever executed."""

from __future__ import annotations

import json
import os
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from .base.arrays import Floats
from .body_result import BodyResult, SurfaceFit
from .contact_result import ContactResult, NodalPressure, solution_html
from .history import History, Record
from .surface_result import SurfaceResult, Surfaces

FORMAT = "contactdd solution"


VERSION = 1


DESCRIPTION, ARRAYS = "solution.json", "solution.npz"


T = TypeVar("T")


@dataclass(frozen=True)
class SavedSolution:
    """A solution as plain data without its scene, read by `load_solution`.

    Attributes:
        status, reason, method: Those of the `Solution`.
        numbers: {"energy", "layer_energy", "residual", "imbalance", "largest_strain", "largest_rotation"}, as the
            attributes of a `Solution` of these names.
        history: The records of the iterations.
        bodies: The `BodyResult` of each body with a mesh, in the order of the scene.
        contacts: {name: `ContactResult`}.
        surfaces: {name: (`SurfaceResult` of the first body, of the second)}, None for a body without a mesh.
        resultants: {body: {"loads", "contact", "supports": (dim,)}}, as of `Solution.forces` (force).

    Example:
        >>> import contactdd as cd
        >>> forces = {"block": {"loads": np.array([0.0, -6.0])}}
        >>> saved = cd.SavedSolution("converged", "", "newton", {"energy": -1.0}, cd.History(), [], {}, {}, forces)
        >>> saved.converged, saved.forces("block")["loads"]
        (True, array([ 0., -6.]))
    """

    status: str
    reason: str
    method: str
    numbers: Mapping[str, float]
    history: History
    bodies: Sequence[BodyResult]
    contacts: Mapping[str, ContactResult]
    surfaces: Mapping[str, Surfaces]
    resultants: Mapping[str, Mapping[str, Floats]]

    @property
    def converged(self) -> bool:
        """Whether the solve converged."""
        return self.status == "converged"

    def contact(self, contact: str | int = 0) -> ContactResult:
        """The pressure, gap and compression of a contact at its points.

        Args:
            contact: Its name or its index.

        Raises:
            ValueError: There is no such contact.
        """
        return self.contacts[self._name(contact)]

    def contact_surface(self, contact: str | int = 0, *, second: bool = False) -> SurfaceResult:
        """The pressure, gap and status of a contact facet by facet.

        Args:
            contact: Its name or its index.
            second: Whether on the second body's surface instead of the first's.

        Raises:
            ValueError: There is no such contact, or that body has no mesh.
        """
        surface = self.surfaces[self._name(contact)][int(second)]
        if surface is None:
            raise ValueError(f"contact = {contact!r}, second = {second}: that body has no mesh")
        return surface

    def body(self, body: str) -> BodyResult:
        """The displacement and stress of a body at its nodes.

        Args:
            body: Its name.

        Raises:
            ValueError: There is no such body with a mesh.
        """
        for other in self.bodies:
            if other.name == body:
                return other
        raise ValueError(f"body = {body!r}: expected one of {', '.join(repr(b.name) for b in self.bodies)}")

    def forces(self, body: str) -> Mapping[str, Floats]:
        """The resultants on a body, each (dim,) (force): "loads", "contact" and "supports".

        Args:
            body: Its name.

        Raises:
            ValueError: There is no such body.
        """
        if body not in self.resultants:
            raise ValueError(f"body = {body!r}: expected one of {', '.join(map(repr, self.resultants))}")
        return self.resultants[body]

    def plot_contact(self, contact: str | int = 0, **options: Any) -> Any:
        """A matplotlib figure of pressure and gap over a contact, see `Solution.plot_contact`.

        Args:
            contact: Its name or its index.
            options: As of `Solution.plot_contact`.
        """
        from .view.contact_plot import plot_contact

        return plot_contact(self.contact(contact), self.surfaces[self._name(contact)], **options)

    def plot_bodies(self, bodies: Sequence[str] | None = None, **options: Any) -> Any:
        """A picture of the deformed bodies, see `Solution.plot_bodies`.

        Args:
            bodies: Their names; by default all.
            options: As of `Solution.plot_bodies`.
        """
        from .view.body_plot import plot_bodies

        return plot_bodies(self.bodies if bodies is None else [self.body(body) for body in bodies], **options)

    def export(self, folder: str | os.PathLike[str]) -> list[Path]:
        """The files written for ParaView, see `Solution.export`.

        Args:
            folder: The path of the folder, which is made if missing.
        """
        from .view.export import Fields, export

        contacts = [(name, result, self.surfaces[name]) for name, result in self.contacts.items()]
        return export(Fields({body.name: body for body in self.bodies}, contacts), Path(folder))

    def __repr__(self) -> str:
        lines = [f"SavedSolution by {self.method!r}: {self.status} ({self.reason})"]
        return "\n  ".join(lines + [f"{name}: {result!r}" for name, result in self.contacts.items()])

    def _repr_html_(self) -> str:
        return solution_html(self.status, self.reason, self.method, self.contacts)

    def _name(self, contact: str | int) -> str:
        for index, name in enumerate(self.contacts):
            if contact in (index, name, name.replace("–", "-")):
                return name
        raise ValueError(f"contact = {contact!r}: expected an index or one of {', '.join(map(repr, self.contacts))}")


def save(solution: SavedSolution, folder: Path) -> Path:
    """The folder written; it is made if missing, and an earlier solution in it is replaced."""
    folder.mkdir(parents=True, exist_ok=True)
    arrays: dict[str, NDArray] = {}
    description = {
        "format": FORMAT,
        "version": VERSION,
        "status": solution.status,
        "reason": solution.reason,
        "method": solution.method,
        "numbers": dict(solution.numbers),
        "history": [asdict(record) for record in solution.history],
        "resultants": {
            body: {n: v.tolist() for n, v in forces.items()} for body, forces in solution.resultants.items()
        },
        "bodies": [_body_told(solution, index, arrays) for index in range(len(solution.bodies))],
        "contacts": [_contact_told(solution, index, name, arrays) for index, name in enumerate(solution.contacts)],
    }
    _replace(folder / ARRAYS, lambda file: np.savez_compressed(file, **arrays))  # type: ignore[arg-type]
    _replace(folder / DESCRIPTION, lambda file: file.write(json.dumps(description, indent=1).encode()))
    return folder


def _body_told(solution: SavedSolution, index: int, arrays: dict[str, NDArray]) -> dict[str, Any]:
    """The description of one body; its arrays go into `arrays`."""
    body = solution.bodies[index]
    plain = _taken_apart(body, f"body {index}", arrays, skip="fits")
    for number, fit in enumerate(body.fits):
        _taken_apart(fit, f"body {index} fit {number}", arrays)
    return plain | {"fits": len(body.fits)}


def _contact_told(solution: SavedSolution, index: int, name: str, arrays: dict[str, NDArray]) -> dict[str, Any]:
    """The description of one contact; its arrays go into `arrays`."""
    result, prefix = solution.contacts[name], f"contact {index}"
    told: dict[str, Any] = {"name": name, "contact": _taken_apart(result, prefix, arrays, skip="nodal")}
    told["nodal"] = None if result.nodal is None else _taken_apart(result.nodal_field, f"{prefix} nodal", arrays)
    for side, surface in enumerate(solution.surfaces[name]):
        told[f"surface {side}"] = surface and _taken_apart(surface, f"surface {index} {side}", arrays)
    return told


def load_solution(folder: str | os.PathLike[str]) -> SavedSolution:
    """The solution that `Solution.save` wrote into a folder.

    Only numbers and text are read; nothing in the files is executed.

    Args:
        folder: The folder that was given to `Solution.save`.

    Raises:
        ValueError: The folder holds no saved solution, or one that is damaged or of a later version.

    Example:
        >>> solution.save("groove")  # doctest: +SKIP
        >>> cd.load_solution("groove").contact().force  # doctest: +SKIP
    """
    path = Path(folder)
    if not (path / DESCRIPTION).is_file() or not (path / ARRAYS).is_file():
        raise ValueError(f"folder = {str(path)!r}: expected one that holds {DESCRIPTION} and {ARRAYS}")
    try:
        told = json.loads((path / DESCRIPTION).read_text(encoding="utf-8"))
        with np.load(path / ARRAYS, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        if told["format"] != FORMAT or told["version"] != VERSION:
            raise ValueError(f"{told['format']!r}, version {told['version']}, is not {FORMAT!r}, version {VERSION}")
        return _put_together(told, arrays)
    except (OSError, EOFError, KeyError, TypeError, AttributeError, ValueError, zipfile.BadZipFile) as error:
        raise ValueError(f"folder = {str(path)!r}: damaged, or no saved solution ({error})") from error


def _put_together(told: dict[str, Any], arrays: Mapping[str, NDArray]) -> SavedSolution:
    history = History()
    for record in told["history"]:
        history.append(Record(**record))
    bodies, contacts, surfaces = [], {}, {}
    resultants = {body: {n: np.array(v) for n, v in forces.items()} for body, forces in told["resultants"].items()}
    for index, entry in enumerate(told["bodies"]):
        fits = tuple(_made(SurfaceFit, f"body {index} fit {number}", {}, arrays) for number in range(entry["fits"]))
        body = _made(BodyResult, f"body {index}", entry, arrays, fits=fits)
        bodies.append(body)
    for index, entry in enumerate(told["contacts"]):
        area = tuple(entry["contact"]["unpaired_area"])
        given, prefix = entry["nodal"], f"contact {index}"
        nodal = None if given is None else _made(NodalPressure, f"{prefix} nodal", given, arrays)
        own = {"unpaired_area": area, "nodal": nodal}
        contacts[entry["name"]] = _made(ContactResult, prefix, entry["contact"], arrays, **own)
        surfaces[entry["name"]] = (_surface(index, 0, entry, arrays), _surface(index, 1, entry, arrays))
    plain = {name: told[name] for name in ("status", "reason", "method", "numbers")}
    return SavedSolution(
        **plain, history=history, bodies=bodies, contacts=contacts, surfaces=surfaces, resultants=resultants
    )


def _surface(index: int, side: int, entry: Mapping[str, Any], arrays: Mapping[str, NDArray]) -> SurfaceResult | None:
    """One side of a contact."""
    plain = entry[f"surface {side}"]
    return None if plain is None else _made(SurfaceResult, f"surface {index} {side}", plain, arrays)


def _taken_apart(item: Any, prefix: str, arrays: dict[str, NDArray], skip: str = "") -> dict[str, Any]:
    """The plain fields of a dataclass; its arrays go into `arrays`."""
    plain = {}
    for name in (field.name for field in fields(item) if field.name != skip):
        value = getattr(item, name)
        value = value() if callable(value) else value
        if isinstance(value, np.ndarray):
            arrays[f"{prefix} {name}"] = value
        elif value is not None:
            plain[name] = value.item() if isinstance(value, np.generic) else value
    return plain


def _made(kind: type[T], prefix: str, plain: Mapping[str, Any], arrays: Mapping[str, NDArray], **own: Any) -> T:
    """A dataclass from its plain fields and its arrays."""
    names = [field.name for field in fields(cast(Any, kind)) if field.name not in own]
    given = {name: arrays[f"{prefix} {name}"] for name in names if f"{prefix} {name}" in arrays}
    return kind(**given, **{name: plain[name] for name in names if name in plain and name not in given}, **own)


def _replace(path: Path, write: Any) -> None:
    """Write a file that appears whole or not at all."""
    partial = path.with_name(f"{path.name}.{os.getpid()}.part")
    try:
        with open(partial, "wb") as file:
            write(file)
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)
