"""The smooth surface behind facets: between their nodes a curved surface leaves straight facets by the sagitta h²κ/8.

On meshes that do not match, the sagittas of both sides do not cancel: for a press fit they are more than the
interference. Here every facet carries a patch through its nodes that has the smooth surface's normals at its vertices,
exact on circles, cylinders and spheres. Nothing is smoothed that neighbours do not agree on (see `vertex_normals`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any

import basix
import numpy as np
import scipy
from numpy.typing import NDArray

from ..base import compat
from ..base.arrays import Floats, Indices, components
from ..base.basis import basis_values
from ..base.facets import FacetPoints, dot, facet_map, facet_type, surface_points
from .overlap import meet_line
from .vertex_normals import SurfaceNodes, vertex_normals

if TYPE_CHECKING:
    from .surface import ContactSurface

#: A rigid motion across whose velocity the normals are, to this part, carries the surface along itself.
GLIDING = 1e-6

#: Facets that meet at less than this angle (degrees) may be meant as a curve; at more they are an edge for sure.
CURVED = 59.0

#: Normals that differ by less are those of a plane.
FLAT = 1e-12


@dataclass(frozen=True)
class SmoothSurface:
    """Patches through the nodes of n facets of c corners and e edges.

    frame: the facets' shape; order: theirs; corners: (n, c, dim); upright: (n, c, dim) the straight facets' normals
    there; slopes: (n, e, 2) how the patch rises above that along its edges, from both ends; bend: (n,) half of
    the curvature, for the next term of a circle; offsets: (n, k, dim) from there to the facet's other nodes; tilt: (n,
    c, dim) from the facet's own normals at its corners to those of the smooth surface; doubt: (n,) by how much a facet
    may still be off; glides: (g, dim, 1 + dim) the rigid motions a + A x that carry the whole surface along itself.
    """

    frame: _Frame
    order: int
    corners: Floats
    upright: Floats
    slopes: Floats
    bend: Floats
    offsets: Floats
    tilt: Floats
    doubt: Floats
    glides: Floats

    def normals(self, facets: Indices, local: Floats, own: FacetPoints) -> Floats:
        """The smooth surface's unit normals (n, dim) at points of facets."""
        turned = _units(own.normal + _combined(self.frame.weights(local), self.tilt[facets]))
        return self._across_glides(own.x, turned)

    def places(self, facets: Indices, local: Floats) -> Floats:
        """The points of the patches (n, dim) at the facets' coordinates."""
        weights = self.frame.weights(local)
        upright = _units(_combined(weights, self.upright[facets]))
        first = self.rise_by_edges(facets, local).sum(axis=1)
        x = _combined(weights, self.corners[facets]) + _on_circle(first, self.bend[facets])[:, None] * upright
        if self.offsets.shape[1] == 0:
            return x
        return x + _combined(self.frame.inner(local), self.offsets[facets])

    def rise_by_edges(self, facets: Indices, local: Floats) -> Floats:
        """The part of the rise above the straight facet due to each edge, but for the next term of a circle, (n, e)."""
        t, counts = self.frame.edge_coordinates(local)
        slopes = self.slopes[facets]
        return counts * (slopes[..., 0] * (1.0 - t) + slopes[..., 1] * t)

    def edges(self, facets: Indices) -> Floats:
        """From the first end of every edge to the second, (n, e, dim)."""
        return _along_edges(self.corners[facets], self.frame.ends)

    def sizes(self, facets: Indices) -> Floats:
        """The facets' longest edges, (n,)."""
        edges = self.edges(facets)
        return np.sqrt(dot(edges, edges)).max(axis=1)

    def _across_glides(self, x: Floats, normals: Floats) -> Floats:
        """Unit normals at x across the motions that carry the surface along itself.

        A round pin that turns must not meet a resistance that comes from the rounding of its normals.
        """
        if len(self.glides) == 0:
            return normals
        velocities = self.glides[:, :, 0] + np.einsum("gij,pj->pgi", self.glides[:, :, 1:], x)
        for _ in range(x.shape[1] - 1):  # as many directions as the surface can have
            square = dot(velocities, velocities)
            longest = square.argmax(axis=1)
            places = np.arange(len(x)), longest
            held = square[places] > 1e-12 * square.max()
            along = np.where(
                held[:, None], velocities[places] / np.sqrt(np.where(held, square[places], 1.0))[:, None], 0.0
            )
            normals = normals - dot(normals, along)[:, None] * along
            velocities = velocities - dot(velocities, along[:, None])[..., None] * along[:, None]
        return _units(normals)


