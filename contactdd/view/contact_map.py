"""Maps of a contact in space: its facets, seen along the normal, and the edge of contact (matplotlib)."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.tri import Triangulation

from ..base.arrays import Floats, Indices
from ..base.scattered import scattered
from ..contact_result import ContactResult
from ..surface_result import STATUS, SurfaceResult, Surfaces
from .picture import BLUE, GREY, MAP, short_numbers, with_unit

SHOWN = ("pressure", "gap", "status")


#: The colours of the four states of a facet.
STATUS_COLOURS = ("#ffffff", "#dddddd", "#56B4E9", BLUE)


def draw_map(
    figure: Any,
    result: ContactResult,
    surfaces: Surfaces,
    show: str,
    whole: bool,
    stress: str | None,
    length: str | None,
) -> None:
    """Draw what `show` says on the facets, and the edge of contact."""
    axes = figure.subplots()
    surface, points = mapped(result, surfaces)
    axis, facing = seen_along(result, surface)
    plane = [other for other in range(3) if other != axis]
    outlines = surface.outlines[facing][:, :, plane]
    low, high = _window(outlines, surface.closed[facing], whole)
    if show == "status":
        drawn = _draw_status(axes, outlines, surface.status[facing])
    else:
        told = surface.covered[facing] > 1e-6
        points = None if points is None else points[facing][told]
        drawn = _draw_values(axes, result, outlines[told], points, plane, show, (low, high))
    wide = high[0] - low[0] > 1.5 * (high[1] - low[1])
    if wide:
        figure.set_size_inches(7.0, min(4.6, 2.0 + 6.0 * (high[1] - low[1]) / (high[0] - low[0])))
    label = {"pressure": with_unit("contact pressure", stress), "gap": with_unit("deformed gap", length)}
    bar = figure.colorbar(drawn, ax=axes, label=label.get(show, ""), location="bottom" if wide else "right", aspect=30)
    if show == "status":
        bar.set_ticks(list(STATUS), labels=list(STATUS.values()))
    else:
        short_numbers(bar.ax.xaxis if wide else bar.ax.yaxis)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    axes.set_xlabel(with_unit("xyz"[plane[0]], length))
    axes.set_ylabel(with_unit("xyz"[plane[1]], length))


def mapped(result: ContactResult, surfaces: Surfaces) -> tuple[SurfaceResult, Indices | None]:
    """The surface that a map is drawn on, and which points (f, corners) are its facets' corners.

    That is the surface of the nodes where the contact's points are nodes, as in hard contact, else the one of which the
    larger part lies opposite the other, and no points.
    """
    from scipy.spatial import cKDTree

    found, tree = [surface for surface in surfaces if surface is not None], cKDTree(result.x)
    for surface in found:
        away, points = tree.query(surface.outlines)
        if away.max() <= 1e-9 * np.ptp(result.x, axis=0).max():
            return surface, points
    return max(found, key=lambda each: each.areas @ each.covered / each.areas.sum()), None


def seen_along(result: ContactResult, surface: SurfaceResult) -> tuple[int, Any]:
    """The axis that the normals of the closed part are nearest to, and the mask (f,) of the facets that can be seen
    along it from the side where most of them face."""
    from scipy.spatial import cKDTree

    pressed = result.weights * result.closed
    normal = (pressed if np.any(pressed) else result.weights) @ (result.normal * np.abs(result.normal))
    axis = int(np.argmax(np.abs(normal)))
    nearest = cKDTree(result.x).query(surface.outlines.mean(axis=1))[1]
    return axis, result.normal[nearest, axis] * np.sign(normal[axis]) > 0.05


def _window(outlines: Floats, closed: Floats, whole: bool) -> tuple[Floats, Floats]:
    """The corners of what is shown: the box of the closed facets and half of its size around it, or all facets."""
    part = outlines if whole else outlines[closed > 0.0]
    low, high = window(outlines.reshape(-1, 2), part.reshape(-1, 2))
    margin = 0.02 * (high - low).max()
    return low - margin, high + margin


def window(places: Floats, part: Floats) -> tuple[Floats, Floats]:
    """The ends of places (n, k), as far as they are within half of its size around a part of them (m, k), if any."""
    low, high = places.min(axis=0), places.max(axis=0)
    if len(part) == 0:
        return low, high
    around = 0.5 * float(np.ptp(part, axis=0).max())
    return np.maximum(low, part.min(axis=0) - around), np.minimum(high, part.max(axis=0) + around)


def _draw_status(axes: Any, outlines: Floats, status: Any) -> Any:
    facets = PolyCollection(list(outlines), linewidths=0.3, edgecolors=GREY)
    facets.set_array(status)
    facets.set_cmap(ListedColormap(list(STATUS_COLOURS)))
    facets.set_norm(BoundaryNorm(np.arange(-0.5, 4.0), 4))
    return axes.add_collection(facets)


def _draw_values(
    axes: Any,
    result: ContactResult,
    outlines: Floats,
    points: Indices | None,
    plane: list[int],
    show: str,
    seen: tuple[Floats, Floats],
) -> Any:
    """The values of the points, linear in between, on the facets in pieces as fine as the points, and the edge."""
    pieces = min(max(int(np.ceil(np.sqrt(len(result.x) / max(len(outlines), 1)))), 2), 8)
    triangles = cut(outlines, pieces)
    size = float(np.ptp(outlines.reshape(-1, 2), axis=0).max())
    keys = (triangles.reshape(-1, 2) / size).round(9)
    _, first, numbers = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    corners = triangles.reshape(-1, 2)[first]
    values = np.stack([{"pressure": result.pressure, "gap": result.gap}[show], result._opening], axis=1)
    if points is None:
        told = scattered(result.x[:, plane], values, corners)
    else:
        told = cut(values[points], pieces).reshape(-1, 2)[first]
    shown, opening = told.T
    mesh = Triangulation(*corners.T, numbers.reshape(-1, 3))
    drawn = axes.tripcolor(mesh, shown, shading="gouraud", cmap=MAP, rasterized=True)
    inside = shown[np.all((corners >= seen[0]) & (corners <= seen[1]), axis=1)]
    drawn.set_clim(inside.min(), inside.max())
    if opening.min() < 0.0 < opening.max():
        for colour, width in (("white", 1.8), ("black", 0.8)):
            axes.tricontour(mesh, opening, levels=[0.0], colors=colour, linewidths=width)
    return drawn


def cut(outlines: Floats, pieces: int) -> Floats:
    """Triangles (t, 3, 2) of facets (f, corners, 2), each side cut into so many pieces; or values of theirs.

    Four corners are four triangles around the middle: neither diagonal is before the other.
    """
    if outlines.shape[1] == 4:
        middle = np.broadcast_to(outlines.mean(axis=1, keepdims=True), outlines.shape)
        outlines = np.stack([middle, outlines, np.roll(outlines, -1, axis=1)], axis=2).reshape(-1, 3, outlines.shape[2])
    i, j = np.indices((pieces, pieces)).reshape(2, -1)
    upright, turned = np.stack([[i, j], [i + 1, j], [i, j + 1]]), np.stack([[i + 1, j], [i + 1, j + 1], [i, j + 1]])
    places = np.concatenate([upright[..., i + j < pieces], turned[..., i + j < pieces - 1]], axis=2) / pieces
    shares = np.stack([1.0 - places.sum(axis=1), places[:, 0], places[:, 1]])  # of a facet's corners at a triangle's
    return np.einsum("wck,fwd->fkcd", shares, outlines).reshape(-1, 3, 2)
