"""Pictures of deformed bodies: what of them is drawn, and how."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..base.arrays import TINY, Floats
from ..base.checks import check_choice, finite, positive
from ..body_result import BodyResult
from ..kinematics import STRESSES
from .frame import Frame, framed, turning
from .picture import Picture, with_unit
from .render import Coloured, View

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


@dataclass(frozen=True)
class Drawing:
    """What is drawn of bodies: component: what colours them; frame: what is around them."""

    component: str
    frame: Frame

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
    coloured, view = drawn.coloured(bodies), drawn.frame.view
    title = title or f"displacements enlarged {view.scale:g} times"
    picture = framed([coloured], [title], drawn.frame, size, path=path)
    if bodies[0].dim == 3 or view.sweep:
        picture.turned = lambda: turning(picture, coloured, view)
    return picture


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
    limits = round_limits([shown(body, component) for body in bodies]) if limits is None else _increasing(limits)
    towards, up = FLAT if bodies[0].dim == 2 and not sweep else _direction(camera)
    scale = visible_scale(bodies) if scale is None else finite("scale", scale)
    middle = None if focus is None else _point(focus, 3 if sweep else bodies[0].dim)
    view = View(towards, up, scale, limits, positive("zoom", zoom), middle, edges, undeformed, sweep)
    rings = all(body.ring for body in bodies)
    label = with_unit(named(component, rings), unit)
    return Drawing(component, Frame(view, label, "rz " if rings and not sweep else "xyz"))


def named(component: str, rings: bool) -> str:
    """What is shown, in words."""
    if component in STRESSES:
        return f"{RING_STRESSES[component]} stress" if rings else f"stress {component}"
    return component if component == "displacement" else f"{component} stress"


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


def _increasing(limits: tuple[float, float]) -> tuple[float, float]:
    """The limits of a bar, checked."""
    low, high = (finite("limits", limit) for limit in limits)
    if low >= high:
        raise ValueError(f"limits = {limits!r}: expected the lower number first")
    return low, high


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
