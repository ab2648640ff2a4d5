"""Elastic bodies with a flat surface, without a mesh: known by how the surface answers to pressures."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Any

import numpy as np
import scipy
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.checks import as_floats
from ..base.spectral import SpectralStiffness
from ..material import Isotropic
from ..meshless import MeshlessBody
from ..parameter import Parameter, current
from ..shapes.plane import plane_distance
from ..shapes.shape import as_direction, as_point


class ElasticSurface(MeshlessBody):
    """A flat elastic surface whose displacement by pressures is known, at places of its own.

    Its degrees of freedom are the translation of what holds it and, relative to that, u_n at its places, both counted
    along the outward normal (length). A pressure at the places is what their forces are over their areas, so that the
    stiffness between them is the inverse of `flexibility`.

    Attributes:
        origin: (dim,) where the surface's own coordinates are zero (length).
        normal: (dim,) out of the body.
        modulus: E* = E/(1 − ν²), or E in plane stress (stress).
    """

    def __init__(
        self,
        name: str,
        material: Isotropic,
        kinematics: str,
        origin: ArrayLike,
        normal: ArrayLike,
        displacement: float | Parameter | None,
        force: float | Parameter,
    ) -> None:
        super().__init__(name, kinematics)
        self.material, self.modulus = material, _modulus(material, kinematics)
        self.origin = as_point("origin", origin)
        if self.origin.shape != (self.kinematics.dim,):
            raise ValueError(f"origin = {origin!r}: expected {self.kinematics.dim} numbers")
        self.normal = as_direction("normal", normal, self.kinematics.dim)
        self._displacement, self._force = displacement, force
        self._known: Floats | None = None
        self.prescribed(), self.load()  # refuse now what can be none

    @property
    @abstractmethod
    def places(self) -> Floats:
        """Where the surface's own degrees of freedom are, (places, dim)."""

    @property
    @abstractmethod
    def areas(self) -> Floats:
        """The area that each of the places stands for, (places,)."""

    @abstractmethod
    def flexibility(self) -> Floats:
        """u_n into the body at the places by a force of 1 at each, (places, places), symmetric and positive definite
        (length / force)."""

    @abstractmethod
    def interpolation(self, x: Floats) -> scipy.sparse.csr_matrix:
        """The operator from values at the places to the surface opposite points x (n, dim), (n, places).

        Args:
            x: (n, dim) points.

        Raises:
            ValueError: A point lies beyond the places.
        """

    @property
    def size(self) -> int:
        """The translation and one displacement for each place."""
        return 1 + len(self.areas)

    @property
    def tangent(self) -> Floats:
        """The direction of a plane surface's own coordinate: the normal turned clockwise, (2,)."""
        return np.array([self.normal[1], -self.normal[0]])

    def contact_points(self) -> tuple[Floats, Floats, Floats]:
        """The places, for contacts with others that have no mesh: points (n, dim), outward normals (n, dim) and areas
        (n,)."""
        return self.places, np.tile(self.normal, (len(self.areas), 1)), self.areas

    def contact_facets(self) -> Floats:
        return np.stack([self.places[:-1], self.places[1:]], axis=1)

    def point_stiffnesses(self) -> Floats:
        return np.full(len(self.areas), self.modulus / self.spacing)

    @property
    @abstractmethod
    def spacing(self) -> float:
        """The smallest distance of two places (length)."""

    def gap(self, x: Floats, direction: Floats) -> Floats:
        found = plane_distance(x, direction, self.origin, self.normal)
        if not np.all(np.isfinite(found)):
            worst = int(np.argmax(~np.isfinite(found)))
            raise ValueError(
                f"body {self.name!r}: the surface opposite at x = {x[worst]} faces away from it, its normal is "
                f"{direction[worst]}; expected a surface with normals against {self.normal}"
            )
        return found

    def normal_displacement(self, x: Floats, direction: Floats) -> Any:
        # The surface moves along its own normal: of that a contact sees the part against its direction.
        seen = -direction @ self.normal
        rows = scipy.sparse.hstack([scipy.sparse.csr_matrix(np.ones((len(x), 1))), self.interpolation(x)])
        return scipy.sparse.diags(seen) @ rows.tocsr()

    def stiffness(self) -> Floats | SpectralStiffness:
        if self._known is None:
            self._known = _with_translation(self.name, self.flexibility())
        return self._known

    def prescribed(self) -> Floats:
        values = np.full(self.size, np.nan)
        if self._displacement is not None:
            values[0] = _number("displacement", self._displacement)
        return values

    def load(self) -> Floats:
        forces = np.zeros(self.size)
        forces[0] = _number("force", self._force)
        return forces

    def rigid_motions(self) -> tuple[Floats, Floats]:
        motions = self.kinematics.rigid_modes(np.zeros((1, 3)))[0]
        translation = np.zeros((self.size, 1))
        translation[0] = 1.0
        # All modes at their centre: the translations are those that move it.
        return translation, (motions.T @ self.normal)[:, None]

    def resultant(self, forces: Floats) -> Floats:
        total = forces[0] * self.normal
        return total * [0.0, 1.0] if self.kinematics.axisymmetric else total


