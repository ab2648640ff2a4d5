"""Pictures of bodies without stress, of bodies whose partner is not drawn, and refusals that say what was expected."""

from __future__ import annotations

import matplotlib
import numpy as np
import pytest
from test_half_space import roll
from test_pictures import STEEL

import contactdd as cd

pytest.importorskip("pyvista")


def strip(**options) -> cd.Body:
    mesh = cd.rectangle((-2, -1), (2, 0), (32, 8))
    return cd.Body("strip", mesh, STEEL, supports=[cd.Fixed("bottom")], **options)


def test_what_has_no_stress_has_the_colour_of_zero():
    """Two bodies apart, nothing on them: the bar's middle is zero, and so is what is drawn."""
    lid = cd.Body("lid", cd.rectangle((-2, 0.5), (2, 1), (8, 2)), STEEL, supports=[cd.Fixed("top")])
    low = strip()
    solution = cd.solve(cd.Scene([low, lid], [cd.Contact((low, "top"), (lid, "bottom"), cd.LinearLayer(1e4))]))
    picture = solution.plot_bodies(size=(300, 200))
    expected = np.array(matplotlib.colormaps["viridis"](0.5)[:3]) * 255
    near = np.abs(picture.pixels[30:140].astype(float) - expected).max(axis=2) <= 3  # a step of 256 colours
    assert near.sum() > 5000


def test_a_body_whose_partner_is_not_drawn_is_where_it_is():
    """Under a rigid cylinder, which no picture shows, nothing but the displacements is enlarged."""
    low, cylinder = strip(), roll(force=100.0)
    solution = cd.solve(cd.Scene([low, cylinder], [cd.Contact((low, "top"), cylinder, cd.LinearLayer(1e6))]))
    body = solution.body("strip")
    np.testing.assert_allclose(body.drawn(200.0), body.points + 200.0 * body.displacement, rtol=0, atol=1e-12)


def test_a_body_on_its_axis_has_no_slits():
    """A quarter of a disc with a hollow top, whose axis is not quite at zero: no more edges than those of its sides."""
    from contactdd.view.render import _outline, grid, swept

    radii = cd.rectangle((0, 0), (1, 1), (4, 4))
    cone = cd.Body("cone", radii, STEEL, supports=[cd.Fixed("bottom"), cd.Symmetry("left")], kinematics="axisymmetric")
    held = [cd.Fixed("top"), cd.Symmetry("left")]
    lid = cd.Body("lid", radii.moved((0, 1)), STEEL, supports=held, kinematics="axisymmetric")
    solution = cd.solve(cd.Scene([cone, lid], [cd.Contact((cone, "top"), (lid, "bottom"), cd.LinearLayer(1e4))]))
    body = solution.body("cone")
    points = body.points + np.where(body.points == 0.0, 1e-18, 0.0)
    points[:, 1] += 0.5 * points[:, 0]  # else everything at the axis is flat
    lines = _outline(swept(grid(body, points), 90.0), flat=False)
    lengths = lines.compute_cell_sizes(length=True, area=False, volume=False)["Length"]
    # Along the axis 1, at the rim twice 1, along the bottom and the top of the cuts √1.25 each, and two arcs.
    assert lengths.sum() == pytest.approx(3 + 4 * np.sqrt(1.25) + np.pi, rel=1e-3)


def test_refusals_say_what_was_expected():
    q, low, upper = cd.Parameter(1.0), strip(), cd.rectangle((-2, 0), (2, 1), (8, 2))
    lid = cd.Body("lid", upper, STEEL, supports=[cd.Symmetry("left")], loads=[cd.Pressure("top", q)])
    scene = cd.Scene([low, lid], [cd.Contact((low, "top"), (lid, "bottom"), cd.LinearLayer(1e4))])
    path = cd.programme(scene, q, [1.0])
    for label in ("{load}", "{", "{}", "{step.foo}"):
        with pytest.raises(ValueError, match=r"label = .*: expected a text with \{step\} and \{value\}"):
            path.plot_contact(label=label)
    for options, words in (
        ({"limits": 3}, "limits = 3: expected two numbers"),
        ({"size": 300}, "size = 300: expected the width and the height"),
    ):
        with pytest.raises(ValueError, match=words):
            path.solutions[0].plot_bodies(**options)
    with pytest.raises(TypeError, match="focus = 'middle': expected the 2 coordinates of a point"):
        path.solutions[0].plot_bodies(focus="middle")
