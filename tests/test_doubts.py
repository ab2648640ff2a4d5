"""A warning of a doubtful result points at the line that asked for it."""

from __future__ import annotations

import warnings

import pytest

import contactdd as cd


def blocks(E: float, layer: cd.Layer, load: float) -> cd.Scene:
    """A block on another, pressed evenly."""
    sides, soft = cd.Symmetry("left", "right"), cd.Isotropic(E, 0.0)
    lower = cd.Body("lower", cd.rectangle((0, 0), (1, 1), (2, 2)), soft, supports=[sides, cd.Symmetry("bottom")])
    mesh = cd.rectangle((0, 1), (1, 2), (2, 2))
    upper = cd.Body("upper", mesh, soft, supports=[sides], loads=[cd.Pressure("top", load)])
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), layer)])


@pytest.mark.parametrize(
    ("scene", "category"),
    [
        (lambda: blocks(10.0, cd.LinearLayer(1e3), 3.0), cd.LargeStrainWarning),  # a strain of 0.3
        (
            lambda: blocks(1e5, cd.TableLayer([0.1, 0.2], [1.0, 2.0]), 3.0),
            cd.LayerRangeWarning,
        ),  # 3 > 2, the last point
    ],
)
def test_the_line_that_asked(scene, category):
    made = scene()
    with pytest.warns(category) as found:
        cd.solve(made)
    assert [warning.filename for warning in found] == [__file__]


def test_a_sound_result_is_silent():
    made = blocks(1e5, cd.LinearLayer(1e3), 3.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert cd.solve(made).converged
