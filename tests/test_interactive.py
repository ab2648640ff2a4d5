"""Pictures of solids turn under the mouse in a notebook where trame is, and are still ones elsewhere."""

from __future__ import annotations

from importlib.util import find_spec

import pytest
import test_numbers_out
import test_pictures

import contactdd as cd
from contactdd.view import interactive

pytest.importorskip("pyvista")


def test_without_trame_pictures_stand_still(monkeypatch):
    monkeypatch.setattr(interactive, "find_spec", lambda name: None)
    picture = test_pictures.solid().plot_bodies(size=(300, 200))
    assert picture._repr_html_() is None
    assert picture._repr_png_().startswith(b"\x89PNG")


def test_a_vtk_that_cannot_is_no_error(monkeypatch):
    """Debian's has no web modules, which trame finds out when it is asked."""

    class Plotter:
        def __getattr__(self, name):
            raise AttributeError(name)

    monkeypatch.setattr(interactive, "find_spec", lambda name: True)
    assert interactive.turnable(Plotter, (300, 200)) is None


def test_plane_bodies_stand_still():
    assert cd.solve(test_numbers_out.blocks()).plot_bodies(size=(300, 200))._repr_html_() is None


@pytest.mark.skipif(find_spec("trame_vtk") is None, reason="trame is not installed")
def test_with_trame_they_turn():
    """A frame that asks the network for nothing, between the still picture's title and its bar."""
    html = test_pictures.solid().plot_bodies(size=(300, 200))._repr_html_()
    if html is None:
        pytest.skip("this VTK has no web modules")
    assert html.count("<img src=") == 2
    assert html.count("<iframe srcdoc=") == 1
    assert "src=&quot;http" not in html