def _modulus(material: Any, kinematics: str) -> float:
    """E* of a material that is isotropic and the same everywhere."""
    if not isinstance(material, Isotropic) or material.varies:
        raise TypeError(f"material = {material!r}: expected a cd.Isotropic of two numbers")
    E, nu = float(material.E), float(material.nu)  # type: ignore[arg-type]  # it does not vary
    return E if kinematics == "plane stress" else E / (1 - nu**2)


def _number(name: str, value: float | Parameter) -> float:
    number = as_floats(name, current(value), "a finite number")
    if number.ndim or not np.isfinite(number):
        raise ValueError(f"{name} = {value!r}: expected a finite number")
    return float(number)


def _with_translation(name: str, flexibility: Floats) -> Floats:
    """The stiffness between the translation, which alone costs nothing, and the displacements."""
    count = len(flexibility)
    matrix = np.zeros((count + 1, count + 1))
    try:
        factor = scipy.linalg.cho_factor(0.5 * (flexibility + flexibility.T))
    except np.linalg.LinAlgError:
        raise ValueError(f"body {name!r}: its places are too close for its influence functions to tell apart") from None
    inverse = scipy.linalg.cho_solve(factor, np.eye(count))
    matrix[1:, 1:] = 0.5 * (inverse + inverse.T)
    return matrix


def galerkin(
    answer: Callable[[Floats], Floats],
    nodes: Floats,
    areas: Floats,
    weight: Callable[[Floats], Floats] = np.ones_like,
) -> Floats:
    """The flexibility of pressures that are linear between nodes (N,): the mean u_n by each function under each other.

    answer: from points (n,) to u_n there of each function, (n, N); areas: (N,) of the functions; weight: the area for a
    length at points. ∫ ψ_i u_j over both areas, by Gauss points.
    """
    points, weights = np.polynomial.legendre.leggauss(POINTS)
    middles, halves = 0.5 * (nodes[1:] + nodes[:-1]), 0.5 * np.diff(nodes)
    matrix = np.zeros((len(nodes), len(nodes)))
    for point, share in zip(points, weights, strict=True):
        at = middles + point * halves
        here = (share * halves * weight(at))[:, None] * answer(at)
        matrix[:-1] += 0.5 * (1 - point) * here
        matrix[1:] += 0.5 * (1 + point) * here
    return 0.5 * (matrix + matrix.T) / np.outer(areas, areas)


#: Gauss points between two nodes.
POINTS = 6


def hats(name: str, at: Floats, nodes: Floats) -> scipy.sparse.csr_matrix:
    """The linear interpolation between nodes (N,) at coordinates (n,), (n, N); refused beyond them."""
    slack = 1e-10 * (nodes[-1] - nodes[0])
    if at.min() < nodes[0] - slack or at.max() > nodes[-1] + slack:
        raise ValueError(
            f"body {name!r}: a contact reaches from {at.min():g} to {at.max():g} along its surface, its nodes from "
            f"{nodes[0]:g} to {nodes[-1]:g}; expected nodes wherever there may be contact"
        )
    left = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, len(nodes) - 2)
    share = np.clip((at - nodes[left]) / (nodes[left + 1] - nodes[left]), 0.0, 1.0)
    values, columns = (np.column_stack(ends).ravel() for ends in ((1 - share, share), (left, left + 1)))
    return scipy.sparse.csr_matrix((values, columns, 2 * np.arange(len(at) + 1)), shape=(len(at), len(nodes)))


def as_nodes(name: str, values: ArrayLike) -> Floats:
    """`values` as increasing coordinates (N,)."""
    nodes = as_floats(name, values, "increasing numbers")
    if nodes.ndim != 1 or len(nodes) < 2 or not np.all(np.isfinite(nodes)) or not np.all(np.diff(nodes) > 0):
        raise ValueError(f"{name}: expected at least two finite numbers, each larger than the one before")
    return nodes
