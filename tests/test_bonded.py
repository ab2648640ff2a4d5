"""Bonded layers: laws that hold in tension too, bars and blocks that hang on them."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contactdd as cd

E, NU, STIFFNESS = 2.0e5, 0.3, 1e5
STEEL, LOOSE = cd.Isotropic(E, 0.0), cd.Isotropic(E, NU)
GLUE = cd.BondedLayer(cd.LinearLayer(STIFFNESS))
#: A power law in compression, one with a wall in tension.
UNLIKE = cd.BondedLayer(cd.PowerLayer(B=1e-6, a=1.5), tension=cd.HyperbolicLayer(2e5, 1e-2))

METHODS = ("auto", "one-point", "chord", "kurchatov", "anderson", "robin", "newton", "newton-chord", "newton-krylov")


def blocks(layer, load, *, cells=((4, 2), (4, 2)), material=STEEL, gap=0.0, swapped=False, supports=(), **options):
    """A block on a floor and a loose one on top of it, pulled by a load (positive upwards) on its upper side."""
    low = cd.Body("low", cd.rectangle((0, 0), (2, 1), cells[0]), material, supports=[cd.Fixed("bottom"), *supports])
    loads = [cd.Traction("top", load)]
    high = cd.Body("high", cd.rectangle((0, 1), (2, 2), cells[1]), material, supports=supports, loads=loads)
    sides = [(low, "top"), (high, "bottom")]
    first, second = reversed(sides) if swapped else sides
    return cd.Scene([low, high], [cd.Contact(first, second, layer, gap=gap, **options)])


@settings(max_examples=60, deadline=None)
@given(y=st.floats(-3e-3, 3e-3), z=st.floats(-3e-3, 3e-3), near=st.booleans())
def test_divided_difference_in_50_digits(y, z, near):
    """Across the kink, near each other and equal; 1e-12: two powers with a few roundings each."""

    def stress(gap):
        if gap < 0:
            return -((-gap / mpmath.mpf(1e-6)) ** (1 / mpmath.mpf(1.5)))
        return 2e5 * gap / (1 - gap / mpmath.mpf(1e-2))

    if near:
        z = y * (1 + 1e-11)
    if y == z:
        assert float(UNLIKE.divided_difference(y, z)) == pytest.approx(float(UNLIKE.contact_derivative(y)), rel=1e-13)
        return
    with mpmath.workdps(50):
        a, b = mpmath.mpf(y), mpmath.mpf(z)
        exact = float((stress(a) - stress(b)) / (a - b))
    assert float(UNLIKE.divided_difference(y, z)) == pytest.approx(exact, rel=1e-12)
    assert float(UNLIKE.divided_difference(z, y)) == float(UNLIKE.divided_difference(y, z))


def test_law_and_its_parts():
    """The energy's slope is the stress, the compression its inverse, NaN is handed on."""
    z = np.array([-2e-3, -1e-5, 1e-5, 2e-3])
    step = 1e-4 * np.abs(z)
    slope = (UNLIKE.energy(z + step) - UNLIKE.energy(z - step)) / (2 * step)
    assert slope == pytest.approx(UNLIKE.contact_stress(z), rel=1e-7)  # the step squared
    assert UNLIKE.compression(UNLIKE.contact_stress(z)) == pytest.approx(z, rel=1e-13)
    assert GLUE.contact_stress(z) == pytest.approx(STIFFNESS * z)
    assert np.all(UNLIKE.energy(z) > 0)
    for function in (UNLIKE.contact_stress, UNLIKE.contact_derivative, UNLIKE.energy):
        assert np.isnan(function(np.array([np.nan])))[0]
    assert np.isnan(UNLIKE.divided_difference(np.nan, 1e-3))


def test_varies_along_the_surface():
    """A bond of varying stiffness is the bond of its value at each point."""
    law = cd.BondedLayer(cd.VaryingLayer(cd.LinearLayer, stiffness=lambda x: 1 + x[0])).at(np.array([[0.0, 1, 2]] * 2))
    assert law.contact_stress(np.array([1.0, -1.0, 0.5])).tolist() == [1.0, -2.0, 1.5]
    assert law.divided_difference(np.array([1.0, -1, 0.5]), np.array([2.0, 1.0, 0.0])).tolist() == [1.0, 2.0, 3.0]


@pytest.mark.parametrize("make", [
    lambda: cd.BondedLayer(GLUE), lambda: cd.BondedLayer(cd.LinearLayer(1.0), tension=GLUE),
    lambda: cd.BondedLayer(cd.HardContact()), lambda: cd.SeriesLayer(GLUE, cd.LinearLayer(1.0)),
])  # fmt: skip
def test_refused(make):
    with pytest.raises(TypeError, match="expected"):
        make()


def test_varying_bond_inside_out_is_refused():
    inside = cd.VaryingLayer(lambda k: cd.BondedLayer(cd.LinearLayer(k)), k=lambda x: 1 + x[0])
    with pytest.raises(ValueError, match="BondedLayer\\(VaryingLayer"):
        inside.at(np.zeros((2, 1)))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("load", [20.0, -20.0], ids=["pulled", "pressed"])