@dataclass(frozen=True)
class SmoothPoints:
    """n points of the smooth surface behind points of facets.

    facets: (n,) by their place in the surface; local: (n, dim − 1) the facets' coordinates; x: (n, dim).
    """

    surface: ContactSurface
    shape: SmoothSurface
    facets: Indices
    local: Floats
    x: Floats

    @classmethod
    def on_lines(
        cls,
        surface: ContactSurface,
        shape: SmoothSurface,
        facets: Indices,
        local: Floats,
        direction: Floats,
        line: Floats,
    ) -> SmoothPoints:
        """The intersections of lines through `line` (n, dim) with the smooth surface; local: starts of the search."""
        domain, entities, start = surface.body.mesh.domain, surface.entities[facets], local

        def patch(local: Floats) -> tuple[Floats, Floats]:
            # The facets' tangents will do: the patch follows them but for its slope.
            return shape.places(facets, local), facet_map(domain, entities, local)[1]

        local = meet_line(patch, line, direction, start, within=0.5)
        x = shape.places(facets, local)
        missed = shape.sizes(facets) * 1e-6 < np.linalg.norm(_across(x - line, direction), axis=1)
        if missed.any():  # a patch as steep as its line: what it rises by where the line meets the facet
            local = np.where(missed[:, None], start, local)
            x = np.where(missed[:, None], line + _along(shape.places(facets, start) - line, direction), x)
        return cls(surface, shape, facets, local, x)

    def kept(self, places: Indices) -> SmoothPoints:
        """Some of the points."""
        return replace(self, facets=self.facets[places], local=self.local[places], x=self.x[places])

    @property
    def doubt(self) -> Floats:
        """The uncertainty of the facets' rise where the smooth surface is not determined, (n,) (length)."""
        return self.shape.doubt[self.facets]

    def stretch_trace(self) -> scipy.sparse.csr_matrix | None:
        """The part of u_n due to the rise as the facets stretch, (n, dofs); None on quadratic facets or elements.

        Between the nodes of a circle that grows by u_r, linear elements have u_n = u_r cos α on the chord: they miss
        s u_r/R, the rise times the strain along the edges. Rigid motions stretch nothing, and the forces that belong
        to it pull the ends of each edge towards each other: neither balance of a body changes.
        """
        if self.shape.order > 1 or self.surface.body.degree > 1:
            return None
        space, ends, dim = self.surface.body.space, self.shape.frame.ends, self.x.shape[1]
        cells, local = self.surface.entities[self.facets].T
        nodes = space.dofmap.list[cells[:, None], np.array(basix.topology(space.mesh.basix_cell())[dim - 1])[local]]
        edges = self.shape.edges(self.facets)
        parts = (self.shape.rise_by_edges(self.facets, self.local) / dot(edges, edges))[..., None] * edges
        columns = [components(nodes[:, ends[:, end]], dim) for end in (0, 1)]
        rows = np.repeat(np.arange(len(cells)), parts[0].size)
        entries = (np.concatenate([-parts.ravel(), parts.ravel()]), (np.tile(rows, 2), np.concatenate(columns)))
        trace = scipy.sparse.csr_matrix(entries, shape=(len(cells), dim * space.dofmap.index_map.size_local))
        trace.eliminate_zeros()
        return trace


