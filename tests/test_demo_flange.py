"""The demo of a bolted flange with a gasket: it runs as a script, and its numbers are checked."""

from __future__ import annotations

import math

import pytest
from test_demos import is_picture, run


def test_flange(tmp_path):
    """Statics, a loop whose area is what is dissipated, and a set that stays when the bolts are loosened."""
    summary = run("flange", tmp_path)
    stages = summary["stages"]
    assert stages["bolted"]["force"] == pytest.approx(180e3, rel=1e-7)
    assert stages["under pressure"]["force"] == pytest.approx(180e3 - 5 * math.pi * 60**2, rel=1e-7)
    assert stages["under pressure"]["open"] < 1e-9
    assert stages["loosened"]["open"] > 0.5
    assert summary["work"] == pytest.approx(summary["dissipated"] + summary["stored"], rel=0.01)  # 24 trapezia
    assert all(is_picture(tmp_path / name) for name in ("gasket.png", "flange.png"))
