"""Points that lie opposite each other on two contact surfaces: on meshes that match, and on any others by segments.

Partners x, x' lie on one line along their common normal n = (n_α − n_β)/|n_α − n_β|, and both bodies are seen along it
with the same weights: action equals reaction, in force and in moment, and nothing tells the two surfaces apart.

The law holds at every point of every segment, so a layer much stiffer than the facets (its stiffness times their size
over E above about 10) asks for more than linear elements can give: the pressure then wavers from point to point around
the right mean. On the NAFEMS cylinder degree 2 stood a layer ten times stiffer than degree 1 with the same error. The
result then gives the projected pressure; the quadrature "mortar" asks at the nodes of one surface only (`nodal`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import basix
import numpy as np
import scipy

from ..base.arrays import Floats, Indices
from ..base.basis import quadrature_rule
from ..base.facets import FacetPoints, dot, facet_map, facet_points
from ..errors import MeshMismatchError
from .detection import FACING, facing_pairs
from .overlap import common_normals, meet_line, segments
from .smooth import SmoothPoints, SmoothSurface, smoothed

if TYPE_CHECKING:
    from ..contact import Contact
    from .surface import ContactSurface


@dataclass(frozen=True)
class PointPairs:
    """n pairs of opposite points of two surfaces.

    points: both sides' x and x'; facets: both sides' facets, by their place in the surface; normal: (n, dim) the common
    normal out of the first; weights: (n,) areas across it, in bodies of revolution of the full ring; segment: (n,) the
    segment that each pair belongs to; smooth: each side's points of the smooth surface on the same lines, None where it
    is flat.
    """

    points: tuple[FacetPoints, FacetPoints]
    facets: tuple[Indices, Indices]
    normal: Floats
    weights: Floats
    segment: Indices
    smooth: tuple[SmoothPoints | None, SmoothPoints | None]

    @property
    def places(self) -> tuple[Floats, Floats]:
        """Both sides' points of the smooth surfaces, (n, dim) each."""
        first, second = (p.x if s is None else s.x for p, s in zip(self.points, self.smooth, strict=True))
        return first, second

    @property
    def doubt(self) -> Floats:
        """The uncertainty of the gap where the smooth surface is not determined, (n,) (length)."""
        return sum((s.doubt for s in self.smooth if s is not None), np.zeros(len(self.weights)))

    @property
    def gap(self) -> Floats:
        """The distance of the smooth surfaces along the common normal, (n,); negative where they overlap."""
        return dot(self.places[1] - self.places[0], self.normal)

    @property
    def middle(self) -> Floats:
        """Midway between the smooth surfaces, (n, dim)."""
        return 0.5 * (self.places[0] + self.places[1])

    def covered(self, side: int, count: int) -> Floats:
        """The area of each of a side's `count` facets that has a partner, (count,)."""
        slope = np.abs(dot(self.points[side].normal, self.normal))
        return np.asarray(np.bincount(self.facets[side], self.weights / slope, count), dtype=float)


@dataclass(frozen=True)
class Matching:
    """Two surfaces whose facets lie opposite each other one to one.

    facets: the second's opposite each of the first's; values: likewise, or None where they are in the same order.
    """

    facets: Indices
    values: Indices | None = None

    def in_order(self, rows: Any) -> Any:
        """Rows of an array or a matrix, one for each of the second surface's values, in the order of the first's."""
        return rows if self.values is None else rows[self.values]

    @property
    def places(self) -> Indices | None:
        """The positions of the second surface's values in the order of the first's; None if the order is the same."""
        return None if self.values is None else np.argsort(self.values)


def matching(first: ContactSurface, second: ContactSurface, reach: float) -> Matching | None:
    """Pair the facets of two surfaces one to one, or None if the meshes do not match within `reach`."""
    if _in_order(first, second, reach):
        return Matching(np.arange(len(first.facets)))
    facets = _matching_facets(first, second, reach)
    return None if facets is None else matching_on(first, second, facets)


def matching_on(first: ContactSurface, second: ContactSurface, facets: Indices) -> Matching | None:
    """The pairs of values on facets that match, or None if one has no partner.

    facets: the second surface's opposite each of the first's.
    """
    if first.per_value == first.per_facet:  # one value on each facet
        return Matching(facets, facets)
    dim, n = first.body.mesh.dim, len(first.facets)
    if np.array_equal(facets, np.arange(n)) and _in_order(first, second, np.inf):
        return Matching(facets)
    here, there, normal = (part.reshape(n, -1, dim) for part in (first.points.x, second.points.x, first.points.normal))
    offsets = _offsets(here, there[facets], normal)
    if offsets.min(axis=2).max() > _tolerance(first):
        return None
    return Matching(facets, (facets[:, None] * first.per_facet + offsets.argmin(axis=2)).ravel())


