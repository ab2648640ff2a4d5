"""The demos of scenes: each runs as a script, and its numbers are checked."""

from __future__ import annotations

import numpy as np
import pytest
from test_demos import is_picture, run


def test_cylinder(tmp_path):
    """NAFEMS asks for 6.21 mm and 3585 MPa; Hertz' half-planes are an approximation to one or two percent."""
    summary = run("cylinder", tmp_path)
    assert summary["half_width"] == pytest.approx(6.21, rel=0.02)
    assert summary["peak_pressure"] == pytest.approx(3585, rel=0.02)
    assert summary["fitted_half_width"] == pytest.approx(6.21, rel=0.02)
    assert summary["fitted_peak_pressure"] == pytest.approx(3585, rel=0.02)
    assert summary["imbalance"] < 1e-9
    # The pressures follow the turned normals: their sum is a little more than the load on this half.
    assert summary["force"] == pytest.approx(35e3 / 2, rel=2e-3)
    assert all(is_picture(tmp_path / name) for name in ("contact.png", "bodies.png"))


def test_three_bodies(tmp_path):
    summary = run("three_bodies", tmp_path)
    for contact in ("left–right", "wedge–left", "wedge–right"):
        # Statics holds to the iteration's residual, 1e-10.
        assert summary[contact]["force"] == pytest.approx(summary[contact]["statics"], rel=1e-8)
    assert summary["imbalance"] < 1e-8
    assert all(is_picture(tmp_path / f"{name}.png") for name in ("contact1", "contact2", "contact3", "bodies"))


def test_stack(tmp_path):
    summary = run("stack", tmp_path)
    assert len(summary["contacts"]) == 7
    for contact in summary["contacts"]:
        assert contact["force"] == pytest.approx(40.0, rel=1e-8)  # the load on 4 cm, to the iteration's residual
        assert 0.3 < contact["open"] < 1.4  # every groove is partly closed
        assert contact["peak_pressure"] > 15.0
    assert summary["imbalance"] < 1e-8
    assert all(is_picture(tmp_path / name) for name in ("contacts.png", "bodies.png"))


def test_grooved_block_3d(tmp_path):
    summary = run("grooved_block_3d", tmp_path)
    held, free = summary["held"], summary["free"]
    assert held["force"] == pytest.approx(40.0, rel=1e-7)
    # Gauss points of segments find an edge to about a third of a facet of 0.25 / 3 and the spline in the groove.
    assert [held["open_front"], held["open_back"]] == pytest.approx([summary["reference_edge"]] * 2, abs=0.02)
    assert held["peak_pressure"] == pytest.approx(summary["reference_peak"], rel=0.01)
    assert summary["error_l2"] < 0.015  # 0.007 when written
    assert free["open_back"] < held["open_back"] - 0.02
    assert np.isclose(free["open_front"], held["open_front"], atol=0.02)
    assert max(held["imbalance"], free["imbalance"]) < 1e-8
    assert all(is_picture(tmp_path / name) for name in ("contact.png", "bodies.png"))
