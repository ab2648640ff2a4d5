"""What can go wrong, by name."""

from __future__ import annotations

from numbers import Real
from typing import Any

import numpy as np


class ContactError(Exception):
    """The base of the errors that a run of the solver can end in."""


class LooseBodyError(ContactError):
    """A body that neither its supports nor the active contact hold.

    Attributes: `body`, its name; `motion`, the free rigid motion in words.
    """

    def __init__(self, body: str, motion: str) -> None:
        super().__init__(f"body {body!r} is held by nothing: its supports and the active contact leave {motion} free")
        self.body = body
        self.motion = motion


class NotConvergedError(ContactError):
    """A run that ended without a solution.

    Attributes: `status` and `reason`, and `solution`, the last state with its history.
    """

    def __init__(self, status: str, reason: str, solution: Any) -> None:
        super().__init__(f"{status}: {reason}")
        self.status = status
        self.reason = reason
        self.solution = solution


class NoEquilibriumError(NotConvergedError):
    """A scene without equilibrium: the loads move a body for ever.

    Attributes: `body`, its name; `motion`, in words; `status`, `reason` and `solution`, the last state.
    """

    def __init__(self, body: str, motion: str, solution: Any) -> None:
        super().__init__(
            "no equilibrium", f"the loads move body {body!r} for ever: nothing stops its {motion}", solution
        )
        self.body = body
        self.motion = motion


class CheckpointError(ContactError, ValueError):
    """A checkpoint that is missing, damaged or of another run."""


class MeshMismatchError(ContactError, ValueError):
    """Two contact surfaces whose facets cannot be paired."""


def positive(name: str, value: Any) -> float:
    """`value` as a float, refused unless it is a finite number above zero."""
    number = finite(name, value)
    if number <= 0.0:
        raise ValueError(f"{name} = {value!r}: expected a number > 0")
    return number


def finite(name: str, value: Any) -> float:
    """`value` as a float, refused unless it is a finite number."""
    if isinstance(value, (bool, str)) or not np.isscalar(value):
        raise TypeError(f"{name} = {value!r}: expected a number")
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name} = {value!r}: expected a number") from None
    if not np.isfinite(number):
        raise ValueError(f"{name} = {value!r}: expected a finite number")
    return number


def whole(name: str, value: Any, expected: str = "a whole number >= 1") -> int:
    """`value` as an int, refused unless it is a whole number above zero."""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise TypeError(f"{name} = {value!r}: expected {expected}")
    if not 1 <= value < np.inf or int(value) != value:
        raise ValueError(f"{name} = {value!r}: expected {expected}")
    return int(value)


def floats(name: str, value: Any, expected: str) -> np.ndarray:
    """`value` as an array of floats, refused if it is anything else; of what shape and whether finite is not asked."""
    try:
        array = np.asarray(value)
        if array.dtype.kind in "SUc":  # numpy would read a number in a text, and forget imaginary parts
            raise TypeError
        return np.asarray(array, dtype=float)
    except (TypeError, ValueError):
        raise TypeError(f"{name} = {value!r}: expected {expected}") from None


def one_of(name: str, value: Any, choices: tuple[str, ...]) -> str:
    """`value`, refused unless it is one of `choices`."""
    if value not in choices:
        raise ValueError(f"{name} = {value!r}: expected one of {', '.join(map(repr, choices))}")
    return value


def tuple_of(name: str, values: Any, kind: Any) -> tuple:
    """`values` as a tuple, refused unless it is a sequence of the given kind."""
    if not isinstance(values, (list, tuple)) or not all(isinstance(value, kind) for value in values):
        kinds = " or ".join(each.__name__ for each in getattr(kind, "__args__", (kind,)))
        raise TypeError(f"{name} = {values!r}: expected a list of {kinds}")
    return tuple(values)
