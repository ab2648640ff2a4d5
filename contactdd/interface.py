"""A discretised contact: the points of S_αβ with their weights and gaps, and how both bodies are seen from them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import basix
import numpy as np
import scipy.sparse as sp
from dolfinx import fem
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from . import compat
from .body import Body
from .contact import Contact
from .errors import MeshMismatchError
from .field import evaluate
from .quadrature import Rule, rule
from .trace import facet_entities, facet_points, normal_trace

Floats = NDArray[np.float64]


class ContactSurface:
    """One body's side of a contact: its facets, and its normal displacement at the points of the quadrature rule.

    `integration points` are those at which ∫ φ u_n v_n is evaluated, facet by facet; `values` are the places where
    the law is: the same points or, for the rule "facet", the facets. areas: what each integration point stands for on
    the mesh; weights: in the body, the full ring of a body of revolution.
    """

    def __init__(self, body: Body, surface: str, quadrature: Rule) -> None:
        self.body, self.surface, self.rule = body, surface, quadrature
        self.facets = body.mesh.facets(surface)
        entities = facet_entities(body.mesh.domain, self.facets)
        cell = compat.coordinate_map(body.mesh.domain).cell_type
        points, weights = quadrature.points(basix.cell.subentity_types(cell)[body.mesh.dim - 1][0])
        self.per_facet = len(points)
        self.points = facet_points(
            body.mesh.domain, np.repeat(entities, len(points), axis=0), np.tile(points, (len(entities), 1))
        )
        self.areas = np.tile(weights, len(entities)) * self.points.area
        self.weights = self.areas * body.kinematics.weight(self.points.x.T)
        self.trace = normal_trace(body.space, self.points)

    @cached_property
    def spread(self) -> sp.csr_matrix:
        """From the values to the integration points: the identity or, one value per facet, its repetition."""
        points, per_value = len(self.weights), self.per_facet if self.rule.name == "facet" else 1
        rows = np.arange(points)
        return sp.csr_matrix((np.ones(points), (rows, rows // per_value)), shape=(points, points // per_value))

    @cached_property
    def value_weights(self) -> Floats:
        """The area that belongs to each value."""
        return self.spread.T @ self.weights

    @cached_property
    def average(self) -> sp.csr_matrix:
        """From the integration points to the values: the mean over what belongs to each."""
        if self.rule.name != "facet":
            return self.spread
        return sp.diags(1.0 / self.value_weights) @ self.spread.T @ sp.diags(self.weights)

    @cached_property
    def facet_of_value(self) -> NDArray[np.intp]:
        """The position in `facets` that each value belongs to."""
        per_facet = 1 if self.rule.name == "facet" else self.per_facet
        return np.arange(len(self.value_weights)) // per_facet

    @cached_property
    def nodal_trace(self) -> sp.csr_matrix:
        """The normal displacement at the nodes of the surface, each node once: what the paper's stopping rule looks at."""
        domain, dim = self.body.mesh.domain, self.body.mesh.dim
        facet = basix.cell.subentity_types(compat.coordinate_map(domain).cell_type)[dim - 1][0]
        nodes = basix.create_element(
            basix.ElementFamily.P, facet, self.body.degree, basix.LagrangeVariant.equispaced
        ).points
        entities = np.repeat(facet_entities(domain, self.facets), len(nodes), axis=0)
        points = facet_points(domain, entities, np.tile(nodes, (len(self.facets), 1)))
        size = np.sqrt(self.areas.max()) if dim == 3 else self.areas.max()
        _, first = np.unique(np.round(points.x / (1e-6 * size)), axis=0, return_index=True)
        return normal_trace(self.body.space, points)[np.sort(first)]

    @cached_property
    def robin(self) -> RobinTerm:
        """The surface's Robin term in UFL; made when a solver first asks for it."""
        return RobinTerm(self)


class RobinTerm:
    """∫ φ u_n v_n ds in UFL, φ a function on the submesh of the contact facets, refreshed at every iteration."""

    def __init__(self, surface: ContactSurface) -> None:
        import ufl

        body = surface.body
        submesh, parents, entity_map = compat.facet_submesh(body.mesh.domain, surface.facets)
        space = fem.functionspace(submesh, surface.rule.element(submesh.topology.cell_name()))
        self.phi = fem.Function(space, name="robin_coefficient")
        self._dofs = _value_dofs(surface, space, parents)
        u, v = ufl.TrialFunction(body.space), ufl.TestFunction(body.space)
        expression = body.robin_form(u, v, self.phi, surface.surface, surface.rule.metadata)
        self._form = compat.form(expression, entity_map)
        self._matrix = fem.create_matrix(self._form)

    def matrix(self, phi: Floats) -> sp.csr_matrix:
        """The assembled Robin term for the coefficient's values; its sparsity is always the same."""
        self.phi.x.array[self._dofs] = phi
        self.phi.x.scatter_forward()
        self._matrix.set_value(0.0)
        fem.assemble_matrix(self._matrix, self._form)
        return self._matrix.to_scipy().tocsr()


