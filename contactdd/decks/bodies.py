"""The bodies of a deck: cells that share nodes, with their materials, supports and loads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy
from dolfinx import fem

from ..base.arrays import Floats, Integers
from ..body import Body
from ..eigenstrain import ThermalStrain
from ..files.contents import Contents
from ..files.deck import Card, side
from ..files.kinds import SERENDIPITY, Kind
from ..files.simplices import simplex_of
from ..load import BodyForce, Pressure
from ..material import Material
from ..mesh import Mesh
from ..point_force import PointForce
from ..support import PointDisplacement
from .model import Model, Section

#: The kinematics of elements by the beginning of their type.
KINEMATICS = {"CPE": "plane strain", "CPS": "plane stress", "CAX": "axisymmetric", "C3D": "solid"}


@dataclass(frozen=True)
class Part:
    """A part of a deck's mesh that shares no node with the others.

    elements: their numbers; nodes: the numbers of all their nodes, sorted; kind: of all cells, or of the
    largest where they are cut into one kind; name: of the body.
    """

    elements: Integers
    nodes: Integers
    kind: Kind
    name: str

    @cached_property
    def members(self) -> set[int]:
        """The numbers of the nodes."""
        return {int(node) for node in self.nodes}


def parts_of(model: Model, contents: Contents) -> list[Part]:
    """The parts of a deck's mesh, in the order of their first elements."""
    rows = [
        (number, nodes, block.kind)
        for block in contents.blocks
        for number, nodes in zip(block.numbers, block.nodes, strict=True)
    ]
    element = np.repeat(np.arange(len(rows)), [len(nodes) for _, nodes, _ in rows])
    node = np.searchsorted(contents.numbers, np.concatenate([nodes for _, nodes, _ in rows]))
    shape = (len(rows), len(contents.numbers))
    touches = scipy.sparse.csr_matrix((np.ones(len(node)), (element, node)), shape=shape)
    _, label = scipy.sparse.csgraph.connected_components(touches @ touches.T, directed=False)
    found: list[Part] = []
    for place in np.unique(label):
        ours = [rows[i] for i in np.flatnonzero(label == place)]
        elements = np.sort(np.array([number for number, _, _ in ours]))
        nodes = np.unique(np.concatenate([nodes for _, nodes, _ in ours]))
        kinds = {kind for _, _, kind in ours}
        if len(kinds) > 1 and simplex_of(kinds) is None:
            raise ValueError(
                f"{contents.source} has a body of {' and '.join(sorted(map(str, kinds)))}; expected one kind"
            )
        taken = {part.name for part in found}
        found.append(
            Part(elements, nodes, max(kinds, key=lambda kind: kind.nodes), _name(model, contents, elements, taken))
        )
    return sorted(found, key=lambda part: int(part.elements[0]))


def _name(model: Model, contents: Contents, elements: Integers, taken: set[str]) -> str:
    """The name of the set of these elements and no others, else a number."""
    for name, members in contents.bodies.items():
        if name not in taken and np.array_equal(members, elements):
            return name
    for section in model.sections:
        ours = np.isin(model.elements(section.elset), elements)
        if section.elset not in taken and np.any(ours) and np.all(ours):
            return section.elset
    return f"BODY-{len(taken) + 1}"


def body_of(model: Model, contents: Contents, part: Part, types: Mapping[int, str]) -> Body:
    """A part as a body."""
    sections = _sections(model, part)
    kinematics = _kinematics(model, part, types)
    mesh = _mesh(model, contents, part)
    material: Any = _material(model, sections[0])
    if len(sections) > 1:
        material = {section.elset: _material(model, section) for section in sections}
    return Body(
        part.name,
        mesh,
        material,
        supports=_supports(model, contents, part, mesh),
        loads=_loads(model, contents, part, mesh, sections, kinematics),
        degree=1 if part.kind.nodes == part.kind.corners else 2,
        kinematics=kinematics,
    )


def _sections(model: Model, part: Part) -> list[Section]:
    """The sections of a part, one where all have the same material."""
    found = [each for each in model.sections if np.any(np.isin(model.elements(each.elset), part.elements))]
    covered = [model.elements(section.elset) for section in found]
    bare = np.setdiff1d(part.elements, np.concatenate([np.zeros(0, dtype=np.int64), *covered]))
    if len(bare):
        raise ValueError(
            f"{model.deck.source}: {len(bare)} of the {len(part.elements)} elements of {part.name!r}, one of them "
            f"{bare[0]}, have no *SOLID SECTION"
        )
    return found if len({section.material for section in found}) > 1 else found[:1]


def _material(model: Model, section: Section) -> Material:
    if section.material not in model.materials:
        raise ValueError(f"{model.deck.source} has no elastic material {section.material!r}")
    return model.materials[section.material]


def _kinematics(model: Model, part: Part, types: Mapping[int, str]) -> str:
    kinds = {next((k for start, k in KINEMATICS.items() if types[int(e)].startswith(start)), "") for e in part.elements}
    if len(kinds) != 1 or "" in kinds:
        raise ValueError(f"{model.deck.source}: the elements of {part.name!r} are of several types, or none known here")
    return kinds.pop()


def _mesh(model: Model, contents: Contents, part: Part) -> Mesh:
    """The mesh, each pressure's faces a surface of their own."""
    surfaces = dict(contents.surfaces)
    for value, faces in _pressures(model, part).items():
        rows = [_face(model, contents, number, label) for number, label in faces]
        counts = {len(row) for row in rows}
        surfaces[_pressed(value)] = [np.array([row for row in rows if len(row) == count]) for count in counts]
    bodies = {**contents.bodies, part.name: part.elements}
    return replace(contents, bodies=bodies, surfaces=surfaces).mesh(part.name)


