"""A rough surface on the periodic half-space beside Tamaas: the same pressures, and the CPU time of both.

    python3 demos/studies/beside_tamaas.py --tamaas PYTHON [--quick] [--out DIR]

PYTHON is an interpreter that has Tamaas, such as that of a virtual environment with Python 3.12 (`pip install tamaas`);
it runs peers/with_tamaas.py in a process of its own. The surface is that of rough_surface.py, pressed by a rigid plate,
once without a layer and once with a linear one. Both solve to 1e-10 in their own measure, on one thread.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
from results import Report
from rough_surface import heights, pressed

import contactdd as cd

FORCE = 5.0
#: By name: the layer, and its compliance.
LAYERS = {"no layer": (cd.HardContact(), 0.0), "linear layer": (cd.LinearLayer(1e4), 1e-4)}


def theirs(python: str, surface: np.ndarray, compliance: float, folder: Path) -> tuple[np.ndarray, dict[str, float]]:
    """Tamaas' pressures, and what it tells of its run."""
    given, found = folder / "heights.npy", folder / "pressures.npy"
    np.save(given, surface)
    script = Path(__file__).parent / "peers" / "with_tamaas.py"
    env = {"PATH": os.environ["PATH"], "OMP_NUM_THREADS": "1"}
    command = [python, str(script), str(given), str(found), str(FORCE), str(compliance)]
    told = subprocess.run(command, env=env, check=True, capture_output=True, text=True).stdout
    return np.load(found), json.loads(told.splitlines()[-1])


def main() -> None:
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--tamaas", default=sys.executable)
    known, rest = parser.parse_known_args()
    report = Report(__file__, __doc__, rest, quick="64 × 64 points")
    rows = []
    for count in (64,) if report.quick else (64, 128, 256):
        surface = heights(count, count // 8)
        for name, (layer, compliance) in LAYERS.items():
            pressure, told = theirs(known.tamaas, surface, compliance, report.folder)
            solution, seconds = pressed(surface, layer, FORCE)
            ours = solution.contact().pressure.reshape(count, count)
            difference = float(np.linalg.norm(ours - pressure) / np.linalg.norm(pressure))
            row = {"points": count, "layer": name, "difference": difference, "cpu_seconds": seconds}
            rows.append(row | {"tamaas_cpu_seconds": told["cpu_seconds"], "tamaas_error": told["error"]})
            print(
                f"{count:4}² {name:13} pressures differ by {difference:.1e}; CPU {seconds:.2f} s, Tamaas "
                f"{told['cpu_seconds']:.2f} s (its error {told['error']:.0e})"
            )
    report.summary(rows)
    # Both are exact on the same grid but for their tolerances: hard contact's multipliers settle to 1e-6.
    assert all(row["difference"] < 1e-5 for row in rows)


if __name__ == "__main__":
    main()
