"""A body that another rank holds: its local problem without the inside and the solves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NoReturn

import numpy as np
import scipy

from ..base.arrays import Floats, Indices, Operator
from ..base.ranks import Ranks
from ..base.spectral import SpectralStiffness
from .condensed import CondensedProblem, seen_from
from .dense import DenseSystem
from .problem import Fields, Solver, contact_traces, nodal_operator, rigid_motions
from .stiffness import SelectedStiffness
from .task import LocalTask


class CollectiveOperator:
    """A matrix that one rank holds and all ranks apply together.

    Args:
        ranks: The ranks.
        owner: The rank that holds the matrix.
        matrix: The matrix on that rank; the others need none.
        size: The number of its rows and columns where there is no matrix.
    """

    def __init__(self, ranks: Ranks, owner: int, matrix: Any = None, size: int = 0) -> None:
        self._ranks, self._owner, self._matrix = ranks, owner, matrix
        self.shape = (size, size) if matrix is None else matrix.shape

    def __matmul__(self, y: Floats) -> Floats:
        own = self._matrix is not None and self._ranks.comm.rank == self._owner
        product = np.ascontiguousarray(self._matrix @ y) if own else np.empty_like(y, order="C")
        return self._ranks.sent(product, self._owner)

    def gathered(self) -> scipy.sparse.csr_matrix:
        """The matrix, on every rank."""
        return self._ranks.gather(None if self._matrix is None else as_matrix(self._matrix))[self._owner]


def as_matrix(operator: Any) -> Operator:
    """The matrix of an operator; one that a single rank holds is sent to all."""
    if isinstance(operator, SpectralStiffness):
        return operator.toarray()
    if isinstance(operator, SelectedStiffness):
        return operator.matrix
    return operator.gathered() if isinstance(operator, CollectiveOperator) else operator


@dataclass(frozen=True)
class SharedProblem:
    """The part of a local problem that is sent to the other ranks.

    Attributes:
        kept: The unknowns of the admissible space that are its unknowns, None for all.
        stiffness: S of a condensed problem, None where all ranks apply the stiffness together.
        load, constant: See `LocalProblem`.
        modes, coefficients, springs: Of the rigid motions, None where every rank finds them itself.
        stiffness_scale: The largest stiffness of the unknowns.
        factor_free: See `LocalProblem`.
    """

    kept: Indices | None
    stiffness: Floats | None
    load: Floats
    constant: float
    motions: tuple[Floats, Floats, Floats] | None
    stiffness_scale: float
    factor_free: bool

    @classmethod
    def of(cls, problem: Any) -> SharedProblem:
        """The shared part of the problem of a meshed body."""
        rigid = problem.rigid
        if isinstance(problem, CondensedProblem):
            motions = rigid.modes, rigid.owners[0].coefficients, rigid.springs
            condensed = problem.kept, problem.stiffness, problem.load, problem.constant, motions
            return cls(*condensed, rigid.stiffness_scale, problem.factor_free)
        return cls(None, None, problem.load, problem.constant, None, rigid.stiffness_scale, problem.factor_free)


class RemoteProblem:
    """A local problem that another rank holds: gaps, forces and energies can be found from it, solves cannot."""

    def __init__(self, task: LocalTask, shared: SharedProblem, owner: int, ranks: Ranks) -> None:
        self.name, self.length, self.dofs = task.body.name, task.body.mesh.size, task.discrete
        self.factor_free, self.kept = shared.factor_free, shared.kept
        self.load, self.constant = shared.load, shared.constant
        self.traces = contact_traces(task.sides, self.dofs.space, self.kept, task.crowded)
        modes, coefficients, springs = shared.motions or (*self.dofs.motions, self.dofs.spring_forces)
        kinematics, scale = task.body.kinematics, shared.stiffness_scale
        self.rigid = rigid_motions(self.name, kinematics, self.traces, modes, coefficients, springs, scale)
        if shared.stiffness is None:
            self.stiffness: Operator = CollectiveOperator(ranks, owner, size=self.dofs.space.size)
            self._system: DenseSystem | None = None
        else:
            self.stiffness = shared.stiffness
            self._system = DenseSystem(self.name, shared.stiffness, self.traces, self.rigid)

    def refreshed(self, dofs: Any) -> NoReturn:
        raise NotImplementedError("a remote problem is received anew from its owner")

    @property
    def size(self) -> int:
        return len(self.load)

    @property
    def nodal_trace(self) -> scipy.sparse.csr_matrix:
        trace = self.dofs.space.columns(nodal_operator(self.traces))
        return trace if self.kept is None else trace[:, self.kept]

    @property
    def nodal_offset(self) -> Floats:
        return self.dofs.space.prescribed(nodal_operator(self.traces))

    def correct(self, phi: Mapping[int, Floats], residual: Floats, scale: float) -> Floats:
        raise self._elsewhere()

    def robin_solver(self, phi: Mapping[int, Floats]) -> Solver:
        raise self._elsewhere()

    def low_modes(self, phi: Mapping[int, Floats], below: float) -> Floats:
        raise self._elsewhere()

    def start(self, normal_displacement: Mapping[int, Floats]) -> Floats:
        raise self._elsewhere()

    def restrict(self, u: Floats) -> Floats:
        y = self.dofs.restrict(u)
        return y if self.kept is None else y[self.kept]

    def displacement(self, y: Floats) -> Floats:
        raise self._elsewhere()

    def seen(self, y: Floats, operator: scipy.sparse.csr_matrix) -> Floats | None:
        if self.kept is None:
            return operator @ self.dofs.displacement(y)
        return seen_from(self.dofs, self.kept, y, operator)

    def fields(self, y: Floats, deformation: Floats) -> Fields:
        raise self._elsewhere()

    def _elsewhere(self) -> RuntimeError:
        return RuntimeError(f"body {self.name!r} is solved by the rank that holds it")
