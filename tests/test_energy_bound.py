"""The bound of the energy's error: above it, near it, and nothing where there is none."""

from __future__ import annotations

import numpy as np
import pytest
import scenes
import ufl
from random_blocks import bounded, energy, finer

import contactdd as cd


def test_what_is_exact():
    """Under an even pressure elements are exact: what is left is the tolerance of the solve, squared, and rounding."""
    bound = cd.energy_bound(cd.solve(scenes.pressed((4, 2), gap=0.0)))
    assert 0.0 <= bound.error < 1e-10 * abs(bound.energy)
    assert bound.relative < 1e-5


def test_a_column():
    """A layer, two blocks without lateral contraction, a pressure: F₁ in closed form, exact for linear elements."""
    E, k, q = 2.0e5, 1.0e6, 5.0
    rod = cd.Isotropic(E=E, nu=0.0)
    low = scenes.block("low", 0, (4, 2), rod, supports=[cd.Fixed("bottom")])
    high = scenes.block("high", 1, (4, 2), rod, loads=[cd.Pressure("top", q)])
    bound = cd.energy_bound(cd.solve(scenes.stack([low, high], cd.LinearLayer(k), 0.0)))
    exact = -0.5 * q**2 * scenes.LENGTH * (2 * scenes.HEIGHT / E + 1 / k)
    assert bound.energy == pytest.approx(exact, rel=1e-10)
    assert bound.least_energy == pytest.approx(exact, rel=1e-10)


@pytest.mark.parametrize(("degree", "cells"), [(1, 8), (1, 16), (2, 4)])
def test_the_exact_energy_of_the_groove(degree, cells):
    """The energy of the semi-analytic solution, elastic and layer's less the work of the loads, lies in between."""
    exact = cd.reference.groove()
    energy = exact.elastic_energy + exact.layer_energy - scenes.LOAD * scenes.LENGTH * exact.approach
    bound = cd.energy_bound(cd.solve(scenes.pressed((2 * cells, cells), degree=degree)))
    assert bound.least_energy < energy < bound.energy
    assert bound.error < 1.1 * (bound.energy - energy)  # measured: 1.013 to 1.018


@pytest.mark.parametrize("seed", range(2))
def test_random_blocks(seed):
    """Never below the error that a far finer solution tells of, and at most twice it."""
    outcome = bounded(seed, (1,))
    assert not outcome.fault, outcome


def test_the_bound_falls_like_the_error_and_the_gap_is_one_of_energies():
    """At degree 1 F₁ − min F₁ falls like h²; the dual energies of all meshes lie below all primal ones."""
    solutions = [cd.solve(scenes.pressed((2 * n, n), gap=lambda x: 0.2 * scenes.groove(x))) for n in (4, 8)]
    bounds = [cd.energy_bound(solution) for solution in solutions]
    assert np.log2(bounds[0].error / bounds[1].error) > 1.5  # the edge of contact costs some of the order
    for one in bounds:
        for other in bounds:
            assert one.least_energy < other.energy
    assert bounds[0].error == pytest.approx(sum(cells.sum() for cells in bounds[0].cells) + sum(bounds[0].contacts))
    assert all(np.all(cells >= 0) for cells in bounds[0].cells)


def test_a_state_far_from_the_solution():
    """What the iteration has left counts: a run that was stopped early is farther from the least energy."""
    scene = scenes.pressed((8, 4))
    solved = cd.solve(scene)
    stopped = cd.solve(scene, "chord", gamma=0.3, max_iterations=3, on_failure="return")
    bound = cd.energy_bound(stopped)
    assert not stopped.converged
    truth = cd.energy_bound(solved)
    assert bound.error > 1.2 * truth.error
    assert bound.error >= bound.energy - truth.energy + (truth.energy - energy(finer(scene, 1)))
    assert bound.least_energy <= energy(finer(scene, 1))


def test_prescribed_displacements_and_weight():
    """A block is lowered onto another, both have weight: no free motion, a constant body force."""
    weight = [cd.BodyForce((0.0, -3.0))]
    low = scenes.block("low", 0, (7, 4), supports=[cd.Fixed("bottom")], loads=weight)
    high = scenes.block("high", 1, (7, 4), supports=[cd.Displacement("top", (None, -1e-3))], loads=weight)
    scene = scenes.stack([low, high])
    bound = cd.energy_bound(cd.solve(scene))
    error = bound.energy - energy(finer(scene, 1))
    assert error <= bound.error < 1.5 * error  # some of the error is beyond the finer solution


