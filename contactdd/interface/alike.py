"""The interfaces of many contacts: of those that are copies of each other, moved, one is found and the others follow.

Whatever the bodies are made of, whatever holds and loads them, and however wide the gap is that the user prescribes:
points, weights, normals and traces are the geometry of two meshes.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import replace

import numpy as np

from ..base.isometry import ROUNDING, Isometry, rounded
from ..body import Body
from ..contact import Contact
from ..quadrature import RULES
from .discretise import Interface, InterfaceSide, discretise

#: The indices of a contact's bodies in the scene.
Places = tuple[int, int]


def discretise_all(contacts: Sequence[Contact], places: Sequence[Places]) -> list[Interface]:
    """The interfaces of contacts, in order."""
    if len(contacts) == 1:
        return [discretise(contacts[0], places[0])]
    found: list[Interface] = []
    firsts: dict[Hashable, list[Interface]] = {}
    for contact, bodies in zip(contacts, places, strict=True):
        alike = firsts.setdefault(_likeness(contact), [])
        copies = (_copied(first, contact, bodies) for first in alike)
        interface = next((copy for copy in copies if copy is not None), None)
        if interface is None:
            interface = discretise(contact, bodies)
            alike.append(interface)
        found.append(interface)
    return found


def _likeness(contact: Contact) -> Hashable:
    """A key that all copies of a contact share; one of its own where there are none.

    Values at nodes are those of the softer body, which no geometry tells; a ring that is moved is another ring.
    """
    (first, _), (second, _) = contact.sides
    for body in (first, second):
        if body.mesh is None or body.kinematics.axisymmetric or RULES[contact.quadrature].of_nodes:
            return object()
    sides = [
        (body.mesh.fingerprint, body.degree, body.kinematics, body.mesh.entities(surface).tobytes())
        for body, surface in contact.sides
    ]
    settings = contact.quadrature, contact.quadrature_degree, contact.measure_gap, contact.search_distance
    between = rounded(_corner(second) - _corner(first), first.mesh.size)
    return (*settings, callable(contact.gap), *sides, between)


def _corner(body: Body) -> np.ndarray:
    """The first node of a body, (dim,)."""
    return np.asarray(body.mesh.domain.geometry.x[0, : body.mesh.dim])


def _copied(first: Interface, contact: Contact, places: Places) -> Interface | None:
    """The interface of a contact whose bodies are those of another one, moved alike; None if they are not."""
    pairs = [(side.meshed.body, body) for side, (body, _) in zip(first.sides, contact.sides, strict=True)]
    moves = [body.elements.nodes_isometry_from(original.elements) for original, body in pairs]
    largest = max(float(np.abs(_corner(body)).max()) + body.mesh.size for pair in pairs for body in pair)
    move = _translation(moves, 2.0 * ROUNDING * largest)
    if move is None:
        return None
    given = replace(first.prescription, points=move(first.prescription.points))
    return replace(
        first,
        contact=contact.frozen(),
        x=move(first.x),
        prescribed_gap=given.at(contact.gap),
        prescription=given,
        sides=(_moved(first, 0, contact, places, move), _moved(first, 1, contact, places, move)),
    )


def _translation(moves: Sequence[Isometry | None], rounding: float) -> Isometry | None:
    """The first of two moves if both are the same translation, to rounding."""
    one, other = moves
    if one is None or other is None or one.mirrors or other.mirrors:
        return None
    return one if np.abs(one.offset - other.offset).max() <= rounding else None


def _moved(first: Interface, index: int, contact: Contact, places: Places, move: Isometry) -> InterfaceSide:
    """One side of a contact as that of the one it copies."""
    side, (body, surface) = first.sides[index], contact.sides[index]
    return replace(
        side,
        body=places[index],
        surface=side.meshed.copied(body, surface, move),
        make_transfer=lambda: side.transfer,
    )
