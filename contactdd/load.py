"""Loads: the terms of l(v) = ∫ f·v dx + ∫ p·v ds.

A value is a number, an array, a function of the coordinates x (3, points), a UFL expression or a `Parameter`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np
import ufl
from dolfinx import fem

from .base import compat
from .base.arrays import Floats
from .elements import Elements
from .field import Field, check_dimension, check_field, coefficient, volume_coefficient
from .parameter import current


@dataclass(frozen=True)
class Pressure:
    """A normal pressure on a named surface, positive when it pushes.

    Args:
        surface: The name of the surface.
        value: p (stress): a number, a function of the coordinates x (3, points), a UFL expression or a `Parameter`.

    Raises:
        TypeError, ValueError: The value can be no pressure.

    Example:
        >>> Pressure("top", 10.0)
        Pressure(surface='top', value=10.0)
    """

    surface: str
    value: Field

    def __post_init__(self) -> None:
        check_field("pressure", self.value)

    def form(self, on: Elements, v: Any) -> Any:
        """The UFL form of the load's part of l(v).

        Args:
            on: The elements of the body.
            v: Their test function.
        """
        p = coefficient("pressure", self.value, on.domain, (), on.field_degree, on.mesh.entities(self.surface))
        return on.over_surface(-p * ufl.dot(ufl.FacetNormal(on.domain), v), self.surface)


@dataclass(frozen=True)
class Traction:
    """A surface load vector on a named surface.

    Args:
        surface: The name of the surface.
        value: p (dim,) (stress): a number, a function of the coordinates x (3, points), a UFL expression or a
            `Parameter`, with as many components as there are coordinates.

    Raises:
        TypeError, ValueError: The value can be no vector field.

    Example:
        >>> Traction("right", (5.0, 0.0))
        Traction(surface='right', value=(5.0, 0.0))
    """

    surface: str
    value: Field

    def __post_init__(self) -> None:
        check_field("traction", self.value, vector=True)

    def check(self, dim: int) -> None:
        """Refuse a vector of another number of components than a body of that dimension has coordinates.

        Args:
            dim: The number of coordinates.

        Raises:
            ValueError: It does not fit.
        """
        check_dimension("traction", self.value, dim)

    def form(self, on: Elements, v: Any) -> Any:
        """The UFL form of the load's part of l(v).

        Args:
            on: The elements of the body.
            v: Their test function.
        """
        p = coefficient("traction", self.value, on.domain, (on.dim,), on.field_degree, on.mesh.entities(self.surface))
        return on.over_surface(ufl.dot(p, v), self.surface)


@dataclass(frozen=True)
class BodyForce:
    """A force per unit volume.

    Args:
        value: f (dim,) (force / length³): a number, a function of the coordinates x (3, points), a UFL expression or a
            `Parameter`, with as many components as there are coordinates.

    Raises:
        TypeError, ValueError: The value can be no vector field.

    Example:
        >>> BodyForce((0.0, -7.85e-9 * 9810.0))  # the weight of steel in mm, N, s
        BodyForce(value=(0.0, -7.700850000000001e-05))
    """

    value: Field

    def __post_init__(self) -> None:
        check_field("body force", self.value, vector=True)

    def check(self, dim: int) -> None:
        """Refuse a vector of another number of components than a body of that dimension has coordinates.

        Args:
            dim: The number of coordinates.

        Raises:
            ValueError: It does not fit.
        """
        check_dimension("body force", self.value, dim)

    def form(self, on: Elements, v: Any) -> Any:
        """The UFL form of the load's part of l(v).

        Args:
            on: The elements of the body.
            v: Their test function.
        """
        f = volume_coefficient("body force", self.value, on.domain, (on.dim,), on.field_degree)
        return on.over_volume(ufl.dot(f, v))


@dataclass(frozen=True)
class Resultant:
    """A total force spread evenly over a named surface: the same traction force / area everywhere on it.

    Args:
        surface: The name of the surface.
        force: (dim,) The total force (force), per unit of thickness in the plane, that of the full ring in a body of
            revolution, where only an axial one exists: numbers or a `Parameter`.

    Raises:
        TypeError, ValueError: The force is no vector of finite numbers.

    Example:
        >>> Resultant("top", (0.0, -100.0))
        Resultant(surface='top', force=(0.0, -100.0))
    """

    surface: str
    force: Field

    def __post_init__(self) -> None:
        if callable(current(self.force)) or isinstance(self.force, ufl.core.expr.Expr):
            raise TypeError(f"force = {self.force!r}: expected 2 or 3 finite numbers")
        check_field("force", self.force, vector=True)

    def check(self, dim: int) -> None:
        """Refuse a vector of another number of components than a body of that dimension has coordinates.

        Args:
            dim: The number of coordinates.

        Raises:
            ValueError: It does not fit.
        """
        check_dimension("force", self.force, dim)

    def form(self, on: Elements, v: Any) -> Any:
        """The UFL form of the load's part of l(v).

        Args:
            on: The elements of the body.
            v: Their test function.
        """
        force = current(self.force)
        if callable(force) or np.shape(force) != (on.dim,) or not np.all(np.isfinite(force)):
            raise ValueError(f"force = {self.force!r}: expected {on.dim} finite numbers")
        if on.kinematics.axisymmetric and force[0] != 0.0:
            raise ValueError(f"force = {self.force!r}: around a ring radial forces sum to zero; expected force[0] = 0")
        traction = fem.Constant(on.domain, np.asarray(force, dtype=float) / on.area(self.surface))
        return on.over_surface(ufl.dot(traction, v), self.surface, on.area_metadata)


class LoadedBody(Protocol):
    """The part of a `Body` that its loads may ask for."""

    name: str
    elements: Elements

    @property
    def space(self) -> fem.FunctionSpace:
        """The finite element space of the displacements."""
        ...

    def eigenstrain_form(self, strain: Any, v: Any) -> ufl.Form:
        """The UFL form ∫ (C : ε₀) : ε(v) dx of an eigenstrain.

        Args:
            strain: ε₀, a UFL vector of six components in the order of Voigt.
            v: A test function.
        """
        ...


class BodyLoad(ABC):
    """A load that takes the body with its material: eigenstrains, forces at points and the user's own forms.

    Attributes:
        is_strain: Whether it is an eigenstrain, which `eigenstrain` gives.
    """

    is_strain: ClassVar[bool] = False

    @abstractmethod
    def vector(self, body: LoadedBody) -> Floats:
        """The load's part of l(v) for all degrees of freedom, (dofs,) (force).

        Args:
            body: The body.
        """

    def check_on(self, body: LoadedBody) -> None:  # noqa: B027  # most fit any body
        """Refuse what does not fit a body.

        Args:
            body: The body.
        """

    def eigenstrain(self, on: Elements) -> Any:
        """The eigenstrain, a UFL vector of six components in the order of Voigt, of a load that is one.

        Args:
            on: The elements of the body.
        """
        raise NotImplementedError

    def followed(self, body: LoadedBody) -> Iterable[Any]:
        """The values that may change between solves: parameters, dolfinx' Constants and Functions in UFL.

        Args:
            body: The body.
        """
        return vars(self).values()


class FormLoad(BodyLoad):
    """A load that a form of the body gives."""

    @abstractmethod
    def form_on(self, body: LoadedBody, v: Any) -> Any:
        """The UFL form of the load's part of l(v).

        Args:
            body: The body.
            v: A test function of its elements.
        """

    def vector(self, body: LoadedBody) -> Floats:
        """The load's part of l(v) for all degrees of freedom, (dofs,) (force).

        Args:
            body: The body.
        """
        form = compat.form(self.form_on(body, ufl.TestFunction(body.space)))
        return np.asarray(fem.assemble_vector(form).array)


Load = Pressure | Traction | BodyForce | Resultant | BodyLoad


def is_eigenstrain(load: Load) -> bool:
    """Whether a load is an eigenstrain.

    Args:
        load: The load.
    """
    return isinstance(load, BodyLoad) and load.is_strain
