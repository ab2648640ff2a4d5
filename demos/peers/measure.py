"""One measurement in a process of its own: python -m peers.measure '{"package": …}' prints the numbers as JSON."""

from __future__ import annotations

import contextlib
import importlib
import json
import sys
import time
from pathlib import Path

import numpy as np

from . import problem

#: How much CPU time the repetitions may take, in seconds, and how many there are at least and at most.
BUDGET, FEWEST, MOST = 1.5, 3, 15


def measure(package: str, way: str, shape: str, degree: int, x: list[float], y: list[float]) -> dict[str, float]:
    """CPU seconds of the first run and of the best of the following, peak memory, and the answer."""
    solver = importlib.import_module(f".with_{package}", __package__)
    before = _forget_peak()
    cold, answer = _timed(solver, way, shape, degree, x, y)
    peak = _status("VmHWM") - before
    seconds: list[float] = []
    while len(seconds) < FEWEST or (sum(seconds) < BUDGET and len(seconds) < MOST):
        seconds.append(_timed(solver, way, shape, degree, x, y)[0])
    return {
        "cold_seconds": cold,
        "cpu_seconds": min(seconds),
        "median_seconds": float(np.median(seconds)),
        "peak_mb": peak,
        "unknowns": answer.unknowns,
        "steps": answer.steps,
        "pressure": answer.pressure.tolist(),
    }


def _timed(solver, way: str, shape: str, degree: int, x: list[float], y: list[float]) -> tuple[float, problem.Answer]:
    """CPU seconds from the coordinates of the cells to the pressures."""
    began = time.process_time()
    grid = problem.Grid("", np.array(x), np.array(y))
    answer = solver.solve(grid, shape, degree, way)
    return time.process_time() - began, answer


def _forget_peak() -> float:
    """Have Linux measure the peak of this process's memory from now on; the memory now (MB)."""
    with contextlib.suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")
    return _status("VmRSS")


def _status(name: str) -> float:
    """A number of /proc/self/status in MB."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(float(line.split()[1]) for line in lines if line.startswith(name)) / 1024


if __name__ == "__main__":
    print(json.dumps(measure(**json.loads(sys.argv[1]))))
