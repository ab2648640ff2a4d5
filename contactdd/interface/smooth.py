"""The smooth surface behind facets: between their nodes a curved surface leaves straight facets by the sagitta h²κ/8.

On meshes that do not match, the sagittas of both sides do not cancel: for a press fit they are more than the
interference. Here every vertex looks at the nodes around it, fits a polynomial one degree higher than the facets'
(exact on circles, cylinders and spheres), and believes it where it explains the nodes; the facet's normals at its
vertices then make a patch through the same nodes. Nothing is smoothed that neighbours do not agree on: next to a
crease the fit comes from one side, and a notch, a step or a rough profile stays as it is meshed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import basix
import numpy as np
import scipy
from numpy.typing import NDArray

from ..base import compat
from ..base.arrays import Floats, Indices
from ..base.facets import FacetPoints, dot, facet_map, facet_points, facet_type, surface_points
from .overlap import axes_across, meet_line

if TYPE_CHECKING:
    from .surface import ContactSurface

#: Facets whose normals are further than half of this from their mean at a vertex form an edge, however regular.
CREASE = np.radians(35.0)

#: What part of the nodes' departure from a plane a fit may leave unexplained, by its degree. A parabola: a fold between two
#: planes leaves 0.22, a plane that ends in an arc 0.21, curvature that changes by a third from facet to facet 0.07.
UNEXPLAINED = {2: 0.1, 3: 0.01}

#: A rigid motion across whose velocity the normals are to this part carries the surface along itself.
GLIDING = 1e-6

#: Normals that differ by less are those of a plane.
FLAT = 1e-12


@dataclass(frozen=True)
class SmoothSurface:
    """Patches through the nodes of n facets of c corners and e edges.

    order: 1 or 2, the facets' own; kind: their shape; tilt: (n, c, dim) from the facet's own normals at its corners to
    those of the smooth surface; ends: (e, 2) the corners of every edge; edges: (n, e, dim) from the first to the second;
    slopes: (n, e, 2) how the patch rises above the facet at both ends of each edge, along it; bend: (n,) half of the
    curvature, for the next term of a circle; doubt: (n,) by how much the facet may still be off; glides: (k, dim,
    1 + dim) the rigid motions v(x) = a + A x that carry the whole surface along itself, a and A.
    """

    order: int
    kind: basix.CellType
    tilt: Floats
    ends: NDArray[np.intp]
    edges: Floats
    slopes: Floats
    bend: Floats
    doubt: Floats
    glides: Floats

    def normals(self, facets: Indices, local: Floats, own: FacetPoints) -> Floats:
        """The smooth surface's unit normals (n, dim) at points of facets."""
        turned = own.normal + np.einsum("pc,pci->pi", _corner_functions(self.kind, local), self.tilt[facets])
        return self._across_glides(own.x, turned / np.linalg.norm(turned, axis=1, keepdims=True))

    def _across_glides(self, x: Floats, normals: Floats) -> Floats:
        """Unit normals (n, dim) at x, across the motions that carry the surface along itself.

        A turning round pin must not meet a resistance that comes from the rounding of its normals alone.
        """
        if len(self.glides) == 0:
            return normals
        velocities = self.glides[:, :, 0] + np.einsum("kij,pj->pki", self.glides[:, :, 1:], x)
        along = np.linalg.pinv(velocities, rcond=1e-6) @ (velocities @ normals[:, :, None])
        across = normals - along[:, :, 0]
        return across / np.linalg.norm(across, axis=1, keepdims=True)

    def rise(self, facets: Indices, local: Floats) -> Floats:
        """How far the smooth surface lies above points of facets along the facets' own normals, (n,)."""
        first = self.rise_by_edges(facets, local).sum(axis=1)
        bend, rise = self.bend[facets], first
        for _ in range(4):  # y = first − bend y²: a circle's equation
            rise = first / (1.0 + bend * rise)
        return rise

    def rise_by_edges(self, facets: Indices, local: Floats) -> Floats:
        """What each edge adds to the rise, but for the next term of a circle, (n, edges)."""
        along, blend = _edge_coordinates(_corner_functions(self.kind, local), self.ends, self.kind)
        slope = _slope_between_three if self.order == 2 else _slope_between
        return blend * slope(along, self.slopes[facets])


