"""A discretised contact: the points of S_αβ with weights and gaps, and u_n of both bodies there."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache, cached_property, partial
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from ..base.arrays import Floats
from ..base.checks import as_floats
from ..base.facets import dot
from ..contact import Contact, Gap
from ..contact_result import closed_points
from ..errors import MeshMismatchError
from ..field import evaluate
from ..hard_contact import HardContact, augmented_layer
from ..layer import Layer
from ..meshless import MeshlessBody
from ..quadrature import Quadrature, Sampling, find_quadrature
from .nodal import LinearFunctions, hats, node_coordinates, side_of_nodes
from .pairing import Matching, PointPairs, matching, matching_on, pair_by_segments
from .smooth import smooth_places
from .surface import ContactSurface, Gather, PointSurface
from .trace import normal_trace


@dataclass(frozen=True)
class InterfaceSide:
    """One body's side of an interface of n points.

    body: its index in the scene; trace: (n, dofs) from its displacement to u_n at the points; make_transfer: makes
    `transfer`; along: gives the same operator to its displacement along an axis (dim,).
    """

    body: int
    surface: ContactSurface | PointSurface
    trace: scipy.sparse.csr_matrix
    make_transfer: Callable[[], Gather | scipy.sparse.csr_matrix]
    along: Callable[[Floats], scipy.sparse.csr_matrix]

    @cached_property
    def transfer(self) -> Gather | scipy.sparse.csr_matrix:
        """From values at the interface's points to the integration points of the body's own surface, for its Robin
        term."""
        return self.make_transfer()

    @property
    def meshed(self) -> ContactSurface:
        """The surface of a body that has a mesh."""
        if not isinstance(self.surface, ContactSurface):
            raise TypeError(f"body {self.body} of the scene has no mesh; expected one with facets")
        return self.surface


@dataclass(frozen=True)
class PrescribedGap:
    """The evaluation of a prescribed gap.

    points: (m, dim) where it is evaluated; mean: (n, m) from these values to those at an interface, None if they are
    the same; part: how much of it lies on this side of the contact.
    """

    points: Floats
    mean: scipy.sparse.csr_matrix | None
    part: float = 1.0

    def at(self, gap: Gap) -> Floats:
        values = self.part * evaluate("gap", gap, self.points.T)
        return values if self.mean is None else self.mean @ values


@dataclass(frozen=True)
class Interface:
    """A contact at n points, with the gap that it has for the present values of its parameters.

    x: (n, dim) coordinates on the first surface, the smooth one behind its facets if they do not match the second's, or
    the nodes of either; normal: (n, dim) out of the first body; weights: (n,) areas; geometric_gap: (n,) the part of
    the initial gap d found from the meshes; prescribed_gap: (n,) the part prescribed by the user; prescription: how to
    evaluate that part again; sides: both bodies; nodal: from both sides' surfaces to the linear functions of one's
    nodes; unpaired_area: the area of either surface that has no partner; facets: on meshes that match, the second
    surface's opposite each of the first's; gathered: (nodes, n) from the points' values to all nodes of a surface, None
    where the points are no nodes; centres: (n, dim) the centres of what acts at nodes, ∫ ψ x / ∫ ψ, None where they are
    `x`; doubt: (n,) the uncertainty of `geometric_gap` where the facets leave open which surface is meant, None if they
    do not; slides: None, or the index of the contact whose sliding along an axis this interface is, `normal` then being
    that axis; layer: the contact's law at the points, a hard contact's `AugmentedLayer`. Contact integrals are sums
    over the points: J = Σ weights ∫₀^z g⁻.
    """

    contact: Contact
    x: Floats
    normal: Floats
    weights: Floats
    geometric_gap: Floats
    prescribed_gap: Floats
    prescription: PrescribedGap
    sides: tuple[InterfaceSide, InterfaceSide]
    nodal: Callable[..., LinearFunctions]
    unpaired_area: tuple[float, float] = (0.0, 0.0)
    facets: NDArray[np.intp] | None = None
    gathered: scipy.sparse.csr_matrix | None = None
    centres: Floats | None = None
    doubt: Floats | None = None
    slides: int | None = None
    layer: Layer = field(init=False)

    def __post_init__(self) -> None:
        # However the interface came about: its law is the one of its contact, at its points.
        object.__setattr__(self, "layer", self._law())

    def _law(self) -> Layer:
        layer = self.contact.layer
        if isinstance(layer, HardContact):
            return augmented_layer(layer, min(float(each.max()) for each in self._stiffnesses_of_hard))
        law = layer.at(self.x.T)
        return _half(law) if self.mirrored else law

    @property
    def measured(self) -> Floats:
        """The former name of `geometric_gap`; warns."""
        warnings.warn("Interface.measured is now called geometric_gap", DeprecationWarning, stacklevel=2)
        return self.geometric_gap

    @cached_property
    def functions(self) -> LinearFunctions:
        """The linear functions of the nodes of one surface."""
        return self.nodal(*(side.surface for side in self.sides))

    def nodal_field(self, pressure: Floats) -> Floats:
        """A pressure at the points, L²-projected onto the linear functions: its values at all nodes of their surface.

        Zero where the contact does not reach.
        """
        if self.gathered is not None:
            return self.gathered @ pressure
        return self.functions.everywhere(self.functions.projected(pressure, self.weights))

    @cached_property
    def facet_stiffness(self) -> float:
        """E/h of the softer body's facets, the stiffness of a layer that is as stiff as they are."""
        return min((float(np.median(stiffnesses)) for stiffnesses in self._facet_stiffnesses), default=np.inf)

    @property
    def _facet_stiffnesses(self) -> list[Floats]:
        """E/h of the facets of both surfaces that have a mesh, or at the points of those that have none."""
        found = [side.surface.stiffnesses for side in self.sides]
        return [stiffnesses for stiffnesses in found if stiffnesses is not None]

    @property
    def _stiffnesses_of_hard(self) -> list[Floats]:
        """The same, which a hard contact cannot be without."""
        if not self._facet_stiffnesses:
            names = " and ".join(repr(body.name) for body, _ in self.contact.sides)
            raise ValueError(f"contact of {names} without a layer: expected a body with a mesh or point_stiffnesses()")
        return self._facet_stiffnesses

    @property
    def unlike(self) -> bool:
        """Whether a law meets two meshes that do not match at points or segments, not at nodes."""
        meshed = all(isinstance(side.surface, ContactSurface) for side in self.sides)
        return self.facets is None and self.gathered is None and meshed

    @cached_property
    def gap(self) -> Floats:
        """The initial gap d at the points, (n,), less the layer's clearance."""
        return self.geometric_gap + self.prescribed_gap - self.layer.clearance

    def layer_after(self, gap: Floats) -> Layer:
        """The contact's layer at the points once these gaps (points,) have been reached."""
        law = self.layer.after(gap)
        return law.layer if self.mirrored else law  # type: ignore[attr-defined]

    def refreshed(self, contact: Contact) -> Interface:
        """The same interface for the present gap of the user's contact; everything else is shared."""
        return replace(self, contact=contact.frozen(), prescribed_gap=self.prescription.at(contact.gap))

    def with_layer(self, layer: Layer | HardContact) -> Interface:
        """The same interface with the law of another layer."""
        return replace(self, contact=self.contact.with_layer(layer))

    def decomposed(self) -> Interface:
        """The same interface for decomposed methods, which solve hard contacts more softly."""
        layer = self.contact.layer
        return self.with_layer(layer.decomposed()) if isinstance(layer, HardContact) else self

    @property
    def rule(self) -> Quadrature:
        """The quadrature rule that tells where the points are."""
        return next(side.surface.rule for side in self.sides if isinstance(side.surface, ContactSurface))

    @property
    def mirrored(self) -> bool:
        """Whether the contact is that of a body with its mirror image, of whose layer it has one half."""
        return self.contact.mirrored

    @property
    def hard(self) -> bool:
        """Whether the contact has no layer."""
        return isinstance(self.contact.layer, HardContact)

    def closed(self, gap: Floats, pressure: Floats) -> NDArray[np.bool_]:
        """Where the layer is compressed, a hard contact carries pressure, or a bond holds, (points,)."""
        return closed_points(gap, pressure, self.hard, self.layer.bonded)

    def compressions(self, gap: Floats) -> Floats:
        """The compressions w of the layer, (points,), positive where a bond is stretched."""
        return gap if self.layer.bonded else np.minimum(gap, 0.0)


