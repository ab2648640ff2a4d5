"""A discretised contact: the points of S_αβ with their weights and gaps, and how both bodies are seen from them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from ..base.arrays import Floats
from ..base.checks import as_floats
from ..base.facets import dot
from ..contact import Contact, Gap
from ..errors import MeshMismatchError
from ..field import evaluate
from ..quadrature import Rule, rule
from .pairing import PointPairs, matching, matching_on, pair_by_segments
from .smooth import smooth_places
from .surface import ContactSurface, Gather, PointSurface
from .trace import normal_trace


@dataclass(frozen=True)
class InterfaceSide:
    """A body seen from the n points of an interface.

    body: its place in the scene; trace: (n, dofs) from its displacement to u_n at the points; transfer: from values
    at the interface's points to the integration points of the body's own surface, where its Robin term lives.
    """

    body: int
    surface: ContactSurface
    trace: scipy.sparse.csr_matrix
    transfer: Gather | scipy.sparse.csr_matrix


@dataclass(frozen=True)
class PrescribedGap:
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

    x: (n, dim) where on the first surface, the smooth one behind its facets if they do not match the second's; normal:
    (n, dim) out of the first body; weights: (n,) areas; measured: (n,) the part of d found from the meshes; shape: (n,)
    that which is given, and how: given; sides: both bodies; unmatched: the area of either surface that has no partner;
    facets: on meshes that match, the second surface's opposite each of the first's; doubt: (n,) by how much `measured`
    may be off where the facets do not tell what surface is meant, None if they do. Contact integrals are sums over the
    points: J = Σ weights ∫₀^z g⁻.
    """

    contact: Contact
    x: Floats
    normal: Floats
    weights: Floats
    measured: Floats
    shape: Floats
    given: PrescribedGap
    sides: tuple[InterfaceSide, InterfaceSide]
    unmatched: tuple[float, float] = (0.0, 0.0)
    facets: NDArray[np.intp] | None = None
    doubt: Floats | None = None

    def __post_init__(self) -> None:
        # However the interface came about: its layer is the one at its points. One that varies nowhere is itself.
        object.__setattr__(self, "contact", self.contact.at(self.x.T))

    @cached_property
    def gap(self) -> Floats:
        """d at the points, (n,), counted from where the layer begins."""
        return self.measured + self.shape - self.contact.layer.clearance

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
    degree = max(body.degree for body, _ in contact.sides if body.mesh is not None)
    quadrature = rule(contact.quadrature, degree, contact.quadrature_degree)
    if any(body.mesh is None for body, _ in contact.sides):
        return _opposite_meshless(contact, bodies, quadrature)
    first, second = _surfaces(contact, quadrature)
    matched = matching(first, second, contact.reach) if facets is None else matching_on(first, second, facets)
    if matched is None:
        return _on_segments(contact, bodies, first, second)
    x, normal = first.mean(first.points.x), first.mean(first.points.normal)
    distance = dot(matched.in_order(second.mean(second.points.x)) - x, normal)
    measured = contact.measure_gap * without_rounding(distance, np.abs(x).max())
    given = PrescribedGap(smooth_places(first) if callable(contact.gap) else first.points.x, first.average)
    shape = given.at(contact.gap)
    sides = (
        InterfaceSide(bodies[0], first, first.mean(first.trace).tocsr(), first.spread()),
        InterfaceSide(
            bodies[1], second, matched.in_order(second.mean(second.trace).tocsr()), second.spread(matched.places)
        ),
    )
    facets = matched.facets
    return Interface(contact.frozen(), x, normal, first.value_weights, measured, shape, given, sides, facets=facets)


def _opposite_meshless(contact: Contact, bodies: tuple[int, int], quadrature: Rule) -> Interface:
    """The interface between a meshed surface and a body without a mesh, at the points of the meshed one."""
    meshed = next(i for i, (body, _) in enumerate(contact.sides) if body.mesh is not None)
    (body, surface), (partner, _) = contact.sides[meshed], contact.sides[1 - meshed]
    own = ContactSurface(body, surface, quadrature)
    x, normal, weights = own.mean(own.points.x), own.mean(own.points.normal), own.value_weights
    trace = scipy.sparse.csr_matrix(_checked("normal_displacement", partner.normal_displacement(x, normal), len(x), 2))
    places = smooth_places(own)
    distance = _checked("gap", partner.gap(own.mean(places), normal), len(x), 1)
    measured = contact.measure_gap * without_rounding(distance, np.abs(x).max())
    given = PrescribedGap(places, own.average)
    points = Gather(np.arange(len(x)), len(x))
    sides = [
        InterfaceSide(bodies[meshed], own, own.mean(own.trace).tocsr(), own.spread()),
        InterfaceSide(bodies[1 - meshed], PointSurface(weights, trace), trace, points),
    ]
    first, second = sides if meshed == 0 else reversed(sides)
    outward = normal if meshed == 0 else -normal
    return Interface(contact.frozen(), x, outward, weights, measured, given.at(contact.gap), given, (first, second))