@dataclass(frozen=True)
class SmoothPoints:
    """n points of the smooth surface behind points of facets.

    facets: (n,) by their place in the surface; local: (n, dim − 1) the points of the facets, in their coordinates; x:
    (n, dim) those of the smooth surface on the same lines.
    """

    surface: ContactSurface
    shape: SmoothSurface
    facets: Indices
    local: Floats
    x: Floats

    @classmethod
    def on_lines(
        cls, surface: ContactSurface, shape: SmoothSurface, facets: Indices, local: Floats, direction: Floats
    ) -> SmoothPoints:
        """Where lines (n, dim) through points of facets meet the smooth surface."""
        domain, entities = surface.body.mesh.domain, surface.entities[facets]

        def patch(local: Floats) -> tuple[Floats, Floats]:
            flat = facet_points(domain, entities, local)
            rise = shape.rise(facets, local)
            return flat.x + rise[:, None] * flat.normal, facet_map(domain, entities, local)[1]

        start = facet_map(domain, entities, local)[0]
        return cls(surface, shape, facets, local, patch(meet_line(patch, start, direction, local))[0])

    def kept(self, places: Indices) -> SmoothPoints:
        """Some of the points."""
        return replace(self, facets=self.facets[places], local=self.local[places], x=self.x[places])

    @property
    def doubt(self) -> Floats:
        """By how much the facets may be off there, where nothing tells what is smooth, (n,)."""
        return self.shape.doubt[self.facets]

    def stretch_trace(self) -> scipy.sparse.csr_matrix | None:
        """What the rise adds to u_n as the facets stretch, (n, dofs); None where the elements bend by themselves.

        Between the nodes of a circle that grows by u_r, linear elements have u_n = u_r cos α on the chord: they
        miss s u_r/R, the rise times the strain along the edges. Rigid motions stretch nothing, and the forces that
        belong to it pull each edge's ends towards each other: neither balance of a body changes.
        """
        space, ends = self.surface.body.space, self.shape.ends
        if self.shape.order != 1 or self.surface.body.degree > 1:
            return None
        dim, kind = self.x.shape[1], space.mesh.basix_cell()
        cells, local = self.surface.entities[self.facets].T
        vertices = np.array(basix.topology(kind)[dim - 1])[local]
        nodes = space.dofmap.list[cells[:, None], vertices]
        edge = self.shape.edges[self.facets]
        parts = (self.shape.rise_by_edges(self.facets, self.local) / dot(edge, edge))[..., None] * edge
        rows = np.broadcast_to(np.arange(len(cells))[:, None, None], parts.shape)
        columns = [nodes[:, ends[:, end], None] * dim + np.arange(dim) for end in (0, 1)]
        entries = np.concatenate([-parts.ravel(), parts.ravel()])
        places = (np.tile(rows.ravel(), 2), np.concatenate([c.ravel() for c in columns]))
        size = dim * space.dofmap.index_map.size_local
        trace = scipy.sparse.csr_matrix((entries, places), shape=(len(cells), size))
        trace.eliminate_zeros()
        return trace


def smoothed(surface: ContactSurface) -> SmoothSurface | None:
    """The smooth surface behind a contact surface; None where it is flat."""
    if np.ptp(surface.points.normal, axis=0).max() <= FLAT:
        return None
    nodes = _Nodes.of(surface)
    normals, doubtful = _vertex_normals(nodes)
    return _patches(nodes, normals, doubtful)


# ---------------------------------------------------------------------------------------------------------------------
# The patch between its corners


def _slope_between(t: Floats, slopes: Floats) -> Floats:
    """q in t (1 − t) q, the cubic on [0, 1] that is zero at both ends and rises inwards with the given slopes there."""
    return slopes[..., 0] * (1.0 - t) + slopes[..., 1] * t


def _slope_between_three(t: Floats, slopes: Floats) -> Floats:
    """The same for the quartic that is zero in the middle as well."""
    return (1.0 - 2.0 * t) * (slopes[..., 0] * (1.0 - t) - slopes[..., 1] * t)


def _corner_functions(kind: basix.CellType, local: Floats) -> Floats:
    """The (bi)linear functions of the corners at points of the reference facet, (n, corners)."""
    if kind == basix.CellType.quadrilateral:
        r, s = local.T
        return np.stack([(1 - r) * (1 - s), r * (1 - s), (1 - r) * s, r * s], axis=1)
    return np.column_stack([1.0 - local.sum(axis=1), local])


