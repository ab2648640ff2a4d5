"""Meshes made for a wanted accuracy: it is there, cheaper than on uniform meshes, or it is said that it is not."""

from __future__ import annotations

import numpy as np
import pytest
import scenes
import ufl
from test_ranks import launch

import contactdd as cd

EXACT = cd.reference.groove()


def true_error(solution):
    result = solution.contact()
    p = EXACT.pressure(np.clip(result.x[:, 0], 0, EXACT.length))
    return np.sqrt(result.weights @ (result.pressure - p) ** 2 / (result.weights @ p**2))


def unknowns(scene):
    return sum(body.dofs for body in scene.bodies)


@pytest.mark.parametrize(("degree", "accuracy", "saved"), [(1, 2e-3, 1.5), (2, 2e-4, 2.0)])
def test_the_groove(degree, accuracy, saved):
    """The accuracy is there to a factor of 1.5, for fewer unknowns than uniform meshes of that error would have."""
    scene = scenes.pressed((8, 4), degree=degree)
    made = cd.adapt(scene, accuracy)
    assert made.reached
    assert made.status == "reached"
    assert made.rounds[-1].error <= accuracy < made.rounds[-2].error
    error = true_error(made.solution)
    assert error < 1.5 * accuracy
    uniform = scenes.pressed((64, 32), degree=degree) if degree == 1 else scenes.pressed((32, 16), degree=degree)
    rate = (degree + 1) / 2  # of the error by unknowns in the plane
    equal = unknowns(uniform) * (true_error(cd.solve(uniform)) / error) ** (1 / rate)
    assert unknowns(made.scene) < equal / saved
    assert scene.bodies[0].mesh.cells == 64  # the user's scene is as it was
    assert sum(made.rounds[-1].cells.values()) == sum(body.mesh.cells for body in made.scene.bodies)


def test_rate_by_unknowns():
    """At degree 2 the error falls like N^(−1.4) at least (uniform meshes: N^(−1.3) here, the edge costs the rest)."""
    made = cd.adapt(scenes.pressed((8, 4), degree=2), 1e-4)
    late = [r for r in made.rounds if r.error < 3e-3]
    rate = -np.polyfit(np.log([r.unknowns for r in late]), np.log([r.error for r in late]), 1)[0]
    assert rate > 1.4


def test_what_is_far_stays_coarse():
    """A block is held deep below: its cells at the contact become small, those at its foot stay large."""
    low = cd.Body(
        "low", cd.rectangle((0, -8), (4, 1), (8, 18)), scenes.STEEL,
        supports=[cd.Symmetry("left", "right"), cd.Fixed("bottom")],
    )  # fmt: skip
    high = scenes.block("high", 1, (8, 4), loads=[cd.Pressure("top", 10.0)])
    made = cd.adapt(scenes.stack([low, high]), 3e-3)
    assert made.reached
    domain = made.scene.bodies[0].mesh.domain
    from contactdd.base import compat

    y = domain.geometry.x[compat.geometry_dofmap(domain)][:, :, 1]
    heights, middle = np.ptp(y, axis=1), y.mean(axis=1)
    assert heights[middle > 0.8].min() <= 1 / 32
    assert heights[middle < -5].min() >= 0.25


@pytest.mark.parametrize("kinematics", ["plane stress", "axisymmetric"])
def test_other_kinematics(kinematics):
    made = cd.adapt(scenes.pressed((8, 4), kinematics=kinematics), 2e-2)
    finest = cd.solve(scenes.pressed((96, 48), kinematics=kinematics, degree=2))
    result = made.solution.contact()
    p = finest.contact().at(result.x)["pressure"]
    assert np.sqrt(result.weights @ (result.pressure - p) ** 2 / (result.weights @ p**2)) < 3e-2


def test_in_space():
    meshes = [cd.box((0, 0, z), (2, 1, z + 1), (4, 2, 2)) for z in (0, 1)]
    low = cd.Body("low", meshes[0], scenes.STEEL, supports=[cd.Fixed("bottom")])
    high = cd.Body("high", meshes[1], scenes.STEEL, loads=[cd.Pressure("top", 10.0)])
    gap = cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(1e6), gap=lambda x: 2e-5 * x[0] ** 2)
    made = cd.adapt(cd.Scene([low, high], [gap]), 2.5e-2)
    assert made.reached
    assert len(made.rounds) > 1
    assert made.solution.contact().force == pytest.approx(20.0, rel=1e-8)
    again = cd.error_estimate(made.solution, degrees=2)  # a better judge
    assert again.pressure.relative < 3.75e-2


