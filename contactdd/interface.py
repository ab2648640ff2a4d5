"""A discretised contact: the points of S_αβ with their weights and gaps, and how both bodies are seen from them."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import basix
import numpy as np
import scipy
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from . import compat
from .body import Body
from .contact import Contact, Gap
from .errors import MeshMismatchError
from .field import evaluate
from .isometry import Isometry
from .quadrature import Rule, rule
from .trace import FacetPoints, dot, facet_corners, facet_type, normal_trace, surface_points, surface_trace
from .transfer import Partners, by_segments, matching, matching_on

Floats = NDArray[np.float64]


class ContactSurface:
    """One body's side of a contact: its facets, and its normal displacement at the points of the quadrature rule.

    `integration points` are those at which ∫ φ u_n v_n is evaluated, facet by facet; `values` are the places where
    the law is: the same points or, for the rule "facet", the facets. points: the n integration points, per_facet on
    each facet; areas: (n,) what each stands for on the mesh; weights: (n,) in the body, the full ring of a body of
    revolution; trace: (n, dofs) from the displacement to u_n there.
    """

    def __init__(self, body: Body, surface: str, quadrature: Rule) -> None:
        self.body, self.surface, self.rule = body, surface, quadrature
        self.facets = body.mesh.facets(surface)
        self.entities = body.mesh.entities(surface)
        points, weights = quadrature.points(facet_type(body.mesh.domain))
        self.per_facet = len(points)
        self.points = surface_points(body.mesh.domain, self.entities, points)
        self.areas = (self.points.area.reshape(-1, len(points)) * weights).ravel()
        self.weights = self.areas * body.kinematics.weight(self.points.x.T)
        self.trace = surface_trace(body.space, self.entities, points, self.points.normal)

    def copied(self, body: Body, isometry: Isometry) -> ContactSurface:
        """The same surface of a body on a copy of the mesh, of the same degree."""
        other = copy(self)
        other.body, trace, signs = body, self.trace, isometry.signs
        other.points = self.points.turned(isometry)
        other.weights = self.areas * body.kinematics.weight(other.points.x.T)
        other.trace = copy(trace)
        other.trace.data = trace.data * signs[trace.indices % len(signs)]
        return other

    def spread(self, order: NDArray[np.intp] | None = None) -> Spread:
        """To the integration points from the values, or from values whose `order` tells where each of these stands."""
        per_value = self.per_facet if self.rule.name == "facet" else 1
        values = np.arange(len(self.weights)) // per_value
        return Spread(values if order is None else order[values], len(values) // per_value)

    @cached_property
    def value_weights(self) -> Floats:
        """The area that belongs to each value."""
        return self.facet_areas if self.rule.name == "facet" else self.weights

    @cached_property
    def average(self) -> scipy.sparse.csr_matrix | None:
        """From the integration points to the values: the mean over what belongs to each; None where they are one."""
        if self.rule.name != "facet":
            return None
        parts = (self.weights.reshape(-1, self.per_facet) / self.value_weights[:, None]).ravel()
        ends = np.arange(0, len(parts) + 1, self.per_facet)
        return scipy.sparse.csr_matrix((parts, np.arange(len(parts)), ends), shape=(len(ends) - 1, len(parts)))

    def mean(self, rows: Any) -> Any:
        """The rows (integration points, n) of an array or a sparse matrix, averaged to the values."""
        return rows if self.average is None else self.average @ rows

    @cached_property
    def facet_areas(self) -> Floats:
        """The area of each facet."""
        return self.weights.reshape(len(self.facets), -1).sum(axis=1)

    @cached_property
    def corners(self) -> Floats:
        """The corners in order around each facet, (facets, corners, dim)."""
        return facet_corners(self.body.mesh.domain, self.entities)

    @cached_property
    def centre(self) -> Floats:
        """The middle of the reference facet, (dim − 1,)."""
        return np.asarray(basix.geometry(facet_type(self.body.mesh.domain))).mean(axis=0)

    @cached_property
    def middles(self) -> FacetPoints:
        """The middle of every facet."""
        return surface_points(self.body.mesh.domain, self.entities, self.centre[None])

    @cached_property
    def nodal_trace(self) -> scipy.sparse.csr_matrix:
        """The normal displacement at the nodes of the surface, each once: what the paper's stopping rule looks at."""
        domain, dim = self.body.mesh.domain, self.body.mesh.dim
        nodes = basix.create_element(
            basix.ElementFamily.P, facet_type(domain), self.body.degree, basix.LagrangeVariant.equispaced
        ).points
        points = surface_points(domain, self.entities, nodes)
        size = np.sqrt(self.areas.max()) if dim == 3 else self.areas.max()
        _, first = np.unique(np.round(points.x / (1e-6 * size)), axis=0, return_index=True)
        return surface_trace(self.body.space, self.entities, nodes, points.normal)[np.sort(first)]

    @cached_property
    def robin(self) -> RobinTerm:
        """The surface's Robin term in UFL; made when a solver first asks for it."""
        return RobinTerm(self)


