"""The launcher finds dolfinx also in PyPI's wheel, whose libraries another module has to load first."""

from __future__ import annotations

import os
import sys

import pytest
from test_launcher import launch


@pytest.mark.parametrize("version", ["0.11.0.post0", "0.8.0"])
def test_the_wheel_is_found(version, tmp_path):
    """A dolfinx that can be imported after dolfinx_solver only, as there; a version that is too old is none."""
    (tmp_path / "dolfinx_solver.py").write_text("")
    (tmp_path / "dolfinx.py").write_text(f"import sys\nsys.modules['dolfinx_solver']\n__version__ = {version!r}\n")
    programs = tmp_path / "bin"
    programs.mkdir()
    for name, script in [
        ("python3", f'PYTHONPATH="{tmp_path}" exec {sys.executable} "$@"'),
        ("docker", "exit 1"),
        ("podman", 'case $1 in info | image) ;; *) echo "in a container" ;; esac'),
    ]:
        (programs / name).write_text(f"#!/bin/sh\n{script}\n")
        (programs / name).chmod(0o755)
    done = launch("true", CONTACTDD_RUN="", PATH=f"{programs}:{os.environ['PATH']}", XDG_CACHE_HOME=str(tmp_path))
    assert done.returncode == 0
    assert ("it has dolfinx" in done.stderr) == (version != "0.8.0")
