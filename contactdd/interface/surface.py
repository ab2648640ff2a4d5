"""One body's side of a contact: its facets, integration points, and normal displacement there."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import basix
import numpy as np
import scipy
from numpy.typing import NDArray

from ..base.arrays import Floats
from ..base.facets import FacetPoints, facet_corners, facet_type, surface_points
from ..base.isometry import Isometry
from ..body import Body
from ..quadrature import Quadrature
from .overlap import axes_across
from .trace import surface_trace


class ContactSurface:
    """One body's side of a contact: its facets, and its normal displacement at the points of the quadrature rule.

    `integration points` are those at which ∫ φ u_n v_n is evaluated, facet by facet; `values` are the places where
    φ is given: the same points or, for the rule "facet", the facets. points: the n integration points, per_facet on
    each facet and per_value for each value; areas: (n,) what each stands for on the mesh; weights: (n,) in the body,
    the full ring of a body of revolution; trace: (n, dofs) from the displacement to u_n there; across: None, or the
    tangent that u_n is counted along instead, 0 or in space 1.
    """

    across: int | None = None

    def __init__(self, body: Body, surface: str, quadrature: Quadrature) -> None:
        self.body, self.surface, self.rule = body, surface, quadrature
        self.facets = body.mesh.facets(surface)
        self.entities = body.mesh.entities(surface)
        points, weights = quadrature.points(facet_type(body.mesh.domain))
        self._reference = points
        self.per_facet = len(points)
        self.per_value = quadrature.points_per_value(len(points))
        self.points = surface_points(body.mesh.domain, self.entities, points)
        self.areas = (self.points.area.reshape(-1, len(points)) * weights).ravel()
        self.weights = self.areas * body.kinematics.weight(self.points.x.T)
        self.trace = self._trace(self.points.normal)

    def copied(self, body: Body, surface: str, isometry: Isometry) -> ContactSurface:
        """The surface of a body on a copy of the mesh, of the same degree; surface: its name there."""
        other = copy(self)
        for name in [name for name in vars(self) if isinstance(getattr(ContactSurface, name, None), cached_property)]:
            del vars(other)[name]
        other.body, other.surface, other.facets = body, surface, body.mesh.facets(surface)
        other.points = self.points.turned(isometry)
        other.weights = self.areas * body.kinematics.weight(other.points.x.T)
        if isometry.mirrors:
            signs = isometry.signs
            other.trace = copy(self.trace)
            other.trace.data = self.trace.data * signs[self.trace.indices % len(signs)]
        return other

    def sliding(self, across: int) -> ContactSurface:
        """The same surface, its displacements along one of its tangents in place of the normal."""
        other = copy(self)
        other.across = across
        vars(other).pop("nodal_trace", None)
        other.trace = self._trace(other._directed(self.points.normal))
        return other

    def trace_along(self, axis: Floats) -> scipy.sparse.csr_matrix:
        """The operator (n, dofs) to the displacement along an axis (dim,)."""
        return self._trace(np.broadcast_to(axis, self.points.normal.shape))

    def _trace(self, directions: Floats) -> scipy.sparse.csr_matrix:
        """The operator (n, dofs) to the displacements along directions (n, dim)."""
        return surface_trace(self.body.space, self.entities, self._reference, directions)

    def _directed(self, normal: Floats) -> Floats:
        """The directions that displacements are counted along where the normals are these, (n, dim)."""
        return normal if self.across is None else axes_across(normal)[:, self.across]

    def spread(self, order: NDArray[np.intp] | None = None) -> Gather:
        """The operator from values, in their own order or at the positions `order`, to the integration points."""
        values = np.arange(len(self.weights)) // self.per_value
        return Gather(values if order is None else order[values], len(values) // self.per_value)

    @cached_property
    def value_weights(self) -> Floats:
        """The area that belongs to each value."""
        return self.weights.reshape(-1, self.per_value).sum(axis=1)

    @cached_property
    def average(self) -> scipy.sparse.csr_matrix | None:
        """From the integration points to the values: the mean over what belongs to each; None where they are one."""
        if self.per_value == 1:
            return None
        parts = (self.weights.reshape(-1, self.per_value) / self.value_weights[:, None]).ravel()
        ends = np.arange(0, len(parts) + 1, self.per_value)
        return scipy.sparse.csr_matrix((parts, np.arange(len(parts)), ends), shape=(len(ends) - 1, len(parts)))

    def mean(self, rows: Any) -> Any:
        """The rows (integration points, n) of an array or a sparse matrix, averaged to the values."""
        return rows if self.average is None else self.average @ rows

    def mean_along(self, axis: Floats) -> scipy.sparse.csr_matrix:
        """The operator to the mean displacement along an axis (dim,) at the values."""
        return self.mean(self.trace_along(axis)).tocsr()

    @cached_property
    def facet_areas(self) -> Floats:
        """The area of each facet."""
        return self.weights.reshape(len(self.facets), -1).sum(axis=1)

    @cached_property
    def facet_sizes(self) -> Floats:
        """The length of each facet, in space the root of its area, (facets,)."""
        areas = self.areas.reshape(len(self.facets), -1).sum(axis=1)
        return areas if self.body.mesh.dim == 2 else np.sqrt(areas)

    @cached_property
    def stiffnesses(self) -> Floats:
        """E/h of each facet, the stiffness of a layer that is as stiff as it, (facets,)."""
        return self.moduli / self.facet_sizes

    @cached_property
    def moduli(self) -> Floats:
        """Young's modulus of the body at each facet, the least of its directions, (facets,)."""
        x = np.zeros((3, len(self.facets)))
        x[: self.body.mesh.dim] = self.middles.x.T
        compliance = np.linalg.inv(self.body.stiffness_at(x, self.entities[:, 0]))
        return np.broadcast_to(1.0 / compliance[..., range(3), range(3)].max(axis=-1), len(self.facets))

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
        nodes = np.asarray(
            basix.create_element(
                basix.ElementFamily.P, facet_type(domain), self.body.degree, basix.LagrangeVariant.equispaced
            ).points
        )
        points = surface_points(domain, self.entities, nodes)
        size = np.sqrt(self.areas.max()) if dim == 3 else self.areas.max()
        _, first = np.unique(np.round(points.x / (1e-6 * size)), axis=0, return_index=True)
        return surface_trace(self.body.space, self.entities, nodes, self._directed(points.normal))[np.sort(first)]