def without_rounding(distance: Floats, size: float) -> Floats:
    """Distances between surfaces whose coordinates are up to `size`, those that are rounding alone made zero.

    Else bodies that touch would do so or not by the last bit of their coordinates.
    """
    return np.where(np.abs(distance) <= 1e-13 * size, 0.0, distance)


def discretise(
    contact: Contact,
    bodies: tuple[int, int],
    facets: NDArray[np.intp] | None = None,
    split: bool = False,
    rule: Quadrature | None = None,
) -> Interface:
    """The interface of a contact between the bodies of given indices in a scene.

    facets: the second surface's opposite each of the first's, where they are known to match; split: whether facets are
    split into segments even where they match; rule: another than the contact's own.
    """
    if all(body.mesh is None for body, _ in contact.sides):
        return _between_meshless(contact, bodies)
    if rule is None:
        degree = max(body.degree for body, _ in contact.sides if body.mesh is not None)
        rule = find_quadrature(contact.quadrature, degree, contact.quadrature_degree)
    if any(body.mesh is None for body, _ in contact.sides):
        return _opposite_meshless(contact, bodies, rule)
    first, second = _surfaces(contact, rule)
    if split or rule.of_nodes:
        return _on_segments(contact, bodies, first, second)
    matched = matching(first, second, contact.reach) if facets is None else matching_on(first, second, facets)
    if matched is None:
        return _on_segments(contact, bodies, first, second)
    x, normal = first.mean(first.points.x), first.mean(first.points.normal)
    distance = dot(matched.in_order(second.mean(second.points.x)) - x, normal)
    measured = contact.measure_gap * without_rounding(distance, np.abs(x).max())
    given = PrescribedGap(smooth_places(first) if callable(contact.gap) else first.points.x, first.average)
    shape = given.at(contact.gap)
    sides = (
        InterfaceSide(bodies[0], first, first.mean(first.trace).tocsr(), first.spread, first.mean_along),
        InterfaceSide(
            bodies[1],
            second,
            matched.in_order(second.mean(second.trace).tocsr()),
            lambda: second.spread(matched.places),
            lambda axis: matched.in_order(second.mean_along(axis)),
        ),
    )
    return Interface(
        contact.frozen(),
        x,
        normal,
        first.value_weights,
        measured,
        shape,
        given,
        sides,
        partial(_linear_functions, matched),
        facets=matched.facets,
    )


