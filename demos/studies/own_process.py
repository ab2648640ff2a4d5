"""Measurements that must not see each other's memory: a study that calls itself, each time in a process of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any


def in_own_process(script: str, *arguments: Any, environment: Mapping[str, str] | None = None) -> dict[str, Any]:
    """What `script --case arguments` prints last, as JSON; one thread, with the package beside the script.

    environment: variables that are other there.
    """
    paths = [str(Path(script).resolve().parents[2]), os.environ.get("PYTHONPATH", "")]
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
    done = subprocess.run(
        [sys.executable, script, "--case", *map(str, arguments)],
        env={**os.environ, **threads, "PYTHONPATH": os.pathsep.join(filter(None, paths)), **(environment or {})},
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    )
    return json.loads(done.stdout.splitlines()[-1])
