"""A meshed body in all its degrees of freedom: admissible displacements, stiffness, rigid motions and loads.

What the local problems of meshed bodies have in common, whichever way they solve it.
"""

from __future__ import annotations

from copy import copy
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..base.arrays import Floats
from ..body import Body
from .copies import loaded_alike
from .forms import load_vector
from .problem import Fields
from .rigid import allowed_motions
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
    """

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
        other.space = replace(self.space, offset=admissible_space(self.body).offset)
        other._set_loads()
        return other

    def _set_loads(self) -> None:
        """Set what follows from the loads and prescribed displacements."""
        self.load = load_vector(self.body)
        offset = self.space.offset
        prescribed = self.stiffness.forces(offset) if self.space.has_offset else np.zeros_like(offset)
        self.free_load = self.space.restricted(self.load - prescribed)
        self.constant = float(0.5 * offset @ prescribed - self.load @ offset)

    @property
    def prescribed(self) -> bool:
        return self.space.has_offset

    @property
    def load_size(self) -> float:
        return float(np.linalg.norm(self.load.reshape(-1, self.body.mesh.dim).sum(axis=0)))

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

    def fields(self, u: Floats, deformed: Floats) -> Fields:
        """The body's solution of a displacement u whose part without rigid motions is `deformed`."""
        elastic = self.stiffness.forces(deformed)
        return Fields(u, elastic, self.stiffness.spring_forces(u), 0.5 * float(deformed @ elastic))

    def free_forces(self, forces: Floats) -> Floats:
        return self.space.restricted(forces)

    def reactions(self, forces: Floats) -> Floats:
        return forces - self.space.extended(self.space.restricted(forces))

    def resultant(self, forces: Floats) -> Floats:
        return self.body.kinematics.resultant(forces.reshape(-1, self.body.mesh.dim))

    def rigid_displacements(self, coefficients: Floats) -> Floats:
        return self.body.rigid_modes() @ coefficients

    def carried(self) -> Floats:
        modes = self.body.rigid_modes()
        *prevented, prescribed = self.space.prevented(np.column_stack([modes, self.space.offset])).T
        return modes @ np.linalg.lstsq(np.transpose(prevented), prescribed, rcond=1e-10)[0]
