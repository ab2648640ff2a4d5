"""What a scene doesn't use costs nothing: no import, no compiled form, and none twice."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

#: Counts the forms that are compiled, in a process whose cache is empty.
COUNT = """
import json
import ffcx.codegeneration.jit as jit
compiled = []
compile_forms = jit.compile_forms
def counting(forms, *arguments, **options):
    compiled.extend(str(form.signature()) for form in forms)
    return compile_forms(forms, *arguments, **options)
jit.compile_forms = counting
import contactdd as cd
from scenes import pressed

def groove(q=10, E=2.1e5):
    return pressed((8, 4), gap=lambda x: 1e-4 * (1 - x[0] / 4), load=q, material=cd.Isotropic(E=E, nu=0.3))
"""


def answer(script: str, home: Path | None = None) -> object:
    """What a script prints as JSON in its last line, run in a process of its own."""
    env = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "tests"), os.environ.get("PYTHONPATH", "")]),
    }
    if home is not None:
        env["XDG_CACHE_HOME"] = str(home)  # where dolfinx keeps compiled forms
    done = subprocess.run([sys.executable, "-c", script], env=env, check=True, capture_output=True, text=True)
    return json.loads(done.stdout.splitlines()[-1])


def test_import_brings_nothing_that_solving_does_not_use():
    alone = "try: import dolfinx_solver\nexcept ImportError: pass\nimport dolfinx\n"  # the wheel's libraries first
    listing = "import json, sys; print(json.dumps(sorted(sys.modules)))"
    before, after = set(answer(alone + listing)), set(answer(f"{alone}import contactdd\n{listing}"))
    heavy = {"scipy.sparse", "scipy.optimize", "scipy.interpolate", "scipy.spatial", "matplotlib", "pyvista", "gmsh"}
    assert heavy & (after - before) == set()
    assert "contactdd.reference" not in after
    assert not {f"contactdd.{name}" for name in ("rigid_body", "half_space", "influence", "shapes")} & after


def test_reference_is_there_when_asked_for():
    assert answer("import contactdd as cd; print(cd.reference.hertz_cylinder(1.0, 1.0, 1.0, 0.3).half_width)")
    with pytest.raises(subprocess.CalledProcessError):
        answer("import contactdd as cd; cd.nothing_of_that_name")


def test_forms_compiled(tmp_path):
    """Two for the whole groove, whatever its numbers; none for a second scene; one Robin term for both bodies."""
    script = COUNT + (
        "cd.solve(groove()); first = len(compiled)\n"
        "cd.solve(groove(q=20, E=1e5), 'chord'); second = len(compiled)\n"
        "cd.solve(groove(), local_solver='assembled'); cd.solve(groove(), 'chord', local_solver='assembled')\n"
        "print(json.dumps([first, second, len(set(compiled))]))"
    )
    assert answer(script, tmp_path) == [2, 2, 3]
