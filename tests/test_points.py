"""Supports and forces at single nodes."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import STEEL, block, stack

import contactdd as cd

K = 1e4


def pressed(high: cd.Body) -> cd.Scene:
    low = block("low", 0.0, (4, 2), supports=[cd.Fixed("bottom")])
    return stack([low, high], cd.LinearLayer(K), 0.0)


def nodes_of(mesh: cd.Mesh, y: float) -> np.ndarray:
    x = mesh.domain.geometry.x
    return x[np.isclose(x[:, 1], y), :2]


@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("shape", ["triangle", "quadrilateral"])
def test_held_nodes_hold_what_lies_between(degree, shape):
    """All vertices of a side held are the side held, in elements of any degree."""
    mesh = cd.rectangle((0, 1), (4, 2), (4, 2), shape=shape)
    side = cd.Displacement("top", (0.0, -1e-3))
    points = cd.PointDisplacement(nodes_of(mesh, 2.0), (0.0, -1e-3))
    found = [
        cd.solve(pressed(cd.Body("high", mesh, STEEL, supports=[each], degree=degree))).displacement("high").x.array
        for each in (side, points)
    ]
    np.testing.assert_array_equal(*found)


def test_one_node_keeps_a_body_from_sliding():
    """A smooth block that nothing holds sideways: a single node takes no force, and the rest is as between walls."""
    mesh = cd.rectangle((0, 1), (4, 2), (4, 2))
    load = [cd.Pressure("top", 3.0)]
    body = cd.Body("high", mesh, STEEL, supports=[cd.PointDisplacement([[2.0, 1.0]], (0.0, None))], loads=load)
    solution = cd.solve(pressed(body))
    assert solution.contact().force == pytest.approx(12.0, rel=1e-9)
    assert abs(solution.forces("high")["supports"][0]) < 1e-8 * 12.0
    assert cd.error_estimate(solution).pressure.relative < 0.05  # in elements of degree 2 it is the same node


def test_nodal_forces_are_what_a_pressure_does():
    """Equal pressures on equal linear facets: half as much at the ends."""
    mesh = cd.rectangle((0, 1), (4, 2), (4, 2))
    walls = [cd.Symmetry("left", "right")]
    x = nodes_of(mesh, 2.0)
    shares = np.where(np.isclose(x[:, 0] % 4, 0), 0.5, 1.0)
    forces = cd.PointForce(x, np.outer(shares, [0.0, -3.0]))
    by_nodes, by_pressure = (
        cd.solve(pressed(cd.Body("high", mesh, STEEL, supports=walls, loads=[load]))).displacement("high").x.array
        for load in (forces, cd.Pressure("top", 3.0))
    )
    np.testing.assert_allclose(by_nodes, by_pressure, rtol=0, atol=1e-15)


def test_refusals():
    mesh = cd.rectangle((0, 1), (4, 2), (4, 2))
    with pytest.raises(ValueError, match="no node at"):
        cd.solve(pressed(cd.Body("high", mesh, STEEL, supports=[cd.PointDisplacement([[0.3, 1.2]], (0.0, 0.0))])))
    with pytest.raises(ValueError, match="expected 2 entries"):
        cd.Body("high", mesh, STEEL, supports=[cd.PointDisplacement([[0.0, 1.0]], (0.0, 0.0, 0.0))])
    with pytest.raises(ValueError, match="points"):
        cd.PointDisplacement([], (0.0, 0.0))
    with pytest.raises(ValueError, match="forces"):
        cd.PointForce([[0.0, 1.0]], (0.0, np.nan))
    with pytest.raises(ValueError, match="3 coordinates"):
        cd.Body("high", mesh, STEEL, loads=[cd.PointForce([[0.0, 1.0, 0.0]], (0.0, 1.0, 0.0))])
    held = cd.Body("high", mesh, STEEL, supports=[cd.PointDisplacement(nodes_of(mesh, 2.0), (0.0, 0.0))])
    with pytest.raises(ValueError, match="not those between them"):
        cd.adapt(pressed(held), 1e-2)
