"""Rigid motions: which of them the supports leave free, whether the contact resists them, and what follows.

A motion that nothing resists is harmless where the forces do no work on it (a block may slide without friction on
another): the linear problem is then solved with that motion held. Where they do work, nothing holds the body.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from numpy.typing import NDArray

from ..base.arrays import Floats
from ..errors import LooseBodyError
from ..kinematics import Kinematics
from .space import AdmissibleSpace

if TYPE_CHECKING:
    from ..interface.surface import Gather


@dataclass(frozen=True)
class Resistance:
    """What an interface adds to the stiffness of the rigid motions: Σ_p φ_p m_p m_pᵀ.

    rows: (points, motions) √weight u_n of each motion; transfer: from φ at the interface to these points, None where
    they are its own.
    """

    interface: int
    rows: Floats
    transfer: Gather | scipy.sparse.csr_matrix | None = None

    def root(self, phi: Mapping[int, Floats]) -> Floats:
        """R of the stiffness RᵀR, (points, motions)."""
        values = phi[self.interface] if self.transfer is None else self.transfer @ phi[self.interface]
        return np.sqrt(values)[:, None] * self.rows


@dataclass(frozen=True)
class Owner:
    """Whose motions a group of columns are: the body's name, its kinematics and the motions' coefficients."""

    body: str
    kinematics: Kinematics
    coefficients: Floats


@dataclass(frozen=True)
class RigidMotions:
    """The rigid motions that the supports of one body, or of several together, leave free.

    modes: (unknowns, motions), orthonormal within each body; springs: (unknowns, motions) the forces with which springs
    answer them (a rigid motion meets no other elastic force); contacts: what the interfaces add; owners: whose motions
    they are; stiffness_scale: the largest stiffness of the unknowns.
    """

    modes: Floats
    springs: Floats
    contacts: Sequence[Resistance]
    owners: Sequence[Owner]
    stiffness_scale: float

    @cached_property
    def elastic(self) -> Floats:
        """The stiffness that springs give the motions, (motions, motions)."""
        elastic = self.modes.T @ self.springs
        return 0.5 * (elastic + elastic.T)

    @cached_property
    def floating(self) -> bool:
        """Whether there are free motions and no spring resists any of them."""
        return self.modes.shape[1] > 0 and not np.any(self.springs)

    def free(self, phi: Mapping[int, Floats]) -> Floats:
        """The motions that neither springs nor the coefficient φ resist, as columns of coefficients (motions, free)."""
        count = self.modes.shape[1]
        if count == 0:
            return np.zeros((0, 0))
        roots = [contact.root(phi) for contact in self.contacts]
        held = sum((root.T @ root for root in roots), self._steadied)
        # Below this a motion's resistance is lost in the rounding of the stiffness, or of a layer stiffer than that.
        limit = 1e-14 * max(self.stiffness_scale, float(np.abs(held).max()))
        # Mostly the contacts hold all that they ever could.
        if _smallest(held) > limit:
            return self._idle
        # The roots give the free motions; their squares would mix in held ones by the rounding of the stiffest layer.
        springs, directions = np.linalg.eigh(self.elastic)
        roots.append(np.sqrt(np.maximum(springs, 0.0))[:, None] * directions.T)
        _, singular, motions = np.linalg.svd(np.linalg.qr(np.vstack(roots), mode="r"))
        return motions[singular**2 <= limit].T

    @cached_property
    def _idle(self) -> Floats:
        """The neutral motions, (motions, idle); none if springs that are soft enough for these hold any of them."""
        answer = self.neutral.T @ self.elastic @ self.neutral
        return self.neutral[:, : 0 if np.any(np.abs(answer) > 1e-14 * self.stiffness_scale) else None]

    @cached_property
    def _steadied(self) -> Floats:
        """What springs give the motions, with the idle ones held."""
        return self.elastic + self.stiffness_scale * (self._idle @ self._idle.T)

    @cached_property
    def neutral(self) -> Floats:
        """The motions that change no gap and meet no spring, open or closed, (motions, neutral): nothing depends on
        them."""
        springs = np.linalg.norm(self.springs, axis=0) / max(self.stiffness_scale, np.finfo(float).tiny)
        rows = np.vstack([np.diag(springs)] + [contact.rows for contact in self.contacts])
        _, singular, motions = np.linalg.svd(rows, full_matrices=False)
        return motions[singular <= 1e-10 * singular.max(initial=np.finfo(float).tiny)].T

    def fixing_dofs(self, phi: Mapping[int, Floats], forces: Floats, scale: float) -> NDArray[np.intp]:
        """Unknowns to hold so that no motion is free, none if none is.

        Raises LooseBodyError if the forces (unknowns,) do work on a free motion; scale: the size of the forces at work.
        """
        free = self.free(phi)
        if free.shape[1] == 0:
            return np.zeros(0, dtype=np.intp)
        motions = self.modes @ free
        work = motions.T @ forces
        # Loads and contact forces on one body cancel to rounding; 1e-9 leaves room for that and for no real load.
        if np.abs(work).max() > 1e-9 * scale:
            raise self.loose(free @ work)
        return select_fixing_dofs(motions)

    def by_owner(self, coefficients: Floats) -> list[Floats]:
        """Every owner's part of coefficients (motions,) or (motions, n)."""
        ends = np.cumsum([owner.coefficients.shape[1] for owner in self.owners])
        return np.split(coefficients, ends[:-1])

    def loose(self, motion: Floats, advice: str = "") -> LooseBodyError:
        """The error that names the body which a motion (coefficients) moves most, and how; advice: ends its message."""
        pairs = zip(self.owners, self.by_owner(motion), strict=True)
        owner, part = max(pairs, key=lambda pair: float(np.linalg.norm(pair[1])))
        return LooseBodyError(owner.body, owner.kinematics.describe(owner.coefficients @ part), advice)


