"""A contact with the bodies on both its sides, as a Robin coefficient of the user's own may see it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .interface.discretise import Interface
from .interface.surface import ContactSurface
from .local.problem import LocalProblem


@dataclass(frozen=True)
class ContactSides:
    """A contact and the bodies on both its sides.

    Args:
        index: The contact's index in the scene.
        interfaces: All discretised contacts of the scene.
        problems: The two bodies' local problems, see `LocalProblem`.

    Example:
        >>> def two_sided(layer, z, z_previous, x, sides):  # one row for each body: see demos/own_method.py
        ...     first, second = sides.moduli
        ...     ratios = np.array([[1 + first / second], [1 + second / first]])
        ...     return ratios * layer.divided_difference(z_previous, z)
        >>> import contactdd as cd
        >>> method = cd.Scheme("two-sided", two_sided, "decomposed", "")
    """

    index: int
    interfaces: Sequence[Interface]
    problems: tuple[LocalProblem, LocalProblem]

    @property
    def interface(self) -> Interface:
        """The discretised contact, with its n points: `x`, `normal`, `weights`, `gap`, `layer`, `contact`."""
        return self.interfaces[self.index]

    @property
    def bodies(self) -> tuple[str, str]:
        """The names of the two bodies."""
        return self.problems[0].name, self.problems[1].name

    @cached_property
    def moduli(self) -> tuple[float, float]:
        """Young's modulus of each body at its surface (stress), infinite of one without a mesh.

        Against a pressure of the wave number κ a surface has the stiffness E κ / (2 (1 − ν²)) (stress / length).
        """
        surfaces = (side.surface for side in self.interface.sides)
        first, second = (float(np.mean(s.moduli)) if isinstance(s, ContactSurface) else np.inf for s in surfaces)
        return first, second


def sides_of_contacts(interfaces: Sequence[Interface], problems: Sequence[LocalProblem]) -> list[ContactSides]:
    """Every contact with its two bodies, in order."""
    pairs = ([problems[side.body] for side in interface.sides] for interface in interfaces)
    return [ContactSides(index, interfaces, (first, second)) for index, (first, second) in enumerate(pairs)]
