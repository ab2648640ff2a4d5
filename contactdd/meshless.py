"""Bodies without a mesh: rigid ones, or elastic ones whose compliance is known otherwise.

All that a contact asks of such a body is where its surface lies opposite given points, and how its own degrees of
freedom move it there. In the paper's words: different methods in different bodies.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from .base.arrays import Floats, Operator
from .base.spectral import SpectralStiffness
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
    #: Whether it stands for the mirror image of what touches it, with half of the layer and of the given gap.
    mirrors: bool = False
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
    def normal_displacement(self, x: Floats, direction: Floats) -> Operator:
        """The operator (n, dofs) from the degrees of freedom to u_n of the surface opposite the points.

        An array or a sparse matrix, which bodies of many degrees of freedom need.

        u_n is counted along this body's outward normal, which is −direction.

        Args:
            x: (n, dim) The points, on the other body's surface (length).
            direction: (n, dim) Unit vectors, out of the other body.
        """

    def displacement_along(self, x: Floats, axis: Floats) -> Operator | None:
        """The operator (n, dofs) to the displacement of the surface opposite points along an axis.

        Bonds that resist sliding need it; None, as by default, if it is not known.

        Args:
            x: (n, dim) The points, on the other body's surface (length).
            axis: (dim,) A unit vector.
        """
        return None

    def contact_points(self) -> tuple[Floats, Floats, Floats] | None:
        """The points of its own at which a contact with another body without a mesh is evaluated.

        Returns:
            Points (n, dim) on its surface, its outward unit normals (n, dim) and the areas (n,) that they stand for,
            that of the full ring of a body of revolution; None if it has none.
        """
        return None

    def contact_facets(self) -> Floats | None:
        """The corners (facets, corners, dim) of what lies between its contact points, in order around each facet.

        For pictures and curves; None if it has no points.
        """
        return None

    def point_stiffnesses(self) -> Floats | None:
        """E/h at its contact points (n,) (stress / length): how stiff a layer is that is as stiff as its surface.

        Hard contacts with other bodies without a mesh need it; None if it is rigid or has no points.
        """
        return None

    @property
    def size(self) -> int:
        """The number of degrees of freedom; by default those of a rigid body."""
        return self.kinematics.rigid_modes(np.zeros((1, 3))).shape[2]

    def stiffness(self) -> Floats | SpectralStiffness:
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
        if self.kinematics.axisymmetric:
            return np.array([0.0, forces[0]])
        return np.array(forces[: self.kinematics.dim])
