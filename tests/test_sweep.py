"""Sweeps reuse what does not change: γ, the load, the layer."""

from __future__ import annotations

import numpy as np
import pytest
import scenes

import contactdd as cd
from contactdd.local import assembled, condensation, factor


@pytest.fixture
def factorisations(monkeypatch):
    """How many factorisations have been made."""
    made = []

    class Counted(factor.Factor):
        def __init__(self, *arguments, **options):
            made.append(1)
            super().__init__(*arguments, **options)

    for module in (condensation, assembled):
        monkeypatch.setattr(module, "Factor", Counted)
    return made


def test_layers_share_the_bodies(factorisations):
    scene = scenes.paper()
    cd.solve(scene)
    before = len(factorisations)
    assert before > 0
    for B, a in ((4e-6, 1.1), (8e-6, 1.1), (4e-6, 2.0)):
        layer = cd.PowerLayer(B, a)
        swept = cd.solve(scene.with_layer(layer)).contact()
        assert len(factorisations) == before
        fresh = scenes.paper()
        alone = cd.Contact(*fresh.contacts[0].sides, layer, gap=scenes.groove)
        expected = cd.solve(cd.Scene(fresh.bodies, [alone])).contact()
        # Two eliminations of the same matrices, both solved to 1e-10.
        np.testing.assert_allclose(swept.pressure, expected.pressure, atol=1e-8 * expected.pressure.max())
        before = len(factorisations)
    # The scene itself is as it was.
    assert scene.contacts[0].layer == scenes.LAYER


def test_gamma_and_methods_share_the_bodies(factorisations):
    scene = scenes.paper("vertex")
    cd.solve(scene)
    before = len(factorisations)
    for method, gamma in (("chord", 0.5), ("chord", 0.7), ("kurchatov", 0.6), ("newton", "search")):
        cd.solve(scene, method, gamma=gamma)
    assert len(factorisations) == before


def test_bad_layers_are_refused():
    scene = scenes.paper()
    with pytest.raises(TypeError, match="layer = 5"):
        scene.with_layer(5)
    with pytest.raises(ValueError, match="contact = 'nowhere'"):
        scene.with_layer(scenes.LAYER, "nowhere")