@pytest.mark.parametrize(
    ("options", "status"),
    [
        ({"max_unknowns": 400}, "unknowns limit"),
        ({"max_rounds": 2}, "rounds limit"),
        ({"time_limit": 1e-9}, "time limit"),
    ],
)
def test_limits(options, status):
    """What is not reached is never claimed; the last solution is kept."""
    with pytest.warns(cd.ContactWarning, match=f"adapt: {status}, the estimated error of the pressure is 0.0"):
        made = cd.adapt(scenes.pressed((8, 4)), 1e-5, **options)
    assert not made.reached
    assert made.status == status
    assert made.solution.converged
    assert made.rounds[-1].error > 1e-5
    assert unknowns(made.scene) <= options.get("max_unknowns", 600)  # a round makes three of one at most


def test_refusals_before_anything_is_solved():
    scene = scenes.pressed((8, 4))
    with pytest.raises(TypeError, match=r"scene = 3: expected a cd\.Scene"):
        cd.adapt(3, 1e-2)
    with pytest.raises(ValueError, match="accuracy = 0: expected a number > 0"):
        cd.adapt(scene, 0)
    with pytest.raises(ValueError, match="on_failure = 'no'"):
        cd.adapt(scene, 1e-2, on_failure="no")
    with pytest.raises(ValueError, match="quadrilaterals, which cannot be refined"):
        cd.adapt(scenes.pressed((8, 4), shape="quadrilateral"), 1e-2)
    x = ufl.SpatialCoordinate(scene.bodies[0].mesh.domain)
    body = cd.Body("lower", scene.bodies[0].mesh, scenes.STEEL, loads=[cd.Pressure("bottom", x[0])])
    with pytest.raises(ValueError, match="its Pressure is a UFL expression"):
        cd.adapt(scene.with_bodies({"lower": body}), 1e-2)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(12))
def test_no_accuracy_is_falsely_claimed(seed):
    """Random grooves, loads, laws and unlike meshes: the error, by cells a quarter of the size and a degree more, is at
    most twice what was asked for."""
    rng = np.random.default_rng(seed)
    depth, middle, load = 10 ** rng.uniform(-4.3, -3), rng.uniform(0, 4), 10 ** rng.uniform(0.5, 1.5)
    layer = cd.PowerLayer(B=10 ** rng.uniform(-6, -5), a=rng.uniform(0.5, 1.5))
    cells = [(int(rng.integers(8, 14)), int(rng.integers(3, 6))) for _ in range(2)]
    degree = int(rng.integers(1, 3))
    low = scenes.block("low", 0, cells[0], loads=[cd.Pressure("bottom", load)], degree=degree)
    high = scenes.block("high", 1, cells[1], loads=[cd.Pressure("top", load)], degree=degree)
    scene = scenes.stack([low, high], layer, lambda x: scenes.groove(x, depth, 1.0, middle))
    accuracy = 10 ** rng.uniform(-2.5, -1.5)
    made = cd.adapt(scene, accuracy)
    assert made.reached
    fine = made.scene.refined().refined()
    fine = fine.with_bodies({body.name: body.with_degree(degree + 1) for body in fine.bodies})
    result = made.solution.contact()
    p = cd.solve(fine).contact().at(result.x)["pressure"]
    true = np.sqrt(result.weights @ (result.pressure - p) ** 2 / (result.weights @ p**2))
    assert true < 2 * accuracy


RANKS = """
from mpi4py import MPI
import contactdd as cd
from scenes import block, stack

bodies = [block("a", 0, (8, 4), loads=[cd.Pressure("bottom", 10.0)]), block("b", 1, (8, 4),
          loads=[cd.Pressure("top", 10.0)])]
made = cd.adapt(stack(bodies, comm=MPI.COMM_WORLD), 2e-2)
print("told", [r.unknowns for r in made.rounds], made.status)
"""


def test_the_same_meshes_on_several_ranks():
    told = set()
    for ranks in (1, 2):
        done = launch(ranks, RANKS)
        assert done.returncode == 0, done.stderr
        told |= {line for line in done.stdout.splitlines() if line.startswith("told")}
    assert len(told) == 1
