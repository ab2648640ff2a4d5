"""A body against its own mirror plane is one half of two equal bodies."""

from __future__ import annotations

import numpy as np
import pytest
import scenes

import contactdd as cd
from contactdd.layers.halved import HalvedLayer


def half(layer=scenes.LAYER, gap=scenes.groove, load=scenes.LOAD, **options):
    lower = scenes.block("lower", 0, (32, 16), loads=[cd.Pressure("bottom", load)], **options.pop("body", {}))
    plane = cd.MirrorPlane("mirror", (0, scenes.HEIGHT), (0, -1))
    return cd.Scene([lower, plane], [cd.Contact((lower, "top"), plane, layer, gap=gap, **options)])


@pytest.mark.parametrize(
    ("layer", "options"),
    [
        (scenes.LAYER, {}),
        (scenes.LAYER, {"quadrature": "mortar"}),
        (cd.LinearLayer(1e5), {}),
        (cd.HardContact(), {"quadrature": "mortar"}),
    ],
)
def test_half_a_groove(layer, options):
    one, both = (
        cd.solve(half(layer, **options)),
        cd.solve(scenes.pressed(layer=layer, **{"quadrature": "gauss"} | options)),
    )
    peak = both.contact().pressure.max()
    ours, theirs = one.contact().sorted(), both.contact().sorted()
    # Both are solved to 1e-10, hard contact to a millionth.
    bound = 1e-5 if isinstance(layer, cd.HardContact) else 1e-7
    assert ours.pressure == pytest.approx(theirs.pressure, abs=bound * peak)
    assert ours.gap == pytest.approx(theirs.gap / 2, abs=bound * np.abs(theirs.gap).max())
    assert ours.force == pytest.approx(theirs.force, rel=1e-8)
    assert one.energy == pytest.approx(both.energy / 2, rel=1e-6)
    assert one.layer_energy == pytest.approx(both.layer_energy / 2, rel=1e-6, abs=1e-12 * abs(both.energy))


def test_decomposed_methods_halve_too():
    one, expected = (cd.solve(half(), method=method).contact().pressure for method in ("chord", "newton"))
    assert one == pytest.approx(expected, abs=1e-6 * expected.max())


def test_a_programme_of_gaps():
    depth = cd.Parameter(0.0)
    gap = depth.field(lambda r0, x: r0 * scenes.groove(x))
    path = cd.programme(half(gap=gap), depth, [0.5, 1.0])
    expected = cd.solve(half()).contact().pressure
    assert path.solutions[-1].contact().pressure == pytest.approx(expected, abs=1e-8 * expected.max())


def test_halves_of_laws():
    """Two halves in series are the whole, in all five functions."""
    layer = cd.PowerLayer(4e-6, 1.1)
    part, w, other = HalvedLayer(layer), -np.geomspace(1e-8, 1e-3, 9), -np.geomspace(1e-4, 1e-5, 9)
    assert part.contact_stress(w / 2) == pytest.approx(layer.contact_stress(w), rel=1e-14)
    assert 2 * part.energy(w / 2) == pytest.approx(layer.energy(w), rel=1e-14)
    assert part.contact_derivative(w / 2) == pytest.approx(2 * layer.contact_derivative(w), rel=1e-14)
    quotients = part.divided_difference(w / 2, other / 2), 2 * layer.divided_difference(w, other)
    assert quotients[0] == pytest.approx(quotients[1], rel=1e-14)
    assert 2 * part.compression(-np.arange(5.0)) == pytest.approx(layer.compression(-np.arange(5.0)), rel=1e-14)
    series = cd.SeriesLayer(part, part)
    assert series.contact_stress(w) == pytest.approx(layer.contact_stress(w), rel=1e-12)
    table = HalvedLayer(cd.OverclosureLayer(p0=2.0, c0=0.3))
    assert table.clearance == pytest.approx(0.15)


def test_a_measured_gap_is_the_distance_to_the_plane():
    """Bodies 2 e apart, pushed together by their outer faces: half of that is closed by each."""
    e, steel = 1e-3, cd.Isotropic(2.1e5, 0.0)
    mesh = cd.rectangle((0, 0), (4, 1), (8, 2))
    lower = cd.Body("lower", mesh, steel, supports=[cd.Symmetry("left"), cd.Displacement("bottom", [None, 2 * e])])
    plane = cd.MirrorPlane("mirror", (0, 1 + e), (0, -1))
    k = 1e5
    pressure = (
        cd.solve(cd.Scene([lower, plane], [cd.Contact((lower, "top"), plane, cd.LinearLayer(k))])).contact().pressure
    )
    # p h/E + p/(2k) = e: the column and half the layer.
    assert pressure == pytest.approx(e / (1 / 2.1e5 + 0.5 / k), rel=1e-8)