def _opposite_meshless(contact: Contact, bodies: tuple[int, int], quadrature: Quadrature) -> Interface:
    """The interface between a meshed surface and a body without a mesh, at the points or nodes of the meshed one."""
    meshed = next(i for i, (body, _) in enumerate(contact.sides) if body.mesh is not None)
    (body, surface), (partner, _) = contact.sides[meshed], contact.sides[1 - meshed]
    own = ContactSurface(body, surface, quadrature)
    if quadrature.of_nodes:
        return _nodes_opposite_meshless(contact, bodies, own, partner, meshed)
    x, normal, weights = own.mean(own.points.x), own.mean(own.points.normal), own.value_weights
    places = smooth_places(own)
    trace, measured = _seen_meshless(contact, partner, x, own.mean(places), normal)
    given = PrescribedGap(places, own.average, part=0.5 if contact.mirrored else 1.0)
    points, along = PointSurface(weights, trace), _meshless_along(partner, x)
    sides = [
        InterfaceSide(bodies[meshed], own, own.mean(own.trace).tocsr(), own.spread, own.mean_along),
        InterfaceSide(bodies[1 - meshed], points, trace, partial(_everywhere, len(x)), along),
    ]
    first, second = sides if meshed == 0 else reversed(sides)
    return Interface(
        contact.frozen(),
        x,
        normal if meshed == 0 else -normal,
        weights,
        measured,
        given.at(contact.gap),
        given,
        (first, second),
        lambda *_: LinearFunctions(own, own.points, own.weights, own.average),
    )


