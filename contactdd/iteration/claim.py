"""The file that a run writes its state to: never one that is no checkpoint, or that another run writes."""

from __future__ import annotations

import errno
import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path

try:
    import fcntl
except ImportError:  # not a Unix: runs in one folder have to be told apart by the user
    fcntl = None  # type: ignore[assignment]

#: The endings of the names of a lock and of an unfinished file.
LOCK, PART = ".lock", re.compile(r"\.\d+-[0-9a-f]{8}\.part")


class Claim:
    """A file that this run alone writes, until `release`.

    path: the file; refused: why it is another than the one asked for, or nothing.
    """

    def __init__(self, path: Path, lock: int | None, refused: str) -> None:
        self.path, self.refused = path, refused
        self._lock = lock
        if lock is not None:
            _remove_unfinished(path)

    def release(self) -> None:
        """Let others write the file."""
        if self._lock is not None:
            _unlock(self.path, self._lock)
        self._lock = None


def claim(path: Path, foreign: Callable[[Path], str]) -> Claim:
    """The file, or the first of file-2, file-3, … that nothing speaks against.

    foreign: what speaks against writing over a file that is there, in words, or nothing.
    """
    refused = ""
    for candidate in _candidates(path):
        free, lock = _lock(candidate)
        reason = foreign(candidate) if free else "another run writes it"
        if not reason:
            return Claim(candidate, lock, refused)
        if lock is not None:
            _unlock(candidate, lock)
        refused = refused or reason
    raise AssertionError  # there are always more


def _candidates(path: Path) -> Iterator[Path]:
    path = Path(os.path.realpath(path))  # a link stays one
    yield path
    number = 2
    while True:
        yield path.with_name(f"{path.stem}-{number}{path.suffix}")
        number += 1


def _lock(path: Path) -> tuple[bool, int | None]:
    """Whether nobody else writes the file, and the lock; None where the file system has no locks."""
    name = path.with_name(path.name + LOCK)
    while fcntl is not None:
        try:
            lock = os.open(name, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
        except OSError:
            break
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if _is(name, lock):
                return True, lock
        except OSError as error:
            if error.errno in (errno.EWOULDBLOCK, errno.EACCES):
                os.close(lock)
                return False, None
            os.close(lock)
            break
        os.close(lock)  # who held it has just removed it
    return True, None


def _unlock(path: Path, lock: int) -> None:
    name = path.with_name(path.name + LOCK)
    if _is(name, lock) and os.fstat(lock).st_size == 0:  # a file of that name with something in it isn't ours
        name.unlink()
    os.close(lock)


def _is(name: Path, file: int) -> bool:
    """Whether an open file still has that name."""
    try:
        return os.path.samestat(os.stat(name), os.fstat(file))
    except OSError:
        return False


def _remove_unfinished(path: Path) -> None:
    """Remove what a run that was killed while it wrote has left."""
    for other in path.parent.iterdir():
        if other.name.startswith(path.name) and PART.fullmatch(other.name[len(path.name) :]):
            other.unlink(missing_ok=True)
