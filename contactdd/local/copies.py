"""Bodies that are copies of each other: on moved or mirrored copies of one mesh, of the same material, held alike.

What one of them is eliminated to, the others are too, but for the signs of the mirrored components.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..base.arrays import Floats
from ..base.isometry import turned
from ..body import Body
from ..load import Pressure
from ..material import Isotropic
from ..parameter import current
from ..support import Fixed, Symmetry


def originals(bodies: Sequence[Body]) -> list[tuple[int, Floats] | None]:
    """Of every body the place of the first one that it is a copy of, with the signs of `signs_between`, or None."""
    found: list[tuple[int, Floats] | None] = []
    firsts: dict[int, list[int]] = {}
    for place, body in enumerate(bodies):
        alike = firsts.setdefault(id(body.mesh.surfaces), [])
        pairs = ((first, signs_between(bodies[first], body)) for first in alike)
        found.append(next(((first, signs) for first, signs in pairs if signs is not None), None))
        if found[-1] is None:
            alike.append(place)
    return found


def signs_between(original: Body, body: Body) -> Floats | None:
    """The ±1 by which the components of the one's displacements, numbered alike, are the other's; None for no copies.

    Loads may differ. Shape (dim,): −1 where the body is mirrored.
    """
    isometry = body.mesh.isometry_from(original.mesh)
    if isometry is None:
        return None
    same = (original.degree, original.kinematics, original.material) == (body.degree, body.kinematics, body.material)
    if not same or body.kinematics.ring or body.material.varies or not _held_alike(original, body):
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
