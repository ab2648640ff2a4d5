"""What other ranks are told of a body: the cells behind its contact surfaces, from which they make a body of their own.

That body stands for the whole one in contacts: its surfaces have the same facets in the same order, nodes, elements and
moduli, so that every rank discretises the contacts alike. It holds no supports and loads and is never solved.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import basix
import basix.ufl
import numpy as np

from .base import compat
from .base.arrays import Floats, Indices, components
from .base.facets import facet_type, surface_points
from .base.ranks import Ranks
from .body import Body
from .contact import Contact
from .deferred_body import DeferredBody
from .material import Anisotropic, Material
from .mesh import cells_behind
from .meshless import MeshlessBody


@dataclass(frozen=True)
class Skin:
    """The cells behind contact surfaces of a body.

    cells: (c, k) the nodes of each, x: (n, dim) the nodes' coordinates; shape: of the cells, and geometry their degree
    and Lagrange variant; surfaces: {name: (facets, 2) the cell and local facet of each facet}; extent: (dim,) of the
    whole mesh; nodes: (c, m) the numbers, from 0, of each cell's nodes in the body's elements; places: (facets, 3) the
    middles of all facets, and stiffness: (facets, 6, 6) there, a single one where it does not vary.
    """

    name: str
    degree: int
    kinematics: str
    cells: Indices
    x: Floats
    shape: str
    geometry: tuple[int, int]
    surfaces: dict[str, Indices]
    extent: Floats
    nodes: Indices
    places: Floats
    stiffness: Floats

    def body(self) -> tuple[Body, Indices]:
        """The body that stands for the whole one, and the place of its degrees of freedom among those told of."""
        degree, variant = self.geometry
        element = compat.coordinate_element(self.shape, degree)
        if degree > 2:
            kind, dim = basix.LagrangeVariant(variant), self.x.shape[1]
            element = basix.ufl.element("Lagrange", self.shape, degree, kind, shape=(dim,))
        mesh, given = cells_behind(self.cells, self.x, element, self.surfaces, self.extent)
        varies = len(self.stiffness) > 1
        material = MaterialAtPoints(self.places, self.stiffness) if varies else Anisotropic(self.stiffness[0])
        body = Body(self.name, mesh, material, degree=self.degree, kinematics=self.kinematics)
        order = np.empty(body.dofs // mesh.dim, dtype=np.int64)
        order[body.space.dofmap.list] = self.nodes[given]
        return body, components(order, mesh.dim)


class MaterialAtPoints(Material):
    """Hooke's law at some points, elsewhere that of the nearest of them."""

    checked = True

    def __init__(self, points: Floats, stiffness: Floats) -> None:
        from scipy.spatial import cKDTree

        self._nearest, self._values = cKDTree(points), stiffness

    @property
    def varies(self) -> bool:
        return True

    def _stiffness(self, x: Floats) -> Floats:
        return self._values[self._nearest.query(x.T)[1]]


def skin(body: Body, surfaces: Iterable[str]) -> tuple[Skin, Indices]:
    """The cells of a body behind some surfaces, and its degrees of freedom in them."""
    mesh, domain, geometry = body.mesh, body.mesh.domain, compat.coordinate_map(body.mesh.domain)
    entities = {name: mesh.entities(name) for name in sorted(surfaces)}
    pairs = np.concatenate(list(entities.values()))
    there = np.unique(pairs[:, 0])
    used, cells = _renumbered(compat.geometry_dofmap(domain)[there])
    nodes, of_cells = _renumbered(body.space.dofmap.list[there])
    middle = np.asarray(basix.geometry(facet_type(domain))).mean(axis=0)[None]
    places = np.zeros((len(pairs), 3))
    places[:, : mesh.dim] = surface_points(domain, pairs, middle).x
    varies = body.material.varies
    told = Skin(
        body.name,
        body.degree,
        body.kinematics.name,
        cells,
        domain.geometry.x[used, : mesh.dim],
        domain.topology.cell_name(),
        (geometry.degree, int(geometry.lagrange_variant)),
        {name: np.column_stack([np.searchsorted(there, each[:, 0]), each[:, 1]]) for name, each in entities.items()},
        mesh.extent,
        of_cells,
        places,
        body.stiffness_at(places.T, pairs[:, 0]) if varies else body.material.stiffness()[None],
    )
    return told, components(nodes, mesh.dim)


def _renumbered(table: Indices) -> tuple[Indices, Indices]:
    """The numbers in a table, in order, and the table with their places among these."""
    found, places = np.unique(table, return_inverse=True)
    return found, places.reshape(table.shape)


def made_by_owners(
    bodies: Sequence[Body | DeferredBody | MeshlessBody], contacts: Sequence[Contact], ranks: Ranks
) -> tuple[tuple[Any, ...], tuple[Contact, ...], dict[int, Indices]]:
    """The bodies that this rank knows and the contacts between them, and the degrees of freedom that all ranks know.

    Of a deferred body its owners have the whole one, and the degrees of freedom in its skin; the others have what
    stands for it, and the places of its degrees of freedom among those. On one rank nothing is told.
    """
    whole: dict[int, Body] = {}
    known: dict[int, Indices] = {}

    def make(index: int) -> Skin | None:
        body = bodies[index]
        if not isinstance(body, DeferredBody):
            return None
        whole[index] = body.made()
        if ranks.alone:
            return None
        told, known[index] = skin(whole[index], {s for c in contacts for b, s in c.sides if b is body})
        return told

    for index, told in enumerate(ranks.each(make)):
        if told is not None and not ranks.owns(index):
            whole[index], known[index] = told.body()
    made = {body.name: body for body in whole.values()}
    found = tuple(made.get(body.name, body) for body in bodies)
    return found, tuple(contact.with_bodies(made) for contact in contacts), known
