"""An accuracy that was asked for is there: a few of the random scenes of random_blocks.py, one of each accuracy."""

from __future__ import annotations

import pytest
from random_blocks import asked


@pytest.mark.parametrize("seed", [3, 1, 56])
def test_three_accuracies(seed):
    """Reached, and by a mesh cut once more in elements of two degrees more the error is at most twice that."""
    outcome = asked(seed)
    assert not outcome.fault, outcome
