"""The moment of a contact whose pressure is a linear field on nodes is that field's own, not one of forces at nodes."""

from __future__ import annotations

import numpy as np
import pytest

import contactdd as cd

STEEL = cd.Isotropic(2.1e5, 0.3)


def pressed(cells, loads, other=None, swapped=False):
    """A loose block, pressed by tractions on its top on a floor, or on a partner without a mesh: the contact's result.

    Its elements can turn as rigid bodies: whatever the pressure is, its moment is the load's to the tolerance.
    """
    flat, box = len(cells) == 2, cd.rectangle if len(cells) == 2 else cd.box
    corners = (((0, 1), (2, 2)), ((-1, 0), (3, 1))) if flat else (((0, 0, 1), (2, 1, 2)), ((-1, -1, 0), (3, 2, 1)))
    upper = cd.Body("upper", box(*corners[0], cells), STEEL, loads=[cd.Traction("top", loads)])
    floor = box(*corners[1], tuple(n + 1 for n in cells))
    lower = other or cd.Body("lower", floor, STEEL, supports=[cd.Fixed("bottom")])
    sides = [(upper, "bottom"), other or (lower, "top")]
    first, second = reversed(sides) if swapped else sides
    contact = cd.Contact(first, second, cd.LinearLayer(1e4), quadrature="mortar")
    return cd.solve(cd.Scene([upper, lower], [contact]), tolerance=1e-12).contact()


@pytest.mark.parametrize("partner", ["block", "rigid"])
@pytest.mark.parametrize("swapped", [False, True])
def test_moment_of_a_linear_pressure(partner, swapped):
    """6 + 3 (x − 1) from 0 to 2: force 12, moment 3 · 2³/12 = 2 about the middle; forces at the nodes have 2.25."""
    rigid = cd.RigidBody("plate", cd.Plane((0, 1), (0, 1))) if partner == "rigid" else None
    result = pressed((4, 2), lambda x: (0.0 * x[0], -6 - 3 * (x[0] - 1)), rigid, swapped)
    assert result.force == pytest.approx(12, rel=1e-9)
    assert result.moment((1, 1)) == pytest.approx(-2 if swapped else 2, rel=1e-9)  # on the first body
    np.testing.assert_allclose(result.centre_of_pressure, [1 + 2 / 12, 1], rtol=1e-9)
    np.testing.assert_allclose(result.sorted().moment((1, 1)), result.moment((1, 1)), rtol=1e-12)


def test_moment_in_space():
    """6 + 3 (x − 1) + 2 (y − 1/2) on 2 × 1: about the middle ∫ (y − 1/2) p = 2 · 2/12 and −∫ (x − 1) p = −2."""
    result = pressed((3, 2, 2), lambda x: (0 * x[0], 0 * x[0], -6 - 3 * (x[0] - 1) - 2 * (x[1] - 0.5)))
    np.testing.assert_allclose(result.moment((1, 0.5, 1)), [1 / 3, -2, 0], rtol=1e-8, atol=1e-8)
