"""Speed against error in space: CPU seconds and memory for the pressure over a dimple between two blocks.

Every measurement is a process of its own, on one thread, from the ends of the cells to the pressure, without imports
and compilation. The bodies have nothing in common that could be shared. The error is the relative L2 error of the
pressure against the semi-analytic reference. NGSolve solves the same problem with the same cells, law and stopping rule
where it can be imported, with what an expert would put together: cells condensed, one factor by CHOLMOD (scikit-sparse)
or one algebraic multigrid (pyamg) for each body, and conjugate gradients.
"""

from __future__ import annotations

import importlib.util
import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from dimple import TOLERANCE, Cells, scene
from matplotlib.figure import Figure
from own_process import in_own_process
from results import Report

import contactdd as cd

CASES = (
    *("Q:1:8:4:1", "Q:1:16:8:1", "Q:1:24:12:1", "Q:1:32:16:1", "Q:2:8:3:1.7", "Q:2:16:4:1.7"),
    *("Q:3:6:2:2", "Q:3:10:3:2", "Q:4:6:2:2", "Q:4:8:3:2", "P:2:8:4:1.5", "P:2:16:6:1.5"),
)
QUICK = ("Q:1:4:2:1", "Q:1:8:4:1", "Q:2:4:2:1.7")
#: The solvers, and the packages that each needs beside contactdd.
SOLVERS = {
    "contactdd, auto": (),
    "contactdd, condensed": (),
    "contactdd, multigrid": (),
    "NGSolve, sparsecholesky": ("ngsolve",),
    "NGSolve, cholmod": ("ngsolve", "sksparse"),
    "NGSolve, pyamg": ("ngsolve", "pyamg"),
}
LEVELS = (1.5e-2, 5e-3, 3e-3, 1.5e-3, 1e-3, 5e-4, 3e-4, 2e-4)


def solved(cells: Cells, solver: str) -> tuple[np.ndarray, np.ndarray, np.ndarray, int, int]:
    """Points (n, 2) of the contact, their areas and pressures; the unknowns and Newton steps."""
    package, way = solver.split(", ")
    if package == "NGSolve":
        from peers import dimple_with_ngsolve

        return dimple_with_ngsolve.solved(cells, way)
    made = scene(cells)
    solution = cd.solve(made, tolerance=TOLERANCE, local_solver=way)
    contact = solution.contact(degree=2 * cells.degree + 8)
    unknowns = sum(body.dofs for body in made.bodies)
    return contact.x[:, :2], contact.weights, contact.pressure, unknowns, solution.iterations


def case(name: str, solver: str) -> dict[str, Any]:
    """One measurement in this process."""
    from peak_memory import forget_peak, peak_mb

    cells = Cells.named(name)
    solved(Cells(cells.kind, cells.degree, 2, 1, 1.0), solver)  # compiles
    before, began = forget_peak(), time.process_time()
    x, weights, pressure, unknowns, steps = solved(cells, solver)
    seconds, peak = time.process_time() - began, peak_mb() - before
    exact = cd.reference.dimple(points=512).pressure(*x.T)
    return {
        "cells": name,
        "solver": solver,
        "unknowns": unknowns,
        "steps": steps,
        "cpu_seconds": seconds,
        "peak_mb": peak,
        "error": float(np.sqrt(weights @ (pressure - exact) ** 2 / (weights @ exact**2))),
    }


def there() -> list[str]:
    """The solvers whose packages can be imported."""
    found = []
    for solver, packages in SOLVERS.items():
        missing = [package for package in packages if importlib.util.find_spec(package) is None]
        if missing:
            print(f"{solver}: left out, as {' and '.join(missing)} cannot be imported")
        else:
            found.append(solver)
    return found


def level_table(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The fewest CPU seconds to every error level, by solver, and the share of `auto` of the best peer's."""
    table = []
    for level in LEVELS:
        reached: dict[str, list[float]] = {}
        for row in rows:
            if row["error"] <= level:
                reached.setdefault(row["solver"], []).append(row["cpu_seconds"])
        best = {solver: min(seconds) for solver, seconds in reached.items()}
        peers = [seconds for solver, seconds in best.items() if not solver.startswith("contactdd")]
        ours = best.get("contactdd, auto")
        table.append({"error": level, "seconds": best, "share": ours / min(peers) if ours and peers else None})
    return table


def print_levels(table: list[dict[str, Any]]) -> None:
    print("\nfewest CPU seconds to an error of the pressure\n")
    for row in table:
        seconds = ", ".join(f"{solver} {value:.2f}" for solver, value in row["seconds"].items())
        print(f"{row['error']:.1e}: {seconds}" + (f"; share {row['share']:.2f}" if row["share"] else ""))


def draw(rows: list[dict[str, Any]], path: Path) -> None:
    """The error against CPU seconds and against memory."""
    figure = Figure(figsize=(9, 4), layout="constrained")
    both = figure.subplots(1, 2, sharey=True)
    for solver in dict.fromkeys(row["solver"] for row in rows):
        family = sorted((row for row in rows if row["solver"] == solver), key=lambda row: row["cpu_seconds"])
        style: dict[str, Any] = {"marker": "o" if solver.startswith("contactdd") else "x", "ls": "", "ms": 5}
        for axes, what in zip(both, ("cpu_seconds", "peak_mb"), strict=True):
            axes.loglog([row[what] for row in family], [row["error"] for row in family], label=solver, **style)
    both[0].set(xlabel="CPU seconds", ylabel="relative L2 error of the pressure")
    both[1].set_xlabel("peak memory, MB")
    for axes in both:
        axes.grid(alpha=0.3, which="both")
    both[0].legend(frameon=False, fontsize=8)
    figure.savefig(path, dpi=150)


def main(arguments: list[str] | None = None) -> None:
    report = Report(__file__, __doc__, arguments, quick="small cells only")
    rows, solvers = [], there()
    print(f"{'cells':14} {'solver':24} {'unknowns':>8} {'steps':>5} {'CPU s':>8} {'peak MB':>8} {'error':>8}")
    for name in QUICK if report.quick else CASES:
        for solver in solvers:
            row = in_own_process(__file__, name, solver)
            rows.append(row)
            print(
                f"{name:14} {solver:24} {row['unknowns']:8} {row['steps']:5} {row['cpu_seconds']:8.2f} "
                f"{row['peak_mb']:8.1f} {row['error']:8.1e}",
                flush=True,
            )
    table = level_table(rows)
    print_levels(table)
    draw(rows, report.path("speed_in_space.png"))
    report.summary({"measurements": rows, "levels": table})


if __name__ == "__main__":
    if sys.argv[1:2] == ["--case"]:
        print(json.dumps(case(sys.argv[2], sys.argv[3])))
    else:
        main()
