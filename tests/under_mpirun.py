"""Commands under mpirun, as tests start them."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path


def mpirun(ranks: int, *command: str) -> list[str]:
    """The command on so many ranks, by the mpirun beside this Python or the first one found."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    return [shutil.which("mpirun", path=path) or "mpirun", "-n", str(ranks), *command]


def environment(folder: Path | str, *paths: Path) -> dict[str, str]:
    """Where it runs; paths: where Python looks for modules.

    mpirun keeps its files in the folder: one that was killed leaves them behind, and a later one of the same process
    number would not start beside them.
    """
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, paths)), "OMP_NUM_THREADS": "1", "TMPDIR": str(folder)}
    env.pop("PYTHONUNBUFFERED", None)  # prints are written whole: else the lines of two ranks mix
    if os.geteuid() == 0:
        env |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    # More ranks than this machine has cores: those that wait for a message leave their core to the others.
    return env | {"PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe", "OMPI_MCA_mpi_yield_when_idle": "1"}
