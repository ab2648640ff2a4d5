"""The how-to pages: each is a short script that runs as it stands and ends by asserting its physics."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest
from test_demos import is_picture, prose

PAGES = sorted((Path(__file__).parents[1] / "docs" / "howto").glob("*.py"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_it_runs(page, tmp_path, monkeypatch):
    """In an empty folder, with the pictures that it names; its own assertions hold."""
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(page))
    pictures = re.findall(r'"(\w+\.png)"', page.read_text())
    assert all(is_picture(tmp_path / name) for name in pictures)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_it_is_short(page):
    """At most forty lines of code, prose and a formula or an assertion of what must hold."""
    code = [line for line in page.read_text().splitlines() if line.strip() and not line.lstrip().startswith("#")]
    assert len(code) <= 40
    assert len(prose(page)) >= 8
    assert any(re.match(r" *assert ", line) for line in code)
