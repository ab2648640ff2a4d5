"""Forces at single nodes of a mesh."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .base.arrays import Floats
from .base.checks import as_floats
from .load import BodyLoad, LoadedBody


@dataclass(frozen=True, eq=False)
class PointForce(BodyLoad):
    """Forces at single nodes of the mesh, as nodal forces of other programs are.

    In theory the displacement under such a force is infinite: spread it over a surface where its place matters.

    Args:
        points: (n, dim) The places of nodes (length).
        forces: (dim,) The force at each of them, or (n, dim) one for each (force, per unit of thickness in the plane,
            on the full ring in a body of revolution).

    Raises:
        TypeError, ValueError: Points or forces are no such arrays.

    Example:
        >>> PointForce([[0.0, 1.0], [2.0, 1.0]], (0.0, -5.0)).forces.shape
        (2, 2)
    """

    points: Floats | Sequence[Sequence[float]]
    forces: Floats | Sequence[float] | Sequence[Sequence[float]]

    def __post_init__(self) -> None:
        points = as_floats("points", self.points, "coordinates of points (n, dim)")
        forces = as_floats("forces", self.forces, "a force (dim,), or one for each point")
        if points.ndim != 2 or len(points) == 0 or not np.all(np.isfinite(points)):
            raise ValueError(f"points = {self.points!r}: expected the finite coordinates of points, (n, dim)")
        if forces.shape not in (points.shape, points.shape[1:]) or not np.all(np.isfinite(forces)):
            raise ValueError(f"forces = {self.forces!r}: expected finite numbers, {points.shape[1:]} or {points.shape}")
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "forces", np.broadcast_to(forces, points.shape))

    def check(self, dim: int) -> None:
        """Refuse points of another number of coordinates than a body of that dimension has.

        Args:
            dim: The number of coordinates.

        Raises:
            ValueError: It does not fit.
        """
        if np.shape(self.points)[1] != dim:
            raise ValueError(f"points: {np.shape(self.points)[1]} coordinates; expected {dim}")

    def vector(self, body: LoadedBody) -> Floats:
        """The load's part of l(v) for all degrees of freedom, (dofs,) (force).

        Args:
            body: The body.
        """
        on, forces = body.elements, np.asarray(self.forces)
        if on.kinematics.axisymmetric and np.any(forces[:, 0]):
            raise ValueError("forces: around a ring radial forces at a point are a line load; expected zero")
        vector = np.zeros((on.dofs // on.dim, on.dim))
        np.add.at(vector, on.nodes_at(np.asarray(self.points)), forces)
        return vector.ravel()
