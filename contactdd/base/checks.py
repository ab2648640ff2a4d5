"""Arguments checked before anything is computed: each refusal says the name, the value and what was expected."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterable
from numbers import Real
from typing import Any

import numpy as np


def positive(name: str, value: Any) -> float:
    """`value` as a float, refused unless it is a finite number above zero."""
    number = finite(name, value)
    if number <= 0.0:
        raise ValueError(f"{name} = {value!r}: expected a number > 0")
    return number


def positive_values(name: str, value: Any) -> Any:
    """`value` as a float, or as an array of floats where it is one, refused unless all are finite and above zero."""
    if not isinstance(value, np.ndarray) or value.ndim == 0:
        return positive(name, value if not isinstance(value, np.ndarray) else value.item())
    numbers = as_floats(name, value, "numbers > 0")
    wrong = ~(np.isfinite(numbers) & (numbers > 0.0))
    if np.any(wrong):
        raise ValueError(f"{name}: {numbers[wrong].flat[0]:g} at a point; expected numbers > 0")
    return numbers


def finite(name: str, value: Any) -> float:
    """`value` as a float, refused unless it is a finite number."""
    scalar: Any = value
    if isinstance(value, (bool, str)) or not np.isscalar(value):
        raise TypeError(f"{name} = {value!r}: expected a number")
    try:
        number = float(scalar)
    except (TypeError, ValueError):
        raise TypeError(f"{name} = {value!r}: expected a number") from None
    if not math.isfinite(number):
        raise ValueError(f"{name} = {value!r}: expected a finite number")
    return number


def as_count(name: str, value: Any, expected: str = "a whole number >= 1") -> int:
    """`value` as an int, refused unless it is a whole number above zero."""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise TypeError(f"{name} = {value!r}: expected {expected}")
    number = float(value)
    if not 1 <= number < np.inf or int(number) != number:
        raise ValueError(f"{name} = {value!r}: expected {expected}")
    return int(number)


def as_bool(name: str, value: Any) -> bool:
    """`value` as a bool, refused if it is anything else: "no" would be true."""
    if not isinstance(value, bool | np.bool_):
        raise TypeError(f"{name} = {value!r}: expected True or False")
    return bool(value)


def as_floats(name: str, value: Any, expected: str) -> np.ndarray:
    """`value` as a float array; TypeError if it cannot be one. Shape and finiteness are not checked."""
    try:
        array = np.asarray(value)
        if array.dtype.kind in "SUc":  # numpy would read a number in a text, and forget imaginary parts
            raise TypeError
        return np.asarray(array, dtype=float)
    except (TypeError, ValueError):
        raise TypeError(f"{name} = {value!r}: expected {expected}") from None


def check_vector(name: str, value: Any, dim: int) -> None:
    """Refuse anything but a vector of `dim` finite numbers."""
    expected = f"{dim} finite numbers"
    array = as_floats(name, value, expected)
    if array.shape != (dim,) or not np.all(np.isfinite(array)):
        raise ValueError(f"{name} = {value!r}: expected {expected}")


def check_choice(name: str, value: Any, choices: tuple[str, ...]) -> str:
    """`value`, refused unless it is one of `choices`."""
    if not isinstance(value, str) or value not in choices:
        raise ValueError(f"{name} = {value!r}: expected one of {', '.join(map(repr, choices))}")
    return value


def as_tuple_of(name: str, values: Any, kind: Any) -> tuple:
    """`values` as a tuple, refused unless it is a sequence of the given kind."""
    if not isinstance(values, (list, tuple)) or not all(isinstance(value, kind) for value in values):
        kinds = " or ".join(each.__name__ for each in getattr(kind, "__args__", (kind,)))
        raise TypeError(f"{name} = {values!r}: expected a list of {kinds}")
    return tuple(values)


def listed(names: Iterable[str]) -> str:
    """Names for a message, in order."""
    return ", ".join(repr(name) for name in sorted(names)) or "none"


def positional(function: Callable[..., Any]) -> int | None:
    """The number of positional arguments that a function takes; None where it does not tell."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return None
    if any(each.kind is each.VAR_POSITIONAL for each in parameters):
        return None
    return sum(each.kind in (each.POSITIONAL_ONLY, each.POSITIONAL_OR_KEYWORD) for each in parameters)
