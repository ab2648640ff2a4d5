"""The assembled forms of a body: the matrices of its stiffness and its springs, and its load vector.

Bodies with a constant material and constant pressures are of few kinds, which differ in numbers only. UFL and the
compiler see such a form once per kind, not once per body.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import scipy
import ufl
from dolfinx import fem
from numpy.typing import ArrayLike, NDArray

from ..base import compat
from ..base.arrays import Floats
from ..base.checks import finite
from ..body import Body
from ..kinematics import KINEMATICS
from ..load import BodyLoad, Load, Pressure, is_eigenstrain
from ..parameter import current


def stiffness_matrix(body: Body) -> scipy.sparse.bsr_matrix:
    """∫ σ(u) : ε(v) dx for all degrees of freedom, in blocks of the nodes."""
    if body.material.varies:
        u, v = ufl.TrialFunction(body.space), ufl.TestFunction(body.space)
        return _matrix(compat.form(body.elastic_form(u, v)))
    metadata = body.elastic_metadata or {}
    shared = _elasticity(*_elements(body), body.kinematics.name, metadata.get("quadrature_degree"))
    stiffness = body.kinematics.reduce(body.material.stiffness())
    return _matrix(shared.on(body, stiffness, np.arange(body.mesh.cells, dtype=np.int32)))


def spring_matrix(body: Body) -> scipy.sparse.csr_matrix:
    """∫ k u·v ds of all springs."""
    forms = body.spring_forms(ufl.TrialFunction(body.space), ufl.TestFunction(body.space))
    return sum((_matrix(compat.form(form)).tocsr() for form in forms), scipy.sparse.csr_matrix((body.dofs, body.dofs)))


def load_vectors(body: Body) -> tuple[Floats, Floats | None]:
    """l(v) for all degrees of freedom, and the part of it that eigenstrains are; None without any."""
    total: Floats = np.zeros(body.dofs)
    strains: Floats | None = None
    for load in body.loads:
        vector = one_load(body, load)
        total = total + vector
        if is_eigenstrain(load):
            strains = vector if strains is None else strains + vector
    return total, strains


def eigenstrain_energy(body: Body) -> float:
    """½ ∫ ε₀ : C : ε₀ dx, the energy that the body would store if it were held at every point."""
    return float(fem.assemble_scalar(compat.form(body.eigenstrain_energy_form())))


def one_load(body: Body, load: Load) -> Floats:
    """The vector of one load, that of a constant pressure by the form that all such share."""
    value = current(load.value) if isinstance(load, Pressure) else None
    if not isinstance(load, Pressure) or not np.isscalar(value):
        return _own_load(body, load)
    shared = _pressure(*_elements(body), body.kinematics.name)
    facets = body.mesh.entities(load.surface).ravel()
    return fem.assemble_vector(shared.on(body, finite("pressure", value), facets)).array


def _own_load(body: Body, load: Load) -> Floats:
    """The vector of a load by a form of its own."""
    if isinstance(load, BodyLoad):
        vector = load.vector(body)
    else:
        vector = fem.assemble_vector(compat.form(load.form(body.elements, ufl.TestFunction(body.space)))).array
    if not np.isfinite(vector.sum()):
        raise ValueError(f"body {body.name!r}: its {type(load).__name__} gives forces that are no finite numbers")
    return vector


@dataclass(frozen=True)
class SharedForm:
    """A compiled form of one integral with one constant in it.

    arguments: how many test and trial functions; place: the integral's kind and the number of its part of the mesh.
    """

    compiled: Any
    arguments: int
    place: tuple[fem.IntegralType, int]

    def on(self, body: Body, value: ArrayLike, entities: NDArray[np.int32]) -> fem.Form:
        """The form on cells or (cell, local facet) pairs of a body, with the constant's value."""
        kind, number = self.place
        return compat.bound(self.compiled, [body.space] * self.arguments, {kind: [(number, entities)]}, value)


@cache
def _elasticity(coordinates: Any, element: Any, kinematics: str, degree: int | None) -> SharedForm:
    """∫ ε(v) : C : ε(u), C constant, by a quadrature of that degree."""
    domain, kind = ufl.Mesh(coordinates), KINEMATICS[kinematics]
    space = ufl.FunctionSpace(domain, element)
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    stiffness = ufl.Constant(domain, (len(kind.components),) * 2)
    metadata = {} if degree is None else {"quadrature_degree": degree}
    dx = ufl.Measure("dx", domain=domain, metadata=metadata)
    energy = ufl.inner(stiffness * kind.strain(u), kind.strain(v))
    form = kind.weight(ufl.SpatialCoordinate(domain)) * energy * dx
    return SharedForm(compat.compiled(form), 2, (fem.IntegralType.cell, -1))


@cache
def _pressure(coordinates: Any, element: Any, kinematics: str) -> SharedForm:
    """−∫ p v_n ds, p constant."""
    domain, kind = ufl.Mesh(coordinates), KINEMATICS[kinematics]
    v = ufl.TestFunction(ufl.FunctionSpace(domain, element))
    p = ufl.Constant(domain)
    work = -p * ufl.dot(ufl.FacetNormal(domain), v)
    form = kind.weight(ufl.SpatialCoordinate(domain)) * work * ufl.ds(1, domain=domain)
    return SharedForm(compat.compiled(form), 1, (fem.IntegralType.exterior_facet, 1))


def _elements(body: Body) -> tuple[Any, Any]:
    """The elements of a body's coordinates and displacements."""
    return body.mesh.domain.ufl_domain().ufl_coordinate_element(), body.space.ufl_element()


def _matrix(form: fem.Form) -> scipy.sparse.bsr_matrix:
    return fem.assemble_matrix(form).to_scipy()
