"""Pictures: curves along a contact (matplotlib) and deformed bodies (pyvista, off screen)."""

from __future__ import annotations

import io
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib.figure
import numpy as np
from matplotlib.image import imsave
from numpy.typing import NDArray

from ..field import evaluate
from ..kinematics import STRESSES

if TYPE_CHECKING:
    from ..body import Body
    from ..contact import Contact
    from ..solution import ContactResult, Solution


BLUE, RED, GREY = "#1f5f8b", "#b5432e", "#7a7a7a"


@dataclass(frozen=True)
class Picture:
    """A rendered picture, shown inline in a notebook; pixels: (height, width, 3) bytes."""

    pixels: NDArray[np.uint8]

    def save(self, path: str | Path) -> Path:
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


def plot_contact(solution: Solution, contact: str | int | Contact = 0, *, path: str | Path | None = None) -> Figure:
    """Pressure and deformed gap along a contact, the closed part shaded: a matplotlib figure, also saved to `path`.

    In the plane the curves run along the contact; in space the pressure is drawn over it.
    """
    result = solution.contact(contact)
    figure = Figure(figsize=(7.0, 4.6), layout="constrained")
    if result.x.shape[1] == 2:
        _draw_curves(figure, result)
    else:
        _draw_map(figure, result)
    if path is not None:
        figure.savefig(path, dpi=150)
    return figure


def plot_bodies(
    solution: Solution,
    *,
    component: str = "yy",
    scale: float | None = None,
    path: str | Path | None = None,
    size: tuple[int, int] = (1200, 800),
    title: str | None = None,
) -> Picture:
    """The deformed bodies coloured by a stress component ("xx", "yy", "zz", "yz", "xz", "xy" or "von Mises").

    scale: how many times the displacements are enlarged (by default to a twentieth of the scene). Raises ValueError for
    an unknown component, RuntimeError where nothing can draw.
    """
    import pyvista

    from .display import ensure_display

    if component not in (*STRESSES, "von Mises"):
        raise ValueError(f"component = {component!r}: expected one of {', '.join(STRESSES)} or 'von Mises'")
    ensure_display()
    if scale is None:
        scale = _visible_scale(solution)
    name = f"stress {component}"
    grids = [_grid(solution, body, component, name) for body in solution.scene.bodies]
    limits = (min(float(grid[name].min()) for grid in grids), max(float(grid[name].max()) for grid in grids))
    plotter = pyvista.Plotter(off_screen=True, window_size=list(size))
    plotter.set_background("white")
    flat = solution.scene.bodies[0].mesh.dim == 2
    for grid in grids:
        warped = grid.warp_by_vector("drawn", factor=scale)
        # Light gives depth in space; in the plane it would only dull the colours.
        shading = {"lighting": False} if flat else {"ambient": 0.4, "diffuse": 0.6}
        bar = _bar_arguments(name)
        plotter.add_mesh(warped, scalars=name, clim=limits, cmap="viridis", scalar_bar_args=bar, **shading)
        edges = warped.extract_feature_edges(manifold_edges=False, feature_edges=not flat)
        plotter.add_mesh(edges, color="black", line_width=2)
    plotter.add_text(
        title or f"displacements enlarged {scale:.3g} times", font_size=11, color="black", position="upper_edge"
    )
    _look(plotter, flat)
    pixels = plotter.screenshot(return_img=True)
    plotter.close()
    picture = Picture(np.asarray(pixels)[:, :, :3])
    if path is not None:
        picture.save(path)
    return picture


def _look(plotter: Any, flat: bool) -> None:
    """Let everything fit between the title and the scalar bar: from the front, or from the left front corner above."""
    plotter.enable_parallel_projection()
    if flat:
        x0, x1, y0, y1, *_ = plotter.bounds
        width, height = plotter.window_size
        # The drawing gets seven tenths of the window's height and nine of its width.
        half = max((y1 - y0) / 0.7, (x1 - x0) / 0.9 * height / width) / 2
        plotter.view_xy()
        plotter.camera.parallel_scale = half
        focus = np.array([(x0 + x1) / 2, (y0 + y1) / 2 - 0.1 * half, 0.0])
        plotter.camera.focal_point, plotter.camera.position = focus, focus + [0.0, 0.0, 10 * half]
    else:
        plotter.view_vector((-1.0, -1.6, 0.9), viewup=(0.0, 0.0, 1.0))
        plotter.camera.zoom(0.85)


def plot(solution: Solution) -> list[Any]:
    """The bodies and every contact, as a list of pictures; in a notebook they are shown."""
    pictures = [plot_bodies(solution), *(plot_contact(solution, contact) for contact in solution.scene.contacts)]
    if _in_notebook():
        from IPython.display import display

        for picture in pictures:
            display(picture)
    return pictures


def body_grid(solution: Solution, body: Body) -> Any:
    """The mesh of a body as a pyvista grid with its displacement (points, 3) and six stresses (points, 6)."""
    import pyvista
    from dolfinx.plot import vtk_mesh

    grid = pyvista.UnstructuredGrid(*vtk_mesh(body.space))
    u = solution.displacement(body).x.array.reshape(-1, body.mesh.dim)
    grid.point_data["displacement"] = np.pad(u, ((0, 0), (0, 3 - body.mesh.dim)))
    grid.point_data["stress"] = _nodal_stress(solution, body)
    return grid


