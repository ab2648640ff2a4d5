"""`python -m contactdd`: what is installed; `python -m contactdd solve scene.toml`: a scene in a file."""

from __future__ import annotations

import argparse
import importlib
import importlib.metadata
import importlib.util
import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from .base import compat  # noqa: F401  (the libraries of PyPI's dolfinx come first)
from .errors import ContactError
from .programme import LoadPath
from .solution import Solution

#: What is of use beside dolfinx, and what for.
OPTIONAL = {
    "gmsh": "reads .geo and .msh files",
    "matplotlib": "draws contacts",
    "pyvista": "draws bodies",
    "pandas": "frames of results",
    "tqdm": "progress bars",
    "notebook": "serves notebooks",
}


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit status: 0, 1 if a scene has no solution, 2 if a file makes no scene.

    Args:
        arguments: Those of the command line by default.
    """
    parser = argparse.ArgumentParser(
        prog="contactdd", description="Contact of elastic bodies through nonlinear layers."
    )
    commands = parser.add_subparsers(dest="command", metavar="COMMAND")
    solving = commands.add_parser(
        "solve", help="solve a scene in a TOML file, or in a deck of CalculiX (.inp)", description=solve.__doc__
    )
    solving.add_argument("file", type=Path, help="the scene")
    solving.add_argument("--out", type=Path, metavar="DIR", help="where results go, by default beside the file")
    solving.add_argument("--no-pictures", action="store_true", help="numbers only")
    given = parser.parse_args(arguments)
    if given.command is None:
        print("\n".join(installed()))
        return 0
    return solve(given.file, given.out, pictures=not given.no_pictures)


def solve(file: Path, out: Path | None, *, pictures: bool) -> int:
    """Solve a scene in a file; print how it ended, and write tables, pictures and files for ParaView."""
    from .decks import read_scene
    from .scene_file import SceneFile, SceneFileError, read_scene_file

    try:
        deck = file.suffix.lower() == ".inp"
        solved = (SceneFile(file, read_scene(file)) if deck else read_scene_file(file)).solve()
    except (OSError, SceneFileError) as error:
        print(f"contactdd: {error}", file=sys.stderr)
        return 2
    except (ContactError, TypeError, ValueError) as error:
        print(f"contactdd: {file}: {error}", file=sys.stderr)
        return 1 if isinstance(error, ContactError) else 2
    print(solved)
    folder = out or file.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)
    for path in write(solved, folder, pictures=pictures):
        print(f"  {path}")
    return 0


def write(solved: Solution | LoadPath, folder: Path, *, pictures: bool) -> Iterator[Path]:
    """Write the results into a folder; the paths of the tables and pictures, and of the folder of the fields."""
    from .view.export import file_name

    last = solved.solutions[-1] if isinstance(solved, LoadPath) else solved
    if isinstance(solved, LoadPath):
        yield solved.to_csv(folder / "programme.csv")
    for contact in last.scene.contacts:
        yield last.contact(contact).to_csv(folder / f"{file_name(contact.name)}.csv")
    summary = folder / "summary.json"
    summary.write_text(json.dumps(numbers(last), indent=1) + "\n")
    yield summary
    solved.export(folder / "fields")
    yield folder / "fields"
    if pictures and there("matplotlib"):
        for contact in last.scene.contacts:
            last.plot_contact(contact, path=folder / f"{file_name(contact.name)}.png")
            yield folder / f"{file_name(contact.name)}.png"
    if pictures and there("pyvista") and any(body.mesh is not None for body in last.scene.bodies):
        last.plot_bodies(path=folder / "bodies.png")
        yield folder / "bodies.png"


def numbers(solution: Solution) -> dict[str, Any]:
    """What a solution comes to, contact by contact."""
    contacts = {contact.name: solution.contact(contact) for contact in solution.scene.contacts}
    each = {
        name: {
            "force": found.force,
            "force vector": [float(part) for part in found.force_vector],
            "peak pressure": found.peak_pressure,
            "mean pressure": found.mean_pressure,
            "contact area": found.area,
        }
        for name, found in contacts.items()
    }
    return {"status": solution.status, "iterations": solution.iterations, "imbalance": solution.imbalance} | each


def installed() -> Iterator[str]:
    """The lines that say which versions there are, what else is found, and how to run a demo."""
    import dolfinx
    from mpi4py import MPI
    from petsc4py import PETSc

    version = sys.modules[__package__].__version__
    yield f"contactdd {version} in {Path(__file__).parent}"
    mpi = " ".join(MPI.Get_library_version().splitlines()[0].split(",")[0].split())
    yield f"Python {sys.version.split()[0]}, dolfinx {dolfinx.__version__}, {mpi}"
    petsc = ".".join(map(str, PETSc.Sys.getVersion()))
    packages = [f"{name} {'yes' if has_package(name) else 'no'}" for name in ("mumps", "hypre")]
    yield f"PETSc {petsc}, {', '.join(packages)}"
    for name, use in OPTIONAL.items():
        yield f"{name:12}{found_version(name) or 'not found':14}{use}"
    yield ""
    yield "A demo, in a checkout:     python demos/groove.py --out DIR"
    yield "A scene in a file:         python -m contactdd solve demos/groove.toml"


def has_package(name: str) -> bool:
    """Whether PETSc was built with a package."""
    from petsc4py import PETSc

    return bool(PETSc.Sys.hasExternalPackage(name))


def there(name: str) -> bool:
    """Whether a module can be found, without importing it."""
    return importlib.util.find_spec(name) is not None


def found_version(name: str) -> str | None:
    """The version of a module that can be found."""
    if not there(name):
        return None
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:  # Debian's gmsh has no record of itself
        return str(getattr(importlib.import_module(name), "__version__", "found"))


if __name__ == "__main__":
    sys.exit(main())
