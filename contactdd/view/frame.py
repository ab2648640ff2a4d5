"""The frame around rendered bodies: titles, the axes' directions, one bar for all (matplotlib)."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from ..base.checks import as_count
from .interactive import image, turnable
from .picture import MAP, Picture, short_numbers
from .render import Coloured, View, pixels, plotted

#: What the frame takes of the height above and below the bodies, in inches; the width of a picture, in inches.
TITLE, BAR, WIDTH = 0.4, 0.85, 8.0


@dataclass(frozen=True)
class Frame:
    """What is around bodies: view: how they are drawn; label: of the bar; names: of the three axes."""

    view: View
    label: str
    names: str


def framed(
    steps: Sequence[Sequence[Coloured]],
    titles: Sequence[str],
    frame: Frame,
    size: tuple[int, int],
    *,
    columns: int = 1,
    path: str | os.PathLike[str] | None = None,
) -> Picture:
    """One panel for each step, with its title, and below the axes' directions and one bar for all.

    size: (width, height) of the figure in pixels.
    """
    width, height = (as_count("size", number) for number in size)
    dpi = width / WIDTH
    rows = -(-len(steps) // columns)
    above, below = round(TITLE * dpi), round(BAR * dpi)
    panel = width // columns, (height - below) // rows - above
    if min(panel) < 10:
        raise ValueError(f"size = {size!r}: expected more, for {panel[0]} x {panel[1]} pixels are left for the bodies")
    picture = Picture(figsize=(width / dpi, height / dpi), dpi=dpi)
    for index, (bodies, title) in enumerate(zip(steps, titles, strict=True)):
        row, column = divmod(index, columns)
        corner = column * panel[0], height - (row + 1) * (panel[1] + above)
        axes = picture.add_axes((corner[0] / width, corner[1] / height, panel[0] / width, panel[1] / height))
        _draw_panel(axes, pixels(bodies, frame.view, panel), title, 12 if columns == 1 else 10)
    _draw_directions(picture.add_axes((0.03, 0.05 * below / height, 0.1, 0.9 * below / height)), frame)
    bar = picture.add_axes((0.25, 0.58 * below / height, 0.5, 0.2 * below / height))
    _draw_bar(picture, bar, frame)
    if path is not None:
        picture.save(path)
    return picture


def _draw_panel(axes: Any, pixels: NDArray[np.uint8], title: str, fontsize: int) -> None:
    axes.imshow(pixels, interpolation="none", aspect="auto")
    axes.set_axis_off()
    axes.set_title(title, fontsize=fontsize)


def _draw_bar(picture: Picture, axes: Any, frame: Frame) -> None:
    mapped = ScalarMappable(Normalize(*frame.view.limits), MAP)
    bar = picture.colorbar(mapped, cax=axes, orientation="horizontal", label=frame.label)
    bar.locator = MaxNLocator(nbins=6, steps=[1, 2, 2.5, 5, 10])
    short_numbers(bar.ax.xaxis)


def _draw_directions(axes: Any, frame: Frame) -> None:
    """Arrows along the axes as they are seen; one that points to the eye is left out."""
    seen = 0.7 * np.eye(3) @ frame.view.screen.T
    low, high = np.minimum(seen.min(axis=0), 0.0) - 0.3, np.maximum(seen.max(axis=0), 0.0) + 0.3
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    axes.set_axis_off()
    for end, name in zip(seen, frame.names, strict=True):
        if np.linalg.norm(end) > 0.1:
            axes.annotate("", end, (0, 0), arrowprops={"arrowstyle": "->", "shrinkA": 0, "shrinkB": 0})
            axes.annotate(name, 1.25 * end, ha="center", va="center")


def turning(picture: Picture, bodies: Sequence[Coloured], view: View) -> str | None:
    """The bodies in a frame that turns them, between the picture's title and its bar."""
    pixels = picture.pixels
    above, below = round(TITLE * picture.dpi), round(BAR * picture.dpi)
    height, width, _ = pixels.shape
    size = width, height - above - below
    frame = turnable(lambda: plotted(bodies, view, size), size)
    bar = pixels[-below:].copy()
    bar[:, : width // 6] = 255  # the axes, which turn
    return frame and "<br>".join([image(pixels[:above]), frame, image(bar)])
