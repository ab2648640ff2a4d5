"""The size of strains and rotations, and warnings where linear theory is doubtful."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import basix
import numpy as np

from .base import compat
from .base.arrays import Floats
from .base.checks import finite
from .body import Body
from .errors import LargeStrainWarning
from .interface.discretise import Interface
from .material import Isotropic

#: The strain from which on linear theory is doubtful. Green's strain is ε + ½ ∇uᵀ∇u: what linear theory leaves out is
#: about half of ε², relative to ε 5 % at ε = 0.1.
LARGE_STRAIN = 0.1


#: The same of rotations (rad). A rigid turn by ω appears as a strain of 1 − cos ω ≈ ½ ω², 0.5 % at 0.1.
LARGE_ROTATION = 0.1


#: Surfaces that come together by more than this part of the thinner body's thickness are worth a closer look: Hertz's
#: approach of a cylinder's own size 2R at strains of 0.1 (a/R = 0.2) is 0.01.
NOTED_APPROACH = 0.005


#: So are pressures above this part of the material's smallest stiffness.
NOTED_PRESSURE = 0.02


@dataclass(frozen=True)
class StrainSize:
    """The largest strain (principal, in absolute value) and rotation (rad) at the middles of a body's cells."""

    body: str
    strain: float
    rotation: float

    @property
    def doubtful(self) -> bool:
        """Whether linear theory is doubtful."""
        return self.strain > LARGE_STRAIN or self.rotation > LARGE_ROTATION

    def __str__(self) -> str:
        return f"body {self.body!r}: strains up to {self.strain:.2g}, rotations up to {self.rotation:.2g} rad"


def strain_size(body: Body, displacement: Floats) -> StrainSize:
    """The largest strain and rotation of a displacement (dofs,) of a body."""
    strain, rotation = _strains(body, displacement)
    if len(strain) == 0:
        return StrainSize(body.name, 0.0, 0.0)
    largest = np.abs(np.linalg.eigvalsh(strain)).max()
    return StrainSize(body.name, float(largest), float(np.linalg.norm(rotation, axis=(1, 2)).max() / np.sqrt(2.0)))


def _strains(body: Body, displacement: Floats) -> tuple[Floats, Floats]:
    """ε and the skew part of ∇u at the middles of the cells, (cells, 3, 3) each."""
    domain, dim = body.mesh.domain, body.mesh.dim
    geometry = compat.coordinate_map(domain)
    middle = np.asarray(basix.geometry(geometry.cell_type)).mean(axis=0)[None]
    nodes = domain.geometry.x[compat.geometry_dofmap(domain)][:, :, :dim]
    values, *slopes = geometry.tabulate(1, middle)[:, 0, :, 0]
    jacobian = np.einsum("kn,cni->cik", np.array(slopes), nodes)
    own, *derivatives = body.space.element.basix_element.tabulate(1, middle)[:, 0, :, 0]
    u = displacement.reshape(-1, dim)[body.space.dofmap.list]
    gradient = np.einsum("kn,cni->cik", np.array(derivatives), u) @ np.linalg.inv(jacobian)
    strain = np.zeros((len(nodes), 3, 3))
    rotation = np.zeros_like(strain)
    strain[:, :dim, :dim] = 0.5 * (gradient + np.swapaxes(gradient, 1, 2))
    rotation[:, :dim, :dim] = 0.5 * (gradient - np.swapaxes(gradient, 1, 2))
    if body.kinematics.axisymmetric:
        strain[:, 2, 2] = (u[:, :, 0] @ own) / (nodes[:, :, 0] @ values)
    return strain, rotation


def suspicious(interfaces: Sequence[Interface], gaps: Sequence[Floats]) -> bool:
    """Whether strains may be large, judged by the approach and the pressure of the contacts alone.

    A strain far from contacts, such as that of a body bent by its loads, is not found.
    """
    return any(_noted(interface, gap) for interface, gap in zip(interfaces, gaps, strict=True))


def _noted(interface: Interface, gap: Floats) -> bool:
    scales = [_scales(body) for body, _ in interface.contact.sides if body.mesh]
    if not scales:  # what has no mesh tells no strains
        return False
    thickness, stiffness = (min(values) for values in zip(*scales, strict=True))
    if np.abs(interface.gap - gap).max(initial=0.0) > NOTED_APPROACH * thickness:
        return True
    return np.abs(interface.layer.contact_stress(gap)).max(initial=0.0) > NOTED_PRESSURE * stiffness


_known: WeakKeyDictionary[Body, tuple[float, float]] = WeakKeyDictionary()


def _scales(body: Body) -> tuple[float, float]:
    """A body's thickness, the shortest side of its bounding box, and its smallest stiffness; both never change."""
    if body not in _known:
        _known[body] = float(body.mesh.extent.min()), _least_stiffness(body)
    return _known[body]


def _least_stiffness(body: Body) -> float:
    """The smallest eigenvalue of C, that at the middle of a cell where the material varies."""
    material = body.material
    if isinstance(material, Isotropic) and not material.varies:  # 3λ + 2μ, 2μ and, of shear, μ: with no matrix
        E, nu = finite("E", material.E), finite("nu", material.nu)
        return min(E / (1 - 2 * nu), E / (2 * (1 + nu)))
    if not material.varies:
        return float(np.linalg.eigvalsh(material.stiffness()).min())
    stiffness = body.stiffness_at(body.mesh.middles.T, np.arange(body.mesh.cells, dtype=np.int32))
    return float(np.linalg.eigvalsh(stiffness).min())


def warn(sizes: Sequence[StrainSize]) -> None:
    """Warn of the bodies whose strains are not small."""
    large = [str(size) for size in sizes if size.doubtful]
    if large:
        warnings.warn(
            f"linear theory is doubtful here: {'; '.join(large)}; it is good for strains below {LARGE_STRAIN:g} and "
            f"rotations below {LARGE_ROTATION:g} rad, where it errs by 5 % and 0.5 %",
            LargeStrainWarning,
            stacklevel=6,  # `solve` is called through `warn_of_doubts`, the solution and its decorator
        )
