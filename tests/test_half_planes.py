"""The groove between bodies that grow towards half-planes, its layer towards none: the closed form of MODEL.md's end.

What is left of the difference must be explained: by b/l (the sides are planes of symmetry: a row of grooves 2l apart)
and by the mesh.
"""

from __future__ import annotations

import numpy as np
import pytest
from scenes import DEPTH, groove

import contactdd as cd

E, NU, B, LOAD = 2.1e5, 0.3, 1.0, 20.0
EXACT = cd.reference.groove_half_planes(q=LOAD, E=E, nu=NU, b=B, r0=DEPTH)


def solve(length, refine, stiffness=1e10):
    """Bodies of l × l, quadratic quadrilaterals, fine at the groove and growing away from it."""
    x = np.concatenate(
        [
            np.linspace(0.0, 1.5 * B, 24 * refine + 1),
            1.5 * B * np.geomspace(1.0, length / (1.5 * B), 12 * refine + 1)[1:],
        ]
    )
    y = np.concatenate(
        [np.linspace(0.0, 0.5, 6 * refine + 1), 0.5 * np.geomspace(1.0, length / 0.5, 12 * refine + 1)[1:]]
    )
    steel, sides = cd.Isotropic(E=E, nu=NU), [cd.Symmetry("left", "right")]
    lower_mesh = cd.rectangle((0, -length), (length, 0), (x, -y[::-1]), shape="quadrilateral")
    upper_mesh = cd.rectangle((0, 0), (length, length), (x, y), shape="quadrilateral")
    lower = cd.Body("lower", lower_mesh, steel, supports=sides, loads=[cd.Pressure("bottom", LOAD)], degree=2)
    upper = cd.Body("upper", upper_mesh, steel, supports=sides, loads=[cd.Pressure("top", LOAD)], degree=2)
    layer = cd.LinearLayer(stiffness)
    contact = cd.Contact((lower, "top"), (upper, "bottom"), layer, gap=groove, quadrature_degree=8)
    result = cd.solve(cd.Scene([lower, upper], [contact])).contact(degree=20)
    order = np.argsort(result.x[:, 0])
    return result.x[order, 0], np.maximum(result.gap[order], 0.0), result.pressure[order]


def open_half_width(x, gap):
    """a* from the whole profile: gap^{2/3} = r₀^{2/3} (a*² − x²) / b² is a straight line over x²."""
    inner = x < 0.6 * EXACT.open_half_width
    slope, intercept = np.polyfit(x[inner] ** 2, gap[inner] ** (2 / 3), 1)
    return np.sqrt(-intercept / slope)


def test_difference_falls_with_the_square_of_b_over_l():
    lengths = np.array([5.0, 10.0, 20.0])
    errors = []
    for length in lengths:
        x, gap, _ = solve(length, refine=2)
        width = abs(open_half_width(x, gap) / EXACT.open_half_width - 1)
        profile = np.abs(gap - EXACT.gap(x))[x < B].max() / EXACT.gap(np.zeros(1))[0]
        errors.append((width, profile))
    rates = -np.polyfit(np.log(lengths), np.log(np.array(errors)), 1)[0]
    # The neighbouring grooves' stresses decay with (b/l)²; the mesh's own error bends the fit by a little.
    assert rates == pytest.approx([2.0, 2.0], abs=0.25)
    assert errors[-1][0] < 2e-3
    assert errors[-1][1] < 3e-3


def test_rest_is_the_mesh():
    """Far enough from the sides, a finer mesh takes the difference down to what b/l leaves."""
    errors = []
    for refine in (1, 2):
        x, gap, _ = solve(60.0, refine)
        errors.append(np.abs(gap - EXACT.gap(x))[x < B].max() / EXACT.gap(np.zeros(1))[0])
    assert errors[1] < 0.6 * errors[0]
    # By the rate above b/l = 1/60 leaves 3e-4; the rest is one cell of 1/32 at the edge of contact.
    assert errors[1] < 2e-3


def test_pressure():
    # A layer as good as rigid is a penalty: displacements are right, but p = k z magnifies their smallest waves. This
    # one still yields only 2e-7 under the load, a 2500th of the groove's depth.
    x, _, p = solve(20.0, refine=2, stiffness=1e8)
    # Within a cell of the edge of contact, and of the groove's rim, the pressure has a root; elsewhere it is smooth.
    smooth = (np.abs(x - EXACT.open_half_width) > 0.1) & (np.abs(x - B) > 0.1) & (x < 3)
    # The layer rounds the roots; b/l = 1/20 leaves two thousandths.
    np.testing.assert_allclose(p[smooth], EXACT.pressure(x[smooth]), rtol=0.02, atol=0.01 * LOAD)
