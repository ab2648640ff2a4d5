"""A progress bar, by default shown on a terminal or in a notebook only, and only of runs that take their time."""

from __future__ import annotations

import math
import sys
import time
from typing import Any

import numpy as np

from ..base.notebook import in_notebook
from ..history import Record

#: How long a run goes on before its bar appears, since what ends sooner needs none, and how often it moves, in seconds.
PATIENCE, PAUSE = 1.0, 0.1


class Progress:
    """How far the run has come from its first measure to the tolerance, on a logarithmic scale.

    shown: True or False; None means: on a terminal or in a notebook. On a terminal only with tqdm installed.
    """

    def __init__(self, shown: bool | None, tolerance: float, criterion: str) -> None:
        self._criterion, self._tolerance = criterion, tolerance
        self._first = 0.0
        wanted = _watched() if shown is None else shown
        self._due = time.monotonic() + PATIENCE if wanted else math.inf
        self._bar: TerminalBar | NotebookBar | None = None

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *error: object) -> None:
        if self._bar is not None:
            self._bar.close()

    def update(self, record: Record) -> None:
        """Show one iteration."""
        measure = record.change if self._criterion == "change" else record.residual
        self._first = self._first or max(measure, 2 * self._tolerance)
        if time.monotonic() < self._due:
            return
        self._bar = self._bar or _bar()
        if self._bar is None:
            self._due = math.inf
            return
        self._due = time.monotonic() + PAUSE
        done = np.log(self._first / max(measure, self._tolerance)) / np.log(self._first / self._tolerance)
        text = f"iteration {record.iteration}, {self._criterion} {measure:.1e}"
        self._bar.show(int(100 * np.clip(done, 0.0, 1.0)), text)


class TerminalBar:
    """A bar on a terminal, which goes when it is closed."""

    def __init__(self) -> None:
        from tqdm import tqdm

        self._bar = tqdm(total=100, bar_format="{l_bar}{bar}| {elapsed}{postfix}", leave=False, mininterval=0.0)

    def show(self, percent: int, text: str) -> None:
        """Show how far the run is."""
        self._bar.n = percent
        self._bar.set_postfix_str(text, refresh=True)

    def close(self) -> None:
        """Take the bar away."""
        self._bar.close()


class NotebookBar:
    """A bar in a notebook, of plain HTML: a widget would stay behind, dead, in the file."""

    def __init__(self) -> None:
        from IPython.display import HTML, display

        self._html: Any = HTML
        self._output: Any = display(HTML(""), display_id=True)

    def show(self, percent: int, text: str) -> None:
        """Show how far the run is."""
        self._output.update(self._html(f'<progress value="{percent}" max="100"></progress> {text}'))

    def close(self) -> None:
        """Leave nothing behind."""
        self._output.update(self._html(""))


def _watched() -> bool:
    if hasattr(sys, "ps1") or in_notebook():
        return True
    return bool(sys.stderr is not None and sys.stderr.isatty())


def _bar() -> TerminalBar | NotebookBar | None:
    try:
        return NotebookBar() if in_notebook() else TerminalBar()
    except ImportError:
        return None
