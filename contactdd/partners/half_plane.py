"""The elastic half-plane."""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.checks import check_choice, positive
from ..material import Isotropic
from ..parameter import Parameter
from . import influence
from .elastic_surface import ElasticSurface, as_nodes, galerkin, hats


class HalfPlane(ElasticSurface):
    """An elastic half-plane, by Flamant's line load; the pressure on it is linear between its nodes.

    In the plane the displacement of a half-plane under a force has no limit far away: it is counted from the surface at
    a distance `reference` from the load, ``u_n = (2/(π E*)) ∫ p ln(reference / |x − s|) ds``. The reference changes how
    far bodies approach, never the pressures under a given force. There the half-plane is held, moved or loaded.

    Nodes should be no closer than the points of a mesh that touches them, whose forces would else be needles.

    Args:
        name: Unique in a scene.
        material: `Isotropic`, of two numbers.
        nodes: (N,) increasing coordinates along the surface wherever there may be contact (length), from `origin`
            along the normal turned clockwise, which is x for a normal (0, 1).
        reference: The distance from a load at which the surface is held (length), at least the nodes' extent.
        origin: (2,) the point of the surface where its coordinate is 0 (length).
        normal: (2,) out of the body.
        displacement: Of what holds it, along the normal (length): a number, a `Parameter`, or None where it is free.
        force: On it along the normal (force per thickness): a number or a `Parameter`.
        kinematics: "plane strain" or "plane stress".

    Raises:
        TypeError, ValueError: An argument is none of these.

    Example:
        >>> HalfPlane("ground", Isotropic(2.1e5, 0.3), np.linspace(-1, 1, 41), reference=100).size
        42
    """

    def __init__(
        self,
        name: str,
        material: Isotropic,
        nodes: ArrayLike,
        reference: float,
        *,
        origin: ArrayLike = (0.0, 0.0),
        normal: ArrayLike = (0.0, 1.0),
        displacement: float | Parameter | None = 0.0,
        force: float | Parameter = 0.0,
        kinematics: str = "plane strain",
    ) -> None:
        check_choice("kinematics", kinematics, ("plane strain", "plane stress"))
        self.nodes = as_nodes("nodes", nodes)
        self.length = float(self.nodes[-1] - self.nodes[0])
        self.reference = positive("reference", reference)
        if self.reference < self.length:
            # The energy of pressures is positive from a quarter of the extent on (the capacity of an interval).
            raise ValueError(f"reference = {reference!r}: expected at least the extent of the nodes, {self.length:g}")
        super().__init__(name, material, kinematics, origin, normal, displacement, force)

    @property
    def places(self) -> Floats:
        return self.origin + self.nodes[:, None] * self.tangent

    @property
    def areas(self) -> Floats:
        return np.asarray(influence.hat_areas(self.nodes))

    @property
    def spacing(self) -> float:
        return float(np.diff(self.nodes).min())

    def flexibility(self) -> Floats:
        def answer(at: Floats) -> Floats:
            return np.asarray(influence.line_load_hats(at, self.nodes, self.reference) / self.modulus, dtype=float)

        return galerkin(answer, self.nodes, self.areas)

    def interpolation(self, x: Floats) -> scipy.sparse.csr_matrix:
        return hats(self.name, (x - self.origin) @ self.tangent, self.nodes)
