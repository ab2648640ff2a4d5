"""Numbers that change from solve to solve: loads, prescribed displacements and gaps of a load programme."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .base.arrays import Floats
from .base.checks import as_floats


class Followed:
    """A value that follows parameters, with the arithmetic that makes others of it.

    `2 * q`, `-q`, `q + r`, `q / 3` follow their parameters as these do.
    """

    __array_ufunc__ = None  # arrays leave `array * q` to it

    @property
    def value(self) -> float | Floats:
        """The present value."""
        raise NotImplementedError

    def __add__(self, other: Any) -> Expression:
        return Expression(operator.add, self, other)

    def __radd__(self, other: Any) -> Expression:
        return Expression(operator.add, other, self)

    def __sub__(self, other: Any) -> Expression:
        return Expression(operator.sub, self, other)

    def __rsub__(self, other: Any) -> Expression:
        return Expression(operator.sub, other, self)

    def __mul__(self, other: Any) -> Expression:
        return Expression(operator.mul, self, other)

    def __rmul__(self, other: Any) -> Expression:
        return Expression(operator.mul, other, self)

    def __truediv__(self, other: Any) -> Expression:
        return Expression(operator.truediv, self, other)

    def __rtruediv__(self, other: Any) -> Expression:
        return Expression(operator.truediv, other, self)

    def __pow__(self, other: Any) -> Expression:
        return Expression(operator.pow, self, other)

    def __neg__(self) -> Expression:
        return Expression(operator.neg, self)


class Expression(Followed):
    """An operation on parameters and numbers; made by arithmetic with a `Parameter`."""

    def __init__(self, operation: Callable[..., Any], *operands: Any) -> None:
        for operand in operands:
            if not isinstance(operand, Followed):
                as_floats("operand", operand, "a parameter or numbers")
        self.operation, self.operands = operation, operands
        _ = self.value  # refuses what is no number at once

    @property
    def value(self) -> float | Floats:
        """The present value.

        Raises:
            ValueError: It is no finite number.
        """
        values = (o.value if isinstance(o, Followed) else np.asarray(o, dtype=float)[()] for o in self.operands)
        try:
            with np.errstate(all="ignore"):
                array = np.asarray(self.operation(*values), dtype=float)
        except ZeroDivisionError:
            array = np.asarray(np.nan)
        if not np.all(np.isfinite(array)):
            raise ValueError(f"{self!r} = {array}: expected finite numbers")
        return array if array.ndim else float(array)

    def __repr__(self) -> str:
        return f"Expression({self.operation.__name__}, {', '.join(map(repr, self.operands))})"


class Parameter(Followed):
    """A number (or an array) that loads, prescribed displacements and gaps may have as their value.

    Setting `value` to another one is all that is needed before the next solve: stiffnesses, factorisations and
    contacts are kept. Solutions found before keep the value that they were found with. Arithmetic with a parameter
    gives what follows it in its turn: `2 * q`, `-q`, `[0, -q]` are values too.

    Args:
        value: The value at first, in the unit of what follows it.

    Raises:
        TypeError, ValueError: The value is no finite number or array of such.

    Example:
        >>> q = Parameter(10.0)
        >>> q.value = 20.0
        >>> q
        Parameter(20.0)
        >>> (5 - 2 * q).value
        -35.0
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
    """The present value, detached from later changes of the parameter; of a list with parameters a list."""
    if isinstance(value, Followed):
        return value.value
    if isinstance(value, ParameterField):
        return value.frozen()
    if isinstance(value, list | tuple) and parameters(value):
        return [current(each) for each in value]
    return value


def refuse_parameter(name: str, value: Any) -> None:
    """Refuse a parameter where a number enters a stiffness, which is made once."""
    if parameters([value]):
        raise TypeError(f"{name} = {value!r}: a parameter can change loads, displacements and gaps; expected a number")


def parameters(values: Any) -> list[Parameter]:
    """The parameters among values, lists of values and expressions."""
    found: list[Parameter] = []
    for value in values:
        if isinstance(value, Parameter):
            found.append(value)
        elif isinstance(value, ParameterField):
            found.append(value.parameter)
        elif isinstance(value, Expression):
            found += parameters(value.operands)
        elif isinstance(value, list | tuple):
            found += parameters(value)
    return found
