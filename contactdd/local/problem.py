"""The contract of a local problem: the problem of one body, seen from its contacts, independent of all others.

    a(ũ, v) + ∫ φ ũ_n v_n = l(v) + ∫ φ u_n v_n + ∫ g⁻ v_n    (22), (32), (36)

A local problem works with some vector of unknowns y of its body and hides which: all free displacements (`assembled`,
`multigrid`), those that the contacts touch (`condensed`), the motions of a rigid body, or what a user's own way of
solving a body needs. Implementations are independent of each other and share parts: the body in all its degrees of
freedom (`BodyDofs`, of meshes `discrete.DiscreteBody`) and dense algebra (`dense.DenseSystem`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
import scipy

from ..base.arrays import Floats, Indices, Operator
from ..interface.discretise import InterfaceSide
from ..kinematics import Kinematics
from .rigid import Owner, Resistance, RigidMotions, select_fixing_dofs
from .space import SMALL, AdmissibleSpace

#: From forces (unknowns,) to the unknowns that they cause (unknowns,).
Solver = Callable[[Floats], Floats]


@dataclass(frozen=True)
class ContactTrace:
    """The action of one interface on the unknowns of a body: u_n at its points is trace @ y + offset.

    Attributes:
        interface: The interface's index in the scene.
        side: The body's side of it.
        trace: (points, unknowns) The operator from unknowns to u_n, without prescribed displacements.
        offset: (points,) The u_n of the prescribed displacements (length).
        robin_trace: (own points, unknowns) The same operator at the integration points of the body's own surface.
    """

    interface: int
    side: InterfaceSide
    trace: Operator
    offset: Floats
    robin_trace: Operator

    def surface_stiffness(self, phi: Mapping[int, Floats]) -> Floats:
        """φ times the areas at the integration points of the body's own surface.

        Args:
            phi: The Robin coefficient at the points of each interface (stress / length), by the interfaces' indices.
        """
        return self.side.surface.weights * (self.side.transfer @ phi[self.interface])


@dataclass(frozen=True)
class Fields:
    """A body's solution in all degrees of freedom.

    Attributes:
        displacement: (dofs,) The displacement u (length).
        elastic_forces: (dofs,) The forces a(u, ·), of the deformation only, see `system.state.State`.
        spring_forces: (dofs,) The forces of elastic foundations.
        elastic_energy: The energy ½ a(u, u), that which eigenstrains take away left out (force · length).
    """

    displacement: Floats
    elastic_forces: Floats
    spring_forces: Floats
    elastic_energy: float


class BodyDofs(Protocol):
    """A body in all its degrees of freedom: nodal displacements of a mesh, or the motions of a rigid body."""

    @property
    def load(self) -> Floats:
        """(dofs,) l(v)."""
        ...

    @property
    def prescribed(self) -> bool:
        """Whether any displacement other than zero is prescribed."""
        ...

    @property
    def load_size(self) -> float:
        """The size of the sum of all nodal loads, radial ones of a body of revolution included."""
        ...

    def free_forces(self, forces: Floats) -> Floats:
        """The part of forces (dofs,) that works on admissible displacements, in these."""
        ...

    def reactions(self, forces: Floats) -> Floats:
        """The part of forces (dofs,) that the supports take, (dofs,)."""
        ...

    def resultant(self, forces: Floats) -> Floats:
        """The total force (dim,) of forces (dofs,)."""
        ...

    def rigid_displacements(self, coefficients: Floats) -> Floats:
        """The displacements (dofs, n) of rigid motions given by coefficients (motions, n)."""
        ...


class LocalProblem(Protocol):
    """The problem of one body: made by a local solver, and all that the rest of the package knows of the body."""

    @property
    def name(self) -> str:
        """The body's name."""
        ...

    @property
    def length(self) -> float:
        """The body's size (length); 0 where it has none."""
        ...

    @property
    def dofs(self) -> BodyDofs:
        """The body in all its degrees of freedom."""
        ...

    @property
    def traces(self) -> Sequence[ContactTrace]:
        """The actions of the contacts on the unknowns, one for each side of an interface."""
        ...

    @property
    def load(self) -> Floats:
        """(unknowns,) the loads less what prescribed displacements cause."""
        ...

    @property
    def constant(self) -> float:
        """The part of the energy F₁ that depends on no unknown."""
        ...

    @property
    def stiffness(self) -> Operator:
        """(unknowns, unknowns) a(u, v) in the unknowns."""
        ...

    @property
    def rigid(self) -> RigidMotions:
        """The rigid motions that the supports leave."""
        ...

    @property
    def factor_free(self) -> bool:
        """Whether the body is too large to factor its stiffness."""
        ...

    @property
    def size(self) -> int:
        """The number of unknowns."""
        ...

    @property
    def nodal_trace(self) -> scipy.sparse.csr_matrix:
        """u_n at the nodes of all contact surfaces from the unknowns, but for `nodal_offset`."""
        ...

    @property
    def nodal_offset(self) -> Floats:
        """u_n at the nodes of all contact surfaces of the prescribed displacements."""
        ...

    def correct(self, phi: Mapping[int, Floats], residual: Floats, scale: float) -> Floats:
        """ũ − u of (22): the solution of a(δ, v) + ∫ φ δ_n v_n = residual.

        Args:
            phi: The Robin coefficient at the points of each interface (stress / length).
            residual: (unknowns,) forces.
            scale: The size of the forces at work.

        Raises:
            LooseBodyError: Nothing holds the body against these forces.
        """
        ...

    def robin_solver(self, phi: Mapping[int, Floats]) -> Solver:
        """(A + Φ)⁻¹, with any motion fixed that is free: the body's part of a preconditioner.

        Depends on φ only and may be applied to many right-hand sides; invalid once the body is solved with another φ.

        Args:
            phi: The Robin coefficient at the points of each interface (stress / length), by the interfaces' indices.
        """
        ...

    def low_modes(self, phi: Mapping[int, Floats], below: float) -> Floats:
        """The modes of A v = λ (A + Φ) v with λ below a bound, (unknowns, modes); none where A is too large to ask.

        Args:
            phi: The Robin coefficient at the points of each interface (stress / length), by the interfaces' indices.
            below: The bound.
        """
        ...

    def start(self, normal_displacement: Mapping[int, Floats]) -> Floats:
        """Unknowns with (nearly) the given u_n at the contact points and the inside in equilibrium.

        Args:
            normal_displacement: u_n (length) at the points of each interface, by the interfaces' indices.
        """
        ...

    def restrict(self, u: Floats) -> Floats:
        """The unknowns of the admissible displacement closest to a given one.

        Args:
            u: (dofs,) a displacement (length).
        """
        ...

    def displacement(self, y: Floats) -> Floats:
        """The displacement (dofs,) of unknowns.

        Args:
            y: (unknowns,) The unknowns.
        """
        ...

    def seen(self, y: Floats, operator: scipy.sparse.csr_matrix) -> Floats | None:
        """The product of an operator with the displacement where the unknowns alone suffice for it, else None.

        Args:
            y: (unknowns,) The unknowns.
            operator: On all degrees of freedom.
        """
        ...

    def fields(self, y: Floats, deformation: Floats) -> Fields:
        """The body's solution in all degrees of freedom.

        Args:
            y: (unknowns,) The unknowns.
            deformation: (unknowns,) the same without rigid motions.
        """
        ...

    def refreshed(self, dofs: Any) -> LocalProblem:
        """The same problem for other loads and prescribed displacements; all matrices are shared.

        Args:
            dofs: The body in all its degrees of freedom, read anew.
        """
        ...


