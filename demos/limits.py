"""Where the plain methods end: iterations of I, II, III over the relaxation γ and what makes a scene hard.

Over the ratio of the two bodies' Young's moduli, and over the number of floating bodies in a stack; as the paper's
Table 1, but to a residual of 1e-6, which no slowly moving run reaches by standing still.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np
from hard_scenes import E, stack, two_blocks
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from report import Report

import contactdd as cd

METHODS = {"I": "one-point", "II": "chord", "III": "kurchatov"}
GAMMAS = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.65, 0.7, 0.75, 0.8, 0.9, 0.95, 1.0)
RATIOS = (1e-6, 1e-4, 1e-3, 1e-2, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 1e2, 1e3, 1e4, 1e6)
COUNTS = (2, 3, 4, 6, 8, 12, 16)
MOST = 400
#: Instead of a number: not there after MOST iterations, and diverged or going round in circles.
SLOW, DIVERGED = "–", "÷"
Count = int | str


def iterations(scene: cd.Scene, method: str, gamma: float) -> Count:
    """Iterations to the residual 1e-6, or why the method does not come there."""
    run = cd.solve(scene, method, gamma=gamma, tolerance=1e-6, max_iterations=MOST, on_failure="return")
    return run.iterations if run.converged else SLOW if run.status == "iteration limit" else DIVERGED


def study(values: Sequence[float], build: Callable[[float], cd.Scene]) -> dict[str, list[list[Count]]]:
    """For every method the iterations, rows by value, columns by γ."""
    table: dict[str, list[list[Count]]] = {column: [] for column in METHODS}
    for value in values:
        scene = build(value)
        for column, method in METHODS.items():
            table[column].append([iterations(scene, method, gamma) for gamma in GAMMAS])
    return table


def print_study(title: str, values: Sequence[float], table: dict[str, list[list[Count]]]) -> None:
    print(f"\n{title}; {SLOW} more than {MOST}, {DIVERGED} diverges")
    for column, rows in table.items():
        print(f"{METHODS[column]} ({column})\n" + " " * 8 + "".join(f"{gamma:>6}" for gamma in GAMMAS))
        for value, row in zip(values, rows, strict=True):
            print(f"{value:>8g}" + "".join(f"{count:>6}" for count in row))


def draw(values: Sequence[float], names: list[str], label: str, table: dict, path: str) -> None:
    """One map per method."""
    figure = Figure(figsize=(15, 0.34 * len(values) + 1.6), layout="constrained")
    norm = LogNorm(5, MOST)
    panels = figure.subplots(1, len(METHODS), sharey=True)
    for axes, (column, rows) in zip(panels, table.items(), strict=True):
        image = axes.imshow(_numbers(rows), norm=norm, cmap="viridis_r", aspect="auto", origin="lower")
        _annotate(axes, rows)
        axes.set_title(f"{column}: {METHODS[column]}")
        axes.set_xticks(range(len(GAMMAS)), [str(gamma) for gamma in GAMMAS], rotation=60)
        axes.set_yticks(range(len(values)), names)
        axes.set_xlabel("relaxation γ")
    panels[0].set_ylabel(label)
    figure.colorbar(image, ax=panels, label=f"iterations ({SLOW} more than {MOST}, {DIVERGED} diverges)")
    figure.savefig(path, dpi=110)


def _numbers(rows: list[list[Count]]) -> np.ndarray:
    return np.array([[np.nan if isinstance(count, str) else count for count in row] for row in rows])


def _annotate(axes: Axes, rows: list[list[Count]]) -> None:
    for y, row in enumerate(rows):
        for x, count in enumerate(row):
            dark = isinstance(count, int) and count > 60
            axes.text(x, y, count, ha="center", va="center", fontsize=6.5,
                      color="white" if dark else "black")  # fmt: skip


def main(arguments: list[str] | None = None) -> None:
    report = Report(__file__, __doc__, arguments)
    began = time.process_time()
    ratios = study(RATIOS, lambda ratio: two_blocks(moduli=(E, ratio * E), cells=((16, 8), (16, 8))))
    counts = study(COUNTS, lambda count: stack(int(count), cells=(12, 6)))
    print_study("Iterations over γ, rows by the ratio of Young's moduli", RATIOS, ratios)
    print_study("Iterations over γ, rows by the number of bodies", COUNTS, counts)
    draw(
        RATIOS, [f"{ratio:g}" for ratio in RATIOS], "Young's modulus, upper / lower", ratios, report.path("moduli.png")
    )
    draw(COUNTS, [str(count) for count in COUNTS], "bodies", counts, report.path("bodies.png"))
    seconds = time.process_time() - began
    print(f"\n{seconds:.0f} s CPU")
    report.summary({"gammas": GAMMAS, "ratios": RATIOS, "by_ratio": ratios, "counts": COUNTS, "by_count": counts})


if __name__ == "__main__":
    main()