def test_other_units():
    """In millimetres instead of centimetres the bound of the energy per thickness is a hundred times as large."""

    def bound(unit):
        def gap(x):
            return unit * scenes.groove(x / unit)

        low = scenes.block("low", 0, (6, 3), length=4 * unit, height=unit, loads=[cd.Pressure("bottom", 10.0)])
        high = scenes.block("high", unit, (6, 3), length=4 * unit, height=unit, loads=[cd.Pressure("top", 10.0)])
        layer = cd.PowerLayer(B=4e-6 * unit, a=1.1)
        return cd.energy_bound(cd.solve(scenes.stack([low, high], layer, gap)))

    # Which of two edges of the same length is cut where contact ends is a matter of rounding.
    large, small = bound(10.0), bound(1.0)
    assert large.error == pytest.approx(100 * small.error, rel=1e-3)
    assert large.energy == pytest.approx(100 * small.energy, rel=1e-9)
    assert large.relative == pytest.approx(small.relative, rel=1e-3)


def test_what_would_be_no_bound_is_refused():
    def pressed(**options):
        return cd.solve(scenes.pressed((4, 2), **options))

    with pytest.raises(TypeError, match="solution = 3: expected a Solution"):
        cd.energy_bound(3)
    with pytest.raises(ValueError, match="straight triangles"):
        cd.energy_bound(pressed(shape="quadrilateral"))
    with pytest.raises(ValueError, match="not a body of revolution"):
        cd.energy_bound(pressed(kinematics="axisymmetric"))
    with pytest.raises(ValueError, match="a constant material"):
        cd.energy_bound(pressed(material=cd.Isotropic(E=lambda x: 2e5 + x[0], nu=0.3)))
    with pytest.raises(ValueError, match="it is hard"):
        cd.energy_bound(pressed(layer=cd.HardContact(), quadrature="mortar"))
    low = scenes.block("low", 0, (4, 2), supports=[cd.Spring("bottom", 1e5)])
    high = scenes.block("high", 1, (4, 2), loads=[cd.Pressure("top", 10.0)])
    with pytest.raises(ValueError, match="it has a Spring; expected one of Fixed"):
        cd.energy_bound(cd.solve(scenes.stack([low, high])))
    with pytest.raises(ValueError, match="carries tension or shear"):
        cd.energy_bound(pressed(layer=cd.BondedLayer(cd.LinearLayer(1e6))))
    heated = scenes.block("high", 1, (4, 2), loads=[cd.ThermalStrain(1e-5, 1.0)])
    low = scenes.block("low", 0, (4, 2), supports=[cd.Fixed("bottom")])
    with pytest.raises(ValueError, match="it has a ThermalStrain"):
        cd.energy_bound(cd.solve(scenes.stack([low, heated], gap=-1e-4)))
    low = scenes.block("low", 0, (5, 2), supports=[cd.Fixed("bottom")])
    with pytest.raises(ValueError, match="facets that match"):
        cd.energy_bound(cd.solve(scenes.stack([low, high])))
    low = scenes.block("low", 0, (4, 2), supports=[cd.Fixed("bottom")], loads=[cd.BodyForce(lambda x: -x[:2])])
    with pytest.raises(ValueError, match="body force varies"):
        cd.energy_bound(cd.solve(scenes.stack([low, high])))
    x = ufl.SpatialCoordinate(high.mesh.domain)
    low = scenes.block("low", 0, (4, 2), supports=[cd.Fixed("bottom")])
    high = cd.Body("high", high.mesh, scenes.STEEL, supports=high.supports, loads=[cd.Pressure("top", 10 + x[0])])
    with pytest.raises(ValueError, match="UFL expression"):
        cd.energy_bound(cd.solve(scenes.stack([low, high])))


def test_shear_that_ends_at_a_free_corner_is_refused():
    """σ_xy is the load's on one face and zero on the other: no symmetric stress is continuous at their corner."""
    low = scenes.block("low", 0, (4, 2), supports=[cd.Fixed("bottom")])
    mesh = cd.rectangle((0, 1), (4, 2), (4, 2))
    loads = [cd.Pressure("top", 10.0), cd.Traction("right", (0.0, 1.0))]
    high = cd.Body("high", mesh, scenes.STEEL, supports=[cd.Symmetry("left")], loads=loads)
    with pytest.raises(ValueError, match="no symmetric stress that is continuous"):
        cd.energy_bound(cd.solve(scenes.stack([low, high], cd.LinearLayer(1e6), 0.0)))
