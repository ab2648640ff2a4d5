"""Pictures of deformed bodies (pyvista, off screen)."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..base.arrays import TINY, Floats
from ..base.checks import check_choice, finite, positive
from ..body_result import BodyResult
from ..kinematics import STRESSES
from .picture import MAP, Picture, with_unit

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


def plot_bodies(
    bodies: Sequence[BodyResult],
    *,
    component: str | None = None,
    scale: float | None = None,
    limits: tuple[float, float] | None = None,
    camera: str | tuple[float, float, float] = "corner",
    zoom: float = 1.0,
    edges: bool = False,
    undeformed: bool = False,
    sweep: float = 0.0,
    unit: str | None = None,
    path: str | Path | None = None,
    size: tuple[int, int] = (1200, 800),
    title: str | None = None,
) -> Picture:
    """A picture of deformed bodies coloured by a stress.

    Colours are those of the bar: nothing is lit. Gaps are enlarged as the displacements are, see `SurfaceFit`.

    Args:
        bodies: to be drawn.
        component: "xx", "yy", "zz", "yz", "xz", "xy", "von Mises" or "displacement"; by default the stress along the
            axis that the contacts' normals are nearest to.
        scale: how many times the displacements are enlarged, by default to a twentieth of the scene.
        limits: of the bar; by default round numbers around what is drawn.
        camera: how a solid is looked at: "corner", "front", "side", "top" or a direction (x, y, z) to look from.
        zoom: how much larger than what fits.
        edges: whether the cells' edges are drawn.
        undeformed: whether the outline before deformation is drawn.
        sweep: through how many degrees bodies of revolution are turned about their axis; 0 draws their meridian.
        unit: of what is shown, for the bar.
        path: where it is also saved.
        size: width and height in pixels.
        title: by default how many times the displacements are enlarged.

    Raises:
        ValueError: for an unknown component or camera.
        RuntimeError: where nothing can draw.
    """
    import pyvista

    from .display import display

    component = normal_component(bodies) if component is None else check_choice("component", component, COMPONENTS)
    check_sweep(bodies, sweep)
    flat = bodies[0].dim == 2 and not sweep
    direction = FLAT if flat else _direction(camera)
    zoom = positive("zoom", zoom)
    scale = visible_scale(bodies) if scale is None else scale
    name = with_unit(component if component == "displacement" else f"stress {component}", unit)
    points = _in_space(np.vstack([body.drawn(scale) for body in bodies]))
    points = turned(points, sweep) if sweep else points
    values = [shown(body, component) for body in bodies]
    limits, labels = (limits, 5) if limits is not None else round_limits(values)
    with display():
        plotter = pyvista.Plotter(off_screen=True, window_size=list(size))
        plotter.set_background("white")
        # Lines are a little nearer to the eye than the surfaces that they are on, which moves nothing in the picture.
        nearer = 3e-3 * float(np.ptp(points, axis=0).max()) * np.asarray(direction[0]) / np.linalg.norm(direction[0])
        for body, value in zip(bodies, values, strict=True):
            mesh = grid(body, body.drawn(scale))
            mesh.point_data[name] = value
            shapes = [mesh, grid(body, body.points)] if undeformed else [mesh]
            mesh, *before = [swept(shape, sweep) for shape in shapes] if sweep else shapes
            bar = _bar_arguments(name, labels)
            plotter.add_mesh(mesh, scalars=name, clim=limits, cmap=MAP, scalar_bar_args=bar, lighting=False)
            _add_lines(plotter, mesh, before, nearer, flat=flat, edges=edges)
        plotter.add_text(
            title or f"displacements enlarged {scale:g} times", font_size=11, color="black", position="upper_edge"
        )
        plotter.add_axes(color="black", line_width=3, zlabel="" if flat else "z")
        _look(plotter, points, direction, zoom)
        pixels = plotter.screenshot(return_img=True)
        plotter.close()
    picture = Picture(np.asarray(pixels)[:, :, :3])
    if path is not None:
        picture.save(path)
    return picture


def grid(body: BodyResult, points: Floats) -> Any:
    """A body as a pyvista grid with its nodes at the given points (n, dim)."""
    import pyvista

    cells = np.insert(body.cells, 0, body.cells.shape[1], axis=1).ravel()
    return pyvista.UnstructuredGrid(cells, np.full(len(body.cells), body.cell_type, dtype=np.uint8), _in_space(points))


def check_sweep(bodies: Sequence[BodyResult], sweep: float) -> None:
    """Refuse to turn what is no body of revolution."""
    if not 0.0 <= finite("sweep", sweep) <= 360.0:
        raise ValueError(f"sweep = {sweep!r}: expected an angle from 0 to 360 degrees")
    if sweep and not all(body.ring for body in bodies):
        raise ValueError(f"sweep = {sweep!r}: expected bodies of revolution only, or 0")


def turned(points: Floats, sweep: float) -> Floats:
    """Points (r, y, 0) of a meridian at angles through the sweep, the axis as z."""
    angles = np.radians(np.linspace(0.0, sweep, 1 + max(int(np.ceil(sweep / 5.0)), 1)))
    r, y = points[:, 0], points[:, 1]
    return np.concatenate([np.column_stack([r * np.cos(a), r * np.sin(a), y]) for a in angles])


def swept(mesh: Any, sweep: float) -> Any:
    """The surface of a body of revolution, from its meridian as a pyvista grid, the axis as z."""
    meridian = _surface(mesh, 2).triangulate()
    # Else neighbouring cells that are numbered in opposite senses would seem to meet at an edge.
    meridian = meridian.compute_normals(point_normals=False, consistent_normals=True, split_vertices=False)
    meridian.points = np.asarray(meridian.points)[:, [0, 2, 1]]
    return meridian.extrude_rotate(angle=sweep, resolution=1 + int(sweep / 2.0), capping=sweep < 360.0).clean()


def _in_space(points: Floats) -> Floats:
    """Points (n, 2) of the plane or (n, 3) of space as points of space."""
    return np.pad(points, ((0, 0), (0, 3 - points.shape[1])))


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


def round_limits(values: Sequence[Floats]) -> tuple[tuple[float, float], int]:
    """Round numbers around all values, and how many labels between them are round too."""
    low, high = min(float(value.min()) for value in values), max(float(value.max()) for value in values)
    # Stresses that are equal but for rounding are one number.
    spread = max(high - low, 1e-6 * max(abs(low), abs(high)), TINY)
    power = 10.0 ** np.floor(np.log10(spread / 4.0))
    step = next(power * factor for factor in (1.0, 2.0, 2.5, 5.0, 10.0) if spread / (power * factor) <= 5.0)
    first, last = np.floor(low / step + 1e-9), np.ceil(high / step - 1e-9)
    if last <= first:
        last = first + 1.0
    return (float(first * step), float(last * step)), int(last - first) + 1


def _direction(camera: str | tuple[float, float, float]) -> tuple[Any, Any]:
    """The direction to look from, and which way is up."""
    if isinstance(camera, str):
        return CAMERAS[check_choice("camera", camera, tuple(CAMERAS))]
    towards = np.asarray(camera, dtype=float)
    if towards.shape != (3,) or not np.all(np.isfinite(towards)) or not towards.any():
        raise ValueError(f"camera = {camera!r}: expected one of {', '.join(CAMERAS)} or a direction (x, y, z)")
    steep = abs(towards[2]) > 0.99 * np.linalg.norm(towards)
    return towards, (0.0, 1.0, 0.0) if steep else (0.0, 0.0, 1.0)


def _surface(mesh: Any, subdivision: int) -> Any:
    """The faces around a mesh, curved ones in pieces; newer pyvistas want to be told how they are found."""
    known = "algorithm" in inspect.signature(mesh.extract_surface).parameters
    return mesh.extract_surface(nonlinear_subdivision=subdivision, **{"algorithm": "dataset_surface"} if known else {})


def _outline(mesh: Any, flat: bool) -> Any:
    return _surface(mesh, 1).extract_feature_edges(
        manifold_edges=False, feature_edges=not flat, boundary_edges=True, non_manifold_edges=False
    )


def _add_lines(plotter: Any, mesh: Any, before: Sequence[Any], nearer: Floats, *, flat: bool, edges: bool) -> None:
    """Draw the outline of a body, its cells' edges if asked for, and the outlines that it had before."""
    plotter.add_mesh(_outline(mesh, flat).translate(nearer), color="black", line_width=2)
    if edges:
        plotter.add_mesh(_cell_edges(mesh).translate(nearer), color="black", line_width=1, opacity=0.5)
    for shape in before:
        plotter.add_mesh(_outline(shape, flat), color="grey", line_width=1)


