"""A progress bar appears for runs that take their time only, and closes with them."""

from __future__ import annotations

import os
import re

import nbclient
import nbformat
import pytest
from test_demos import ROOT

import contactdd as cd
from contactdd.iteration import progress

pytest.importorskip("tqdm")


def record(iteration: int, residual: float) -> cd.Record:
    return cd.Record(iteration, 1.0, residual, residual, -1.0, 1.0, 0.0, 1.0, 2 * iteration, 0.0)


def shown(monkeypatch, capsys, seconds_each: float, shown: bool = True) -> list[str]:
    """The numbers of percent that a run of four iterations shows, whose residuals fall by a hundred each."""
    clock = iter(range(100))
    monkeypatch.setattr(progress.time, "monotonic", lambda: seconds_each * next(clock))
    with progress.Progress(shown, 1e-8, "residual") as bar:
        for iteration in range(1, 5):
            bar.update(record(iteration, 0.01**iteration))
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.rsplit("\r", 1)[-1].strip() == ""  # nothing stays
    return list(dict.fromkeys(re.findall(r"(\d+)%", told.err)))


def test_a_short_run_has_no_bar(monkeypatch, capsys):
    assert shown(monkeypatch, capsys, 1e-3) == []


def test_a_long_run_has_one(monkeypatch, capsys):
    """From the first iteration after a second: a third, two thirds and all of the decades to the tolerance."""
    assert [each for each in shown(monkeypatch, capsys, 0.6) if each != "0"] == ["33", "66", "100"]


def test_nor_has_one_that_is_not_wanted(monkeypatch, capsys):
    assert shown(monkeypatch, capsys, 0.6, shown=False) == []


def test_a_bar_in_a_notebook_leaves_nothing(monkeypatch):
    """It is drawn while the run goes on, here from its start, and is empty in the file."""
    paths = [str(ROOT), str(ROOT / "tests"), os.environ.get("PYTHONPATH", "")]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(paths))
    cell = """
import scenes, contactdd as cd
from contactdd.iteration import progress
progress.PATIENCE = progress.PAUSE = 0.0
drawn, show = [], progress.NotebookBar.show
progress.NotebookBar.show = lambda bar, percent, text: (drawn.append(text), show(bar, percent, text))
iterations = cd.solve(scenes.pressed((16, 8)), "chord", gamma=0.6).iterations
print(len(drawn) == iterations > 5, drawn[0])
"""
    content = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell)])
    nbclient.NotebookClient(content, timeout=120, kernel_name="python3").execute()
    outputs = content.cells[0].outputs
    assert [output["data"]["text/html"] for output in outputs if output.output_type == "display_data"] == [""]
    assert any(output.get("text", "").startswith("True iteration 1, residual ") for output in outputs)
