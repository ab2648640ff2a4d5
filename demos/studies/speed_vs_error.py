"""Speed against error: CPU seconds for the groove's contact pressure to a given accuracy, beside other packages.

Every measurement is a process of its own, on one thread: mesh, assembly, solution and the pressure at nine Gauss points
per facet, without imports and, as kernels are compiled in the first run, the best of several further ones. The error is
the relative L2 error of p(x) against the semi-analytic reference, by the same function for all. NGSolve, scikit-fem and
GetFEM solve the same problem with the same law and gap on the same cells where they can be imported. In contactdd's
scenes the upper body is the lower one's mirror image, and both share what is the same, but for "nothing shared". Last
comes what it costs to ask for an accuracy instead (accuracy_asked.py), on the groove and two more scenes.
"""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import accuracy_asked
import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure
from peers.problem import Grid, graded, uniform
from results import Report

import contactdd as cd

#: How each package is asked: the fastest way first.
WAYS = {
    "contactdd": (
        "coupled, condensed",
        "coupled, condensed, nothing shared",
        "coupled, assembled",
        "coupled, multigrid",
        "decomposed, condensed",
        "decomposed, assembled",
    ),
    "ngsolve": ("pcg", "pcg, cholmod", "newton"),
    "skfem": ("pcg", "newton"),
    "getfem": ("newton",),
}
#: What a way needs beside its package.
NEEDED = {"pcg, cholmod": "sksparse"}
MODULES = {"ngsolve": "NGSolve", "skfem": "scikit-fem", "getfem": "GetFEM"}
#: Error levels of the table.
LEVELS = (1.5e-2, 5e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6)


@dataclass(frozen=True)
class Case:
    """A mesh and an element."""

    grid: Grid
    shape: str
    degree: int

    @property
    def element(self) -> str:
        return ("P" if self.shape == "triangle" else "Q") + str(self.degree)


def cases(quick: bool) -> list[Case]:
    """From a few large cells to the accuracy of 3e-6."""
    if quick:
        return [Case(uniform(32, 16), "triangle", 1), Case(graded(1, 2, 2, 2, 3, 3), "quadrilateral", 4)]
    chosen = [Case(uniform(32 * n, 16 * n), "triangle", 1) for n in (1, 2, 4)]
    chosen += [Case(uniform(16 * n, 8 * n), "triangle", 2) for n in (1, 2, 4)]
    chosen += [Case(uniform(8 * n, 2 * n), "quadrilateral", p) for p in (2, 3, 4) for n in (1, 2, 4)]
    chosen += [Case(graded(5 * n, 8 * n, 10 * n, 8 * n, 1 + 0.25 / n, 1 + 0.5 / n), "triangle", 1) for n in (1, 2)]
    chosen += [Case(graded(2, 4, 5, 4, 1.7, 2), "triangle", 2), Case(graded(2, 4, 4, 3, 2, 2), "triangle", 4)]
    chosen += [Case(uniform(4, 1), "quadrilateral", 3)]
    chosen += [Case(graded(*layout), "quadrilateral", degree) for degree, layout in HIGH_ORDER]
    return chosen


#: Degree and layout (left, middle, right, layers, ratio, ratio in depth) of graded quadrilaterals: of a hundred those
#: with the smallest error for their number of unknowns, and a few near them.
HIGH_ORDER = (
    (3, (1, 1, 2, 1, 2, 2)),
    (4, (1, 1, 2, 1, 3, 2)),
    (5, (1, 1, 2, 1, 4, 2)),
    (7, (1, 1, 2, 1, 4, 2)),
    (8, (1, 1, 2, 1, 4, 2)),
    (6, (1, 1, 2, 2, 5, 3)),
    (4, (1, 2, 3, 2, 2, 3)),
    (5, (1, 2, 3, 2, 3, 4)),
    (6, (1, 2, 3, 2, 3, 4)),
    (6, (2, 3, 3, 2, 3, 4)),
    (7, (1, 2, 3, 2, 3, 4)),
    (7, (2, 3, 3, 2, 3, 4)),
    (8, (2, 3, 3, 2, 3, 4)),
)


def configurations(quick: bool) -> Iterator[tuple[str, str, Case]]:
    """Package, way and case of every measurement."""
    for package, ways in WAYS.items():
        if package in MODULES and importlib.util.find_spec(package) is None:
            print(f"{MODULES[package]} is not installed here, and left out")
            continue
        there = [way for way in ways if way not in NEEDED or importlib.util.find_spec(NEEDED[way]) is not None]
        for case in cases(quick):
            for way in there:
                if not too_slow(package, way, case):
                    yield package, way, case


def too_slow(package: str, way: str, case: Case) -> bool:
    """Whether a measurement would take many seconds and be no rival to the others."""
    facets = (len(case.grid.x) - 1) * case.degree
    if "assembled" in way:  # refactors in every step
        return facets > 64
    if "multigrid" in way:  # for large solids; here it only shows what it costs
        return facets > 64 or case.degree > 2
    if package == "getfem":
        return facets > 72 or case.degree > 6
    return package == "skfem" and (case.degree > 6 or facets > (128 if way == "newton" else 256))


