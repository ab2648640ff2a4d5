"""Contact without a layer: p ≥ 0, gap ≥ 0, p · gap = 0.

Such a contact is the limit of ever stiffer layers, but is not solved as one. With a multiplier λ for the pressure at
every node the augmented Lagrangian (Hestenes, Powell, Rockafellar; Alart and Curnier for contact) takes the pressure as

    p = [λ − k z]⁺ = k [s − z]⁺,    s = λ/k,

that is the linear layer k on gaps z less s, whose solution is found as that of any layer; then λ is set to p, until
both agree. Where they do, p > 0 means z = 0 and p = 0 means z ≥ 0, whatever k is: k decides only how fast that is.
"""

from __future__ import annotations

from dataclasses import dataclass

from .base.checks import positive
from .layer import LinearLayer

#: k of the augmented Lagrangian over the stiffness E/h of the bodies' finest facets: each update of the multipliers
#: then leaves a tenth to a hundredth of the penetration, and the linear systems are no worse than with a stiff layer.
PENALTY = 30.0

#: The same for the decomposed methods, whose steps get slower the stiffer the layer is.
DECOMPOSED_PENALTY = 0.3


@dataclass(frozen=True)
class HardContact:
    """Contact without a layer between the surfaces: no penetration and no tension, p ≥ 0, gap ≥ 0, p · gap = 0.

    Given in place of a layer. The pressure is a linear field on the nodes of one surface (`quadrature="mortar"`, which
    such a contact always has), found by an augmented Lagrangian; the weighted gap at each node is zero to a millionth
    of the compression of a layer as stiff as the elements under that pressure. The remaining penetration is in
    `ContactResult.penetration` and in the history's notes. The places of a `PeriodicHalfSpace` are
    held and let go instead, until none overlaps and none pulls.

    Args:
        penalty: The penalty k over the bodies' surface stiffness E/h (no unit), by default 30, and 0.3 with decomposed
            methods. It changes the number of iterations, not the result.

    Raises:
        TypeError, ValueError: The penalty is no positive finite number.

    Example:
        >>> HardContact()
        HardContact(penalty=None)
    """

    penalty: float | None = None

    def __post_init__(self) -> None:
        if self.penalty is not None:
            object.__setattr__(self, "penalty", positive("penalty", self.penalty))

    def decomposed(self) -> HardContact:
        """The contact with the penalty of decomposed methods, unless the user chose one."""
        return HardContact(DECOMPOSED_PENALTY) if self.penalty is None else self


class AugmentedLayer(LinearLayer):
    """p = k [s − z]⁺ as a law of the shifted gap z − s: what a hard contact is solved with."""


def augmented_layer(contact: HardContact, facet_stiffness: float) -> AugmentedLayer:
    """The linear layer of a hard contact between surfaces whose facets have the stiffness E/h."""
    return AugmentedLayer((contact.penalty or PENALTY) * facet_stiffness)
