"""The demo of all layer laws: its columns agree with their closed form, and it draws every law."""

from __future__ import annotations

from test_demos import is_picture, run


def test_layers(tmp_path):
    summary = run("layers", tmp_path)
    assert len(summary) == 12
    # The tolerance of the solve, 1e-12 of the forces, over the softest law's share of the column.
    assert max(law["error"] for law in summary.values()) < 1e-9
    assert is_picture(tmp_path / "layers.png")