def _edge_coordinates(weights: Floats, ends: NDArray[np.intp], kind: basix.CellType) -> tuple[Floats, Floats]:
    """How far along every edge points lie, t from 0 to 1, and how much its rise counts there, (n, edges) each.

    On an edge itself that one alone counts, t (1 − t). On quadrilaterals each counts as it is near (Coons), on
    triangles by λᵢλⱼ: both have quadratic precision.
    """
    first, second = weights[:, ends[:, 0]], weights[:, ends[:, 1]]
    total = first + second
    if kind == basix.CellType.triangle:
        return 0.5 * (1.0 + second - first), first * second
    t = np.divide(second, total, out=np.full_like(total, 0.5), where=np.abs(total) > 1e-9)
    return t, t * (1.0 - t) * total


# ---------------------------------------------------------------------------------------------------------------------
# The nodes of the surface


@dataclass(frozen=True)
class _Nodes:
    """The nodes of a surface's facets.

    kind, order: of the facets; degree: of what is fitted; x: (m, dim) every node once; facets: (n, k) the nodes of each facet, corners first;
    normals: (n, c, dim) each facet's own at its corners; tangents: (n, e, 2, dim) along the edges from both ends;
    ends: (e, 2) the corners of every edge.
    """

    kind: basix.CellType
    order: int
    degree: int
    x: Floats
    facets: NDArray[np.intp]
    normals: Floats
    tangents: Floats
    ends: NDArray[np.intp]

    @classmethod
    def of(cls, surface: ContactSurface) -> _Nodes:
        """The nodes of a contact surface; of facets of a higher order than two only the vertices."""
        domain, dim = surface.body.mesh.domain, surface.body.mesh.dim
        element, kind = compat.coordinate_map(domain), facet_type(domain)
        cells, local = surface.entities.T
        closure = np.array(element.entity_closure_dofs[dim - 1])
        names, facets = np.unique(compat.geometry_dofmap(domain)[cells[:, None], closure[local]], return_inverse=True)
        facets = facets.reshape(len(cells), -1)
        x = domain.geometry.x[names, :dim]
        corners = np.asarray(basix.geometry(kind))
        ends = np.array(basix.topology(kind)[1])
        points = surface_points(domain, surface.entities, corners)
        repeated = np.repeat(surface.entities, len(corners), axis=0)
        _, derivatives = facet_map(domain, repeated, np.tile(corners, (len(cells), 1)))
        derivatives = derivatives.reshape(len(cells), len(corners), dim, -1)
        along = corners[ends[:, 1]] - corners[ends[:, 0]]
        tangents = np.stack(
            [
                np.einsum("neik,ek->nei", derivatives[:, ends[:, end]], sign * along)
                for end, sign in ((0, 1.0), (1, -1.0))
            ],
            axis=2,
        )
        normals = points.normal.reshape(len(cells), len(corners), dim)
        chords = x[facets[:, ends[:, 1]]] - x[facets[:, ends[:, 0]]]
        straight = np.abs(tangents[:, :, 0] - chords).max() <= 1e-9 * np.abs(chords).max()
        order = 1 if straight else element.degree
        if order != 2:
            facets = facets[:, : len(corners)]
        return cls(kind, order, 3 if order == 2 else 2, x, facets, normals, tangents, ends)

    @property
    def corners(self) -> NDArray[np.intp]:
        return self.facets[:, : self.normals.shape[1]]

    def vertex_mean(self) -> tuple[Floats, NDArray[np.bool_]]:
        """The mean of the facets' normals at every node that is a vertex, (m, dim), and whether facets are smooth
        there."""
        vertices, dim = self.corners.ravel(), self.x.shape[1]
        mean = np.stack([np.bincount(vertices, self.normals[..., i].ravel(), len(self.x)) for i in range(dim)], axis=1)
        length = np.linalg.norm(mean, axis=1, keepdims=True)
        mean = mean / np.where(length > 0.0, length, 1.0)
        cosine = dot(mean[self.corners], self.normals)
        sharp = np.bincount(vertices, (cosine < np.cos(0.5 * CREASE)).ravel(), len(self.x)) > 0
        return mean, (length[:, 0] > 0.0) & ~sharp

    def around(self, smooth: NDArray[np.bool_]) -> tuple[scipy.sparse.csr_matrix, scipy.sparse.csr_matrix]:
        """Which nodes are seen from each: those of its facets, and of the facets of their vertices that are no edge.

        Also which nodes each facet has, (n, m).
        """
        count, size = self.facets.shape
        entries = (np.ones(count * size), self.facets.ravel(), np.arange(0, count * size + 1, size))
        has = scipy.sparse.csr_matrix(entries, shape=(count, len(self.x)))
        near = (has.T @ has).tocsr()
        passed = scipy.sparse.diags(smooth.astype(float))
        seen = (passed @ (near @ passed @ near + near)).tocsr()
        seen.data[:] = 1.0
        seen.sort_indices()
        return seen, has


