"""Rigid motions that the supports allow, and the resistance of springs and contacts to them.

allowed     not prevented by a support of the body: the columns of `RigidMotions.modes`;
floating    bodies with allowed motions of which no spring resists any (whatever the contacts do);
kernel      allowed motions that change no gap and meet no spring, whatever φ is: no result depends on them;
unresisted  the kernel motions without those that springs resist after all, within rounding;
free(φ)     allowed motions that neither springs nor contacts with the Robin coefficient φ resist: the unresisted ones,
            and those of bodies whose contacts are open;
loose       a body with a free motion on which forces do work: nothing holds it, which is a `LooseBodyError`.

A free motion on which the forces do no work is harmless (a block may slide without friction on another): the linear
problem is then solved with as many unknowns fixed as there are free motions (`fixing_dofs`).
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

from ..base.arrays import TINY, Floats
from ..errors import LooseBodyError
from ..kinematics import Kinematics
from .space import AdmissibleSpace

if TYPE_CHECKING:
    from ..interface.discretise import InterfaceSide


@dataclass(frozen=True)
class Resistance:
    """The resistance of one interface to the rigid motions: the stiffness Σ_p φ_p m_p m_pᵀ.

    rows: (points, motions) √weight u_n of each motion; side: the one at whose own points that is, None where they are
    the interface's.
    """

    interface: int
    rows: Floats
    side: InterfaceSide | None = None

    def root(self, phi: Mapping[int, Floats]) -> Floats:
        """R of the stiffness RᵀR, (points, motions)."""
        values = phi[self.interface] if self.side is None else self.side.transfer @ phi[self.interface]
        return np.sqrt(values)[:, None] * self.rows


@dataclass(frozen=True)
class Owner:
    """The body that a group of columns belongs to: its name, its kinematics and the motions' coefficients."""

    body: str
    kinematics: Kinematics
    coefficients: Floats


