"""The choice of a local solver for each body, and the local problems of a scene: made once, kept, refreshed.

A local solver is a function of a `LocalTask` that makes a `LocalProblem`. The registry is open: `register_local_solver`
adds one by name, and a body may bring its own, `Body(..., local_solver=make)`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from copy import copy
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ..base.arrays import Floats
from ..base.ranks import Ranks
from ..base.spectral import SpectralStiffness
from ..interface.discretise import Interface, InterfaceSide
from .assembled import AssembledProblem
from .condensed import CondensedProblem
from .copies import originals
from .cost import Choice, cheapest_solver
from .discrete import DiscreteBody
from .memory import refuse_if_too_large
from .meshless import MeshlessProblem
from .multigrid import MultigridProblem
from .problem import LocalProblem
from .remote import CollectiveOperator, RemoteProblem, SharedProblem
from .spectral import SpectralProblem
from .task import LocalTask

#: Bodies above which memory counts.
MANY = 16
#: The kind of a problem that a body makes itself.
OWN = "own"
#: Makes the local problem of a body.
LocalSolver = Callable[[LocalTask], LocalProblem]


def _assembled(task: LocalTask) -> LocalProblem:
    refuse_if_too_large(task.body)
    return AssembledProblem(task)


def _meshless(task: LocalTask) -> LocalProblem:
    """The problem of a body without a mesh: by dense algebra, or by transforms where its stiffness is spectral."""
    stiffness = task.body.stiffness()
    return SpectralProblem(task, stiffness) if isinstance(stiffness, SpectralStiffness) else MeshlessProblem(task)


#: The local solvers by name.
LOCAL_SOLVERS: dict[str, LocalSolver] = {
    "condensed": CondensedProblem,
    "assembled": _assembled,
    "multigrid": MultigridProblem,
}


def register_local_solver(name: str, make: LocalSolver) -> None:
    """Add a local solver, to be asked for by its name: `cd.solve(scene, local_solver=name)`.

    Args:
        name: A new name.
        make: A function of a `LocalTask` (a body, its sides of the contacts, its finite elements) to a `LocalProblem`.

    Raises:
        ValueError: The name is taken.
        TypeError: `name` is no text or `make` no function.
    """
    if not isinstance(name, str) or not name:
        raise TypeError(f"name = {name!r}: expected a text")
    if not callable(make):
        raise TypeError(f"make = {make!r}: expected a function of a LocalTask")
    if name == "auto" or name in LOCAL_SOLVERS:
        raise ValueError(f"name = {name!r}: there is a local solver of that name")
    LOCAL_SOLVERS[name] = make


class LocalSolvers:
    """The local problems of a scene's bodies, of every kind that was asked for.

    Args:
        bodies: The bodies.
        interfaces: The discretised contacts between them.
        ranks: Which rank holds which body.
    """

    def __init__(self, bodies: Sequence[Any], interfaces: Sequence[Interface], ranks: Ranks) -> None:
        self._bodies, self._ranks = bodies, ranks
        self._sides = sides_of_bodies(len(bodies), interfaces)
        self._discrete: dict[int, DiscreteBody] = {}
        self._problems: dict[tuple[str, int], LocalProblem] = {}
        self._choices: dict[int, Choice] = {}
        self._originals = originals(bodies) if ranks.alone else [None] * len(bodies)

    def problems(self, local_solver: str) -> list[LocalProblem]:
        """Every body's local problem, in order.

        Args:
            local_solver: A registered name, or "auto": the one that is estimated to cost less.
        """
        kinds = self._ranks.agree([self._kind(index, local_solver) for index in range(len(self._bodies))])
        if self._ranks.alone:
            return [self._problem(kind, index) for index, kind in enumerate(kinds)]
        return self._dealt_out(kinds)

    @property
    def notes(self) -> list[str]:
        """What was estimated for large bodies whose local solver was chosen here, in words."""
        return [choice.note for choice in self._choices.values() if choice.note]

    def refreshed(self) -> LocalSolvers:
        """The same problems for the present loads and prescribed displacements; all matrices are shared."""
        other = copy(self)
        other._discrete = {index: discrete.refreshed() for index, discrete in self._discrete.items()}
        kept = {key: p for key, p in self._problems.items() if not isinstance(p, RemoteProblem)}
        other._problems = {
            (kind, index): problem.refreshed(other._discrete.get(index)) for (kind, index), problem in kept.items()
        }
        return other

    def shared(self) -> LocalSolvers:
        """The same problems for a scene that differs in its layers only."""
        other = copy(self)
        other._discrete, other._problems = dict(self._discrete), dict(self._problems)
        return other

    def _kind(self, index: int, local_solver: str) -> str:
        """The name under which a body's problem is kept; a body's own local solver has precedence."""
        body, found = self._bodies[index], self._originals[index]
        if body.mesh is None or callable(body.local_solver):
            return OWN
        name = body.local_solver or local_solver
        if name != "auto":
            return name
        return self._choice(index if found is None else found[0]).solver  # a copy is of the same size as its original

    def _choice(self, index: int) -> Choice:
        """The local solver that suits a body and its copies."""
        if index not in self._choices:
            copies = 1 + sum(found is not None and found[0] == index for found in self._originals)
            self._choices[index] = cheapest_solver(self._bodies[index], self._sides[index], copies)
        return self._choices[index]

    def _problem(self, kind: str, index: int) -> LocalProblem:
        """One body's local problem, made when first asked for."""
        if (kind, index) not in self._problems:
            make = (self._bodies[index].local_solver or _meshless) if kind == OWN else LOCAL_SOLVERS[kind]
            self._problems[kind, index] = make(self._task(kind, index))
        return self._problems[kind, index]

    def _dealt_out(self, kinds: Sequence[str]) -> list[LocalProblem]:
        """The problems of the bodies that this rank holds, and of the others the shared parts.

        A body's own local problem is small, and is made by every rank.
        """
        ranks = self._ranks
        missing = any((kind, index) not in self._problems for index, kind in enumerate(kinds))
        if any(ranks.gather(missing)):
            shared = ranks.each(
                lambda index: None if kinds[index] == OWN else SharedProblem.of(self._problem(kinds[index], index))
            )
            for index, part in enumerate(shared):
                if part is not None and not ranks.owns(index):
                    task, owner = self._task(kinds[index], index), ranks.teams[index][0]
                    self._problems[kinds[index], index] = RemoteProblem(task, part, owner, ranks)
        return [self._problem(kind, index) for index, kind in enumerate(kinds)]

    def _task(self, kind: str, index: int) -> LocalTask:
        """The task of a body's local solver."""
        body, ranks = self._bodies[index], self._ranks
        task = LocalTask(body, self._sides[index], None if body.mesh is None else self._discrete_body(index))
        if len(self._bodies) > MANY:
            task = replace(task, crowded=True)
        if not ranks.alone and ranks.owns(index):
            owner = ranks.teams[index][0]
            task = replace(task, comm=ranks.team(index), collective=partial(CollectiveOperator, ranks, owner))
        for other, signs in self._touched_alike(index):
            if (kind, other) in self._problems and task.discrete.space.free is not None:
                return replace(task, original=self._problems[kind, other], signs=signs)
        return task

    def _touched_alike(self, index: int) -> Iterator[tuple[int, Floats]]:
        """The bodies before this one of which it is a copy, touched by contacts on the same surfaces, and the signs."""
        found = self._originals[index]
        if found is None:
            return
        first, signs = found
        surfaces = _touched(self._sides[index])
        for other in range(first, index):
            copied = (first, np.ones_like(signs)) if other == first else self._originals[other]
            if copied is not None and copied[0] == first and _touched(self._sides[other]) == surfaces:
                yield other, signs * copied[1]

    def _discrete_body(self, index: int) -> DiscreteBody:
        """One body without its contacts, made when first asked for; a copy takes over its original's matrices."""
        if index not in self._discrete:
            found = self._originals[index]
            original = None if found is None or found[0] not in self._discrete else (self._discrete[found[0]], found[1])
            if original is not None and original[0].space.free is None:  # tilted supports mix what the signs part
                original = None
            self._discrete[index] = DiscreteBody(self._bodies[index], original)
        return self._discrete[index]


def _touched(sides: Sequence[tuple[int, InterfaceSide]]) -> set[str]:
    """The names of the surfaces at which a body is touched."""
    return {side.surface.surface for _, side in sides}


def sides_of_bodies(count: int, interfaces: Sequence[Interface]) -> list[list[tuple[int, InterfaceSide]]]:
    """The sides of interfaces at which each of the bodies lies, each side with its interface's index."""
    found: list[list[tuple[int, InterfaceSide]]] = [[] for _ in range(count)]
    for index, interface in enumerate(interfaces):
        for side in interface.sides:
            found[side.body].append((index, side))
    return found
