"""Pictures of a contact: curves along it in the plane, a map on its facets in space (matplotlib)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import BoundaryNorm, ListedColormap

from ..base.arrays import Floats
from ..base.checks import check_choice
from ..contact_result import ContactResult
from ..surface_result import STATUS, SurfaceResult
from .picture import BLUE, GREY, MAP, RED, Figure, with_unit

SHOWN = ("pressure", "gap", "status")


#: The colours of the four states of a facet.
STATUS_COLOURS = ("#ffffff", "#dddddd", "#56B4E9", BLUE)


def plot_contact(
    result: ContactResult,
    surface: SurfaceResult | None,
    *,
    along: str | None = None,
    about: Sequence[float] | None = None,
    show: str = "pressure",
    path: str | Path | None = None,
    stress_unit: str | None = None,
    length_unit: str | None = None,
) -> Figure:
    """A figure of a contact: pressure and deformed gap over it, the closed part shaded and its edge marked.

    Args:
        result: the contact's values at its points.
        surface: the first body's facets, which a map in space is drawn on.
        along: what the curves are drawn over: "arc length", "x", "y", or in space "radius", the distance from
            `about`. By default a coordinate where the contact lies along it, else the arc length in the
            plane, and in space a map.
        about: the point that a radius is counted from, by default the centre of pressure.
        show: what a map shows: "pressure", "gap" or "status".
        path: where it is also saved, vector formats included, by the file's ending.
        stress_unit, length_unit: for the labels.
    """
    dim = result.x.shape[1]
    choices = ("arc length", "x", "y") if dim == 2 else ("radius",)
    if along is not None:
        check_choice("along", along, choices)
    check_choice("show", show, SHOWN)
    figure = Figure(figsize=(7.0, 4.6), layout="constrained")
    if dim == 3 and along is None and surface is not None:
        _draw_map(figure, surface, show, stress_unit, length_unit)
    else:
        along = along or natural_place(result)
        _draw_curves(figure, result, along, place(result, along, about), stress_unit, length_unit)
    if path is not None:
        figure.savefig(path, dpi=150)
    return figure


def natural_place(result: ContactResult) -> str:
    """The coordinate that a contact lies along, else its arc length; in space the radius."""
    if result.x.shape[1] == 3:
        return "radius"
    sizes = np.ptp(result.x, axis=0)
    straight = sizes.min() <= 1e-9 * sizes.max()
    return "xy"[int(np.argmax(sizes))] if straight or result.corners is None else "arc length"


def place(result: ContactResult, along: str, about: Sequence[float] | None = None) -> Floats:
    """The coordinates of the points along a contact, (n,), see `plot_contact`."""
    if along == "arc length":
        return result.arc_length
    if along == "radius":
        centre = result.centre_of_pressure if about is None else np.asarray(about, dtype=float)
        return np.linalg.norm(result.x - np.where(np.isnan(centre), result.x.mean(axis=0), centre), axis=1)
    return result.x[:, "xy".index(along)]


def _draw_curves(
    figure: Any, result: ContactResult, along: str, s: Floats, stress: str | None, length: str | None
) -> None:
    order = np.argsort(s, kind="stable")
    s, p, gap = s[order], result.pressure[order], result.gap[order]
    lines = {"linestyle": "none", "marker": ".", "markersize": 2} if along == "radius" else {}
    top, bottom = figure.subplots(2, 1, sharex=True)
    top.plot(s, p, color=BLUE, **lines)
    bottom.plot(s, gap, color=RED, **lines)
    if along != "radius":
        top.fill_between(s, p, color=BLUE, alpha=0.15)
        bottom.fill_between(s, gap, 0.0, where=(gap < 0.0) | result.bonded, color=RED, alpha=0.15)
        turns = np.flatnonzero((gap[1:] < 0.0) != (gap[:-1] < 0.0)) if not result.bonded else np.zeros(0, dtype=int)
        for edge in s[turns] + gap[turns] / (gap[turns] - gap[turns + 1]) * (s[turns + 1] - s[turns]):
            for axes in (top, bottom):
                axes.axvline(edge, color=GREY, linewidth=0.8, linestyle=":")
    bottom.axhline(0.0, color=GREY, linewidth=0.8)
    top.set_ylabel(with_unit("contact pressure", stress))
    if result.bonded:
        top.axhline(0.0, color=GREY, linewidth=0.8)
    else:
        top.set_ylim(bottom=0.0)
    bottom.set_ylabel(with_unit("deformed gap z", length))
    name = {"x": "radius r", "y": "axis z"}.get(along, along) if result.ring else along
    bottom.set_xlabel(with_unit(name, length))
    for axes in (top, bottom):
        axes.margins(x=0.0)
        axes.spines[["top", "right"]].set_visible(False)


def _draw_map(figure: Any, surface: SurfaceResult, show: str, stress: str | None, length: str | None) -> None:
    """The facets, each in one colour, and the edge of contact."""
    axes = figure.subplots()
    outlines = surface.outlines
    first, second = sorted(int(axis) for axis in np.argsort(np.ptp(outlines.reshape(-1, 3), axis=0))[1:])
    facets = PolyCollection(list(outlines[:, :, [first, second]]), linewidths=0.15, edgecolors="face")
    values = {"pressure": surface.pressure, "gap": surface.gap, "status": surface.status}[show]
    facets.set_array(values)
    if show == "status":
        facets.set_cmap(ListedColormap(list(STATUS_COLOURS)))
        facets.set_norm(BoundaryNorm(np.arange(-0.5, 4.0), 4))
        facets.set_edgecolor(GREY)
    else:
        facets.set_cmap(MAP)
    axes.add_collection(facets)
    edge = surface.edge
    if show != "status" and len(edge):
        axes.add_collection(LineCollection(list(edge[:, :, [first, second]]), colors="white", linewidths=1.4))
        axes.add_collection(LineCollection(list(edge[:, :, [first, second]]), colors="black", linewidths=0.6))
    label = {"pressure": with_unit("contact pressure", stress), "gap": with_unit("deformed gap z", length)}
    width, height = np.ptp(outlines.reshape(-1, 3), axis=0)[[first, second]]
    wide = width > 1.5 * height
    if wide:
        figure.set_size_inches(7.0, min(4.6, 2.0 + 6.0 * height / width))
    bar = figure.colorbar(facets, ax=axes, label=label.get(show, ""), location="bottom" if wide else "right")
    if show == "status":
        bar.set_ticks(list(STATUS), labels=list(STATUS.values()))
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.set_xlabel(with_unit("xyz"[first], length))
    axes.set_ylabel(with_unit("xyz"[second], length))
