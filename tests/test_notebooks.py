"""Own methods, a joint with a gasket, error and adaptivity: pages that are notebooks, run cell by cell in a kernel."""

from __future__ import annotations

import os
import re

import nbclient
import nbformat
import pytest
from test_demos import ROOT, code_cells, is_picture
from test_site import site  # noqa: F401


@pytest.mark.parametrize(
    ("page", "told"),
    [("own_method", None), ("flange_gasket", "MPa"), ("error_and_adaptivity", "Adaptation: reached")],
)
def test_a_page_is_a_notebook(page, told, tmp_path, monkeypatch):
    """Its pictures are shown and saved, its numbers printed, its assertions hold, and no progress bar is left over."""
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]))
    cells = [nbformat.v4.new_code_cell(cell) for cell in code_cells(ROOT / "docs" / "howto" / f"{page}.py")]
    content = nbformat.v4.new_notebook(cells=cells)
    options = {"resources": {"metadata": {"path": str(tmp_path)}}, "kernel_name": "python3"}
    nbclient.NotebookClient(content, timeout=120, **options).execute()
    outputs = [output for cell in content.cells for output in cell.outputs]
    shown = [output["data"] for output in outputs if "data" in output]
    assert any("image/png" in data for data in shown)
    assert not any("widget" in kind for data in shown for kind in data)
    assert all(is_picture(picture) for picture in tmp_path.glob("*.png"))
    assert told is None or any(told in output.get("text", "") for output in outputs)


@pytest.mark.long
def test_every_page_of_the_site_shows_the_pictures_that_it_saves(site):  # noqa: F811
    for page in (ROOT / "docs" / "howto").glob("*.py"):
        made = nbformat.read(site / "howto" / f"{page.stem}.ipynb", as_version=4)
        kinds = [kind for cell in made.cells for output in cell.get("outputs", []) for kind in output.get("data", {})]
        assert kinds.count("image/png") >= len(re.findall(r'"\w+\.png"', page.read_text())), page.stem
        assert f'href="{page.stem}.ipynb"' in (site / "howto" / f"{page.stem}.html").read_text()