def _nodes_opposite_meshless(
    contact: Contact, bodies: tuple[int, int], own: ContactSurface, partner: MeshlessBody, meshed: int
) -> Interface:
    """The same with the values at the nodes of the meshed surface."""
    facets = np.repeat(np.arange(len(own.facets)), own.per_facet)
    sampling = own.rule.sampling(own.weights, facets, lambda: hats(own, own.points))
    places = smooth_places(own)
    trace, measured = _seen_meshless(contact, partner, own.points.x, places, own.points.normal)
    normal = sampling.means(own.points.normal)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    given = PrescribedGap(places, sampling.mean, part=0.5 if contact.mirrored else 1.0)
    weights, trace = sampling.weights, sampling.means(trace)

    def along(axis: Floats) -> scipy.sparse.csr_matrix:
        return sampling.means(_meshless_along(partner, own.points.x)(axis))

    sides = [
        InterfaceSide(
            bodies[meshed],
            own,
            sampling.means(own.trace),
            partial(_facet_means, own, facets, own.weights, sampling),
            lambda axis: sampling.means(own.trace_along(axis)),
        ),
        InterfaceSide(
            bodies[1 - meshed], PointSurface(weights, trace), trace, partial(_everywhere, len(weights)), along
        ),
    ]
    first, second = sides if meshed == 0 else reversed(sides)
    return Interface(
        contact.frozen(),
        node_coordinates(own)[sampling.nodes],
        normal if meshed == 0 else -normal,
        weights,
        sampling.means(measured),
        given.at(contact.gap),
        given,
        (first, second),
        lambda *_: LinearFunctions(own, own.points, own.weights, sampling.mean),
        gathered=sampling.gathered,
        centres=sampling.means(own.points.x),
    )


def _half(law: Layer) -> Layer:
    """The half of a law that lies on one side of a mirror plane."""
    from ..layers.halved import half

    return half(law)


def _seen_meshless(
    contact: Contact, partner: MeshlessBody, x: Floats, places: Floats, normal: Floats
) -> tuple[scipy.sparse.csr_matrix, Floats]:
    """The normal displacement of a body without a mesh at points x, as an operator on its unknowns, and its distance
    from the places on the smooth surface."""
    trace = _operator(partner.normal_displacement(x, normal), len(x))
    distance = _checked("gap", partner.gap(places, normal), len(x), 1)
    return trace, contact.measure_gap * without_rounding(distance, np.abs(x).max())


def _between_meshless(contact: Contact, bodies: tuple[int, int]) -> Interface:
    """The interface between two bodies without a mesh, at the points that the first offers, or else the second."""
    offered = [body.contact_points() for body, _ in contact.sides]
    owner = 0 if offered[0] is not None else 1
    x, outward, weights = offered[owner]
    count = len(weights)
    x, outward = _checked("contact_points", x, count, 2), _checked("contact_points", outward, count, 2)
    weights = _checked("contact_points", weights, count, 1)
    partner = contact.sides[1 - owner][0]
    distance = _checked("gap", partner.gap(x, outward), count, 1)
    measured = contact.measure_gap * without_rounding(distance, np.abs(x).max())
    sides = [
        _side_of_points(contact, side, bodies[side], (x, -outward if side == owner else outward), weights)
        for side in (0, 1)
    ]
    given = PrescribedGap(x, None, part=0.5 if contact.mirrored else 1.0)
    return Interface(
        contact.frozen(),
        x,
        outward if owner == 0 else -outward,
        weights,
        measured,
        given.at(contact.gap),
        given,
        (sides[0], sides[1]),
        _no_functions,
        gathered=scipy.sparse.eye(count, format="csr"),
    )


