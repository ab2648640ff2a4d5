"""What a solution tells, from whichever unknowns it has to be found."""

from __future__ import annotations

import numpy as np

import contactdd as cd

STEEL = cd.Isotropic(E=2.1e5, nu=0.3)  # MPa; lengths in cm
LAYER = cd.PowerLayer(B=4e-6, a=1.1)


def floating_stack() -> cd.Scene:
    """Two blocks pressed together from both ends, free to move up and down as one.

    One point per facet meets the middle node of the upper block's edges only: at other points that block's inside is
    needed and the lower one's is not.
    """
    sides = [cd.Symmetry("left", "right")]
    low, high = cd.rectangle((0, 0), (4, 1), (8, 4)), cd.rectangle((0, 1), (4, 2), (8, 4))
    lower = cd.Body("lower", low, STEEL, supports=sides, loads=[cd.Pressure("bottom", 10.0)], degree=1)
    upper = cd.Body("upper", high, STEEL, supports=sides, loads=[cd.Pressure("top", 10.0)], degree=2)

    def gap(x):
        return 5e-4 * np.maximum(1 - x[0] ** 2, 0) ** 1.5

    contact = cd.Contact((lower, "top"), (upper, "bottom"), LAYER, gap=gap, quadrature_degree=1)
    return cd.Scene([lower, upper], [contact])


def test_a_floating_stack_has_one_gap_at_other_points_too():
    """Bodies seen from their contacts and whole bodies are the same problem, so every gap is the same."""
    condensed, assembled = (cd.solve(floating_stack(), local_solver=way) for way in ("condensed", "assembled"))
    found, expected = condensed.contact(degree=6), assembled.contact(degree=6)
    # Both residuals are below 1e-10, the layer is stiffer than the bodies by less than a hundred.
    np.testing.assert_allclose(found.gap, expected.gap, rtol=0, atol=1e-8 * np.abs(expected.gap).max())
    np.testing.assert_allclose(found.force, expected.force, rtol=1e-7)
