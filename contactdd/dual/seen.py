"""A solution seen on finer meshes, where its displacements are the same."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from dolfinx import fem

from ..base.arrays import Floats, Indices
from ..body import Body
from ..contact import Contact
from ..interface.discretise import Interface, discretise
from ..mesh import Mesh
from ..solution import Solution


@dataclass(frozen=True)
class SeenSolution:
    """A solution on meshes that its own were refined to, cell by cell the same polynomials.

    contacts: the scene's; bodies: of it, on the finer meshes; displacements: of every body.
    """

    contacts: tuple[Contact, ...]
    bodies: tuple[Body, ...]
    displacements: tuple[fem.Function, ...]

    @classmethod
    def of(cls, solution: Solution) -> SeenSolution:
        """A solution on its own meshes."""
        bodies = solution.scene.bodies
        return cls(solution.scene.contacts, bodies, tuple(solution.displacement(body) for body in bodies))

    def on(self, meshes: Mapping[str, Mesh]) -> SeenSolution:
        """The same on meshes, by the bodies' names, that the present ones were refined to at once."""
        bodies = tuple(body.on(meshes.get(body.name, body.mesh)) for body in self.bodies)
        return SeenSolution(self.contacts, bodies, tuple(map(_interpolated, bodies, self.bodies, self.displacements)))

    def contact(self, index: int, degree: int) -> tuple[Interface, Floats]:
        """A contact at Gauss points of a degree, and its gaps there; its facets may no longer match."""
        contact = self.contacts[index].with_bodies({body.name: body for body in self.bodies}).resampled(degree)
        names = [body.name for body in self.bodies]
        places = [names.index(body.name) for body, _ in contact.sides]
        interface = discretise(contact, (places[0], places[1]))
        closed = [side.trace @ self.displacements[side.body].x.array for side in interface.sides]
        return interface, interface.gap - closed[0] - closed[1]

    def cells_at(self, index: int, chosen: Sequence[Indices]) -> dict[str, list[int]]:
        """The cells of both bodies at facets of a contact, chosen (first's, second's) by index."""
        sides = self.contacts[index].with_bodies({body.name: body for body in self.bodies}).sides
        found: dict[str, list[int]] = {}
        for (body, surface), facets in zip(sides, chosen, strict=True):
            found.setdefault(body.name, []).extend(body.mesh.entities(surface)[facets, 0].tolist())
        return found


def _interpolated(body: Body, coarse: Body, u: fem.Function) -> fem.Function:
    function = fem.Function(body.space)
    values = body.elements.interpolated(u, coarse.elements)
    assert values is not None, "a mesh that was refined from the present one"
    function.x.array[:] = values
    return function


def refined(meshes: Mapping[str, Mesh], cells: Mapping[str, Sequence[int]]) -> dict[str, Mesh]:
    """Some meshes, finer in some cells."""
    return {name: meshes[name].refined(np.unique(chosen)) for name, chosen in cells.items() if len(chosen)}


def unmatched(interface: Interface) -> list[Indices]:
    """The facets of either surface that are longer than those opposite, where they do not match."""
    middles = [side.meshed.middles.x for side in interface.sides]
    sizes = [side.meshed.facet_sizes for side in interface.sides]
    found = []
    for own, other in ((0, 1), (1, 0)):
        apart = np.linalg.norm(middles[own][:, None] - middles[other][None], axis=2)
        nearest = np.argmin(apart, axis=1)
        found.append(np.flatnonzero(sizes[own] > 1.5 * sizes[other][nearest]))
    return found
