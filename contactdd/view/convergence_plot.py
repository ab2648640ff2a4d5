"""Pictures of how iterations converge (matplotlib)."""

from __future__ import annotations

import os
from collections.abc import Mapping

import numpy as np
from matplotlib.ticker import MaxNLocator

from ..base.arrays import Floats
from .picture import BLUE, GREEN, GREY, RED, Figure

#: Of Okabe and Ito's palette, each with a line of its own for those who see no colours.
STYLES = ((BLUE, "-"), (RED, "--"), (GREEN, "-."), ("#CC79A7", ":"), ("#E69F00", "-"), ("#56B4E9", "--"), (GREY, "-."))


def rate(values: Floats) -> float:
    """The factor per iteration by which values fall: of the line fitted to their logarithms over the second half.

    Not a number for fewer than three values that are above zero.
    """
    return _line(values)[0]


def _line(values: Floats) -> tuple[float, Floats, Floats]:
    """The rate, and the fitted line: iterations and values."""
    iterations = np.arange(1, len(values) + 1)
    used = (values > 0.0) & (iterations > (len(values) // 2 if len(values) >= 6 else 0))
    if np.sum(used) < 3:
        return float("nan"), np.zeros(0), np.zeros(0)
    slope, start = np.polyfit(iterations[used], np.log(values[used]), 1)
    ends = iterations[used][[0, -1]].astype(float)
    return float(np.exp(slope)), ends, np.exp(start + slope * ends)


def plot_convergence(
    runs: Mapping[str, Floats], quantity: str, *, path: str | os.PathLike[str] | None = None
) -> Figure:
    """A figure of a quantity over the iterations of one or several runs.

    The legend gives each run's fitted `rate`, where there is one, and a broad line shows over which iterations.
    """
    figure = Figure(figsize=(7.0, 4.6), layout="constrained")
    axes = figure.subplots()
    for (name, values), (colour, line) in zip(runs.items(), STYLES * (1 + len(runs) // len(STYLES)), strict=False):
        fitted, *ends = _line(values)
        label = name if np.isnan(fitted) else f"{name}, × {fitted:.3g} per iteration".lstrip(", ")
        shown = np.where(values > 0.0, values, np.nan)
        # Points of many iterations would be a thick line.
        marks = {"marker": "o", "markersize": 3} if len(values) < 60 else {}
        axes.semilogy(np.arange(1, len(values) + 1), shown, line, color=colour, label=label, **marks)
        axes.semilogy(*ends, color=colour, linewidth=6, alpha=0.2, solid_capstyle="butt")
    axes.set_xlabel("iteration")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_ylabel(quantity)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(True, axis="y", color="#dddddd", linewidth=0.6)
    if any(axes.get_legend_handles_labels()):
        axes.legend(frameon=False)
    if path is not None:
        figure.save(path)
    return figure
