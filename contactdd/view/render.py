"""Deformed bodies as pixels, or as a scene that turns under the mouse (pyvista, off screen)."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats
from ..body_result import BodyResult
from .picture import MAP


@dataclass(frozen=True)
class View:
    """How bodies are drawn.

    towards: (3,) the direction to look from; up: (3,) which way is up; scale: of the displacements; limits: of the
    colours; zoom: how much larger than what fits; focus: (3,) the point in the middle, None for that of the bodies;
    edges, undeformed: whether cells' edges and the outline before deformation are drawn; sweep: through how many
    degrees meridians are turned.
    """

    towards: tuple[float, float, float]
    up: tuple[float, float, float]
    scale: float
    limits: tuple[float, float]
    zoom: float = 1.0
    focus: tuple[float, ...] | None = None
    edges: bool = False
    undeformed: bool = False
    sweep: float = 0.0

    @property
    def eye(self) -> Floats:
        """The unit vector towards the eye."""
        return np.asarray(self.towards, dtype=float) / np.linalg.norm(self.towards)

    @property
    def screen(self) -> Floats:
        """The unit vectors to the right and upwards, (2, 3)."""
        right = np.cross(self.up, self.eye)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(self.eye, right)])


@dataclass(frozen=True)
class Coloured:
    """A body and the values (n,) at its nodes that colour it."""

    body: BodyResult
    values: Floats


def pixels(bodies: Sequence[Coloured], view: View, size: tuple[int, int]) -> NDArray[np.uint8]:
    """The bodies on white, (height, width, 3) bytes. Raises RuntimeError where nothing can draw."""
    from .display import display

    with display():
        plotter = plotted(bodies, view, size)
        shot = plotter.screenshot(return_img=True)
        plotter.close()
    return np.asarray(shot)[:, :, :3]


def plotted(bodies: Sequence[Coloured], view: View, size: tuple[int, int]) -> Any:
    """The bodies in a pyvista plotter, which looks at them as `view` says. Nothing is lit: colours are the bar's."""
    import pyvista

    plotter = pyvista.Plotter(off_screen=True, window_size=list(size))
    plotter.set_background("white")
    shapes = [[each.body.drawn(view.scale), each.body.points][: 1 + view.undeformed] for each in bodies]
    points = _in_space(np.vstack([points for shape in shapes for points in shape]))
    points = turned(points, view.sweep) if view.sweep else points
    # Lines are a little nearer to the eye than the surfaces that they are on, which moves nothing in the picture.
    nearer = 3e-3 * float(np.ptp(points, axis=0).max()) * view.eye
    for each, shape in zip(bodies, shapes, strict=True):
        grids = [grid(each.body, points) for points in shape]
        grids[0].point_data["shown"] = each.values
        mesh, *before = [swept(mesh, view.sweep) for mesh in grids] if view.sweep else grids
        plotter.add_mesh(mesh, scalars="shown", clim=view.limits, cmap=MAP, show_scalar_bar=False, lighting=False)
        _add_lines(plotter, mesh, before, nearer, flat=each.body.dim == 2 and not view.sweep, edges=view.edges)
    _look(plotter, points, view)
    return plotter


def grid(body: BodyResult, points: Floats) -> Any:
    """A body as a pyvista grid with its nodes at the given points (n, dim)."""
    import pyvista

    cells = np.insert(body.cells, 0, body.cells.shape[1], axis=1).ravel()
    return pyvista.UnstructuredGrid(cells, np.full(len(body.cells), body.cell_type, dtype=np.uint8), _in_space(points))


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
    r = meridian.points[:, 0]
    r[np.abs(r) < 1e-9 * np.abs(r).max()] = 0.0  # else points on the axis, not quite one, are edges of slits
    return meridian.extrude_rotate(angle=sweep, resolution=1 + int(sweep / 2.0), capping=sweep < 360.0).clean()


def _in_space(points: Floats) -> Floats:
    """Points (n, 2) of the plane or (n, 3) of space as points of space."""
    return np.pad(points, ((0, 0), (0, 3 - points.shape[1])))


def _surface(mesh: Any, subdivision: int) -> Any:
    """The faces around a mesh, curved ones in pieces; newer pyvistas want to be told how they are found."""
    known = "algorithm" in inspect.signature(mesh.extract_surface).parameters
    return mesh.extract_surface(nonlinear_subdivision=subdivision, **{"algorithm": "dataset_surface"} if known else {})


def _outline(mesh: Any, flat: bool) -> Any:
    # Cells that have shrunk on an axis would be third ones at the edges of others, which then are none.
    return (
        _surface(mesh, 1)
        .triangulate()
        .clean()
        .extract_feature_edges(
            manifold_edges=False, feature_edges=not flat, boundary_edges=True, non_manifold_edges=False
        )
    )


def _add_lines(plotter: Any, mesh: Any, before: Sequence[Any], nearer: Floats, *, flat: bool, edges: bool) -> None:
    """Draw the outline of a body, its cells' edges if asked for, and the outlines that it had before."""
    for shape in before:
        plotter.add_mesh(_outline(shape, flat), color="#555555", line_width=2)
    plotter.add_mesh(_outline(mesh, flat).translate(nearer), color="black", line_width=2)
    if edges:
        cells = _surface(mesh, 0).extract_all_edges()
        plotter.add_mesh(cells.translate(nearer), color="black", line_width=1, opacity=0.5)


def _look(plotter: Any, points: Floats, view: View) -> None:
    """Let everything fit into the window, with a margin of a fiftieth."""
    plotter.enable_parallel_projection()
    seen = points @ view.screen.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    width, height = plotter.window_size
    half = max(high[1] - low[1], (high[0] - low[0]) * height / width) / (2 * 0.96 * view.zoom)
    depth = points @ view.eye
    middle = (low + high) / 2 if view.focus is None else view.screen @ view.focus
    focus = middle @ view.screen + depth.mean() * view.eye
    plotter.camera.focal_point = focus
    plotter.camera.position = focus + (np.ptp(depth) + 10 * half) * view.eye
    plotter.camera.up = view.screen[1]
    plotter.camera.parallel_scale = half
    plotter.renderer.ResetCameraClippingRange()
