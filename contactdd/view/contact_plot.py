"""Pictures of a contact: curves along it, or in space a map of it (matplotlib)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..base.arrays import Floats
from ..base.checks import check_choice
from ..contact_result import ContactResult
from ..surface_result import Surfaces
from .contact_map import SHOWN, draw_map, window
from .picture import BLUE, GREY, RED, Figure, short_numbers, with_unit


def plot_contact(
    result: ContactResult,
    surfaces: Surfaces,
    *,
    along: str | None = None,
    about: Sequence[float] | None = None,
    show: str = "pressure",
    whole: bool = False,
    path: str | Path | None = None,
    stress_unit: str | None = None,
    length_unit: str | None = None,
) -> Figure:
    """A figure of a contact: pressure and deformed gap over it, the closed part shaded and its edge marked.

    Args:
        result: the contact's values at its points.
        surfaces: the facets of both bodies, which a map in space is drawn on.
        along: what the curves are drawn over: "arc length", "x", "y", or in space "radius", the distance from
            `about`. By default a coordinate where the contact lies along it, else the arc length in the
            plane, and in space a map.
        about: the point that a radius is counted from, by default the centre of pressure.
        show: what a map shows: "pressure", "gap" or "status".
        whole: whether all of the surface is shown, not only what lies around the closed part.
        path: where it is also saved, vector formats included, by the file's ending.
        stress_unit, length_unit: for the labels.
    """
    dim = result.x.shape[1]
    choices = ("arc length", "x", "y") if dim == 2 else ("radius",)
    if along is not None:
        check_choice("along", along, choices)
    check_choice("show", show, SHOWN)
    figure = Figure(figsize=(7.0, 4.6), layout="constrained")
    if dim == 3 and along is None and any(surfaces):
        draw_map(figure, result, surfaces, show, whole, stress_unit, length_unit)
    else:
        along = along or natural_place(result)
        s = place(result, along, about)
        shown = _extent(result, along, s, whole)
        _draw_curves(figure, result, along, s, shown, stress_unit, length_unit)
    if path is not None:
        figure.save(path)
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


def place_name(result: ContactResult, along: str) -> str:
    """The coordinate along a contact in words: of a meridian x is the radius and y the axis."""
    return {"x": "radius r", "y": "axis z"}.get(along, along) if result.ring else along


def _extent(result: ContactResult, along: str, s: Floats, whole: bool) -> tuple[float, float]:
    """What is shown of a contact whose points are at s (n,): all of its surface or what is around its closed part."""
    surface = np.array([0.0 if along == "radius" else s.min(), s.max()])
    if result.corners is not None and along == "arc length":
        surface = np.array([0.0, np.linalg.norm(np.diff(result.corners, axis=1), axis=2).sum()])
    elif result.corners is not None and along != "radius":
        surface = result.corners[:, :, "xy".index(along)].ravel()
    low, high = window(surface[:, None], s[result.closed & (not whole), None])
    return float(low[0]), float(high[0])


def _draw_curves(
    figure: Any,
    result: ContactResult,
    along: str,
    s: Floats,
    shown: tuple[float, float],
    stress: str | None,
    length: str | None,
) -> None:
    order = np.argsort(s, kind="stable")
    s, p, gap = s[order], result.pressure[order], result.gap[order]
    lines = {"linestyle": "none", "marker": ".", "markersize": 2} if along == "radius" else {}
    top, bottom = figure.subplots(2, 1, sharex=True)
    top.plot(s, p, color=BLUE, **lines)
    bottom.plot(s, gap, color=RED, **lines)
    if along != "radius":
        top.fill_between(s, p, color=BLUE, alpha=0.15)
        bottom.fill_between(s, gap, 0.0, where=result.closed[order], color=RED, alpha=0.15)
        _mark_edges((top, bottom), s, result._opening[order])
    bottom.axhline(0.0, color=GREY, linewidth=0.8)
    top.set_ylabel(with_unit("contact pressure", stress))
    bottom.set_ylabel(with_unit("deformed gap", length))
    bottom.set_xlabel(with_unit(place_name(result, along), length))
    bottom.set_xlim(shown)
    inside = gap[(s >= shown[0]) & (s <= shown[1])]
    low, high = min(float(inside.min()), 0.0), max(float(inside.max()), 0.0)
    bottom.set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))
    if result.bonded:
        top.axhline(0.0, color=GREY, linewidth=0.8)
    else:
        top.set_ylim(bottom=0.0)
    for axes in (top, bottom):
        axes.spines[["top", "right"]].set_visible(False)
        short_numbers(axes.yaxis)
    short_numbers(bottom.xaxis)
    figure.align_ylabels()


def _mark_edges(panels: Sequence[Any], s: Floats, opening: Floats) -> None:
    """Mark where a contact opens: where `opening` (n,) changes its sign over s (n,)."""
    turns = np.flatnonzero((opening[1:] < 0.0) != (opening[:-1] < 0.0))
    share = opening[turns] / (opening[turns] - opening[turns + 1])
    for edge in s[turns] + share * (s[turns + 1] - s[turns]):
        for axes in panels:
            axes.axvline(edge, color=GREY, linewidth=0.8, linestyle=":")
