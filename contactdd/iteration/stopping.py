"""The stopping criterion and the end of a run."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..errors import LooseBodyError
from ..history import Record

#: A run has progressed if its distance fell below this factor of the best one so far.
PROGRESS = 0.99


class NotANumberError(ArithmeticError):
    """A force, an energy or a coefficient that is no finite number: no iterate to go on from, and never a solution."""


@dataclass(frozen=True)
class StoppingCriterion:
    """The rule by which a run ends.

    tolerance: the bound of the criterion, "residual" or "change"; most: the largest number of iterations; patience: the
    number of iterations without progress after which the run is called stalled.
    """

    tolerance: float
    criterion: str
    most: int
    patience: int

    #: Largest allowed ratio of the residual to the unrelaxed change of the last step (0.91 at most in Table 1); beyond
    #: it the change is small for another reason than convergence.
    EXPLAINED = 2.0
    #: Largest residual of a converged run, however small γ.
    LARGE = 0.1

    def distance(self, residual: float, last: Record | None) -> float:
        """The distance of a run from its goal, 1 at the goal: by its residual now and the change of its last iteration.

        A small change alone proves nothing: a small γ makes small steps from anywhere, and a body that drifts away
        makes them relatively small. So the residual must be what the change without its relaxation explains.
        """
        if not math.isfinite(residual):  # max() below ignores what is not a number
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
    unbounded_motion: LooseBodyError | None = None
