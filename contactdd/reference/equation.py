"""The contact of two elastic layers whose faces bulge in proportion to each cosine of the pressure: Newton's method."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dctn, idctn
from scipy.optimize import brentq
from scipy.sparse.linalg import LinearOperator, cg

from ..base.arrays import Floats
from ..layer import Layer


@dataclass(frozen=True)
class ContactEquation:
    """w = c - d - K s with p(w) = q + s, in the midpoints of a uniform grid along a line or over a rectangle.

    w is the layer's compression counted positive, s the pressure's deviation from its mean q, and K s the bulge of both
    faces (compliance: of each cosine); unknown are s and the number c. Equivalently, the convex energy
    ½⟨s, K s⟩ + ⟨∫ p dw⟩ - q c is least.
    """

    layer: Layer
    q: float
    d: Floats
    compliance: Floats

    def solve(self, most_steps: int = 100) -> tuple[Floats, float]:
        """s and c, by a semismooth Newton method with a line search on the energy."""
        s, c = np.zeros_like(self.d), self._closing_of_rigid_bodies()
        previous = math.inf
        for _ in range(most_steps):
            w = self.compression(s, c)
            error = float(np.sqrt(np.mean(self._imbalance(s, w) ** 2))) / self.q
            # Where the layer is hard, rounding of w ends the progress before 1e-12.
            if error < 1e-12 or (error < 1e-7 and error > previous / 2):
                return s, c
            previous = error
            ds, dc = self._newton_direction(s, w)
            step = self._step_length(s, w, ds, dc - self._bulge(ds))
            s, c = s + step * ds, c + step * dc
        raise RuntimeError(f"the equation of the contact didn't converge: relative residual {error:g}, expected < 1e-7")

    def compression(self, s: Floats, c: float) -> Floats:
        return c - self.d - self._bulge(s)

    def _closing_of_rigid_bodies(self) -> float:
        upper = self.d.max() - float(self.layer.compression(-self.q))
        return brentq(lambda c: self._pressure(c - self.d).mean() - self.q, 0, upper, xtol=1e-15 * upper)

    def _pressure(self, w: Floats) -> Floats:
        return -self.layer.contact_stress(-w)

    def _bulge(self, s: Floats) -> Floats:
        return _apply_in_cosines(self.compliance, s)

    def _imbalance(self, s: Floats, w: Floats) -> Floats:
        return self._pressure(w) - self.q - s

    def _newton_direction(self, s: Floats, w: Floats) -> tuple[Floats, float]:
        """ds and dc. The pressure changes by dp = p'(w) dw on the contact only, and ds = dp + imbalance."""
        contact, imbalance = w > 0, self._imbalance(s, w)
        from_imbalance = self._pressure_change(-self._bulge(imbalance), w, contact)
        from_closing = self._pressure_change(np.ones_like(w), w, contact)
        dc = -(imbalance.sum() + from_imbalance.sum()) / from_closing.sum()
        return from_imbalance + dc * from_closing + imbalance, dc

    def _pressure_change(self, closing: Floats, w: Floats, contact: NDArray[np.bool_]) -> Floats:
        """The dp, 0 off the contact, with dp/p'(w) + K dp = closing on it; conjugate gradients."""
        # A circulant preconditioner, with the layer's typical softness; where the layer is much softer still
        # (at the edge, a < 1) its own stiffness takes over.
        softness = 1 / self.layer.contact_derivative(-w[contact])
        typical = np.median(softness)
        damping = np.sqrt(typical / np.maximum(softness, typical))
        dp = np.zeros_like(w)

        def in_cosines(factors: Floats, values: Floats) -> Floats:
            dp[contact] = values
            return _apply_in_cosines(factors, dp)[contact]

        def operator(values: Floats) -> Floats:
            return softness * values + in_cosines(self.compliance, values)

        def preconditioner(values: Floats) -> Floats:
            return damping * in_cosines(1 / (self.compliance + typical), damping * values)

        shape = (softness.size, softness.size)
        dp[contact] = cg(
            LinearOperator(shape, operator, dtype=float),
            closing[contact],
            rtol=1e-12,
            maxiter=1000,
            M=LinearOperator(shape, preconditioner, dtype=float),
        )[0]
        return dp

    def _step_length(self, s: Floats, w: Floats, ds: Floats, dw: Floats) -> float:
        """1, or the zero in (0, 1) of the energy's slope along the direction if a full step overshoots."""

        def slope(t: float) -> float:
            return float(np.mean(self._imbalance(s + t * ds, w + t * dw) * dw))

        if slope(1.0) <= 0.5 * abs(slope(0.0)):
            return 1.0
        return brentq(slope, 0, 1, xtol=1e-9, rtol=1e-2)


def _apply_in_cosines(factors: Floats, values: Floats) -> Floats:
    return np.asarray(idctn(factors * dctn(values, norm="ortho"), norm="ortho"))
