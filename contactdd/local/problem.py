"""What a local problem is: how one body is solved, seen from its contacts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Operator
from ..interface.discretise import Interface, InterfaceSide
from .space import AdmissibleSpace

#: From forces (unknowns,) to the unknowns that they cause (unknowns,).
Solver = Callable[[Floats], Floats]


#: What other ranks need to know of a condensed problem: the kept unknowns, S, the load on them, the constant of the
#: energy, the load on all degrees of freedom, and the rigid motions with their coefficients and springs.
Shared = tuple[NDArray[np.intp], Floats, Floats, float, Floats, tuple[Floats, Floats, Floats]]


@dataclass(frozen=True)
class ContactTrace:
    """Where one interface meets the unknowns of a body.

    interface: its place in the scene; side: the body's side of it; trace (points, unknowns), offset (points,): u_n at
    its points is trace @ y + offset; robin_trace: u_n of the unknowns at the integration points of the body's own
    surface.
    """

    interface: int
    side: InterfaceSide
    trace: Operator
    offset: Floats
    robin_trace: Operator


@dataclass(frozen=True)
class Fields:
    """A body's solution in all degrees of freedom.

    displacement: (dofs,); elastic_forces: (dofs,) a(u, ·), of the deformation only, see `start.State`; spring_forces:
    (dofs,) those of elastic foundations; elastic_energy: ½ a(u, u).
    """

    displacement: Floats
    elastic_forces: Floats
    spring_forces: Floats
    elastic_energy: float


def sides(place: int, interfaces: Sequence[Interface]) -> list[tuple[int, InterfaceSide]]:
    """The sides of interfaces at which the body at a place of the scene lies, each with its interface's place."""
    return [
        (index, side) for index, interface in enumerate(interfaces) for side in interface.sides if side.body == place
    ]


def contact_traces(
    sides: Sequence[tuple[int, InterfaceSide]], space: AdmissibleSpace, kept: NDArray[np.intp]
) -> list[ContactTrace]:
    """Where the interfaces meet the kept unknowns."""
    some, found = space.columns_of(kept), []
    for index, side in sides:
        trace = some(side.trace)
        robin_trace = trace if side.surface.trace is side.trace else some(side.surface.trace)
        found.append(ContactTrace(index, side, trace, space.prescribed(side.trace), robin_trace))
    return found
