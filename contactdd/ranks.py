"""Bodies on MPI ranks: which rank holds which body, and what passes between them.

Every rank knows all meshes and contacts. A body is assembled, factored and condensed by one rank only, and its solves
are done there; what all ranks see of it is its condensed problem, of the size of its contacts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
from mpi4py import MPI

T = TypeVar("T")


class Ranks:
    """The owners of the bodies on a communicator.

    work: of each body, in any unit; the bodies are dealt out, the largest first, to whoever has least to do.
    """

    def __init__(self, comm: MPI.Comm, work: Sequence[float]) -> None:
        self.comm = comm
        load = np.zeros(comm.size)
        self.owners = [0] * len(work)
        for place in np.argsort(work, kind="stable")[::-1]:
            rank = int(np.argmin(load))
            self.owners[place] = rank
            load[rank] += work[place]

    @property
    def alone(self) -> bool:
        """Whether there is only one rank."""
        return self.comm.size == 1

    def owns(self, place: int) -> bool:
        """Whether this rank holds the body."""
        return self.owners[place] == self.comm.rank

    def each(self, make: Callable[[int], T]) -> list[T]:
        """make(place) of every body, each made by its owner, known to all. An error of one rank is raised on all."""
        if self.alone:
            return [make(place) for place in range(len(self.owners))]
        made: list[tuple[int, Any]] = []
        failed: Exception | None = None
        try:
            made = [(place, make(place)) for place in range(len(self.owners)) if self.owns(place)]
        except Exception as error:
            failed = error
        gathered = self.comm.allgather((made, failed))
        for _, error in gathered:
            if error is not None:
                raise error
        return [value for _, value in sorted((pair for part, _ in gathered for pair in part), key=lambda pair: pair[0])]

    def agree(self, value: T) -> T:
        """The first rank's value: what is decided by rounding must be decided once."""
        return value if self.alone else self.comm.bcast(value, root=0)