# ---------------------------------------------------------------------------------------------------------------------
# The fit at a vertex


@dataclass(frozen=True)
class _Fit:
    """Polynomials z(u) over the tangent planes of v vertices, and what they are worth.

    vertex: (v,) the nodes; normal: (v, dim); axes: (v, dim − 1, dim); coefficients: (v, monomials); bend: (v, dim − 1,
    dim − 1) the curvature; fair: (v,) whether the fit explains the nodes around.
    """

    vertex: Indices
    normal: Floats
    axes: Floats
    coefficients: Floats
    bend: Floats
    fair: NDArray[np.bool_]

    def normals_at(self, place: Indices, offset: Floats, degree: int) -> Floats:
        """The unit normals at points that lie at `offset` (p, dim) from the vertices at `place`."""
        axes, normal = self.axes[place], self.normal[place]
        u, z = np.einsum("pki,pi->pk", axes, offset), dot(normal, offset)
        slope = np.einsum("pmk,pm->pk", _monomial_slopes(u, degree), self.coefficients[place])
        slope /= (1.0 - _second(self.bend[place], u) * z)[:, None]
        turned = normal - np.einsum("pk,pki->pi", slope, axes)
        return turned / np.linalg.norm(turned, axis=1, keepdims=True)


def _exponents(dim: int, degree: int) -> list[tuple[int, ...]]:
    """The monomials of degrees 1 to `degree` in one or two variables."""
    if dim == 1:
        return [(p,) for p in range(1, degree + 1)]
    return [(p - q, q) for p in range(1, degree + 1) for q in range(p + 1)]


def _monomials(u: Floats, degree: int) -> Floats:
    """The monomials at u (..., dim − 1), (..., monomials)."""
    return np.stack([np.prod(u ** np.array(p), axis=-1) for p in _exponents(u.shape[-1], degree)], axis=-1)


def _monomial_slopes(u: Floats, degree: int) -> Floats:
    """The monomials' derivatives at u (p, dim − 1), (p, monomials, dim − 1)."""
    powers = np.array(_exponents(u.shape[1], degree))
    slopes = np.empty((len(u), *powers.shape))
    for k in range(u.shape[1]):
        lower = powers.copy()
        lower[:, k] = np.maximum(lower[:, k] - 1, 0)
        slopes[:, :, k] = powers[:, k] * np.prod(u[:, None, :] ** lower, axis=2)
    return slopes


def _curvature(coefficients: Floats, dim: int) -> Floats:
    """The second derivatives at the vertex, (v, dim, dim)."""
    second = coefficients[:, dim : dim + (1 if dim == 1 else 3)]
    if dim == 1:
        return 2.0 * second[:, :, None]
    a, b, c = second.T
    return np.stack([np.stack([2 * a, b], axis=1), np.stack([b, 2 * c], axis=1)], axis=1)


def _second(bend: Floats, u: Floats) -> Floats:
    """κ in z = ½uᵀHu + ½κz², the next term of a circle, a cylinder and a sphere: |Hu|²/uᵀHu, at most |H|."""
    turned = np.einsum("...kl,...l->...k", bend, u)
    largest = np.sqrt(np.einsum("...kl,...kl->...", bend, bend))
    work, square = dot(u, turned), dot(turned, turned)
    kappa = np.divide(square, work, out=np.zeros_like(work), where=np.abs(work) * largest > square)
    return np.where(np.abs(work) * largest > square, kappa, np.sign(work) * largest)


def _neighbours(seen: scipy.sparse.csr_matrix, vertices: Indices) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """The nodes around each vertex but itself, (v, k), padded with the vertex itself; and which are not padding."""
    rows = seen[vertices]
    counts = np.diff(rows.indptr)
    places = np.arange(counts.max(initial=0))
    there = places < counts[:, None]
    nodes = np.where(there, rows.indices[np.minimum(rows.indptr[:-1, None] + places, rows.nnz - 1)], vertices[:, None])
    return nodes, there & (nodes != vertices[:, None])


