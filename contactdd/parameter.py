"""Numbers that change from solve to solve: loads, prescribed displacements and gaps of a load programme."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .base.arrays import Floats
from .base.checks import as_floats


class Parameter:
    """A number (or an array) that loads, prescribed displacements and gaps may have as their value.

    Setting `value` to another one is all that is needed before the next solve: stiffnesses, factorisations and
    contacts are kept. Solutions found before keep the value that they were found with.

    Args:
        value: The value at first, in the unit of what follows it.

    Raises:
        TypeError, ValueError: The value is no finite number or array of such.

    Example:
        >>> q = Parameter(10.0)
        >>> q.value = 20.0
        >>> q
        Parameter(20.0)
    """

    def __init__(self, value: ArrayLike) -> None:
        self.value = value

    @property
    def value(self) -> float | Floats:
        """The present value."""
        return self._value

    @value.setter
    def value(self, value: ArrayLike) -> None:
        array = as_floats("value", value, "finite numbers").copy()
        if not np.all(np.isfinite(array)):
            raise ValueError(f"value = {value!r}: expected finite numbers")
        array.setflags(write=False)  # an entry changed in place would pass unnoticed
        self._value = array if array.ndim else float(array)

    def field(self, function: Callable[[Any, Floats], Any]) -> ParameterField:
        """A field that follows the parameter.

        Args:
            function: From the value and the coordinates x (dim, points) to the field's values (points,), or (dim,
                points).

        Example:
            >>> Parameter(2.0).field(lambda q, x: q * x[0])(np.array([[1.0, 3.0], [0.0, 0.0]]))
            array([2., 6.])
        """
        return ParameterField(self, function)

    def __repr__(self) -> str:
        return f"Parameter({self._value!r})"


class ParameterField:
    """A function of the coordinates that follows a parameter; made by `Parameter.field`."""

    def __init__(self, parameter: Parameter, function: Callable[[Any, Floats], Any]) -> None:
        self.parameter, self.function = parameter, function

    def __call__(self, x: Floats) -> Any:
        return self.function(self.parameter.value, x)

    def __repr__(self) -> str:
        return f"ParameterField({self.parameter!r}, {self.function!r})"

    def frozen(self) -> Callable[[Floats], Any]:
        """The function with the parameter's present value for good."""
        value = self.parameter.value
        return lambda x: self.function(value, x)


def current(value: Any) -> Any:
    """The present value, detached from later changes of the parameter."""
    if isinstance(value, Parameter):
        return value.value
    return value.frozen() if isinstance(value, ParameterField) else value


def refuse_parameter(name: str, value: Any) -> None:
    """Refuse a parameter where a number enters a stiffness, which is made once."""
    if parameters([value]):
        raise TypeError(f"{name} = {value!r}: a parameter can change loads, displacements and gaps; expected a number")


def parameters(values: Any) -> list[Parameter]:
    """The parameters among values and lists of values."""
    found: list[Parameter] = []
    for value in values:
        if isinstance(value, Parameter):
            found.append(value)
        elif isinstance(value, ParameterField):
            found.append(value.parameter)
        elif isinstance(value, list | tuple):
            found += parameters(value)
    return found
