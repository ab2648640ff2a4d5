"""Docstrings in Google style, those of properties as those of methods.

Sphinx' own extension takes what stands before a colon in a property's first line for its type, and leaves its sections.
"""

from __future__ import annotations

from typing import Any

from sphinx.ext.napoleon import Config, GoogleDocstring

SETTINGS = Config(napoleon_use_ivar=True, napoleon_custom_sections=[("Warns", "Raises")])


def rewrite(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Put the lines of a docstring into Sphinx' markup."""
    kind = "method" if what == "property" else what
    lines[:] = GoogleDocstring(lines, SETTINGS, app, kind, name, thing, options).lines()


def setup(app: Any) -> dict[str, bool]:
    """Rewrite what autodoc has found."""
    app.connect("autodoc-process-docstring", rewrite)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
