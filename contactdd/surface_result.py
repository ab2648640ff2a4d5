"""A contact surface facet by facet, as plain arrays, for maps and files."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .base.arrays import Floats, Indices

#: The values of `SurfaceResult.status` in words.
STATUS = {0: "nothing opposite", 1: "open", 2: "partly closed", 3: "closed"}


@dataclass(frozen=True)
class SurfaceResult:
    """One body's surface of a contact, f facets on m nodes of the body's own degree.

    Attributes:
        name: The name of the contact.
        body: The name of the body whose surface it is.
        points: (m, dim) The nodes before deformation (length).
        cells: (f, k) The nodes of each facet, in VTK's order.
        cell_type: VTK's number of the facets' shape.
        displacement: (m, dim) The body's displacements at the nodes (length).
        areas: (f,) The areas of the facets, those of the full ring in a body of revolution.
        covered: (f,) The fraction of each facet that lies opposite the other surface.
        closed: (f,) The fraction of the covered part where the layer is compressed; all of it where it is bonded.
        pressure: (f,) The mean contact pressure of each facet, so that areas @ pressure is the contact force (stress).
        gap, compression: (f,) The means over the covered part (length); not a number where nothing is covered.
        projected_pressure: (m,) The `ContactResult.nodal_pressure` at the nodes (stress); None on the surface that it
            does not belong to.

    Example:
        >>> import contactdd as cd
        >>> x, u = np.array([[0.0, 1.0], [1.0, 1.0]]), np.zeros((2, 2))
        >>> one, gap = np.ones(1), np.array([-0.01])
        >>> surface = cd.SurfaceResult("l-u", "l", x, np.array([[0, 1]]), 3, u, one, one, one, 5 * one, gap, gap)
        >>> surface.status, surface.areas @ surface.pressure
        (array([3]), np.float64(5.0))
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

    def __repr__(self) -> str:
        counts = ", ".join(f"{np.sum(self.status == state)} {name}" for state, name in STATUS.items())
        force = float(self.areas @ self.pressure)
        return f"SurfaceResult({self.name!r} on {self.body!r}, {len(self.cells)} facets: {counts}; force {force:.6g})"

    @property
    def status(self) -> Indices:
        """The state of each facet, (f,), see `STATUS`; fractions up to 1e-6 of a facet are rounding."""
        state = np.where(self.closed >= 1.0 - 1e-6, 3, np.where(self.closed > 1e-6, 2, 1))
        return np.where(self.covered > 1e-6, state, 0)

    @property
    def outlines(self) -> Floats:
        """The corners of the facets in order around each, (f, corners, dim)."""
        corners = {3: 2, 68: 2, 5: 3, 69: 3, 9: 4, 70: 4}[self.cell_type]
        return self.points[self.cells[:, :corners]]

    @property
    def edge(self) -> Floats:
        """The edge of contact in space as line segments, (e, 2, 3) (length): where the gap is zero between facets.

        The gap at a corner is the mean of the facets around it, and is linear in between. The surface's own rim is not
        part of the edge, nor has a bond any. (0, 2, dim) in the plane.
        """
        outlines = self.outlines
        if outlines.shape[2] == 2 or np.all(self.closed == 1.0):
            return np.zeros((0, 2, outlines.shape[2]))
        told = ~np.isnan(self.gap)
        outlines = outlines[told]
        nodes = self.cells[told][:, : outlines.shape[1]]
        count = np.bincount(nodes.ravel(), minlength=len(self.points))
        sums = np.bincount(nodes.ravel(), np.repeat(self.gap[told], nodes.shape[1]), minlength=len(self.points))
        corner = sums[nodes] / count[nodes]
        centre = np.broadcast_to(outlines.mean(axis=1)[:, None], outlines.shape)
        triangles = np.stack([centre, outlines, np.roll(outlines, -1, axis=1)], axis=2).reshape(-1, 3, 3)
        middle = np.broadcast_to(corner.mean(axis=1)[:, None], corner.shape)
        values = np.stack([middle, corner, np.roll(corner, -1, axis=1)], axis=2).reshape(-1, 3)
        return zero_lines(triangles, values)


#: Both sides of a contact, None for that of a body without a mesh.
Surfaces = tuple[SurfaceResult | None, SurfaceResult | None]


def zero_lines(triangles: Floats, values: Floats) -> Floats:
    """The segments (m, 2, dim) where linear functions, given at triangles' corners, are zero: (n, 3) on (n, 3, dim)."""
    negative = values < 0.0
    alone = np.where(negative.sum(axis=1) == 1, np.argmax(negative, axis=1), np.argmin(negative, axis=1))
    cut = np.flatnonzero(negative.any(axis=1) & ~negative.all(axis=1))
    one = alone[cut]
    ends = []
    for other in ((one + 1) % 3, (one + 2) % 3):
        near, far = values[cut, one], values[cut, other]
        part = (near / (near - far))[:, None]
        ends.append((1.0 - part) * triangles[cut, one] + part * triangles[cut, other])
    return np.stack(ends, axis=1)
