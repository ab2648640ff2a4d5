"""The reference in space: its balance and convergence, a limit in the plane, finite elements that approach it."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import contactdd as cd
from contactdd.layer import PowerLayer
from contactdd.reference.equation import ContactEquation
from contactdd.reference.groove import groove_shape

sys.path.insert(0, str(Path(__file__).parents[1] / "demos" / "studies"))
import dimple as study

MIDDLES = (np.arange(60) + 0.5) / 60


def pressures(points: int) -> np.ndarray:
    return cd.reference.dimple(points=points).pressure(MIDDLES[:, None], MIDDLES)


def test_the_pressure_carries_the_load_and_is_symmetric():
    p = pressures(128)
    assert p == pytest.approx(p.T, abs=1e-9)
    # The midpoint rule over 60 × 60 squares, which an edge of the contact cuts.
    assert p.mean() == pytest.approx(10.0, rel=2e-4)


def test_it_converges_to_the_published_numbers():
    """Edge and corner pressure of 2048 points a side, 0.317969 and 9.7106565; the order is nearly 2."""
    best = pressures(256)
    errors = [np.linalg.norm(pressures(n) - best) / np.linalg.norm(best) for n in (32, 64, 128)]
    assert np.log2(errors[0] / errors[1]) > 1.5
    assert errors[2] < 1e-4
    answer = cd.reference.dimple(points=256)
    assert answer.contact_edge == pytest.approx(0.317969, abs=2e-5)
    assert float(answer.pressure(1.0, 1.0)) == pytest.approx(9.7106565, rel=1e-5)


def test_a_groove_across_the_square_is_the_plane_problem():
    """A gap that depends on x alone: the same equation along a line."""
    n, k = 64, np.pi * np.arange(64)
    x = (np.arange(n) + 0.5) / n
    waves = np.hypot(k[:, None], k)
    waves[0, 0] = 1.0
    compliance = 2 * cd.reference.surface_compliance(waves, 0.5, 2.1e5, 0.3)
    compliance[0, 0] = 0.0
    d = np.repeat(groove_shape(x, 0.5, 2.5e-4)[:, None], n, axis=1)
    s, c = ContactEquation(PowerLayer(4e-6, 1.1), 10.0, d, compliance).solve()
    answer = cd.reference.groove(length=1.0, height=0.5, b=0.5, r0=2.5e-4, points=n)
    assert s + 10.0 == pytest.approx(np.repeat(answer.pressure(x)[:, None], n, axis=1), rel=1e-7, abs=1e-7)
    assert c + 20 * 0.5 / cd.reference.moduli.oedometric_modulus(2.1e5, 0.3) == pytest.approx(answer.approach, rel=1e-9)


def test_finite_elements_approach_it():
    answer, errors = cd.reference.dimple(points=128), []
    for name in ("Q:1:8:4:1", "Q:1:16:8:1"):
        contact = cd.solve(study.scene(study.Cells.named(name)), tolerance=1e-8).contact(degree=10)
        expected = answer.pressure(*contact.x[:, :2].T)
        errors.append(np.sqrt(contact.weights @ (contact.pressure - expected) ** 2 / (contact.weights @ expected**2)))
    assert errors[1] == pytest.approx(3.0e-3, rel=0.1)
    assert np.log2(errors[0] / errors[1]) > 1.5


@pytest.mark.parametrize("wrong", [{"points": 4}, {"side": -1.0}, {"nu": 0.5}, {"B": 0.0}])
def test_bad_arguments_are_refused(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        cd.reference.dimple(**wrong)
