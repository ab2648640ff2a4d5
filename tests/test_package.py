"""The wheel and the source distribution: built, installed and imported as a user's pip would do it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

import contactdd as cd

pytestmark = pytest.mark.long
ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> Path:
    """The folder of the wheel and the source distribution, made from a copy of what they are made from."""
    pytest.importorskip("build", reason="the module build, which builds packages, is not installed")
    source, folder = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("dist")
    shutil.copytree(ROOT / "contactdd", source / "contactdd", ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    command = [sys.executable, "-m", "build", "--no-isolation", "--outdir", str(folder), str(source)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder


def test_the_wheel_has_all_modules_and_its_types(built):
    (wheel,) = built.glob("*.whl")
    names = set(zipfile.ZipFile(wheel).namelist())
    modules = {str(path.relative_to(ROOT)) for path in (ROOT / "contactdd").rglob("*.py")}
    assert modules | {"contactdd/py.typed"} <= names
    assert not [name for name in names if not name.startswith("contactdd")]


def test_the_sources_have_all_modules_and_the_licence(built):
    (archive,) = built.glob("*.tar.gz")
    with tarfile.open(archive) as opened:
        names = {name.partition("/")[2] for name in opened.getnames()}
    assert {"LICENSE", "README.md", "pyproject.toml", "contactdd/py.typed", "contactdd/__init__.py"} <= names


def test_it_works_from_where_it_is_installed(built, tmp_path):
    """In an environment of its own, away from the checkout: the package, its types and its command."""
    (wheel,) = built.glob("*.whl")
    environment = [sys.executable, "-m", "venv", "--system-site-packages", "--without-pip", str(tmp_path / "venv")]
    subprocess.run(environment, check=True)
    python = tmp_path / "venv" / "bin" / "python"
    pip = [sys.executable, "-m", "pip", "--python", str(python)]
    install = [*pip, "install", "--quiet", "--no-deps", "--no-index", str(wheel)]
    env = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    subprocess.run(install, check=True, env=env, capture_output=True)
    script = (
        "import contactdd, pathlib; p = pathlib.Path(contactdd.__file__).parent; print(p, (p / 'py.typed').exists())"
    )
    said = subprocess.run([python, "-c", script], cwd=tmp_path, env=env, check=True, capture_output=True, text=True)
    folder, typed = said.stdout.split()
    assert Path(folder).is_relative_to(tmp_path)
    assert typed == "True"
    told = subprocess.run(
        [python.parent / "contactdd"], cwd=tmp_path, env=env, check=True, capture_output=True, text=True
    )
    assert f"contactdd {cd.__version__} in {folder}" in told.stdout