def contact_traces(
    sides: Sequence[tuple[int, InterfaceSide]],
    space: AdmissibleSpace,
    kept: Indices | None = None,
    crowded: bool = False,
) -> list[ContactTrace]:
    """The traces of a body's sides on all unknowns of its admissible space, or on those `kept`.

    crowded: see `LocalTask`.
    """
    some, found = space.columns if kept is None else space.columns_of(kept, 0 if crowded else SMALL), []
    for index, side in sides:
        trace = some(side.trace)
        robin_trace = trace if side.surface.trace is side.trace else some(side.surface.trace)
        found.append(ContactTrace(index, side, trace, space.prescribed(side.trace), robin_trace))
    return found


def refreshed_traces(traces: Sequence[ContactTrace], space: AdmissibleSpace) -> list[ContactTrace]:
    """The same traces for the present prescribed displacements."""
    return [replace(trace, offset=space.prescribed(trace.side.trace)) for trace in traces]


def nodal_operator(traces: Sequence[ContactTrace]) -> scipy.sparse.csr_matrix:
    """u_n at the nodes of all contact surfaces of a body, from all degrees of freedom."""
    return scipy.sparse.vstack([trace.side.surface.nodal_trace for trace in traces]).tocsr()


def rigid_motions(
    name: str,
    kinematics: Kinematics,
    traces: Sequence[ContactTrace],
    modes: Floats,
    coefficients: Floats,
    springs: Floats,
    stiffness_scale: float,
) -> RigidMotions:
    """The free rigid motions of one body: their unknowns (unknowns, motions), coefficients (all motions, motions) and
    forces of springs (unknowns, motions), with what each contact adds to their stiffness."""
    contacts = [
        Resistance(
            trace.interface,
            np.sqrt(trace.side.surface.weights)[:, None] * (trace.robin_trace @ modes),
            trace.side,
        )
        for trace in traces
    ]
    return RigidMotions(modes, springs, contacts, [Owner(name, kinematics, coefficients)], stiffness_scale)


def free_fixing_dofs(rigid: RigidMotions, phi: Mapping[int, Floats]) -> Indices:
    """The unknowns to fix so that no motion is free under φ; empty if there is none."""
    return select_fixing_dofs(rigid.modes @ rigid.free(phi))
