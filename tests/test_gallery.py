"""The gallery has every demo, with a picture of its own, and the contents of the how-to pages have every page."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TABLE = dict(re.findall(r"\| \[\]\((demos/\w+\.py)\) \| !\[\]\((\S+)\)", (ROOT / "docs" / "gallery.md").read_text()))


@pytest.mark.parametrize("demo", sorted((ROOT / "demos").glob("*.py")), ids=lambda demo: demo.stem)
def test_every_demo_is_in_the_gallery(demo):
    """With a picture that is there and small: a PNG of at most 200 kB."""
    picture = (ROOT / "docs" / TABLE[f"demos/{demo.name}"]).resolve()
    assert picture.name.startswith(demo.stem.removesuffix("_short"))
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert picture.stat().st_size < 200_000


def test_the_gallery_has_no_demo_that_is_gone():
    assert {demo for demo in TABLE if not (ROOT / demo).exists()} == set()


def test_every_how_to_page_is_in_their_contents():
    contents = (ROOT / "docs" / "howto" / "index.md").read_text()
    assert [page.stem for page in (ROOT / "docs" / "howto").glob("*.py") if page.stem not in contents] == []
