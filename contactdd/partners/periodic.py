"""Elastic surfaces that repeat themselves: the half-plane and strips on a rigid base, by Fourier series."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np
import scipy
from numpy.typing import ArrayLike

from ..base.arrays import Floats
from ..base.checks import as_bool, as_count, check_choice, positive
from ..material import Isotropic
from ..parameter import Parameter
from . import influence
from .elastic_surface import ElasticSurface, hats


class PeriodicSurface(ElasticSurface):
    """A plane elastic surface whose pressure repeats after a period, at equidistant nodes.

    A pressure cos kx moves it by c(k) cos kx / E*; between the nodes it is linear for contacts with meshes. Contacts
    with bodies without a mesh are looked at between `origin` and one period further: there such a partner has to be.

    Attributes:
        period: (length).
        nodes: (N,) coordinates from 0 up to one step before the period (length).
    """

    def __init__(
        self,
        name: str,
        material: Isotropic,
        period: float,
        count: int,
        *,
        origin: ArrayLike = (0.0, 0.0),
        normal: ArrayLike = (0.0, 1.0),
        displacement: float | Parameter | None = 0.0,
        force: float | Parameter = 0.0,
        kinematics: str = "plane strain",
    ) -> None:
        check_choice("kinematics", kinematics, ("plane strain", "plane stress"))
        self.period = self.length = positive("period", period)
        self.nodes = self.period / as_count("count", count) * np.arange(count)
        super().__init__(name, material, kinematics, origin, normal, displacement, force)

    @abstractmethod
    def compliance(self, k: Floats) -> Floats:
        """c(k): u_n of a pressure cos kx for a modulus E* = 1 (length).

        Args:
            k: Wave numbers >= 0 (1 / length).
        """

    @property
    def places(self) -> Floats:
        return self.origin + self.nodes[:, None] * self.tangent

    @property
    def areas(self) -> Floats:
        return np.full(len(self.nodes), self.period / len(self.nodes))

    @property
    def spacing(self) -> float:
        return self.period / len(self.nodes)

    def flexibility(self) -> Floats:
        count = len(self.nodes)
        k = np.asarray(2 * np.pi / self.period * np.arange(count // 2 + 1), dtype=float)
        column = np.fft.irfft(self.compliance(k), count) / (self.modulus * self.period / count)
        return np.asarray(scipy.linalg.circulant(column))

    def interpolation(self, x: Floats) -> scipy.sparse.csr_matrix:
        count = len(self.nodes)
        at = np.mod((x - self.origin) @ self.tangent, self.period)
        wrapped = hats(self.name, at, np.append(self.nodes, self.period)).tocoo()
        entries = (wrapped.data, (wrapped.row, wrapped.col % count))
        return scipy.sparse.csr_matrix(entries, shape=(len(x), count))


class PeriodicHalfPlane(PeriodicSurface):
    """An elastic half-plane under pressures that repeat themselves, by Fourier series: c(k) = 2/k.

    A uniform pressure moves its surface without limit: the mean displacement is counted from points at a depth
    `reference`, with the strains along the surface free, c(0) = reference. The reference changes how far bodies
    approach, never the pressures under a given force. There the half-plane is held, moved or loaded.

    Args:
        name: Unique in a scene.
        material: `Isotropic`, of two numbers.
        period: Of all pressures (length).
        count: The number of nodes on it.
        reference: The depth from which mean displacements are counted, by default the period (length).
        origin: (2,) the first node (length).
        normal: (2,) out of the body; the nodes follow each other along it turned clockwise, x for (0, 1).
        displacement: Of what holds it, along the normal (length): a number, a `Parameter`, or None where it is free.
        force: On one period along the normal (force per thickness): a number or a `Parameter`.
        kinematics: "plane strain" or "plane stress".

    Raises:
        TypeError, ValueError: An argument is none of these.

    Example:
        >>> ground = PeriodicHalfPlane("ground", Isotropic(91.0, 0.3), period=2 * np.pi, count=16)
        >>> ground.compliance(np.array([1.0, 2.0]))
        array([2., 1.])
    """

    def __init__(
        self,
        name: str,
        material: Isotropic,
        period: float,
        count: int,
        *,
        reference: float | None = None,
        origin: ArrayLike = (0.0, 0.0),
        normal: ArrayLike = (0.0, 1.0),
        displacement: float | Parameter | None = 0.0,
        force: float | Parameter = 0.0,
        kinematics: str = "plane strain",
    ) -> None:
        self.reference = positive("reference", period if reference is None else reference)
        super().__init__(
            name,
            material,
            period,
            count,
            origin=origin,
            normal=normal,
            displacement=displacement,
            force=force,
            kinematics=kinematics,
        )

    def compliance(self, k: Floats) -> Floats:
        return np.where(k > 0, influence.half_plane_wave(np.where(k > 0, k, 1.0)), self.reference)


class ElasticStrip(PeriodicSurface):
    """An elastic strip on a rigid base, by its Fourier kernel, under pressures that repeat themselves.

    A period of ten thicknesses more than the contact is as good as none: its answer dies away in a few. The base is
    held, moved or loaded.

    Args:
        name: Unique in a scene.
        material: `Isotropic`, of two numbers.
        thickness: Of the strip (length).
        period: Of all pressures (length).
        count: The number of nodes on it.
        bonded: Whether it sticks to the base; else it slides on it without friction, and a uniform pressure finds its
            strains along the base free.
        origin: (2,) the first node (length).
        normal: (2,) out of the body; the nodes follow each other along it turned clockwise, x for (0, 1).
        displacement: Of the base, along the normal (length): a number, a `Parameter`, or None where it is free.
        force: On one period of the base along the normal (force per thickness): a number or a `Parameter`.
        kinematics: "plane strain" or "plane stress".

    Raises:
        TypeError, ValueError: An argument is none of these.

    Example:
        >>> strip = ElasticStrip("strip", Isotropic(91.0, 0.3), thickness=1, period=20, count=16, bonded=False)
        >>> print(strip.compliance(np.array([0.0, 10.0])).round(6))
        [1.  0.2]
    """

    def __init__(
        self,
        name: str,
        material: Isotropic,
        thickness: float,
        period: float,
        count: int,
        *,
        bonded: bool = True,
        origin: ArrayLike = (0.0, 0.0),
        normal: ArrayLike = (0.0, 1.0),
        displacement: float | Parameter | None = 0.0,
        force: float | Parameter = 0.0,
        kinematics: str = "plane strain",
    ) -> None:
        self.thickness, self.bonded = positive("thickness", thickness), as_bool("bonded", bonded)
        super().__init__(
            name,
            material,
            period,
            count,
            origin=origin,
            normal=normal,
            displacement=displacement,
            force=force,
            kinematics=kinematics,
        )

    def compliance(self, k: Floats) -> Floats:
        if not self.bonded:
            return influence.sliding_strip_wave(k, self.thickness)
        nu = float(self.material.nu)  # type: ignore[arg-type]  # it does not vary
        kappa = (3 - nu) / (1 + nu) if self.kinematics.plane_stress else 3 - 4 * nu
        return influence.bonded_strip_wave(k, self.thickness, kappa)
