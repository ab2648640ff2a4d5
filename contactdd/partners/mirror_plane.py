"""Mirror planes: one half of a scene that is symmetric about the contact between two equal bodies."""

from __future__ import annotations

from numpy.typing import ArrayLike

from ..shapes.plane import Plane
from .rigid_body import RigidBody


class MirrorPlane(RigidBody):
    """The plane between a body and its mirror image, in place of the image.

    The contact is that between both bodies: its layer and its given gap are those of the whole, of which half lies on
    this side. Pressures and forces are those of both bodies. Gaps, compressions and energies of the result are those of
    one half, up to the plane. The body is not held by it otherwise than by the contact.

    Args:
        name: Unique in a scene.
        point: (dim,) any point of the plane (length).
        normal: (dim,) across it, towards the body.
        kinematics: As of `Body`; by default "plane strain" or "solid".

    Raises:
        TypeError, ValueError: An argument is none of these.

    Example:
        >>> MirrorPlane("mirror", (0, 1), (0, -1))
        MirrorPlane('mirror', plane strain)
    """

    mirrors = True

    def __init__(self, name: str, point: ArrayLike, normal: ArrayLike, *, kinematics: str | None = None) -> None:
        super().__init__(name, Plane(point, normal), kinematics=kinematics)

    def __repr__(self) -> str:
        return f"MirrorPlane({self.name!r}, {self.kinematics.name})"
