"""The values of dolfinx' Constants and Functions in what a user gives: they may change between solves."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import ufl
from dolfinx import fem

from .base.arrays import Floats


class CoefficientValue:
    """The numbers of a `fem.Constant` or `fem.Function`, read and set as those of a `Parameter` are."""

    def __init__(self, coefficient: Any) -> None:
        self._array = coefficient.x.array if isinstance(coefficient, fem.Function) else coefficient.value

    @property
    def value(self) -> Floats:
        """A copy of the present numbers."""
        return np.array(self._array)

    @value.setter
    def value(self, value: Floats) -> None:
        np.copyto(self._array, value)


def coefficient_values(values: Iterable[Any]) -> list[CoefficientValue]:
    """The values of all Constants and Functions in UFL expressions and forms, also within lists."""
    return [CoefficientValue(coefficient) for each in _expressions(values) for coefficient in _coefficients(each)]


def _expressions(values: Iterable[Any]) -> Iterator[Any]:
    for value in values:
        if isinstance(value, list | tuple):
            yield from _expressions(value)
        elif is_ufl(value):
            yield value


def is_ufl(value: Any) -> bool:
    """Whether a value is an expression or a form of UFL."""
    return isinstance(value, ufl.core.expr.Expr | ufl.Form)


def _coefficients(expression: Any) -> list[Any]:
    functions = ufl.algorithms.extract_coefficients(expression)
    constants = ufl.algorithms.analysis.extract_constants(expression)
    return [each for each in (*functions, *constants) if isinstance(each, fem.Function | fem.Constant)]
