"""Faults that random scenes found, each with its right value."""

from __future__ import annotations

import numpy as np
import pytest
import random_scenes
from scenes import block
from scipy.optimize import brentq

import contactdd as cd

STEEL, WALLS = cd.Isotropic(2.1e5, 0.3), cd.Symmetry("left", "right")


@pytest.mark.parametrize("length", [1.0, 1e6])
@pytest.mark.parametrize("softness", [1e-3, 1e-9])
def test_what_soft_springs_give_way_is_told_in_any_unit(length, softness):
    """A block on a layer pushed sideways against springs k moves by q/k and a little for its own strain.

    Taken for a motion that nothing resists, by a threshold that depended on the unit of length, it was reported zero.
    """
    E, k = 1e5, softness * 1e5 / length
    ground = cd.rectangle((0, 0), (4 * length, length), (8, 2))
    mesh = cd.rectangle((0, length), (4 * length, 2 * length), (9, 2))
    lower = cd.Body("lower", ground, cd.Isotropic(E, 0.0), supports=[cd.Fixed("bottom")])
    upper = cd.Body("upper", mesh, cd.Isotropic(E, 0.0), supports=[cd.Spring("left", k, direction=(1, 0))],
                    loads=[cd.Pressure("top", 1.0), cd.Traction("left", (1e-6 * softness * E, 0.0))])  # fmt: skip
    scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.LinearLayer(E / length))])
    solution = cd.solve(scene)
    u_x = solution.displacement("upper").x.array[::2]
    at_left = np.isclose(upper.space.tabulate_dof_coordinates()[:, 0], 0.0, atol=1e-9 * length)
    # The load is at the springs, so that the block is not strained by it; the residual is 1e-10 of the pressure, and
    # the sideways force 1e-6 softness of that.
    assert u_x[at_left] == pytest.approx(1e-6 * length, rel=max(1e-6, 1e-10 / (1e-6 * softness * E)))


@pytest.mark.parametrize("method", ["auto", "newton-krylov", "newton-chord", "anderson", "chord", "kurchatov"])
def test_a_settlement_that_reaches_nothing(method):
    """A block loose between two others that are not brought close enough: no forces, in any method.

    With rounding alone at work there is no scale; the block was "held by nothing", or the run went on for ever.
    """
    bodies = [block("1", 0.0, (4, 2), supports=[cd.Fixed("bottom")]), block("2", 1.0, (5, 2)),
              block("3", 2.0, (4, 3), supports=[cd.Displacement("top", [None, -1e-4])])]  # fmt: skip
    layer = cd.PowerLayer(4e-6, 1.1)
    contacts = [cd.Contact((low, "top"), (high, "bottom"), layer, gap=gap)
                for low, high, gap in zip(bodies[:-1], bodies[1:], (0.0, 2e-4), strict=True)]  # fmt: skip
    solution = cd.solve(cd.Scene(bodies, contacts), method, max_iterations=200)
    # In a decomposed method a force that began as the layer's goes to zero by its relaxation, to the tolerance.
    assert all(solution.contact(contact).peak_pressure <= 1e-9 for contact in contacts)
    assert all(np.all(solution.contact(contact).gap > -1e-12) for contact in contacts)


@pytest.mark.parametrize("depth", [10.0, 100.0, 270.0])
@pytest.mark.parametrize("method", ["auto", "newton-krylov", "newton-chord"])
def test_an_exponential_law_met_many_decay_lengths_deep(depth, method):
    """Two held blocks with an interference: δ = w₀ log(1 + p/p₀) + 2 h p/M, M the modulus of the sheet between walls.

    At 270 decay lengths the first slope is 10¹¹⁷ times the last: a full step, which opened all and far more, left of it
    less than the thousandth that the line search asks for, and was taken.
    """
    p0, w0, nu, E = 1.0, 1e-6, 0.3, 2.1e5
    modulus = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    bodies = [block("lower", 0.0, (4, 2), supports=[cd.Symmetry("bottom")]),
              block("upper", 1.0, (4, 2), supports=[cd.Symmetry("top")])]  # fmt: skip
    contact = cd.Contact((bodies[0], "top"), (bodies[1], "bottom"), cd.ExponentialLayer(p0, w0), gap=-depth * w0)
    solution = cd.solve(cd.Scene(bodies, [contact]), method, max_iterations=60)
    right = brentq(
        lambda p: w0 * np.log1p(p / p0) + 2 * p / modulus - depth * w0, 0.0, depth * w0 * modulus, rtol=1e-14
    )
    assert solution.contact().pressure == pytest.approx(right, rel=1e-9)
    energy = solution.history.energy
    assert np.all(np.diff(energy) <= 1e-15 * energy[-1])  # at the end it rounds, either way


@pytest.mark.parametrize("method", ["auto", "newton-krylov", "newton", "anderson"])
def test_a_rigid_body_free_sideways(method):
    """A rigid plate under a force, which frictionless contact does not hold sideways: the pressure is the force's.

    Neither stiffness nor contact resisted that motion, and the eigenproblem of its lowest modes was singular.
    """
    floor = block("floor", 0.0, (4, 2), supports=[cd.Symmetry("bottom")])
    plate = random_scenes.Plate(height=1.0, radius=np.inf, size=2.0, force=40.0, depth=None)
    plate.prescribed = lambda: np.full(3, np.nan)
    solution = cd.solve(cd.Scene([floor, plate], [cd.Contact((floor, "top"), plate, cd.LinearLayer(1e6))]), method)
    assert solution.contact().pressure == pytest.approx(10.0, rel=1e-8)