def _side_of_points(
    contact: Contact, side: int, place: int, rays: tuple[Floats, Floats], weights: Floats
) -> InterfaceSide:
    """One side of a contact between bodies without a mesh; rays: its points and the directions into this body."""
    body, count = contact.sides[side][0], len(weights)
    trace = _operator(body.normal_displacement(*rays), count)
    points = PointSurface(weights, trace, stiffnesses=body.point_stiffnesses(), corners=body.contact_facets())
    return InterfaceSide(place, points, trace, partial(_everywhere, count), _meshless_along(body, rays[0]))


def _everywhere(count: int) -> Gather:
    """The operator to the points of an interface themselves."""
    return Gather(np.arange(count), count)


def _meshless_along(body: MeshlessBody, x: Floats) -> Callable[[Floats], scipy.sparse.csr_matrix]:
    """What gives the operator to the displacement of a body without a mesh along an axis, opposite points x."""

    def along(axis: Floats) -> scipy.sparse.csr_matrix:
        found = body.displacement_along(x, axis)
        if found is None:
            raise ValueError(
                f"contact with body {body.name!r}: how a {type(body).__name__} moves along its surface is not known; "
                "expected a layer without shear_stiffness"
            )
        return _operator(found, len(x))

    return along


def _no_functions(*_: PointSurface) -> LinearFunctions:
    raise ValueError("a contact between bodies without a mesh has no functions of facets; expected its own points")


def _operator(values: Any, points: int) -> scipy.sparse.csr_matrix:
    """The normal displacement that a body without a mesh gives at some points, an array or a sparse matrix."""
    if not scipy.sparse.issparse(values):
        return scipy.sparse.csr_matrix(_checked("normal_displacement", values, points, 2))
    trace = scipy.sparse.csr_matrix(values)
    if trace.shape[0] != points or not np.all(np.isfinite(trace.data)):
        raise ValueError(f"normal_displacement of shape {trace.shape}: expected finite numbers of {points} points")
    return trace


def _checked(name: str, values: Any, points: int, dimensions: int) -> Floats:
    """The values of a body without a mesh at points, refused unless they are finite numbers for each."""
    array = as_floats(name, values, f"finite numbers of {points} points")
    if array.ndim != dimensions or len(array) != points or not np.all(np.isfinite(array)):
        raise ValueError(f"{name} of shape {array.shape}: expected finite numbers of {points} points")
    return array


def _surfaces(contact: Contact, quadrature: Quadrature) -> tuple[ContactSurface, ContactSurface]:
    """Both surfaces; where they are the same one of copies of a mesh, the second follows from the first."""
    (body, surface), (other, opposite) = contact.sides
    first = ContactSurface(body, surface, quadrature)
    if surface == opposite:
        isometry = other.elements.isometry_from(body.elements)
        if isometry is not None:
            return first, first.copied(other, opposite, isometry)
    return first, ContactSurface(other, opposite, quadrature)


def _on_segments(contact: Contact, bodies: tuple[int, int], first: ContactSurface, second: ContactSurface) -> Interface:
    """The interface on the segments of both surfaces, as between meshes that do not match."""
    surfaces, rule = (first, second), first.rule
    if not rule.splits:
        raise MeshMismatchError(
            f"contact {contact.name!r}: quadrature = {rule.name!r} needs meshes that match along the contact; "
            "expected 'gauss', 'facet' or 'mortar'"
        )
    partners = pair_by_segments(contact, first, second)
    nodal = cache(lambda: side_of_nodes(surfaces, partners.facets))
    sampling = rule.sampling(
        partners.weights, partners.segment, lambda: hats(surfaces[nodal()], partners.points[nodal()])
    )
    x = partners.places[0]
    normal = sampling.means(partners.normal)
    given = PrescribedGap(partners.middle, sampling.mean)
    shape = given.at(contact.gap)
    sides = tuple(
        InterfaceSide(
            bodies[index],
            surface,
            sampling.means(_trace(surface, partners, index, sign)),
            partial(_facet_means, surface, partners.facets[index], partners.weights, sampling),
            partial(_seen_along, surface, partners, index, sampling),
        )
        for index, (surface, sign) in enumerate(((first, 1.0), (second, -1.0)))
    )
    unpaired = tuple(_unpaired_area(surface, partners, index) for index, surface in enumerate(surfaces))
    return Interface(
        contact.frozen(),
        sampling.means(x) if sampling.nodes is None else node_coordinates(surfaces[nodal()])[sampling.nodes],
        normal / np.linalg.norm(normal, axis=1, keepdims=True),
        sampling.weights,
        contact.measure_gap * sampling.means(without_rounding(partners.gap, np.abs(x).max())),
        shape,
        given,
        (sides[0], sides[1]),
        partial(_functions_on_segments, partners, sampling),
        (unpaired[0], unpaired[1]),
        gathered=sampling.gathered,
        centres=None if sampling.nodes is None else sampling.means(x),
        doubt=sampling.means(partners.doubt) if contact.measure_gap and partners.doubt.any() else None,
    )