@dataclass(frozen=True)
class PointSurface:
    """The side of a body without a mesh: the n points of the interface themselves.

    weights: (n,) areas; trace: (n, dofs) from its degrees of freedom to u_n; surface: its name; stiffnesses: (n,) E/h,
    and corners: (facets, corners, dim) of its own points, None if it has none.
    """

    weights: Floats
    trace: scipy.sparse.csr_matrix
    surface: str = ""
    stiffnesses: Floats | None = None
    corners: Floats | None = None

    @property
    def nodal_trace(self) -> scipy.sparse.csr_matrix:
        """u_n where the paper's stopping rule looks: it has no other nodes than the points."""
        return self.trace

    def mean(self, rows: Any) -> Any:
        """The rows (points, n) of an array or a matrix at the values, which are the points."""
        return rows


@dataclass(frozen=True)
class Gather:
    """The operator to points, each of which takes the value at its place (points,) among as many values as `size`."""

    places: NDArray[np.intp]
    size: int

    def __matmul__(self, values: Floats) -> Floats:
        return values[self.places]

    def __rmatmul__(self, matrix: scipy.sparse.csr_matrix) -> scipy.sparse.csr_matrix:
        entries = (matrix.data, self.places[matrix.indices], matrix.indptr)
        return scipy.sparse.csr_matrix(entries, shape=(matrix.shape[0], self.size))
