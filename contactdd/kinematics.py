"""Kinds of deformation: plane strain, plane stress, a body of revolution or a solid in space.

Each kind gives the free Voigt components of strain, the stiffness reduced to them, their relation to the displacement
(3), and the weight of all integrals. Everything else in the package is the same for all.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import ufl
from numpy.typing import NDArray

from .base.arrays import TINY
from .base.checks import check_choice
from .material import PLACE, VOIGT

STRESSES = ("xx", "yy", "zz", "yz", "xz", "xy")


@dataclass(frozen=True)
class Kinematics:
    """A kind of deformation.

    In a body of revolution x is the radius r, y the axial and z the hoop direction: the stress "zz" is the hoop stress.

    Attributes:
        name: "plane strain", "plane stress", "axisymmetric" or "solid".
        dim: The dimension of the mesh.
        components: The Voigt components of strain that are free.
        plane_stress: Whether the other stresses (not the other strains) vanish.
        axisymmetric: Whether every point of the mesh stands for a ring.
    """

    name: str
    dim: int
    components: tuple[int, ...]
    plane_stress: bool = False
    axisymmetric: bool = False

    def reduce(self, stiffness: NDArray[np.float64]) -> NDArray[np.float64]:
        """The stiffness between the free components, from the full (..., 6, 6) one.

        The other strains vanish, or, in plane stress, they adjust until their stresses do (static condensation).
        """
        kept = list(self.components)
        block = stiffness[..., np.array(kept)[:, None], kept]
        if not self.plane_stress:
            return block
        rest = [i for i in range(6) if i not in kept]
        coupling = stiffness[..., np.array(kept)[:, None], rest]
        held = stiffness[..., np.array(rest)[:, None], rest]
        return block - coupling @ np.linalg.solve(held, np.swapaxes(coupling, -1, -2))

    def tensor(self, stiffness: NDArray[np.float64]) -> NDArray[np.float64]:
        """C_ijmn between the free strains in the coordinates of the mesh, (dim, dim, dim, dim) from a (6, 6) one."""
        places = np.searchsorted(self.components, PLACE[: self.dim, : self.dim])
        return self.reduce(stiffness)[places[:, :, None, None], places]

    def full_stress(self, stiffness: NDArray[np.float64]) -> NDArray[np.float64]:
        """The matrix from the free strains to all six stresses, (..., 6, free components) from (..., 6, 6)."""
        kept = list(self.components)
        if not self.plane_stress:
            return np.ascontiguousarray(stiffness[..., kept])
        matrix = np.zeros((*stiffness.shape[:-1], len(kept)))
        matrix[..., kept, :] = self.reduce(stiffness)
        return matrix

    def full_eigenstress(self, stiffness: NDArray[np.float64]) -> NDArray[np.float64]:
        """The matrix from six eigenstrains to the six stresses that they take away, (..., 6, 6).

        In plane stress the other strains adjust, so that those eigenstrains cause no stress.
        """
        if not self.plane_stress:
            return stiffness
        kept = np.array(self.components)
        matrix = np.zeros_like(stiffness)
        matrix[..., kept[:, None], kept] = self.reduce(stiffness)
        return matrix

    def eigenstress(self, stiffness: NDArray[np.float64]) -> NDArray[np.float64]:
        """The rows of `full_eigenstress` that do work on the free strains, (..., free components, 6)."""
        return np.ascontiguousarray(self.full_eigenstress(stiffness)[..., list(self.components), :])

    def weight(self, x: Any) -> Any:
        """The volume (or area) per unit of the mesh's own at x: 2πr in a body of revolution, else 1.

        x: a UFL coordinate or an array (dim, points). Every integral of the package carries this weight, so that
        energies and forces of a body of revolution are those of the full ring.
        """
        return 2 * np.pi * x[0] if self.axisymmetric else 1

    def resultant(self, forces: NDArray[np.float64]) -> NDArray[np.float64]:
        """The sum (dim,) of nodal forces (nodes, dim); radial forces on a ring sum to zero around it."""
        total = forces.sum(axis=0)
        if self.axisymmetric:
            total[0] = 0.0
        return total

    def strain(self, u: Any) -> Any:
        """The engineering strains of the free components, as a UFL vector (3); u_r/r around a ring."""
        epsilon = ufl.sym(ufl.grad(u))

        def component(i: int, j: int) -> Any:
            if max(i, j) == self.dim:
                return u[0] / ufl.SpatialCoordinate(ufl.domain.extract_unique_domain(u))[0]
            return epsilon[i, j] if i == j else 2 * epsilon[i, j]

        return ufl.as_vector([component(*VOIGT[i]) for i in self.components])

    def rigid_modes(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Displacements of the rigid motions at points x (n, 3), shape (n, dim, modes).

        Translations first, then rotations about the centre of the points, made of the order one by their size. A ring
        can only move along its axis.
        """
        if self.axisymmetric:
            return np.tile([[0.0], [1.0]], (len(x), 1, 1))
        return self.mesh_motions(x)

    def mesh_motions(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Displacements of the rigid motions of the mesh alone at points x (n, 3), shape (n, dim, modes).

        In a body of revolution all but the one along the axis cause strains, but only of the order of u_r/r: within a
        cell they are smooth, and multigrid needs them as nearly free of stress.
        """
        centred = x[:, : self.dim] - x[:, : self.dim].mean(axis=0)
        centred /= max(np.abs(centred).max(initial=0.0), TINY)
        planes = ((1, 0),) if self.dim == 2 else ((2, 1), (0, 2), (1, 0))
        modes = np.zeros((len(x), self.dim, self.dim + len(planes)))
        modes[:, :, : self.dim] = np.eye(self.dim)
        for rotation, (i, j) in enumerate(planes, self.dim):
            modes[:, i, rotation], modes[:, j, rotation] = centred[:, j], -centred[:, i]
        return modes

    def mirrored_modes(self, signs: NDArray[np.float64]) -> NDArray[np.float64]:
        """The signs (modes,) of the modes of a body's copy whose displacement components have the signs `signs`."""
        if self.dim == 2:
            return np.array([*signs, signs[1] * signs[0]])
        return np.array([*signs, signs[2] * signs[1], signs[0] * signs[2], signs[1] * signs[0]])

    def describe(self, mode: NDArray[np.float64]) -> str:
        """A rigid motion, given by its coefficients in `rigid_modes`, in words."""
        if self.axisymmetric:
            return "translation along the axis"
        axes = "xyz"[: self.dim]
        names = [f"translation along {axis}" for axis in axes]
        names += ["rotation in the plane"] if self.dim == 2 else [f"rotation about {axis}" for axis in axes]
        weights = np.abs(np.asarray(mode))
        return " with ".join(name for name, weight in zip(names, weights, strict=True) if weight > 0.1 * weights.max())


KINEMATICS = {
    kind.name: kind
    for kind in (
        Kinematics("plane strain", 2, (0, 1, 5)),
        Kinematics("plane stress", 2, (0, 1, 5), plane_stress=True),
        Kinematics("axisymmetric", 2, (0, 1, 2, 5), axisymmetric=True),
        Kinematics("solid", 3, (0, 1, 2, 3, 4, 5)),
    )
}


def kinematics(name: str | None, dim: int) -> Kinematics:
    """The kinematics of that name; by default plane strain in the plane and a solid in space."""
    if name is None:
        name = "plane strain" if dim == 2 else "solid"
    check_choice("kinematics", name, tuple(KINEMATICS))
    kind = KINEMATICS[name]
    if kind.dim != dim:
        raise ValueError(f"kinematics = {name!r}: it needs a mesh of dimension {kind.dim}, not {dim}")
    return kind
