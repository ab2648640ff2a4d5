"""Meshes and named groups from gmsh: from its model, its .msh files and its .geo scripts."""

from __future__ import annotations

import hashlib
import json
import os
import re
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from ..base.arrays import Integers
from ..base.checks import finite, listed
from ..mesh import Mesh
from .contents import Block, Contents, in_order, merged
from .kinds import Kind

#: Blank scripts with which the words kept by gmsh's parser are cleared: a refused script leaves a few buffers of them.
ATTEMPTS = 100


def from_gmsh(model: Any, dim: int | None = None, *, body: str | None = None) -> Mesh:
    """The mesh of the current gmsh model, its surfaces named by the physical groups of dimension `dim` - 1.

    The model is only read: several bodies can be taken from one. A group without a name is named by its number ("101").
    A facet in several groups belongs to each surface. A group between two bodies is a surface of each; one inside the
    body is kept out of the way, and refused when it is asked for.

    Args:
        model: `gmsh.model`, with a mesh.
        dim: 2 or 3; by default 3 if the model has solid cells.
        body: The physical group of dimension `dim` to take where the model has several; by default all cells in groups,
            or all cells if none is in a group.

    Raises:
        ValueError: There are no cells or no such group; the cells are of several kinds, or of one that cannot be
            computed with; a group has facets that belong to no cell.
    """
    return contents(model, dim, "the gmsh model").mesh(body)


def contents(model: Any, dim: int | None, source: str) -> Contents:
    """The nodes, cells and groups of the current gmsh model."""
    if dim is None:
        dim = 3 if len(model.mesh.getElements(3)[0]) else 2
    if dim not in (2, 3):
        raise ValueError(f"dim = {dim!r}: expected 2 or 3")
    numbers, x, _ = model.mesh.getNodes()
    blocks = [Block(*each) for each in _elements(model, dim)]
    if dim == 2 and not blocks and len(model.mesh.getElements(3)[0]):
        raise ValueError(f"dim = 2: {source} has solid cells only; expected 3")
    bodies = merged((name, _joined(_tags(model, dim, group))) for name, group in _groups(model, dim))
    surfaces: dict[str, list[Integers]] = {}
    for name, group in _groups(model, dim - 1):
        surfaces.setdefault(name, []).extend(_corners(model, dim - 1, group))
    return Contents(source, dim, *in_order(source, numbers, x.reshape(-1, 3)), blocks, bodies, False, surfaces)


def _groups(model: Any, dim: int) -> Iterator[tuple[str, int]]:
    """The name and number of each physical group of a dimension."""
    for _, number in model.getPhysicalGroups(dim):
        yield model.getPhysicalName(dim, number).strip() or str(number), number


def _elements(model: Any, dim: int, entity: int = -1) -> Iterator[tuple[Kind, Integers, Integers]]:
    """Kind, numbers and nodes (n, nodes) of the elements of an entity, or of all."""
    for number, tags, nodes in zip(*model.mesh.getElements(dim, entity), strict=True):
        name, _, _, count, *_ = model.mesh.getElementProperties(number)
        shape = name.split()[0].lower()
        kind = Kind("interval" if shape == "line" else shape, count)
        yield kind, np.asarray(tags, dtype=np.int64), np.asarray(nodes, dtype=np.int64).reshape(-1, count)


def _tags(model: Any, dim: int, group: int) -> Iterator[Integers]:
    """The numbers of the elements in a physical group."""
    for entity in model.getEntitiesForPhysicalGroup(dim, group):
        yield from (np.asarray(tags, dtype=np.int64) for tags in model.mesh.getElements(dim, int(entity))[1])


def _corners(model: Any, dim: int, group: int) -> Iterator[Integers]:
    """The corner nodes (n, corners) of the elements in a physical group, kind by kind."""
    for entity in model.getEntitiesForPhysicalGroup(dim, group):
        for kind, _, nodes in _elements(model, dim, int(entity)):
            yield nodes[:, : kind.corners]


def _joined(parts: Iterator[Integers]) -> Integers:
    return np.concatenate([np.zeros(0, dtype=np.int64), *parts])


# ------------------------------------------------------------------------------------------------------- files


