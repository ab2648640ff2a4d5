"""Newton's system (17) in the contact forces, of surfaces that are known by how they answer to these."""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats
from ..local.problem import LocalProblem
from ..local.spectral import SpectralProblem
from ..system.ensemble import Ensemble
from ..system.state import Phi
from .krylov import Krylov, deflated_conjugate_gradients, pseudo_inverse

#: Reduction of the forces' error between two changes of the set of points that press.
ROUGHLY = 1e-2


def surface_of(ensemble: Ensemble) -> int | None:
    """The body at whose own places the only contact of a scene is, if all bodies are surfaces on grids or rigid.

    Of two such bodies the softer one; None if it is no such scene.
    """
    problems = ensemble.problems
    known = all(isinstance(problem, SpectralProblem) or _rigid(problem) for problem in problems)
    if not known or len(ensemble.interfaces) != 1:
        return None
    own = {i: p.stiffness.largest for i, p in enumerate(problems) if isinstance(p, SpectralProblem) and _sees_itself(p)}
    return min(own, key=own.__getitem__, default=None)


def _rigid(problem: LocalProblem) -> bool:
    """Whether a body has rigid motions only, which nothing but contacts resists."""
    return problem.size == problem.rigid.count and not np.any(problem.stiffness)


def _sees_itself(problem: SpectralProblem) -> bool:
    """Whether the contact's points are the surface's own places, in order."""
    first, shape = int(problem.stiffness.translation), problem.traces[0].trace.shape
    # The weights between places are not negative and sum to 1.
    return shape[0] == shape[1] - first and np.allclose(problem.traces[0].trace.diagonal(first), 1.0)


class Pressures:
    """The contact's forces t, and from them the correction δ = K⁺ (r − Nᵀ t) + Z q: a `step.Step`.

        (Φ⁻¹ + N K⁺ Nᵀ) t − N Z q = N K⁺ r,    Zᵀ Nᵀ t = Zᵀ r,    where Φ > 0,

    with the bodies' stiffness K, their rigid motions Z, N from the unknowns to the approach and Φ = φ times the areas.
    K⁺ is as cheap as K, and its system stays well conditioned where K + Nᵀ Φ N does not: under layers that are stiff,
    and closed on a part of the surface. The preconditioner is the inverse for the surface under an even layer of the
    mean stiffness, scaled down where the layer is softer than that.
    """

    def __init__(self, ensemble: Ensemble, surface: int, note: str = "") -> None:
        self._ensemble = ensemble
        stiffness = cast("SpectralProblem", ensemble.problems[surface]).stiffness
        self._surface = stiffness.without_translation()
        part = ensemble.parts[surface]
        self._places = slice(part.start + int(stiffness.translation), part.stop)
        self._onto_unknowns = ensemble.normal_approach.T
        self._motions: Floats = ensemble.rigid.displacements(np.eye(ensemble.rigid.count))
        self._moves = ensemble.normal_approach @ self._motions
        self.body_solves, self.note = 0, note

    def correct(self, phi: Phi, residual: Floats, scale: float) -> Floats:
        self._ensemble.rigid.fixing_dofs(phi, residual, scale)  # only its check
        stiff = self._ensemble.weights * self._ensemble.at_all_points(phi)
        soft = np.divide(1.0, stiff, out=np.zeros_like(stiff), where=stiff > 0.0)
        return self._solution(stiff > 0.0, soft, np.zeros_like(stiff), residual, Krylov.FORCING)[0]

    def held(self, pressing: NDArray[np.bool_], gaps: Floats, residual: Floats, scale: float) -> tuple[Floats, Floats]:
        """The correction that closes the gaps at a set of points, and that of the forces there (points,).

        Raises LooseBodyError where the set does not hold a body.
        """
        rigid = self._ensemble.rigid
        rigid.fixing_dofs({0: np.where(pressing, rigid.stiffness_scale, 0.0)}, residual, scale)
        return self._solution(pressing, np.zeros_like(gaps), pressing * gaps, residual, ROUGHLY)

    def _solution(
        self, closed: NDArray[np.bool_], soft: Floats, gaps: Floats, residual: Floats, reduction: float
    ) -> tuple[Floats, Floats]:
        """δ and t, which is zero where the contact is not closed, with N δ = gaps + t / Φ where it is.

        soft: Φ⁻¹, 0 where nothing gives way; gaps: zero where open; reduction: of the error of t.
        """
        rigid, approach = self._ensemble.rigid, self._ensemble.normal_approach
        elastic = self._flexed(residual)
        if not closed.any():
            return elastic, gaps
        even = self._even(soft[closed])
        scale = closed * np.sqrt(np.minimum((even + self._least) / (soft + self._least), 1.0))

        def apply(forces: Floats) -> Floats:
            return soft * forces + closed * (approach @ self._flexed(self._onto_unknowns @ forces))

        def under_even(lengths: Floats) -> Floats:
            return scale * self._surface.in_series(scale * lengths, even)

        # Forces that balance those on the rigid motions; of others the part that does work on these is left out.
        moves = closed[:, None] * self._moves
        answer = np.array([under_even(each) for each in moves.T]).reshape(moves.shape[::-1]).T
        inverse = pseudo_inverse(moves.T @ answer, rigid.stiffness_scale)

        def precondition(lengths: Floats) -> Floats:
            forces = under_even(lengths)
            return forces - answer @ (inverse @ (moves.T @ forces))

        start = answer @ (inverse @ (self._motions.T @ residual))
        rhs = closed * (approach @ elastic) - gaps
        forces = deflated_conjugate_gradients(apply, precondition, _itself, rhs, start, reduction)
        found = elastic - self._flexed(self._onto_unknowns @ forces)
        left = closed * (approach @ found) - gaps - soft * forces
        found -= self._motions @ (inverse @ (answer.T @ left))
        # What is left of N u = gaps + soft t: as a force on a stiff layer it would be large, as a displacement not.
        left = closed * (approach @ found) - gaps - soft * forces
        found[self._places] -= left / (1.0 + soft * self._surface.largest)
        return found, forces

    @property
    def _least(self) -> float:
        """The compliance of the surface's shortest waves."""
        return 1.0 / self._surface.largest

    def _even(self, soft: Floats) -> float:
        """The compliance of an even layer that under the shortest waves is as stiff as these are in the mean."""
        return max(float(1.0 / np.mean(1.0 / (soft + self._least))) - self._least, 0.0)

    def _flexed(self, forces: Floats) -> Floats:
        """K⁺ times forces (unknowns,): how surfaces answer to them; rigid bodies, and what holds a surface, do not."""
        parts = list(zip(self._ensemble.problems, self._ensemble.split(forces), strict=True))
        self.body_solves += len(parts)
        return np.concatenate([p.stiffness.flexed(f) if isinstance(p, SpectralProblem) else 0.0 * f for p, f in parts])


def _itself(vector: Floats) -> Floats:
    return vector