def _smallest(matrix: Floats) -> float:
    """The smallest eigenvalue of a symmetric matrix."""
    if len(matrix) == 1:
        return float(matrix[0, 0])
    if len(matrix) == 2:
        a, b, _, d = map(float, matrix.ravel())
        return 0.5 * (a + d) - math.hypot(0.5 * (a - d), b)
    return float(np.linalg.eigvalsh(matrix)[0])


def select_fixing_dofs(motions: Floats) -> NDArray[np.intp]:
    """As many unknowns as there are motions (unknowns, motions), such that holding them stops every motion."""
    if motions.shape[1] == 0:
        return np.zeros(0, dtype=np.intp)
    if motions.shape[1] == 1:
        return np.atleast_1d(np.abs(motions[:, 0]).argmax())
    return scipy.linalg.qr(motions.T, mode="r", pivoting=True)[1][: motions.shape[1]]


def allowed_motions(modes: Floats, space: AdmissibleSpace) -> tuple[Floats, Floats]:
    """The rigid motions that the supports allow.

    modes: (dofs, motions) all of a body; space: what the supports leave. Returns the unknowns of an orthonormal set
    (unknowns, allowed), and its coefficients in `modes` (motions, allowed).
    """
    # Zero rows, so that there are as many singular values as motions.
    rows = np.concatenate([space.prevented(modes), np.zeros((modes.shape[1], modes.shape[1]))])
    _, singular, right = np.linalg.svd(rows, full_matrices=False)
    allowed = right[singular <= 1e-8 * np.linalg.norm(modes)].T
    return orthonormal(space.restricted(modes) @ allowed, allowed)


def orthonormal(modes: Floats, *combined: Floats) -> Any:
    """An orthonormal set with the same span, and other matrices (n, motions) combined in the same way."""
    if modes.shape[1] == 1:
        length = np.linalg.norm(modes)
        return modes / length, *(other / length for other in combined)
    q, r = np.linalg.qr(modes)
    inverse = np.linalg.inv(r)
    return q, *(other @ inverse for other in combined)
