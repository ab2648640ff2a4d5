"""Imports point one way: all of the package's are read from its text, those for types and inside functions too."""

from __future__ import annotations

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "contactdd"

#: Each level imports from those before it and from its own; a name is a file or a folder of the package.
LEVELS = [
    ["base"],
    ["errors", "parameter", "coefficient_value"],
    ["field", "kinematics", "layer", "quadrature", "mesh", "material", "surface_heights"],
    ["piecewise_material", "smoothing"],
    ["layers", "hard_contact"],
    ["files", "shapes"],
    ["body_result", "contact_result", "surface_result"],
    ["view"],
    ["history"],
    ["elements"],
    ["support", "load"],
    ["eigenstrain", "linear_form", "point_force"],
    ["body", "meshless"],
    ["partners"],
    ["contact"],
    ["interface"],
    ["sample", "small_strains"],
    ["local"],
    ["contact_sides", "relaxation"],
    ["hints"],
    ["scene", "scheme"],
    ["decks"],
    ["system"],
    ["iteration"],
    ["saved"],
    ["solution"],
    ["doubts"],
    ["solve"],
    ["error_estimate"],
    ["remeshing"],
    ["adaptation", "dual"],
    ["programme"],
    ["scene_file"],
    ["__main__"],
]
LEVEL = {room: level for level, rooms in enumerate(LEVELS) for room in rooms}
#: Rooms beside the road: what they may import, and nobody but the package's front door imports them.
ASIDE = {"reference": {"base", "layer"}}
#: Imports that point backwards today, by importing module; it must shrink to nothing.
KNOWN: dict[str, set[str]] = {}


def modules() -> dict[str, Path]:
    """Every module of the package by its dotted name, without `contactdd.`; the package itself is ''."""
    found = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


MODULES = modules()


def imported(module: str) -> set[str]:
    """The modules of the package that a module imports, wherever in its text."""
    path, found = MODULES[module], set()
    package = module.split(".") if path.name == "__init__.py" else module.split(".")[:-1]
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names if alias.name.split(".")[0] == "contactdd"]
            found |= {name.removeprefix("contactdd").removeprefix(".") for name in names}
        elif isinstance(node, ast.ImportFrom):
            if node.level == 0 and (node.module or "").split(".")[0] != "contactdd":
                continue
            if node.level == 0:
                start = (node.module or "").split(".")[1:]
            else:
                up = package[: len(package) - node.level + 1]
                start = [part for part in up if part] + (node.module.split(".") if node.module else [])
            for alias in node.names:  # a module of that name, or something in the module that it is taken from
                inner = ".".join([*start, alias.name])
                found.add(inner if inner in MODULES else ".".join(start))
    return found - {module}


IMPORTS = {module: imported(module) for module in MODULES}


def room(module: str) -> str:
    """The file or the folder at the top of the package that a module is in."""
    return module.split(".")[0]


def backwards(module: str) -> set[str]:
    """The imports of a module that do not point to its own level or an earlier one."""
    if module == "":  # the front door hands on the public names
        return set()
    here = room(module)
    if here in ASIDE:
        return {other for other in IMPORTS[module] if room(other) != here and room(other) not in ASIDE[here]}
    mine = LEVEL.get(here, -1)  # a file without a level imports nothing until it has one
    return {other for other in IMPORTS[module] if other == "" or LEVEL.get(room(other), len(LEVELS)) > mine}


def test_every_file_has_its_level():
    """A new file or folder at the top is given its level here; no level names what is not there."""
    there, named = {room(module) for module in MODULES if module}, set(LEVEL) | set(ASIDE)
    assert not there - named, "without a level"
    assert not named - there, "not there any more"


def test_imports_are_read():
    """The reader of imports sees all its kinds: relative, of a module, of a name, for types, inside functions."""
    assert "solve" in IMPORTS[""]
    assert "reference" in IMPORTS[""], "imported for types"
    assert {"base.checks", "scene", "system.ensemble"} <= IMPORTS["solve"]
    assert any(other.startswith("view.") for other in IMPORTS["solution"]), "imported inside functions"
    assert "base" not in IMPORTS["base.ranks"]
    assert sum(map(len, IMPORTS.values())) > 200


@pytest.mark.parametrize("module", [module for module in MODULES if module])
def test_imports_point_one_way(module):
    found = {f"{module} imports {other}" for other in backwards(module) - KNOWN.get(module, set())}
    assert not found, f"the levels are {' <- '.join('/'.join(rooms) for rooms in LEVELS)}"
    gone = KNOWN.get(module, set()) - backwards(module)
    assert not gone, f"KNOWN still lists what is mended: {module} imports {gone}"


def test_no_circle():
    """Between no modules at all; the levels themselves forbid circles of folders."""
    allowed = {m: {o for o in others if o not in KNOWN.get(m, ())} for m, others in IMPORTS.items() if m}
    try:
        tuple(TopologicalSorter(allowed).static_order())
    except CycleError as error:
        pytest.fail("a circle of imports: " + " -> ".join(error.args[1][::-1]))
