"""Newton's method in the pressures, and hard contact by its set of points: answers of other ways, and their cost."""

from __future__ import annotations

import numpy as np
import pytest

import contactdd as cd

SOFT = cd.Isotropic(1e3, 0.3)
DOWN = cd.Plane((0, 0, 0), (0, 0, -1))

LAWS = [
    cd.PowerLayer(1e-7, 1.1),  # stiffer than the shortest waves
    cd.PowerLayer(1e-4, 0.3),  # infinitely soft at rest
    cd.PowerLayer(1e-8, 4.0),  # infinitely stiff at rest
    cd.ExponentialLayer(1e-2, 1e-4),
    cd.HyperbolicLayer(1e3, 1e-3),
    cd.BondedLayer(cd.LinearLayer(1e5)),
]


def ground(count=24, name="ground", material=SOFT, **options):
    return cd.PeriodicHalfSpace(name, material, (1.0, 1.0), (count, count), **options)


def plate(force=1.0, **options):
    options = {"displacement": (0, 0, None), "force": (0, 0, -force)} | options
    return cd.RigidBody("plate", DOWN, **options)


def waves(x):
    """A surface of few waves, its highest points about 0 (length)."""
    pairs = ((1, 0, 0.3), (1, 2, 1.1), (3, 1, 2.0), (2, 3, 0.7), (4, 4, 2.9))
    return 4e-3 - sum(2e-3 / (i + j) * np.cos(2 * np.pi * (i * x[0] + j * x[1]) + phase) for i, j, phase in pairs)


def solved(bodies, layer, gap=waves, method="auto", **options):
    return cd.solve(cd.Scene(bodies, [cd.Contact(*bodies, layer, gap=gap)]), method, progress=False, **options)


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_layers_as_by_krylov(law):
    """The same pressures as by conjugate gradients in the displacements, both to a residual of 1e-10."""
    found, expected = (solved([ground(), plate()], law, method=method) for method in ("auto", "newton-krylov"))
    assert "pressures" in found.history[0].note
    pressures = [solution.contact().pressure for solution in (found, expected)]
    # A residual of forces is that times the condition of the pressures: stiff layers leave 1e-7.
    assert pressures[0] == pytest.approx(pressures[1], abs=1e-6 * pressures[1].max())
    assert found.displacement("plate") == pytest.approx(expected.displacement("plate"), rel=1e-6, abs=1e-12)


def test_hard_contact_as_by_multipliers():
    """The pressures of the augmented Lagrangian, which settle to 1e-6; nothing overlaps, nothing pulls."""
    found, expected = (
        solved([ground(), plate()], cd.HardContact(), method=method) for method in ("auto", "newton-krylov")
    )
    ours, theirs = found.contact(), expected.contact()
    assert ours.pressure == pytest.approx(theirs.pressure, abs=3e-6 * theirs.pressure.max())
    assert ours.force == pytest.approx(1.0, rel=1e-9)
    assert ours.pressure.min() == 0.0
    assert ours.gap[ours.pressure == 0].min() > 0.0
    assert np.abs(ours.gap[ours.pressure > 0]).max() < 1e-12  # the heights are some 1e-3
    assert found.energy == pytest.approx(expected.energy, rel=1e-6)


@pytest.mark.parametrize("layer", [cd.HardContact(), cd.PowerLayer(1e-6, 1.1)], ids=str)
def test_a_plate_that_tilts(layer):
    """Free to turn, under a force off the centre: the resultant of the pressures goes through its point."""
    moment, options = (0.06, -0.04, 0), {"rotation": (None, None, 0.0)}
    found = solved([ground(), plate(moment=moment, **options)], layer)
    result = found.contact()
    forces, x = result.weights * result.pressure, result.x
    assert forces.sum() == pytest.approx(1.0, rel=1e-8)
    assert [forces @ x[:, 1], -forces @ x[:, 0]] == pytest.approx([-moment[0], -moment[1]], abs=1e-8)
    other = solved([ground(), plate(moment=moment, **options)], layer, method="newton-krylov")
    assert result.pressure == pytest.approx(other.contact().pressure, abs=3e-6 * result.peak_pressure)