def read(path: Path, dim: int | None, script: bool, order: int, parameters: Mapping[str, float]) -> Contents:
    """The nodes, cells and groups of a .msh file or a .geo script."""
    if not script and (parameters or order != 1):
        raise ValueError(f"path = {str(path)!r}: parameters and order are for .geo scripts; a .msh file has its own")
    import gmsh

    source = f"path = {str(path)!r}: the file"
    if not script:
        check_physical_names(source, path.read_bytes().decode("latin-1"))
    with _session(gmsh) as own:
        if script and not own:  # with options of the user's that may change the mesh: none for the cache
            with _run(gmsh, path, dim, order, parameters, own):
                return contents(gmsh.model, dim, source)
        with _opened(gmsh, _cached(gmsh, path, dim, order, parameters) if script else path, own):
            return contents(gmsh.model, dim, source)


def check_physical_names(source: str, text: str) -> None:
    """Refuse physical names of a dimension that does not exist, with which gmsh ends the interpreter.

    text: a .msh file, in which these names are readable in the binary form too.
    """
    for section in re.findall(r"\$PhysicalNames\s+\d+(.*?)\$EndPhysicalNames", text, re.DOTALL):
        for dim, name in re.findall(r"^\s*(-?\d+)\s+-?\d+\s*(.*?)\s*$", section, re.MULTILINE):
            if not 0 <= int(dim) <= 3:
                raise ValueError(f"{source} has the physical name {name} of the dimension {dim}; expected 0 to 3")


def meshed(path: Path, size: float, order: int, kind: str) -> Contents:
    """The mesh of the inside of a geometry, its cells of a size; kind: "STEP file", or "STL file" of a surface."""
    import gmsh

    with _session(gmsh) as own, _opened(gmsh, path, own), _sizes(gmsh, size):
        try:
            if kind == "STL file":
                _fill(gmsh)
            dim = gmsh.model.getDimension()
            if dim < 2:
                raise ValueError("there is nothing to be meshed in it")
            gmsh.model.mesh.generate(dim)
            gmsh.model.mesh.setOrder(order)
        except Exception as error:
            raise ValueError(f"path = {str(path)!r}: gmsh cannot mesh it: {error}") from None
        return contents(gmsh.model, dim, f"path = {str(path)!r}: the file")


def _fill(gmsh: Any) -> None:
    """Make a volume of the current model's triangles, its faces divided where they meet at more than 40°."""
    gmsh.model.mesh.removeDuplicateNodes()
    corners = np.concatenate([nodes for _, _, nodes in _elements(gmsh.model, 2)] or [np.zeros((0, 3), dtype=np.int64)])
    edges = np.sort(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]), axis=1)
    counts = np.unique(edges, axis=0, return_counts=True)[1]
    if np.any(counts != 2) or len(counts) == 0:
        raise ValueError(f"{int(np.sum(counts != 2))} edges have not two triangles; expected a closed surface")
    gmsh.model.mesh.classifySurfaces(np.deg2rad(40.0), True, True, np.pi)
    gmsh.model.mesh.createGeometry()
    surfaces = [tag for _, tag in gmsh.model.getEntities(2)]
    gmsh.model.geo.addVolume([gmsh.model.geo.addSurfaceLoop(surfaces)])
    gmsh.model.geo.synchronize()


@contextmanager
def _sizes(gmsh: Any, size: float) -> Iterator[None]:
    """A size of cells everywhere, the user's options set back afterwards."""
    wanted = {"MeshSizeMin": size, "MeshSizeMax": size, "MeshSizeFromPoints": 0, "MeshSizeExtendFromBoundary": 0}
    before = {name: gmsh.option.getNumber(f"Mesh.{name}") for name in wanted}
    for name, value in wanted.items():
        gmsh.option.setNumber(f"Mesh.{name}", value)
    try:
        yield
    finally:
        for name, value in before.items():
            gmsh.option.setNumber(f"Mesh.{name}", value)


