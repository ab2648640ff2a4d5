"""Quadrature rules of a contact: the points and weights at which the layer's law is evaluated.

"facet":  one value per facet (DG0), the law at the facet's mean gap;
"vertex": the facet's vertices with equal weights, as in the paper's computations;
"gauss":  Gauss points, accurate for elements of higher degree (the default);
"mortar": one value per node of one surface, the law at the weighted mean gap there. The pressure is a linear field on
          that surface, which the bodies' displacements can follow however stiff the layer is.

Integration points: where ∫ φ u_n v_n is evaluated. Values, at evaluation points: where the layer law is evaluated.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar

import basix
import basix.ufl
import numpy as np
import scipy
from numpy.typing import NDArray

from .base.arrays import Floats, Indices
from .base.basis import quadrature_rule
from .base.checks import as_count, check_choice


@dataclass(frozen=True)
class Sampling:
    """The relation between the values of a contact and its integration points.

    mean: (values, points) the weighted means; weights: (values,) areas; spread: (points, values) from values to points;
    both matrices are None where the values are those at the points; nodes: (values,) the indices of the nodes that
    carry them, gathered: (nodes, values) the value of each node; None where values belong to points or segments.
    """

    mean: scipy.sparse.csr_matrix | None
    weights: Floats
    spread: scipy.sparse.csr_matrix | None
    nodes: Indices | None = None
    gathered: scipy.sparse.csr_matrix | None = None

    def means(self, rows: Any) -> Any:
        """The values of rows (points, ...) of an array or a sparse matrix."""
        return rows if self.mean is None else self.mean @ rows


@dataclass(frozen=True)
class Quadrature(ABC):
    """A contact quadrature; degree: the polynomial degree that its integrals are exact for.

    name: what the user calls it; splits: whether facets may be split into segments, as unlike meshes need;
    of_nodes: whether the values belong to nodes, so that facets are split in any case; rings: whether 2πr is
    integrated well enough for bodies of revolution; largest_degree: of elements whose accuracy the rule keeps.
    """

    degree: int

    name: ClassVar[str]
    splits: ClassVar[bool] = True
    of_nodes: ClassVar[bool] = False
    rings: ClassVar[bool] = True
    largest_degree: ClassVar[float] = np.inf

    def points(self, facet: basix.CellType) -> tuple[Floats, Floats]:
        """Integration points (n, dim − 1) and weights (n,) on the reference facet."""
        return _gauss(facet, self.degree)

    def points_per_value(self, per_facet: int) -> int:
        """The number of a facet's integration points that share one value, on a surface that is not split."""
        return 1

    @abstractmethod
    def element(self, cell_name: str) -> Any:
        """The element on the facet submesh in which the Robin coefficient φ lives."""

    @property
    def metadata(self) -> dict[str, Any]:
        """The metadata with which the UFL measure of the Robin term uses the same points."""
        return {"quadrature_rule": "default", "quadrature_degree": self.degree}

    @abstractmethod
    def sampling(self, weights: Floats, segment: Indices, hats: Callable[[], scipy.sparse.csr_matrix]) -> Sampling:
        """The values on segments.

        weights, segment: (points,) the area and the segment of each point; hats: (points, nodes) the linear functions
        of the nodes of the surface whose nodes may carry values.
        """


class FacetQuadrature(Quadrature):
    """One value per facet or segment."""

    name = "facet"

    def points_per_value(self, per_facet: int) -> int:
        return per_facet

    def element(self, cell_name: str) -> Any:
        return basix.ufl.element("Discontinuous Lagrange", cell_name, 0)

    def sampling(self, weights: Floats, segment: Indices, hats: Callable[[], scipy.sparse.csr_matrix]) -> Sampling:
        total = np.asarray(np.bincount(segment, weights), dtype=float)
        points = np.arange(len(segment))
        mean = scipy.sparse.csr_matrix((weights / total[segment], (segment, points)), shape=(len(total), len(points)))
        return Sampling(
            mean, total, scipy.sparse.csr_matrix((np.ones(len(points)), (points, segment)), shape=mean.shape[::-1])
        )


