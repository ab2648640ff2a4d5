"""A rough surface on the periodic half-space beside Tamaas: the same pressures, and the CPU time of both.

    python3 demos/studies/beside_tamaas.py --tamaas PYTHON [--quick] [--out DIR]

PYTHON is an interpreter that has Tamaas, such as that of a virtual environment with Python 3.12 (`pip install tamaas`);
it runs peers/with_tamaas.py in a process of its own. The surface is that of rough_surface.py, its waves down to eight
points, pressed by a rigid plate without a layer and with power layers, which Tamaas takes as a `Functional`. The layers
are stiff beside the surface, or the force closes it: else Tamaas' iterations do not converge. Tamaas solves to 1e-8 in
its own measure, contactdd to a residual of 1e-10, both on one thread; of each the CPU seconds are those of one solve
from nothing, without imports.
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

#: By name: the force, and B and a of the layer.
CASES = {
    "no layer": (5.0, 0.0, 1.0),
    "power layer, 4 % closed": (5.0, 1e-6, 1.1),
    "power layer, half closed": (50.0, 1e-5, 1.1),
    "power layer, closed": (500.0, 1e-5, 1.1),
}


def theirs(python: str, surface: np.ndarray, case: tuple[float, ...], folder: Path) -> tuple[np.ndarray, dict]:
    """Tamaas' pressures, and what it tells of its run."""
    given, found = folder / "heights.npy", folder / "pressures.npy"
    np.save(given, surface)
    script = Path(__file__).parent / "peers" / "with_tamaas.py"
    env = {"PATH": os.environ["PATH"], "OMP_NUM_THREADS": "1"}
    command = [python, str(script), str(given), str(found), *map(str, case)]
    told = subprocess.run(command, env=env, check=True, capture_output=True, text=True).stdout
    return np.load(found), json.loads(told.splitlines()[-1])


def main() -> None:
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--tamaas", default=sys.executable)
    known, rest = parser.parse_known_args()
    report = Report(__file__, __doc__, rest, quick="64 × 64 points")
    rows = []
    pressed(heights(32, 4), cd.HardContact(), 1.0), pressed(heights(32, 4), cd.PowerLayer(1e-5, 1.1), 1.0)  # imports
    for count in (64,) if report.quick else (256, 512, 1024):
        surface = heights(count, count // 8)
        for name, (force, B, a) in CASES.items():
            if count > 512 and name == "power layer, half closed":
                continue  # Tamaas takes more than ten minutes for it
            pressure, told = theirs(known.tamaas, surface, (force, B, a), report.folder)
            solution, seconds = pressed(surface, cd.PowerLayer(B, a) if B else cd.HardContact(), force)
            ours = solution.contact().pressure.reshape(count, count)
            difference = float(np.abs(ours - pressure).max() / pressure.max())
            row = {"points": count, "case": name, "difference": difference, "cpu_seconds": seconds}
            row |= {"iterations": solution.iterations, "closed": solution.contact().area}
            rows.append(row | {f"tamaas_{key}": value for key, value in told.items()})
            theirs_took = told["cpu_seconds"]
            print(
                f"{count:4}² {name:25} pressures differ by {difference:.1e}; CPU {seconds:5.2f} s, Tamaas "
                f"{theirs_took:5.2f} s (its error {told['error']:.0e}); ratio {seconds / theirs_took:.2f}"
            )
    report.summary(rows)
    # Both are exact on the same grid but for their tolerances.
    assert all(row["difference"] < 1e-5 for row in rows)


if __name__ == "__main__":
    main()
