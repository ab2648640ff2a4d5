"""A contact surface facet by facet, as plain arrays: what maps and files show of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .base.arrays import Floats, Indices

#: What `SurfaceResult.status` says.
STATUS = {0: "nothing opposite", 1: "open", 2: "partly closed", 3: "closed"}


@dataclass(frozen=True)
class SurfaceResult:
    """One body's side of a contact, f facets on m nodes of the body's own degree.

    Args:
        name: of the contact.
        body: the name of the body whose surface it is.
        points: (m, dim) the nodes.
        cells: (f, k) the nodes of each facet, in VTK's order.
        cell_type: VTK's number of the facets' shape.
        displacement: (m, dim) of the body at the nodes (length).
        areas: (f,) of the facets.
        covered: (f,) the part of each facet that lies opposite the other surface.
        closed: (f,) the part of what is covered where the layer is compressed.
        pressure: (f,) the mean over the facet, so that areas @ pressure is the contact force (stress).
        gap, compression: (f,) the means over what is covered (length); not a number where that is nothing.
        projected_pressure: (m,) a continuous pressure at the nodes, where the solution has one.
    """

    name: str
    body: str
    points: Floats
    cells: Indices
    cell_type: int
    displacement: Floats
    areas: Floats
    covered: Floats
    closed: Floats
    pressure: Floats
    gap: Floats
    compression: Floats
    projected_pressure: Floats | None = None

    @property
    def status(self) -> Indices:
        """The state of each facet, (f,), see `STATUS`; 1e-6 of a facet is rounding."""
        state = np.where(self.closed >= 1.0 - 1e-6, 3, np.where(self.closed > 1e-6, 2, 1))
        return np.where(self.covered > 1e-6, state, 0)

    @property
    def outlines(self) -> Floats:
        """The corners of the facets in order around each, (f, corners, dim)."""
        corners = {3: 2, 68: 2, 5: 3, 69: 3, 9: 4, 70: 4}[self.cell_type]
        return self.points[self.cells[:, :corners]]

    @property
    def edge(self) -> Floats:
        """The facets' sides between contact and none, (e, 2, 3): the edge of contact in space, as fine as the facets.

        A facet is in contact if its mean gap is negative; the surface's own rim is not part of the edge.
        """
        corners = self.outlines.shape[1]
        around = self.cells[:, :corners]
        sides = np.stack([around, np.roll(around, -1, axis=1)], axis=2).reshape(-1, 2)
        touching = np.repeat(np.nan_to_num(self.gap, nan=1.0) < 0.0, corners)
        _, first, inverse, count = np.unique(
            np.sort(sides, axis=1), axis=0, return_index=True, return_inverse=True, return_counts=True
        )
        closed = np.bincount(inverse.ravel(), touching)
        return self.points[sides[first[(count == 2) & (closed == 1)]]]
