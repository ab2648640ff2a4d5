"""A body: its mesh, material, supports and loads, and the forms (22) that they give in UFL."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from .kinematics import kinematics as find_kinematics
from .load import Load
from .material import Isotropic
from .mesh import Mesh
from .support import Support
from .trace import facet_entities


class Body:
    """One elastic body Ω_α.

    name: unique in a scene; mesh: a `Mesh`; material: its law (2); supports, loads: what holds and pushes it;
    degree: of the Lagrange elements; kinematics: "plane strain" (default in the plane), "plane stress" or "solid".
    Lengths, stresses and loads are in the user's own consistent set of units.
    """

    def __init__(
        self,
        name: str,
        mesh: Mesh,
        material: Isotropic,
        *,
        supports: Sequence[Support] = (),
        loads: Sequence[Load] = (),
        degree: int = 1,
        kinematics: str | None = None,
    ) -> None:
        if not isinstance(name, str) or not name:
            raise TypeError(f"name = {name!r}: expected a text")
        if not isinstance(mesh, Mesh):
            raise TypeError(f"mesh = {mesh!r}: expected a contactdd mesh, such as cd.rectangle(...) makes")
        if not hasattr(material, "stiffness"):
            raise TypeError(f"material = {material!r}: expected a material, such as cd.Isotropic(E, nu)")
        if int(degree) != degree or degree < 1:
            raise ValueError(f"degree = {degree!r}: expected a whole number >= 1")
        self.name = name
        self.mesh = mesh
        self.material = material
        self.supports = tuple(supports)
        self.loads = tuple(loads)
        self.degree = int(degree)
        self.kinematics = find_kinematics(kinematics, mesh.dim)
        self._check_surfaces()

    def __repr__(self) -> str:
        kind = self.kinematics.name
        return f"Body({self.name!r}, {self.mesh.cells} cells, degree {self.degree}, {self.material}, {kind})"

    @cached_property
    def space(self) -> fem.FunctionSpace:
        """The finite element space of the body's displacements."""
        return fem.functionspace(self.mesh.domain, ("Lagrange", self.degree, (self.mesh.dim,)))

    @cached_property
    def stiffness(self) -> Any:
        """The stiffness between the strains that take part; a constant, so that other numbers compile nothing anew."""
        return fem.Constant(self.mesh.domain, self.kinematics.reduce(self.material.stiffness()))

    @property
    def dx(self) -> ufl.Measure:
        return ufl.Measure("dx", domain=self.mesh.domain)

    def ds(self, surface: str, metadata: dict[str, Any] | None = None) -> ufl.Measure:
        """The measure of a named surface."""
        self.mesh.facets(surface)  # refuses an unknown name
        place = list(self.mesh.surfaces).index(surface)
        return ufl.Measure(
            "ds", domain=self.mesh.domain, subdomain_data=self._boundary, subdomain_id=place, metadata=metadata
        )

    @cached_property
    def _boundary(self) -> list[tuple[int, NDArray[np.int32]]]:
        """The (cell, local facet) pairs of every named surface; one object, which all integrals of a form share."""
        domain = self.mesh.domain
        return [(i, facet_entities(domain, facets).ravel()) for i, facets in enumerate(self.mesh.surfaces.values())]

    def stress(self, u: Any) -> Any:
        """Hooke's law (2): the stresses of the free Voigt components, a UFL vector."""
        return self.stiffness * self.kinematics.strain(u)

    def elastic_form(self, u: Any, v: Any) -> ufl.Form:
        """a(u, v) = ∫ σ(u) : ε(v) dx."""
        return ufl.inner(self.stress(u), self.kinematics.strain(v)) * self.dx

    def load_form(self, v: Any) -> ufl.Form | None:
        """l(v) = ∫ f·v dx + ∫ p·v ds, or None for a body without loads."""
        forms = [load.form(self, v) for load in self.loads]
        return sum(forms[1:], forms[0]) if forms else None

    def robin_form(self, u: Any, v: Any, phi: Any, surface: str, metadata: dict[str, Any]) -> ufl.Form:
        """∫ φ u_n v_n ds over a contact surface: the Robin term of (22), (32), (36)."""
        n = ufl.FacetNormal(self.mesh.domain)
        return phi * ufl.dot(u, n) * ufl.dot(v, n) * self.ds(surface, metadata)

    def _check_surfaces(self) -> None:
        """Refuse an unknown surface name now, not when the forms are made."""
        for item in (*self.supports, *self.loads):
            for surface in getattr(item, "surfaces", (getattr(item, "surface", None),)):
                if surface is not None:
                    self.mesh.facets(surface)