def smoothed(surface: ContactSurface) -> SmoothSurface | None:
    """The smooth surface behind a contact surface; None where it is flat."""
    if np.ptp(surface.points.normal, axis=0).max() <= FLAT:
        return None
    domain, dim = surface.body.mesh.domain, surface.body.mesh.dim
    frame = _frame(facet_type(domain), compat.coordinate_map(domain))
    x, facets = _nodes(surface, frame)
    count = len(frame.corners)
    normals = surface_points(domain, surface.entities, frame.corners).normal.reshape(len(facets), count, dim)
    straight = _combined(frame.weights(frame.nodes[count:])[None], x[facets[:, None, :count]])
    order = frame.order
    if np.abs(x[facets[:, count:]] - straight).max(initial=0.0) <= 1e-9 * np.ptp(x, axis=0).max():
        order, facets = 1, facets[:, :count]
    seen = facets if order <= 2 else facets[:, :count]  # of the others too many to explain
    nodes = SurfaceNodes(x, seen, normals, 3 if order == 2 else 2)
    smooth, doubtful = vertex_normals(nodes)
    smooth = np.where(doubtful[:, None, None], normals, smooth)
    patches = _patches(frame, order, nodes, smooth, doubtful)
    return patches if order == 1 else _through(patches, surface, x[facets[:, count:]], doubtful)


def smooth_places(surface: ContactSurface) -> Floats:
    """The points of the smooth surface above a surface's integration points, (n, dim), or these if it is flat."""
    shape = smoothed(surface)
    if shape is None:
        return surface.points.x
    facets = np.repeat(np.arange(len(surface.facets)), surface.per_facet)
    local = np.tile(surface.rule.points(shape.frame.kind)[0], (len(surface.facets), 1))
    return SmoothPoints.on_lines(surface, shape, facets, local, surface.points.normal, surface.points.x).x


def _nodes(surface: ContactSurface, frame: _Frame) -> tuple[Floats, NDArray[np.intp]]:
    """The nodes of a surface, each once, (m, dim), and those of its facets, (n, nodes of the frame)."""
    domain, dim = surface.body.mesh.domain, surface.body.mesh.dim
    cells, local = surface.entities.T
    closure = np.array(compat.coordinate_map(domain).entity_closure_dofs[dim - 1])[local]
    names, facets = np.unique(compat.geometry_dofmap(domain)[cells[:, None], closure], return_inverse=True)
    return domain.geometry.x[names, :dim], facets.reshape(len(cells), -1)


def _patches(
    frame: _Frame, order: int, nodes: SurfaceNodes, smooth: Floats, doubtful: NDArray[np.bool_]
) -> SmoothSurface:
    """The patches through the corners of facets that have the smooth normals there, (n, c, dim)."""
    corners, own = nodes.x[nodes.corners], nodes.normals
    upright, edges = _upright(corners, own), _along_edges(corners, frame.ends)
    # Facets that have no smooth surface stay as they are: straight between the corners, and on to the other nodes.
    slopes = np.where(doubtful[:, None, None], 0.0, _slopes(smooth, upright, edges, frame.ends))
    slopes[np.abs(slopes) <= FLAT * np.sqrt(dot(edges, edges))[..., None]] = 0.0
    tilt = smooth - own
    tilt[np.abs(tilt).max(axis=(1, 2)) <= FLAT] = 0.0
    glides = np.zeros((0, 0, 0)) if doubtful.any() else _glides(corners, smooth)
    nothing = np.zeros((len(corners), 0, corners.shape[2]))
    bend, doubt = _bend(slopes, edges), _doubt(order, nodes, edges, doubtful)
    return SmoothSurface(frame, order, corners, upright, slopes, bend, nothing, tilt, doubt, glides)