def measure(package: str, way: str, case: Case) -> dict[str, Any]:
    """One measurement, in a process of its own."""
    question = {
        "package": package,
        "way": way,
        "shape": case.shape,
        "degree": case.degree,
        "x": case.grid.x.tolist(),
        "y": case.grid.y.tolist(),
    }
    here = Path(__file__).parent
    paths = [str(here), str(here.parents[1]), os.environ.get("PYTHONPATH", "")]
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    done = subprocess.run(
        [sys.executable, "-m", "peers.measure", json.dumps(question)],
        env={**os.environ, **threads, "PYTHONPATH": os.pathsep.join(filter(None, paths))},
        capture_output=True,
        text=True,
    )
    if done.returncode != 0:
        raise RuntimeError(f"{package}, {way}, {case.grid.name}:\n{done.stderr}")
    numbers = json.loads(done.stdout.splitlines()[-1])
    return {
        "solver": f"{MODULES.get(package, package)}, {way}",
        "element": case.element,
        "mesh": case.grid.name,
        "unknowns": numbers["unknowns"],
        "cpu_seconds": numbers["cpu_seconds"],
        "cold_seconds": numbers["cold_seconds"],
        "peak_mb": numbers["peak_mb"],
        "error_l2": pressure_error(case.grid, np.array(numbers["pressure"])),
    }


def pressure_error(grid: Grid, pressure: np.ndarray) -> float:
    """The relative L2 error of the pressure at `Grid.points`."""
    x, weights = grid.points
    exact = cd.reference.groove().pressure(x)
    return float(np.sqrt(weights @ (pressure - exact) ** 2 / (weights @ exact**2)))


def fastest(rows: list[dict[str, Any]], level: float, solver: str) -> dict[str, Any] | None:
    """The fastest measurement that reaches an error level, of the solver of that name or of all of "contactdd"."""
    named = (row for row in rows if row["solver"] == solver or row["solver"].startswith(f"{solver}, coupled"))
    reached = [row for row in named if row["error_l2"] <= level]
    return min(reached, key=lambda row: row["cpu_seconds"], default=None)


def level_table(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The fastest CPU seconds to every error level, by solver, and contactdd's share of the best peer's."""
    peers = dict.fromkeys(row["solver"] for row in rows if not row["solver"].startswith("contactdd"))
    solvers = ["contactdd", "contactdd, coupled, condensed, nothing shared", *peers]
    table = []
    for level in LEVELS:
        best = {solver: fastest(rows, level, solver) for solver in solvers}
        seconds = {solver: row["cpu_seconds"] if row else None for solver, row in best.items()}
        there = [seconds[peer] for peer in peers if seconds[peer] is not None]
        ratio = seconds["contactdd"] / min(there) if there and seconds["contactdd"] else None
        table.append({"error": level, "seconds": seconds, "ratio": ratio})
    return table


def print_levels(table: list[dict[str, Any]]) -> None:
    print("\nfastest CPU milliseconds to an error of p(x), and contactdd's share of the best peer's\n")
    solvers = list(table[0]["seconds"])
    print("| error ≤ | " + " | ".join(solvers) + " | share |")
    print("|---|" + "---|" * (len(solvers) + 1))
    for row in table:
        cells = ["–" if value is None else f"{1e3 * value:.1f}" for value in row["seconds"].values()]
        share = "–" if row["ratio"] is None else f"{row['ratio']:.2f}"
        print(f"| {row['error']:.1e} | " + " | ".join(cells) + f" | {share} |")


def draw(rows: list[dict[str, Any]], path: Path) -> None:
    """CPU seconds against the error: a line along the fastest of each solver, faint points for the others."""
    figure = Figure(figsize=(8, 5.6), layout="constrained")
    axes = figure.subplots()
    colors = colormaps["tab20"].colors  # in pairs of a dark and a light one
    axes.set_prop_cycle(color=colors[::2] + colors[1::2])
    for solver in dict.fromkeys(row["solver"] for row in rows):
        ours = solver.startswith("contactdd")
        points = sorted((row["error_l2"], row["cpu_seconds"]) for row in rows if row["solver"] == solver)
        front = [point for i, point in enumerate(points) if all(point[1] < other[1] for other in points[:i])]
        (line,) = axes.loglog(*zip(*front, strict=True), "o-" if ours else "s--", markersize=4, label=solver)
        axes.loglog(*zip(*points, strict=True), "." if ours else "x", alpha=0.25, color=line.get_color())
    axes.set_xlabel("relative L2 error of p(x)")
    axes.set_ylabel("CPU seconds")
    axes.invert_xaxis()
    axes.grid(alpha=0.3, which="both")
    axes.legend(frameon=False, fontsize=8)
    figure.savefig(path, dpi=150)


def main(arguments: list[str] | None = None) -> None:
    report = Report(__file__, __doc__, arguments, quick="two meshes only")
    rows = []
    print(f"{'solver':34} {'element':7} {'mesh':16} {'unknowns':>8} {'CPU ms':>8} {'peak MB':>7} {'error':>8}")
    for package, way, case in configurations(report.quick):
        row = measure(package, way, case)
        rows.append(row)
        print(
            f"{row['solver']:34} {row['element']:7} {row['mesh']:16} {row['unknowns']:8} "
            f"{1e3 * row['cpu_seconds']:8.1f} {row['peak_mb']:7.1f} {row['error_l2']:8.1e}",
            flush=True,
        )
    print_levels(level_table(rows))
    if not report.quick:
        report.path("accuracy_asked.json").write_text(json.dumps(accuracy_asked.table(), indent=1) + "\n")
    draw(rows, report.path("speed_vs_error.png"))
    report.summary(rows)


if __name__ == "__main__":
    main()
