"""Maps of contacts in space show the contact as it lies; pictures can be looked at closely; load programmes move."""

from __future__ import annotations

import sys

import matplotlib
import numpy as np
import pytest
import test_numbers_out
import test_pictures
from matplotlib.collections import TriMesh
from scenes import groove

import contactdd as cd
from contactdd.view import movie
from contactdd.view.contact_map import cut

pytest.importorskip("pyvista")

STEEL, LOAD = test_numbers_out.STEEL, 10.0


def punch(first: str, gap=0.0) -> cd.Solution:
    """A small block pressed along x on a large one, whose contact surface has eight times the area."""
    large = cd.Body("large", cd.box((0, 0, 0), (1, 4, 2), (3, 12, 6)), STEEL, supports=[cd.Fixed("left")])
    small = cd.Body("small", cd.box((1, 1, 0), (2, 2, 1), (3, 4, 4)), STEEL, loads=[cd.Pressure("right", LOAD)])
    small.supports = (cd.Symmetry("bottom"), cd.Symmetry("top"), cd.Symmetry("front"), cd.Symmetry("back"))
    sides = [(large, "right"), (small, "left")]
    sides = sides if first == "large" else sides[::-1]
    return cd.solve(cd.Scene([large, small], [cd.Contact(*sides, cd.LinearLayer(1e6), gap=gap)]))


def drawn_area(figure) -> float:
    """The area of the triangles of a map."""
    (drawn,) = [c for c in figure.axes[0].collections if isinstance(c, TriMesh)]
    corners = np.array([path.vertices[:3] for path in drawn.get_paths()])
    (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    return float(np.sum(np.abs(ax * by - ay * bx)) / 2)


@pytest.mark.parametrize("first", ["large", "small"])
def test_a_map_is_seen_along_the_normal(first):
    """It shows the punch's square in y and z, whichever body is the first, and no pressure beside it."""
    figure = punch(first).plot_contact(length_unit="cm")
    axes = figure.axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("y [cm]", "z [cm]")
    assert drawn_area(figure) == pytest.approx(1.0, rel=1e-12)
    low, high = axes.get_xlim()
    assert (low, high) == pytest.approx((0.98, 2.02))  # the margin of a fiftieth


def test_a_map_shows_what_is_around_the_contact():
    """A gap that opens along y: closed on a strip beside y = 1, half of whose size around it is shown, or all."""
    solution = punch("small", gap=lambda x: 4e-4 * (x[1] - 1))
    surface = solution.contact_surface()
    touching = surface.outlines[surface.closed > 0.0][..., 1].max()
    assert 1.2 < touching < 1.6
    narrow, whole = (solution.plot_contact(whole=all_of_it).axes[0].get_xlim()[1] for all_of_it in (False, True))
    assert narrow == pytest.approx(min(touching + 0.5 * 1.0, 2.0), abs=0.05)  # the strip is as long as the punch
    assert whole == pytest.approx(2.02)


def test_the_edge_on_a_map_is_a_smooth_line():
    """A ring of radius 1/2 where the gap opens: all of the drawn edge lies within a facet of the points' own edge."""
    solution = test_pictures.solid(gap=lambda x: 1e-4 * np.maximum(1 - 4 * ((x[0] - 1) ** 2 + (x[1] - 0.5) ** 2), 0))
    figure = solution.plot_contact(show="gap")
    lines = [c for c in figure.axes[0].collections if not isinstance(c, TriMesh)]
    edge = np.vstack([path.vertices for path in lines[-1].get_paths()])
    result = solution.contact()
    away = np.linalg.norm(result.x[:, :2] - [1.0, 0.5], axis=1)
    inner, outer = away[~result.closed].max(), away[result.closed].min()
    size = np.hypot(2 / 4, 1 / 3)  # of a facet
    radii = np.linalg.norm(edge - [1.0, 0.5], axis=1)
    assert outer - size < radii.min() <= radii.max() < inner + size


def test_facets_are_cut_into_what_they_were():
    rng = np.random.default_rng(1)
    facets = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) + 0.2 * rng.random((5, 4, 2))
    for outlines in (facets, facets[:, :3]):
        area = 0.5 * np.abs(
            sum(
                np.linalg.det(outlines[:, [0, k, k + 1]][:, 1:] - outlines[:, :1])
                for k in range(1, outlines.shape[1] - 1)
            )
        )
        pieces = cut(outlines, 4).reshape(-1, 3, 2)
        parts = 0.5 * np.abs(np.linalg.det(pieces[:, 1:] - pieces[:, :1]))
        assert parts.sum() == pytest.approx(area.sum(), rel=1e-12)


def test_a_corner_looked_at_closely():
    """With the focus on the lower left corner the bodies fill the upper right quarter, and nothing else."""
    solution = cd.solve(test_numbers_out.blocks())
    options = {"limits": (-4 * LOAD, 0.0), "scale": 0.0, "size": (400, 300), "zoom": 20.0, "focus": (0.0, 0.0)}
    pixels = solution.plot_bodies(**options).pixels.astype(float)
    colour = np.array(matplotlib.colormaps["viridis"](0.75)[:3]) * 255
    body = np.abs(pixels - colour).max(axis=2) <= 2
    top, bottom = 20, 300 - 43  # the bodies' part of the picture: below the title, above the bar
    middle = (top + bottom) // 2
    assert body[top + 4 : middle - 4, 204:].mean() > 0.98
    assert not body[top:bottom, :196].any()
    assert not body[middle + 4 : bottom, :].any()
    for wrong in ({"focus": (0.0, 0.0, 0.0)}, {"limits": (1.0, 1.0)}, {"size": (400, 40)}, {"scale": float("nan")}):
        with pytest.raises(ValueError, match=f"{next(iter(wrong))} = "):
            solution.plot_bodies(**wrong)


