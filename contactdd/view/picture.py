"""Pictures: matplotlib figures that belong to no window, shown by a notebook."""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import matplotlib.figure
import numpy as np
from matplotlib.ticker import ScalarFormatter
from numpy.typing import NDArray

from ..base.notebook import in_notebook

#: Of the palette of Okabe and Ito, which readers of any colour sight tell apart; also in print without colours.
BLUE, RED, GREEN, GREY = "#0072B2", "#D55E00", "#009E73", "#7a7a7a"


#: Of even lightness steps, for values.
MAP = "viridis"


class Figure(matplotlib.figure.Figure):
    """A matplotlib figure that belongs to no window and shows itself in a notebook."""

    def save(self, path: str | os.PathLike[str]) -> Path:
        """The file written, of the format that its ending names; in vector formats maps are finer pixels."""
        file = Path(path)
        self.savefig(file, dpi=150 if file.suffix.lower() in (".png", ".jpg", ".jpeg") else 300)
        return file

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png", dpi=100)
        return buffer.getvalue()


class Picture(Figure):
    """A figure with rendered bodies in it, one pixel of the figure each of theirs.

    turned: what shows the picture as HTML whose bodies turn under the mouse, None where that cannot be had.
    """

    turned: Callable[[], str | None] | None = None

    @property
    def pixels(self) -> NDArray[np.uint8]:
        """The figure as pixels, (height, width, 3) bytes."""
        from matplotlib.backends.backend_agg import FigureCanvasAgg

        canvas = FigureCanvasAgg(self)
        canvas.draw()
        return np.asarray(canvas.buffer_rgba())[:, :, :3].copy()

    def save(self, path: str | os.PathLike[str]) -> Path:
        """The file written, of the format that its ending names; in vector formats text and bar are vectors."""
        self.savefig(path, dpi="figure")
        return Path(path)

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png", dpi="figure")
        return buffer.getvalue()

    def _repr_html_(self) -> str | None:
        return None if self.turned is None else self.turned()


def with_unit(label: str, unit: str | None) -> str:
    """A label with its unit, if that is known."""
    return label if unit is None else f"{label} [{unit}]"


def short_numbers(axis: Any) -> None:
    """Let the numbers on an axis be short: a power of ten beside it where they would have many zeros."""
    formatter = ScalarFormatter(useMathText=True)
    formatter.set_powerlimits((-2, 4))
    axis.set_major_formatter(formatter)


def show(pictures: Sequence[Any]) -> None:
    """Show pictures in a notebook; elsewhere nothing happens."""
    if in_notebook():
        from IPython.display import display

        for picture in pictures:
            display(picture)
