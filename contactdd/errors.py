"""What can go wrong, by name."""

from __future__ import annotations

from typing import Any


class ContactError(Exception):
    """The base of the errors that a run of the solver can end in."""


class ContactWarning(UserWarning):
    """A result that is right for the discretised scene and may not be for the one that was meant."""


class LooseBodyError(ContactError):
    """A body that neither its supports nor the active contact hold.

    Attributes: `body`, its name; `motion`, the free rigid motion in words; `advice`, the end of the message.
    """

    def __init__(self, body: str, motion: str, advice: str = "") -> None:
        super().__init__(
            f"body {body!r} is held by nothing: its supports and the active contact leave {motion} free{advice}"
        )
        self.body = body
        self.motion = motion
        self.advice = advice

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.body, self.motion)


class NotConvergedError(ContactError):
    """A run that ended without a solution.

    Attributes: `status` and `reason`, and `solution`, the last state with its history (None in a pickled copy).
    """

    def __init__(self, status: str, reason: str, solution: Any) -> None:
        super().__init__(f"{status}: {reason}")
        self.status = status
        self.reason = reason
        self.solution = solution

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.status, self.reason, None)


class NoEquilibriumError(NotConvergedError):
    """A scene without equilibrium: the loads move a body for ever.

    Attributes: `body`, its name; `motion`, in words; `status`, `reason` and `solution`, the last state.
    """

    def __init__(self, body: str, motion: str, solution: Any, advice: str = "") -> None:
        super().__init__(
            "no equilibrium", f"the loads move body {body!r} for ever: nothing stops its {motion}{advice}", solution
        )
        self.body = body
        self.motion = motion

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.body, self.motion, None)


class CheckpointError(ContactError, ValueError):
    """A checkpoint that is missing, damaged or of another run."""


class LayerRangeWarning(ContactWarning):
    """A solution in which a layer is compressed further than its law is known: beyond a table's end, or to a pole."""


class MeshMismatchError(ContactError, ValueError):
    """Two contact surfaces whose facets cannot be paired."""


class LargeStrainWarning(ContactWarning):
    """Strains or rotations of a solution are so large that linear theory, and with it the solution, is doubtful."""