def _fits(nodes: _Nodes, mean: Floats, smooth: NDArray[np.bool_], seen: scipy.sparse.csr_matrix) -> _Fit:
    """The polynomials around all vertices that are no edge and see nodes enough."""
    degree, dim = nodes.degree, nodes.x.shape[1]
    unknowns = len(_exponents(dim - 1, degree))
    vertices = np.flatnonzero(smooth & (np.diff(seen.indptr) > unknowns + 1))
    around, there = _neighbours(seen, vertices)
    offset = nodes.x[around] - nodes.x[vertices][:, None]
    size = np.sqrt(dot(offset, offset)).max(axis=1, initial=0.0)
    offset = offset / np.where(size > 0.0, size, 1.0)[:, None, None]
    normal, bend = mean[vertices], np.zeros((len(vertices), dim, dim))
    for step in range(6):
        axes = axes_across(normal)
        u, z = np.einsum("vni,vki->vnk", offset, axes), np.einsum("vni,vi->vn", offset, normal)
        within = np.einsum("vki,vij,vlj->vkl", axes, bend, axes)
        data = z - 0.5 * _second(within[:, None], u) * z**2
        terms = _monomials(u, degree) * there[:, :, None]
        coefficients = _least_squares(terms, data)
        within = _curvature(coefficients, dim - 1)
        bend = np.einsum("vki,vkl,vlj->vij", axes, within, axes)
        if step < 5:
            normal = normal - np.einsum("vk,vki->vi", coefficients[:, : dim - 1], axes)
            normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    left = _length(data - np.einsum("vnm,vm->vn", terms, coefficients))
    slope = terms[:, :, : dim - 1]
    curved = _length(data - np.einsum("vnm,vm->vn", slope, _least_squares(slope, data)))
    fair = left <= np.maximum(UNEXPLAINED[degree] * curved, 1e-11)
    # Back to the surface's unit of length.
    powers = np.array([sum(p) - 1 for p in _exponents(dim - 1, degree)])
    coefficients = coefficients * size[:, None] ** -powers
    return _Fit(vertices, normal, axes, coefficients, within / size[:, None, None], fair)


def _length(rows: Floats) -> Floats:
    return np.sqrt(dot(rows, rows))


def _least_squares(terms: Floats, data: Floats) -> Floats:
    """The least-squares coefficients (v, m) of terms (v, n, m) for data (v, n); of what they cannot tell, none."""
    scale = np.sqrt(np.einsum("vnm,vnm->vm", terms, terms))
    scale = np.where(scale > 1e-12, scale, 1.0)
    terms = terms / scale[:, None]
    square = np.einsum("vnm,vnl->vml", terms, terms) + 1e-12 * np.eye(terms.shape[2])
    right = np.einsum("vnm,vn->vm", terms, data)
    return np.linalg.solve(square, right[:, :, None])[:, :, 0] / scale


# ---------------------------------------------------------------------------------------------------------------------
# From the vertices to the facets


def _vertex_normals(nodes: _Nodes) -> tuple[Floats, NDArray[np.bool_]]:
    """The smooth surface's normals at every facet's corners, (n, c, dim), and which facets have none, (n,).

    A corner whose own fit is fair has that fit's normal. Any other takes the mean of what the fair fits around say that
    have seen all of the facet: so a fit never reaches across a crease.
    """
    mean, smooth = nodes.vertex_mean()
    seen, has = nodes.around(smooth)
    fit = _fits(nodes, mean, smooth, seen)
    degree, corners = nodes.degree, nodes.corners
    place = np.full(len(nodes.x), -1)
    place[fit.vertex[fit.fair]] = np.flatnonzero(fit.fair)
    own = place[corners]
    normals = np.where((own >= 0)[..., None], fit.normal[np.maximum(own, 0)] if len(fit.vertex) else 0.0, 0.0)
    asking = np.flatnonzero((own < 0).any(axis=1))
    fair = np.flatnonzero(fit.fair)
    if len(asking) and len(fair):
        sees = (seen[fit.vertex[fair]] @ has[asking].T).tocoo()
        whole = sees.data > nodes.facets.shape[1] - 0.5
        witness, facet = fair[sees.row[whole]], sees.col[whole]
        said = np.zeros((len(asking), *normals.shape[1:]))
        for corner in range(corners.shape[1]):
            offset = nodes.x[corners[asking[facet], corner]] - nodes.x[fit.vertex[witness]]
            np.add.at(said[:, corner], facet, fit.normals_at(witness, offset, degree))
        lengths = np.linalg.norm(said, axis=2, keepdims=True)
        said = said / np.where(lengths > 0.0, lengths, 1.0)
        normals[asking] = np.where((own[asking] >= 0)[..., None], normals[asking], said)
    return normals, (dot(normals, normals) < 0.5).any(axis=1)


