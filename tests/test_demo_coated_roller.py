"""The demo of a coated roller: it runs as a script, and its numbers are checked."""

from __future__ import annotations

import pytest
from test_demos import is_picture, run


def test_coated_roller(tmp_path):
    """Hertz without the skin; with it the middle stays his, and the edge, within a bending length, carries more."""
    summary = run("coated_roller", tmp_path)
    alone, hard, hertz = (summary[name] for name in ("rubber alone", "hard skin", "hertz"))
    assert alone["peak"] == pytest.approx(hertz["peak"], rel=0.02)  # nip over thickness of the rubber: 1/6, squared
    assert alone["half_width"] == pytest.approx(hertz["half_width"], rel=0.03)
    assert hard["middle"] == pytest.approx(alone["middle"], rel=0.01)
    assert hard["peak"] > 1.5 * hard["middle"]
    assert hard["half_width"] - hard["bending"] < hard["peak_at"]
    assert is_picture(tmp_path / "nip.png")