def _pressed(value: float) -> str:
    return f"pressure {value!r}"  # all digits: each value has a surface of its own


def _pressures(model: Model, part: Part) -> dict[float, list[tuple[int, str]]]:
    """The faces on which each pressure acts."""
    found: dict[float, list[tuple[int, str]]] = {}
    ours = {int(element) for element in part.elements}
    for (element, face), value in model.pressures.items():
        if element in ours and value != 0.0:
            found.setdefault(value, []).append((element, face))
    return found


def _face(model: Model, contents: Contents, number: int, label: str) -> Integers:
    """The corner nodes of a face of an element."""
    for block in contents.blocks:
        row = np.flatnonzero(block.numbers == number)
        if len(row):
            return block.nodes[row[0], side(model.deck, "DLOAD", label, block.kind)]
    raise ValueError(f"{model.deck.source} has a load on the element {number}, which is not there")


def _points(contents: Contents, nodes: Sequence[int] | Integers, dim: int) -> Floats:
    return contents.x[np.searchsorted(contents.numbers, nodes), :dim]


def _thickness(model: Model, section: Section, kinematics: str) -> float:
    """The thickness of plane bodies, which has to be the same of all: bodies here are one unit thick."""
    if kinematics in ("solid", "axisymmetric"):
        return 1.0
    if len({each.thickness for each in model.sections}) > 1:
        model.not_understood("SOLIDSECTION of several thicknesses")
    return section.thickness


def _supports(model: Model, contents: Contents, part: Part, mesh: Mesh) -> list[PointDisplacement]:
    """The held nodes, one support for each direction and value."""
    held: dict[tuple[int, float], list[int]] = {}
    ours = part.members
    for (node, direction), value in model.boundaries.items():
        if node not in ours:
            continue
        if direction > mesh.dim:
            if value != 0.0:
                model.not_understood(f"BOUNDARY of direction {direction}")
            continue
        held.setdefault((direction, value), []).append(node)
    for direction in range(1, mesh.dim + 1):
        values = [value for each, value in held if each == direction and len(held[each, value]) > 1]
        if len(values) > 1 and part.kind in SERENDIPITY:
            model.not_understood(f"BOUNDARY whose values differ from node to node of {part.kind}")
    return [
        PointDisplacement(
            _points(contents, nodes, mesh.dim),
            [value if axis == direction - 1 else None for axis in range(mesh.dim)],
        )
        for (direction, value), nodes in held.items()
    ]


def _loads(
    model: Model,
    contents: Contents,
    part: Part,
    mesh: Mesh,
    sections: Sequence[Section],
    kinematics: str,
) -> list[Any]:
    loads: list[Any] = [Pressure(_pressed(value), value) for value in _pressures(model, part)]
    thickness = _thickness(model, sections[0], kinematics)
    forces: dict[int, Floats] = {}
    ours = part.members
    for (node, direction), value in model.forces.items():
        if node in ours and value != 0.0:
            if direction > mesh.dim or kinematics == "axisymmetric":
                model.not_understood(f"CLOAD of direction {direction} on {kinematics} elements")
                continue
            forces.setdefault(node, np.zeros(mesh.dim))[direction - 1] = value / thickness
    if forces:
        loads.append(PointForce(_points(contents, list(forces), mesh.dim), np.array(list(forces.values()))))
    loads += _weights(model, part, mesh, sections)
    return loads + _heat(model, contents, part, mesh, sections)


def _weights(model: Model, part: Part, mesh: Mesh, sections: Sequence[Section]) -> list[BodyForce]:
    found = []
    for name, acceleration in model.gravity.items():
        if np.any(np.isin(model.elements(name), part.elements)):
            if len(sections) > 1 or not np.all(np.isin(part.elements, model.elements(name))):
                model.not_understood("DLOAD GRAV on a part of a body, or on one of several materials")
            density = model.densities.get(sections[0].material)
            if density is None:
                raise ValueError(f"{model.deck.source}: the material {sections[0].material!r} has no *DENSITY")
            found.append(BodyForce(tuple(density * acceleration[: mesh.dim])))
    return found


def _heat(model: Model, contents: Contents, part: Part, mesh: Mesh, sections: Sequence[Section]) -> list[ThermalStrain]:
    """The thermal strain of a part that is warmer or colder than at first."""
    initial = np.array([model.initial.get(int(node), 0.0) for node in part.nodes])
    rise = np.array([model.temperature.get(int(node), first) for node, first in zip(part.nodes, initial, strict=True)])
    rise -= initial
    if not np.any(rise):
        return []
    if len(sections) > 1:
        model.not_understood("TEMPERATURE of a body of several materials")
    alpha = model.expansions.get(sections[0].material)
    if alpha is None:
        raise ValueError(f"{model.deck.source}: the material {sections[0].material!r} has no *EXPANSION")
    if np.all(rise == rise[0]):
        return [ThermalStrain(alpha, float(rise[0]))]
    field = fem.Function(fem.functionspace(mesh.domain, ("Lagrange", 1)))
    tree = scipy.spatial.cKDTree(_points(contents, part.nodes, mesh.dim))
    field.x.array[:] = rise[tree.query(field.function_space.tabulate_dof_coordinates()[:, : mesh.dim])[1]]
    return [ThermalStrain(alpha, field)]


def types_of(cards: Sequence[Card]) -> dict[int, str]:
    """The type of each element by its number."""
    found: dict[int, str] = {}
    for card in cards:
        if card.keyword == "ELEMENT":
            for line in card.lines:
                first = line.split(",")[0].strip()
                if first.isdigit():
                    found.setdefault(int(first), card.parameters.get("TYPE", ""))
    return found
