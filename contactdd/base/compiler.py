"""How the C compiler treats the kernels of forms: for this machine's processor, sums in any order.

Elements of high degree spend most of their time in these kernels; the flags make them two to three times faster. The
flags are part of the name under which a kernel is kept, so that machines with unlike processors may share a cache.
"""

from __future__ import annotations

import platform
from functools import cache
from pathlib import Path

#: What makes a processor one of x86-64's levels, as Linux names its abilities.
LEVELS = {
    "x86-64-v4": {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
    "x86-64-v3": {"avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "movbe"},
}


# Not -ffast-math: linked into a library it would have the whole process flush small numbers to zero.
REORDERED = ["-fno-math-errno", "-fno-trapping-math", "-fno-signed-zeros", "-fassociative-math"]


@cache
def flags() -> list[str]:
    """The compiler's flags."""
    return ["-O3", *REORDERED, *_processor()]


def _processor() -> list[str]:
    """The flag that allows the instructions of this processor; none where it isn't known."""
    info = Path("/proc/cpuinfo")
    if platform.machine() != "x86_64" or not info.is_file():
        return []
    abilities = next((set(line.split()) for line in info.read_text().splitlines() if line.startswith("flags")), set())
    level = next((name for name, needed in LEVELS.items() if needed <= abilities), None)
    return [] if level is None else [f"-march={level}"]