def _through(shape: SmoothSurface, surface: ContactSurface, x: Floats, doubtful: NDArray[np.bool_]) -> SmoothSurface:
    """Patches that go through the nodes x (n, k, dim) beside the corners as well.

    Nodes lie off a patch across it: what they are shifted by along it changes the coordinates, not the surface. Facets
    that stay as they are keep their coordinates, too.
    """
    count, frame = len(x), shape.frame
    facets = np.repeat(np.arange(count), x.shape[1])
    local, nodes = np.tile(frame.nodes[len(frame.corners) :], (count, 1)), x.reshape(-1, x.shape[2])
    across = _units(_combined(frame.weights(local), shape.upright[facets]))
    foot = SmoothPoints.on_lines(surface, shape, facets, local, across, nodes).x
    foot = np.where(doubtful[facets][:, None], shape.places(facets, local), foot)
    return replace(shape, offsets=(nodes - foot).reshape(x.shape))


def _slopes(normals: Floats, upright: Floats, edges: Floats, ends: NDArray[np.intp]) -> Floats:
    """The slopes above the facet, along each edge inwards, of a surface with given normals at corners, (n, e, 2)."""
    along = np.stack([edges, -edges], axis=2)
    return -dot(normals[:, ends], along) / dot(normals[:, ends], upright[:, ends])


def _bend(slopes: Floats, edges: Floats) -> Floats:
    """Half of the curvature of a circle that rises with the slopes above edges, the most bent of each facet's, (n,)."""
    bends = slopes.mean(axis=2) / dot(edges, edges)
    return np.take_along_axis(bends, np.abs(bends).argmax(axis=1)[:, None], axis=1)[:, 0]


def _on_circle(first: Floats, bend: Floats) -> Floats:
    """y = first − bend y²: what a circle rises above its chord, from the parabola that has its slopes."""
    rise = first
    for _ in range(4):
        rise = first / (1.0 + bend * rise)
    return rise


def _doubt(order: int, nodes: SurfaceNodes, edges: Floats, doubtful: NDArray[np.bool_]) -> Floats:
    """By how much facets may be off that have no smooth surface, if their neighbours' normals mean a curve, (n,)."""
    if not doubtful.any() or order > 2:
        return np.zeros(len(edges))
    mean, meant = nodes.vertex_mean(np.radians(CURVED))
    off = mean[nodes.corners] - nodes.normals
    turn = np.where(meant[nodes.corners], np.sqrt(dot(off, off)), 0.0).max(axis=1)
    return np.where(doubtful, turn * np.sqrt(dot(edges, edges)).max(axis=1) / 4.0**order, 0.0)


def _upright(corners: Floats, own: Floats) -> Floats:
    """The normals of straight facets at their corners, (n, c, dim), on the side of the facets' own."""
    count = corners.shape[1]
    if corners.shape[2] == 2:
        edge = corners[:, 1] - corners[:, 0]
        across = np.repeat((edge[:, ::-1] * np.array([1.0, -1.0]))[:, None], 2, axis=1)
    else:
        beside = np.array([[1, 2], [2, 0], [0, 1]] if count == 3 else [[1, 2], [3, 0], [0, 3], [2, 1]])
        across = np.cross(corners[:, beside[:, 0]] - corners, corners[:, beside[:, 1]] - corners)
    across = across / np.sqrt(dot(across, across))[..., None]
    return np.copysign(1.0, dot(across, own))[..., None] * across


def _glides(x: Floats, normals: Floats) -> Floats:
    """The rigid motions that carry a surface along itself, v(x)·n = 0, from its points and normals (..., dim).

    On a circle its turning, on a sphere three, on a cylinder turning and shift; a and A of a + A x, (g, dim, 1 + dim).
    """
    dim = x.shape[-1]
    x, normals = x.reshape(-1, dim), normals.reshape(-1, dim)
    middle = x.mean(axis=0)
    size = np.abs(x - middle).max()
    motions = _rigid_motions(dim)
    velocities = motions[:, None, :, 0] + np.einsum("gij,pj->gpi", motions[:, :, 1:], (x - middle) / size)
    _, singular, coefficients = np.linalg.svd(dot(velocities, normals).T, full_matrices=False)
    glides = np.einsum("km,mij->kij", coefficients[singular <= GLIDING * singular[0]], motions)
    glides[:, :, 1:] /= size
    glides[:, :, 0] -= glides[:, :, 1:] @ middle
    return glides