@dataclass(frozen=True)
class RigidMotions:
    """The rigid motions that the supports of one body, or of several together, allow.

    modes: (unknowns, motions), orthonormal within each body; springs: (unknowns, motions) the forces of springs under
    each motion (a rigid motion causes no other elastic force); contacts: the resistances of the interfaces; owners: the
    bodies of the motions; stiffness_scale: the largest stiffness of the unknowns.
    """

    modes: Floats
    springs: Floats
    contacts: Sequence[Resistance]
    owners: Sequence[Owner]
    stiffness_scale: float

    @cached_property
    def elastic(self) -> Floats:
        """The stiffness of springs against the motions, (motions, motions)."""
        elastic = self.modes.T @ self.springs
        return 0.5 * (elastic + elastic.T)

    @property
    def count(self) -> int:
        """The number of motions."""
        return self.modes.shape[1]

    @cached_property
    def floating(self) -> bool:
        """Whether there are allowed motions and no spring resists any of them."""
        return self.count > 0 and not np.any(self.springs)

    def free(self, phi: Mapping[int, Floats]) -> Floats:
        """The motions free under φ, as columns of coefficients (motions, free)."""
        if self.count == 0:
            return np.zeros((0, 0))
        roots = [contact.root(phi) for contact in self.contacts]
        resistance = sum((root.T @ root for root in roots), self._elastic_with_kernel_fixed)
        # Below this a motion's resistance is lost in the rounding of the stiffness, or of a layer stiffer than that.
        limit = 1e-14 * max(self.stiffness_scale, float(np.abs(resistance).max()))
        # Mostly the contacts resist all that they ever could.
        if _smallest(resistance) > limit:
            return self.unresisted
        # Use the square roots: forming RᵀR would mix resisted motions into the free ones at the rounding of the
        # stiffest layer.
        roots.append(self.spring_root)
        _, singular, motions = np.linalg.svd(np.linalg.qr(np.vstack(roots), mode="r"))
        return motions[singular**2 <= limit].T

    @property
    def spring_root(self) -> Floats:
        """R of the stiffness RᵀR of springs, (motions, motions)."""
        springs, directions = np.linalg.eigh(self.elastic)
        return np.sqrt(np.maximum(springs, 0.0))[:, None] * directions.T

    @property
    def unsprung(self) -> NDArray[np.bool_]:
        """Which motions no spring answers, (motions,)."""
        return ~np.any(self.springs, axis=0)

    @property
    def unbounded(self) -> Floats:
        """The motions that no spring resists, as columns of coefficients (motions, unbounded)."""
        return self.unresisted_by_springs(float(np.abs(self.elastic).max(initial=0.0)))

    def unresisted_by_springs(self, largest: float) -> Floats:
        """The same; largest: the stiffness in whose rounding a resistance is lost."""
        if not np.any(self.elastic):
            return np.eye(self.count)
        springs, directions = np.linalg.eigh(self.elastic)
        return directions[:, springs <= 1e-12 * largest]

    @property
    def rows(self) -> Floats:
        """√weight u_n of each motion at all points, (points, motions)."""
        return np.vstack([contact.rows for contact in self.contacts])

    def displacements(self, coefficients: Floats) -> Floats:
        """The unknowns (unknowns,) of motions given by coefficients."""
        return self.modes @ coefficients

    def free_displacements(self, phi: Mapping[int, Floats]) -> Floats:
        """The motions free under φ as unknowns, (unknowns, free)."""
        return self.modes @ self.free(phi)

    def closest(self, stiffness: Floats, wanted: Floats) -> Floats:
        """The coefficients (motions,) of unsprung motions with about the wanted √weight u_n at all points.

        Those of least squares, with weights `stiffness` (points,), and of these the smallest.
        """
        coefficients, roots = np.zeros(self.count), np.sqrt(stiffness)
        rows = roots[:, None] * self.rows[:, self.unsprung]
        coefficients[self.unsprung] = np.linalg.lstsq(rows, roots * wanted, rcond=1e-10)[0]
        return coefficients

    @cached_property
    def unresisted(self) -> Floats:
        """The kernel motions, (motions, unresisted); none if springs soft enough for the kernel resist any of them."""
        resistance = self.kernel.T @ self.elastic @ self.kernel
        return self.kernel[:, : 0 if np.any(np.abs(resistance) > 1e-14 * self.stiffness_scale) else None]

    @cached_property
    def _elastic_with_kernel_fixed(self) -> Floats:
        """The stiffness of springs against the motions, with the unresisted ones fixed."""
        return self.elastic + self.stiffness_scale * (self.unresisted @ self.unresisted.T)

    @cached_property
    def kernel(self) -> Floats:
        """The motions that change no gap and meet no spring, whatever φ is, (motions, kernel)."""
        springs = np.linalg.norm(self.springs, axis=0) / max(self.stiffness_scale, TINY)
        rows = np.vstack([np.diag(springs)] + [contact.rows for contact in self.contacts])
        _, singular, motions = np.linalg.svd(rows, full_matrices=False)
        return motions[singular <= 1e-10 * singular.max(initial=TINY)].T

    def fixing_dofs(self, phi: Mapping[int, Floats], forces: Floats, scale: float) -> NDArray[np.intp]:
        """Unknowns to fix so that no rigid motion remains; empty if there is none.

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
        """The parts of coefficients (motions,) or (motions, n), one for each owner."""
        ends = np.cumsum([owner.coefficients.shape[1] for owner in self.owners])
        return np.split(coefficients, ends[:-1])

    def loose(self, motion: Floats, advice: str = "") -> LooseBodyError:
        """The error that names the body which a motion (coefficients) moves most; advice: the end of its message."""
        return loose_body(self.owners, self.by_owner(motion), advice)


def loose_body(owners: Sequence[Owner], parts: Sequence[Floats], advice: str) -> LooseBodyError:
    """The error that names the body which a motion, its coefficients given by body, moves most."""
    owner, part = max(zip(owners, parts, strict=True), key=lambda pair: float(np.linalg.norm(pair[1])))
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
    """As many unknowns as there are motions (unknowns, motions), such that fixing them prevents every motion."""
    if motions.shape[1] == 0:
        return np.zeros(0, dtype=np.intp)
    if motions.shape[1] == 1:
        return np.atleast_1d(np.abs(motions[:, 0]).argmax())
    return scipy.linalg.qr(motions.T, mode="r", pivoting=True)[1][: motions.shape[1]]


def allowed_motions(modes: Floats, space: AdmissibleSpace) -> tuple[Floats, Floats]:
    """The rigid motions that the supports allow.

    modes: (dofs, motions) all of a body; space: its admissible displacements. Returns the unknowns of an orthonormal
    set (unknowns, allowed), and its coefficients in `modes` (motions, allowed).
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
