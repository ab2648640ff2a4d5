"""The speed and the scaling demo in their quick forms: their numbers make sense. How fast they are is not asserted."""

from __future__ import annotations

import numpy as np
import pytest
from test_demos import is_picture, run

FIELDS = {"solver", "element", "mesh", "unknowns", "cpu_seconds", "peak_mb", "error_l2"}


@pytest.mark.long
def test_speed_vs_error(tmp_path):
    rows = run("studies/speed_vs_error", tmp_path, "--quick")
    assert all(set(row) >= FIELDS and row["cpu_seconds"] > 0 and row["unknowns"] > 0 for row in rows)
    assert is_picture(tmp_path / "speed_vs_error.png")
    ours = [row for row in rows if row["solver"].startswith("contactdd")]
    ways = {f"{method}, {local}" for method in ("coupled", "decomposed") for local in ("condensed", "assembled")}
    ways |= {"coupled, condensed, nothing shared", "coupled, multigrid"}
    assert {row["solver"] for row in ours} == {f"contactdd, {way}" for way in ways}
    # Everybody solves the same problem: on the same mesh all have about the same error.
    for element, expected in (("P1", 1.22e-2), ("Q4", 1.1e-3)):
        errors = [row["error_l2"] for row in rows if row["element"] == element]
        assert len(errors) >= 4
        assert errors == pytest.approx([expected] * len(errors), rel=0.25)


@pytest.mark.long
def test_scaling(tmp_path):
    summary = run("studies/scaling", tmp_path, "--quick")
    rows = summary["measurements"]
    assert is_picture(tmp_path / "scaling.png")
    assert {row["kind"] for row in rows} == {"plane", "space", "bodies"}
    # The pressure carries the load, 10 on an edge of 4 or on an area of 4.
    assert [row["force"] for row in rows] == pytest.approx([40.0] * len(rows), rel=1e-6)
    assert max(row["iterations"] for row in rows) <= 8
    assert max(row["body_solves"] for row in rows) <= 60
    assert all(np.isfinite(list(powers.values())).all() for powers in summary["exponents"].values())
    assert summary["estimate"]["cores"] > 1
    assert summary["estimate"]["seconds"] > 0