def _rigid_motions(dim: int) -> Floats:
    """The rigid motions a + A x of the plane or of space, (motions, dim, 1 + dim)."""
    pairs = [(i, j) for i in range(dim) for j in range(i + 1, dim)]
    motions = np.zeros((dim + len(pairs), dim, 1 + dim))
    motions[range(dim), range(dim), 0] = 1.0
    for row, (i, j) in enumerate(pairs, start=dim):
        motions[row, i, 1 + j], motions[row, j, 1 + i] = -1.0, 1.0
    return motions


def _along_edges(corners: Floats, ends: NDArray[np.intp]) -> Floats:
    return corners[:, ends[:, 1]] - corners[:, ends[:, 0]]


def _combined(weights: Floats, values: Floats) -> Floats:
    """The sums of values (..., c, dim) by weights (..., c)."""
    return np.einsum("...c,...ci->...i", weights, values)


def _along(vectors: Floats, direction: Floats) -> Floats:
    """The part of vectors (n, dim) along unit directions."""
    return dot(vectors, direction)[:, None] * direction


def _across(vectors: Floats, direction: Floats) -> Floats:
    return vectors - _along(vectors, direction)


def _units(vectors: Floats) -> Floats:
    return vectors / np.sqrt(dot(vectors, vectors))[..., None]


@dataclass(frozen=True)
class _Frame:
    """The shape of facets: nodes (k, dim − 1) in their coordinates, corners (c, dim − 1) first; ends: (e, 2) the
    corners of every edge."""

    kind: basix.CellType
    order: int
    element: Any
    nodes: Floats
    corners: Floats
    ends: NDArray[np.intp]

    def weights(self, local: Floats) -> Floats:
        """The (bi)linear functions of the corners at points, (n, c)."""
        if self.kind == basix.CellType.quadrilateral:
            r, s = local.T
            return np.stack([(1 - r) * (1 - s), r * (1 - s), (1 - r) * s, r * s], axis=1)
        return np.column_stack([1.0 - local.sum(axis=1), local])

    def inner(self, local: Floats) -> Floats:
        """The functions of the other nodes at points, (n, k − c)."""
        return basis_values(self.element, local)[:, len(self.corners) :]

    def edge_coordinates(self, local: Floats) -> tuple[Floats, Floats]:
        """The coordinates t of points along every edge, from 0 to 1, and the weights of its rise there, (n, e) each.

        On an edge itself that one alone counts, t (1 − t). On quadrilaterals each counts as it is near (Coons), on
        triangles by λᵢλⱼ: both have quadratic precision.
        """
        weights = self.weights(local)
        first, second = weights[:, self.ends[:, 0]], weights[:, self.ends[:, 1]]
        total = first + second
        if self.kind == basix.CellType.triangle:
            return 0.5 * (1.0 + second - first), first * second
        t = np.divide(second, total, out=np.full_like(total, 0.5), where=np.abs(total) > 1e-9)
        return t, t * (1.0 - t) * total


@cache
def _frame(kind: basix.CellType, coordinates: Any) -> _Frame:
    """The shape of the facets of cells with that coordinate element."""
    variant = coordinates.lagrange_variant
    element = basix.create_element(basix.ElementFamily.P, kind, coordinates.degree, variant)
    corners, ends = np.asarray(basix.geometry(kind)), np.array(basix.topology(kind)[1])
    return _Frame(kind, coordinates.degree, element, np.asarray(element.points), corners, ends)
