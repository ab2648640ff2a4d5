"""The page for those who come from FEniCSx: it runs as a script, on one rank and on two, with the same numbers."""

from __future__ import annotations

import json

import pytest
import test_demos
from test_demos import ROOT, is_picture, run
from test_ranks import launch


def test_own_fenicsx(tmp_path):
    summary = run("own_fenicsx", tmp_path / "one")
    # 40 q and the foot's weight, to the solve's residual.
    assert summary["forces"] == pytest.approx([40 * q + 7.7e-5 * 1200 for q in (0.5, 1.5)], rel=1e-8)
    assert summary["from_nodes"] == pytest.approx(summary["forces"][1], rel=1e-8)
    for name in ("bodies.png", "pressures.png"):
        assert is_picture(tmp_path / "one" / name)
    for name in ("paraview/pad.vtu", "paraview/contacts.xdmf", "own_field.xdmf"):
        assert (tmp_path / "one" / name).stat().st_size > 100
    script, out = ROOT / "demos" / "own_fenicsx.py", tmp_path / "two"
    code = f"import runpy, sys\nsys.argv = ['own', '--out', {str(out)!r}]\nsys.path.insert(0, {str(script.parent)!r})\n"
    done = launch(2, code + f"runpy.run_path({str(script)!r}, run_name='__main__')")
    assert done.returncode == 0, done.stderr
    two = json.loads((out / "summary.json").read_text())
    assert two["forces"] == pytest.approx(summary["forces"], rel=1e-9)
    assert two["peaks"] == pytest.approx(summary["peaks"], rel=1e-7)  # residuals of 1e-10


@pytest.mark.parametrize("demo", ["own_fenicsx", "own_method"])
def test_they_teach(demo):
    test_demos.test_demos_teach(demo)
