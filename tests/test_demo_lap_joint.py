"""The demo of a glued lap joint: it runs as a script, and its numbers are checked."""

from __future__ import annotations

import pytest
from test_demos import is_picture, run


def test_lap_joint(tmp_path):
    """Shear lag with the plates' own shear; Poisson's effect and the ends leave a percent on these plates."""
    summary = run("lap_joint", tmp_path)
    guided, free = summary["cases"]["guided"], summary["cases"]["free"]
    assert guided["force"] == pytest.approx(1.0, rel=1e-8)
    assert guided["peak"] == pytest.approx(guided["with the plates' shear"]["peak"], rel=0.015)
    assert guided["with the plates' shear"]["error"] < 0.015
    assert free["peak"] < guided["peak"]
    assert not summary["held without shear"]
    assert all(is_picture(tmp_path / name) for name in ("shear.png", "bodies.png"))
