"""The law of a discretised contact: what a hard contact's or a varying layer is at the contact's points."""

from __future__ import annotations

import numpy as np
import pytest
import scenes

import contactdd as cd

E = (2e3, 5e3)
HEIGHTS = (1.0, 2.0)


def pressed_columns(layer, gap=0.0, approach=1e-3, scale=1.0):
    """Two columns without lateral strain, the upper one's top moved down by `approach`; E times `scale`."""
    lower, upper = (cd.Isotropic(E=scale * modulus, nu=0.0) for modulus in E)
    bodies = [
        scenes.block("lower", 0, (4, 2), lower, length=2.0, height=HEIGHTS[0], supports=[cd.Symmetry("bottom")]),
        scenes.block(
            "upper", HEIGHTS[0], (5, 3), upper, length=2.0, height=HEIGHTS[1],
            supports=[cd.Displacement("top", (None, -approach))],
        ),
    ]  # fmt: skip
    return scenes.stack(bodies, layer, gap, quadrature="mortar")


@pytest.mark.parametrize("gap", [0.0, 4e-4, 2e-3])
def test_hard_contact_follows_a_gap_that_changes(gap):
    """p = [Δ − d]⁺ / (H₁/E₁ + H₂/E₂), whichever gap the scene was made with."""
    given = cd.Parameter(7e-4)
    scene = pressed_columns(cd.HardContact(), given)
    cd.solve(scene)
    given.value = gap
    pressure = max(1e-3 - gap, 0.0) / sum(height / modulus for height, modulus in zip(HEIGHTS, E, strict=True))
    # The multipliers are settled to a millionth.
    np.testing.assert_allclose(cd.solve(scene).contact().pressure, pressure, rtol=1e-5, atol=1e-12)


@pytest.mark.parametrize(
    "layer", [cd.LinearLayer(4e3), cd.VaryingLayer(cd.LinearLayer, stiffness=lambda x: 4e3 + 0 * x[0])]
)
def test_layer_in_place_of_a_hard_contact_and_back(layer):
    """A layer adds its own compression 1/k to what the columns give way: p = Δ / (H₁/E₁ + H₂/E₂ + 1/k)."""
    columns = sum(height / modulus for height, modulus in zip(HEIGHTS, E, strict=True))
    hard = pressed_columns(cd.HardContact())
    layered = hard.with_layer(layer)
    np.testing.assert_allclose(cd.solve(layered).contact().pressure, 1e-3 / (columns + 1 / 4e3), rtol=1e-9)
    again = layered.with_layer(cd.HardContact())
    np.testing.assert_allclose(cd.solve(again).contact().pressure, 1e-3 / columns, rtol=1e-5)
    assert [scene.interfaces[0].hard for scene in (hard, layered, again)] == [True, False, True]


def test_penalty_is_a_stiffness():
    """k of the augmented Lagrangian goes with the softer facets' E/h; less in decomposed methods, unless given."""
    softest = E[0] / 0.5  # facets 0.5 long, the upper ones' are E₂/0.4
    for penalty, softer in ((None, 0.3 / 30.0), (7.0, 1.0)):
        here, stiff = (pressed_columns(cd.HardContact(penalty), scale=scale).interfaces[0] for scale in (1.0, 1e3))
        assert stiff.layer.stiffness == pytest.approx(1e3 * here.layer.stiffness, rel=1e-12)
        assert here.layer.stiffness == pytest.approx((penalty or 30.0) * softest, rel=1e-9)
        assert here.decomposed().layer.stiffness == pytest.approx(softer * here.layer.stiffness, rel=1e-12)
        np.testing.assert_array_equal(here.decomposed().gap, here.gap)


def test_varying_law_is_evaluated_at_the_points():
    """Bodies that hardly give way: p = k(x) Δ at every node, with the k that it has there."""
    law = cd.VaryingLayer(cd.LinearLayer, stiffness=lambda x: 10.0 * (1 + x[0]))
    scene = pressed_columns(law, scale=1e9)
    result = cd.solve(scene).contact()
    stiffness = 10.0 * (1 + result.x[:, 0])
    np.testing.assert_allclose(scene.interfaces[0].layer.contact_derivative(np.full(len(result.x), -1.0)), stiffness)
    np.testing.assert_allclose(result.pressure, 1e-3 * stiffness, rtol=1e-7)  # k over the columns' stiffness, 1e12
