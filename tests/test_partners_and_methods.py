"""Coupled and decomposed methods agree whatever a body's partner is: all those without a mesh."""

from __future__ import annotations

import numpy as np
import pytest

import contactdd as cd

SOFT = cd.Isotropic(1e3, 0.3)
#: Soft beside the bodies, so that the decomposed methods converge within some hundred steps.
LAYER, LOAD = cd.PowerLayer(2e-3, 1.2), 2.0


def plane_block(right=1.0):
    mesh = cd.rectangle((0, 0), (right, 1), (6, 4))
    return cd.Body("block", mesh, SOFT, supports=[cd.Symmetry("left")], loads=[cd.Pressure("top", LOAD)])


def ring_block():
    mesh = cd.rectangle((0, 0), (1, 1), (6, 4))
    axis, loads = [cd.Symmetry("left")], [cd.Pressure("top", LOAD)]
    return cd.Body("block", mesh, SOFT, supports=axis, loads=loads, kinematics="axisymmetric")


def solid_block():
    mesh = cd.box((-0.5, -0.5, 0), (0.5, 0.5, 0.5), (3, 3, 2))
    return cd.Body("block", mesh, SOFT, supports=[cd.Symmetry("left", "front")], loads=[cd.Pressure("top", LOAD)])


def rigid(shape, **options):
    return cd.RigidBody("ground", shape, **options)


def bump(x):
    return 1e-2 * x[0] ** 2


PARTNERS = {
    "plane": (plane_block, lambda: rigid(cd.Plane((0, 0), (0, 1)))),
    "cylinder": (plane_block, lambda: rigid(cd.Cylinder((0, -5), 5))),
    "profile": (plane_block, lambda: rigid(cd.Profile(lambda x: -1e-2 * x**2, body="below"))),
    "level set": (plane_block, lambda: rigid(cd.LevelSet(lambda x: x[1] + 1e-2 * x[0] ** 2, centre=(0, 0), reach=1.0))),
    "half-plane": (plane_block, lambda: cd.HalfPlane("ground", SOFT, np.linspace(-0.1, 1.1, 25), 10.0)),
    "periodic half-plane": (plane_block, lambda: cd.PeriodicHalfPlane("ground", SOFT, 4.0, 48, origin=(-1, 0))),
    "strip": (plane_block, lambda: cd.ElasticStrip("ground", SOFT, 0.5, 4.0, 48, origin=(-1, 0))),
    "mirror": (plane_block, lambda: cd.MirrorPlane("ground", (0, 0), (0, 1))),
    "sphere": (ring_block, lambda: rigid(cd.Sphere((0, -5), 5), kinematics="axisymmetric")),
    "half-space of rings": (ring_block, lambda: cd.AxisymmetricHalfSpace("ground", SOFT, np.linspace(0, 1.1, 20))),
    "half-space": (solid_block, lambda: cd.HalfSpace("ground", SOFT, (1.2, 1.2), (6, 6))),
    "periodic half-space": (solid_block, lambda: cd.PeriodicHalfSpace("ground", SOFT, (1.5, 1.5), (8, 8))),
}


@pytest.mark.parametrize("name", PARTNERS)
def test_methods_agree(name):
    """All solve to a residual of 1e-10; the pressures are the same to a condition of some hundred more."""
    block, partner = PARTNERS[name]
    bodies = [block(), partner()]
    scene = cd.Scene(bodies, [cd.Contact((bodies[0], "bottom"), bodies[1], LAYER, gap=bump)])
    runs = {
        method: cd.solve(scene, method, max_iterations=2000, progress=False)
        for method in ("auto", "newton-krylov", "chord", "kurchatov", "anderson")
    }
    pressures = {method: run.contact().pressure for method, run in runs.items()}
    for method, pressure in pressures.items():
        assert pressure == pytest.approx(pressures["auto"], abs=1e-7 * pressures["auto"].max()), method
        assert runs[method].imbalance < 1e-8
    assert runs["auto"].contact().force > 0.0
