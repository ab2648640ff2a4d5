"""Shared by all tests: the demos are importable modules."""

from __future__ import annotations

import sys
from pathlib import Path

import contactdd  # noqa: F401  before any test imports dolfinx itself, see contactdd.compat

sys.path.insert(0, str(Path(__file__).parents[1] / "demos"))