def _checked(name: str, values: Any, points: int, dimensions: int) -> Floats:
    """What a body without a mesh says of some points, refused unless it is finite numbers for each."""
    array = as_floats(name, values, f"finite numbers of {points} points")
    if array.ndim != dimensions or len(array) != points or not np.all(np.isfinite(array)):
        raise ValueError(f"{name} of shape {array.shape}: expected finite numbers of {points} points")
    return array


def _surfaces(contact: Contact, quadrature: Rule) -> tuple[ContactSurface, ContactSurface]:
    """Both surfaces; where they are the same one of copies of a mesh, the second follows from the first."""
    (body, surface), (other, opposite) = contact.sides
    first = ContactSurface(body, surface, quadrature)
    if surface == opposite:
        isometry = other.elements.isometry_from(body.elements)
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
    partners = pair_by_segments(contact, first, second)
    if contact.quadrature == "facet":
        values, weights = partners.mean(), np.bincount(partners.segment, partners.weights)
        member = np.unique(partners.segment, return_index=True)[1]
    else:
        values, weights = scipy.sparse.eye(len(partners.weights), format="csr"), partners.weights
        member = np.arange(len(weights))
    normal = values @ partners.normal
    given = PrescribedGap(partners.middle, values)
    shape = given.at(contact.gap)
    sides = tuple(
        InterfaceSide(
            bodies[place],
            surface,
            (values @ _trace(surface, partners, place, sign)).tocsr(),
            _facet_means(surface, partners.facets[place][member], weights),
        )
        for place, (surface, sign) in enumerate(((first, 1.0), (second, -1.0)))
    )
    unmatched = tuple(_unmatched(surface, partners, place) for place, surface in enumerate((first, second)))
    return Interface(
        contact.frozen(),
        values @ partners.places[0],
        normal / np.linalg.norm(normal, axis=1, keepdims=True),
        weights,
        contact.measure_gap * (values @ without_rounding(partners.gap, np.abs(partners.places[0]).max())),
        shape,
        given,
        (sides[0], sides[1]),
        (unmatched[0], unmatched[1]),
        doubt=values @ partners.doubt if contact.measure_gap and partners.doubt.any() else None,
    )


def _trace(surface: ContactSurface, partners: PointPairs, place: int, sign: float) -> scipy.sparse.csr_matrix:
    """The normal displacement of one side, outwards, at the points, (n, dofs)."""
    trace = normal_trace(surface.body.space, partners.points[place], sign * partners.normal)
    smooth = partners.smooth[place]
    stretch = None if smooth is None else smooth.stretch_trace()
    return trace if stretch is None else trace + stretch


def _facet_means(surface: ContactSurface, owner: NDArray[np.intp], weights: Floats) -> scipy.sparse.csr_matrix:
    """From the values at an interface, `owner` their facets, to a body's own integration points: the facets' means.

    A facet that is only partly covered gets as much of the mean as is covered, so that ∫ φ keeps its value.
    """
    count = len(surface.facets)
    shares = (weights / surface.facet_areas[owner], (owner, np.arange(len(owner))))
    means = scipy.sparse.csr_matrix(shares, shape=(count, len(owner)))
    return means[np.repeat(np.arange(count), surface.per_facet)]


def _unmatched(surface: ContactSurface, partners: PointPairs, place: int) -> float:
    """The area of a surface that has no partner."""
    bare = np.maximum(surface.facet_areas - partners.covered(place, len(surface.facets)), 0.0)
    area, total = float(bare.sum()), float(surface.facet_areas.sum())
    return area if area > 1e-6 * total else 0.0  # less is what seams between curved facets leave
