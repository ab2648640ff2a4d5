"""An iterate of all bodies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ..base.arrays import Floats

#: A Robin coefficient φ at the points of every interface, by the interfaces' indices.
Phi = Mapping[int, Floats]


@dataclass
class State:
    """An iterate.

    unknowns: (unknowns,) of all bodies, beside what is prescribed and carried along; deformation: (unknowns,) the same
    without the bodies' free rigid motions, which may be so much larger that their rounding alone would look like a
    force; gaps, previous_gaps: z^k, z^{k−1} of every interface; shifts: the multipliers of hard contacts over k,
    (points,) of every interface, by which the gaps here are smaller than those of the bodies; empty where no contact
    is hard.
    """

    unknowns: Floats
    deformation: Floats
    gaps: list[Floats]
    previous_gaps: list[Floats]
    shifts: list[Floats] = field(default_factory=list)

    @cached_property
    def largest(self) -> float:
        """max |unknowns|, no number where one of them is none."""
        return float(np.abs(self.unknowns).max(initial=0.0))
