"""The demos as pages: copies of them beside the site's other sources, each with its pictures at its end."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import jupytext

ROOT = Path(__file__).parents[2]
DEMOS, PAGES = ROOT / "demos", ROOT / "docs" / "demos"


def pictures(demo: str) -> list[str]:
    """The names of the committed pictures of a demo."""
    return sorted(path.name for path in (DEMOS / "pictures").glob(f"{demo}_*.png"))


def page(script: Path) -> str:
    """A demo's text with its pictures in a last cell, and how it is run."""
    lines = [f"Run it: `./run demos/{script.name}`."]
    for name in pictures(script.stem):
        lines += ["", f"![](pictures/{name})"]
    return script.read_text() + "\n# %% [markdown]\n" + "\n".join(f"# {line}".rstrip() for line in lines) + "\n"


def write(path: Path, text: str) -> None:
    """Write a file unless it holds that text already: a page that does not change is not read anew."""
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def notebook(text: str) -> Any:
    """A script in the percent format as a notebook."""
    made = jupytext.reads(text, fmt="py:percent")
    made.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    made.metadata["language_info"] = {"name": "python", "pygments_lexer": "ipython3"}
    return made


def copy(_: Any) -> None:
    """Bring the demos, the notebook and the pictures into the site's sources, where Sphinx takes ../demos to be."""
    (PAGES / "pictures").mkdir(parents=True, exist_ok=True)
    for picture in (DEMOS / "pictures").glob("*.png"):
        shutil.copy2(picture, PAGES / "pictures" / picture.name)
    for script in DEMOS.glob("*.py"):
        write(PAGES / script.name, page(script))
    write(PAGES / "notebook.ipynb", (DEMOS / "groove.ipynb").read_text())


def setup(app: Any) -> dict[str, bool]:
    """Copy before Sphinx looks for its sources."""
    app.connect("builder-inited", copy)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