def _seen_along(
    surface: ContactSurface, partners: PointPairs, index: int, sampling: Sampling, axis: Floats
) -> scipy.sparse.csr_matrix:
    """The displacement of one side along an axis (dim,), at the values, (n, dofs)."""
    directions = np.broadcast_to(axis, partners.normal.shape)
    return sampling.means(normal_trace(surface.body.space, partners.points[index], directions))


def _trace(surface: ContactSurface, partners: PointPairs, side_index: int, sign: float) -> scipy.sparse.csr_matrix:
    """The normal displacement of one side, outwards, at the points, (n, dofs)."""
    trace = normal_trace(surface.body.space, partners.points[side_index], sign * partners.normal)
    smooth = partners.smooth[side_index]
    stretch = None if smooth is None else smooth.stretch_trace()
    return trace if stretch is None else trace + stretch


def _functions_on_segments(partners: PointPairs, sampling: Sampling, *surfaces: ContactSurface) -> LinearFunctions:
    """The linear functions of one surface's nodes on the segments of both."""
    side = side_of_nodes((surfaces[0], surfaces[1]), partners.facets)
    return LinearFunctions(surfaces[side], partners.points[side], partners.weights, sampling.mean)


def _linear_functions(matched: Matching, first: ContactSurface, second: ContactSurface) -> LinearFunctions:
    """The linear functions of one surface's nodes on meshes that match."""
    if side_of_nodes((first, second), (np.arange(len(first.facets)), matched.facets)) == 0:
        return LinearFunctions(first, first.points, first.weights, first.average)
    mean = scipy.sparse.eye(len(second.weights), format="csr") if second.average is None else second.average
    return LinearFunctions(second, second.points, second.weights, matched.in_order(mean))


def _facet_means(
    surface: ContactSurface, owner: NDArray[np.intp], weights: Floats, sampling: Sampling
) -> scipy.sparse.csr_matrix:
    """From the values at an interface to a body's own integration points: the facets' means.

    owner, weights: the facets and areas of the interface's points; sampling: their values. A facet that is only partly
    covered gets as much of the mean as is covered, so that ∫ φ keeps its value.
    """
    count, order = len(surface.facets), np.argsort(owner, kind="stable")
    ends = np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=count))])
    shares = (weights / surface.facet_areas[owner])[order]
    total = scipy.sparse.csr_matrix((shares, order, ends), shape=(count, len(owner)))
    if sampling.spread is not None:
        total = (total @ sampling.spread).tocsr()
    return total[np.repeat(np.arange(count), surface.per_facet)]


def _unpaired_area(surface: ContactSurface, partners: PointPairs, side_index: int) -> float:
    """The area of a surface that has no partner."""
    bare = np.maximum(surface.facet_areas - partners.covered(side_index, len(surface.facets)), 0.0)
    area, total = float(bare.sum()), float(surface.facet_areas.sum())
    return area if area > 1e-6 * total else 0.0  # smaller areas are artefacts of seams between curved facets