class VertexQuadrature(Quadrature):
    """The facet's vertices with equal weights."""

    name, splits, rings, largest_degree = "vertex", False, False, 1

    def points(self, facet: basix.CellType) -> tuple[Floats, Floats]:
        vertices = np.asarray(basix.geometry(facet))
        return vertices, np.full(len(vertices), basix.cell.volume(facet) / len(vertices))

    def element(self, cell_name: str) -> Any:
        return basix.ufl.element("Discontinuous Lagrange", cell_name, 1)

    @property
    def metadata(self) -> dict[str, Any]:
        return {"quadrature_rule": "vertex", "quadrature_degree": 1}

    def sampling(self, weights: Floats, segment: Indices, hats: Callable[[], scipy.sparse.csr_matrix]) -> Sampling:
        raise ValueError("quadrature = 'vertex': the vertices of facets are none of their segments")


class GaussQuadrature(Quadrature):
    """A value at every Gauss point."""

    name = "gauss"

    def element(self, cell_name: str) -> Any:
        return basix.ufl.quadrature_element(cell_name, degree=self.degree)

    def sampling(self, weights: Floats, segment: Indices, hats: Callable[[], scipy.sparse.csr_matrix]) -> Sampling:
        return Sampling(None, weights, None)


class MortarQuadrature(GaussQuadrature):
    """A value at every node of one surface; the bodies' own Robin terms are integrated at Gauss points."""

    name, of_nodes = "mortar", True

    def sampling(self, weights: Floats, segment: Indices, hats: Callable[[], scipy.sparse.csr_matrix]) -> Sampling:
        functions = hats()
        shares = (scipy.sparse.diags(weights) @ functions).tocsr()
        total = np.asarray(shares.sum(axis=0)).ravel()
        owner = _owners(total, (functions.T @ shares).tocsr())
        nodes, value = np.unique(owner[owner >= 0], return_inverse=True)
        reached = np.flatnonzero(owner >= 0)
        gathered = scipy.sparse.csr_matrix((np.ones(len(reached)), (reached, value)), shape=(len(total), len(nodes)))
        area = gathered.T @ total
        mean = (scipy.sparse.diags(1.0 / area) @ (shares @ gathered).T).tocsr()
        return Sampling(mean, area, (functions @ gathered).tocsr(), nodes, gathered)


#: A node that a contact covers by less than this part of its neighbour takes the neighbour's value: the deformation
#: hardly feels a pressure there. On the axis of a body of revolution it is a sixth.
COVERED = 0.1


def _owners(total: Floats, overlap: scipy.sparse.csr_matrix) -> Indices:
    """The node whose value each node takes, −1 where the contact does not reach.

    total: (nodes,) the areas; overlap: (nodes, nodes) ∫ ψ_i ψ_j.
    """
    owner = np.where(total > 0.0, np.arange(len(total)), -1)
    rows = np.repeat(np.arange(len(total)), np.diff(overlap.indptr))
    largest = np.zeros(len(total))
    np.maximum.at(largest, rows, total[overlap.indices])
    weak = np.flatnonzero((total > 0.0) & (total < COVERED * largest))
    for node in weak[np.argsort(-total[weak])]:  # the larger first: the others may join them
        others = overlap.indices[overlap.indptr[node] : overlap.indptr[node + 1]]
        owner[node] = owner[others[np.argmax(total[others])]]
    return owner


RULES: dict[str, type[Quadrature]] = {
    kind.name: kind for kind in (FacetQuadrature, VertexQuadrature, GaussQuadrature, MortarQuadrature)
}


@cache
def _gauss(facet: basix.CellType, degree: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    points, weights = quadrature_rule(facet, degree)
    points.setflags(write=False)  # cached and shared: read-only
    weights.setflags(write=False)
    return points, weights


def find_quadrature(name: str, element_degree: int, degree: int | None = None) -> Quadrature:
    """The rule of that name for elements of `element_degree`; `degree` overrides the degree of exactness.

    The default integrates the product of two displacements exactly, as ∫ φ u_n v_n needs.
    """
    kind = RULES[check_choice("quadrature", name, tuple(RULES))]
    if element_degree > kind.largest_degree:
        others = ", ".join(repr(other) for other, rule in RULES.items() if element_degree <= rule.largest_degree)
        raise ValueError(
            f"quadrature = {name!r} with elements of degree {element_degree}: its points alone would spoil their "
            f"accuracy; expected one of {others}"
        )
    return kind(2 * element_degree if degree is None else as_count("quadrature_degree", degree))
