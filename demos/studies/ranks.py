"""Two equal solid bodies on one MPI rank and on two: the same answer, and how much sooner.

Wall time, as that is what ranks save; the two are measured in turn and their ratios are quoted.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI
from results import Report

import contactdd as cd

STEEL = cd.Isotropic(E=2.1e5, nu=0.3)
LAYER = cd.PowerLayer(B=4e-6, a=1.1)
SIZES, QUICK, TURNS = (12, 16, 20, 24), (4,), 3


def pit(x: np.ndarray) -> np.ndarray:
    return 5e-4 * np.maximum(1 - x[0] ** 2 - x[1] ** 2, 0) ** 1.5


def scene(size: int, comm: MPI.Comm) -> cd.Scene:
    """Two cubes of `size`³ cells, each cut into six tetrahedra, with a round pit between them."""
    sides = [cd.Symmetry("left", "right", "front", "back")]
    lower, upper = (
        cd.Body(
            name, cd.box((0, 0, z), (2, 2, z + 2), (size,) * 3), STEEL, supports=sides, loads=[cd.Pressure(face, 10)]
        )
        for name, z, face in (("lower", 0, "bottom"), ("upper", 2, "top"))
    )
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), LAYER, gap=pit)], comm=comm)


def case(size: int) -> dict[str, Any]:
    """One measurement by the ranks of this process: seconds from the scene to its solution."""
    comm = MPI.COMM_WORLD
    cd.solve(scene(2, comm), local_solver="condensed")  # compiles
    comm.Barrier()
    began = time.perf_counter()
    solution = cd.solve(scene(size, comm), local_solver="condensed")
    comm.Barrier()
    seconds = time.perf_counter() - began
    unknowns = solution.displacement("lower").x.array.size * 2
    return {
        "ranks": comm.size,
        "size": size,
        "unknowns": unknowns,
        "seconds": seconds,
        "peak": solution.contact().pressure.max(),
    }


def measured(ranks: int, size: int) -> dict[str, Any]:
    """One measurement by so many ranks."""
    here = Path(__file__)
    beside = str(Path(sys.executable).parent)
    mpirun = shutil.which("mpirun", path=os.pathsep.join([beside, os.environ["PATH"]]))
    env = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": str(here.parents[2])}
    command = [mpirun, "-n", str(ranks), sys.executable, str(here), "--case", str(size)]
    done = subprocess.run(command, env=env, check=True, stdout=subprocess.PIPE, text=True)
    return json.loads(done.stdout.splitlines()[-1])


def compare(sizes: tuple[int, ...], turns: int) -> list[dict[str, Any]]:
    """One rank against two, in turns: the median seconds of each, and the median of the ratios."""
    rows = []
    for size in sizes:
        pairs = [(measured(1, size), measured(2, size)) for _ in range(turns)]
        one, two = (float(np.median([pair[i]["seconds"] for pair in pairs])) for i in range(2))
        ratio = float(np.median([first["seconds"] / second["seconds"] for first, second in pairs]))
        apart = max(abs(first["peak"] / second["peak"] - 1) for first, second in pairs)
        rows.append(
            {
                "size": size,
                "unknowns": pairs[0][0]["unknowns"],
                "one": one,
                "two": two,
                "speedup": ratio,
                "difference": apart,
            }
        )
    return rows


def print_rows(rows: list[dict[str, Any]]) -> None:
    print(f"{'unknowns':>9} {'one rank, s':>12} {'two ranks, s':>13} {'speed-up':>9} {'difference':>11}")
    for row in rows:
        print(
            f"{row['unknowns']:9} {row['one']:12.2f} {row['two']:13.2f} {row['speedup']:9.2f} {row['difference']:11.1e}"
        )


def main(arguments: list[str] | None = None) -> None:
    report = Report(__file__, __doc__, arguments, quick="a small size only")
    rows = compare(QUICK, 1) if report.quick else compare(SIZES, TURNS)
    print_rows(rows)
    figure = Figure(figsize=(5, 3.6), layout="constrained")
    axes = figure.subplots()
    for key, label in (("one", "one rank"), ("two", "two ranks")):
        axes.loglog([row["unknowns"] for row in rows], [row[key] for row in rows], "o-", label=label)
    axes.set_xlabel("unknowns")
    axes.set_ylabel("seconds")
    axes.legend(frameon=False)
    figure.savefig(report.path("ranks.png"), dpi=150)
    report.summary(rows)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--case"]:
        numbers = case(int(sys.argv[2]))
        if MPI.COMM_WORLD.rank == 0:
            print(json.dumps(numbers))
    else:
        main()
