"""CPU seconds to a pressure whose error is known to be below 1e-3, from a coarse mesh that knows nothing of the scene.

`cd.adapt(scene, 1e-3)` solves, estimates and refines until the estimate is below. That includes what a user of uniform
or graded meshes has to know beforehand, or finds out by solving several times: how fine and where. One thread, without
imports; the best of three runs, as the first compiles.
"""

from __future__ import annotations

import time
from typing import Any

from error_known import Case, against_finer, groove, half_planes, hertz, true_error
from results import Report

import contactdd as cd

ACCURACY, DEGREE, RUNS = 1e-3, 2, 3


def scenes() -> list[Case]:
    """The groove between strips and between blocks of sixteen widths of the contact, and Hertz' cylinder."""
    return [
        groove(4, DEGREE),
        against_finer("half-planes", half_planes, 6, DEGREE),
        against_finer("Hertz cylinder", hertz, 6, DEGREE),
    ]


def measured(case: Case, runs: int = RUNS) -> dict[str, Any]:
    """One row."""
    seconds = []
    for _ in range(runs):
        began = time.process_time()
        made = cd.adapt(case.make(), ACCURACY)
        seconds.append(time.process_time() - began)
    last = made.rounds[-1]
    return {
        "scene": case.name,
        "accuracy": ACCURACY,
        "status": made.status,
        "cpu_seconds": min(seconds),
        "last_solve_seconds": made.solution.cpu_seconds,
        "meshes": len(made.rounds),
        "unknowns": last.unknowns,
        "estimate": last.error,
        "true_error": true_error(made.solution, case.exact),
    }


def table() -> list[dict[str, Any]]:
    """The rows of all scenes, printed."""
    print(f"\nan error of {ACCURACY:g} asked for, elements of degree {DEGREE}\n")
    print("| scene | CPU ms | of which the last solve | meshes | unknowns | estimate | true error |")
    print("|---|---|---|---|---|---|---|")
    rows = []
    for case in scenes():
        row = measured(case)
        rows.append(row)
        times = f"{1e3 * row['cpu_seconds']:.0f} | {1e3 * row['last_solve_seconds']:.0f}"
        errors = f"{row['estimate']:.1e} | {row['true_error']:.1e}"
        print(f"| {row['scene']} | {times} | {row['meshes']} | {row['unknowns']} | {errors} |", flush=True)
    return rows


if __name__ == "__main__":
    report = Report(__file__, __doc__)
    report.summary(table())
