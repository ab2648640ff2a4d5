"""Whether this is a notebook."""

from __future__ import annotations

import sys


def in_notebook() -> bool:
    """Whether a kernel runs this; that its package is imported says little."""
    if "ipykernel" not in sys.modules:
        return False
    from IPython import get_ipython

    return getattr(get_ipython(), "kernel", None) is not None
