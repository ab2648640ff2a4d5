"""A progress bar appears for runs that take their time only, and closes with them."""

from __future__ import annotations

import time

import pytest

import contactdd as cd
from contactdd.iteration import progress

pytest.importorskip("tqdm")


def record(iteration: int, residual: float) -> cd.Record:
    return cd.Record(iteration, 1.0, residual, residual, -1.0, 1.0, 0.0, 1.0, 2 * iteration, 0.0)


def shown(monkeypatch, seconds_each: float, shown: bool = True) -> list[int]:
    """The states in percent of the bar that a run of four iterations shows, which fall by a hundred each."""
    clock = iter(range(100))
    monkeypatch.setattr(time, "monotonic", lambda: seconds_each * next(clock))
    states = []
    with progress.Progress(shown, 1e-8, "residual") as bar:
        for iteration in range(1, 5):
            bar.update(record(iteration, 0.01**iteration))
            states += [bar._bar.n] if bar._bar is not None else []
    return states


def test_a_short_run_has_no_bar(monkeypatch, capsys):
    assert shown(monkeypatch, 1e-3) == []
    assert capsys.readouterr() == ("", "")


def test_a_long_run_has_one(monkeypatch, capsys):
    """From the first iteration after a second: a third, two thirds and all of the decades to the tolerance."""
    assert shown(monkeypatch, 0.6) == [33, 66, 100]
    assert "%" in capsys.readouterr().err


def test_nor_has_one_that_is_not_wanted(monkeypatch):
    assert shown(monkeypatch, 0.6, shown=False) == []
