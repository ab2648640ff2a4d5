"""Bodies without a mesh: rigid ones, or elastic ones whose compliance is known otherwise.

All that a contact asks of such a body is where its surface lies opposite given points, and how its own degrees of
freedom move it there. In the paper's words: different methods in different bodies.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from .base.arrays import Floats
from .kinematics import kinematics as find_kinematics


class MeshlessBody(ABC):
    """A body without a mesh, seen from the points of its contacts.

    A subclass says where its surface is (`gap`), how its degrees of freedom displace it (`normal_displacement`) and, if
    it is not rigid, how they resist (`stiffness`). By default they are the motions of a rigid body in the order of
    `Kinematics.rigid_modes`: translations, then rotations.

    Args:
        name: The name, unique in a scene.
        kinematics: As of `Body`: "plane strain", "plane stress", "axisymmetric" or "solid".

    Attributes:
        length: A size (length) with which displacements are compared; 0 leaves that to the other bodies.

    Example:
        >>> class Floor(MeshlessBody):  # rigid, its surface is y = 0
        ...     def gap(self, x, direction):
        ...         return x[:, 1] / -direction[:, 1]
        ...
        ...     def normal_displacement(self, x, direction):  # two translations and a rotation about the origin
        ...         return -np.column_stack([direction, x[:, 0] * direction[:, 1] - x[:, 1] * direction[:, 0]])
        ...
        ...     def prescribed(self):
        ...         return np.zeros(self.size)
        >>> Floor("floor").gap(np.array([[3.0, 0.5]]), np.array([[0.0, -1.0]]))
        array([0.5])
    """

    #: What tells a body without a mesh from others.
    mesh = None
    #: A local solver of its own, a function of a `LocalTask`; None for dense algebra on `stiffness`.
    local_solver = None
    length: float = 0.0

    def __init__(self, name: str, kinematics: str = "plane strain") -> None:
        if not isinstance(name, str) or not name:
            raise TypeError(f"name = {name!r}: expected a text")
        self.name = name
        self.kinematics = find_kinematics(kinematics, 3 if kinematics == "solid" else 2)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.name!r}, {self.kinematics.name})"

    @abstractmethod
    def gap(self, x: Floats, direction: Floats) -> Floats:
        """The distances (n,) from points along directions to this body's surface (length), negative inside the body.

        Args:
            x: (n, dim) The points, on the other body's surface (length).
            direction: (n, dim) Unit vectors, out of the other body.
        """

    @abstractmethod
    def normal_displacement(self, x: Floats, direction: Floats) -> Floats:
        """The operator (n, dofs) from the degrees of freedom to u_n of the surface opposite the points.

        u_n is counted along this body's outward normal, which is −direction.

        Args:
            x: (n, dim) The points, on the other body's surface (length).
            direction: (n, dim) Unit vectors, out of the other body.
        """

    @property
    def size(self) -> int:
        """The number of degrees of freedom; by default those of a rigid body."""
        return self.kinematics.rigid_modes(np.zeros((1, 3))).shape[2]

    def stiffness(self) -> Floats:
        """The stiffness (dofs, dofs) between the degrees of freedom; zero of a rigid body."""
        return np.zeros((self.size, self.size))

    def load(self) -> Floats:
        """The forces (dofs,) on the degrees of freedom, per unit of thickness in the plane; read before every solve."""
        return np.zeros(self.size)

    def prescribed(self) -> Floats:
        """The prescribed values (dofs,) of the degrees of freedom, NaN where free; read before every solve."""
        return np.full(self.size, np.nan)

    def rigid_motions(self) -> tuple[Floats, Floats]:
        """The rigid motions that cost no energy.

        Returns:
            Their degrees of freedom (dofs, motions), and their coefficients (all motions, motions) in
            `Kinematics.rigid_modes`.
        """
        return np.eye(self.size), np.eye(self.size)

    def resultant(self, forces: Floats) -> Floats:
        """The total force (dim,) of forces.

        Args:
            forces: (dofs,) The forces on the degrees of freedom.
        """
        return np.array(forces[: self.kinematics.dim])
