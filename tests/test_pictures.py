"""Pictures show what they say: colours are the bar's, facets are whole, parts do not sink into each other."""

from __future__ import annotations

import matplotlib
import numpy as np
import pytest
import test_numbers_out
from matplotlib.collections import TriMesh

import contactdd as cd
from contactdd.surface_result import zero_lines
from contactdd.view.body_plot import round_limits
from contactdd.view.convergence_plot import rate

pytest.importorskip("pyvista")

STEEL, Q = test_numbers_out.STEEL, 10.0


def solid(**options) -> cd.Solution:
    """Two boxes under even pressure, everything in them constant."""
    held = cd.Symmetry("left", "right", "front", "back")
    low = cd.Body("low", cd.box((0, 0, 0), (2, 1, 1), (4, 3, 2)), STEEL, supports=[held, cd.Symmetry("bottom")])
    high = cd.Body(
        "high", cd.box((0, 0, 1), (2, 1, 2), (5, 2, 2)), STEEL, supports=[held], loads=[cd.Pressure("top", Q)]
    )
    return cd.solve(cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(1e6), **options)]))


@pytest.mark.parametrize("make", [solid, lambda: cd.solve(test_numbers_out.blocks())])
def test_colours_are_those_of_the_bar(make):
    """A constant stress is one colour, the bar's at that number, in space too, where light would change it."""
    picture = make().plot_bodies(limits=(-4 * Q, 0.0), size=(300, 200))
    expected = np.array(matplotlib.colormaps["viridis"](0.75)[:3]) * 255
    near = np.abs(picture.pixels.astype(float) - expected).max(axis=2) <= 2  # a step of 256 colours, and rounding
    other = np.abs(picture.pixels.astype(float) - 255).max(axis=2) > 30
    middle = np.zeros_like(near)
    middle[30:150, 60:240] = True  # the bodies; below are the axes and the bar
    assert near[middle].sum() > 2000
    # The rest of what is drawn there are the outlines, lines of two pixels.
    assert (other & ~near)[middle].sum() < 0.35 * near[middle].sum()


def test_a_map_shows_every_facet():
    """Facets cut into pieces cover the surface, no more and no less; what is constant is one number everywhere."""
    figure = solid().plot_contact()
    (drawn,) = [c for c in figure.axes[0].collections if isinstance(c, TriMesh)]
    np.testing.assert_allclose(drawn.get_array(), Q, rtol=1e-8)  # the tolerance of solve
    corners = np.array([path.vertices[:3] for path in drawn.get_paths()])
    (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    assert np.sum(np.abs(ax * by - ay * bx)) / 2 == pytest.approx(2.0, rel=1e-12)


def test_edge_of_contact_in_space():
    """Pressed by a curved gap: the edge of contact is a curve around, near where the points' gaps change sign."""
    solution = solid(gap=lambda x: 1e-4 * (x[0] - 1) ** 2)
    surface, result = solution.contact_surface(), solution.contact()
    edge = surface.edge.reshape(-1, 3)
    side = np.abs(result.x[:, 0] - 1)
    inner, outer = side[result.closed].max(), side[~result.closed].min()
    size = 2 / 4  # of a facet
    assert len(edge) > 0
    assert np.all(np.abs(np.abs(edge[:, 0] - 1) - 0.5 * (inner + outer)) < size)


def test_lines_where_functions_are_zero():
    """Linear functions on two triangles of a square: x − 0.3 is zero on a line through it."""
    corners = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], dtype=float)
    lines = zero_lines(corners, corners[:, :, 0] - 0.3)
    np.testing.assert_allclose(lines[:, :, 0], 0.3, rtol=1e-14)
    assert np.abs(np.diff(lines[:, :, 1], axis=1)).sum() == pytest.approx(1.0, rel=1e-14)
    assert len(zero_lines(corners, np.ones((2, 3)))) == 0


@pytest.mark.parametrize("how", ["meshes apart", "given gap", "given interference", "meshes overlap"])
def test_parts_do_not_sink_into_each_other(how):
    """Drawn a thousand times enlarged, the surfaces touch or are apart, as far as nodes can tell."""
    apart = {"meshes apart": 2e-4, "meshes overlap": -2e-4}.get(how, 0.0)
    gap = {"given gap": 2e-4, "given interference": -2e-4}.get(how, 0.0)
    low = cd.Body("low", cd.rectangle((0, 0), (4, 1), (8, 4)), STEEL, supports=[cd.Fixed("bottom")])
    down = cd.Displacement("top", [0.0, -3e-4])
    high = cd.Body("high", cd.rectangle((0, 1 + apart), (4, 2), (8, 4)), STEEL, supports=[down])
    contact = cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(1e6), gap=gap)
    solution = cd.solve(cd.Scene([low, high], [contact]))
    below, above = solution.body("low"), solution.body("high")
    edges = [
        body.drawn(1000.0)[np.isclose(body.points[:, 1], height)] for body, height in ((below, 1.0), (above, 1 + apart))
    ]
    heights = [edge[np.argsort(edge[:, 0]), 1] for edge in edges]
    # Nodes take the gap of the nearest point, at a sixth of a facet: the layer's compression changes by less.
    assert np.all(heights[1] - heights[0] > -0.02)
    # And where they touch no gap is drawn: here everywhere.
    assert np.all(heights[1] - heights[0] < 0.02)


