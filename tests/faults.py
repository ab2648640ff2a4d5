"""Faults at random times in real runs: what was written stays, nothing hangs, no run goes on from a wrong state.

A run is a process of its own. Something happens to it at a random moment; then its checkpoint is read and gone on from,
and the result must be that of a run which nothing happened to. `test_faults.py` draws a handful; many, with a table:

    ./run tests/faults.py --runs 100 --seed 1
"""

from __future__ import annotations

import argparse
import os
import random
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import numpy as np
from under_mpirun import environment, mpirun

import contactdd as cd
from contactdd.iteration.checkpoint import _contents

ROOT = Path(__file__).parents[1]

#: A relaxation with which a run takes more than a hundred iterations.
GAMMA = 0.3
#: Seconds within which a process has to end after a fault.
HANG = 30.0

WORKER = """
import os, sys, time
from pathlib import Path
sys.path.insert(0, str(Path(sys.argv[1]) / "tests"))
import numpy as np
from mpi4py import MPI
import contactdd as cd, faults

root, file, result, pause, fail_rank, fail_at = sys.argv[1:]
comm = MPI.COMM_WORLD

def watch(record):
    if comm.rank == 0:
        print("at", record.iteration, flush=True)
    if comm.rank == int(fail_rank) and record.iteration == int(fail_at):
        raise RuntimeError("a fault of one rank")
    time.sleep(float(pause))

print("pid", comm.rank, os.getpid(), flush=True)
options = dict(gamma=faults.GAMMA, checkpoint=file, checkpoint_every=1e-3, callback=watch)
found = cd.solve(faults.scene(comm), "chord", **options)
if comm.rank == 0:
    np.save(result, found.contact().pressure)
    print("end", found.status, found.iterations, flush=True)
"""


class Fault(AssertionError):
    """A run that lost something, hung or went on from a wrong state."""


def scene(comm: object = None) -> cd.Scene:
    """Two unlike blocks that fit but for a shallow groove, on a given communicator."""
    steel, sides = cd.Isotropic(2.1e5, 0.3), cd.Symmetry("left", "right")
    lower = cd.Body("lower", cd.rectangle((0, 0), (4, 1), (16, 8)), steel, supports=[sides, cd.Symmetry("bottom")])
    upper_mesh = cd.rectangle((0, 1), (4, 2), (12, 6))
    upper = cd.Body("upper", upper_mesh, steel, supports=[sides], loads=[cd.Pressure("top", 10.0)])
    layer = cd.PowerLayer(4e-6, 1.1)
    contact = cd.Contact((lower, "top"), (upper, "bottom"), layer, gap=lambda x: 1e-4 * np.cos(2 * x[0]))
    return cd.Scene([lower, upper], [contact], **({} if comm is None else {"comm": comm}))


@cache
def undisturbed() -> tuple[np.ndarray, int]:
    """The pressures of a run that nothing happens to, and its iterations."""
    found = cd.solve(scene(), "chord", gamma=GAMMA)
    return found.contact().pressure, found.iterations


class Worker:
    """A run in a process of its own, or in several under mpirun."""

    def __init__(
        self, folder: Path, file: Path, name: str = "", ranks: int = 1, fail: tuple[int, int] = (-1, -1), pause=0.003
    ) -> None:
        self.result = folder / f"result{name}.npy"
        self._log = (folder / f"log{name}").open("w+")
        words = [str(ROOT), str(file), str(self.result), str(pause), *map(str, fail)]
        command = [sys.executable, "-c", WORKER, *words]
        self.process = subprocess.Popen(
            mpirun(ranks, *command) if ranks > 1 else command,
            env=environment(folder, ROOT),
            stdout=self._log,
            stderr=subprocess.STDOUT,
            preexec_fn=_as_in_a_terminal,
        )

    def log(self) -> list[str]:
        return Path(self._log.name).read_text().rpartition("\n")[0].splitlines()  # whole lines only

    @property
    def iterations(self) -> int:
        """The last iteration that the user's callback was told of."""
        return max([int(line.split()[1]) for line in self.log() if line.startswith("at ")], default=0)

    def pid(self, rank: int) -> int:
        """The process of a rank, as it tells itself: mpirun may hand that on late, or within a line of the other's."""
        deadline = time.monotonic() + HANG
        while time.monotonic() < deadline:
            if told := re.search(rf"pid {rank} (\d+)\D", Path(self._log.name).read_text()):
                return int(told[1])
            time.sleep(0.002)
        raise Fault(f"rank {rank} does not tell its process: " + " | ".join(self.log()[-5:]))

    def wait_for(self, iteration: int) -> None:
        """Wait until the run is so far, or over."""
        deadline = time.monotonic() + 300
        while self.iterations < iteration and self.process.poll() is None:
            if time.monotonic() > deadline:
                raise Fault("the run did not begin: " + " | ".join(self.log()[-5:]))
            time.sleep(0.002)

    def ended(self) -> int:
        """The exit status, soon."""
        try:
            return self.process.wait(timeout=HANG)
        except subprocess.TimeoutExpired:
            raise Fault(f"hangs for {HANG:g} s: " + " | ".join(self.log()[-5:])) from None

    def finished(self) -> bool:
        return any(line.startswith("end converged") for line in self.log())

    def close(self) -> None:
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self._log.close()


