"""The how-to pages: each is a short script that runs as it stands and ends by asserting its physics."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest
from test_demos import is_picture, prose

PAGES = sorted((Path(__file__).parents[1] / "docs" / "howto").glob("*.py"))
PICTURES = {
    "error_and_adaptivity": ["adapted.png"],
    "flange_gasket": ["gasket.png", "flange.png"],
    "imported_mesh": ["clamp.png", "pad.png"],
    "joint_stiffness": ["stiffness.png"],
    "load_cycle": ["steps.png", "multiples.png"],
    "press_fit": ["rings.png"],
    "punch_on_coating": ["punch.png"],
    "sphere_on_plate": ["sphere.png"],
}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_it_runs(page, tmp_path, monkeypatch):
    """In an empty folder, with the pictures that it says it draws; its own assertions hold."""
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(page))
    assert all(is_picture(tmp_path / name) for name in PICTURES[page.stem])


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_it_is_short(page):
    """At most forty lines of code, prose and a formula or an assertion of what must hold."""
    code = [line for line in page.read_text().splitlines() if line.strip() and not line.lstrip().startswith("#")]
    assert len(code) <= 40
    assert len(prose(page)) >= 8
    assert any(re.match(r" *assert ", line) for line in code)
