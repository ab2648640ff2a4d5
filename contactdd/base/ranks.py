"""Bodies on MPI ranks: which rank holds which body, and what passes between them.

Every rank knows all contacts. A body is assembled, factored and condensed by the rank that owns it, or by several
together; its matrices stay and are applied there, as its solves are. What all ranks see of it are its unknowns and the
traces of these at its contacts.

All that passes between the ranks is one kind of message, gathered from all by all. So whatever a rank is waiting for,
it can be told there that another one has failed: see `Ranks.together`.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, TypeVar

import numpy as np
from mpi4py import MPI

T = TypeVar("T")


#: The kind of message of a rank that has failed, instead of the one expected.
FAILED = "failed"


class Ranks:
    """The owners of the bodies on a communicator: one rank for each body, or a team of several where there are more
    ranks than bodies.

    work: of each body, in any unit. teams: the ranks that hold each body, the first of them speaks for it. interrupted:
    set to end all ranks by KeyboardInterrupt when they next meet.
    """

    #: In how many `together` in one another this process is, of whatever scenes.
    depth = 0

    def __init__(self, comm: MPI.Comm, work: Sequence[float]) -> None:
        self.comm = comm
        #: Whether there is only one rank.
        self.alone = comm.size == 1
        self.interrupted = False
        if comm.size > 1:
            _refuse_other_work(comm, work)
        self.teams = deal_out(comm.size, work)
        self._team: MPI.Comm = MPI.COMM_SELF
        if comm.size > len(work):
            body_index = next(i for i, team in enumerate(self.teams) if comm.rank in team)
            self._team = comm.Split(body_index, comm.rank)

    def owns(self, body_index: int) -> bool:
        """Whether this rank holds a body."""
        return self.comm.rank in self.teams[body_index]

    def speaks(self, body_index: int) -> bool:
        """Whether this rank is the one that tells the others of a body."""
        return self.teams[body_index][0] == self.comm.rank

    def team(self, body_index: int) -> MPI.Comm:
        """The ranks that hold a body; to be asked by one of them."""
        return self._team if len(self.teams[body_index]) > 1 else MPI.COMM_SELF

    @contextmanager
    def together(self) -> Iterator[None]:
        """A block that all ranks finish or none: an exception of one of them, wherever it comes from, is raised on all.

        It costs one exchange at the end; nothing on a single rank.
        """
        if self.alone:
            yield
            return
        Ranks.depth += 1
        try:
            yield
            self._gathered("end", None)
        except _EndedElsewhere as end:
            if end.depth < Ranks.depth:  # the other has left what is around this, too
                raise
            if end.depth > Ranks.depth:  # the other has still to leave this
                self._tell(end.error)
            raise end.error from None
        except BaseException as error:
            self._tell(error)
            raise
        finally:
            Ranks.depth -= 1

    def _tell(self, error: BaseException) -> None:
        """Tell the other ranks that this one has failed: wherever they are, they are waiting for its message."""
        self.comm.allgather((FAILED, Ranks.depth, None, _portable(error)))

    def gather(self, value: T) -> list[T]:
        """The values of all ranks, in their order."""
        return [value] if self.alone else self._gathered("gather", value)

    def each(self, make: Callable[[int], T]) -> list[T]:
        """make(body_index) of all bodies, each made by its team, for all ranks; an error of one is raised on all."""
        bodies = range(len(self.teams))
        if self.alone:
            return [make(body_index) for body_index in bodies]
        made: list[tuple[int, Any]] = []
        failed: Exception | None = None
        try:
            made = [(body_index, make(body_index)) for body_index in bodies if self.owns(body_index)]
        except Exception as error:
            failed = error
        spoken = [(body_index, value) for body_index, value in made if self.speaks(body_index)]
        gathered = self._gathered("each", spoken, failed)
        return [value for _, value in sorted((pair for part in gathered for pair in part), key=lambda pair: pair[0])]

    def by_owner(self, body_index: int, make: Callable[[], T]) -> T:
        """The value of a body made by its owner, on all ranks; an error of it is raised on all."""
        return self._from(self.teams[body_index][0], make)

    def once(self, make: Callable[[], T]) -> T:
        """The value made by the first rank, on all ranks; an error of it is raised on all."""
        return self._from(0, make)

    def _from(self, rank: int, make: Callable[[], T]) -> T:
        """The value made by one rank, on all."""
        if self.alone:
            return make()
        made: Any = None
        failed: Exception | None = None
        if self.comm.rank == rank:
            try:
                made = make()
            except Exception as error:
                failed = error
        return self._gathered("once", made, failed)[rank]

    def written(self, write: Callable[[], list[T]]) -> list[T]:
        """What all ranks have written, those of the first rank first; an error of one is raised on all."""
        with self.together():
            return [each for part in self.gather(write()) for each in part]

    def any_says(self, reason: str) -> str:
        """The first text of all ranks that is not empty, "" if there is none. Collective."""
        return reason if self.alone else next(filter(None, self.gather(reason)), "")

    def agree(self, value: T) -> T:
        """The first rank's value: what is decided by rounding must be decided once."""
        return value if self.alone else self._gathered("agree", value if self.comm.rank == 0 else None)[0]

    def _gathered(self, kind: str, value: Any, failed: Exception | None = None) -> list[Any]:
        """The values of all ranks, in their order. All ask for the same kind; an error is raised on all."""
        if self.interrupted:
            self.interrupted = False
            raise KeyboardInterrupt
        messages = self.comm.allgather((kind, Ranks.depth, value, failed and _portable(failed)))
        for one, depth, _, error in messages:
            if one == FAILED:
                raise _EndedElsewhere(error, depth)
        positions = [message[:2] for message in messages]
        if any(position != positions[0] for position in positions):
            error = RuntimeError(f"the ranks have gone different ways, {positions}; expected the same solves on all")
            raise _EndedElsewhere(error, min(depth for _, depth in positions))
        for *_, error in messages:
            if error is not None:
                raise error
        return [value for *_, value, _ in messages]


