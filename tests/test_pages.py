"""The pages name what there is: no name that is gone, and none of a scene's ingredients left out."""

from __future__ import annotations

import functools
import inspect
import re
from pathlib import Path

import pytest

import contactdd as cd
from contactdd.load import BodyLoad

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
SCENE = (ROOT / "docs" / "scene.md").read_text()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_name_exists(page):
    """`cd.name` and `cd.Class.name`, wherever a page has one."""
    for dotted in set(re.findall(r"\bcd((?:\.[A-Za-z]\w*)+)", page.read_text())):
        functools.reduce(getattr, dotted[1:].split("."), cd)


def ingredients():
    """The loads, supports, materials and readers that are public."""
    for name in cd.__all__:
        noun = getattr(cd, name)
        given = inspect.isclass(noun) and not inspect.isabstract(noun)
        if name.startswith("read_") or (given and issubclass(noun, BodyLoad | cd.Material)):
            yield name
    yield from ("Fixed", "Symmetry", "Displacement", "PointDisplacement", "Spring")
    yield from ("Pressure", "Traction", "Resultant", "BodyForce", "BondedLayer", "GasketLayer", "HardContact")


@pytest.mark.parametrize("name", sorted(set(ingredients())))
def test_every_ingredient_is_on_the_page_of_scenes(name):
    assert f"cd.{name}" in SCENE
