"""Rough surfaces as gaps: their values, what lies between and beyond, and a measured file."""

from __future__ import annotations

import numpy as np
import pytest

import contactdd as cd

RNG = np.random.default_rng(0)


def test_places_are_those_of_the_half_space():
    """A contact of the same grid has the heights themselves, whichever way round a square surface would lie."""
    heights = RNG.normal(size=(12, 8))
    ground = cd.PeriodicHalfSpace("ground", cd.Isotropic(1e3, 0.3), (3.0, 2.0), (12, 8), origin=(1.0, 2.0, 0.0))
    gap = cd.SurfaceHeights(heights, (3.0, 2.0), middle=(1.0, 2.0), periodic=True)
    expected = heights.max() - heights.ravel()
    assert gap(ground.places.T) == pytest.approx(expected, abs=1e-12)
    assert gap(ground.places.T + [[6.0], [-4.0], [1.0]]) == pytest.approx(expected, abs=1e-12)  # whole periods


def test_linear_between_and_even_at_the_edge():
    surface = cd.SurfaceHeights([0.0, 3.0, 1.0, 2.0], size=8.0, middle=4.0)
    x = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 7.5, 8.0])
    assert surface(np.array([x, 0 * x])) == pytest.approx([3.0, 3.0, 1.5, 0.0, 1.0, 1.0, 1.0])
    around = cd.SurfaceHeights([0.0, 3.0, 1.0, 2.0], size=8.0, middle=4.0, periodic=True)
    assert around(np.array([[0.0, 8.0, 16.0], [0.0, 0.0, 0.0]])) == pytest.approx(2.0)  # between the last and the first


def test_a_line_and_a_ridge_are_the_same():
    line = RNG.normal(size=16)
    ridge = cd.SurfaceHeights(np.tile(line[:, None], 4), (2.0, 1.0))
    x = RNG.uniform(-1, 1, (3, 40)) * [[1.0], [0.5], [9.0]]
    assert ridge(x) == pytest.approx(cd.SurfaceHeights(line, 2.0)(x), abs=1e-12)


def test_pressed_profile_carries_the_load():
    """Of a rigid rough line on a block of elements, whose points are between the profile's."""
    profile = cd.SurfaceHeights(1e-3 * np.cos(2 * np.pi * (np.arange(64) + 0.5) / 32), size=2.0, middle=1.0)
    mesh = cd.rectangle((0, 0), (2, 1), (32, 8))
    sides = [cd.Symmetry("left", "right")]
    block = cd.Body("block", mesh, cd.Isotropic(1e3, 0.3), supports=sides, loads=[cd.Pressure("top", 0.5)])
    floor = cd.RigidBody("floor", cd.Plane((0, 0), (0, 1)))
    contact = cd.Contact((block, "bottom"), floor, cd.PowerLayer(1e-4, 1.1), gap=profile)
    result = cd.solve(cd.Scene([block, floor], [contact]), progress=False).contact().sorted()
    assert result.force == pytest.approx(1.0, rel=1e-9)
    pressed = result.x[result.pressure > 0, 0]
    assert all(min(abs(x - 1.0), abs(x - 0.0), abs(x - 2.0)) < 0.3 for x in pressed)  # under the crests
    assert 0.0 < result.area < 1.5


def test_what_is_refused():
    with pytest.raises(ValueError, match="not known at x"):
        cd.SurfaceHeights([0.0, 1.0], size=1.0)(np.array([[0.6], [0.0]]))
    with pytest.raises(ValueError, match=r"heights of shape \(1, 4\): expected finite numbers"):
        cd.SurfaceHeights(np.zeros((1, 4)), (1.0, 1.0))
    with pytest.raises(ValueError, match=r"size = 1\.0: expected 2 finite numbers"):
        cd.SurfaceHeights(np.zeros((4, 4)), 1.0)
    with pytest.raises(ValueError, match=r"size = 0\.0: expected a number > 0"):
        cd.SurfaceHeights(np.zeros(4), 0.0)
    with pytest.raises(ValueError, match="expected finite numbers"):
        cd.SurfaceHeights([0.0, np.nan], 1.0)


def test_a_file_of_an_instrument(tmp_path):
    surfaces = pytest.importorskip("SurfaceTopography")
    heights = RNG.normal(size=(8, 4))
    surfaces.Topography(heights, (20.0, 10.0), unit="µm", periodic=True).to_netcdf(str(tmp_path / "measured.nc"))
    read = cd.SurfaceHeights.read(tmp_path / "measured.nc", length_unit=1e-3)
    assert read.size == pytest.approx([0.02, 0.01])
    assert read.periodic
    assert read.heights == pytest.approx(1e-3 * heights)