@pytest.mark.parametrize("layer", [cd.HardContact(), cd.PowerLayer(1e-6, 1.1)], ids=str)
def test_two_elastic_surfaces(layer):
    """On equal grids, and either first, they are one of the combined modulus; on unlike ones nearly."""
    stiff = cd.Isotropic(3e3, 0.2)
    combined = 1 / (1 / (1e3 / (1 - 0.3**2)) + 1 / (3e3 / (1 - 0.2**2)))

    def pair(count):
        other = ground(count, "other", stiff, normal=(0, 0, -1), displacement=None, force=1.0)
        return [ground(), other]

    one = solved([ground(material=cd.Isotropic(combined, 0.0)), plate()], layer).contact()
    two, swapped = (solved(bodies, layer).contact() for bodies in (pair(24), pair(24)[::-1]))
    assert two.pressure == pytest.approx(one.pressure, abs=1e-6 * one.peak_pressure)
    assert swapped.force == pytest.approx(1.0, rel=1e-8)
    assert swapped.peak_pressure == pytest.approx(one.peak_pressure, rel=1e-6)
    unlike = solved(pair(36), layer).contact()
    assert unlike.force == pytest.approx(1.0, rel=1e-8)
    assert unlike.peak_pressure == pytest.approx(one.peak_pressure, rel=0.05)  # interpolated between 24 points


def test_hard_contact_is_hertz():
    radius, force = 10.0, 140.0
    hertz = cd.reference.hertz_sphere(force, radius, SOFT.E, SOFT.nu)
    flat = cd.PeriodicHalfSpace("ground", SOFT, (10.0, 10.0), (96, 96))
    ball = cd.RigidBody("ball", cd.Sphere((0, 0, radius), radius), displacement=(0, 0, None), force=(0, 0, -force))
    result = solved([flat, ball], cd.HardContact(), gap=0.0).contact()
    assert result.force == pytest.approx(force, rel=1e-9)
    assert result.peak_pressure == pytest.approx(hertz.peak_pressure, rel=0.01)


@pytest.mark.parametrize("layer", [cd.HardContact(), cd.PowerLayer(1e-8, 1.1)], ids=str)
def test_cost_does_not_grow_with_the_grid(layer):
    """Steps and transforms on grids of four and sixteen times as many points: the systems stay as well conditioned."""
    runs = [solved([ground(count), plate()], layer) for count in (16, 32, 64)]
    steps, solves = ([getattr(run.history[-1], of) for run in runs] for of in ("iteration", "body_solves"))
    assert steps[-1] <= steps[0] + 6  # the set of points loses a layer of them at each
    assert solves[-1] / steps[-1] < 1.5 * solves[0] / steps[0]


def test_a_load_that_grows_goes_on():
    """From the solution under a little less load few steps are needed, and it is the same."""
    less = solved([ground(), plate(1.0)], cd.HardContact())
    bodies = [ground(), plate(1.01)]
    fresh, further = (solved(bodies, cd.HardContact(), start=start) for start in (None, less))
    assert further.contact().pressure == pytest.approx(fresh.contact().pressure, abs=1e-8 * 1e3)
    assert further.iterations < fresh.iterations


@pytest.mark.parametrize(("moved", "closed"), [(-1e-3, True), (1.0, False)])
def test_prescribed_plates(moved, closed):
    """One that is moved needs no force to hold it; far away it touches nothing."""
    found = solved([ground(), plate(displacement=(0, 0, moved), force=0.0)], cd.HardContact())
    result = found.contact()
    assert (result.force > 0.0) == closed
    assert result.gap.min() > -1e-12
    assert found.imbalance < 1e-8


def test_what_is_pulled_away_is_told():
    with pytest.raises(cd.NoEquilibriumError, match="plate"):
        solved([ground(), plate(-1.0)], cd.HardContact())
