"""Rough surfaces known at scattered points as gaps: planes exactly, grids like grids, and a pressed one."""

from __future__ import annotations

import numpy as np
import pytest

import contactdd as cd

RNG = np.random.default_rng(0)
CORNERS = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 1.0], [2.0, 1.0]])


def test_a_plane_is_itself():
    """Linear pieces show linear functions exactly, wherever the points are."""
    points = np.concatenate([CORNERS, RNG.uniform(size=(60, 2)) * [2.0, 1.0]])
    surface = cd.ScatteredHeights(points, 3e-3 * points[:, 0] - 1e-3 * points[:, 1])
    x = np.vstack([RNG.uniform(size=(2, 50)) * [[2.0], [1.0]], np.full(50, 7.0)])
    assert surface(x) == pytest.approx(6e-3 - 3e-3 * x[0] + 1e-3 * x[1], abs=1e-15)


def test_a_line_out_of_order_is_that_of_equal_steps():
    heights, middles = RNG.normal(size=16), (np.arange(16) + 0.5) / 8
    order = RNG.permutation(16)
    line = cd.ScatteredHeights(middles[order], heights[order])
    x = np.array([np.linspace(middles[0], middles[-1], 33), np.zeros(33)])
    assert line(x) == pytest.approx(cd.SurfaceHeights(heights, 2.0, middle=1.0)(x), abs=1e-12)


@pytest.mark.parametrize("dim", [2, 3])
def test_force_is_that_of_the_same_gap_as_a_function(dim):
    """A wedge is linear between its points: the contact's force and pressures are those of the function."""
    if dim == 2:
        mesh, sides = cd.rectangle((0, 0), (2, 1), (16, 8)), [cd.Symmetry("left", "right")]
        ground, points = cd.Plane((0, 0), (0, 1)), np.array([0.0, 2.0])
    else:
        mesh, sides = cd.box((0, 0, 0), (2, 1, 1), (6, 3, 3)), [cd.Symmetry("left", "right", "front", "back")]
        ground, points = cd.Plane((0, 0, 0), (0, 0, 1)), CORNERS
    block = cd.Body("block", mesh, cd.Isotropic(1e3, 0.3), supports=sides, loads=[cd.Pressure("top", 0.5)])
    floor = cd.RigidBody("floor", ground)
    gaps = cd.ScatteredHeights(points, -1e-3 * points.reshape(len(points), -1)[:, 0]), lambda x: 1e-3 * x[0]
    scenes = [
        cd.Scene([block, floor], [cd.Contact((block, "bottom"), floor, cd.PowerLayer(1e-4, 1.1), gap=gap)])
        for gap in gaps
    ]
    ours, theirs = (cd.solve(scene, progress=False).contact() for scene in scenes)
    assert ours.force == pytest.approx(1.0, rel=1e-9)  # 0.5 on 2 or 2 × 1, to the tolerance of the solve
    assert ours.pressure == pytest.approx(theirs.pressure, abs=1e-8 * theirs.peak_pressure)


def test_refusals():
    with pytest.raises(ValueError, match=r"not known at x = \[2.1 0. \]"):
        cd.ScatteredHeights([0.0, 2.0], [0.0, 1.0])(np.array([[1.0, 2.1], [0.0, 0.0]]))
    with pytest.raises(ValueError, match="is there 2 times"):
        cd.ScatteredHeights([0.0, 1.0, 0.0], [0.0, 1.0, 2.0])
    with pytest.raises(ValueError, match="lie on a line"):
        cd.ScatteredHeights([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]], [0.0, 1.0, 2.0, 0.0])
    with pytest.raises(ValueError, match="one for each point"):
        cd.ScatteredHeights([0.0, 1.0, 2.0], [0.0, 1.0])
    with pytest.raises(ValueError, match="finite"):
        cd.ScatteredHeights([0.0, np.nan], [0.0, 1.0])
    with pytest.raises(ValueError, match=r"shape \(2, 2\)"):
        cd.ScatteredHeights([[0.0, 0.0], [1.0, 0.0]], [0.0, 1.0])
