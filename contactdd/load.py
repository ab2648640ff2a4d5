"""Loads: what stands in l(v) = ∫ f·v dx + ∫ p·v ds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import ufl

from .field import Field, coefficient

if TYPE_CHECKING:
    from .body import Body


@dataclass(frozen=True)
class Pressure:
    """A normal pressure on a named surface, positive when it pushes (stress units)."""

    surface: str
    value: Field

    def form(self, body: Body, v: Any) -> Any:
        p = coefficient("pressure", self.value, body.mesh.domain, (), body.degree + 2)
        return -p * ufl.dot(ufl.FacetNormal(body.mesh.domain), v) * body.ds(self.surface)


@dataclass(frozen=True)
class Traction:
    """A surface load vector on a named surface (stress units)."""

    surface: str
    value: Field

    def form(self, body: Body, v: Any) -> Any:
        p = coefficient("traction", self.value, body.mesh.domain, (body.mesh.dim,), body.degree + 2)
        return ufl.dot(p, v) * body.ds(self.surface)


@dataclass(frozen=True)
class BodyForce:
    """A force per unit volume."""

    value: Field

    def form(self, body: Body, v: Any) -> Any:
        f = coefficient("body force", self.value, body.mesh.domain, (body.mesh.dim,), body.degree + 2)
        return ufl.dot(f, v) * body.dx


Load = Pressure | Traction | BodyForce