def _as_in_a_terminal() -> None:
    """Signals do what they do by default, also where the tests themselves run in the background."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


def kept(file: Path) -> int:
    """How many iterations the checkpoint holds; 0 where there is none."""
    return len(_contents(file)[1]) if file.exists() else 0


def go_on(file: Path, exact: bool = True) -> None:
    """Go on from a checkpoint and compare with the run that nothing happened to."""
    right, iterations = undisturbed()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = cd.solve(scene(), "chord", gamma=GAMMA, checkpoint=file, resume=True)
    if found.iterations != iterations or not (
        np.array_equal(found.contact().pressure, right)
        if exact
        else np.allclose(found.contact().pressure, right, rtol=1e-9)  # several ranks add in another order
    ):
        raise Fault(f"a wrong resume: {found.iterations} iterations instead of {iterations}")


def refuse_litter(folder: Path) -> None:
    """Refuse what is left lying when all that was interrupted has been gone on with."""
    left = [other.name for other in folder.iterdir() if other.suffix in (".part", ".lock")]
    if left:
        raise Fault(f"left lying: {left}")


def check_result(worker: Worker) -> None:
    """What a run that was not ended found."""
    if not worker.finished() or not np.array_equal(np.load(worker.result), undisturbed()[0]):
        raise Fault("a wrong or lost result: " + " | ".join(worker.log()[-5:]))


def _ended_by(number: int, ranks: int = 1) -> Callable[[Path, random.Random], str]:
    """A run that a signal ends: all that the user was told of, or that was written, is there."""

    def fault(folder: Path, dice: random.Random) -> str:
        file, at = folder / "state.npz", dice.randint(1, 100)
        with closing(Worker(folder, file, ranks=ranks)) as worker:
            worker.wait_for(at)
            time.sleep(dice.uniform(0.0, 0.006))
            told, written = worker.iterations, kept(file)
            worker.process.send_signal(number)
            status = worker.ended()
            if worker.finished():
                return "too late"
            now = kept(file)
        if status == 0:
            raise Fault("ended by a signal as if nothing had been")
        if now < (written if number == signal.SIGKILL else told):
            raise Fault(f"lost: {told} iterations done, {written} written, {now} kept")
        go_on(file, exact=ranks == 1)
        return f"{now} kept of {told}"

    return fault


def killed_rank(folder: Path, dice: random.Random) -> str:
    """One of two ranks is killed: the other ends, and what was written stays."""
    file = folder / "state.npz"
    with closing(Worker(folder, file, ranks=2)) as worker:
        worker.wait_for(dice.randint(1, 60))
        told, written = worker.iterations, kept(file)
        os.kill(worker.pid(dice.randint(0, 1)), signal.SIGKILL)
        status, now = worker.ended(), kept(file)
    if status == 0 or now < written:
        raise Fault(f"status {status}, lost: {written} iterations written, {now} kept")
    go_on(file, exact=False)
    return f"{now} kept of {told}"


def failing_rank(folder: Path, dice: random.Random) -> str:
    """The callback of one of two ranks raises: both end, with the state of that iteration."""
    file, at = folder / "state.npz", dice.randint(1, 60)
    with closing(Worker(folder, file, ranks=2, fail=(dice.randint(0, 1), at))) as worker:
        worker.wait_for(at)
        status, now = worker.ended(), kept(file)
        if status == 0 or not any("a fault of one rank" in line for line in worker.log()):
            raise Fault("not told of: " + " | ".join(worker.log()[-5:]))
    if now != at:
        raise Fault(f"failed in iteration {at}, {now} kept")
    go_on(file, exact=False)
    return f"{now} kept of {at}"


def full_disk(folder: Path, dice: random.Random) -> str:
    """From a random moment on no file can grow: the run goes on to its end, and the last state written stays."""
    file = folder / "state.npz"
    with closing(Worker(folder, file)) as worker:
        worker.wait_for(dice.randint(2, 100))  # from the second on there is a file
        written, size = kept(file), file.stat().st_size
        resource.prlimit(worker.process.pid, resource.RLIMIT_FSIZE, (size, size))  # its history would make it longer
        deadline = time.monotonic() + 120
        while worker.process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.02)
        if worker.ended() != 0:
            raise Fault("lost to a full disk: " + " | ".join(worker.log()[-5:]))
        check_result(worker)
        told = any("not written" in line for line in worker.log())
    now = kept(file)
    if now < written or not (told or now == undisturbed()[1]):
        raise Fault(f"{written} iterations written, {now} kept; told of it: {told}")
    go_on(file)
    return f"{now} kept of {undisturbed()[1]}"


def two_writers(folder: Path, dice: random.Random) -> str:
    """Two runs with one file, one of them killed at a random moment or none: each has a whole state of its own."""
    file = folder / "state.npz"
    with closing(Worker(folder, file, "-1")) as first, closing(Worker(folder, file, "-2")) as second:
        killed = dice.choice([None, first, second])
        if killed is not None:
            killed.wait_for(dice.randint(1, 100))
            killed.process.kill()
        for worker in (first, second):
            worker.wait_for(10**6)
            worker.ended()
            if worker is not killed:
                check_result(worker)
    states = sorted(folder.glob("state*.npz"))
    for state in states:
        go_on(state)
    return f"{len(states)} states"


@contextmanager
def closing(worker: Worker) -> Iterator[Worker]:
    try:
        yield worker
    finally:
        worker.close()


#: The faults by name, and how many of a hundred runs each gets.
FAULTS: dict[str, tuple[Callable[[Path, random.Random], str], int]] = {
    "kill -9": (_ended_by(signal.SIGKILL), 20),
    "SIGTERM": (_ended_by(signal.SIGTERM), 17),
    "SIGINT": (_ended_by(signal.SIGINT), 17),
    "full disk": (full_disk, 15),
    "two writers": (two_writers, 15),
    "exception on a rank": (failing_rank, 6),
    "kill -9 of a rank": (killed_rank, 4),
    "SIGINT to mpirun": (_ended_by(signal.SIGINT, 2), 3),
    "SIGTERM to mpirun": (_ended_by(signal.SIGTERM, 2), 3),
}


def run(name: str, seed: int) -> str:
    """What came of one run, in words. Raises Fault where something was lost, wrong or hung."""
    with tempfile.TemporaryDirectory() as folder:
        told = FAULTS[name][0](Path(folder), random.Random(f"{name} {seed}"))
        refuse_litter(Path(folder))
        return told


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--runs", type=int, default=100)
    arguments.add_argument("--seed", type=int, default=1)
    given = arguments.parse_args()
    names = [name for name, (_, share) in FAULTS.items() for _ in range(share)]
    random.Random(given.seed).shuffle(names)
    good, bad = Counter(), []
    for number in range(given.runs):
        name = names[number % len(names)]
        try:
            print(f"{number + 1:4} {name:20} {run(name, 1000 * given.seed + number)}", flush=True)
            good[name] += 1
        except Exception as error:
            print(f"{number + 1:4} {name:20} FAILED {type(error).__name__}: {error}", flush=True)
            bad.append(name)
    for name in FAULTS:
        print(f"{name:20} {good[name]:4} right {bad.count(name):4} wrong")
    raise SystemExit(bool(bad))


if __name__ == "__main__":
    main()