class RobinTerm:
    """∫ φ u_n v_n ds in UFL, φ a function on the submesh of the contact facets, refreshed at every iteration."""

    def __init__(self, surface: ContactSurface) -> None:
        body = surface.body
        submesh, parents, entity_map = compat.facet_submesh(body.mesh.domain, surface.facets)
        space = fem.functionspace(submesh, surface.rule.element(submesh.topology.cell_name()))
        self.phi = fem.Function(space, name="robin_coefficient")
        self._dofs = _value_dofs(surface, space, parents)
        u, v = ufl.TrialFunction(body.space), ufl.TestFunction(body.space)
        expression = body.robin_form(u, v, self.phi, surface.surface, surface.rule.metadata)
        self._form = compat.form(expression, entity_map)
        self._matrix = fem.create_matrix(self._form)

    def matrix(self, phi: Floats) -> scipy.sparse.csr_matrix:
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
class Spread:
    """The operator to points, each of which takes the value at its place (points,) among as many values as `size`."""

    places: NDArray[np.intp]
    size: int

    def __matmul__(self, values: Floats) -> Floats:
        return values[self.places]

    def __rmatmul__(self, matrix: scipy.sparse.csr_matrix) -> scipy.sparse.csr_matrix:
        entries = (matrix.data, self.places[matrix.indices], matrix.indptr)
        return scipy.sparse.csr_matrix(entries, shape=(matrix.shape[0], self.size))


@dataclass(frozen=True)
class Side:
    """A body seen from the n points of an interface.

    body: its place in the scene; trace: (n, dofs) from its displacement to u_n at the points; transfer: from values
    at the interface's points to the integration points of the body's own surface, where its Robin term lives.
    """

    body: int
    surface: ContactSurface
    trace: scipy.sparse.csr_matrix
    transfer: Spread | scipy.sparse.csr_matrix


@dataclass(frozen=True)
class GivenGap:
    """Where a given gap is evaluated, points (m, dim), and how the values at an interface follow, mean (n, m), None if
    they are the same."""

    points: Floats
    mean: scipy.sparse.csr_matrix | None

    def at(self, gap: Gap) -> Floats:
        values = evaluate("gap", gap, self.points.T)
        return values if self.mean is None else self.mean @ values


@dataclass(frozen=True)
class Interface:
    """A contact at n points, with the gap that it has for the present values of its parameters.

    x: (n, dim) where on the first surface; normal: (n, dim) out of the first body; weights: (n,) areas; measured: (n,)
    the part of d found from the meshes; shape: (n,) that which is given, and how: given; sides: both bodies; unmatched:
    the area of either surface that has no partner; facets: on meshes that match, the second surface's opposite each of
    the first's. Contact integrals are sums over the points: J = Σ weights ∫₀^z g⁻.
    """

    contact: Contact
    x: Floats
    normal: Floats
    weights: Floats
    measured: Floats
    shape: Floats
    given: GivenGap
    sides: tuple[Side, Side]
    unmatched: tuple[float, float] = (0.0, 0.0)
    facets: NDArray[np.intp] | None = None

    @cached_property
    def gap(self) -> Floats:
        """d at the points, (n,)."""
        return self.measured + self.shape

    def refreshed(self, contact: Contact) -> Interface:
        """The same interface for the present gap of the user's contact; everything else is shared."""
        return replace(self, contact=contact.frozen(), shape=self.given.at(contact.gap))


def without_rounding(distance: Floats, size: float) -> Floats:
    """Distances between surfaces whose coordinates are up to `size`, those that are rounding alone made zero.

    Else bodies that touch would do so or not by the last bit of their coordinates.
    """
    return np.where(np.abs(distance) <= 1e-13 * size, 0.0, distance)


