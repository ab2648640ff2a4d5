"""Fields on one of a contact's surfaces: linear functions of its nodes, and the projection of a pressure onto them.

A field Σ c_i ψ_i has one value at every vertex of the surface's facets, whatever the bodies' degree: these functions
are nowhere negative, and the bodies' displacements can follow each of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property

import basix
import numpy as np
import scipy

from ..base import compat
from ..base.arrays import Floats, Indices
from ..base.basis import basis_values
from ..base.facets import FacetPoints, facet_nodes
from .surface import ContactSurface

#: A body whose surface is this much softer carries the nodes, whatever the facets.
SOFTER = 3.0


@dataclass(frozen=True)
class LinearFunctions:
    """The linear functions of a surface's nodes, on a contact.

    surface; points: (p,) where they are integrated, weights: (p,) their areas; mean: (values, p) from there to the
    contact's values, None where these are the points.
    """

    surface: ContactSurface
    points: FacetPoints
    weights: Floats
    mean: scipy.sparse.csr_matrix | None = None

    @cached_property
    def x(self) -> Floats:
        """The nodes that the contact reaches, (nodes, dim)."""
        return node_coordinates(self.surface)[self._reached]

    @cached_property
    def at_values(self) -> scipy.sparse.csr_matrix:
        """The functions' means over the points of each value, (values, nodes)."""
        return self._at_points if self.mean is None else (self.mean @ self._at_points).tocsr()

    def interpolated(self, values: Floats) -> Floats:
        """The field with these values at all nodes of the surface, at the contact's values."""
        at_points = self._hats @ values
        return at_points if self.mean is None else self.mean @ at_points

    def projected(self, values: Floats, weights: Floats) -> Floats:
        """The coefficients c (nodes,) of the L² projection: Σ c_j ∫ ψ_i ψ_j = Σ_v weights_v values_v ψ_i(v)."""
        scale, mass = self._mass
        return scale * mass.solve(scale * (self.at_values.T @ (weights * values)))

    def everywhere(self, values: Floats) -> Floats:
        """Values (nodes,) at the nodes `x`, and zeros at all others of the surface."""
        field = np.zeros(self._hats.shape[1])
        field[self._reached] = values
        return field

    @cached_property
    def _hats(self) -> scipy.sparse.csr_matrix:
        return hats(self.surface, self.points)

    @cached_property
    def _reached(self) -> Indices:
        total = self._hats.T @ self.weights
        return np.flatnonzero(total > 1e-14 * total.max())

    @cached_property
    def _at_points(self) -> scipy.sparse.csr_matrix:
        return self._hats[:, self._reached].tocsr()

    @cached_property
    def _mass(self) -> tuple[Floats, scipy.sparse.linalg.SuperLU]:
        """∫ ψ_i ψ_j scaled to a diagonal of ones, so that a node at the edge of an overlap does no harm."""
        mass = self._at_points.T @ scipy.sparse.diags(self.weights) @ self._at_points
        scale = 1.0 / np.sqrt(mass.diagonal())
        return scale, scipy.sparse.linalg.splu((scipy.sparse.diags(scale) @ mass @ scipy.sparse.diags(scale)).tocsc())


def node_coordinates(surface: ContactSurface) -> Floats:
    """The vertices of a surface's facets, each once, (nodes, dim)."""
    return surface.body.mesh.domain.geometry.x[_nodes(surface), : surface.body.mesh.dim]


def hats(surface: ContactSurface, points: FacetPoints) -> scipy.sparse.csr_matrix:
    """The linear functions of a surface's nodes at points of its facets, (points, nodes)."""
    domain, nodes = surface.body.mesh.domain, _nodes(surface)
    basis = basis_values(_linear(compat.coordinate_map(domain).cell_type), points.reference)
    point, corner = np.nonzero(basis > 1e-12)  # those of inner vertices vanish on a facet
    # The first of a cell's geometry nodes are its vertices.
    node = np.searchsorted(nodes, compat.geometry_dofmap(domain)[points.cells[point], corner])
    values = basis[point, corner]
    values /= np.bincount(point, values, len(basis))[point]  # their sum is one to the last digit
    return scipy.sparse.csr_matrix((values, (point, node)), shape=(len(basis), len(nodes)))


def side_of_nodes(surfaces: tuple[ContactSurface, ContactSurface], facets: tuple[Indices, Indices]) -> int:
    """The side, 0 or 1, whose nodes carry a contact's pressure.

    That of the softer body, which can follow any pressure on its own nodes; of bodies about equally stiff the coarser
    surface, whose functions both can follow; else the first. facets: (n,) those of both sides that lie opposite.
    """
    moduli = [float(np.median(side.moduli[own])) for side, own in zip(surfaces, facets, strict=True)]
    if max(moduli) > SOFTER * min(moduli):
        return int(np.argmin(moduli))
    first, second = (float(np.median(side.facet_sizes[own])) for side, own in zip(surfaces, facets, strict=True))
    return int(second > (1 + 1e-6) * first)


def _nodes(surface: ContactSurface) -> Indices:
    """The geometry nodes at the vertices of a surface's facets, in order."""
    return np.unique(facet_nodes(surface.body.mesh.domain, surface.entities))


@cache
def _linear(cell: basix.CellType) -> basix.finite_element.FiniteElement:
    return basix.create_element(basix.ElementFamily.P, cell, 1)
