"""Rendered bodies that turn under the mouse in a notebook, where pyvista's trame packages are installed."""

from __future__ import annotations

import base64
import io
from collections.abc import Callable
from html import escape
from importlib.util import find_spec
from typing import Any

import numpy as np
from matplotlib.image import imsave
from numpy.typing import NDArray


def turnable(plotted: Callable[[], Any], size: tuple[int, int]) -> str | None:
    """A frame with the scene in it that needs no server and no network; None where trame cannot make it.

    plotted: what makes the scene, a pyvista plotter; size: (width, height) of the frame in pixels.
    """
    if find_spec("trame_vtk") is None:
        return None
    from .display import display

    try:
        with display():
            plotter = plotted()
            plotter.disable_parallel_projection()  # which the viewer does not know
            plotter.reset_camera()
            page = getattr(plotter, "trame", plotter).export_html(None).getvalue()
            plotter.close()
    except (ImportError, AttributeError, RuntimeError):  # a VTK without its web modules, such as Debian's
        return None
    return f'<iframe srcdoc="{escape(page)}" width="{size[0]}" height="{size[1]}" frameborder="0"></iframe>'


def image(pixels: NDArray[np.uint8]) -> str:
    """Pixels as an image in HTML."""
    buffer = io.BytesIO()
    imsave(buffer, pixels, format="png")
    return f'<img src="data:image/png;base64,{base64.b64encode(buffer.getvalue()).decode()}">'
