"""Sliding along a bond: for each axis across its normal an interface of its own, whose gap is minus the slip along it.

The tangential jump s = (u_α − u_β)_t of a bond with the shear stiffness k_t adds ½ ∫ k_t |s|² to the energy. Along an
axis t at each point that is ½ ∫ k_t (u_α·t + u_β·(−t))², of the same form as a linear layer's energy of the normal
approach u_αn + u_βn. So all that decomposes and solves a contact decomposes and solves its sliding: φ_t = k_t.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy

from ..base.arrays import Floats
from ..contact import Contact
from .discretise import Interface, InterfaceSide, PrescribedGap
from .overlap import axes_across
from .surface import ContactSurface, PointSurface

#: Parts of a direction below this are rounding, and must not make unknowns of what a surface does not move along.
NOTHING = 1e-14


def sliding_interfaces(interface: Interface, index: int) -> list[Interface]:
    """The interfaces of a contact's sliding, one for each axis across its normal; none where nothing resists it.

    index: the contact's in the scene.
    """
    contact = interface.contact.sliding
    if contact is None:
        return []
    axes = np.swapaxes(axes_across(interface.normal), 0, 1)
    return [_along(interface, contact, index, across, directions) for across, directions in enumerate(axes)]


def _along(interface: Interface, contact: Contact, index: int, across: int, directions: Floats) -> Interface:
    """The interface of the sliding along directions (n, dim), the tangent of that number at each point."""
    nothing = np.zeros(len(interface.weights))
    first, second = interface.sides
    return replace(
        interface,
        contact=contact,
        normal=directions,
        geometric_gap=nothing,
        prescribed_gap=nothing,
        prescription=PrescribedGap(interface.x, None),
        sides=(_side(first, directions, across), _side(second, -directions, across)),
        doubt=None,
        slides=index,
    )


def _side(side: InterfaceSide, directions: Floats, across: int) -> InterfaceSide:
    """A body's side of sliding along directions (n, dim)."""
    trace = sum(
        scipy.sparse.diags(np.where(np.abs(part) > NOTHING, part, 0.0)) @ side.along(axis)
        for part, axis in zip(directions.T, np.eye(directions.shape[1]), strict=True)
    ).tocsr()
    trace.eliminate_zeros()
    surface = side.surface
    if isinstance(surface, ContactSurface):
        return replace(side, surface=surface.sliding(across), trace=trace)
    return replace(side, surface=PointSurface(surface.weights, trace, surface.surface), trace=trace)


def slip(sliding: list[tuple[Interface, Floats]]) -> tuple[Floats, Floats]:
    """The slip of the first surface past the second (n, dim) (length), and the traction on it (n, dim) (stress).

    sliding: the interfaces of one contact's sliding with their gaps.
    """
    slips = sum(-gaps[:, None] * interface.normal for interface, gaps in sliding)
    tractions = sum(interface.layer.contact_stress(gaps)[:, None] * interface.normal for interface, gaps in sliding)
    return np.asarray(slips), np.asarray(tractions)
