"""A picture of estimated errors: of the pressure along contacts, of the bodies' energy in cells (matplotlib)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import LogNorm

from ..base.arrays import TINY, Floats
from ..contact_result import ContactResult
from .contact_plot import natural_place, place, place_name
from .picture import BLUE, MAP, RED, Figure, with_unit

#: The decades of errors that are told apart by colour; smaller ones look alike.
DECADES = 4


@dataclass(frozen=True)
class ContactError:
    """A contact's pressure and its error.

    name: of the contact; result: its values; error: (n,) that of the pressure at its points.
    """

    name: str
    result: ContactResult
    error: Floats


@dataclass(frozen=True)
class CellErrors:
    """The cells of a plane body and their errors: outlines (cells, corners, 2), densities (cells,)."""

    outlines: Floats
    densities: Floats


def plot_error(
    contacts: Sequence[ContactError],
    bodies: Sequence[CellErrors],
    *,
    path: str | Path | None = None,
    stress_unit: str | None = None,
    length_unit: str | None = None,
) -> Figure:
    """A figure of every contact's pressure and the size of its error, and below of the bodies' cells, if there are any.

    Args:
        contacts: the contacts.
        bodies: the bodies in the plane.
        path: where it is also saved, vector formats included, by the file's ending.
        stress_unit, length_unit: for the labels.
    """
    columns = min(len(contacts), 3)
    rows = -(-len(contacts) // columns)
    figure = Figure(figsize=(max(7.0, 4.2 * columns), 2.6 * rows + (3.6 if bodies else 0.6)), layout="constrained")
    grid = figure.add_gridspec(rows + bool(bodies), columns, height_ratios=[1.0] * rows + [1.4] * bool(bodies))
    for index, contact in enumerate(contacts):
        _draw_contact(figure.add_subplot(grid[index // columns, index % columns]), contact, stress_unit, length_unit)
    if bodies:
        _draw_bodies(figure, figure.add_subplot(grid[rows, :]), bodies, stress_unit, length_unit)
    if path is not None:
        figure.save(path)
    return figure


def _draw_contact(axes: Any, contact: ContactError, stress: str | None, length: str | None) -> None:
    along = natural_place(contact.result)
    s = place(contact.result, along)
    order = np.argsort(s, kind="stable")
    s, p, error = s[order], contact.result.pressure[order], np.abs(contact.error[order])
    lines = {"linestyle": "none", "marker": ".", "markersize": 2} if along == "radius" else {"linewidth": 1.0}
    axes.plot(s, p, color=BLUE, **lines)
    axes.set_ylim(bottom=0.0)
    axes.set_title(contact.name, fontsize="medium")
    axes.set_xlabel(with_unit(place_name(contact.result, along), length))
    axes.set_ylabel(with_unit("contact pressure", stress), color=BLUE)
    other = axes.twinx()
    largest = max(float(error.max()), TINY)
    other.semilogy(s, np.where(error > largest * 10.0**-DECADES, error, np.nan), color=RED, **lines)
    other.set_ylabel(with_unit("its error", stress), color=RED)
    for each in (axes, other):
        each.margins(x=0.0)
        each.spines["top"].set_visible(False)


def _draw_bodies(figure: Any, axes: Any, bodies: Sequence[CellErrors], stress: str | None, length: str | None) -> None:
    largest = max(*(float(body.densities.max()) for body in bodies), TINY)
    least = largest * 10.0**-DECADES
    for body in bodies:
        cells = PolyCollection(list(body.outlines), cmap=MAP, norm=LogNorm(least, largest), edgecolors="face")
        cells.set_array(np.maximum(body.densities, least))
        cells.set_linewidth(0.1)
        axes.add_collection(cells)
    figure.colorbar(cells, ax=axes, label=with_unit("energy of the error by volume", stress))
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.set_xlabel(with_unit("x", length))
    axes.set_ylabel(with_unit("y", length))
