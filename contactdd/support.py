"""Supports: prescribed displacements and springs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from .base import compat
from .base.arrays import Floats
from .base.checks import as_floats, check_choice, check_vector, finite, positive
from .base.facets import surface_points
from .elements import Elements
from .field import Field, check_field, coefficient, evaluate
from .material import Number
from .parameter import refuse_parameter

#: One prescribed component: nodes (n,), a unit direction (dim,) and the values (n,) of u·direction at the nodes.
Condition = tuple[NDArray[np.int32], Floats, Floats]


@dataclass(frozen=True)
class Fixed:
    """A support that prevents all displacements on the named surfaces, eq. (5).

    Args:
        surfaces: Their names, one argument each.

    Example:
        >>> Fixed("left", "bottom")
        Fixed(surfaces=('left', 'bottom'))
    """

    surfaces: tuple[str, ...]

    def __init__(self, *surfaces: str) -> None:
        object.__setattr__(self, "surfaces", surfaces)

    def conditions(self, on: Elements) -> Iterator[Condition]:
        """The prescribed components: nodes, a unit direction and the values of u·direction there.

        Args:
            on: The elements of the body.
        """
        for surface in self.surfaces:
            nodes = on.nodes(surface)
            for axis in np.eye(on.dim):
                yield nodes, axis, np.zeros(len(nodes))


@dataclass(frozen=True)
class Symmetry:
    """A plane of symmetry: no normal displacement and no shear on the named surfaces, each of which has to be flat.

    Args:
        surfaces: Their names, one argument each.

    Example:
        >>> Symmetry("left")
        Symmetry(surfaces=('left',))
    """

    surfaces: tuple[str, ...]

    def __init__(self, *surfaces: str) -> None:
        object.__setattr__(self, "surfaces", surfaces)

    def conditions(self, on: Elements) -> Iterator[Condition]:
        """The prescribed components: nodes, a unit direction and the values of u·direction there.

        Args:
            on: The elements of the body.
        """
        for surface, normal in _plane_normals(on, self.surfaces):
            nodes = on.nodes(surface)
            yield nodes, normal, np.zeros(len(nodes))


@dataclass(frozen=True)
class Displacement:
    """Prescribed displacements on a named surface.

    Args:
        surface: The name of the surface.
        values: One per coordinate (length), None where it is free: a number, a function of the coordinates x (3,
            points), a `Parameter` or a UFL expression, such as a component of a dolfinx Function; or such a Function of
            vectors on the body's mesh. It is taken at the nodes, as dolfinx interpolates.

    Raises:
        TypeError, ValueError: A value can be no displacement.

    Example:
        >>> Displacement("top", (None, -0.01))
        Displacement(surface='top', values=(None, -0.01))
    """

    surface: str
    values: Sequence[Field | None] | Any  # UFL's expressions have no types

    def __post_init__(self) -> None:
        if isinstance(self.values, ufl.core.expr.Expr):
            if self.values.ufl_shape not in ((2,), (3,)):
                raise ValueError(f"values: a UFL expression of shape {self.values.ufl_shape}; expected (2,) or (3,)")
            return
        if not isinstance(self.values, list | tuple | np.ndarray):
            raise TypeError(f"values = {self.values!r}: expected a list, one entry per coordinate (None where free)")
        for value in self.values:
            if value is not None:
                check_field("displacement", value)
                if isinstance(value, ufl.core.expr.Expr) and value.ufl_shape != ():
                    raise ValueError(f"displacement: expected a UFL expression of shape (), got {value.ufl_shape}")

    def check(self, dim: int) -> None:
        """Refuse another number of values than a body of that dimension has coordinates.

        Args:
            dim: The number of coordinates.

        Raises:
            ValueError: It does not fit.
        """
        if len(self._components) != dim:
            raise ValueError(f"values = {self.values!r}: expected {dim} entries (None where free)")

    @property
    def _components(self) -> Sequence[Any]:
        """One value per coordinate."""
        if isinstance(self.values, ufl.core.expr.Expr):
            return [self.values[axis] for axis in range(self.values.ufl_shape[0])]
        return self.values

    def conditions(self, on: Elements) -> Iterator[Condition]:
        """The prescribed components: nodes, a unit direction and the values of u·direction there.

        Args:
            on: The elements of the body.
        """
        self.check(on.dim)
        nodes = on.nodes(self.surface)
        x = on.coordinates(nodes)
        for axis, value in zip(np.eye(on.dim), self._components, strict=True):
            if isinstance(value, ufl.core.expr.Expr):
                yield nodes, axis, evaluate("displacement", _at_nodes(value, axis, on)[nodes], x)
            elif value is not None:
                yield nodes, axis, evaluate("displacement", value, x)


@dataclass(frozen=True, eq=False)
class PointDisplacement:
    """Prescribed displacements of single nodes of the mesh.

    Where the corners of an edge, a face or a cell are all held, the nodes that elements have in between are, too; but
    the middle of the edge of a cell of second order is held only if it is among the points. A single node that is held
    in a direction in which forces act has an infinite displacement in theory; hold surfaces there.

    Args:
        points: (n, dim) The places of nodes (length).
        values: One number per coordinate (length), None where they are free.

    Raises:
        TypeError, ValueError: The points are none, or a value is no finite number.

    Example:
        >>> PointDisplacement([[0.0, 0.0]], (0.0, None)).values  # keeps a body that slides along y from moving along x
        (0.0, None)
    """

    points: Floats | Sequence[Sequence[float]]
    values: Sequence[float | None]

    def __post_init__(self) -> None:
        array = as_floats("points", self.points, "coordinates of points (n, dim)")
        if array.ndim != 2 or len(array) == 0 or not np.all(np.isfinite(array)):
            raise ValueError(f"points = {self.points!r}: expected the finite coordinates of points, (n, dim)")
        object.__setattr__(self, "points", array)
        for value in self.values:
            if value is not None:
                finite("displacement", value)

    def check(self, dim: int) -> None:
        """Refuse another number of coordinates than a body of that dimension has.

        Args:
            dim: The number of coordinates.

        Raises:
            ValueError: It does not fit.
        """
        if len(self.values) != dim or np.shape(self.points)[1] != dim:
            raise ValueError(f"values = {self.values!r}: expected {dim} entries, and points of {dim} coordinates")

    def conditions(self, on: Elements) -> Iterator[Condition]:
        """The prescribed components: nodes, a unit direction and the values of u·direction there.

        Args:
            on: The elements of the body.
        """
        nodes = on.nodes_between(on.nodes_at(np.asarray(self.points)))
        for axis, value in zip(np.eye(on.dim), self.values, strict=True):
            if value is not None:
                yield nodes, axis, np.full(len(nodes), float(value))


@dataclass(frozen=True)
class Spring:
    """An elastic foundation on a named surface, which resists a displacement u by the traction −k u.

    A body that is held by springs alone loses digits as they get softer than itself; at 1e-8 of its stiffness a solve
    no longer converges.

    Args:
        surface: The name of the surface.
        stiffness: k > 0 (stress / length), a number or a function of the coordinates x (3, points), nowhere negative.
        direction: None (all directions alike), "normal", or the one direction (dim,) that it resists.

    Raises:
        TypeError, ValueError: The stiffness or the direction can be none.

    Example:
        >>> Spring("bottom", stiffness=50.0, direction="normal")
        Spring(surface='bottom', stiffness=50.0, direction='normal')
    """

    surface: str
    stiffness: Number
    direction: str | Sequence[float] | None = None

    def __post_init__(self) -> None:
        refuse_parameter("stiffness", self.stiffness)
        if isinstance(self.stiffness, ufl.core.expr.Expr):
            raise TypeError("stiffness: a UFL expression; expected a number or a function of the coordinates")
        if not callable(self.stiffness):
            positive("stiffness", self.stiffness)
        if isinstance(self.direction, str):
            check_choice("direction", self.direction, ("normal",))
        elif self.direction is not None:
            direction = as_floats("direction", self.direction, "'normal' or 2 or 3 finite numbers")
            if direction.shape not in ((2,), (3,)) or not 0.0 < np.linalg.norm(direction) < np.inf:
                raise ValueError(
                    f"direction = {self.direction!r}: expected 'normal' or a vector of 2 or 3 numbers, not all zero"
                )

    def check(self, dim: int) -> None:
        """Refuse a direction of another number of coordinates than a body of that dimension has.

        Args:
            dim: The number of coordinates.

        Raises:
            ValueError: It does not fit.
        """
        if self.direction is not None and not isinstance(self.direction, str):
            check_vector("direction", self.direction, dim)

    def conditions(self, on: Elements) -> Iterator[Condition]:
        """The prescribed components: nodes, a unit direction and the values of u·direction there.

        Args:
            on: The elements of the body.
        """
        return iter(())

    def form(self, on: Elements, u: Any, v: Any) -> ufl.Form:
        """The UFL form ∫ k u·v ds, or ∫ k (u·e)(v·e) ds along one direction e.

        Args:
            on: The elements of the body.
            u: Their trial function.
            v: Their test function.
        """
        value = self._values if callable(self.stiffness) else self.stiffness
        k = coefficient("stiffness", value, on.domain, (), on.field_degree, on.mesh.entities(self.surface))
        if self.direction is None:
            return on.over_surface(k * ufl.dot(u, v), self.surface)
        e = ufl.FacetNormal(on.domain) if isinstance(self.direction, str) else self._direction(on)
        return on.over_surface(k * ufl.dot(u, e) * ufl.dot(v, e), self.surface)

    def _values(self, x: Floats) -> Floats:
        values = evaluate("stiffness", self.stiffness, x)
        if values.min() < -1e-12 * np.abs(values).max():  # coordinates that are zero but for rounding are
            worst = int(np.argmin(values))
            raise ValueError(f"stiffness = {values[worst]:g} at x = {x[:, worst]}: expected numbers >= 0")
        return values

    def _direction(self, on: Elements) -> fem.Constant:
        direction = np.asarray(self.direction, dtype=float)
        if direction.shape != (on.dim,) or not 0.0 < np.linalg.norm(direction) < np.inf:
            raise ValueError(f"direction = {self.direction!r}: expected 'normal' or a vector of {on.dim} numbers")
        return fem.Constant(on.domain, direction / np.linalg.norm(direction))


Support = Fixed | Symmetry | Displacement | PointDisplacement | Spring


def _at_nodes(value: Any, axis: Floats, on: Elements) -> Floats:
    """The values of a UFL expression at all nodes, (nodes,); axis: a unit vector along one of the coordinates."""
    vector = ufl.as_vector([value if component else ufl.zero() for component in axis])
    function = fem.Function(on.space)
    function.interpolate(fem.Expression(vector, compat.expression_points(on.space.element)))
    return np.asarray(function.x.array.reshape(-1, on.dim) @ axis)


def _plane_normals(on: Elements, surfaces: Sequence[str]) -> Iterator[tuple[str, Floats]]:
    """The flat surfaces by name, each with its outward normal; a curved one is refused."""
    if not surfaces:
        return
    entities = [on.mesh.entities(surface) for surface in surfaces]
    middle = np.full((1, on.dim - 1), 0.5 if on.dim == 2 else 1 / 3)
    normals = surface_points(on.domain, np.concatenate(entities), middle).normal
    end = 0
    for surface, pairs in zip(surfaces, entities, strict=True):
        start, end = end, end + len(pairs)
        total = normals[start:end].sum(axis=0)
        mean = total / max(float(np.sqrt(total @ total)), 1e-300)
        if np.abs(normals[start:end] - mean).max() > 1e-8:  # a file may have rounded coordinates to eight digits
            raise ValueError(f"surface = {surface!r} of body {on.name!r}: expected a flat surface for a symmetry plane")
        yield surface, np.where(np.abs(mean) < 1e-8, 0.0, mean)
