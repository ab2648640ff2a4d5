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
from .body_plot import normal_component, plot_bodies, round_limits, shown, visible_scale
from .contact_plot import natural_place, place
from .picture import MAP, Figure, Picture, with_unit

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
    colours = matplotlib.colormaps[MAP](np.linspace(0.0, 0.85, len(results)))
    for result, label, colour in zip(results, labels, colours, strict=True):
        s = place(result, along)
        order = np.argsort(s, kind="stable")
        axes.plot(s[order], result.pressure[order], color=colour, label=label)
    axes.set_xlabel(with_unit(along, length_unit))
    axes.set_ylabel(with_unit("contact pressure", stress_unit))
    axes.set_ylim(bottom=0.0)
    axes.margins(x=0.0)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False)
    if path is not None:
        figure.savefig(path, dpi=150)
    return figure


def plot_multiples(
    steps: Steps, labels: Sequence[str], *, columns: int = 3, path: str | Path | None = None, **options: Any
) -> Figure:
    """A figure of all steps' bodies beside each other, drawn alike; options: of `plot_bodies`."""
    pictures = _alike(steps, labels, options)
    columns = min(as_count("columns", columns), len(pictures))
    rows = -(-len(pictures) // columns)
    figure = Figure(figsize=(4.2 * columns, 2.8 * rows), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for panel, picture in zip(panels, pictures, strict=False):
        panel.imshow(picture.pixels)
    for panel in panels:
        panel.set_axis_off()
    if path is not None:
        figure.savefig(path, dpi=200)
    return figure


def animate(
    steps: Steps, labels: Sequence[str], path: str | PathLike[str], *, per_second: float = 4.0, **options: Any
) -> Path:
    """The animation written as a GIF, one frame a step, drawn alike; options: of `plot_bodies`."""
    from PIL import Image

    file = Path(path)
    if file.suffix.lower() != ".gif":
        raise ValueError(f"path = {str(path)!r}: expected a name that ends in .gif")
    time = 1000.0 / positive("per_second", per_second)
    first, *others = (Image.fromarray(picture.pixels) for picture in _alike(steps, labels, options))
    first.save(file, save_all=True, append_images=others, duration=time, loop=0)
    return file


def _alike(steps: Steps, labels: Sequence[str], options: Mapping[str, Any]) -> list[Picture]:
    """The pictures of all steps with one enlargement, one component and one scale of colours."""
    everything = [body for bodies in steps for body in bodies]
    component = options.get("component") or normal_component(everything)
    limits = options.get("limits") or round_limits([shown(body, component) for body in everything])[0]
    scale = options.get("scale") or visible_scale(everything)
    common = {**options, "component": component, "limits": limits, "scale": scale}
    return [plot_bodies(bodies, **{"title": label, **common}) for bodies, label in zip(steps, labels, strict=True)]
