"""How time and memory grow with the number of bodies: a stack of plates, a wall of bricks, a pile of cubes.

Every body has a material of its own, and neighbours have meshes that do not match. Two or three meshes take turns, so
that many contacts are copies of each other; or every body has a mesh of its own ("unlike"), and nothing is shared.
Every measurement is a process of its own, on one thread.
"""

from __future__ import annotations

import itertools
import json
import sys
import time
from collections.abc import Callable
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from own_process import in_own_process
from peak_memory import forget_peak, peak_mb
from results import Report

import contactdd as cd

LAYER = cd.PowerLayer(B=4e-6, a=1.1)
LOAD = 10.0
TOLERANCE = 1e-8


def steel(number: int) -> cd.Isotropic:
    """The material of a body: no two have the same."""
    return cd.Isotropic(E=2.1e5 * (1 + 2 * (0.618034 * number % 1)), nu=0.3)


def ends(start: float, end: float, cells: int, number: int | None) -> np.ndarray:
    """The ends of equal cells or, in the body of a number, of cells that no other body has; whole numbers stay."""
    line = np.linspace(start, end, cells + 1)
    inner = np.abs(line - np.rint(line)) > 1e-9
    shifts = np.zeros(len(line)) if number is None else 0.3 * np.cos(number * np.arange(1.0, cells + 2))
    return line + inner * shifts * (end - start) / cells


def dent(x: np.ndarray) -> np.ndarray:
    """A groove in the middle of a plate."""
    return 1e-4 * np.maximum(np.cos(np.pi * x[0]), 0) ** 1.5


def stack(count: int, unlike: bool = False) -> cd.Scene:
    """Plates on a foundation, with a groove between each two of them."""
    plates = []
    for place in range(count):
        across = ends(0, 4, 16 - place % 3, place if unlike else None)
        mesh = cd.rectangle((0, place), (4, place + 1), (across, 4), shape="quadrilateral")
        supports: list[Any] = [cd.Symmetry("left", "right")] + ([cd.Fixed("bottom")] if place == 0 else [])
        loads = [cd.Pressure("top", LOAD)] if place == count - 1 else []
        plates.append(cd.Body(f"plate {place}", mesh, steel(place), supports=supports, loads=loads))
    contacts = [cd.Contact((lower, "top"), (upper, "bottom"), LAYER, gap=dent) for lower, upper in pairwise(plates)]
    return cd.Scene(plates, contacts)


def wall(count: int, unlike: bool = False) -> cd.Scene:
    """Bricks 2 × 1 in running bond, in courses of √(count / 2): an inner one has six neighbours."""
    across = max(2, round((count / 2) ** 0.5))
    high = max(1, round(count / across))
    courses = [_course(place, across, high - 1, unlike) for place in range(high)]
    contacts = [
        cd.Contact((lower, f"top {x}"), (upper, f"bottom {x}"), LAYER, name=f"bed {place}, {x}")
        for place, (below, above) in enumerate(pairwise(courses))
        for x in range(2 * across)
        for lower, upper in [(_over(below, x), _over(above, x))]
    ]
    for course in courses:
        bricks = [brick for _, brick in course]
        contacts += [cd.Contact((a, "right"), (b, "left"), LAYER) for a, b in pairwise(bricks)]
    return cd.Scene([brick for course in courses for _, brick in course], contacts)


def _course(place: int, across: int, last: int, unlike: bool) -> list[tuple[range, cd.Body]]:
    """The bricks of a course and the unit lengths that each covers; every second course begins and ends with halves."""
    joints = [0, *range(1, 2 * across, 2), 2 * across] if place % 2 else list(range(0, 2 * across + 1, 2))
    return [(range(*pair), _brick(place, pair, 2 * across, last, unlike)) for pair in pairwise(joints)]


