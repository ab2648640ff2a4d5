"""Planes of symmetry that a scene has and does not use: looked for only when asked.

Two bodies of one mesh each, or a body with itself, are mirror images if a reflection takes the nodes of one to those of
the other, and with them the material, the prescribed displacements and the loads. Cells may be cut along other
diagonals: it is the scene that is symmetric, not the mesh.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .base.arrays import Floats, Indices
from .body import Body
from .interface.discretise import Interface
from .material import Isotropic
from .support import Spring

#: Lengths, directions and forces that differ by less than this part of the largest are the same.
SAME = 1e-9


@dataclass(frozen=True)
class _Reflection:
    """The mirror image in the plane through `point` (dim,) across the unit vector `normal` (dim,)."""

    point: Floats
    normal: Floats

    def vectors(self, v: Floats) -> Floats:
        """The images of vectors (..., dim)."""
        return v - 2.0 * (v @ self.normal)[..., None] * self.normal

    def points(self, x: Floats) -> Floats:
        """The images of points (n, dim)."""
        return self.point + self.vectors(x - self.point)


def hints(
    bodies: Sequence[Any], loads: Sequence[Floats], interfaces: Sequence[Interface], sliding: Sequence[Interface] = ()
) -> list[str]:
    """What would make a scene smaller, in words.

    loads: (dofs,) the nodal loads of each body; interfaces: the discretised contacts; sliding: those of their sliding.
    """
    if not all(isinstance(body, Body) and _plain(body) for body in bodies):
        return []
    return _mirror_images(bodies, loads, interfaces) + _cuts(bodies, loads, [*interfaces, *sliding])


def _plain(body: Body) -> bool:
    """Whether a body is of one isotropic material without springs: of others nothing is said."""
    springs = any(isinstance(support, Spring) for support in body.supports)
    return isinstance(body.material, Isotropic) and not body.material.varies and not springs


def _mirror_images(bodies: Sequence[Body], loads: Sequence[Floats], interfaces: Sequence[Interface]) -> list[str]:
    """The hint that two bodies are mirror images of each other."""
    if len(bodies) != 2:
        return []
    (first, second), centres = bodies, [_nodes(body).mean(axis=0) for body in bodies]
    across = centres[1] - centres[0]
    distance = float(np.linalg.norm(across))
    if distance <= SAME * first.mesh.size:
        return []
    mirror = _Reflection(0.5 * (centres[0] + centres[1]), across / distance)
    flat = all(_flat_on(interface, mirror) for interface in interfaces)
    if not flat or not _image(first, loads[0], second, loads[1], mirror):
        return []
    names = f"{first.name!r} and {second.name!r}"
    point, normal = _text(mirror.point), _text(-mirror.normal)
    return [
        f"bodies {names} are mirror images: {first.name!r} alone against cd.MirrorPlane('mirror', {point}, {normal}) "
        "has the same contact, and half of the unknowns"
    ]


def _cuts(bodies: Sequence[Body], loads: Sequence[Floats], interfaces: Sequence[Interface]) -> list[str]:
    """The hints that the whole scene is symmetric about planes across the axes."""
    x, found = np.vstack([_nodes(body) for body in bodies]), []
    middle = 0.5 * (x.min(axis=0) + x.max(axis=0))
    for axis, name in zip(np.eye(len(middle)), "xyz", strict=False):
        if bodies[0].kinematics.axisymmetric and name == "x":
            continue
        mirror = _Reflection(middle, axis)
        whole = all(_image(body, load, body, load, mirror) for body, load in zip(bodies, loads, strict=True))
        if whole and all(_same_contact(interface, mirror) for interface in interfaces):
            at = _number(float(axis @ middle))
            found.append(
                f"the scene is symmetric about {name} = {at}: one half of each body, with cd.Symmetry on its cut, has "
                "the same solution, and half of the unknowns"
            )
    return found


def _image(first: Body, load: Floats, second: Body, other: Floats, mirror: _Reflection) -> bool:
    """Whether the second body is the first's mirror image, its supports and loads too."""
    alike = (first.material, first.kinematics, first.degree) == (second.material, second.kinematics, second.degree)
    if not alike or first.dofs != second.dofs:
        return False
    order = _places(mirror.points(_nodes(first)), _nodes(second), first.mesh.size)
    if order is None:
        return False
    (values, ways), (others, their_ways) = _held(first), _held(second)
    forces, their_forces = load.reshape(-1, first.mesh.dim), other.reshape(-1, first.mesh.dim)
    turned = np.swapaxes(mirror.vectors(np.swapaxes(mirror.vectors(ways), 1, 2)), 1, 2)
    pairs = ((mirror.vectors(values), others), (turned, their_ways), (mirror.vectors(forces), their_forces))
    return all(_same(here, there[order]) for here, there in pairs)


def _held(body: Body) -> tuple[Floats, Floats]:
    """What holds every node: Σ n value (nodes, dim) and Σ n ⊗ n (nodes, dim, dim) over its conditions."""
    dim, count = body.mesh.dim, len(_nodes(body))
    values, ways = np.zeros((count, dim)), np.zeros((count, dim, dim))
    for support in body.supports:
        for nodes, direction, value in support.conditions(body.elements):
            values[nodes] += value[:, None] * direction
            ways[nodes] += np.outer(direction, direction)
    return values, ways


def _same_contact(interface: Interface, mirror: _Reflection) -> bool:
    """Whether a contact is its own mirror image: its points, its gaps and its law."""
    size = float(np.ptp(interface.x, axis=0).max())
    order = _places(mirror.points(interface.x), interface.x, size)
    if order is None:
        return False
    answers = [interface.layer.contact_stress(np.full(len(interface.weights), z)) for z in (-1e-4 * size, 1e-4 * size)]
    return all(_same(values, values[order]) for values in (interface.gap, interface.weights, *answers))


def _flat_on(interface: Interface, mirror: _Reflection) -> bool:
    """Whether a contact faces a plane of reflection everywhere."""
    return bool(np.abs(np.abs(interface.normal @ mirror.normal) - 1.0).max() < SAME)


def _places(x: Floats, among: Floats, size: float) -> Indices | None:
    """Which of some points lies at each of the points x, (n,); None if they are not the same."""
    from scipy.spatial import cKDTree

    distance, order = cKDTree(among).query(x)
    return order if distance.max() <= SAME * size and len(np.unique(order)) == len(x) else None


def _same(here: Floats, there: Floats) -> bool:
    return bool(np.abs(here - there).max(initial=0.0) <= SAME * np.abs(here).max(initial=0.0))


def _nodes(body: Body) -> Floats:
    """The nodes of a body's displacement, (nodes, dim)."""
    return body.space.tabulate_dof_coordinates()[:, : body.mesh.dim]


def _number(value: float) -> str:
    return f"{value:.6g}" if abs(value) > 1e-12 else "0"


def _text(vector: Floats) -> str:
    return f"({', '.join(_number(float(v)) for v in vector)})"
