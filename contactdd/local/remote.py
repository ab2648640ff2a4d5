"""A body whose inside another rank holds."""

from __future__ import annotations

from collections.abc import Sequence

from ..body import Body
from ..interface.discretise import Interface
from .condensed import CondensedProblem
from .problem import Shared, contact_traces, sides
from .space import admissible_space


class RemoteProblem(CondensedProblem):
    """A body that another rank holds, seen from its contacts: all of the condensed problem but the inside."""

    def __init__(self, body: Body, place: int, interfaces: Sequence[Interface], shared: Shared) -> None:
        self.body = body
        self.space = admissible_space(body)
        self.kept, self.stiffness, self.load, self.constant, self.full_load, motions = shared
        self.sides = sides(place, interfaces)
        self.ports = contact_traces(self.sides, self.space, self.kept)
        self.rigid = self._rigid_motions(*motions)