def discretise(contact: Contact, bodies: tuple[int, int], facets: NDArray[np.intp] | None = None) -> Interface:
    """The interface of a contact between the bodies at the given places of a scene.

    facets: the second surface's opposite each of the first's, where they are known to match.
    """
    degree = max(body.degree for body, _ in contact.sides)
    quadrature = rule(contact.quadrature, degree, contact.quadrature_degree)
    first, second = _surfaces(contact, quadrature)
    matched = matching(first, second, contact.reach) if facets is None else matching_on(first, second, facets)
    if matched is None:
        return _on_segments(contact, bodies, first, second)
    x, normal = first.mean(first.points.x), first.mean(first.points.normal)
    distance = dot(matched.in_order(second.mean(second.points.x)) - x, normal)
    measured = contact.measure_gap * without_rounding(distance, np.abs(x).max())
    given = GivenGap(first.points.x, first.average)
    shape = given.at(contact.gap)
    sides = (
        Side(bodies[0], first, first.mean(first.trace).tocsr(), first.spread()),
        Side(bodies[1], second, matched.in_order(second.mean(second.trace).tocsr()), second.spread(matched.places)),
    )
    facets = matched.facets
    return Interface(contact.frozen(), x, normal, first.value_weights, measured, shape, given, sides, facets=facets)


def _surfaces(contact: Contact, quadrature: Rule) -> tuple[ContactSurface, ContactSurface]:
    """Both surfaces; where they are the same one of copies of a mesh, the second follows from the first."""
    (body, surface), (other, opposite) = contact.sides
    first = ContactSurface(body, surface, quadrature)
    if surface == opposite and body.degree == other.degree:
        isometry = other.mesh.isometry_from(body.mesh)
        if isometry is not None:
            return first, first.copied(other, isometry)
    return first, ContactSurface(other, opposite, quadrature)


def _on_segments(contact: Contact, bodies: tuple[int, int], first: ContactSurface, second: ContactSurface) -> Interface:
    """The interface between meshes that do not match; the rule "facet" takes one value per segment."""
    if contact.quadrature == "vertex":
        raise MeshMismatchError(
            f"contact {contact.name!r}: quadrature = 'vertex' needs meshes that match along the contact; "
            "expected 'gauss' or 'facet'"
        )
    partners = by_segments(contact, first, second)
    if contact.quadrature == "facet":
        values, weights = partners.mean(), np.bincount(partners.segment, partners.weights)
        member = np.unique(partners.segment, return_index=True)[1]
    else:
        values, weights = scipy.sparse.eye(len(partners.weights), format="csr"), partners.weights
        member = np.arange(len(weights))
    normal = values @ partners.normal
    given = GivenGap(partners.middle, values)
    shape = given.at(contact.gap)
    sides = tuple(
        Side(
            bodies[place],
            surface,
            (values @ normal_trace(surface.body.space, partners.points[place], sign * partners.normal)).tocsr(),
            _facet_means(surface, partners.facets[place][member], weights),
        )
        for place, (surface, sign) in enumerate(((first, 1.0), (second, -1.0)))
    )
    unmatched = tuple(_unmatched(surface, partners, place) for place, surface in enumerate((first, second)))
    return Interface(
        contact.frozen(),
        values @ partners.points[0].x,
        normal / np.linalg.norm(normal, axis=1, keepdims=True),
        weights,
        contact.measure_gap * (values @ without_rounding(partners.gap, np.abs(partners.points[0].x).max())),
        shape,
        given,
        (sides[0], sides[1]),
        (unmatched[0], unmatched[1]),
    )


def _facet_means(surface: ContactSurface, owner: NDArray[np.intp], weights: Floats) -> scipy.sparse.csr_matrix:
    """From the values at an interface, `owner` their facets, to a body's own integration points: the facets' means.

    A facet that is only partly covered gets as much of the mean as is covered, so that ∫ φ keeps its value.
    """
    count = len(surface.facets)
    shares = (weights / surface.facet_areas[owner], (owner, np.arange(len(owner))))
    means = scipy.sparse.csr_matrix(shares, shape=(count, len(owner)))
    return means[np.repeat(np.arange(count), surface.per_facet)]


def _unmatched(surface: ContactSurface, partners: Partners, place: int) -> float:
    """The area of a surface that has no partner."""
    bare = np.maximum(surface.facet_areas - partners.covered(place, len(surface.facets)), 0.0)
    area, total = float(bare.sum()), float(surface.facet_areas.sum())
    return area if area > 1e-6 * total else 0.0  # less is what seams between curved facets leave
