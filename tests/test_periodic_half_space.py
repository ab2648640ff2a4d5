"""The half-space on a periodic grid by Fourier transforms: closed forms, the same with matrices, rough surfaces."""

from __future__ import annotations

import numpy as np
import pytest

import contactdd as cd
from contactdd.partners.elastic_surface import ElasticSurface

E, NU = 1e3, 0.3
SOFT = cd.Isotropic(E, NU)
MODULUS = E / (1 - NU**2)


class Dense(cd.PeriodicHalfSpace):
    """The same with its matrix."""

    def stiffness(self):
        return ElasticSurface.stiffness(self)


def plate(force=None, moved=0.0):
    motion = (
        {"displacement": (0, 0, moved)} if force is None else {"displacement": (0, 0, None), "force": (0, 0, -force)}
    )
    return cd.RigidBody("plate", cd.Plane((0, 0, 0), (0, 0, -1)), **motion)


def rough(x, seed=0, waves=6):
    """A sum of waves with random phases, its highest point about 0 (length)."""
    rng, height = np.random.default_rng(seed), 0.0
    for i in range(1, waves):
        for j in range(1, waves):
            a, b = rng.uniform(0, 2 * np.pi, 2)
            height = height + 1e-3 * np.cos(2 * np.pi * i * x[0] + a) * np.cos(2 * np.pi * j * x[1] + b) / (i * j)
    return 4e-3 - height


def solved(ground, rigid, layer, gap=rough, **options):
    return cd.solve(cd.Scene([ground, rigid], [cd.Contact(ground, rigid, layer, gap=gap)]), **options)


def test_matrices_say_the_same():
    ground, dense = (kind("ground", SOFT, (1.0, 1.0), (12, 10)) for kind in (cd.PeriodicHalfSpace, Dense))
    assert ground.stiffness() @ np.eye(121) == pytest.approx(dense.stiffness(), abs=1e-9 * dense.stiffness().max())
    layer = cd.LinearLayer(500.0)  # soft enough for the plain chord
    expected = solved(dense, plate(force=0.5), layer)
    peak = expected.contact().pressure.max()
    for method in ("auto", "newton-krylov", "newton-chord", "chord", "anderson"):
        found = solved(ground, plate(force=0.5), layer, method=method, max_iterations=2000)
        assert found.contact().pressure == pytest.approx(
            expected.contact().pressure, abs=1e-6 * peak
        )  # solved to 1e-10
        assert found.displacement("plate")[2] == pytest.approx(expected.displacement("plate")[2], rel=1e-7)
        assert found.imbalance < 1e-8
        assert found.energy == pytest.approx(expected.energy, rel=1e-8)


@pytest.mark.parametrize("held", ["plate", "ground"])
def test_full_contact_with_a_wave(held):
    """Closed everywhere: p = p̄ + h / (c + 1/k) of each wave h, c = 2/(E* |k|)."""
    stiffness, mean = 1e5, 20.0
    options = {} if held == "ground" else {"displacement": None, "force": mean}
    ground = cd.PeriodicHalfSpace("ground", SOFT, (1.0, 0.5), (16, 10), **options)
    rigid = plate(force=0.5 * mean) if held == "ground" else plate()
    if held == "plate":
        ground = cd.PeriodicHalfSpace("ground", SOFT, (1.0, 0.5), (16, 10), displacement=None, force=0.5 * mean)

    def wave(x):
        return 1e-3 * np.cos(2 * np.pi * x[0]) * np.cos(4 * np.pi * x[1])

    result = solved(ground, rigid, cd.LinearLayer(stiffness), gap=lambda x: -wave(x)).contact()
    soft = 2 / (MODULUS * 2 * np.pi * np.sqrt(1 + 4)) + 1 / stiffness
    assert result.pressure == pytest.approx(mean + wave(result.x.T) / soft, rel=1e-7)


def test_a_ridge_is_the_half_plane():
    layer, force = cd.LinearLayer(1e6), 3.0
    plane = cd.PeriodicHalfPlane("ground", SOFT, 1.0, 32, origin=(-0.5 + 1 / 64, 0))
    space = cd.PeriodicHalfSpace("ground", SOFT, (1.0, 0.25), (32, 4))

    def ridge(x):
        return 1e-2 * (1 - np.cos(2 * np.pi * x[0]))

    roll = cd.RigidBody("plate", cd.Plane((0, 0), (0, -1)), displacement=(0, None), force=(0, -force))
    flat = solved(plane, roll, layer, gap=ridge)
    solid = solved(space, plate(force=0.25 * force), layer, gap=ridge)
    found, expected = solid.contact().pressure.reshape(32, 4), flat.contact().pressure
    assert found == pytest.approx(np.tile(expected[:, None], 4), abs=1e-7 * expected.max())
    assert solid.displacement("plate")[2] == pytest.approx(flat.displacement("plate")[1], rel=1e-8)