def test_stresses_around_an_axis_have_their_names():
    body = cd.Body("ring", cd.rectangle((1, 0), (2, 1), (4, 4)), STEEL, kinematics="axisymmetric")
    body.supports, top = (cd.Symmetry("bottom"),), cd.Body("top", cd.rectangle((1, 1), (2, 2), (4, 4)), STEEL)
    top = cd.Body("top", top.mesh, STEEL, kinematics="axisymmetric", loads=[cd.Pressure("top", LOAD)])
    solution = cd.solve(cd.Scene([body, top], [cd.Contact((body, "top"), (top, "bottom"), cd.LinearLayer(1e6))]))
    bars = [solution.plot_bodies(component=c, size=(200, 150)).axes[-1].get_xlabel() for c in (None, "zz", "von Mises")]
    assert bars == ["axial stress", "hoop stress", "von Mises stress"]


def frames():
    return (np.full((31, 41, 3), grey, dtype=np.uint8) for grey in (0, 100, 200))


def test_a_movie_without_ffmpeg_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(movie.shutil, "which", lambda program: None)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(RuntimeError, match="needs ffmpeg"):
        movie.write_mp4(tmp_path / "load.mp4", frames(), 4.0)


def test_a_movie(tmp_path):
    try:
        movie.ffmpeg()
    except RuntimeError as error:
        pytest.skip(str(error))
    movie.write_mp4(tmp_path / "load.mp4", frames(), 4.0)  # of odd numbers of pixels
    assert b"ftyp" in (tmp_path / "load.mp4").read_bytes()[:12]
    with pytest.raises(RuntimeError, match="ffmpeg failed"):
        movie.write_mp4(tmp_path / "no folder" / "load.mp4", frames(), 4.0)


def test_surfaces_fit_where_the_gap_is_steep():
    """Enlarged 900 times, the groove's closed part is one line: nodes take what is between the points beside them."""
    solution = cd.solve(test_numbers_out.blocks(lambda x: groove(x, middle=1.5), cells=(24, 24), degree=(1, 1)))
    scale, result = 900.0, solution.contact().sorted()
    lower, upper = (
        body.drawn(scale)[np.isclose(body.points[:, 1], 1.0)]
        for body in (solution.body("lower"), solution.body("upper"))
    )
    lower, upper = (nodes[np.argsort(nodes[:, 0])] for nodes in (lower, upper))
    closed = (lower[:, 0] < result.edge[0, 0] - 0.2) | (lower[:, 0] > result.edge[1, 0] + 0.2)
    steepest = scale * np.abs(np.diff(result.initial_gap)).max()
    # The nearest point's gap would be off by 0.37 of that; what is linear in between is off by the gap's curvature.
    assert np.abs(upper[closed] - lower[closed])[:, 1].max() < steepest / 20


def test_the_edge_of_facets_is_no_zigzag():
    """A ring: as long as a circle of its mean radius, which the means of facets alone would make a fifth longer."""
    held = cd.Symmetry("left", "right", "front", "back")
    low = cd.Body("low", cd.box((0, 0, 0), (2, 1, 1), (16, 8, 2)), STEEL, supports=[held, cd.Symmetry("bottom")])
    high = cd.Body("high", cd.box((0, 0, 1), (2, 1, 2), (16, 8, 2)), STEEL, supports=[held])
    high.loads = (cd.Pressure("top", LOAD),)

    def pit(x):
        return 1e-4 * np.maximum(1 - 4 * ((x[0] - 1) ** 2 + (x[1] - 0.5) ** 2), 0)

    contact = cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(1e6), gap=pit)
    edge = cd.solve(cd.Scene([low, high], [contact])).contact_surface().edge
    length = np.linalg.norm(np.diff(edge, axis=1), axis=2).sum()
    radius = np.linalg.norm(edge.reshape(-1, 3)[:, :2] - [1.0, 0.5], axis=1).mean()
    assert length == pytest.approx(2 * np.pi * radius, rel=0.02)


def test_a_map_of_hard_contact_is_that_of_its_nodes():
    """A pit in the middle of a symmetric joint: the map has the nodes' pressures and the joint's own symmetries."""
    held = cd.Symmetry("left", "right", "front", "back")
    low = cd.Body("low", cd.box((0, 0, 0), (2, 2, 1), (6, 6, 2), shape="hexahedron"), STEEL)
    high = cd.Body("high", cd.box((0, 0, 1), (2, 2, 2), (4, 4, 2), shape="hexahedron"), STEEL)
    low.supports, high.supports, high.loads = (held, cd.Symmetry("bottom")), (held,), (cd.Pressure("top", LOAD),)

    def pit(x):
        return 2e-4 * np.maximum(1 - (x[0] - 1) ** 2 - (x[1] - 1) ** 2, 0)

    solution = cd.solve(cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), cd.HardContact(), gap=pit)]))
    figure, result = solution.plot_contact(), solution.contact()
    (drawn,) = [c for c in figure.axes[0].collections if isinstance(c, TriMesh)]
    x = np.stack([drawn._triangulation.x, drawn._triangulation.y], axis=1)
    shown = {tuple(place): value for place, value in zip(x.round(9), drawn.get_array(), strict=True)}
    for place, pressure in zip(result.x[:, :2].round(9), result.pressure, strict=True):
        assert shown[tuple(place)] == pytest.approx(pressure, abs=1e-12)
    for (across, along), value in shown.items():
        for other in ((round(2 - across, 9), along), (along, across)):
            assert shown[other] == pytest.approx(value, abs=1e-6 * result.peak_pressure)  # the tolerance of solve
