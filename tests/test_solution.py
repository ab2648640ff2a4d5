"""What a solution tells, from whichever unknowns it has to be found."""

from __future__ import annotations

import numpy as np
from scenes import block, stack

import contactdd as cd


def floating_stack() -> cd.Scene:
    """Two blocks pressed together from both ends, free to move up and down as one.

    One point per facet meets the middle node of the upper block's edges only: at other points that block's inside is
    needed and the lower one's is not.
    """
    lower = block("lower", 0, (8, 4), loads=[cd.Pressure("bottom", 10.0)], degree=1)
    upper = block("upper", 1, (8, 4), loads=[cd.Pressure("top", 10.0)], degree=2)
    return stack([lower, upper], quadrature_degree=1)


def test_a_floating_stack_has_one_gap_at_other_points_too():
    """Bodies seen from their contacts and whole bodies are the same problem, so every gap is the same."""
    condensed, assembled = (cd.solve(floating_stack(), local_solver=way) for way in ("condensed", "assembled"))
    found, expected = condensed.contact(degree=6), assembled.contact(degree=6)
    # Both residuals are below 1e-10, the layer is stiffer than the bodies by less than a hundred.
    np.testing.assert_allclose(found.gap, expected.gap, rtol=0, atol=1e-8 * np.abs(expected.gap).max())
    np.testing.assert_allclose(found.force, expected.force, rtol=1e-7)