def test_round_numbers():
    """Two digits, so that hardly a colour of the bar is left over; equal numbers are one colour, in its middle."""
    for low, high, expected in ((-13.13, -6.3, (-13.2, -6.3)), (0.0, 1.0, (0.0, 1.0)), (-3580.0, 56.5, (-3600, 100))):
        assert round_limits([np.array([low, high])]) == pytest.approx(expected)
    for value in (5.0, -1.2345678e7, 0.0):
        low, high = round_limits([np.array([value, value * (1 + 1e-9)])])
        assert 0.4 < (value - low) / (high - low) < 0.6 or value == low == 0.0 < high


def test_rate():
    assert rate(3.0 * 0.4 ** np.arange(12)) == pytest.approx(0.4, rel=1e-12)
    assert np.isnan(rate(np.array([1.0, 0.1])))


def test_pictures_of_a_load_programme(tmp_path):
    image = pytest.importorskip("PIL.Image")
    q = cd.Parameter(0.0)
    path = cd.programme(test_numbers_out.blocks(load=q), q, [5.0, 10.0, 7.5])
    curves = path.plot_contact(path=tmp_path / "steps.pdf").axes[0].lines
    for curve, load in zip(curves, [5.0, 10.0, 7.5], strict=True):
        np.testing.assert_allclose(curve.get_ydata(), load, rtol=1e-8)
    assert (tmp_path / "steps.pdf").read_bytes()[:5] == b"%PDF-"
    assert len(path.plot_bodies(size=(200, 150), columns=2).axes) == 3 + 2  # steps, directions, bar
    with image.open(path.animate(tmp_path / "load.gif", size=(200, 150))) as movie:
        assert movie.n_frames == 3
    with pytest.raises(ValueError, match=r"ends in \.gif"):
        path.animate(tmp_path / "load.avi")


def test_options_are_checked():
    solution = cd.solve(test_numbers_out.blocks())
    for options, match in (
        ({"component": "zy"}, "component = 'zy'"),
        ({"zoom": 0.0}, "zoom = 0.0"),
        ({"bodies": ["middle"]}, "body = 'middle'"),
    ):
        with pytest.raises(ValueError, match=match):
            solution.plot_bodies(**options)
    with pytest.raises(ValueError, match="along = 'z'"):
        solution.plot_contact(along="z")
    with pytest.raises(ValueError, match="camera = 'above'"):
        solid().plot_bodies(camera="above")
    with pytest.raises(ValueError, match="quantity = 'energy'"):
        solution.history.plot(quantity="energy")
    figure = solution.history.plot()
    assert figure.axes[0].get_ylabel() == "residual"
    np.testing.assert_array_equal(figure.axes[0].lines[0].get_ydata(), solution.history.residual)


def test_a_swept_body_of_revolution():
    """Half of a ring has half of Pappus' area; what is no body of revolution is not turned."""
    from contactdd.view.render import grid, swept

    inner, outer = (
        cd.Body(n, cd.rectangle((r, 0), (r + 10, 10), (4, 4)), STEEL, kinematics="axisymmetric", degree=2)
        for n, r in (("inner", 10), ("outer", 20))
    )
    inner.supports = outer.supports = (cd.Symmetry("bottom"),)
    contact = cd.Contact((inner, "right"), (outer, "left"), cd.LinearLayer(1e6), gap=-0.01)
    solution = cd.solve(cd.Scene([inner, outer], [contact]))
    half = swept(grid(solution.body("inner"), solution.body("inner").points), 180.0)
    # Turned by steps Δ of two degrees, a disc's area is that of a polygon, smaller by Δ²/6 = 2e-4.
    assert half.area == pytest.approx(np.pi * (10 * 10 + 20 * 10 + 20**2 - 10**2) + 2 * 100, rel=2e-4)
    assert solution.plot_bodies(sweep=270.0, size=(200, 150)).pixels.std() > 10
    for scene, angle in ((solution, 400.0), (cd.solve(test_numbers_out.blocks()), 90.0)):
        with pytest.raises(ValueError, match="sweep = "):
            scene.plot_bodies(sweep=angle)
