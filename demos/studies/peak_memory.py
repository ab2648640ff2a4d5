"""The peak of a process's memory, in the large libraries too, which Python itself does not see."""

from __future__ import annotations

import contextlib
from pathlib import Path


def forget_peak() -> float:
    """Have Linux measure the peak of this process's memory from now on; the memory now (MB)."""
    with contextlib.suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")
    return _status("VmRSS")


def peak_mb() -> float:
    """The largest memory of this process since the peak was forgotten (MB)."""
    return _status("VmHWM")


def _status(name: str) -> float:
    """A number of /proc/self/status in MB."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(float(line.split()[1]) for line in lines if line.startswith(name)) / 1024
