"""The Krylov steps: a body is factored once for each coefficient φ, however often it is solved with it."""

from __future__ import annotations

import numpy as np
import pytest
import scipy
from scenes import block, groove, stack

import contactdd as cd
from contactdd.local.factor import Factor


def foundation(count: int) -> cd.Scene:
    """Blocks on a foundation, pressed together over grooves."""
    blocks = [
        block(
            f"block {place}",
            place,
            (12, 3),
            supports=[cd.Fixed("bottom")] if place == 0 else [],
            loads=[cd.Pressure("top", 10.0)] if place == count - 1 else [],
        )
        for place in range(count)
    ]
    return stack(blocks, gap=lambda x: groove(x, middle=2.0))


def counted(function, calls: list):
    """The same function, which leaves a mark in `calls` each time."""

    def marked(*arguments, **options):
        calls.append(function)
        return function(*arguments, **options)

    return marked


@pytest.mark.parametrize("local_solver", ["condensed", "assembled"])
def test_a_body_is_factored_once_per_correction(local_solver, monkeypatch):
    """It is solved many times more, and the forces balance as before."""
    scene, done = foundation(4), []
    scene.local_problems(local_solver)  # the insides are eliminated before the counting begins
    for owner, name in ((scipy.linalg.lapack, "dpotrf"), (scipy.linalg.lapack, "dposv"), (Factor, "update")):
        monkeypatch.setattr(owner, name, counted(getattr(owner, name), done))
    solution = cd.solve(scene, "newton-krylov", local_solver=local_solver)
    assert solution.history[-1].body_solves >= 5 * 4 * solution.iterations
    assert 4 * (solution.iterations - 1) <= len(done) <= 4 * solution.iterations  # the first Factor needs no update
    assert solution.contact(0).force == pytest.approx(40.0, rel=1e-8)  # the residual is below 1e-10 of all forces


@pytest.mark.parametrize("local_solver", ["condensed", "assembled", "multigrid"])
def test_held_is_one_symmetric_inverse_for_many_forces(local_solver):
    """Where the supports hold the body it is (A + Φ)⁻¹ itself, as `correct` finds it, or a multigrid cycle near it."""
    scene = foundation(2)
    problem = scene.local_problems(local_solver)[0]
    phi = {i: np.full(len(face.weights), 1e5) for i, face in enumerate(scene.interfaces)}
    held = problem.robin_solver(phi)
    forces = np.random.default_rng(1).standard_normal((3, problem.size))
    found = np.array([held(force) for force in forces])
    products = forces @ found.T
    # Symmetric to rounding, that of a condition of some 1e4.
    np.testing.assert_allclose(products, products.T, rtol=0, atol=1e-10 * np.abs(products).max())
    assert np.all(np.diag(products) > 0)
    np.testing.assert_array_equal(held(forces[0]), found[0])  # a solve leaves nothing behind
    if local_solver != "multigrid":
        expected = np.array([problem.correct(phi, force, 1.0) for force in forces])
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * np.abs(expected).max())