def _nodal_stress(solution: Solution, body: Body) -> NDArray[np.float64]:
    """The stresses at the nodes of the displacement, averaged over the cells around each, (nodes, 6)."""
    stress = solution.stress(body)
    element = stress.function_space.element.basix_element
    points = body.space.element.basix_element.points
    table = element.tabulate(0, points)[0, :, :, 0]
    cells = stress.x.array.reshape(-1, 6)[stress.function_space.dofmap.list]
    values = np.einsum("pn,cnk->cpk", table, cells).reshape(-1, 6)
    nodes = body.space.dofmap.list.ravel()
    count = np.bincount(nodes)
    return np.stack([np.bincount(nodes, values[:, k]) / count for k in range(6)], axis=1)


def _grid(solution: Solution, body: Body, component: str, name: str) -> Any:
    grid = body_grid(solution, body)
    stress = grid.point_data["stress"]
    grid.point_data["drawn"] = grid.point_data["displacement"] + _given_shape(solution, body, np.asarray(grid.points))
    grid.point_data[name] = von_mises(stress) if component == "von Mises" else stress[:, STRESSES.index(component)]
    return grid


def _given_shape(solution: Solution, body: Body, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far a body's true surface is from its mesh, (points, 3).

    A gap given as a function is a shape that the mesh of the contact's first body does not show. It is drawn as if cut
    into that body, fading out over the body's depth.
    """
    from scipy.spatial import cKDTree

    shift = np.zeros_like(points)
    dim = body.mesh.dim
    for interface in solution.interfaces:
        if interface.contact.sides[0][0] is not body or not np.any(interface.shape):
            continue
        nearest = cKDTree(interface.x).query(points[:, :dim])[1]
        normal = interface.normal[nearest]
        depth = np.sum((interface.x[nearest] - points[:, :dim]) * normal, axis=1)
        fade = 1.0 - np.clip(depth / max(float(depth.max()), np.finfo(float).tiny), 0.0, 1.0)
        above = points[:, :dim] + depth[:, None] * normal  # on the contact, where the gap is given
        shape = evaluate("gap", interface.contact.gap, above.T)
        shift[:, :dim] -= (fade * shape)[:, None] * normal
    return shift


def von_mises(stress: NDArray[np.float64]) -> NDArray[np.float64]:
    """The von Mises stress of stresses (..., 6) in the order xx, yy, zz, yz, xz, xy."""
    xx, yy, zz, yz, xz, xy = np.moveaxis(stress, -1, 0)
    squares = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2 + 6 * (yz**2 + xz**2 + xy**2)
    return np.sqrt(0.5 * squares)


def _draw_curves(figure: Any, result: ContactResult) -> None:
    # The coordinate that changes most stands for the place along the contact.
    axis = int(np.argmax(np.ptp(result.x, axis=0)))
    order = np.argsort(result.x[:, axis], kind="stable")
    x, p, gap = result.x[order, axis], result.pressure[order], result.gap[order]
    top, bottom = figure.subplots(2, 1, sharex=True)
    top.plot(x, p, color=BLUE)
    top.fill_between(x, p, color=BLUE, alpha=0.15)
    top.set_ylabel("contact pressure")
    top.set_ylim(bottom=0.0)
    bottom.plot(x, gap, color=RED)
    bottom.axhline(0.0, color=GREY, linewidth=0.8)
    bottom.fill_between(x, gap, 0.0, where=gap < 0.0, color=RED, alpha=0.15)
    bottom.set_ylabel("deformed gap z")
    bottom.set_xlabel("xy"[axis])
    for axes in (top, bottom):
        axes.margins(x=0.0)
        axes.spines[["top", "right"]].set_visible(False)


def _draw_map(figure: Any, result: ContactResult) -> None:
    axes = figure.subplots()
    flat = np.argsort(np.ptp(result.x, axis=0))[1:]
    first, second = sorted(int(axis) for axis in flat)
    points = axes.tripcolor(result.x[:, first], result.x[:, second], result.pressure, cmap="viridis", shading="gouraud")
    figure.colorbar(points, ax=axes, label="contact pressure")
    axes.set_aspect("equal")
    axes.set_xlabel("xyz"[first])
    axes.set_ylabel("xyz"[second])


def _visible_scale(solution: Solution) -> float:
    """An enlargement, one digit times a power of ten, that makes the largest displacement a twentieth of the scene."""
    coordinates = np.vstack([body.mesh.domain.geometry.x for body in solution.scene.bodies])
    size = float(np.ptp(coordinates, axis=0).max())
    largest = max(float(np.abs(solution.displacement(body).x.array).max()) for body in solution.scene.bodies)
    if largest == 0.0:
        return 1.0
    wanted = 0.05 * size / largest
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(np.floor(wanted / power) * power)


def _bar_arguments(name: str) -> dict[str, Any]:
    return {
        "title": f"{name}\n",  # the line break keeps the title clear of the numbers
        "color": "black",
        "n_labels": 5,
        "fmt": "%.3g",
        "position_x": 0.25,
        "position_y": 0.05,
    }


def _in_notebook() -> bool:
    return "ipykernel" in sys.modules