def _value_dofs(surface: ContactSurface, space: fem.FunctionSpace, parents: NDArray[np.int32]) -> NDArray[np.int32]:
    """The degree of freedom of φ that belongs to each of the surface's values.

    The points of a facet come in the submesh's own order, so they are recognised by where they are.
    """
    cells = np.argsort(parents)  # the surface's facets are sorted
    dofs = space.dofmap.list[cells]
    if surface.rule.name == "facet":
        return dofs[:, 0]
    dim = surface.body.mesh.dim
    there = space.tabulate_dof_coordinates()[dofs][:, :, :dim]
    here = surface.points.x.reshape(len(cells), -1, dim)
    nearest = np.argmin(np.linalg.norm(here[:, :, None] - there[:, None], axis=-1), axis=2)
    return np.take_along_axis(dofs, nearest, axis=1).ravel()


@dataclass(frozen=True)
class Side:
    """A body seen from the n points of an interface.

    body: its place in the scene; trace: (n, dofs) from its displacement to u_n at the points; transfer: from values
    at the interface's points to the integration points of the body's own surface, where its Robin term lives.
    """

    body: int
    surface: ContactSurface
    trace: sp.csr_matrix
    transfer: sp.csr_matrix


@dataclass(frozen=True)
class Interface:
    """A contact at n points, with the gap that it has for the present values of its parameters.

    x: (n, dim) where on the first surface; normal: (n, dim) its outward normal; weights: (n,) areas; gap: (n,) d;
    sides: both bodies. All contact integrals are sums over the points: J = Σ weights ∫₀^z g⁻.
    """

    contact: Contact
    x: Floats
    normal: Floats
    weights: Floats
    gap: Floats
    shape: Floats
    sides: tuple[Side, Side]

    def refreshed(self, contact: Contact) -> Interface:
        """The same interface for the present gap of the user's contact; everything else is shared."""
        shape = self.sides[0].surface.average @ evaluate("gap", contact.gap, self.sides[0].surface.points.x.T)
        return replace(self, contact=contact.frozen(), gap=self.gap - self.shape + shape, shape=shape)


def discretise(contact: Contact, bodies: tuple[int, int]) -> Interface:
    """The interface of a contact between the bodies at the given places of a scene."""
    degree = max(body.degree for body, _ in contact.sides)
    quadrature = rule(contact.quadrature, degree, contact.quadrature_degree)
    first, second = (ContactSurface(body, surface, quadrature) for body, surface in contact.sides)
    partner = _partners(contact, first, second)
    x, normal = first.average @ first.points.x, first.average @ first.points.normal
    distance = np.sum(((second.average @ second.points.x)[partner] - x) * normal, axis=1)
    shape = first.average @ evaluate("gap", contact.gap, first.points.x.T)
    swap = sp.csr_matrix((np.ones(len(partner)), (np.arange(len(partner)), partner)))
    sides = (
        Side(bodies[0], first, (first.average @ first.trace).tocsr(), first.spread),
        Side(bodies[1], second, (swap @ second.average @ second.trace).tocsr(), (second.spread @ swap.T).tocsr()),
    )
    return Interface(contact.frozen(), x, normal, first.value_weights, distance + shape, shape, sides)


def _partners(contact: Contact, first: ContactSurface, second: ContactSurface) -> NDArray[np.intp]:
    """The second surface's value that lies opposite each of the first's, on meshes that match."""
    dim, n = first.body.mesh.dim, len(first.facets)
    middles = [side.points.x.reshape(len(side.facets), -1, dim).mean(axis=1) for side in (first, second)]
    facet = cKDTree(middles[1]).query(middles[0])[1]
    if len(second.facets) != n or len(np.unique(facet)) != n:
        raise MeshMismatchError(f"contact {contact.name!r}: {n} facets against {len(second.facets)} that do not match")
    if first.rule.name == "facet":
        return facet
    here, there = (side.points.x.reshape(n, -1, dim) for side in (first, second))
    # Only the offset across the contact may differ, so points are compared within the facets' planes.
    offset = here[:, :, None] - there[facet][:, None]
    normal = first.points.normal.reshape(n, -1, 1, dim)
    tangential = np.linalg.norm(offset - np.sum(offset * normal, axis=-1, keepdims=True) * normal, axis=-1)
    size = np.sqrt(first.areas.reshape(n, -1).sum(axis=1).max()) if dim == 3 else first.areas.sum() / n
    if tangential.min(axis=2).max() > 1e-6 * size:
        raise MeshMismatchError(f"contact {contact.name!r}: the facets of the two surfaces do not match")
    return (facet[:, None] * first.per_facet + np.argmin(tangential, axis=2)).ravel()
