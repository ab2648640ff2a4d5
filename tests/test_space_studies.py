"""The studies of many bodies, of speed in space and of the costs of local solvers, in their quick forms."""

from __future__ import annotations

import pytest
from test_demos import is_picture, run


@pytest.mark.long
def test_many_bodies(tmp_path):
    rows = run("studies/many_bodies", tmp_path, "--quick")["measurements"]
    assert is_picture(tmp_path / "many_bodies.png")
    assert {row["kind"] for row in rows} == {"stack", "wall", "pile", "unlike wall"}
    assert max(row["iterations"] for row in rows) <= 8
    assert all(row["energy"] < 0.0 < row["cpu_seconds"] for row in rows)


@pytest.mark.long
def test_speed_in_space(tmp_path):
    rows = run("studies/speed_in_space", tmp_path, "--quick")["measurements"]
    assert is_picture(tmp_path / "speed_in_space.png")
    # All solve the same problem: on the same cells all have about the same error.
    for cells, expected in (("Q:1:8:4:1", 1.15e-2), ("Q:2:4:2:1.7", 8e-3)):
        errors = [row["error"] for row in rows if row["cells"] == cells]
        assert len(errors) >= 3
        assert errors == pytest.approx([expected] * len(errors), rel=0.15)


@pytest.mark.long
def test_cost_of_solvers(tmp_path):
    summary = run("studies/cost_of_solvers", tmp_path, "--quick")
    assert is_picture(tmp_path / "cost_of_solvers.png")
    # So small bodies cost what all do; what the model is given is counted by hand: nodes, cells' unknowns, touched.
    first = summary["measurements"][0]
    assert (first["unknowns"], first["touched"]) == (3 * 7 * 7 * 4, 7 * 7)
    assert first["cubes"] == pytest.approx(6 * 6 * 3 * 24**3 / first["unknowns"])
    assert all(row["loss"] >= 0.0 for row in summary["choices"])
