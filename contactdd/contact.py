"""A contact: two named surfaces of two bodies, the layer between them and the gap before deformation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from typing import Any

import numpy as np
import ufl

from .base.checks import as_bool, as_count, check_choice, positive
from .body import Body
from .field import check_field
from .layer import Layer
from .meshless import MeshlessBody
from .parameter import Parameter, ParameterField, current
from .quadrature import RULES

#: A body's side of a contact: a body and the name of its surface, or a body without a mesh.
Side = tuple[Body, str] | MeshlessBody
Gap = float | Callable[[np.ndarray], np.ndarray] | Parameter | ParameterField


class Contact:
    """The possible contact zone S_αβ of two bodies.

    first, second: (body, surface name); layer: the law w ↦ σ_n of both surfaces' layers together;
    gap: d(x) in addition to the distance of the two meshes, negative for an interference: a number, a `Parameter` or a
    function of the coordinates x (dim, points) of the contact's points, midway between the surfaces where their meshes
    do not match; measure_gap: whether the distance of the two meshes counts, where they do not match that of the smooth
    surfaces behind their facets; without it d is `gap` alone; search_distance: how far apart partners may be (length),
    by default the smaller body's size; quadrature: "gauss", "vertex" or "facet" (see `quadrature`); quadrature_degree:
    another degree of exactness; name: by default "first–second" by the bodies' names.
    """

    def __init__(
        self,
        first: Side,
        second: Side,
        layer: Layer,
        *,
        gap: Gap = 0.0,
        measure_gap: bool = True,
        search_distance: float | None = None,
        quadrature: str = "gauss",
        quadrature_degree: int | None = None,
        name: str | None = None,
    ) -> None:
        sides = _checked_side("first", first), _checked_side("second", second)
        bodies = [body for body, _ in sides]
        if all(body.mesh is None for body in bodies):
            raise ValueError(f"first = {bodies[0]!r}, second = {bodies[1]!r}: expected one body with a mesh")
        _check_layer(layer)
        if bodies[0].kinematics.dim != bodies[1].kinematics.dim:
            raise ValueError(
                f"body {bodies[0].name!r} has {bodies[0].kinematics.dim} coordinates, body {bodies[1].name!r} "
                f"{bodies[1].kinematics.dim}; expected both in the plane or both in space"
            )
        check_field("gap", gap)
        if isinstance(gap, ufl.core.expr.Expr):
            raise TypeError(f"gap = {gap!r}: expected a number or a function of the coordinates")
        if name is not None and not isinstance(name, str):
            raise TypeError(f"name = {name!r}: expected a text")
        check_choice("quadrature", quadrature, RULES)
        if quadrature == "vertex" and bodies[0].kinematics.ring:
            raise ValueError(
                "quadrature = 'vertex' between bodies of revolution: the vertices alone do not integrate 2πr v; "
                "expected 'gauss' or 'facet'"
            )
        self.sides = sides
        self.layer = layer
        self.gap = gap
        self.measure_gap = as_bool("measure_gap", measure_gap)
        self.search_distance = None if search_distance is None else positive("search_distance", search_distance)
        self.quadrature = quadrature
        self.quadrature_degree = None if quadrature_degree is None else as_count("quadrature_degree", quadrature_degree)
        self.name = name or f"{bodies[0].name}–{bodies[1].name}"

    @property
    def reach(self) -> float:
        """How far apart partners may be."""
        return self.search_distance or min(body.mesh.size for body, _ in self.sides if body.mesh is not None)

    def resampled(self, degree: int) -> Contact:
        """The same contact at Gauss points of another degree."""
        other = copy(self)
        other.quadrature, other.quadrature_degree = "gauss", degree
        return other

    def with_bodies(self, bodies: Mapping[str, Body]) -> Contact:
        """The same contact between other bodies, with surfaces of the same names.

        Args:
            bodies: The new bodies, by the names of those that they replace.

        Raises:
            ValueError: A new body does not have the surface, or its facets.
        """
        other = copy(self)
        pairs = [(bodies.get(body.name, body), surface) for body, surface in self.sides]
        first, second = (
            _checked_side("bodies", body if isinstance(body, MeshlessBody) else (body, surface))
            for body, surface in pairs
        )
        other.sides = first, second
        return other

    def raised(self, degrees: int) -> Contact:
        """The same contact for elements whose degree is higher by `degrees`, its law at as many more Gauss points."""
        other = copy(self)
        other.quadrature = "gauss"
        if self.quadrature_degree is not None:
            other.quadrature_degree = self.quadrature_degree + 2 * degrees
        return other

    def with_layer(self, layer: Layer) -> Contact:
        """The same contact with another layer."""
        _check_layer(layer)
        other = copy(self)
        other.layer = layer
        return other

    def frozen(self) -> Contact:
        """The contact with the gap that it has now, whatever becomes of a parameter in it."""
        other = copy(self)
        other.gap = current(self.gap)
        return other

    def __repr__(self) -> str:
        zones = " and ".join(f"{body.name}.{surface}" for body, surface in self.sides)
        return f"Contact({self.name!r}: {zones}, {self.layer!r})"


def _checked_side(name: str, side: Side) -> tuple[Any, str]:
    """A side of a contact as (body, surface name); a body without a mesh stands for its whole surface."""
    if isinstance(side, MeshlessBody):
        return side, ""
    if not (isinstance(side, tuple) and len(side) == 2 and isinstance(side[0], Body)):
        raise TypeError(f"{name} = {side!r}: expected (body, surface name), or a body without a mesh")
    body, surface = side
    if len(body.mesh.facets(surface)) == 0:
        raise ValueError(f"{name}: surface {surface!r} of body {body.name!r} has no facets")
    return body, surface


def _check_layer(layer: Layer) -> None:
    if not isinstance(layer, Layer):
        raise TypeError(f"layer = {layer!r}: expected a layer, such as cd.PowerLayer(B, a)")
