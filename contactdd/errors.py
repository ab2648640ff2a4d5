"""Errors and warnings of the solver."""

from __future__ import annotations

from typing import Any


class ContactError(Exception):
    """The base class of the errors that end a run of the solver.

    Example:
        >>> import contactdd as cd
        >>> issubclass(cd.NotConvergedError, cd.ContactError)
        True
    """


class ContactWarning(UserWarning):
    """The base class of warnings of results that solve the discretised scene, but perhaps not the scene meant."""


class LooseBodyError(ContactError):
    """A body that neither its supports nor the active contact hold.

    Attributes:
        body: The name of the body.
        motion: The free rigid motion in words.
        advice: The end of the message.

    Example:
        >>> import contactdd as cd
        >>> cd.LooseBodyError("block", "the translation along x").motion
        'the translation along x'
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

    Attributes:
        status: "iteration limit", "stalled", "diverged" or "no equilibrium".
        reason: The reason of that, in words.
        solution: The `Solution` of the last iterate with its history; None in a pickled copy.
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

    Attributes:
        body: The name of the body.
        motion: The rigid motion in words.
        status: "no equilibrium".
        reason: The reason of that, in words.
        solution: The `Solution` of the last iterate with its history; None in a pickled copy.
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
    """A solution whose strains or rotations are so large that linear theory, and with it the solution, is doubtful."""
