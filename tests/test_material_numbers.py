"""Materials of UFL expressions in which no mesh occurs: numbers, matrices of them, and what UFL makes zero."""

from __future__ import annotations

import numpy as np
import pytest
import ufl

import contactdd as cd

STEEL = cd.Isotropic(2.1e5, 0.3)
VALUE = ufl.as_ufl(2.1e5)


@pytest.mark.parametrize(
    "material",
    [
        cd.Anisotropic(ufl.as_matrix(np.array(STEEL.stiffness()).tolist())),
        cd.Isotropic(E=VALUE, nu=ufl.as_ufl(0.3)),
        cd.Isotropic(E=2 * VALUE / 2 + 0 * VALUE, nu=0.3),
    ],
)
def test_numbers_in_ufl_are_numbers(material):
    """A column of one cell under a pressure comes down as that of numbers does."""
    walls = cd.Symmetry("left", "right")
    mesh = cd.rectangle((0, 0), (1, 1), (1, 1))
    pressed = [cd.Pressure("top", 10.0)]
    down = []
    for each in (material, STEEL):
        low = cd.Body("low", mesh, each, supports=[walls, cd.Fixed("bottom")])
        high = cd.Body("high", mesh.moved((0, 1)), STEEL, supports=[walls], loads=pressed)
        solution = cd.solve(cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(1e5))]))
        down.append(solution.displacement_at("high", [[0.5, 2.0]])[0, 1])
    assert down[0] == pytest.approx(down[1], rel=1e-12)
