"""One body's linear problem (22) on its own: what a decomposed step solves, independently for every body.

A subproblem works with some vector of unknowns y of its body and hides which. `AssembledProblem` keeps every free
displacement and reassembles and refactors its matrix at each step, the plain reading of the method.
`CondensedProblem` keeps only the displacements that the contacts touch; the inside is eliminated once.
`RemoteProblem` is one whose inside another rank holds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from ..base.arrays import Floats, Operator
from ..base.sparse import entry_positions
from ..body import Body
from ..interface.discretise import Interface
from ..interface.robin import RobinTerm
from .copies import loaded_alike
from .factor import Factor
from .forms import load_vector
from .problem import ContactTrace, Fields, Solver, sides
from .rigid import Owner, Resistance, RigidMotions, allowed_motions, select_fixing_dofs
from .space import admissible_space
from .stiffness import Matrices


class AssembledProblem:
    """a(ũ, v) + ∫ φ ũ_n v_n = l(v) + ∫ φ u_n v_n + ∫ g⁻ v_n of one body, in the unknowns y of u = Z y + u₀.

    original: the problem of a body that this one is a copy of, and the signs between them (`copies`).
    """

    def __init__(
        self,
        body: Body,
        place: int,
        interfaces: Sequence[Interface],
        original: tuple[AssembledProblem, Floats] | None = None,
    ) -> None:
        self.body = body
        self.sides = sides(place, interfaces)
        self._factor: Factor | None = None
        if original is not None:
            self._set_as_copy(*original)
            return
        self.space = admissible_space(body)
        self.matrices = Matrices(body, self.space)
        self.motions = allowed_motions(body.rigid_modes(), self.space)
        self._set_loads()

    def _set_as_copy(self, original: AssembledProblem, signs: Floats) -> None:
        """What follows from the problem of a body that this one is a copy of."""
        self.space = original.space
        self.matrices = Matrices(self.body, self.space)
        modes, coefficients = original.motions
        turned = self.mirrored(signs)
        self.motions = turned[:, None] * modes, self.body.kinematics.mirrored_modes(signs)[:, None] * coefficients
        if loaded_alike(original.body, self.body):
            self.full_load = np.tile(signs, len(original.full_load) // len(signs)) * original.full_load
            self.load, self.constant = turned * original.load, original.constant
        else:
            self._set_loads()

    def mirrored(self, signs: Floats) -> Floats:
        """By what the unknowns change (unknowns,) if the displacement's components change by `signs` (dim,)."""
        return signs[self.space.free % len(signs)]

    @cached_property
    def stiffness(self) -> Operator:
        """a(u, v) in the unknowns."""
        return self.matrices.reduced

    @cached_property
    def ports(self) -> list[ContactTrace]:
        """Where the interfaces meet the unknowns."""
        return [
            ContactTrace(
                index,
                side,
                self.space.columns(side.trace),
                self.space.prescribed(side.trace),
                self.space.columns(side.surface.trace),
            )
            for index, side in self.sides
        ]

    @cached_property
    def rigid(self) -> RigidMotions:
        """The rigid motions that the supports leave free."""
        return self._rigid_motions(*self.motions, self.spring_forces)

    @property
    def spring_forces(self) -> Floats:
        """The forces with which springs answer the rigid motions, (unknowns, motions)."""
        modes = self.motions[0]
        if not self.matrices.has_springs:
            return np.zeros_like(modes)
        return self.space.restricted(self.matrices.springs @ self.space.extended(modes))

    def refreshed(self) -> AssembledProblem:
        """The same problem for the present loads and prescribed displacements; all matrices are shared."""
        other = copy(self)
        now = admissible_space(self.body)
        other.space = replace(self.space, offset=now.offset, carried=now.carried)
        if "ports" in vars(self):
            other.ports = [replace(port, offset=other.space.prescribed(port.side.trace)) for port in self.ports]
        other._set_loads()
        return other

    def _set_loads(self) -> None:
        """What follows from the loads and prescribed displacements."""
        self.full_load = load_vector(self.body)
        self.load = self.space.restricted(self.full_load)
        self.constant = 0.0
        if self.space.has_offset:
            prescribed, twice = self._prescribed_forces()
            self.load = self.load - prescribed
            self.constant = 0.5 * twice - float(self.full_load @ self.space.offset)

    def _prescribed_forces(self) -> tuple[Floats, float]:
        """The forces of u₀ (unknowns,) and their work on it; its rigid motion meets no force but that of springs."""
        straining, offset = self.space.straining, self.space.offset
        forces = self.matrices.forces(straining)
        work = float(straining @ forces)
        modes, springs = self.motions[0], self.matrices.has_springs
        answer = np.zeros(modes.shape[1])  # the work of springs on the free motions: that of stresses is rounding
        if springs:
            held = self.matrices.spring_forces(offset - straining)
            work += float(straining @ held + (offset - straining) @ self.matrices.spring_forces(offset))
            forces = forces + held
            answer = modes.T @ self.space.restricted(self.matrices.spring_forces(offset))
        forces = self.space.restricted(forces)
        return forces + modes @ (answer - modes.T @ forces), work

    @cached_property
    def nodal_trace(self) -> scipy.sparse.csr_matrix:
        """u_n at the nodes of all contact surfaces from the unknowns, but for `nodal_offset`."""
        return self.space.columns(self._nodal)

    @property
    def nodal_offset(self) -> Floats:
        """u_n at the nodes of all contact surfaces of the prescribed displacements."""
        return self.space.prescribed(self._nodal)

    @cached_property
    def _nodal(self) -> scipy.sparse.csr_matrix:
        """u_n at the nodes of all contact surfaces, from all degrees of freedom."""
        return scipy.sparse.vstack([side.surface.nodal_trace for _, side in self.sides]).tocsr()

    @property
    def size(self) -> int:
        """The number of unknowns."""
        return len(self.load)

    def correct(self, phi: Mapping[int, Floats], residual: Floats, scale: float) -> Floats:
        """ũ − u of (22): the solution of a(δ, v) + ∫ φ δ_n v_n = residual.

        phi: the Robin coefficient at the points of each interface; scale: the size of the forces at work. Raises
        LooseBodyError where nothing holds the body.
        """
        ground = self.rigid.ground(phi, residual, scale)
        return self._solver(phi, ground)(residual)

    def held(self, phi: Mapping[int, Floats]) -> Solver:
        """(A + Φ)⁻¹, with any motion held that is free: the body's part of a preconditioner.

        All that depends on φ alone is done here, once for however many forces. To be used before the body is asked for
        a solve with another φ.
        """
        return self._solver(phi, select_fixing_dofs(self.rigid.modes @ self.rigid.free(phi)))

    def low_modes(self, phi: Mapping[int, Floats], below: float) -> Floats:
        """The modes of A v = λ (A + Φ) v with λ < below, (unknowns, modes): none where A is too large to ask."""
        return np.zeros((self.size, 0))

    def displacement(self, y: Floats) -> Floats:
        """All degrees of freedom of the displacement."""
        return self.space.extended(y) + self.space.offset

    def seen(self, y: Floats, operator: scipy.sparse.csr_matrix) -> Floats | None:
        """operator @ displacement(y) where the unknowns alone tell it, else None; operator: on all dofs."""
        return operator @ (self.space.extended(y) + self.space.offset)

    def fields(self, y: Floats, deformation: Floats) -> Fields:
        """What the solution tells of the body."""
        u = self.displacement(y)
        if not self.matrices.has_springs:
            deformed = self._strained(deformation)
            elastic = self.matrices.forces(deformed)
            return Fields(u, elastic, np.zeros_like(u), 0.5 * float(deformed @ elastic))
        # The springs answer the rigid motion as well, which is not part of the deformation.
        (owner,) = self.rigid.owners
        moved = self.body.rigid_modes() @ (owner.coefficients @ (self.rigid.modes.T @ y))
        deformed = self._strained(deformation, self.space.restricted(self.matrices.spring_forces(moved)))
        if self.space.carried is not None:
            moved = moved + self.space.carried
        springs = self.matrices.spring_forces(u)
        elastic = self.matrices.forces(deformed) + self.matrices.spring_forces(moved)
        return Fields(u, elastic, springs, 0.5 * float(deformed @ elastic + moved @ springs))

    def _strained(self, deformation: Floats, springs: Floats | None = None) -> Floats:
        """All degrees of freedom of a displacement without its rigid motion.

        springs: (unknowns,) the forces of springs on that motion.
        """
        return self.space.extended(deformation) + self.space.straining

    def restrict(self, u: Floats) -> Floats:
        """The unknowns of the admissible displacement closest to u."""
        return self.space.restricted(u - self.space.offset)

    def start(self, normal_displacement: Mapping[int, Floats]) -> Floats:
        """Unknowns with (nearly) the given u_n at the points of each interface and the inside in equilibrium."""
        from .condensed import CondensedProblem

        condensed = CondensedProblem(self)
        return self.restrict(condensed.displacement(condensed.start(normal_displacement)))

    def _solver(self, phi: Mapping[int, Floats], ground: NDArray[np.intp]) -> Solver:
        """(A + Φ)⁻¹ with these unknowns held, factored; an assembled body has room for one factor only."""
        values = self._system_values(phi)
        values[self._diagonal[ground]] += self.rigid.largest
        if self._factor is None:
            matrix = self.stiffness.copy()
            matrix.data = values
            self._factor = Factor(matrix)
        else:
            self._factor.update(values)
        return self._factor.solve

    @cached_property
    def _robin_terms(self) -> dict[int, RobinTerm]:
        """The Robin terms in UFL, by the interfaces' places."""
        return {port.interface: RobinTerm(port.side.surface) for port in self.ports}

    @cached_property
    def _diagonal(self) -> NDArray[np.intp]:
        """Where the diagonal stands among the entries of the stiffness matrix."""
        return entry_positions(self.stiffness, scipy.sparse.eye(self.size, format="csr"))

    def _system_values(self, phi: Mapping[int, Floats]) -> Floats:
        """The entries of A + Φ at the places of the stiffness matrix."""
        values = self.stiffness.data.copy()
        for port in self.ports:
            surface = port.side.surface
            term = self._robin_terms[port.interface].matrix(surface.mean(port.side.transfer @ phi[port.interface]))
            term = self.space.within(term)
            values[entry_positions(self.stiffness, term)] += term.data
        return values

    def _rigid_motions(self, modes: Floats, coefficients: Floats, springs: Floats) -> RigidMotions:
        """The rigid motions with these columns of unknowns, of coefficients and of forces of springs."""
        contacts = [
            Resistance(
                port.interface,
                np.sqrt(port.side.surface.weights)[:, None] * (port.robin_trace @ modes),
                port.side.transfer,
            )
            for port in self.ports
        ]
        owner = Owner(self.body.name, self.body.kinematics, coefficients)
        return RigidMotions(modes, springs, contacts, [owner], float(self.stiffness.diagonal().max(initial=0.0)))