def _brick(place: int, joints: tuple[int, int], width: int, last: int, unlike: bool) -> cd.Body:
    (x0, x1), top = joints, place + 1
    number = width * place + x0 if unlike else None
    cells = ends(x0, x1, 4 * (x1 - x0), number), ends(place, top, 4 - (place + x0 // 2) % 2, number)
    mesh = cd.rectangle((x0, place), (x1, top), cells, shape="quadrilateral")
    halves: dict[str, Any] = {
        f"{side} {x}": lambda p, x=x, y=y: np.isclose(p[1], y) & (np.abs(p[0] - x - 0.5) < 0.51)
        for side, y in (("bottom", place), ("top", top))
        for x in range(x0, x1)
    }
    supports: list[Any] = [cd.Fixed("bottom")] if place == 0 else []
    supports += [cd.Symmetry("left")] if x0 == 0 else []
    supports += [cd.Symmetry("right")] if x1 == width else []
    loads = [cd.Pressure("top", LOAD)] if place == last else []
    material = steel(width * place + x0)
    return cd.Body(f"brick {place}, {x0}", mesh.with_surfaces(**halves), material, supports=supports, loads=loads)


def _over(course: list[tuple[range, cd.Body]], x: int) -> cd.Body:
    """The brick of a course that covers the unit length from x."""
    return next(brick for covered, brick in course if x in covered)


def pile(count: int, unlike: bool = False) -> cd.Scene:
    """Cubes side by side and upon each other between smooth walls, loaded on top: an inner one has six neighbours."""
    edge = round(count ** (1 / 3))
    cubes = {at: _cube(at, edge, unlike) for at in itertools.product(range(edge), repeat=3)}
    contacts = [
        cd.Contact((cubes[i, j, k], before), (cubes[i + a, j + b, k + c], after), LAYER)
        for i, j, k in cubes
        for (a, b, c), before, after in (
            ((1, 0, 0), "right", "left"),
            ((0, 1, 0), "back", "front"),
            ((0, 0, 1), "top", "bottom"),
        )
        if (i + a, j + b, k + c) in cubes
    ]
    return cd.Scene(list(cubes.values()), contacts)


def _cube(at: tuple[int, ...], edge: int, unlike: bool) -> cd.Body:
    i, j, k = at
    number = (i * edge + j) * edge + k
    x, y, z = (ends(x, x + 1, 3 - sum(at) % 2, number if unlike else None) for x in at)
    mesh = cd.box(at, [i + 1, j + 1, k + 1], (x, y, z), shape="hexahedron")
    walls = {"left": i == 0, "right": i == edge - 1, "front": j == 0, "back": j == edge - 1, "bottom": k == 0}
    supports = [cd.Symmetry(*touched)] if (touched := [side for side, there in walls.items() if there]) else []
    loads = [cd.Pressure("top", LOAD)] if k == edge - 1 else []
    return cd.Body(f"cube {i}, {j}, {k}", mesh, steel(number), supports=supports, loads=loads)


SCENES: dict[str, Callable[[int], cd.Scene]] = {"stack": stack, "wall": wall, "pile": pile}
SCENES |= {f"unlike {name}": partial(make, unlike=True) for name, make in SCENES.items()}
SIZES = {"stack": (64, 256, 1024, 4096), "wall": (66, 264, 528, 2000), "pile": (64, 216, 512, 1000)}
SIZES |= {f"unlike {name}": sizes for name, sizes in SIZES.items()}
QUICK = {"stack": (4, 16), "wall": (8, 18), "pile": (8,), "unlike wall": (8,)}


def case(kind: str, size: int) -> dict[str, Any]:
    """One measurement in this process: CPU seconds without imports and compilation, and peak memory."""
    cd.solve(SCENES[kind](8), tolerance=TOLERANCE)  # compiles
    before, began = forget_peak(), time.process_time()
    scene = SCENES[kind](size)
    made = time.process_time()
    solution = cd.solve(scene, tolerance=TOLERANCE)
    seconds = time.process_time() - began
    return {
        "kind": kind,
        "bodies": len(scene.bodies),
        "contacts": len(scene.contacts),
        "unknowns": sum(body.dofs for body in scene.bodies),
        "cpu_seconds": seconds,
        "making_seconds": made - began,
        "ms_per_body": 1e3 * seconds / len(scene.bodies),
        "peak_mb": peak_mb() - before,
        "iterations": solution.iterations,
        "energy": float(solution.history.energy[-1]),
    }


def draw(rows: list[dict[str, Any]], path: Path) -> None:
    """Time and memory per body against the number of bodies."""
    figure = Figure(figsize=(8, 3.6), layout="constrained")
    both = figure.subplots(1, 2)
    for number, kind in enumerate(SCENES):
        family = [row for row in rows if row["kind"] == kind]
        counts, line = [row["bodies"] for row in family], f"C{number % 3}" + ("o:" if "unlike" in kind else "o-")
        both[0].semilogx(counts, [row["ms_per_body"] for row in family], line, ms=4, label=kind)
        both[1].semilogx(counts, [row["peak_mb"] / row["bodies"] for row in family], line, ms=4, label=kind)
    for axes, what in zip(both, ("CPU milliseconds per body", "peak memory per body, MB"), strict=True):
        axes.set(xlabel="bodies", ylabel=what)
        axes.set_ylim(bottom=0)
        axes.grid(alpha=0.3)
    figure.legend(*both[0].get_legend_handles_labels(), loc="outside upper center", ncols=len(SCENES), frameon=False)
    figure.savefig(path, dpi=150)


def main(arguments: list[str] | None = None) -> None:
    report = Report(__file__, __doc__, arguments, quick="few bodies only")
    rows = []
    print(
        f"{'':12} {'bodies':>6} {'contacts':>8} {'unknowns':>9} {'CPU s':>8} {'ms/body':>8} {'peak MB':>8} {'steps':>5}"
    )
    for kind, sizes in (QUICK if report.quick else SIZES).items():
        for size in sizes:
            row = in_own_process(__file__, kind, size)
            rows.append(row)
            print(
                f"{kind:12} {row['bodies']:6} {row['contacts']:8} {row['unknowns']:9} {row['cpu_seconds']:8.2f} "
                f"{row['ms_per_body']:8.2f} {row['peak_mb']:8.1f} {row['iterations']:5}",
                flush=True,
            )
    draw(rows, report.path("many_bodies.png"))
    report.summary({"measurements": rows})


if __name__ == "__main__":
    if sys.argv[1:2] == ["--case"]:
        print(json.dumps(case(sys.argv[2], int(sys.argv[3]))))
    else:
        main()
