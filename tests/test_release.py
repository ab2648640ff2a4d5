"""A version is one number with one date, wherever it is written; what is installed tells its types."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

import contactdd as cd

ROOT = Path(__file__).parents[1]


def releases() -> list[tuple[str, str]]:
    """Versions and dates in the changelog, the newest first."""
    text = (ROOT / "CHANGELOG.md").read_text()
    headings = re.findall(r"^## (.*)$", text, flags=re.MULTILINE)
    assert all(re.fullmatch(r"\d+\.\d+\.\d+ – \d{4}-\d\d-\d\d|Unreleased", heading) for heading in headings)
    return [tuple(heading.split(" – ")) for heading in headings if heading != "Unreleased"]


def test_the_changelog_knows_the_version():
    versions = releases()
    assert versions[0][0] == cd.__version__
    assert [date for _, date in versions] == sorted((date for _, date in versions), reverse=True)


def test_the_citation_is_of_this_version():
    citation = (ROOT / "CITATION.cff").read_text()
    version, date = releases()[0]
    assert f"\nversion: {version}\n" in citation
    assert f"\ndate-released: {date}\n" in citation


@pytest.mark.skipif(sys.version_info < (3, 11), reason="tomllib is new in Python 3.11")
def test_types_are_installed():
    import tomllib

    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]
    assert "py.typed" in settings["setuptools"]["package-data"]["contactdd"]
    assert (ROOT / "contactdd" / "py.typed").exists()
    assert settings["coverage"]["report"]["fail_under"] >= 95
    assert "--doctest-modules" in settings["pytest"]["ini_options"]["addopts"]


def test_paths_in_the_texts_exist():
    """Every file that README, CONTRIBUTING or a demo's text names by its path is there."""
    for text in (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "demos").glob("*.py")):
        named = re.findall(r"(?<![\w/])(?:demos|tests|contactdd|meshes)/[\w./-]*\w", text.read_text())
        missing = [path for path in named if not (ROOT / path).exists() and "NAME" not in path and "/out" not in path]
        assert not missing, f"{text.name} names {missing}"