def test_column(method, load):
    """Patch test on meshes that do not match: uniform stress, and each branch's own stretch, whatever the method."""
    scene = blocks(UNLIKE, (0.0, load), cells=((4, 2), (5, 3)), supports=[cd.Symmetry("left", "right")])
    found = cd.solve(scene, method, tolerance=1e-12)
    result = found.contact()
    assert result.pressure == pytest.approx(np.full(len(result.x), -load), rel=1e-9)  # the residual's 1e-12, magnified
    assert result.gap == pytest.approx(np.full(len(result.x), float(UNLIKE.compression(load))), rel=1e-9)
    top = found.displacement_at("high", [[1.0, 2.0]])[0, 1]
    assert top == pytest.approx(2 * load / E + float(UNLIKE.compression(load)), rel=1e-9)
    assert result.area == pytest.approx(2.0)
    assert result.edge.shape == (0, 2)
    assert result.peak_tension == pytest.approx(max(load, 0.0), rel=1e-9)
    assert found.imbalance < 1e-9


def test_hangs_on_its_bond_alone():
    """A block under a bending moment: without tension nothing holds it, with a bond σ = M x/I, as between rigid blocks.

    The bond is two hundred times softer than the blocks, which stay flat to that part.
    """
    soft = cd.LinearLayer(1e3)
    with pytest.raises(cd.NoEquilibriumError):
        cd.solve(blocks(soft, lambda x: (0.0 * x[0], 3.0 * (x[0] - 1)), material=LOOSE))
    found = cd.solve(blocks(cd.BondedLayer(soft), lambda x: (0.0 * x[0], 3.0 * (x[0] - 1)), material=LOOSE))
    result = found.contact()
    assert result.pressure == pytest.approx(-3.0 * (result.x[:, 0] - 1), abs=0.02 * 3)
    assert abs(result.force) < 1e-8
    assert result.moment((1.0, 1.0)) == pytest.approx(2.0, rel=1e-6)  # ∫ 3 (x − 1)² dx, on the first body


def test_swapped_bodies_and_energy_balance():
    """Nothing tells the two surfaces apart; a linear bond stores with the bodies half the loads' work."""
    load = (0.0, 10.0)
    walls, unlike = [cd.Symmetry("left")], ((4, 2), (5, 3))
    one, other = (
        cd.solve(blocks(GLUE, load, cells=unlike, material=LOOSE, supports=walls, swapped=swapped), tolerance=1e-12)
        for swapped in (False, True)
    )
    assert one.energy == pytest.approx(other.energy, rel=1e-11)
    assert one.contact().force_vector == pytest.approx(-other.contact().force_vector, rel=1e-9, abs=1e-9)
    assert one.elastic_energy() + one.layer_energy == pytest.approx(-one.energy, rel=1e-11)


def test_mirror_plane():
    """Half of a bonded pair pulled apart is the pair: the same stresses, half the gap."""

    def body(name, floor, diagonal, side, sign):
        mesh = cd.rectangle((0, floor), (2, floor + 1), (4, 2), diagonal=diagonal)
        pull = cd.Traction(side, lambda x: (0 * x[0], sign * 5.0 * x[0]))
        return cd.Body(name, mesh, LOOSE, supports=[cd.Symmetry("left")], loads=[pull])

    low, high = body("low", 0, "right", "bottom", -1), body("high", 1, "left", "top", 1)
    mirror = cd.MirrorPlane("mirror", (0, 1), (0, -1))
    pair = cd.solve(cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), UNLIKE)])).contact()
    half = cd.solve(cd.Scene([low, mirror], [cd.Contact((low, "top"), mirror, UNLIKE)])).contact()
    assert half.pressure == pytest.approx(pair.pressure, rel=1e-8)
    assert half.gap == pytest.approx(0.5 * pair.gap, rel=1e-8)


def test_passed_limits_are_told():
    """A bond stretched beyond its measured law says so, as one compressed too far does."""
    weak = cd.BondedLayer(cd.LinearLayer(1e5), tension=cd.TableLayer([0.0, 1e-4, 2e-4], [0.0, 5.0, 8.0]))
    with pytest.warns(cd.LayerRangeWarning, match="stretched further"):
        found = cd.solve(blocks(weak, (0.0, 10.0), supports=[cd.Symmetry("left", "right")]))
    assert "stretched" in found.notes[0]


def test_saved_and_shown(tmp_path):
    """A saved solution keeps that it is bonded; pictures show tension below zero."""
    found = cd.solve(blocks(GLUE, (0.0, 10.0), supports=[cd.Symmetry("left", "right")]))
    found.save(tmp_path / "bond")
    kept = cd.load_solution(tmp_path / "bond").contact()
    assert kept.bonded
    assert kept.peak_tension == found.contact().peak_tension
    low, high = found.plot_contact().axes[0].get_ylim()
    assert low < -9.9 < high
    assert np.all(found.contact_surface().status == 3)
