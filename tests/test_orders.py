"""The orders of the contact pressure against a manufactured one, on meshes that do not match: p + 1 in L², any law."""

from __future__ import annotations

import numpy as np
import pytest
from manufactured import Manufactured

import contactdd as cd


def rates(problem, degree, sizes, **options):
    """The rates of the error of p between each mesh and the next."""
    errors = [problem.error(cd.solve(problem.scene(n, degree, **options))) for n in sizes]
    return -np.diff(np.log(errors)) / np.diff(np.log(sizes))


@pytest.mark.parametrize("degree", [1, 2, pytest.param(3, marks=pytest.mark.long)])
def test_orders_in_the_plane(degree):
    """Measured 1.99, 2.98, 3.95. With m = 2 the second derivative of P jumps at the edge, on a node of these meshes:
    the rates come to p + 1 from below, by less than 0.06 between these meshes."""
    (rate,) = rates(Manufactured(), degree, (32, 64))
    assert degree + 1 - 0.06 < rate < degree + 1 + 0.06


@pytest.mark.parametrize("layer", [cd.LinearLayer(2e6), cd.PowerLayer(B=1.5e-5, a=0.5)], ids=repr)
def test_any_law(layer):
    (rate,) = rates(Manufactured(layer=layer), 2, (16, 32))
    assert 2.8 < rate < 3.2  # between coarser meshes than above


@pytest.mark.parametrize("shape", ["quadrilateral", "triangle"])
def test_any_cell(shape):
    (rate,) = rates(Manufactured(), 2, (16, 32), shape=shape, unlike=False)
    assert rate > 2.8  # even quadrilaterals superconverge, which is not refused


@pytest.mark.parametrize(("degree", "sizes", "least"), [(1, (4, 6), 1.8), (2, (2, 4), 2.3), (3, (1, 2), 3.4)])
def test_orders_in_space(degree, sizes, least):
    """Coarse meshes, far from the asymptotic order: a wrong term in the contact would leave no order at all."""
    (rate,) = rates(Manufactured(dim=3, half_width=1.0, exponent=4), degree, sizes)
    assert rate > least
