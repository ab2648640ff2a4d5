"""Pictures: matplotlib figures or rendered pixels, both shown by a notebook."""

from __future__ import annotations

import io
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib.figure
import numpy as np
from matplotlib.image import imsave
from numpy.typing import NDArray

#: Of the palette of Okabe and Ito, which readers of any colour sight tell apart; also in print without colours.
BLUE, RED, GREEN, GREY = "#0072B2", "#D55E00", "#009E73", "#7a7a7a"


#: Of even lightness steps, for values.
MAP = "viridis"


@dataclass(frozen=True)
class Picture:
    """A rendered picture, shown inline in a notebook; pixels: (height, width, 3) bytes."""

    pixels: NDArray[np.uint8]

    def save(self, path: str | Path) -> Path:
        """The file written, of the format that its ending names."""
        imsave(path, self.pixels)
        return Path(path)

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        imsave(buffer, self.pixels, format="png")
        return buffer.getvalue()


class Figure(matplotlib.figure.Figure):
    """A matplotlib figure that belongs to no window and shows itself in a notebook."""

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png", dpi=100)
        return buffer.getvalue()


def with_unit(label: str, unit: str | None) -> str:
    """A label with its unit, if that is known."""
    return label if unit is None else f"{label} [{unit}]"


def show(pictures: Sequence[Any]) -> None:
    """Show pictures in a notebook; elsewhere nothing happens."""
    if "ipykernel" in sys.modules:
        from IPython.display import display

        for picture in pictures:
            display(picture)
