"""A progress bar, by default shown on a terminal or in a notebook only, and only of runs that take their time."""

from __future__ import annotations

import math
import sys
import time
from typing import Any

import numpy as np

from ..history import Record

#: How long a run goes on before its bar appears, in seconds: what ends sooner needs none.
PATIENCE = 1.0


class Progress:
    """How far the run has come from its first measure to the tolerance, on a logarithmic scale.

    shown: True or False; None means: on a terminal or in a notebook, and only with tqdm installed.
    """

    def __init__(self, shown: bool | None, tolerance: float, criterion: str) -> None:
        self._criterion, self._tolerance = criterion, tolerance
        self._first = 0.0
        wanted = _watched() if shown is None else shown
        self._due = time.monotonic() + PATIENCE if wanted else math.inf
        self._bar: Any = None

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *error: object) -> None:
        if self._bar is not None:
            self._bar.close()

    def update(self, record: Record) -> None:
        """Show one iteration."""
        measure = record.change if self._criterion == "change" else record.residual
        self._first = self._first or max(measure, 2 * self._tolerance)
        if time.monotonic() > self._due:
            self._bar, self._due = _bar(), math.inf
        if self._bar is None:
            return
        done = np.log(self._first / max(measure, self._tolerance)) / np.log(self._first / self._tolerance)
        self._bar.n = int(100 * np.clip(done, 0.0, 1.0))
        self._bar.set_postfix_str(f"iteration {record.iteration}, {self._criterion} {measure:.1e}", refresh=False)
        self._bar.update(0)


def _watched() -> bool:
    if hasattr(sys, "ps1") or "ipykernel" in sys.modules:
        return True
    return bool(sys.stderr is not None and sys.stderr.isatty())


def _bar() -> Any:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    return tqdm(total=100, bar_format="{l_bar}{bar}| {elapsed}{postfix}", leave=False)