def _cell_edges(mesh: Any) -> Any:
    return _surface(mesh, 0).extract_all_edges()


def _look(plotter: Any, points: Floats, direction: tuple[Any, Any], zoom: float) -> None:
    """Let everything fit between the title and the scalar bar: seven tenths of the height, nine of the width."""
    plotter.enable_parallel_projection()
    towards = np.asarray(direction[0], dtype=float) / np.linalg.norm(direction[0])
    right = np.cross(direction[1], towards)
    right /= np.linalg.norm(right)
    up = np.cross(towards, right)
    seen = points @ np.stack([right, up]).T
    low, high = seen.min(axis=0), seen.max(axis=0)
    width, height = plotter.window_size
    half = max((high[1] - low[1]) / 0.7, (high[0] - low[0]) / 0.9 * height / width) / (2 * zoom)
    across, depth = (low + high) / 2 - [0.0, 0.1 * half], points @ towards
    focus = across @ np.stack([right, up]) + depth.mean() * towards
    plotter.camera.focal_point = focus
    plotter.camera.position = focus + (np.ptp(depth) + 10 * half) * towards
    plotter.camera.up = up
    plotter.camera.parallel_scale = half
    plotter.renderer.ResetCameraClippingRange()


def _bar_arguments(name: str, labels: int) -> dict[str, Any]:
    return {
        "title": f"{name}\n",  # the line break keeps the title clear of the numbers
        "color": "black",
        "n_labels": labels,
        "fmt": "%.4g",
        "position_x": 0.25,
        "position_y": 0.05,
    }
