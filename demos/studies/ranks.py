"""Solids on several MPI ranks: two equal ones on one and on two, how much sooner; a stack of many, how much memory.

Time is wall time, as that is what ranks save; the two are measured in turn and their ratios are quoted. Memory is the
largest that a rank's process ever had, of bodies that only their owners make (`cd.DeferredBody`): no two of them are
copies, which would share one factor where one rank holds both.
"""

from __future__ import annotations

import json
import os
import resource
import shutil
import subprocess
import sys
import time
from itertools import pairwise
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
#: Of the stack: bodies, their cells along a side, numbers of ranks, also more than there are cores.
STACK, RANKS = (32, 18), (1, 2, 4, 8)


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


def deferred(index: int, last: int, cells: int) -> cd.DeferredBody:
    """One block of a stack, which its owner makes; every second is a layer of cells higher, all of other steels."""
    name = f"block {index}"

    def make() -> cd.Body:
        mesh = cd.box((0, 0, index), (2, 2, index + 1), (cells, cells, cells // 2 + index % 2))
        held = cd.Symmetry("left", "right", "front", "back", *(["bottom"] if index == 0 else []))
        loads = [cd.Pressure("top", 10)] if index == last else []
        return cd.Body(name, mesh, cd.Isotropic(2.1e5 + 100 * index, 0.3), supports=[held], loads=loads)

    return cd.DeferredBody(name, make, work=3.0 * (cells + 1) ** 2 * (cells // 2 + 1 + index % 2))


def memory_case(count: int, cells: int, local_solver: str) -> dict[str, Any]:
    """One measurement of a stack by the ranks of this process: MiB and CPU seconds of the rank with most."""
    comm = MPI.COMM_WORLD
    bodies = [deferred(index, count - 1, cells) for index in range(count)]
    contacts = [cd.Contact((a, "top"), (b, "bottom"), LAYER, gap=pit) for a, b in pairwise(bodies)]
    began, before = time.process_time(), resident()
    scene = cd.Scene(bodies, contacts, comm=comm)
    solution = cd.solve(scene, "newton-krylov", local_solver=local_solver, tolerance=1e-12)
    return {
        "ranks": comm.size,
        "unknowns": comm.allreduce(sum(b.dofs for i, b in enumerate(scene.bodies) if scene.ranks.speaks(i))),
        "empty": comm.allreduce(before, MPI.MAX),
        "peak": comm.allreduce(resident(), MPI.MAX),
        "cpu": comm.allreduce(time.process_time() - began, MPI.MAX),
        "pressure": np.concatenate([solution.contact(i).pressure for i in (0, count // 2, count - 2)]).tolist(),
    }


def resident() -> float:
    """The largest memory that this process has had (MiB)."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def measured(ranks: int, case: str, *arguments: object) -> dict[str, Any]:
    """One measurement by so many ranks."""
    here = Path(__file__)
    beside = str(Path(sys.executable).parent)
    mpirun = shutil.which("mpirun", path=os.pathsep.join([beside, os.environ["PATH"]]))
    env = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": str(here.parents[2])}
    env |= {"PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe", "OMPI_MCA_mpi_yield_when_idle": "1"}
    command = [mpirun, "-n", str(ranks), sys.executable, str(here), case, *map(str, arguments)]
    done = subprocess.run(command, env=env, check=True, stdout=subprocess.PIPE, text=True)
    return json.loads(done.stdout.splitlines()[-1])


def memory(count: int, cells: int, local_solver: str, numbers: tuple[int, ...]) -> list[dict[str, Any]]:
    """The memory of a rank for each number of ranks, and how far the answer is from that of the first; printed, too."""
    print(f"{'ranks':>6} {'unknowns':>9} {'MiB of a rank':>14} {'of the first':>13} {'CPU s':>7} {'difference':>11}")
    rows: list[dict[str, Any]] = []
    pressures: list[np.ndarray] = []
    for ranks in numbers:
        row = measured(ranks, "--memory", count, cells, local_solver)
        pressures.append(np.array(row.pop("pressure")))
        row["difference"] = float(np.abs(pressures[-1] - pressures[0]).max() / pressures[0].max())
        rows.append(row)
        share = row["peak"] / rows[0]["peak"]
        numbers_of_row = f"{row['peak']:14.0f} {share:13.2f} {row['cpu']:7.1f} {row['difference']:11.1e}"
        print(f"{ranks:6} {row['unknowns']:9} {numbers_of_row}", flush=True)
    columns = np.array([[1.0, 1 / row["ranks"]] for row in rows])
    constant, shared = np.linalg.lstsq(columns, [row["peak"] for row in rows], rcond=None)[0]
    part = 2**20 * shared / rows[0]["unknowns"]
    print(f"peak = {constant:.0f} MiB + {shared:.0f} MiB / ranks: {part:.0f} bytes per unknown are shared out")
    return rows


def compare(sizes: tuple[int, ...], turns: int) -> list[dict[str, Any]]:
    """One rank against two, in turns: the median seconds of each, and the median of the ratios."""
    rows = []
    for size in sizes:
        pairs = [(measured(1, "--case", size), measured(2, "--case", size)) for _ in range(turns)]
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
    stack, numbers = ((4, 4), (1, 2)) if report.quick else (STACK, RANKS)
    shared = memory(*stack, "condensed", numbers)
    figure = Figure(figsize=(5, 3.6), layout="constrained")
    axes = figure.subplots()
    for key, label in (("one", "one rank"), ("two", "two ranks")):
        axes.loglog([row["unknowns"] for row in rows], [row[key] for row in rows], "o-", label=label)
    axes.set_xlabel("unknowns")
    axes.set_ylabel("seconds")
    axes.legend(frameon=False)
    figure.savefig(report.path("ranks.png"), dpi=150)
    report.summary({"time": rows, "memory": shared})


if __name__ == "__main__":
    if sys.argv[1:2] in (["--case"], ["--memory"]):
        sizes = [int(each) for each in sys.argv[2:4]]
        numbers = case(*sizes) if sys.argv[1] == "--case" else memory_case(*sizes, sys.argv[4])
        if MPI.COMM_WORLD.rank == 0:
            print(json.dumps(numbers))
    else:
        main()
