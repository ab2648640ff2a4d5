"""Pictures of a load programme: contacts step by step, small multiples of the bodies, an animation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np

from ..base.checks import as_count, positive
from ..body_result import BodyResult
from ..contact_result import ContactResult
from .body_plot import Drawing, drawing
from .contact_plot import natural_place, place, place_name
from .frame import framed
from .movie import WRITERS
from .picture import MAP, Figure, Picture, short_numbers, with_unit

#: The bodies of every step.
Steps = Sequence[Sequence[BodyResult]]


def plot_steps(
    results: Sequence[ContactResult],
    labels: Sequence[str],
    *,
    along: str | None = None,
    path: str | Path | None = None,
    stress_unit: str | None = None,
    length_unit: str | None = None,
) -> Figure:
    """A figure of the contact pressure of every step along a contact of the plane, from dark to light."""
    if results[0].x.shape[1] == 3:
        raise ValueError("the contact is a surface in space: its steps are no curves; expected one of plane bodies")
    along = along or natural_place(results[0])
    figure = Figure(figsize=(7.0, 4.6), layout="constrained")
    axes = figure.subplots()
    widths = np.linspace(3.0, 1.2, len(results))  # so that one that comes back to another hides it not
    colours = matplotlib.colormaps[MAP](np.linspace(0.0, 0.85, len(results)))
    for index, (result, label) in enumerate(zip(results, labels, strict=True)):
        s = place(result, along)
        order = np.argsort(s, kind="stable")
        axes.plot(s[order], result.pressure[order], color=colours[index], linewidth=widths[index], label=label)
    axes.set_xlabel(with_unit(place_name(results[0], along), length_unit))
    axes.set_ylabel(with_unit("contact pressure", stress_unit))
    axes.set_ylim(bottom=0.0)
    axes.margins(x=0.0)
    short_numbers(axes.yaxis)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, ncols=1 + len(labels) // 9)
    if path is not None:
        figure.save(path)
    return figure


def plot_multiples(
    steps: Steps,
    labels: Sequence[str],
    *,
    columns: int = 3,
    size: tuple[int, int] | None = None,
    path: str | Path | None = None,
    **options: Any,
) -> Picture:
    """A picture of all steps' bodies beside each other, drawn alike; size: in pixels; options: of `drawing`."""
    columns = min(as_count("columns", columns), len(steps))
    size = size or (1600, 200 - (-len(steps) // columns) * (80 + 1000 // columns))
    drawn = _alike(steps, options)
    return framed([drawn.coloured(bodies) for bodies in steps], labels, drawn.frame, size, columns=columns, path=path)


def animate(
    steps: Steps,
    labels: Sequence[str],
    path: str | PathLike[str],
    *,
    per_second: float = 4.0,
    size: tuple[int, int] = (1200, 800),
    **options: Any,
) -> Path:
    """The animation written, a GIF or an MP4, one frame a step, drawn alike; options: of `drawing`."""
    file, per_second = Path(path), positive("per_second", per_second)
    write = WRITERS.get(file.suffix.lower())
    if write is None:
        raise ValueError(f"path = {str(path)!r}: expected a name that ends in .gif or .mp4")
    drawn = _alike(steps, options)
    panels = ([drawn.coloured(bodies)] for bodies in steps)
    frames = (framed(panel, [label], drawn.frame, size).pixels for panel, label in zip(panels, labels, strict=True))
    write(file, frames, per_second)
    return file


def _alike(steps: Steps, options: Mapping[str, Any]) -> Drawing:
    """One enlargement, one component and one scale of colours for all steps."""
    return drawing([body for bodies in steps for body in bodies], **options)
