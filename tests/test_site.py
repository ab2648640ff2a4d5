"""The documentation's site: built with warnings as errors, complete, and read in a real browser without a network."""

from __future__ import annotations

import re
import subprocess
import zlib
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest

import contactdd as cd

ROOT = Path(__file__).parents[1]
pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def site() -> Path:
    """The site, built anew where a page has changed."""
    done = subprocess.run([ROOT / "docs" / "build"], capture_output=True, text=True)
    if done.returncode != 0 and "this Python is of a virtual environment" in done.stderr:
        pytest.skip(done.stderr)
    assert done.returncode == 0, done.stdout + done.stderr
    return Path(done.stdout.splitlines()[-1]).parent


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """A headless Chromium; the tests that need one are skipped only where none can be had."""
    driver = pytest.importorskip("playwright.sync_api", reason="playwright, which drives the browser, is not installed")
    found = subprocess.run([ROOT / ".ci" / "browser"], capture_output=True, text=True)
    if found.returncode != 0:
        pytest.skip(f"no browser can be had: {found.stderr.strip()}")
    with driver.sync_playwright() as player:
        opened = player.chromium.launch(executable_path=found.stdout.strip())
        yield opened
        opened.close()


class Page(HTMLParser):
    """What a page links to, what it loads, and the places in it that can be linked to."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: set[str] = set()
        self.loads: set[str] = set()
        self.places: set[str] = set()
        self.feed(path.read_text())

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        given = dict(attributes)
        self.places |= {given[name] or "" for name in ("id", "name") if name in given}
        if tag == "a" and given.get("href"):
            self.links.add(given["href"] or "")
        elif tag in ("img", "script", "source") and given.get("src"):
            self.loads.add(given["src"] or "")
        elif tag == "link" and given.get("rel") != "canonical":
            self.loads.add(given["href"] or "")


@pytest.fixture(scope="module")
def pages(site: Path) -> dict[Path, Page]:
    return {path: Page(path) for path in site.rglob("*.html")}


def test_every_page_is_there(site, pages):
    names = {str(path.relative_to(site)) for path in pages}
    howto = {f"howto/{path.stem}.html" for path in (ROOT / "docs" / "howto").glob("*.py")}
    demos = {f"demos/{path.stem}.html" for path in (ROOT / "demos").glob("*.py")}
    written = {f"{path.stem}.html" for path in (ROOT / "docs").glob("*.md")}
    assert len(howto) >= 7
    assert howto | demos | written | {"first_scene.html", "search.html", "reference/index.html"} <= names


def test_every_public_name_is_in_the_reference(site):
    inventory = zlib.decompress((site / "objects.inv").read_bytes().split(b"\n", 4)[4]).decode()
    described = {line.split()[0] for line in inventory.splitlines()}
    public = {f"contactdd.{name}" for name in cd.__all__} | {f"contactdd.reference.{n}" for n in cd.reference.__all__}
    assert not public - described


def test_nothing_comes_from_elsewhere(pages):
    """Scripts, styles, pictures and fonts are the site's own."""
    assert not {load for page in pages.values() for load in page.loads if urlsplit(load).netloc}


def test_no_link_is_broken(pages):
    """Every link within the site leads to a file, and to a place in it that exists."""
    broken = set()
    for path, page in pages.items():
        for link in page.links | page.loads:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            there = pages[target].places if target in pages else None
            if not target.exists() or (parts.fragment and there is not None and unquote(parts.fragment) not in there):
                broken.add((path.name, link))
    assert not broken


def test_the_pages_in_a_browser(site, pages, browser):
    """Every page is drawn without an error, its pictures and formulas show, and it asks the network for nothing."""
    page = browser.new_page()
    wrong: list[str] = []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("requestfailed", lambda request: wrong.append(request.url))
    page.on("request", lambda request: request.url.startswith(("file:", "data:")) or wrong.append(request.url))
    pictures = formulas = 0
    for path in pages:
        if "_modules" in path.parts:
            continue
        page.goto(path.as_uri())
        page.evaluate("document.querySelectorAll('img').forEach(each => each.loading = 'eager')")
        page.wait_for_function("[...document.images].every(each => each.complete)")
        wrong += page.evaluate("[...document.images].filter(each => !each.naturalWidth).map(each => each.src)")
        pictures += page.evaluate("document.images.length")
        formulas += page.evaluate("[...document.querySelectorAll('math')].filter(m => m.clientWidth > 0).length")
    assert not wrong
    assert pictures >= 30
    assert formulas >= 100


@pytest.mark.parametrize(
    ("words", "found"), [("PowerLayer", "reference/layers.html"), ("gasket", "howto/flange_gasket")]
)
def test_the_search_in_a_browser(site, browser, words, found):
    """What is typed into the search field leads to its page, without a server."""
    page = browser.new_page()
    page.goto((site / "index.html").as_uri())
    page.locator("input.sidebar-search").fill(words)
    page.keyboard.press("Enter")
    page.wait_for_selector("#search-results ul.search li a")
    links = page.eval_on_selector_all("#search-results ul.search li a", "all => all.map(each => each.href)")
    assert any(re.search(found, link) for link in links), links
