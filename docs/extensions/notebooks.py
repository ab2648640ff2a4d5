"""Pages that ran when they were made, as notebooks with their output, and a link to each at its page's end."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import nbformat

LINK = '<p>This page as a <a class="download" href="{0}" download>notebook</a>, with its output.</p>'


def offer(app: Any, page: str, template: str, context: dict[str, Any], tree: Any) -> None:
    """Copy the notebook of a page to it."""
    made = Path(app.env.mystnb_config.output_folder, f"{page}.ipynb")
    if tree is None or not made.exists():
        return
    notebook = nbformat.read(made, as_version=4)
    if any(cell.get("outputs") for cell in notebook.cells):
        there = Path(app.outdir, f"{page}.ipynb")
        there.parent.mkdir(parents=True, exist_ok=True)
        nbformat.write(notebook, there)
        context["body"] += LINK.format(there.name)


def setup(app: Any) -> dict[str, bool]:
    """Offer notebooks while pages are written."""
    app.connect("html-page-context", offer)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