def _matching_facets(first: ContactSurface, second: ContactSurface, reach: float) -> Indices | None:
    """The second surface's facet that lies opposite each of the first's, or None if the meshes do not match there."""
    dim, n = first.body.mesh.dim, len(first.facets)
    if len(second.facets) != n or first.corners.shape != second.corners.shape:
        return None
    middles = [side.points.x.reshape(n, -1, dim).sum(axis=1) / side.per_facet for side in (first, second)]
    distance, facet = _nearest(*middles)
    if len(np.unique(facet)) != n or distance.max() > reach:
        return None
    normal = first.points.normal.reshape(n, -1, dim)
    if np.any(dot(normal, second.points.normal.reshape(n, -1, dim)[facet]) > -np.cos(FACING)):
        return None
    offsets = _offsets(first.corners, second.corners[facet], normal[:, :1])
    return facet if offsets.min(axis=2).max() <= _tolerance(first) else None


def _in_order(first: ContactSurface, second: ContactSurface, reach: float) -> bool:
    """Whether the points of two surfaces lie opposite each other one after the other, as those of mirror images do."""
    here, there = first.points, second.points
    if here.x.shape != there.x.shape or first.per_facet < first.body.mesh.dim:  # too few points to tell the facets
        return False
    offset = there.x - here.x
    along = dot(offset, here.normal)
    across = offset - along[:, None] * here.normal
    facing = dot(here.normal, there.normal).max() < -np.cos(FACING)
    return bool(facing and np.abs(along).max() <= reach and dot(across, across).max() <= _tolerance(first) ** 2)


def _tolerance(surface: ContactSurface) -> float:
    """The largest distance of facets that match: a millionth of their size."""
    n = len(surface.facets)
    if surface.body.mesh.dim == 2:
        return 1e-6 * surface.areas.sum() / n
    return 1e-6 * np.sqrt(surface.areas.reshape(n, -1).sum(axis=1).max())


def pair_by_segments(contact: Contact, first: ContactSurface, second: ContactSurface) -> PointPairs:
    """The partners on the segments of both surfaces, whatever their meshes.

    Raises MeshMismatchError if no facet has a partner, or some have two, one behind the other.
    """
    sides = (first, second)
    flat = [side.middles.normal for side in sides]
    pairs = facing_pairs(first.corners, flat[0], second.corners, flat[1], contact.reach)
    facing = dot(flat[0][pairs[0]], flat[1][pairs[1]]) < -np.cos(FACING)
    pairs = (pairs[0][facing], pairs[1][facing])
    common = common_normals(flat[0][pairs[0]], flat[1][pairs[1]])
    simplex = basix.CellType.interval if first.body.mesh.dim == 2 else basix.CellType.triangle
    rule = quadrature_rule(simplex, first.rule.degree)
    found = segments(first.corners[pairs[0]], second.corners[pairs[1]], common, *rule)
    if len(found.pair) == 0:  # an element is not asked for its values at no point
        raise MeshMismatchError(_why_none(contact, first, second))
    facets = (pairs[0][found.pair], pairs[1][found.pair])
    partners = _opposite(sides, facets, found.line, common[found.pair], found.weight, found.pair)
    partners = _within(partners, contact.reach)
    if len(partners.weights) == 0:
        raise MeshMismatchError(_why_none(contact, first, second))
    for place, side in enumerate(sides):
        twice = partners.covered(place, len(side.facets)) > 1.9 * side.facet_areas
        if np.any(twice):
            raise MeshMismatchError(
                f"contact {contact.name!r}: {twice.sum()} facets of surface {side.surface!r} of body "
                f"{side.body.name!r} have two partners, one behind the other; expected a smaller search_distance or "
                "a surface of fewer facets"
            )
    return partners


