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
from .hard_contact import HardContact
from .layer import Layer
from .meshless import MeshlessBody
from .parameter import Parameter, ParameterField, current
from .quadrature import RULES

#: A body's side of a contact: a body and the name of its surface, or a body without a mesh.
Side = tuple[Body, str] | MeshlessBody
Gap = float | Callable[[np.ndarray], np.ndarray] | Parameter | ParameterField


class Contact:
    """The possible contact zone S_αβ of two bodies: two named surfaces, the layer between them and the gap.

    Args:
        first, second: (body, surface name), or a body without a mesh.
        layer: The law w ↦ σ_n of both surfaces' layers together, or `HardContact()` where there is none. The law begins
            where the gap is the layer's clearance, 0 for most: all gaps of a solution count from there.
        gap: d(x), the initial gap in addition to the distance of the two meshes (length), negative for an interference:
            a number, a `Parameter` or a function of the coordinates x (dim, points) of the contact's points, midway
            between the surfaces where their meshes do not match; of a rough surface its `SurfaceHeights`.
        measure_gap: Whether the distance of the two meshes counts: where they do not match, that of the smooth surfaces
            behind their facets. False ignores it and takes `gap` alone: for surfaces that coincide in reality but not
            as straight facets.
        search_distance: The largest distance at which points of the surfaces are paired (length), by default the
            smaller body's size.
        quadrature: The points at which the law is evaluated: "gauss" (the default), Gauss points; "mortar" (the default
            of hard contact), the nodes of one surface, that of the softer body or else of the coarser facets; "facet",
            one per facet; "vertex", the vertices of facets that match.
        quadrature_degree: The degree of exactness, by default twice the elements' degree.
        name: The name, by default "first–second" by the bodies' names.

    Raises:
        TypeError, ValueError: An argument is not what is described here; the bodies differ in dimension; the quadrature
            does not suit hard contact or bodies of revolution.

    Example:
        >>> import contactdd as cd
        >>> steel, mesh = cd.Isotropic(E=2e5, nu=0.3), cd.rectangle((0, 0), (2, 1), (2, 1))
        >>> lower, upper = cd.Body("lower", mesh, steel), cd.Body("upper", mesh.moved((0, 1)), steel)
        >>> cd.Contact((lower, "top"), (upper, "bottom"), cd.LinearLayer(1e4), gap=lambda x: 0.01 * (x[0] - 1) ** 2)
        Contact('lower–upper': lower.top and upper.bottom, LinearLayer(stiffness=10000.0))
    """

    def __init__(
        self,
        first: Side,
        second: Side,
        layer: Layer | HardContact,
        *,
        gap: Gap = 0.0,
        measure_gap: bool = True,
        search_distance: float | None = None,
        quadrature: str | None = None,
        quadrature_degree: int | None = None,
        name: str | None = None,
    ) -> None:
        sides = _checked_side("first", first), _checked_side("second", second)
        bodies = [body for body, _ in sides]
        if all(body.mesh is None and body.contact_points() is None for body in bodies):
            raise ValueError(
                f"first = {bodies[0]!r}, second = {bodies[1]!r}: expected one with a mesh, or with points of its own"
            )
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
        if quadrature is None:
            quadrature = "mortar" if isinstance(layer, HardContact) else "gauss"
        check_choice("quadrature", quadrature, tuple(RULES))
        if isinstance(layer, HardContact) and not RULES[quadrature].of_nodes:
            raise ValueError(
                f"quadrature = {quadrature!r} with a hard contact: its pressure would waver; expected 'mortar'"
            )
        if bodies[0].kinematics.axisymmetric and not RULES[quadrature].rings:
            raise ValueError(
                f"quadrature = {quadrature!r} between bodies of revolution: its points alone do not integrate 2πr v; "
                f"expected one of {', '.join(repr(name) for name, rule in RULES.items() if rule.rings)}"
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
        """The largest distance at which points of the surfaces are paired (length)."""
        if self.search_distance is not None:
            return self.search_distance
        bodies = [body for body, _ in self.sides]
        meshed = [body.mesh.size for body in bodies if body.mesh is not None]
        return min(meshed or [body.length for body in bodies if body.length > 0.0], default=1.0)

    def resampled(self, degree: int) -> Contact:
        """The same contact at Gauss points of another degree.

        Args:
            degree: The degree of exactness.
        """
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

    def raised(self, degrees: int, *, finely: bool = False) -> Contact:
        """The same contact for elements of a higher degree.

        Its law is evaluated at more Gauss points; hard contact's pressures stay at nodes.

        Args:
            degrees: The number of degrees by which the elements are higher.
            finely: Whether at about four times as many points along a facet as the contact has now: in facets where
                contact ends the error of n points falls like n⁻² only, whatever the elements' degree.
        """
        other = copy(self)
        if not isinstance(self.layer, HardContact):
            other.quadrature = "gauss"
        own = self.quadrature_degree
        if finely:
            elements = max(body.degree for body, _ in self.sides if body.mesh is not None)
            other.quadrature_degree = 4 * (own or 2 * elements) + 2 * degrees
        elif own is not None:
            other.quadrature_degree = own + 2 * degrees
        return other

    def with_layer(self, layer: Layer | HardContact) -> Contact:
        """The same contact with another layer.

        Args:
            layer: The new law, or `HardContact()`.

        Raises:
            TypeError, ValueError: It is no layer, or hard contact with another quadrature than "mortar".
        """
        _check_layer(layer)
        if isinstance(layer, HardContact) and not RULES[self.quadrature].of_nodes:
            raise ValueError(
                f"layer = {layer!r} in contact {self.name!r} with quadrature = {self.quadrature!r}: the pressure would "
                "waver; expected a contact with quadrature='mortar'"
            )
        other = copy(self)
        other.layer = layer
        return other

    @property
    def mirrored(self) -> bool:
        """Whether it is the contact of a body with its mirror image: of the layer and the gap it has one half."""
        return any(body.mesh is None and body.mirrors for body, _ in self.sides)

    @property
    def sliding(self) -> Contact | None:
        """What resists sliding along the contact, as a contact of the same surfaces without a gap; None if nothing."""
        law = None if isinstance(self.layer, HardContact) else self.layer.sliding
        if law is None or self.mirrored:
            return None  # a body and its mirror image slide together
        other = copy(self)
        other.layer, other.gap, other.name = law, 0.0, f"{self.name}, sliding"
        return other

    def frozen(self) -> Contact:
        """The same contact with its present gap, detached from later changes of a parameter."""
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


def _check_layer(layer: Layer | HardContact) -> None:
    if not isinstance(layer, Layer | HardContact):
        raise TypeError(f"layer = {layer!r}: expected a layer, such as cd.PowerLayer(B, a), or cd.HardContact()")
