"""Schur complements against dense algebra, where few unknowns or none are eliminated and the matrix is singular."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

import contactdd as cd
from contactdd.factor import Factor
from contactdd.subproblem import Subproblem


@pytest.fixture(scope="module")
def floating() -> sp.csr_matrix:
    """The stiffness of a block that can still move up and down."""
    lower = cd.Body("a", cd.rectangle((0, 0), (1, 1), (4, 3)), cd.Isotropic(1e3, 0.3), supports=[cd.Symmetry("left")])
    upper = cd.Body("b", cd.rectangle((0, 1), (1, 2), (4, 3)), cd.Isotropic(1e3, 0.3), supports=[cd.Fixed("top")])
    scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.LinearLayer(1.0))])
    return Subproblem(lower, 0, scene.interfaces).stiffness


@pytest.mark.parametrize("count", [0, 1, 2, 3, 8, 20])
def test_schur_complement(floating, count):
    dense, n = floating.toarray(), floating.shape[0]
    for seed in range(5):
        inner = np.sort(np.random.default_rng(seed).permutation(n)[:count])
        kept = np.setdiff1d(np.arange(n), inner)
        factor = Factor(floating.copy(), schur=kept)
        block, coupling = dense[np.ix_(inner, inner)], dense[np.ix_(kept, inner)]
        expected = dense[np.ix_(kept, kept)] - coupling @ np.linalg.solve(block, coupling.T)
        # To rounding: the inner block's condition is below a thousand.
        assert np.abs(factor.complement - expected).max() < 1e-11 * np.abs(dense).max()
        assert factor.solve(np.ones(n))[inner] == pytest.approx(np.linalg.solve(block, np.ones(count)), rel=1e-10)
