"""A contact made so that its pressure is known: two blocks, any layer law, in the plane and in space.

The contact is at s = 0, t are the coordinates along it. With functions b(t) of each body and a pressure P(t), let

    u_t = −s ∇b,   u_n = b − P s / (λ + 2μ)

in both blocks, the lower (s < 0) and the upper one (s > 0). On s = 0 that gives no shear stress and the normal stress
−P in both. Let W be the inverse law: the compression of the layer under a pressure. With the gap

    d = b_lower − b_upper − W(P)   and more where P = 0,

the body forces −div σ(u) and the displacements u prescribed on all other faces, this is the solution. The pressure is
P = p₀ [1 − |t − t₀|² / c²]⁺ᵐ.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import ufl
from numpy.typing import NDArray

import contactdd as cd

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Block:
    """One of the two bodies: its constants and the amplitude of b."""

    E: float
    nu: float
    amplitude: float

    @property
    def mu(self) -> float:
        return self.E / (2 * (1 + self.nu))

    @property
    def lam(self) -> float:
        return self.E * self.nu / ((1 + self.nu) * (1 - 2 * self.nu))


@dataclass(frozen=True)
class Manufactured:
    """The problem on [0, 2] × [0, 2], in space on [0, 2]² × [0, 2], contact in the middle of the height.

    dim: 2 or 3; layer: the law; half_width: c (length); exponent: m, at the edge of contact m − 1 derivatives of P are
    zero; peak: p₀ (stress). With c = 0.5 the edge lies on nodes of meshes of 2n cells, n even.
    """

    dim: int = 2
    layer: cd.Layer = field(default_factory=lambda: cd.PowerLayer(B=4e-6, a=0.8))
    half_width: float = 0.5
    exponent: int = 2
    peak: float = 100.0
    wave: tuple[float, float] = (1.3, 0.7)
    lower: Block = Block(2.1e5, 0.3, 2e-4)
    upper: Block = Block(0.7e5, 0.2, -3e-4)

    def distance(self, t: Any) -> Any:
        """|t − t₀|² / c²."""
        return sum((t[i] - 1.0) ** 2 for i in range(self.dim - 1)) / self.half_width**2

    def pressure(self, x: Floats) -> Floats:
        """P at points x (dim, n)."""
        return self.peak * np.maximum(1 - self.distance(x), 0.0) ** self.exponent

    def gap(self, x: Floats) -> Floats:
        """d at points x (dim, n)."""
        beyond = 1e-4 * np.maximum(self.distance(x) - 1, 0.0) ** 2
        compression = self.layer.compression(-self.pressure(x))
        return self._b(self.lower, x, np) - self._b(self.upper, x, np) + compression + beyond

    def displacement(self, block: Block, x: Any, lib: Any = np) -> list[Any]:
        """The components of u at x; lib: numpy or ufl, whose functions are taken."""
        n = self.dim - 1
        s, larger = x[n] - 1.0, np.maximum if lib is np else ufl.max_value
        pressure = self.peak * larger(1 - self.distance(x), 0.0) ** self.exponent
        normal = self._b(block, x, lib) - pressure * s / (block.lam + 2 * block.mu)
        return [-s * slope for slope in self._slopes(block, x, lib)] + [normal]

    def _b(self, block: Block, t: Any, lib: Any) -> Any:
        k, q = self.wave
        return block.amplitude * lib.sin(k * t[0]) * (lib.cos(q * t[1]) if self.dim == 3 else 1.0)

    def _slopes(self, block: Block, t: Any, lib: Any) -> list[Any]:
        k, q = self.wave
        if self.dim == 2:
            return [block.amplitude * k * lib.cos(k * t[0])]
        return [
            block.amplitude * k * lib.cos(k * t[0]) * lib.cos(q * t[1]),
            -block.amplitude * q * lib.sin(k * t[0]) * lib.sin(q * t[1]),
        ]

    def body(self, name: str, cells: int, degree: int, shape: str | None = None) -> cd.Body:
        """The lower or the upper block, `cells` along its height and twice as many along its length."""
        block, floor = (self.lower, 0.0) if name == "lower" else (self.upper, 1.0)
        if self.dim == 2:
            mesh = cd.rectangle((0, floor), (2, floor + 1), (2 * cells, cells), shape=shape or "triangle")
        else:
            corners = (0, 0, floor), (2, 2, floor + 1)
            mesh = cd.box(*corners, (2 * cells, 2 * cells, cells), shape=shape or "tetrahedron")
        sides = ["left", "right", "front", "back"][: 2 * (self.dim - 1)]
        exact = [_component(self, block, axis) for axis in range(self.dim)]
        outer = "bottom" if name == "lower" else "top"
        supports = [cd.Displacement(side, exact) for side in (*sides, outer)]
        material = cd.Isotropic(E=block.E, nu=block.nu)
        force = cd.BodyForce(self._force(block, mesh))
        return cd.Body(name, mesh, material, supports=supports, loads=[force], degree=degree)

    def _force(self, block: Block, mesh: cd.Mesh) -> Any:
        u = ufl.as_vector(self.displacement(block, ufl.SpatialCoordinate(mesh.domain), ufl))
        strain = ufl.sym(ufl.grad(u))
        return -ufl.div(block.lam * ufl.tr(strain) * ufl.Identity(self.dim) + 2 * block.mu * strain)

    def scene(self, cells: int, degree: int, *, unlike: bool = True, shape: str | None = None) -> cd.Scene:
        """The scene; unlike: whether the upper block has one and a half times as many cells."""
        lower = self.body("lower", cells, degree, shape)
        upper = self.body("upper", int(1.5 * cells) if unlike else cells, degree, shape)
        return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), self.layer, gap=self.gap)])

    def error(self, solution: cd.Solution, degree: int | None = None) -> float:
        """The relative L² error of p at the contact's points, or at Gauss points of another degree."""
        result = solution.contact(degree=degree)
        exact = self.pressure(result.x.T)
        return float(np.sqrt(result.weights @ (result.pressure - exact) ** 2 / (result.weights @ exact**2)))


def _component(problem: Manufactured, block: Block, axis: int) -> Callable[[Floats], Floats]:
    return lambda x: problem.displacement(block, x)[axis] + 0 * x[0]
