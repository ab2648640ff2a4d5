"""Pictures of deformed bodies: what is drawn of them, and the frame around it with title, axes and bar (matplotlib)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.ticker import MaxNLocator

from ..base.arrays import TINY, Floats
from ..base.checks import check_choice, finite, positive
from ..body_result import BodyResult
from ..kinematics import STRESSES
from .interactive import image, turnable
from .picture import MAP, Picture, short_numbers, with_unit
from .render import Coloured, View, pixels, plotted

COMPONENTS = (*STRESSES, "von Mises", "displacement")


#: The directions from which a solid is looked at, and which way is up.
CAMERAS = {
    "corner": ((-1.0, -1.6, 0.9), (0.0, 0.0, 1.0)),
    "front": ((0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
    "side": ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "top": ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
}


#: The same for the plane.
FLAT = CAMERAS["top"]


#: What the stresses are called around an axis.
RING_STRESSES = {"xx": "radial", "yy": "axial", "zz": "hoop", "xy": "radial-axial shear", "yz": "yz", "xz": "xz"}


#: What the frame takes of the height above and below the bodies, in inches; the width of a picture, in inches.
TITLE, BAR, WIDTH = 0.4, 0.85, 8.0


@dataclass(frozen=True)
class Drawing:
    """What is drawn of bodies: view: how; component: what colours them; label: of the bar; names: of the three axes."""

    view: View
    component: str
    label: str
    names: str

    def coloured(self, bodies: Sequence[BodyResult]) -> list[Coloured]:
        """The bodies with their colours."""
        return [Coloured(body, shown(body, self.component)) for body in bodies]


def plot_bodies(
    bodies: Sequence[BodyResult],
    *,
    path: str | Path | None = None,
    size: tuple[int, int] = (1200, 800),
    title: str | None = None,
    **options: Any,
) -> Picture:
    """A picture of deformed bodies coloured by a stress.

    Args:
        bodies: to be drawn.
        path: where it is also saved; in vector formats the bodies are pixels, all else is vectors.
        size: width and height in pixels.
        title: by default how many times the displacements are enlarged.
        options: of `drawing`.

    Raises:
        ValueError: for an unknown component or camera.
        RuntimeError: where nothing can draw.
    """
    drawn = drawing(bodies, **options)
    picture = framed([bodies], [title or f"displacements enlarged {drawn.view.scale:g} times"], drawn, size, path=path)
    if bodies[0].dim == 3 or drawn.view.sweep:
        picture.turned = lambda: _turned(picture, drawn.coloured(bodies), drawn.view)
    return picture


def _turned(picture: Picture, bodies: Sequence[Coloured], view: View) -> str | None:
    """The bodies in a frame that turns them, between the picture's title and its bar."""
    pixels = picture.pixels
    above, below = round(TITLE * picture.dpi), round(BAR * picture.dpi)
    height, width, _ = pixels.shape
    size = width, height - above - below
    frame = turnable(lambda: plotted(bodies, view, size), size)
    bar = pixels[-below:].copy()
    bar[:, : width // 6] = 255  # the axes, which turn
    return frame and "<br>".join([image(pixels[:above]), frame, image(bar)])


def drawing(
    bodies: Sequence[BodyResult],
    *,
    component: str | None = None,
    scale: float | None = None,
    limits: tuple[float, float] | None = None,
    camera: str | tuple[float, float, float] = "corner",
    zoom: float = 1.0,
    focus: Sequence[float] | None = None,
    edges: bool = False,
    undeformed: bool = False,
    sweep: float = 0.0,
    unit: str | None = None,
) -> Drawing:
    """What is drawn of bodies, or of those of several steps.

    Gaps are enlarged as the displacements are, see `SurfaceFit`.

    Args:
        bodies: to be drawn.
        component: "xx", "yy", "zz", "yz", "xz", "xy", "von Mises" or "displacement"; by default the stress along the
            axis that the contacts' normals are nearest to.
        scale: how many times the displacements are enlarged, by default to a twentieth of the scene.
        limits: of the bar; by default round numbers around what is drawn.
        camera: how a solid is looked at: "corner", "front", "side", "top" or a direction (x, y, z) to look from.
        zoom: how much larger than what fits.
        focus: the point of the undeformed bodies that the middle of the picture shows, (x, y) or (x, y, z); by default
            their own middle.
        edges: whether the cells' edges are drawn.
        undeformed: whether the outline before deformation is drawn.
        sweep: through how many degrees bodies of revolution are turned about their axis; 0 draws their meridian.
        unit: of what is shown, for the bar.
    """
    component = normal_component(bodies) if component is None else check_choice("component", component, COMPONENTS)
    check_sweep(bodies, sweep)
    limits = round_limits([shown(body, component) for body in bodies]) if limits is None else limits
    towards, up = FLAT if bodies[0].dim == 2 and not sweep else _direction(camera)
    scale = visible_scale(bodies) if scale is None else scale
    middle = None if focus is None else _point(focus, 3 if sweep else bodies[0].dim)
    view = View(towards, up, scale, limits, positive("zoom", zoom), middle, edges, undeformed, sweep)
    rings = all(body.ring for body in bodies)
    label = with_unit(named(component, rings), unit)
    return Drawing(view, component, label, "rz " if rings and not sweep else "xyz")


def named(component: str, rings: bool) -> str:
    """What is shown, in words."""
    if component in STRESSES:
        return f"{RING_STRESSES[component]} stress" if rings else f"stress {component}"
    return component if component == "displacement" else f"{component} stress"


def framed(
    steps: Sequence[Sequence[BodyResult]],
    titles: Sequence[str],
    drawn: Drawing,
    size: tuple[int, int],
    *,
    columns: int = 1,
    path: str | Path | None = None,
) -> Picture:
    """One panel for each step, with its title, and below the axes' directions and one bar for all.

    size: (width, height) of the figure in pixels.
    """
    width, height = size
    dpi = width / WIDTH
    rows = -(-len(steps) // columns)
    above, below = round(TITLE * dpi), round(BAR * dpi)
    panel = width // columns, (height - below) // rows - above
    picture = Picture(figsize=(width / dpi, height / dpi), dpi=dpi)
    for index, (bodies, title) in enumerate(zip(steps, titles, strict=True)):
        row, column = divmod(index, columns)
        corner = column * panel[0], height - (row + 1) * (panel[1] + above)
        axes = picture.add_axes((corner[0] / width, corner[1] / height, panel[0] / width, panel[1] / height))
        axes.imshow(pixels(drawn.coloured(bodies), drawn.view, panel), interpolation="none", aspect="auto")
        axes.set_axis_off()
        axes.set_title(title, fontsize=12 if columns == 1 else 10)
    _draw_directions(picture.add_axes((0.03, 0.05 * below / height, 0.1, 0.9 * below / height)), drawn)
    bar = picture.add_axes((0.25, 0.58 * below / height, 0.5, 0.2 * below / height))
    _draw_bar(picture, bar, drawn)
    if path is not None:
        picture.save(path)
    return picture


def _draw_bar(picture: Picture, axes: Any, drawn: Drawing) -> None:
    mapped = ScalarMappable(Normalize(*drawn.view.limits), MAP)
    bar = picture.colorbar(mapped, cax=axes, orientation="horizontal", label=drawn.label)
    bar.locator = MaxNLocator(nbins=6, steps=[1, 2, 2.5, 5, 10])
    short_numbers(bar.ax.xaxis)


def _draw_directions(axes: Any, drawn: Drawing) -> None:
    """Arrows along the axes as they are seen; one that points to the eye is left out."""
    seen = 0.7 * np.eye(3) @ drawn.view.screen.T
    low, high = np.minimum(seen.min(axis=0), 0.0) - 0.3, np.maximum(seen.max(axis=0), 0.0) + 0.3
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    axes.set_axis_off()
    for end, name in zip(seen, drawn.names, strict=True):
        if np.linalg.norm(end) > 0.1:
            axes.annotate("", end, (0, 0), arrowprops={"arrowstyle": "->", "shrinkA": 0, "shrinkB": 0})
            axes.annotate(name, 1.25 * end, ha="center", va="center")


def check_sweep(bodies: Sequence[BodyResult], sweep: float) -> None:
    """Refuse to turn what is no body of revolution."""
    if not 0.0 <= finite("sweep", sweep) <= 360.0:
        raise ValueError(f"sweep = {sweep!r}: expected an angle from 0 to 360 degrees")
    if sweep and not all(body.ring for body in bodies):
        raise ValueError(f"sweep = {sweep!r}: expected bodies of revolution only, or 0")


def shown(body: BodyResult, component: str) -> Floats:
    """The values that a picture shows at a body's nodes, (n,)."""
    if component == "von Mises":
        return body.von_mises
    if component == "displacement":
        return np.linalg.norm(body.displacement, axis=1)
    return body.stress[:, STRESSES.index(component)]


def normal_component(bodies: Sequence[BodyResult]) -> str:
    """The stress along the axis that the contacts' normals are nearest to."""
    normals = [np.abs(fit.normal[fit.fade >= 1.0]).sum(axis=0) for body in bodies for fit in body.fits]
    return STRESSES[int(np.argmax(sum(normals)))] if normals else "yy"


def visible_scale(bodies: Sequence[BodyResult]) -> float:
    """An enlargement, one digit times a power of ten, that makes the largest displacement a twentieth of the scene."""
    size = float(np.ptp(np.vstack([body.points for body in bodies]), axis=0).max())
    largest = max(float(np.abs(body.displacement).max()) for body in bodies)
    if largest == 0.0:
        return 1.0
    wanted = 0.05 * size / largest
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(np.floor(wanted / power) * power)


def round_limits(values: Sequence[Floats]) -> tuple[float, float]:
    """Numbers of two digits around all values; around equal ones a tenth of them."""
    low, high = min(float(value.min()) for value in values), max(float(value.max()) for value in values)
    size = max(abs(low), abs(high))
    if high - low <= 1e-6 * size:  # equal but for rounding
        low, high = low - 0.1 * size, high + 0.1 * size
    step = 10.0 ** np.floor(np.log10(max(high - low, TINY)) - 1.0)
    first, last = np.floor(low / step + 1e-6), np.ceil(high / step - 1e-6)
    return float(first * step), float(max(last, first + 1.0) * step)


def _point(focus: Sequence[float], dim: int) -> tuple[float, ...]:
    """A point of space from one of `dim` coordinates, checked."""
    point = np.asarray(focus, dtype=float)
    if point.shape != (dim,) or not np.all(np.isfinite(point)):
        raise ValueError(f"focus = {focus!r}: expected the {dim} coordinates of a point")
    return tuple(np.pad(point, (0, 3 - dim)))


def _direction(camera: str | tuple[float, float, float]) -> tuple[Any, Any]:
    """The direction to look from, and which way is up."""
    if isinstance(camera, str):
        return CAMERAS[check_choice("camera", camera, tuple(CAMERAS))]
    towards = np.asarray(camera, dtype=float)
    if towards.shape != (3,) or not np.all(np.isfinite(towards)) or not towards.any():
        raise ValueError(f"camera = {camera!r}: expected one of {', '.join(CAMERAS)} or a direction (x, y, z)")
    steep = abs(towards[2]) > 0.99 * np.linalg.norm(towards)
    return tuple(towards), (0.0, 1.0, 0.0) if steep else (0.0, 0.0, 1.0)
