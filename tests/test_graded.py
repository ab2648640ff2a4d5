"""Structured meshes whose cells are given by their ends."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import contactdd as cd
from contactdd.base import compat

X, Y, Z = [0.0, 0.1, 0.4, 2.0], [0.0, 0.7, 1.0], [-1.0, -0.2, 0.0]


def corners(mesh: cd.Mesh) -> set[tuple[float, ...]]:
    return {tuple(np.round(x[: mesh.dim], 12)) for x in mesh.domain.geometry.x}


@pytest.mark.parametrize("shape", ["triangle", "quadrilateral"])
def test_rectangle(shape):
    mesh = cd.rectangle((0, 0), (2, 1), (X, Y), shape=shape)
    assert corners(mesh) == {(x, y) for x in X for y in Y}
    assert mesh.cells == 6 * (2 if shape == "triangle" else 1)
    assert [len(mesh.facets(side)) for side in ("left", "right", "bottom", "top")] == [2, 2, 3, 3]


@pytest.mark.parametrize("shape", ["tetrahedron", "hexahedron"])
def test_box(shape):
    mesh = cd.box((0, 0, -1), (2, 1, 0), (X, 2, Z), shape=shape)
    assert corners(mesh) == {(x, y, z) for x in X for y in (0.0, 0.5, 1.0) for z in Z}


def test_crossed_cells_meet_in_their_middles():
    mesh = cd.rectangle((0, 0), (2, 1), (X, Y), diagonal="crossed")
    middles = {(round((a + b) / 2, 12), round((c + d) / 2, 12)) for a, b in pairwise(X) for c, d in pairwise(Y)}
    assert corners(mesh) == {(x, y) for x in X for y in Y} | middles


def test_equal_cells_given_by_their_ends_are_the_same():
    counted = cd.rectangle((0, 1), (4, 2), (8, 3))
    given = cd.rectangle((0, 1), (4, 2), (np.linspace(0, 4, 9), np.linspace(1, 2, 4)))
    assert np.array_equal(counted.domain.geometry.x, given.domain.geometry.x)
    assert np.array_equal(compat.geometry_dofmap(counted.domain), compat.geometry_dofmap(given.domain))


@pytest.mark.parametrize(
    "cells",
    [([0, 1], Y), ([0.0, 2.0, 1.0, 2.0], Y), ([0.5, 2.0], Y), ([[0.0, 2.0]], Y), ([0.0, np.nan, 2.0], Y), (0, Y)],
)
def test_refused(cells):
    with pytest.raises(ValueError, match="cells"):
        cd.rectangle((0, 0), (2, 1), cells)
