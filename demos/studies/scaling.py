"""How time, memory and iterations grow: with the unknowns in the plane and in space, and with the number of bodies.

Every measurement is a process of its own, on one thread. The exponents are fitted to the larger half of the sizes.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import ranks
from matplotlib.figure import Figure
from own_process import in_own_process
from peak_memory import forget_peak, peak_mb
from results import Report

import contactdd as cd

STEEL = cd.Isotropic(E=2.1e5, nu=0.3)
LAYER = cd.PowerLayer(B=4e-6, a=1.1)
LOAD = 10.0
TOLERANCE = 1e-8


def dent(x: np.ndarray) -> np.ndarray:
    """The paper's groove."""
    return 5e-4 * np.maximum(1 - x[0] ** 2, 0) ** 1.5


def pit(x: np.ndarray) -> np.ndarray:
    """A round one, about a corner."""
    return 5e-4 * np.maximum(1 - x[0] ** 2 - x[1] ** 2, 0) ** 1.5


def plane(size: int) -> cd.Scene:
    """The groove, linear triangles, 2 `size` × `size` squares per body."""
    sides = [cd.Symmetry("left", "right")]
    meshes = [cd.rectangle((0, y), (4, y + 1), (2 * size, size), diagonal=d) for y, d in ((0, "right"), (1, "left"))]
    bodies = [
        cd.Body(name, mesh, STEEL, supports=sides, loads=[cd.Pressure(side, LOAD)])
        for name, mesh, side in zip(("lower", "upper"), meshes, ("bottom", "top"), strict=True)
    ]
    return cd.Scene(bodies, [cd.Contact((bodies[0], "top"), (bodies[1], "bottom"), LAYER, gap=dent)])


def space(size: int) -> cd.Scene:
    """Two cubes with a pit between them, linear hexahedra, `size`³ cells per body."""
    sides = [cd.Symmetry("left", "right", "front", "back")]
    bodies = [
        cd.Body(
            name,
            cd.box((0, 0, z), (2, 2, z + 2), (size, size, size), shape="hexahedron"),
            STEEL,
            supports=sides,
            loads=[cd.Pressure(side, LOAD)],
        )
        for name, z, side in (("lower", 0, "bottom"), ("upper", 2, "top"))
    ]
    return cd.Scene(bodies, [cd.Contact((bodies[0], "top"), (bodies[1], "bottom"), LAYER, gap=pit)])


def bodies(count: int) -> cd.Scene:
    """A stack of unlike plates on a foundation, the groove between each two of them."""
    plates = []
    for place in range(count):
        mesh = cd.rectangle((0, place), (4, place + 1), (16, 4), shape="quadrilateral")
        supports: list[Any] = [cd.Symmetry("left", "right")] + ([cd.Fixed("bottom")] if place == 0 else [])
        loads = [cd.Pressure("top", LOAD)] if place == count - 1 else []
        steel = cd.Isotropic(E=2.1e5 * (1 + place % 3), nu=0.3)
        plates.append(cd.Body(f"plate {place}", mesh, steel, supports=supports, loads=loads))
    contacts = [cd.Contact((lower, "top"), (upper, "bottom"), LAYER, gap=dent) for lower, upper in pairwise(plates)]
    return cd.Scene(plates, contacts)


SCENES: dict[str, Callable[[int], cd.Scene]] = {"plane": plane, "space": space, "bodies": bodies}
#: "newton-krylov" solves the bodies apart; its coarse space is dense, which ends to pay at some hundred bodies.
METHODS = {"auto": 256, "newton-krylov": 128}
SIZES = {
    "plane": (16, 32, 64, 128, 256, 352),
    "space": (4, 8, 12, 16, 24, 32, 40, 54),
    "bodies": (2, 4, 8, 16, 32, 64, 128, 256),
}
QUICK = {"plane": (8, 16, 32), "space": (3, 4, 6), "bodies": (2, 4, 8)}


def case(kind: str, size: int, method: str) -> dict[str, Any]:
    """One measurement in this process: CPU seconds without imports and compilation, and peak memory."""
    cd.solve(SCENES[kind](2), method, tolerance=TOLERANCE)  # compiles
    before, began = forget_peak(), time.process_time()
    scene = SCENES[kind](size)
    solution = cd.solve(scene, method, tolerance=TOLERANCE)
    force = solution.contact().force
    seconds = time.process_time() - began
    unknowns = sum(body.dofs for body in scene.bodies)
    return {
        "kind": kind,
        "size": size,
        "method": method,
        "bodies": len(scene.bodies),
        "unknowns": unknowns,
        "cpu_seconds": seconds,
        "peak_mb": peak_mb() - before,
        "iterations": solution.iterations,
        "body_solves": int(solution.history.body_solves[-1]) // len(scene.bodies),
        "force": force,
    }


def measured(kind: str, size: int, method: str) -> dict[str, Any]:
    """One measurement in a process of its own."""
    return in_own_process(__file__, kind, size, method)


