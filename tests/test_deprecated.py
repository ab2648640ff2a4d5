"""Names of the version before still work, and say what they are called now."""

from __future__ import annotations

import pytest
from scenes import pressed

import contactdd as cd


def test_a_path_is_a_load_path():
    with pytest.warns(DeprecationWarning, match="LoadPath"):
        assert cd.Path is cd.LoadPath


def test_a_scheme_is_decomposed():
    chord = cd.SCHEMES["chord"]
    with pytest.warns(DeprecationWarning, match="decomposed"):
        assert cd.Scheme("chord", chord.coefficient, "apart", chord.equation).decomposed


def test_subproblems_are_local_problems():
    scene = pressed()
    with pytest.warns(DeprecationWarning, match="local_problems"):
        found = scene.subproblems("condensed")
    assert found == scene.local_problems("condensed")


def test_an_area_without_a_partner():
    result = cd.solve(pressed()).contact()
    with pytest.warns(DeprecationWarning, match="unpaired_area"):
        assert result.unmatched == result.unpaired_area


def test_a_gap_found_from_the_meshes():
    interface = pressed().interfaces[0]
    with pytest.warns(DeprecationWarning, match="geometric_gap"):
        assert interface.measured is interface.geometric_gap
