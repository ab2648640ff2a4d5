"""A deformed body as plain arrays: what pictures, files and saved solutions hold of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .base.arrays import Floats, Indices


@dataclass(frozen=True)
class SurfaceFit:
    """How a contact surface of a body is drawn so that it fits its partner's, at the n nodes of the body.

    fade: (n,) 1 on the surface, 0 at the body's depth; normal: (n, dim) outward; of the nearest contact point: shape
    (n,) the gap given beside the meshes' own, measured (n,) the meshes' own, gap (n,) the deformed one.
    """

    fade: Floats
    normal: Floats
    shape: Floats
    measured: Floats
    gap: Floats

    def shift(self, scale: float) -> Floats:
        """The displacement (n, dim) to be drawn beside the body's own, times `scale` already.

        A gap that is given, or an interference of the meshes, is a shape that is enlarged as the displacements are: it
        is cut into the body. An open gap between the meshes cannot be enlarged so, it may be as large as the bodies;
        where displacements would close more than there is, and where a layer is compressed, which has no thickness in
        a picture, the surface is moved back until it touches.
        """
        overlap = np.minimum(self.measured, 0.0)
        drawn = self.measured - overlap + scale * (self.gap - self.measured + overlap)
        depth = scale * self.shape + (scale - 1.0) * overlap + np.maximum(-drawn, 0.0)
        return -(self.fade * depth)[:, None] * self.normal


@dataclass(frozen=True)
class BodyResult:
    """A deformed body, n nodes of its own degree.

    Args:
        name: of the body.
        kinematics: "plane strain", "plane stress", "axisymmetric" or "solid".
        points: (n, dim) the nodes.
        cells: (c, k) the nodes of each cell, in VTK's order.
        cell_type: VTK's number of the cells' shape.
        displacement: (n, dim) (length).
        stress: (n, 6) in the order xx, yy, zz, yz, xz, xy, the mean of the cells around each node.
        cell_stress: (c, 6) the mean of each cell's nodes.
        fits: how the contact surfaces are drawn.
    """

    name: str
    kinematics: str
    points: Floats
    cells: Indices
    cell_type: int
    displacement: Floats
    stress: Floats
    cell_stress: Floats
    fits: tuple[SurfaceFit, ...] = ()

    @property
    def dim(self) -> int:
        """2 or 3."""
        return self.points.shape[1]

    @property
    def ring(self) -> bool:
        """Whether it is a body of revolution, points[:, 0] the radius."""
        return self.kinematics == "axisymmetric"

    @property
    def von_mises(self) -> Floats:
        """The von Mises stress at the nodes, (n,)."""
        return von_mises(self.stress)

    def drawn(self, scale: float) -> Floats:
        """Where the nodes are drawn, (n, dim).

        Args:
            scale: how many times displacements and gaps are enlarged.
        """
        return self.points + scale * self.displacement + sum(fit.shift(scale) for fit in self.fits)


def von_mises(stress: Floats) -> Floats:
    """The von Mises stress of stresses (..., 6) in the order xx, yy, zz, yz, xz, xy."""
    xx, yy, zz, yz, xz, xy = np.moveaxis(stress, -1, 0)
    squares = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2 + 6 * (yz**2 + xz**2 + xy**2)
    return np.sqrt(0.5 * squares)
