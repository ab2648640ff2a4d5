"""A meshed body in all its degrees of freedom: admissible displacements, stiffness, rigid motions and loads.

What the local problems of meshed bodies have in common, whichever way they solve it.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..base.arrays import Floats
from ..body import Body
from .copies import loaded_alike
from .forms import eigenstrain_energy, load_vectors
from .problem import ContactTrace, Fields, rigid_motions
from .rigid import RigidMotions, allowed_motions
from .space import admissible_space
from .stiffness import Stiffness


class DiscreteBody:
    """u = Z y + u₀ with its loads: the finite element problem of one body, without its contacts.

    Attributes:
        body: The body.
        space: Z and u₀.
        stiffness: a(u, v), in the form that is asked for.
        motions: The rigid motions that the supports allow: their unknowns (unknowns, motions), orthonormal, and their
            coefficients in all of the body's (all motions, motions).
        load: (dofs,) l(v).
        free_load: (unknowns,) the same in the unknowns, less what prescribed displacements cause.
        constant: The part of the energy that depends on no unknown.
        released: What eigenstrains take from the stored energy ½ a(u, u): their part of l(v), (dofs,), and the energy
            that they would store in a body that cannot move; None without eigenstrains.
    """

    released: tuple[Floats, float] | None = None
    load: Floats
    free_load: Floats
    constant: float

    def __init__(self, body: Body, original: tuple[DiscreteBody, Floats] | None = None) -> None:
        self.body = body
        if original is None:
            self.space = admissible_space(body)
            self.stiffness = Stiffness(body, self.space)
            self.motions = allowed_motions(body.rigid_modes(), self.space)
            self._set_loads()
        else:
            self._set_as_copy(*original)

    def _set_as_copy(self, original: DiscreteBody, signs: Floats) -> None:
        """Take over everything from the body that this one copies, with the signs of mirrored components."""
        self.space = original.space
        self.stiffness = Stiffness(self.body, self.space)
        modes, coefficients = original.motions
        turned = self.mirrored(signs)
        self.motions = turned[:, None] * modes, self.body.kinematics.mirrored_modes(signs)[:, None] * coefficients
        if loaded_alike(original.body, self.body):
            self.load = np.tile(signs, len(original.load) // len(signs)) * original.load
            self.free_load, self.constant = turned * original.free_load, original.constant
        else:
            self._set_loads()

    def refreshed(self) -> DiscreteBody:
        """The same body with its present loads and prescribed displacements; all matrices are shared."""
        other = copy(self)
        now = admissible_space(self.body)
        other.space = replace(self.space, offset=now.offset, carried=now.carried)
        other._set_loads()
        return other

    def rigid_motions(self, traces: Sequence[ContactTrace]) -> RigidMotions:
        """The motions in all unknowns, with what springs and each contact add to their stiffness."""
        scale = self.stiffness.largest
        return rigid_motions(
            self.body.name, self.body.kinematics, traces, *self.motions, self.spring_forces, stiffness_scale=scale
        )

    def _set_loads(self) -> None:
        """Set what follows from the loads and prescribed displacements."""
        self.load, strains = load_vectors(self.body)
        if strains is not None:
            self.released = strains, eigenstrain_energy(self.body)
        self.free_load = self.space.restricted(self.load)
        self.constant = 0.0
        if self.space.has_offset:
            prescribed, twice = self._prescribed_forces()
            self.free_load = self.free_load - prescribed
            self.constant = 0.5 * twice - float(self.load @ self.space.offset)

    def _prescribed_forces(self) -> tuple[Floats, float]:
        """The forces of u₀ (unknowns,) and their work on it; its rigid motion meets no force but that of springs."""
        straining, offset = self.space.straining, self.space.offset
        forces = self.stiffness.forces(straining)
        work = float(straining @ forces)
        modes = self.motions[0]
        answer: Floats = np.zeros(
            modes.shape[1]
        )  # the work of springs on the free motions: that of stresses is rounding
        if self.stiffness.has_springs:
            held = self.stiffness.spring_forces(offset - straining)
            work += float(straining @ held + (offset - straining) @ self.stiffness.spring_forces(offset))
            forces = forces + held
            answer = modes.T @ self.space.restricted(self.stiffness.spring_forces(offset))
        forces = self.space.restricted(forces)
        return forces + modes @ (answer - modes.T @ forces), work

    @property
    def prescribed(self) -> bool:
        return self.space.has_offset

    @property
    def load_size(self) -> float:
        acting = self.load if self.released is None else self.load - self.released[0]  # eigenstrains balance themselves
        moving = self.space.extended(self.space.restricted(acting))  # loads on what is held press nothing
        return float(np.linalg.norm(moving.reshape(-1, self.body.mesh.dim).sum(axis=0)))

    def mirrored(self, signs: Floats) -> Floats:
        """The factors ±1 of the unknowns (unknowns,) if the displacement's components change by `signs` (dim,)."""
        return signs[self.space.free_dofs % len(signs)]

    @cached_property
    def spring_forces(self) -> Floats:
        """The forces with which springs answer the rigid motions, (unknowns, motions)."""
        modes = self.motions[0]
        if not self.stiffness.has_springs:
            return np.zeros_like(modes)
        return self.space.restricted(self.stiffness.springs @ self.space.extended(modes))

    def displacement(self, y: Floats) -> Floats:
        """All degrees of freedom of the displacement."""
        return self.space.extended(y) + self.space.offset

    def restrict(self, u: Floats) -> Floats:
        """The unknowns of the admissible displacement closest to u."""
        return self.space.restricted(u - self.space.offset)

    def strained(self, deformation: Floats) -> Floats:
        """All degrees of freedom of a displacement without rigid motions; deformation: (unknowns,)."""
        return self.space.extended(deformation) + self.space.straining

    def moved(self, rigid: RigidMotions, y: Floats) -> Floats | None:
        """The free rigid motion (dofs,) in the unknowns of a problem, None where no spring would answer it."""
        if not self.stiffness.has_springs:
            return None
        return self.rigid_displacements(rigid.owners[0].coefficients @ (rigid.modes.T @ y))

    def fields(self, u: Floats, deformed: Floats, moved: Floats | None) -> Fields:
        """The body's solution of a displacement u whose part without rigid motions is `deformed`.

        moved: The free rigid motion that springs answer, None without springs.
        """
        elastic = self.stiffness.forces(deformed)
        gained = self._gained(u)
        if moved is None:
            return Fields(u, elastic, np.zeros_like(u), 0.5 * float(deformed @ elastic) + gained)
        moved = moved if self.space.carried is None else moved + self.space.carried
        elastic, springs = elastic + self.stiffness.spring_forces(moved), self.stiffness.spring_forces(u)
        return Fields(u, elastic, springs, 0.5 * float(deformed @ elastic + moved @ springs) + gained)

    def _gained(self, u: Floats) -> float:
        """What eigenstrains add to ½ a(u, u): ½ ∫ (ε − ε₀) : C : (ε − ε₀) less ½ ∫ ε : C : ε."""
        return 0.0 if self.released is None else self.released[1] - float(self.released[0] @ u)

    def free_forces(self, forces: Floats) -> Floats:
        return self.space.restricted(forces)

    def reactions(self, forces: Floats) -> Floats:
        return forces - self.space.extended(self.space.restricted(forces))

    def resultant(self, forces: Floats) -> Floats:
        return self.body.kinematics.resultant(forces.reshape(-1, self.body.mesh.dim))

    def rigid_displacements(self, coefficients: Floats) -> Floats:
        return self.body.rigid_modes() @ coefficients