def test_a_small_contact_is_hertz():
    """A ball that touches a tenth of the period: its images disturb it little."""
    radius, force = 10.0, 140.0
    hertz = cd.reference.hertz_sphere(force, radius, E, NU)
    ground = cd.PeriodicHalfSpace("ground", SOFT, (10.0, 10.0), (96, 96))
    ball = cd.RigidBody("ball", cd.Sphere((0, 0, radius), radius), displacement=(0, 0, None), force=(0, 0, -force))
    result = solved(ground, ball, cd.LinearLayer(1e6), gap=0.0).contact()
    assert result.force == pytest.approx(force, rel=1e-8)
    assert result.pressure.max() == pytest.approx(hertz.peak_pressure, rel=0.02)


def test_hard_contact_on_a_grid():
    ground = cd.PeriodicHalfSpace("ground", SOFT, (1.0, 1.0), (24, 24))
    hard = solved(ground, plate(force=0.5), cd.HardContact())
    stiff = solved(ground, plate(force=0.5), cd.LinearLayer(1e8))
    peak = stiff.contact().pressure.max()
    assert hard.contact().pressure == pytest.approx(stiff.contact().pressure, abs=1e-3 * peak)
    assert hard.contact().penetration < 1e-6 * 8e-3


def test_a_rough_surface_closes_with_the_load():
    """Area and mean pressure grow with the force; on a finer grid of the same waves both stay."""
    force = cd.Parameter([0.0, 0.0, 0.0])
    areas = []
    for count in (32, 64):
        ground = cd.PeriodicHalfSpace("ground", SOFT, (1.0, 1.0), (count, count))
        rigid = cd.RigidBody("plate", cd.Plane((0, 0, 0), (0, 0, -1)), displacement=(0, 0, None), force=force)
        scene = cd.Scene([ground, rigid], [cd.Contact(ground, rigid, cd.PowerLayer(1e-4, 1.1), gap=rough)])
        record = {"area": lambda s: s.contact().area, "depth": lambda s: -s.displacement("plate")[2]}
        path = cd.programme(scene, force, [[0, 0, -f] for f in (0.25, 0.5, 1.0)], record=record)
        assert np.all(np.diff(path.records["area"]) > 0)
        assert np.all(np.diff(path.records["depth"]) > 0)
        areas.append(path.records["area"])
    assert areas[0] == pytest.approx(areas[1], rel=0.05)


def test_surfaces_between_points_repeat_themselves():
    ground = cd.PeriodicHalfSpace("ground", SOFT, (1.0, 0.5), (20, 16))
    x = np.random.default_rng(0).uniform(-2, 2, (50, 3))
    rows = ground.interpolation(x)
    assert rows.sum(axis=1) == pytest.approx(np.ones((50, 1)))
    waves = np.cos(2 * np.pi * ground.places[:, 0]) + np.sin(4 * np.pi * ground.places[:, 1])
    exact = np.cos(2 * np.pi * x[:, 0]) + np.sin(4 * np.pi * x[:, 1])
    assert rows @ waves == pytest.approx(exact, abs=0.04)  # (kh)²/8 of each
    assert ground.interpolation(ground.places).toarray() == pytest.approx(np.eye(320))


def test_large_grids_store_no_matrix():
    ground = cd.PeriodicHalfSpace("ground", SOFT, (1.0, 1.0), (256, 256))
    result = solved(ground, plate(force=2.0), cd.PowerLayer(1e-4, 1.1)).contact()
    assert result.force == pytest.approx(2.0, rel=1e-9)


def test_what_is_refused():
    ground = cd.PeriodicHalfSpace("ground", SOFT, (1.0, 1.0), (128, 128))
    with pytest.raises(ValueError, match="a matrix of 16384 points on a periodic grid: too large to be factored"):
        solved(ground, plate(force=0.5), cd.LinearLayer(1e4), method="newton-chord")
    with pytest.raises(ValueError, match="reference = 0: expected a number > 0"):
        cd.PeriodicHalfSpace("ground", SOFT, (1, 1), (4, 4), reference=0)
    with pytest.raises(ValueError, match="rectangles; expected 4194304 at most"):
        cd.PeriodicHalfSpace("ground", SOFT, (1, 1), (4096, 4096))
