"""Contact between meshes that do not match, tested by physics: patch tests, balance, symmetry, known answers, rates."""

from __future__ import annotations

import numpy as np
import pytest

import contactdd as cd

STEEL, BRASS = cd.Isotropic(2.1e5, 0.3), cd.Isotropic(1.0e5, 0.35)
LAYER = cd.PowerLayer(B=4e-6, a=1.1)
LOAD = 10.0
# A pressure comes from a gap of 1e-5 between displacements of 1e-4 that a direct solver knows to 1e-15: 1e-10 has room.
ROUNDING = 1e-10


def pressed(lower: cd.Mesh, upper: cd.Mesh, degree: int = 1, **options) -> cd.Scene:
    """Two blocks pressed together by a uniform pressure, held from the sides: the exact stress is uniform."""
    sides = cd.Symmetry("left", "right", *(["front", "back"] if lower.dim == 3 else []))
    a = cd.Body("a", lower, STEEL, supports=[sides], loads=[cd.Pressure("bottom", LOAD)], degree=degree)
    b = cd.Body("b", upper, BRASS, supports=[sides], loads=[cd.Pressure("top", LOAD)], degree=degree)
    return cd.Scene([a, b], [cd.Contact((a, "top"), (b, "bottom"), LAYER, **options)])


def newton(scene: cd.Scene, tolerance: float = 1e-12) -> cd.Solution:
    """The solution to rounding; a run that cannot come that far is judged by the test's own numbers."""
    return cd.solve(scene, "newton", gamma="search", tolerance=tolerance, max_iterations=60, on_failure="return")


@pytest.mark.parametrize("quadrature", ["facet", "gauss"])
@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("shapes", [("triangle", "triangle"), ("quadrilateral", "triangle"), ("quadrilateral",) * 2])
def test_patch_in_the_plane(shapes, degree, quadrature):
    lower = cd.rectangle((0, 0), (4, 1), (7, 3), shape=shapes[0])
    upper = cd.rectangle((0, 1), (4, 2), (11, 2), shape=shapes[1])
    check_patch(pressed(lower, upper, degree, quadrature=quadrature), area=4.0)


@pytest.mark.parametrize("quadrature", ["facet", "gauss"])
@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize(
    "shapes", [("tetrahedron", "tetrahedron"), ("hexahedron", "hexahedron"), ("tetrahedron", "hexahedron")]
)
def test_patch_in_space(shapes, degree, quadrature):
    lower = cd.box((0, 0, 0), (1, 1.3, 0.5), (3, 4, 1), shape=shapes[0])
    upper = cd.box((0, 0, 0.5), (1, 1.3, 1), (5, 3, 1), shape=shapes[1])
    check_patch(pressed(lower, upper, degree, quadrature=quadrature), area=1.3)


def check_patch(scene: cd.Scene, area: float) -> None:
    solution = newton(scene)
    result = solution.contact()
    assert np.abs(result.pressure / LOAD - 1).max() < ROUNDING
    assert result.weights.sum() == pytest.approx(area, rel=1e-13)
    assert result.unmatched == (0.0, 0.0)
    forces = [solution.forces(body)["contact"] for body in scene.bodies]
    assert np.abs(forces[0] + forces[1]).max() < ROUNDING * LOAD * area
    assert np.abs(forces[0]).max() == pytest.approx(LOAD * area, rel=ROUNDING)