def _opposite(
    sides: tuple[ContactSurface, ContactSurface],
    facets: tuple[Indices, Indices],
    line: Floats,
    normal: Floats,
    weights: Floats,
    segment: Indices,
) -> PointPairs:
    """The points where the facets meet lines along their common normals.

    The lines given (n, dim) run along the flat facets' normals. On curved facets, and on those of a curved surface,
    each turns about the middle of its partners until it follows the smooth surfaces' normals there, unless that leads
    off the facets, as it does across a gap that is wide beside what bends the surface.
    """
    across, straight = normal, line
    kept = np.zeros(len(line), dtype=bool)
    shapes = [smoothed(side) for side in sides]
    local = [np.tile(side.centre, (len(line), 1)) for side in sides]
    for turns in range(10):
        points = []
        for place, side in enumerate(sides):
            entities = side.entities[facets[place]]
            domain = side.body.mesh.domain
            local[place] = meet_line(partial(facet_map, domain, entities), line, normal, local[place])
            points.append(facet_points(domain, entities, local[place]))
        outward = [_normals(*seen) for seen in zip(shapes, facets, local, points, strict=True)]
        if turns > 0:
            kept |= np.maximum(*(_beyond(side, at) for side, at in zip(sides, local, strict=True))) > 0.25
        turned = np.where(kept[:, None], across, common_normals(outward[0], outward[1]))
        line = np.where(kept[:, None], straight, 0.5 * (points[0].x + points[1].x))
        change = np.abs(turned - normal).max(initial=0.0)
        if change < 1e-12:
            break
        normal = turned
    weights = weights / dot(across, normal) * sides[0].body.kinematics.weight(line.T)
    smooth = [
        None if shape is None else SmoothPoints.on_lines(side, shape, at, start, normal, line)
        for side, shape, at, start in zip(sides, shapes, facets, local, strict=True)
    ]
    return PointPairs((points[0], points[1]), facets, normal, weights, segment, (smooth[0], smooth[1]))


def _beyond(side: ContactSurface, local: Floats) -> Floats:
    """The distances of points outside their facets, in the facets' coordinates, (n,)."""
    far = local.sum(axis=1) if side.corners.shape[1] == 3 else local.max(axis=1)
    return np.maximum(far - 1.0, -local.min(axis=1))


def _normals(shape: SmoothSurface | None, facets: Indices, local: Floats, points: FacetPoints) -> Floats:
    """The outward normals of the smooth surface behind points of facets."""
    return points.normal if shape is None else shape.normals(facets, local, points)


def _within(partners: PointPairs, reach: float) -> PointPairs:
    """The segments whose partners are no further apart than `reach`, numbered without gaps."""
    count = int(partners.segment.max()) + 1
    total = np.bincount(partners.segment, partners.weights, count)
    far = np.bincount(partners.segment, partners.weights * np.abs(partners.gap), count) > reach * total
    kept = np.flatnonzero(~far[partners.segment])
    points = tuple(
        FacetPoints(p.cells[kept], p.reference[kept], p.x[kept], p.normal[kept], p.area[kept]) for p in partners.points
    )
    facets = (partners.facets[0][kept], partners.facets[1][kept])
    segment = np.unique(partners.segment[kept], return_inverse=True)[1]
    smooth = [side and side.kept(kept) for side in partners.smooth]
    normal, weights = partners.normal[kept], partners.weights[kept]
    return PointPairs((points[0], points[1]), facets, normal, weights, segment, (smooth[0], smooth[1]))


def _offsets(here: Floats, there: Floats, normal: Floats) -> Floats:
    """The distances across the normals (n, p or 1, dim) between points (n, p, dim) and (n, q, dim) of paired facets.

    On meshes that match only the offset across the contact may differ: points are compared within the facets' planes.
    """
    offset, normal = here[:, :, None] - there[:, None], normal[:, :, None]
    across = offset - dot(offset, normal)[..., None] * normal
    return np.sqrt(dot(across, across))


def _nearest(points: Floats, others: Floats) -> tuple[Floats, Indices]:
    """The distance from each point (n, dim) to the nearest of others (m, dim), and the index of that one."""
    if len(points) * len(others) > 10_000:
        return scipy.spatial.cKDTree(others).query(points)
    offset = points[:, None] - others
    square = dot(offset, offset)
    return np.sqrt(square.min(axis=1)), square.argmin(axis=1)


def _why_none(contact: Contact, first: ContactSurface, second: ContactSurface) -> str:
    """Why no facet of two surfaces has a partner, in words."""
    name = f"contact {contact.name!r}: the surfaces {first.surface!r} and {second.surface!r} "
    if np.min(first.middles.normal @ second.middles.normal.T) > -np.cos(FACING):
        return name + "do not face each other (their outward normals do not point towards one another)"
    nearest = float(scipy.spatial.cKDTree(second.middles.x).query(first.middles.x)[0].min())
    if nearest > contact.reach:
        return name + f"are {nearest:.3g} apart; expected a distance within search_distance = {contact.reach:.3g}"
    return name + "do not overlap: no facet of one lies opposite a facet of the other"
