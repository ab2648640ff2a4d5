"""Identical bodies share the factorisation of their inside, and nothing changes by it."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import block, stack

import contactdd as cd
from contactdd.local import choose


def plates(moduli: list[float], heights: list[float] | None = None) -> cd.Scene:
    """Plates on a foundation, grooves between them."""
    heights = heights or [1.0] * len(moduli)
    bodies, top = [], 0.0
    for place, (modulus, height) in enumerate(zip(moduli, heights, strict=True)):
        supports = [cd.Fixed("bottom")] if place == 0 else []
        loads = [cd.Pressure("top", 10.0)] if place == len(moduli) - 1 else []
        steel = cd.Isotropic(modulus, 0.3)
        bodies.append(block(f"plate {place}", top, (12, 4), steel, height=height, supports=supports, loads=loads))
        top += height
    return stack(bodies)


def factors(scene: cd.Scene) -> int:
    """How many factorisations the bodies have between them."""
    return len(
        {
            id(getattr(problem.condensation, "original", problem.condensation))
            for problem in scene.local_problems("condensed")
        }
    )


def test_only_identical_bodies_share():
    assert factors(plates([2e5] * 6)) == 3  # the lowest is held, the highest has one contact
    assert factors(plates([2e5, 1e5, 2e5, 1e5, 2e5, 1e5])) == 4
    assert factors(plates([2e5] * 6, [1.0, 1.0, 1.0, 1.0 + 1e-9, 1.0, 1.0])) == 4


@pytest.mark.parametrize("method", ["auto", "chord"])
def test_sharing_changes_nothing(method, monkeypatch):
    tolerance = 1e-10 if method == "auto" else 1e-6
    shared = cd.solve(plates([2e5] * 5), method, tolerance=tolerance)
    monkeypatch.setattr(choose, "originals", lambda bodies: [None] * len(bodies))
    scene = plates([2e5] * 5)
    alone = cd.solve(scene, method, tolerance=tolerance)
    assert factors(scene) == 5
    assert shared.iterations == alone.iterations
    for body in scene.bodies:
        u, v = (solution.displacement(body.name).x.array for solution in (shared, alone))
        assert u == pytest.approx(v, abs=1e-9 * np.abs(v).max())
    for contact in scene.contacts:
        p, q = (solution.contact(contact.name).pressure for solution in (shared, alone))
        assert p == pytest.approx(q, abs=1e-7 * q.max())
