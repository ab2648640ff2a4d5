"""The values of dolfinx' Constants and Functions in what a user gives: they may change between solves."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import ufl
from dolfinx import fem

from .base.arrays import Floats

#: UFL's expressions and forms, and lists: not as unions, which are made anew for every question.
UFL, LISTS = (ufl.core.expr.Expr, ufl.Form), (list, tuple)
#: What most values are, told from those at once.
PLAIN = frozenset([float, int, str, bool, type(None), np.ndarray])


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
    return [CoefficientValue(coefficient) for each in ufl_in(values) for coefficient in _coefficients(each)]


def ufl_in(values: Iterable[Any]) -> list[Any]:
    """UFL's expressions and forms among values and lists of values."""
    found: list[Any] = []
    for value in values:
        if type(value) in PLAIN:
            continue
        if isinstance(value, LISTS):
            found += ufl_in(value)
        elif isinstance(value, UFL):
            found.append(value)
    return found


def _coefficients(expression: Any) -> list[Any]:
    functions = ufl.algorithms.extract_coefficients(expression)
    constants = ufl.algorithms.analysis.extract_constants(expression)
    return [each for each in (*functions, *constants) if isinstance(each, fem.Function | fem.Constant)]
