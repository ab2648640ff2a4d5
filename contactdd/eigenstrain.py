"""Eigenstrains ε₀: strains without stress, such as that of heat. Hooke's law (2) becomes σ = C : (ε − ε₀).

They are loads, l(v) = ∫ (C : ε₀) : ε(v) dx, and are taken away where stresses and stored energies are asked for.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import ufl

from .base.arrays import Floats
from .base.checks import as_floats
from .elements import Elements
from .field import Field, check_field, volume_coefficient
from .load import FormLoad, LoadedBody
from .material import VOIGT
from .parameter import current, refuse_parameter


class _Strain(FormLoad):
    """What all eigenstrains have in common."""

    is_strain = True

    def form_on(self, body: LoadedBody, v: Any) -> Any:
        """The UFL form ∫ (C : ε₀) : ε(v) dx.

        Args:
            body: The body.
            v: A test function of its elements.
        """
        return body.eigenstrain_form(self.eigenstrain(body.elements), v)


@dataclass(frozen=True)
class ThermalStrain(_Strain):
    """The strain α ΔT of a body that is heated, of which only what is prevented causes stresses.

    In plane strain and in a body of revolution it acts across the plane and around the axis, too.

    Args:
        alpha: The coefficient of thermal expansion (1 / temperature): a number, a function of the coordinates x (3,
            points), a UFL expression such as a dolfinx Function; or three numbers, along x, y and z.
        temperature: The change ΔT from the state without stress (temperature): a number, a function of the coordinates
            x (3, points), a UFL expression such as a dolfinx Function, or a `Parameter`.

    Raises:
        TypeError, ValueError: A value can be none of these.

    Example:
        >>> ThermalStrain(12e-6, 100.0)
        ThermalStrain(alpha=1.2e-05, temperature=100.0)
    """

    alpha: Any
    temperature: Field

    def __post_init__(self) -> None:
        refuse_parameter("alpha", self.alpha)
        if _is_three(self.alpha):
            _three(self.alpha)
        else:
            check_field("alpha", self.alpha)
        check_field("temperature", self.temperature)

    def eigenstrain(self, on: Elements) -> Any:
        """The eigenstrain, a UFL vector of six components in the order of Voigt.

        Args:
            on: The elements of the body.
        """
        rise = volume_coefficient("temperature", self.temperature, on.domain, (), on.field_degree)
        if _is_three(self.alpha):
            along = [volume_coefficient("alpha", float(each), on.domain, (), 0) for each in _three(self.alpha)]
        else:
            along = [volume_coefficient("alpha", self.alpha, on.domain, (), on.field_degree)] * 3
        return ufl.as_vector([*(alpha * rise for alpha in along), 0, 0, 0])


@dataclass(frozen=True, eq=False)
class Eigenstrain(_Strain):
    """A strain without stress of any origin: swelling, shrinking, a residual strain.

    Args:
        value: ε₀ (no unit): a number, the same along x, y and z, or a symmetric tensor (3, 3); or a function of the
            coordinates x (3, points) to (points,) or (3, 3, points), a UFL expression or a `Parameter` of such. The
            third direction is z, in a body of revolution the one around the axis.

    Raises:
        TypeError, ValueError: The value is no symmetric tensor.

    Example:
        >>> Eigenstrain(-1e-4).value  # concrete that shrinks
        -0.0001
    """

    value: Field

    def __post_init__(self) -> None:
        given = current(self.value)
        if isinstance(given, ufl.core.expr.Expr):
            if given.ufl_shape not in ((), (3, 3)):
                raise ValueError(f"value: a UFL expression of shape {given.ufl_shape}; expected () or (3, 3)")
        elif not callable(given):
            _symmetric(given)

    def eigenstrain(self, on: Elements) -> Any:
        """The eigenstrain, a UFL vector of six components in the order of Voigt.

        Args:
            on: The elements of the body.
        """
        given = current(self.value)
        if isinstance(given, ufl.core.expr.Expr):
            isotropic = given.ufl_shape == ()
        elif callable(given):
            isotropic = np.ndim(given(on.domain.geometry.x[:1].T)) <= 1
            given = given if isotropic else _symmetric_everywhere(given)
        else:
            given = _symmetric(given)
            isotropic = np.ndim(given) == 0
        value = volume_coefficient("eigenstrain", given, on.domain, () if isotropic else (3, 3), on.field_degree)
        if isotropic:
            return ufl.as_vector([value, value, value, 0, 0, 0])
        return ufl.as_vector([value[i, j] if i == j else value[i, j] + value[j, i] for i, j in VOIGT])


def _is_three(alpha: Any) -> bool:
    return isinstance(alpha, list | tuple | np.ndarray)


def _three(alpha: Any) -> np.ndarray:
    array = as_floats("alpha", alpha, "a number or three, along x, y and z")
    if array.shape != (3,) or not np.all(np.isfinite(array)):
        raise ValueError(f"alpha = {alpha!r}: expected a number or three finite ones, along x, y and z")
    return array


def _symmetric_everywhere(function: Callable[[Floats], Any]) -> Callable[[Floats], Any]:
    """The same function of x, refused where its tensors are not symmetric."""

    def checked(x: Floats) -> Any:
        values = np.asarray(function(x), dtype=float)
        size = np.abs(values).max(initial=0.0)
        if values.ndim > 1 and not np.allclose(values, np.swapaxes(values, 0, 1), rtol=0.0, atol=1e-12 * size):
            raise ValueError("value: its tensors are not symmetric everywhere; expected symmetric ones (3, 3, points)")
        return values

    return checked


def _symmetric(value: Any) -> Any:
    """A number, or a symmetric tensor (3, 3), checked."""
    array = as_floats("value", value, "a number or a symmetric tensor (3, 3)")
    if array.shape not in ((), (3, 3)) or not np.all(np.isfinite(array)) or not np.array_equal(array, array.T):
        raise ValueError(f"value = {value!r}: expected a finite number or a symmetric tensor (3, 3) of such")
    return array if array.ndim else float(array)