def exponent(rows: list[dict[str, Any]], against: str, what: str) -> float:
    """The power of growth, fitted to the larger half of the rows."""
    half = sorted(rows, key=lambda row: row[against])[len(rows) // 2 - 1 :]
    return float(
        np.polyfit(np.log([row[against] for row in half]), np.log([max(row[what], 1e-3) for row in half]), 1)[0]
    )


def exponents(rows: list[dict[str, Any]]) -> dict[str, dict[str, float]]:
    """The fitted powers of every family of measurements."""
    families: dict[str, list[dict[str, Any]]] = {}
    for row in rows:
        families.setdefault(f"{row['kind']}, {row['method']}", []).append(row)
    return {
        name: {
            what: exponent(family, "unknowns", what) for what in ("cpu_seconds", "peak_mb", "iterations", "body_solves")
        }
        for name, family in families.items()
    }


def print_exponents(fits: dict[str, dict[str, float]]) -> None:
    print("\nfitted powers of the number of unknowns (of bodies, in the last two)\n")
    print(f"{'':24} {'time':>6} {'memory':>7} {'Newton steps':>13} {'solves per body':>16}")
    for name, powers in fits.items():
        time_, memory, steps, solves = powers.values()
        print(f"{name:24} {time_:6.2f} {memory:7.2f} {steps:13.2f} {solves:16.2f}")


def estimate(rows: list[dict[str, Any]]) -> dict[str, float]:
    """What 1e9 unknowns would take: solid bodies of the largest size measured, one per core.

    A core's time is that of one body here times what the number of bodies adds to the solves per body, fitted to the
    stacks. Of the memory it is what the body's owner has: what every rank keeps of all unknowns, ranks.py measures.
    """
    largest = max((row for row in rows if row["kind"] == "space"), key=lambda row: row["unknowns"])
    stacks = [row for row in rows if row["kind"] == "bodies" and row["method"] == "newton-krylov"]
    power = max(exponent(stacks, "bodies", "body_solves"), 0.0)
    per_body = largest["unknowns"] / largest["bodies"]
    cores = 1e9 / per_body
    growth = (cores / largest["bodies"]) ** power
    return {
        "cores": cores,
        "seconds": largest["cpu_seconds"] / largest["bodies"] * growth,
        "gigabytes_per_core": largest["peak_mb"] / largest["bodies"] / 1024,
        "growth": growth,
    }


def print_estimate(numbers: dict[str, float]) -> None:
    print(
        f"\non paper: 1e9 unknowns, {numbers['cores']:.0f} solid bodies, one per core: about {numbers['seconds']:.0f} "
        f"s and {numbers['gigabytes_per_core']:.1f} GB per core for its own body (solves per body grow "
        f"{numbers['growth']:.1f} times); what every rank keeps of all unknowns is in docs/benchmarks.md"
    )


def draw(rows: list[dict[str, Any]], path: Path) -> None:
    """Time and memory against unknowns, solves per body against the number of bodies."""
    figure = Figure(figsize=(11, 3.8), layout="constrained")
    axes = figure.subplots(1, 3)
    for number, (kind, method) in enumerate(dict.fromkeys((row["kind"], row["method"]) for row in rows)):
        family = [row for row in rows if (row["kind"], row["method"]) == (kind, method)]
        style: dict[str, Any] = {"ms": 4, "label": f"{kind}, {method}", "color": f"C{number}"}
        for place, what in enumerate(("cpu_seconds", "peak_mb")):
            axes[place].loglog([r["unknowns"] for r in family], [r[what] for r in family], "o-", **style)
        if kind == "bodies":
            axes[2].semilogx([r["bodies"] for r in family], [r["body_solves"] for r in family], "o-", **style)
    for place, (x, y) in enumerate(
        (("unknowns", "CPU seconds"), ("unknowns", "peak memory, MB"), ("bodies", "solves per body"))
    ):
        axes[place].set_xlabel(x)
        axes[place].set_ylabel(y)
        axes[place].grid(alpha=0.3)
    axes[2].set_ylim(bottom=0)
    axes[0].legend(frameon=False, fontsize=7)
    figure.savefig(path, dpi=150)


def main(arguments: list[str] | None = None) -> None:
    report = Report(__file__, __doc__, arguments, quick="small sizes only")
    rows = []
    columns = ("kind", "method", "size", "bodies", "unknowns", "CPU s", "peak MB", "steps", "solves")
    print("{:7} {:14} {:>5} {:>6} {:>9} {:>8} {:>8} {:>5} {:>6}".format(*columns))
    for kind, sizes in (QUICK if report.quick else SIZES).items():
        for method in METHODS if kind == "bodies" else ("auto",):
            for size in (size for size in sizes if kind != "bodies" or size <= METHODS[method]):
                row = measured(kind, size, method)
                rows.append(row)
                print(
                    f"{kind:7} {method:14} {size:5} {row['bodies']:6} {row['unknowns']:9} {row['cpu_seconds']:8.2f} "
                    f"{row['peak_mb']:8.1f} {row['iterations']:5} {row['body_solves']:6}",
                    flush=True,
                )
    fits, paper = exponents(rows), estimate(rows)
    print_exponents(fits)
    print_estimate(paper)
    print("\ntwo equal solid bodies on one MPI rank and on two (wall time, medians of runs in turn)\n")
    on_ranks = ranks.compare(ranks.QUICK, 1) if report.quick else ranks.compare(ranks.SIZES, ranks.TURNS)
    ranks.print_rows(on_ranks)
    draw(rows, report.path("scaling.png"))
    report.summary({"measurements": rows, "exponents": fits, "estimate": paper, "ranks": on_ranks})


if __name__ == "__main__":
    if sys.argv[1:2] == ["--case"]:
        print(json.dumps(case(sys.argv[2], int(sys.argv[3]), sys.argv[4])))
    else:
        main()
