"""When a run ends, and how it ended."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..errors import LooseBodyError
from ..history import Record

#: What a measure has to fall to for the run to have come closer.
PROGRESS = 0.99


class NotANumberError(ArithmeticError):
    """A force, an energy or a coefficient that is no finite number: no iterate to go on from, and never a solution."""


@dataclass(frozen=True)
class StoppingCriterion:
    """When a run ends.

    tolerance: of the criterion, "residual" or "change"; most: iterations; patience: iterations without any progress
    after which the run is called stalled.
    """

    tolerance: float
    criterion: str
    most: int
    patience: int

    #: The residual may be this many times the change that the step would have made without its relaxation: over the
    #: whole of Table 1 it is up to 0.91; where the change is small for another reason it is many times as large.
    EXPLAINED = 2.0
    #: Above this no residual is small, however small γ.
    LARGE = 0.1

    def distance(self, residual: float, last: Record | None) -> float:
        """The distance of a run from its goal, 1 at the goal: by its residual now and the change of its last iteration.

        A small change alone proves nothing: a small γ makes small steps from anywhere, and a body that drifts away
        makes them relatively small. So the residual must be what the change without its relaxation explains.
        """
        if not math.isfinite(residual):  # nor does max() below tell
            return math.inf
        if self.criterion == "residual":
            return residual / self.tolerance
        if last is None or not math.isfinite(last.change):
            return math.inf
        explained = min(self.EXPLAINED * self.tolerance / min(last.gamma, 1.0), self.LARGE)
        return max(last.change / self.tolerance, residual / explained)


@dataclass(frozen=True)
class Termination:
    """The end of a run: its status, the reason in words, and the unbounded motion where there is no equilibrium."""

    status: str
    reason: str
    escape: LooseBodyError | None = None
