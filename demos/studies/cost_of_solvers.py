"""What condensing a solid and solving it by multigrid cost, fitted: the model by which `local_solver="auto"` chooses.

Two blocks with a dimple between them are solved in both ways with cells of several degrees; powers of the unknowns n of
a body and of the cubes w of its cells' unknowns, per unknown, are fitted to the CPU seconds per body. The constants
printed are those of `contactdd/local/cost.py`.
"""

from __future__ import annotations

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
from contactdd.local.cost import CLEARLY, Size, condensing_seconds, dense_seconds, multigrid_seconds

CASES = (
    *("Q:1:12:6:1", "Q:1:16:8:1", "Q:1:20:10:1", "Q:1:24:12:1", "Q:1:28:14:1"),
    *("Q:2:8:3:1.7", "Q:2:12:4:1.7", "Q:2:16:4:1.7", "Q:3:6:2:2", "Q:3:8:3:2", "Q:4:6:2:2"),
    *("P:1:16:8:1", "P:1:24:10:1", "P:2:8:4:1.5", "P:2:12:5:1.5"),
)
QUICK = ("Q:1:6:3:1", "Q:1:8:4:1", "Q:2:4:2:1.7", "P:2:4:2:1.5")
SOLVERS = ("condensed", "multigrid")
#: Unknowns of a body up to which what costs the same for all counts too much for a fit.
SMALL = 4000


def case(name: str, local_solver: str) -> dict[str, Any]:
    """One measurement in this process: CPU seconds per body, without imports and compilation."""
    cells = Cells.named(name)
    cd.solve(scene(Cells(cells.kind, cells.degree, 2, 1, 1.0)), tolerance=TOLERANCE, local_solver=local_solver)
    began = time.process_time()
    made = scene(cells)
    solution = cd.solve(made, tolerance=TOLERANCE, local_solver=local_solver)
    seconds = (time.process_time() - began) / 2
    found = Size.of(made.bodies[0], [(0, made.interfaces[0].sides[0])])
    return {
        "cells": name,
        "local_solver": local_solver,
        "cpu_seconds": seconds,
        "unknowns": found.unknowns,
        "cubes": found.cubes,
        "touched": found.touched,
        "steps": solution.iterations,
    }


def fitted(rows: list[dict[str, Any]], both: bool) -> list[float]:
    """The constants c of seconds = exp(c₀) n^c₁ w^c₂; both: whether w counts."""
    n, w = (np.log([row[what] for row in rows]) for what in ("unknowns", "cubes"))
    columns = [np.ones_like(n), n, w] if both else [np.ones_like(n), n]
    return np.linalg.lstsq(np.column_stack(columns), np.log([row["cpu_seconds"] for row in rows]), rcond=None)[
        0
    ].tolist()


def size(row: dict[str, Any]) -> Size:
    return Size(row["unknowns"], row["cubes"], row["touched"])


def compared(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """By cells: what was measured, what `auto` estimates, and how much slower its choice is than the better one."""
    found = []
    for name in dict.fromkeys(row["cells"] for row in rows):
        condensed, multigrid = (next(r for r in rows if (r["cells"], r["local_solver"]) == (name, s)) for s in SOLVERS)
        seconds = condensed["cpu_seconds"], multigrid["cpu_seconds"]
        one = size(condensed)
        estimates = condensing_seconds(one) + dense_seconds(one), multigrid_seconds(one)
        chosen = seconds[int(estimates[1] < CLEARLY * estimates[0])]
        found.append(
            {
                "cells": name,
                "unknowns": condensed["unknowns"],
                **dict(zip(SOLVERS, seconds, strict=True)),
                **dict(zip(("estimate condensed", "estimate multigrid"), estimates, strict=True)),
                "loss": chosen / min(seconds) - 1,
            }
        )
    return found


def draw(rows: list[dict[str, Any]], path: Path) -> None:
    """The measured seconds against the estimated ones."""
    figure = Figure(figsize=(4.6, 4.2), layout="constrained")
    axes = figure.subplots()
    for solver in SOLVERS:
        axes.loglog([r[f"estimate {solver}"] for r in rows], [r[solver] for r in rows], "o", ms=4, label=solver)
    ends = [min(r[s] for r in rows for s in SOLVERS), max(r[s] for r in rows for s in SOLVERS)]
    axes.loglog(ends, ends, "k-", lw=0.8)
    axes.set(xlabel="estimated CPU seconds per body", ylabel="measured")
    axes.legend(frameon=False)
    figure.savefig(path, dpi=150)


def main(arguments: list[str] | None = None) -> None:
    report = Report(__file__, __doc__, arguments, quick="small bodies only")
    rows = []
    print(f"{'cells':14} {'local solver':12} {'unknowns':>8} {'w':>6} {'touched':>7} {'CPU s':>8} {'steps':>5}")
    for name in QUICK if report.quick else CASES:
        for solver in SOLVERS:
            row = in_own_process(__file__, name, solver)
            rows.append(row)
            print(
                f"{name:14} {solver:12} {row['unknowns']:8} {row['cubes']:6.0f} {row['touched']:7} "
                f"{row['cpu_seconds']:8.3f} {row['steps']:5}",
                flush=True,
            )
    large = [row for row in rows if row["unknowns"] > SMALL or report.quick]
    fits = {s: fitted([row for row in large if row["local_solver"] == s], s == "multigrid") for s in SOLVERS}
    print(f"\nconstants fitted: {fits}\n\nwith those of the package:\n")
    table = compared(rows)
    for row in table:
        print(
            f"{row['cells']:14} condensed {row['condensed']:8.3f} ({row['estimate condensed']:8.3f})  multigrid "
            f"{row['multigrid']:8.3f} ({row['estimate multigrid']:8.3f})  auto loses {100 * row['loss']:5.0f} %"
        )
    draw(table, report.path("cost_of_solvers.png"))
    report.summary({"measurements": rows, "fitted": fits, "choices": table})


if __name__ == "__main__":
    if sys.argv[1:2] == ["--case"]:
        print(json.dumps(case(sys.argv[2], sys.argv[3])))
    else:
        main()