def mesh_cache() -> Path:
    """The folder of the meshes made from scripts: contactdd/meshes in $XDG_CACHE_HOME or ~/.cache."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "contactdd" / "meshes"


@contextmanager
def _session(gmsh: Any) -> Iterator[bool]:
    """gmsh, started for a while; False where the user has started it, whose models and options stay as they are."""
    own = not gmsh.isInitialized()
    if own:
        _start(gmsh)
        try:
            yield own
        finally:
            gmsh.finalize()
        return
    current, names = gmsh.model.getCurrent(), gmsh.parser.getNames()
    variables = [(name, gmsh.parser.getNumber(name), gmsh.parser.getString(name)) for name in names]
    try:
        yield own
    finally:
        gmsh.model.setCurrent(current)
        gmsh.parser.clear()
        for name, numbers, texts in variables:
            if len(texts):
                gmsh.parser.setString(name, texts)
            else:
                gmsh.parser.setNumber(name, numbers)


def _start(gmsh: Any) -> None:
    gmsh.initialize(["contactdd", "-v", "1"], interruptible=False)
    gmsh.option.setNumber("Mesh.SaveAll", 1)  # also what is in no group


@contextmanager
def _opened(gmsh: Any, path: Path, own: bool) -> Iterator[None]:
    """A file as the current model, which is taken away afterwards."""
    _open(gmsh, path, own)
    try:
        yield
    finally:
        gmsh.model.remove()


def _open(gmsh: Any, path: Path, own: bool) -> None:
    """Open a file; ValueError with gmsh's words if it cannot."""
    try:
        try:
            _load(gmsh, path)
        except Exception:
            if path.suffix != ".geo" or not own:
                raise
            # Its parser keeps words of a script that it refused before, and takes them for the start of this one.
            _forget(gmsh)
            _load(gmsh, path)
    except Exception as error:
        if own:
            _forget(gmsh)
        raise ValueError(f"path = {str(path)!r}: gmsh cannot read it: {error}") from None


def _load(gmsh: Any, path: Path) -> None:
    """A file as a new model: `gmsh.open`, when it has failed once, does nothing any more in the user's session."""
    gmsh.model.add(path.stem)
    gmsh.parser.clear()  # else a script keeps the numbers that it, or another, had when it was read before
    try:
        gmsh.merge(str(path))
    except Exception:
        gmsh.model.remove()
        raise


def _forget(gmsh: Any) -> None:
    """Throw away the words that the parser keeps, by blank scripts until one is taken."""
    with tempfile.TemporaryDirectory() as folder:
        blank = Path(folder, "blank.geo")
        blank.write_text("\n")
        for _ in range(ATTEMPTS):
            gmsh.finalize()
            gmsh.initialize(["contactdd", "-v", "0"], interruptible=False)
            try:
                gmsh.open(str(blank))
                break
            except Exception:
                continue
        gmsh.finalize()
        _start(gmsh)


def _cached(gmsh: Any, script: Path, dim: int | None, order: int, parameters: Mapping[str, float]) -> Path:
    """The .msh file of a script, from the cache or made now."""
    text = _text(script)
    values = {name: finite(name, value) for name, value in sorted(parameters.items())}
    recipe = json.dumps(["all cells", text, values, dim, order, gmsh.__version__, *_named_files(script, text)])
    target = mesh_cache() / f"{script.stem}-{hashlib.sha256(recipe.encode()).hexdigest()[:16]}.msh"
    if not target.is_file():
        with _run(gmsh, script, dim, order, values, True):
            target.parent.mkdir(parents=True, exist_ok=True)
            # Written aside and moved, so that a run that is interrupted or runs beside another leaves no half file.
            unfinished = target.with_name(f"{os.getpid()}-{target.name}")
            gmsh.write(str(unfinished))
            unfinished.replace(target)
    return target


@contextmanager
def _run(
    gmsh: Any, script: Path, dim: int | None, order: int, parameters: Mapping[str, float], own: bool
) -> Iterator[None]:
    """The mesh of a script as the current model."""
    _text(script)
    with _opened(gmsh, script, own):
        known = [name.removeprefix("Parameters/") for name in gmsh.onelab.getNames("Parameters/.*")]
    for name, value in parameters.items():
        if name not in known:
            raise ValueError(f"{name} = {value!r}: {script.name} has no such parameter (it has {listed(known)})")
        gmsh.onelab.setNumber(f"Parameters/{name}", [finite(name, value)])
    try:
        with _opened(gmsh, script, own):
            gmsh.model.mesh.generate(gmsh.model.getDimension() if dim is None else dim)
            gmsh.model.mesh.setOrder(order)
            yield
    finally:
        for name in parameters:
            gmsh.onelab.clear(f"Parameters/{name}")


def _text(script: Path) -> str:
    """The text of a script, also where a comment is in an old encoding."""
    content = script.read_bytes()
    if not content.endswith(b"\n"):
        raise ValueError(
            f"path = {str(script)!r}: expected a line break at the end, without which gmsh cuts the last line"
        )
    try:
        return content.decode()
    except UnicodeDecodeError:
        return content.decode("latin-1")


def _named_files(script: Path, text: str) -> list[str]:
    """A digest of every file that a script names, so that a mesh is made anew when one of them changes."""
    named = sorted({script.parent / name for name in re.findall(r'"([^"\n]+)"', text)})
    return [hashlib.sha256(file.read_bytes()).hexdigest() for file in named if file.is_file()]
