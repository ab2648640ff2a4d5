"""Theory against practice: the linear layer, closed everywhere, contracts as the iteration's matrix says."""

from __future__ import annotations

import limits
import pytest


@pytest.mark.parametrize("gamma", [0.3, 0.6, 0.9])
@pytest.mark.parametrize(("bodies", "stiffness"), [(2, 1e5), (3, 1e4), (3, 1e5), (3, 1e6)])
def test_contraction_is_the_spectral_radius(bodies, stiffness, gamma):
    scene = limits.linear_scene(bodies, stiffness)
    predicted = limits.predicted_contraction(scene, gamma)
    assert predicted < 1
    # Three digits: the slowest mode has outrun the others by then, and the residual is a hundred times above rounding.
    assert limits.measured_contraction(scene, "chord", gamma) == pytest.approx(predicted, rel=5e-4)


@pytest.mark.parametrize("method", ["one-point", "kurchatov", "robin"])
def test_all_coefficients_are_the_layer_stiffness(method):
    """For a linear law every divided difference is its stiffness: the methods are one."""
    scene = limits.linear_scene(3, 1e5)
    measured = [limits.measured_contraction(scene, name, 0.6) for name in ("chord", method)]
    assert measured[0] == pytest.approx(measured[1], rel=1e-6)  # rounding of residuals of 1e-12


def test_divergence_is_predicted_too():
    """Where the spectral radius is above one the method must not arrive; below it must."""
    scene = limits.linear_scene(3, 1e6)
    assert limits.predicted_contraction(scene, 1.05) < 0.95
    assert limits.iterations(scene, "chord", 1.05) != limits.DIVERGED
    assert limits.predicted_contraction(scene, 1.2) > 1.05
    assert limits.iterations(scene, "chord", 1.2) == limits.DIVERGED
