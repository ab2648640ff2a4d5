"""Shared by all tests: the demos' modules can be imported."""

from __future__ import annotations

import sys
from pathlib import Path

import contactdd  # noqa: F401  before any test imports dolfinx itself, see contactdd.base.compat

DEMOS = Path(__file__).parents[1] / "demos"
sys.path[:0] = [str(DEMOS), str(DEMOS / "studies")]
