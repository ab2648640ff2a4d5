"""A deformed body as plain arrays, for pictures, files and saved solutions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .base.arrays import Floats, Indices


@dataclass(frozen=True)
class SurfaceFit:
    """The shift with which a contact surface of a body is drawn so that it fits its partner's, at the n nodes.

    fade: (n,) 1 on the surface, 0 at the body's depth; normal: (n, dim) outward; of the nearest contact point: shape
    (n,) the prescribed part of the initial gap, measured (n,) that between the meshes, gap (n,) the deformed gap.
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
    """A deformed body as plain arrays, at the n nodes of its own degree.

    Attributes:
        name: The name of the body.
        kinematics: "plane strain", "plane stress", "axisymmetric" or "solid".
        points: (n, dim) The nodes before deformation (length).
        cells: (c, k) The nodes of each cell, in VTK's order.
        cell_type: VTK's number of the cells' shape.
        displacement: (n, dim) The displacements of the nodes (length).
        stress: (n, 6) The stresses in the order xx, yy, zz, yz, xz, xy, the mean of the cells around each node.
        cell_stress: (c, 6) The mean stresses of each cell, over its nodes.
        fits: The shifts with which the contact surfaces are drawn.

    Example:
        >>> import contactdd as cd
        >>> triangle = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
        >>> uniaxial = np.array([[100.0, 0, 0, 0, 0, 0]])
        >>> cells = np.array([[0, 1, 2]])
        >>> body = cd.BodyResult("t", "plane stress", triangle, cells, 5, 0 * triangle, uniaxial.repeat(3, 0), uniaxial)
        >>> body.von_mises
        array([100., 100., 100.])
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

    def __repr__(self) -> str:
        size = f"{len(self.points)} nodes, {len(self.cells)} cells, {self.kinematics}"
        moved, stressed = np.linalg.norm(self.displacement, axis=1).max(), self.von_mises.max()
        return f"BodyResult({self.name!r}, {size}, displacement up to {moved:.6g}, von Mises up to {stressed:.6g})"

    @property
    def dim(self) -> int:
        """The dimension of the coordinates, 2 or 3."""
        return self.points.shape[1]

    @property
    def ring(self) -> bool:
        """Whether the body is a body of revolution, points[:, 0] the radius."""
        return self.kinematics == "axisymmetric"

    @property
    def von_mises(self) -> Floats:
        """The von Mises stress at the nodes, (n,) (stress)."""
        return von_mises(self.stress)

    def drawn(self, scale: float) -> Floats:
        """The positions at which the nodes are drawn, (n, dim) (length).

        Args:
            scale: The factor by which displacements and gaps are enlarged.
        """
        return self.points + scale * self.displacement + sum(fit.shift(scale) for fit in self.fits)


def von_mises(stress: Floats) -> Floats:
    """The von Mises stress of stresses (..., 6) in the order xx, yy, zz, yz, xz, xy."""
    xx, yy, zz, yz, xz, xy = np.moveaxis(stress, -1, 0)
    squares = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2 + 6 * (yz**2 + xz**2 + xy**2)
    return np.sqrt(0.5 * squares)
