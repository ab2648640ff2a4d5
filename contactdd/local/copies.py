"""Bodies that are copies of each other, moved or mirrored, of the same material and held alike: decided here alone.

The condensed stiffness of one is that of the others up to the signs of mirrored components, and so is all that follows
from it: assembly, condensation, contact surfaces.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Any

import numpy as np

from ..base.arrays import Floats
from ..base.isometry import turned
from ..body import Body
from ..load import Pressure
from ..material import Isotropic
from ..parameter import current
from ..support import Fixed, Symmetry


def originals(bodies: Sequence[Any]) -> list[tuple[int, Floats] | None]:
    """The index of the first body that each body copies, with the signs of `signs_between`; None if it is no copy."""
    found: list[tuple[int, Floats] | None] = []
    firsts: dict[Hashable, list[int]] = {}
    for index, body in enumerate(bodies):
        key = _likeness(body) if isinstance(body, Body) else id(body)
        if isinstance(body, Body) and len(bodies) > 2:  # of two there is one pair to compare
            key = key, body.mesh.fingerprint
        alike = firsts.setdefault(key, [])
        pairs = ((first, signs_between(bodies[first], body)) for first in alike)
        found.append(next(((first, signs) for first, signs in pairs if signs is not None), None))
        if found[-1] is None:
            alike.append(index)
    return found


def _likeness(body: Body) -> Hashable:
    """A cheap key that all copies of a body share."""
    mesh, material = body.mesh, body.material
    constants = material if isinstance(material, Isotropic) and not material.varies else id(material)
    cells = mesh.domain.topology.cell_name(), mesh.cells, len(mesh.domain.geometry.x)
    plain = all(isinstance(support, Fixed | Symmetry) for support in body.supports)
    return body.degree, body.kinematics, constants, cells, body.supports if plain else id(body)


def signs_between(original: Body, body: Body) -> Floats | None:
    """Signs (±1 per component) relating the displacements of a copy to its original, (dim,); None if it is no copy.

    Loads may differ. −1 stands where the body is mirrored.
    """
    same = (original.material, original.kinematics) == (body.material, body.kinematics)
    if not same or body.kinematics.axisymmetric or body.material.varies or not _held_alike(original, body):
        return None
    isometry = body.elements.isometry_from(original.elements)
    if isometry is None:
        return None
    unchanged = isinstance(body.material, Isotropic) or _unchanged(body, isometry.signs)
    return isometry.signs if unchanged else None


def loaded_alike(original: Body, body: Body) -> bool:
    """Whether a copy's loads are those of the original, times the signs."""
    even = all(isinstance(load, Pressure) and np.isscalar(current(load.value)) for load in body.loads)
    return even and original.loads == body.loads


def _held_alike(original: Body, body: Body) -> bool:
    """Whether the supports of both hold the same surfaces in a way that a mirror doesn't change."""
    plain = all(isinstance(support, Fixed | Symmetry) for support in body.supports)
    return plain and original.supports == body.supports


def _unchanged(body: Body, signs: Floats) -> bool:
    """Whether a body's stiffness is the same in the mirror."""
    material = body.kinematics.tensor(body.material.stiffness())
    return bool(np.abs(turned(material, signs) - material).max() <= 1e-14 * np.abs(material).max())
