"""Formulas as MathML, which browsers draw themselves: no script, no font from elsewhere."""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.util import logging

log = logging.getLogger(__name__)


def plain(formula: str) -> str:
    r"""A formula without what docutils does not read as TeX does: \dots, sizes of brackets, the digits of \frac12."""
    formula = re.sub(r"\\[bB]igg?[lr]?(?![a-zA-Z])", "", formula.replace(r"\dots", r"\ldots"))
    return re.sub(r"frac\s*(\d)\s*(\d)", r"frac{\1}{\2}", formula)


def drawn(node: nodes.Element, as_block: bool) -> str:
    """A formula in MathML; one that cannot be read is a warning, and stays as it is."""
    try:
        return tex2mathml(plain(node.astext()), as_block=as_block)
    except (MathError, SyntaxError, IndexError) as error:
        log.warning("formula %r: %s", node.astext(), error, location=node)
        return f"<code>{node.astext()}</code>"


def inline(translator: Any, node: nodes.math) -> None:
    """Write a formula within a line."""
    translator.body.append(drawn(node, as_block=False))
    raise nodes.SkipNode


def block(translator: Any, node: nodes.math_block) -> None:
    """Write a formula on lines of its own."""
    translator.body.append(f'<div class="math">{drawn(node, as_block=True)}</div>\n')
    raise nodes.SkipNode


def setup(app: Any) -> dict[str, bool]:
    """Make the renderer known to Sphinx."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
