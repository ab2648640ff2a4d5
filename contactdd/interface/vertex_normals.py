"""The normals that the smooth surface behind a surface's facets has at their vertices, from the nodes alone.

Every vertex looks at the nodes around it, fits a polynomial (exact on circles, cylinders and spheres), and believes it
where it explains the nodes. Next to a crease the fit of a vertex further away is taken, so that it comes from one side;
where no fit is fair (a notch, a step, a rough profile) there is no smooth surface.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from ..base.arrays import Floats, Indices
from ..base.facets import dot
from .overlap import axes_across

#: Facets whose normals are further than half of this from their mean at a vertex form an edge, however regular.
CREASE = np.radians(35.0)

#: What part of the nodes' departure from a plane a fit may leave unexplained, by its degree. A parabola leaves 0.22 of
#: a fold between two planes, 0.21 where a plane ends in an arc, 0.07 where curvature grows by a third each facet.
UNEXPLAINED = {2: 0.1, 3: 0.01}


@dataclass(frozen=True)
class SurfaceNodes:
    """The nodes of a surface's n facets.

    x: (m, dim) every node once; facets: (n, k) the nodes of each facet, its c corners first; normals: (n, c, dim) each
    facet's own at its corners; degree: of what is fitted to the nodes.
    """

    x: Floats
    facets: NDArray[np.intp]
    normals: Floats
    degree: int

    @property
    def corners(self) -> NDArray[np.intp]:
        return self.facets[:, : self.normals.shape[1]]

    def vertex_mean(self, crease: float = CREASE) -> tuple[Floats, NDArray[np.bool_]]:
        """The mean of the facets' normals at every node that is a vertex, (m, dim), and whether that is no edge."""
        vertices, dim = self.corners.ravel(), self.x.shape[1]
        mean = np.stack([np.bincount(vertices, self.normals[..., i].ravel(), len(self.x)) for i in range(dim)], axis=1)
        length = np.linalg.norm(mean, axis=1, keepdims=True)
        mean = mean / np.where(length > 0.0, length, 1.0)
        cosine = dot(mean[self.corners], self.normals)
        sharp = np.bincount(vertices, (cosine < np.cos(0.5 * crease)).ravel(), len(self.x)) > 0
        return mean, (length[:, 0] > 0.0) & ~sharp

    def around(self, smooth: NDArray[np.bool_]) -> tuple[scipy.sparse.csr_matrix, scipy.sparse.csr_matrix]:
        """The nodes around each node: those of its facets, and of the facets of their vertices that are no edge.

        Also the nodes of each facet, (n, m).
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


def vertex_normals(nodes: SurfaceNodes) -> tuple[Floats, NDArray[np.bool_]]:
    """The smooth surface's normals at every facet's corners, (n, c, dim), and which facets have none, (n,).

    A corner whose own fit is fair has that fit's normal. Any other takes the mean of what the fair fits around say that
    have seen all of the facet: so a fit never reaches across a crease.
    """
    mean, smooth = nodes.vertex_mean()
    seen, has = nodes.around(smooth)
    fit = _fits(nodes, mean, smooth, seen)
    degree, corners = nodes.degree, nodes.corners
    fit_of_node = np.full(len(nodes.x), -1)
    fit_of_node[fit.vertex[fit.fair]] = np.flatnonzero(fit.fair)
    own = fit_of_node[corners]
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
    return normals, ~(dot(normals, nodes.normals) > np.cos(0.5 * CREASE)).all(axis=1)  # not a number is none


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

    def normals_at(self, fit: Indices, offset: Floats, degree: int) -> Floats:
        """The unit normals at points that lie at `offset` (p, dim) from the vertices of the fits `fit`."""
        axes, normal = self.axes[fit], self.normal[fit]
        u, z = np.einsum("pki,pi->pk", axes, offset), dot(normal, offset)
        slope = np.einsum("pmk,pm->pk", _monomial_slopes(u, degree), self.coefficients[fit])
        slope /= (1.0 - _second(self.bend[fit], u) * z)[:, None]
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


def _fits(nodes: SurfaceNodes, mean: Floats, smooth: NDArray[np.bool_], seen: scipy.sparse.csr_matrix) -> _Fit:
    """The polynomials around all vertices that are no edge and see nodes enough."""
    degree, dim = nodes.degree, nodes.x.shape[1]
    unknowns = len(_exponents(dim - 1, degree))
    vertices = np.flatnonzero(smooth & (np.diff(seen.indptr) > unknowns + 2))
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
    fair = left <= np.maximum(UNEXPLAINED[degree] * curved, 1e-11)  # rounding explains the rest
    fair &= dot(normal, mean[vertices]) > np.cos(0.5 * CREASE)
    # Back to the surface's unit of length.
    powers = np.array([sum(p) - 1 for p in _exponents(dim - 1, degree)])
    coefficients = coefficients * size[:, None] ** -powers
    return _Fit(vertices, normal, axes, coefficients, within / size[:, None, None], fair)


def _length(rows: Floats) -> Floats:
    return np.sqrt(dot(rows, rows))


def _least_squares(terms: Floats, data: Floats) -> Floats:
    """The least-squares coefficients (v, m) of terms (v, n, m) for data (v, n); undetermined ones are zero."""
    scale = np.sqrt(np.einsum("vnm,vnm->vm", terms, terms))
    scale = np.where(scale > 1e-12, scale, 1.0)
    terms = terms / scale[:, None]
    square = np.einsum("vnm,vnl->vml", terms, terms) + 1e-12 * np.eye(terms.shape[2])
    right = np.einsum("vnm,vn->vm", terms, data)
    return np.linalg.solve(square, right[:, :, None])[:, :, 0] / scale