class _EndedElsewhere(BaseException):
    """Another rank has failed; no exception that what runs here could handle.

    Attributes: `error`, the other's; `depth`, the number of `Ranks.together` in one another that it has left from.
    """

    def __init__(self, error: BaseException, depth: int) -> None:
        super().__init__(error)
        self.error, self.depth = error, depth


def _portable(error: BaseException) -> BaseException:
    """The same error, or one that says the same where it cannot be sent."""
    try:
        if type(pickle.loads(pickle.dumps(error))) is type(error):
            return error
    except Exception:
        pass
    return RuntimeError(f"{type(error).__name__}: {error}")


def _refuse_other_work(comm: MPI.Comm, work: Sequence[float]) -> None:
    """Refuse scenes whose bodies are others on other ranks: they would be dealt out in different ways."""
    found = comm.allgather(list(work))
    if any(other != found[0] for other in found):
        raise ValueError(f"bodies: their degrees of freedom on each rank are {found}; expected the same scene on all")


def deal_out(ranks: int, work: Sequence[float]) -> list[list[int]]:
    """The ranks that hold each body.

    With no more ranks than bodies, the bodies go, the largest first, to whoever has least to do; with more, every body
    has one rank and the others join where there is most work for each.
    """
    bodies = len(work)
    teams: list[list[int]] = [[] for _ in range(bodies)]
    if ranks <= bodies:
        load = np.zeros(ranks)
        for body in np.argsort(work, kind="stable")[::-1]:
            rank = int(np.argmin(load))
            teams[body] = [rank]
            load[rank] += work[body]
        return teams
    for rank in range(ranks):
        body = rank if rank < bodies else int(np.argmax([w / len(team) for w, team in zip(work, teams, strict=True)]))
        teams[body].append(rank)
    return teams
