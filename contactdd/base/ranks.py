"""Bodies on MPI ranks: which rank holds which body, and what passes between them.

Every rank knows all meshes and contacts. A body is assembled, factored and condensed by the rank that owns it, or by
several together, and its solves are done there; what all ranks see of it is its condensed problem, of the size of its
contacts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
from mpi4py import MPI

T = TypeVar("T")


class Ranks:
    """The owners of the bodies on a communicator: one rank for each body, or a team of several where there are more
    ranks than bodies.

    work: of each body, in any unit. teams: the ranks that hold each body, the first of them speaks for it.
    """

    def __init__(self, comm: MPI.Comm, work: Sequence[float]) -> None:
        self.comm = comm
        self.teams = deal_out(comm.size, work)
        self._team: MPI.Comm = MPI.COMM_SELF
        if comm.size > len(work):
            place = next(place for place, team in enumerate(self.teams) if comm.rank in team)
            self._team = comm.Split(place, comm.rank)

    @property
    def alone(self) -> bool:
        """Whether there is only one rank."""
        return self.comm.size == 1

    def owns(self, place: int) -> bool:
        """Whether this rank holds the body."""
        return self.comm.rank in self.teams[place]

    def team(self, place: int) -> MPI.Comm:
        """The ranks that hold a body; to be asked by one of them."""
        return self._team if len(self.teams[place]) > 1 else MPI.COMM_SELF

    def each(self, make: Callable[[int], T]) -> list[T]:
        """make(place) of every body, each made by its team, known to all. An error of one rank is raised on all."""
        places = range(len(self.teams))
        if self.alone:
            return [make(place) for place in places]
        made: list[tuple[int, Any]] = []
        failed: Exception | None = None
        try:
            made = [(place, make(place)) for place in places if self.owns(place)]
        except Exception as error:
            failed = error
        spoken = [(place, value) for place, value in made if self.teams[place][0] == self.comm.rank]
        gathered = self.comm.allgather((spoken, failed))
        for _, error in gathered:
            if error is not None:
                raise error
        return [value for _, value in sorted((pair for part, _ in gathered for pair in part), key=lambda pair: pair[0])]

    def once(self, make: Callable[[], T]) -> T:
        """What the first rank makes, known to all; an error of it is raised on all."""
        if self.alone:
            return make()
        made: tuple[Any, Exception | None] = (None, None)
        if self.comm.rank == 0:
            try:
                made = (make(), None)
            except Exception as error:
                made = (None, error)
        value, failed = self.comm.bcast(made, root=0)
        if failed is not None:
            raise failed
        return value

    def agree(self, value: T) -> T:
        """The first rank's value: what is decided by rounding must be decided once."""
        return value if self.alone else self.comm.bcast(value, root=0)


def deal_out(ranks: int, work: Sequence[float]) -> list[list[int]]:
    """The ranks that hold each body.

    With no more ranks than bodies, the bodies go, the largest first, to whoever has least to do; with more, every body
    has one rank and the others join where there is most work for each.
    """
    bodies = len(work)
    teams: list[list[int]] = [[] for _ in range(bodies)]
    if ranks <= bodies:
        load = np.zeros(ranks)
        for place in np.argsort(work, kind="stable")[::-1]:
            rank = int(np.argmin(load))
            teams[place] = [rank]
            load[rank] += work[place]
        return teams
    for rank in range(ranks):
        place = rank if rank < bodies else int(np.argmax([w / len(team) for w, team in zip(work, teams, strict=True)]))
        teams[place].append(rank)
    return teams
