"""The study of what ingredients cost: it runs, and what a scene does not use is not there."""

from __future__ import annotations

import pytest
from test_demos import run


@pytest.mark.long
def test_ingredients(tmp_path):
    """Two forms for each scene, imports of the ingredient's own, and a pressure as accurate as asked for."""
    summary = run("studies/ingredients", tmp_path, "--quick")
    scenes = summary["scenes"]
    assert all(row["forms"] == 2 for row in scenes.values())
    assert not [module for module in scenes["two bodies"]["modules"] if ".layers" in module or ".partners" in module]
    assert "contactdd.partners.half_plane" in scenes["on the half-plane"]["own"]
    assert "contactdd.interface.sliding" in scenes["two bodies, bonded with shear"]["own"]
    ground = summary["ground"]
    assert max(ground[name]["error"] for name in ground) <= 0.05
