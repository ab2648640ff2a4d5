"""The demo of a machine joint: it runs as a script, and its numbers are checked."""

from __future__ import annotations

import pytest
from test_demos import is_picture, run


def test_machine_joint(tmp_path):
    """K ~ p^(1 − m), and the constants' own value: the tangent is exact, so only the solves' residual is left."""
    summary = run("machine_joint", tmp_path)
    for name, m in (("ground", 0.5), ("scraped", 0.5), ("milled", 0.45)):
        assert summary[name]["exponent"] == pytest.approx(1 - m, abs=1e-6)
        assert summary[name]["error"] < 1e-6
        assert max(summary[name]["part"]) < 1.0
    assert is_picture(tmp_path / "stiffness.png")
