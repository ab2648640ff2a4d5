"""Where the plain methods end: iterations of I, II, III over the relaxation γ and what makes a scene hard.

Over the ratio of the two bodies' Young's moduli, and over the number of floating bodies in a stack; as the paper's
Table 1, but to a residual of 1e-6, which no slowly moving run reaches by standing still.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Sequence

import numpy as np
import scipy.linalg
from hard_scenes import NU, SIDES, E, stack, two_blocks
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from results import Report

import contactdd as cd
from contactdd.system.ensemble import Ensemble

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


def linear_scene(bodies: int, stiffness: float) -> cd.Scene:
    """Held blocks of unlike stiffness and height with interference: linear layers that stay closed everywhere."""
    heights = (1.0, 1.6, 0.8)[:bodies]
    floors = np.concatenate([[0.0], np.cumsum(heights)])
    blocks = []
    for i in range(bodies):
        support = cd.Fixed("bottom") if i == 0 else cd.Fixed("top") if i == bodies - 1 else SIDES
        mesh = cd.rectangle((0, floors[i]), (1, floors[i + 1]), (8, 4))
        blocks.append(cd.Body(f"block {i + 1}", mesh, cd.Isotropic(E * (1 + i), NU), supports=[support]))
    pairs, layer = itertools.pairwise(blocks), cd.LinearLayer(stiffness)
    return cd.Scene(blocks, [cd.Contact((low, "top"), (high, "bottom"), layer, gap=-1e-3) for low, high in pairs])


def predicted_contraction(scene: cd.Scene, gamma: float) -> float:
    """The spectral radius of I − γ (A + Φ)⁻¹ (A + C) for closed linear layers, by dense algebra.

    A: the bodies' stiffness; Φ: the Robin terms, body by body; C: the contacts' coupled stiffness.
    """
    problems = scene.local_problems("condensed")
    phi = {i: np.full(len(face.weights), face.layer.stiffness) for i, face in enumerate(scene.interfaces)}
    ensemble = Ensemble(problems, scene.interfaces)
    unknowns = np.eye(ensemble.size)
    coupled = ensemble.tangent(phi, unknowns)
    apart = scipy.linalg.block_diag(*(np.column_stack([*map(p.robin_solver(phi), np.eye(p.size))]) for p in problems))
    return float(np.abs(np.linalg.eigvals(unknowns - gamma * apart @ coupled)).max())


def measured_contraction(scene: cd.Scene, method: str, gamma: float) -> float:
    """What the residual is multiplied with per iteration, in the mean of the last ten before rounding shows."""

    def everything(x: np.ndarray) -> np.ndarray:
        return 1e-5 * np.random.default_rng(0).standard_normal(x.shape[1])

    run = cd.solve(
        scene, method, gamma=gamma, start=everything, tolerance=1e-14, max_iterations=1000, on_failure="return"
    )
    residual = run.history.residual
    last = int(np.flatnonzero(residual > 1e-12)[-1])
    return float((residual[last] / residual[last - 10]) ** 0.1)


def print_theory() -> list[dict[str, float]]:
    """Predicted and measured contraction of the decomposed iteration, a line per scene and γ."""
    rows = []
    print("\nContraction per iteration for linear layers closed everywhere")
    for bodies, stiffness in ((2, 1e5), (3, 1e5), (3, 1e6)):
        for gamma in (0.3, 0.6, 0.9):
            scene = linear_scene(bodies, stiffness)
            predicted, measured = predicted_contraction(scene, gamma), measured_contraction(scene, "chord", gamma)
            numbers = f"predicted {predicted:.4f}, measured {measured:.4f}"
            print(f"{bodies} bodies, layer {stiffness:.0e}, γ = {gamma}: {numbers}")
            rows.append({"bodies": bodies, "stiffness": stiffness, "gamma": gamma,
                         "predicted": predicted, "measured": measured})  # fmt: skip
    return rows


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
    theory = print_theory()
    print(f"\n{time.process_time() - began:.0f} s CPU")
    axes = {"gammas": GAMMAS, "ratios": RATIOS, "counts": COUNTS}
    report.summary(axes | {"by_ratio": ratios, "by_count": counts, "theory": theory})


if __name__ == "__main__":
    main()
