"""One measurement in a process of its own: python -m peers.measure '{"package": …}' prints the numbers as JSON."""

from __future__ import annotations

import importlib
import json
import sys
import time

import numpy as np
from peak_memory import forget_peak, peak_mb

from . import problem

#: How much CPU time the repetitions may take, in seconds, and how many there are at least and at most.
BUDGET, FEWEST, MOST = 0.6, 3, 60


def measure(package: str, way: str, shape: str, degree: int, x: list[float], y: list[float]) -> dict[str, float]:
    """CPU seconds of a first run on two cells and of the best of several on the mesh, peak memory, and the answer."""
    solver = importlib.import_module(f".with_{package}", __package__)
    cold = _timed(solver, way, shape, degree, [0.0, 1.0, 4.0], [0.0, 1.0])[0]  # compiles, and imports what is left
    before = forget_peak()
    answer = _timed(solver, way, shape, degree, x, y)[1]
    peak = peak_mb() - before
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


if __name__ == "__main__":
    print(json.dumps(measure(**json.loads(sys.argv[1]))))
