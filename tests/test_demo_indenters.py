"""The demo of rigid indenters: it runs as a script, and its numbers are checked."""

from __future__ import annotations

import pytest
from test_demos import is_picture, run


def test_indenters(tmp_path):
    """Hertz, Sneddon and Boussinesq on elements, on rings and on a grid."""
    summary = run("indenters", tmp_path)
    assert len(summary["cases"]) == 9
    for case, row in summary["cases"].items():
        assert row["force"] == pytest.approx(1.0, rel=1e-7)
        if "elements" not in case:  # a finite block is stiffer than the half-space
            assert row["depth"] == pytest.approx(1.0, rel=0.02 if "grid" in case else 0.01)
    # F ~ δ^(3/2), δ², δ.
    assert summary["exponents"] == pytest.approx({"sphere": 1.5, "cone": 2.0, "punch": 1.0}, rel=5e-3)
    assert is_picture(tmp_path / "pressures.png")


def test_rough_surface(tmp_path):
    """Under a small force the area is proportional to it, and a layer that yields makes it larger."""
    rows = run("studies/rough_surface", tmp_path, "--quick")
    assert len(rows) == 16
    assert is_picture(tmp_path / "pressure.png")
    areas = {(row["layer"], row["force"]): row["area"] for row in rows if row["points"] == 64}
    stiff = [areas["stiff layer", force] for force in (0.5, 1.5, 5.0, 15.0)]
    soft = [areas["power layer, a = 1.1", force] for force in (0.5, 1.5, 5.0, 15.0)]
    assert all(more > less for more, less in zip(soft, stiff, strict=True))
    assert stiff[2] / stiff[1] == pytest.approx(5.0 / 1.5, rel=0.2)