def _patches(nodes: _Nodes, normals: Floats, doubtful: NDArray[np.bool_]) -> SmoothSurface:
    """The patches with the given normals at their corners; facets that have none stay as they are."""
    as_meshed = doubtful | (nodes.order > 2)
    used = np.where(as_meshed[:, None, None], nodes.normals, normals)
    slopes, length = _slopes(nodes, used), np.sqrt(dot(nodes.tangents, nodes.tangents))
    slopes[np.abs(slopes) <= FLAT * length] = 0.0
    tilt = used - nodes.normals
    tilt[np.abs(tilt).max(axis=(1, 2)) <= FLAT] = 0.0
    edges = nodes.x[nodes.facets[:, nodes.ends[:, 1]]] - nodes.x[nodes.facets[:, nodes.ends[:, 0]]]
    bend = _bend(slopes, edges) if nodes.order == 1 else np.zeros(len(edges))
    glides = _glides(nodes.x[nodes.corners], normals) if not doubtful.any() else np.zeros((0, 0, 0))
    doubt = _doubt(nodes, as_meshed) if nodes.order <= 2 else np.zeros(len(edges))
    return SmoothSurface(nodes.order, nodes.kind, tilt, nodes.ends, edges, slopes, bend, doubt, glides)


def _bend(slopes: Floats, edges: Floats) -> Floats:
    """Half of the curvature of a circle that rises with the slopes above edges, the most bent of each facet's, (n,)."""
    bends = slopes.mean(axis=2) / dot(edges, edges)
    return np.take_along_axis(bends, np.abs(bends).argmax(axis=1)[:, None], axis=1)[:, 0]


def _glides(x: Floats, normals: Floats) -> Floats:
    """The rigid motions that carry a surface along itself, from its points and normals (..., dim): (k, dim, 1 + dim).

    On a circle its turning, on a sphere three, on a cylinder turning and shift: v(x)·n = 0 everywhere.
    """
    dim = x.shape[-1]
    x, normals = x.reshape(-1, dim), normals.reshape(-1, dim)
    middle = x.mean(axis=0)
    size = np.abs(x - middle).max()
    motions = _rigid_motions(dim)
    velocities = motions[:, None, :, 0] + np.einsum("kij,pj->kpi", motions[:, :, 1:], (x - middle) / size)
    _, singular, coefficients = np.linalg.svd(dot(velocities, normals).T, full_matrices=False)
    glides = np.einsum("gk,kij->gij", coefficients[singular <= GLIDING * singular[0]], motions)
    glides[:, :, 1:] /= size
    glides[:, :, 0] -= glides[:, :, 1:] @ middle
    return glides


def _rigid_motions(dim: int) -> Floats:
    """The rigid motions v(x) = a + A x of space, (motions, dim, 1 + dim)."""
    pairs = [(i, j) for i in range(dim) for j in range(i + 1, dim)]
    motions = np.zeros((dim + len(pairs), dim, 1 + dim))
    motions[range(dim), range(dim), 0] = 1.0
    for row, (i, j) in enumerate(pairs, start=dim):
        motions[row, i, 1 + j], motions[row, j, 1 + i] = -1.0, 1.0
    return motions


def _slopes(nodes: _Nodes, normals: Floats) -> Floats:
    """How a surface with the given normals at the corners rises above each facet along its edges, (n, e, 2)."""
    at, own = normals[:, nodes.ends], nodes.normals[:, nodes.ends]
    return -dot(at, nodes.tangents) / dot(at, own)


def _doubt(nodes: _Nodes, doubtful: NDArray[np.bool_]) -> Floats:
    """The sagitta that a facet would have if the surface were smooth there, where nothing says that it is, (n,)."""
    mean, smooth = nodes.vertex_mean()
    at = np.where(smooth[nodes.corners][..., None], mean[nodes.corners], nodes.normals)
    sagitta = np.abs(_slopes(nodes, at)).max(axis=(1, 2)) / (4.0 if nodes.order == 1 else 16.0)
    return np.where(doubtful, sagitta, 0.0)
