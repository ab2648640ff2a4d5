"""A body that another rank holds: what its owner tells of its local problem, whose solves are the owner's."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NoReturn

import numpy as np
import scipy

from ..base.arrays import Floats, Indices, Operator, norm
from ..body import Body
from ..interface.discretise import InterfaceSide
from .problem import BodyDofs, ContactTrace, Fields, LocalProblem, Solver, rigid_motions


@dataclass(frozen=True)
class SharedDofs:
    """What all ranks know of a body in all its degrees of freedom.

    sizes: see `load_sizes`; prescribed, load_size: see `BodyDofs`; work: (all motions,) that of the loads on the rigid
    motions; motions: (dofs, all motions) these, at the degrees of freedom of the body as this rank knows it, or those
    that it is told of; none of a body that it knows.
    """

    sizes: Floats
    prescribed: bool
    load_size: float
    work: Floats
    motions: Floats

    @classmethod
    def of(cls, dofs: BodyDofs, motions: int, known: Indices | None) -> SharedDofs:
        """The same of a body that this rank holds.

        motions: the number of its rigid ones; known: the degrees of freedom that other ranks know, None for all.
        """
        moved = dofs.rigid_displacements(np.eye(motions))
        told = moved[[] if known is None else known]
        return cls(load_sizes(dofs), dofs.prescribed, dofs.load_size, moved.T @ dofs.load, told)

    def rigid_displacements(self, coefficients: Floats) -> Floats:
        """The displacements (dofs, n) of rigid motions given by coefficients (motions, n)."""
        return self.motions @ coefficients


def load_sizes(dofs: Any) -> Floats:
    """The sizes of all loads on a body, of those that are no eigenstrains, and of these, on what is not prescribed."""
    if isinstance(dofs, SharedDofs):
        return dofs.sizes
    strains = eigenstrain_load(dofs)
    if strains is None:
        size = norm(dofs.free_forces(dofs.load))
        return np.array([size, size, 0.0])
    return np.array([norm(dofs.free_forces(each)) for each in (dofs.load, dofs.load - strains, strains)])


def eigenstrain_load(dofs: Any) -> Floats | None:
    """The part (dofs,) of the loads of a body that eigenstrains are; None without any, as on a body of one's own."""
    released = getattr(dofs, "released", None)
    return None if released is None else released[0]


def work_of_loads(dofs: Any, coefficients: Floats) -> Floats:
    """The work of a body's loads on rigid motions given by coefficients (all motions, n), (n,)."""
    if isinstance(dofs, SharedDofs):
        return coefficients.T @ dofs.work
    return dofs.rigid_displacements(coefficients).T @ dofs.load


@dataclass(frozen=True)
class SharedProblem:
    """The part of a local problem that is sent to the other ranks, of the size of its contacts but for vectors.

    Attributes:
        dofs: What is told of all degrees of freedom.
        load, constant, factor_free: See `LocalProblem`.
        motions: The rigid motions' unknowns, coefficients and forces of springs; these None where there are none.
        stiffness_scale: The largest stiffness of the unknowns.
        traces: The trace, offset and Robin trace of every `ContactTrace`.
        nodal: The nodal trace and its offset.
    """

    dofs: SharedDofs
    load: Floats
    constant: float
    factor_free: bool
    motions: tuple[Floats, Floats, Floats | None]
    stiffness_scale: float
    traces: Sequence[tuple[Operator, Floats, Operator]]
    nodal: tuple[scipy.sparse.csr_matrix, Floats]

    @classmethod
    def of(cls, problem: LocalProblem, known: Indices | None) -> SharedProblem:
        """The shared part of a problem that this rank holds; known: see `SharedDofs.of`."""
        rigid, coefficients = problem.rigid, problem.rigid.owners[0].coefficients
        return cls(
            SharedDofs.of(problem.dofs, len(coefficients), known),
            problem.load,
            problem.constant,
            problem.factor_free,
            (rigid.modes, coefficients, rigid.springs if np.any(rigid.springs) else None),
            rigid.stiffness_scale,
            [(each.trace, each.offset, each.robin_trace) for each in problem.traces],
            (problem.nodal_trace, problem.nodal_offset),
        )


class RemoteProblem:
    """A local problem that another rank holds: gaps and contact forces can be found from it, all else is its owner's.

    Args:
        body: The body as this rank knows it.
        sides: Its sides of the scene's interfaces, each with the interface's index.
        shared: What its owner tells.
        known: The places of the body's degrees of freedom among those that its owner tells of, None if it is whole.
    """

    dofs: Any  # `SharedDofs`: what asks for more than those is done by the owner

    def __init__(
        self,
        body: Body,
        sides: Sequence[tuple[int, InterfaceSide]],
        shared: SharedProblem,
        known: Indices | None,
    ) -> None:
        self.name, self.length = body.name, body.mesh.size
        motions = body.rigid_modes() if known is None else shared.dofs.motions[known]
        self.dofs = replace(shared.dofs, motions=motions)
        self.load, self.constant, self.factor_free = shared.load, shared.constant, shared.factor_free
        self.nodal_trace, self.nodal_offset = shared.nodal
        told = zip(sides, shared.traces, strict=True)
        self.traces = [ContactTrace(index, side, *parts) for (index, side), parts in told]
        scale = shared.stiffness_scale
        modes, coefficients, told_springs = shared.motions
        springs = np.broadcast_to(0.0, modes.shape) if told_springs is None else told_springs
        self.rigid = rigid_motions(self.name, body.kinematics, self.traces, modes, coefficients, springs, scale)

    @property
    def size(self) -> int:
        return len(self.load)

    @property
    def stiffness(self) -> Operator:
        raise self._elsewhere()

    def refreshed(self, dofs: Any) -> NoReturn:
        raise NotImplementedError("a remote problem is received anew from its owner")

    def correct(self, phi: Mapping[int, Floats], residual: Floats, scale: float) -> Floats:
        raise self._elsewhere()

    def robin_solver(self, phi: Mapping[int, Floats]) -> Solver:
        raise self._elsewhere()

    def low_modes(self, phi: Mapping[int, Floats], below: float) -> Floats:
        raise self._elsewhere()

    def start(self, normal_displacement: Mapping[int, Floats]) -> Floats:
        raise self._elsewhere()

    def restrict(self, u: Floats) -> Floats:
        raise self._elsewhere()

    def displacement(self, y: Floats) -> Floats:
        raise self._elsewhere()

    def seen(self, y: Floats, operator: scipy.sparse.csr_matrix) -> None:
        return None

    def fields(self, y: Floats, deformation: Floats) -> Fields:
        raise self._elsewhere()

    def _elsewhere(self) -> RuntimeError:
        return RuntimeError(f"body {self.name!r} is solved by the rank that holds it")
