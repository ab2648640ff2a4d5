"""Schur complements against dense algebra, where few unknowns or none are eliminated and the matrix is singular."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

import contactdd as cd
from contactdd.local.factor import Factor


@pytest.fixture(scope="module")
def floating() -> sp.csr_matrix:
    """The stiffness of a block that can still move up and down."""
    lower = cd.Body("a", cd.rectangle((0, 0), (1, 1), (4, 3)), cd.Isotropic(1e3, 0.3), supports=[cd.Symmetry("left")])
    upper = cd.Body("b", cd.rectangle((0, 1), (1, 2), (4, 3)), cd.Isotropic(1e3, 0.3), supports=[cd.Fixed("top")])
    scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.LinearLayer(1.0))])
    return scene.local_problems("assembled")[0].stiffness


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
        assert np.abs(factor.schur_complement - expected).max() < 1e-11 * np.abs(dense).max()
        assert factor.solve(np.ones(n))[inner] == pytest.approx(np.linalg.solve(block, np.ones(count)), rel=1e-10)


def test_nothing_kept():
    """Supports may hold all that the contacts of a body touch."""
    matrix = sp.csr_matrix(np.diag([2.0, 3.0, 4.0]) + 0.5 * np.ones((3, 3)))
    factor = Factor(matrix.copy(), schur=np.zeros(0, dtype=np.intp))
    assert factor.schur_complement.shape == (0, 0)
    assert factor.solve(np.ones(3)) == pytest.approx(np.linalg.solve(matrix.toarray(), np.ones(3)), rel=1e-14)


def test_no_unknowns_at_all():
    empty = sp.csr_matrix((0, 0))
    for factor in (Factor(empty), Factor(empty, schur=np.zeros(0, dtype=np.intp))):
        factor.update(np.zeros(0))
        assert factor.solve(np.zeros(0)).shape == (0,)
        assert factor.schur_complement.shape == (0, 0)
