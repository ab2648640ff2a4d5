"""A handful of the random faults of `faults.py`; each is a real process to which something happens."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

import faults


@pytest.mark.parametrize("name", ["kill -9", "SIGTERM", "SIGINT", "full disk", "two writers"])
def test_nothing_is_lost(name):
    faults.run(name, seed=7)


@pytest.mark.parametrize("name", ["exception on a rank", "kill -9 of a rank", "SIGTERM to mpirun"])
def test_nothing_is_lost_on_two_ranks(name):
    faults.run(name, seed=7)
