"""Pictures of bodies leave the process as it was: without a display, with the backend that was chosen."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = """
import os
{before}
import sys
import test_uniform
import contactdd as cd

solution = cd.solve(test_uniform.scene(degree=2))
for _ in range(2):
    picture = solution.plot_bodies(component="yy", size=(300, 200))
assert picture.pixels.std() > 10, "an empty picture"
assert "DISPLAY" not in os.environ
solution.plot_contact(path=sys.argv[1])
import matplotlib
import matplotlib.pyplot as plt
plt.figure()
print(matplotlib.get_backend().lower())
"""


@pytest.mark.parametrize(
    ("before", "backend"), [("", "agg"), ("import matplotlib; matplotlib.use('svg')", "svg")], ids=["none", "svg"]
)
def test_a_script_that_draws_bodies_before_its_first_figure(before, backend, tmp_path):
    """Without a display and without a choice matplotlib needs no window; a choice is left as it is."""
    env = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "MPLBACKEND")}
    env["PYTHONPATH"] = os.pathsep.join([str(Path(__file__).parent), env.get("PYTHONPATH", "")])
    command = [sys.executable, "-c", SCRIPT.format(before=before), tmp_path / "contact.png"]
    done = subprocess.run(command, env=env, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split()[-1] == backend
    assert (tmp_path / "contact.png").stat().st_size > 5000
