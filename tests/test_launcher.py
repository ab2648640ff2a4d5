"""The launcher `run`: commands, arguments, statuses and signals go through it unchanged.

The tests run inside the environment that the launcher makes, so it finds the current Python good. What it does on a
machine without dolfinx is tried with stand-ins for python3, docker and the like on a PATH of our own.
"""

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
RUN = str(ROOT / "run")


def launch(*command, stdin="", cwd=None, **environment):
    """Run a command through the launcher, here unless the environment says otherwise."""
    env = {**os.environ, "CONTACTDD_RUN": "here", **environment}
    return subprocess.run([RUN, *command], input=stdin, capture_output=True, text=True, cwd=cwd, env=env, timeout=60)


@pytest.fixture
def stand_in(tmp_path):
    """A directory of programs that shadow the system's, and a function that adds one."""
    folder = tmp_path / "bin"
    folder.mkdir()

    def add(name, script):
        program = folder / name
        program.write_text(f"#!/bin/sh\n{script}\n")
        program.chmod(0o755)
        return f"{folder}:{os.environ['PATH']}"

    return add


def test_syntax():
    for script in ("run", ".ci/run"):
        subprocess.run(["bash", "-n", ROOT / script], check=True)
        assert os.access(ROOT / script, os.X_OK)


@pytest.mark.parametrize("status", [0, 1, 37, 255])
def test_exit_status(status):
    assert launch("sh", "-c", f"exit {status}").returncode == status


def test_unknown_command():
    assert launch("no-such-command-anywhere").returncode == 127


ARGUMENTS = ["two words", "it's", '"quoted"', "a\nb", "", "$HOME", "*", "\\", "--help", "-c", "é σ", "x=1"]


def test_arguments():
    printed = launch(sys.executable, "-c", "import sys; print(ascii(sys.argv[1:]))", *ARGUMENTS).stdout
    assert printed == ascii(ARGUMENTS) + "\n"


def test_python_script(tmp_path):
    script = tmp_path / "a script.py"
    script.write_text("import sys, pathlib\nprint(ascii(sys.argv[1:]), sys.path[1], pathlib.Path.cwd())")
    done = launch("a script.py", *ARGUMENTS, cwd=tmp_path)
    assert done.stdout == f"{ARGUMENTS!a} {ROOT} {tmp_path}\n"


def test_pytest(tmp_path):
    (tmp_path / "test_one.py").write_text("def test_one():\n    import contactdd\n")
    done = launch("pytest", "-q", "-p", "no:cacheprovider", "-k", "one or two", cwd=tmp_path)
    assert done.returncode == 0
    assert "1 passed" in done.stdout
    assert launch("pytest", "-q", "-p", "no:cacheprovider", "-k", "two", cwd=tmp_path).returncode == 5


def test_standard_streams():
    done = launch("cat", stdin="one\ntwo")
    assert done.stdout == "one\ntwo"
    assert re.fullmatch(r"run: .+\n", done.stderr), "one line, and on stderr only"


@pytest.mark.parametrize("signum", [signal.SIGTERM, signal.SIGINT])
def test_signals_reach_the_command(signum):
    code = f"""
import signal, sys, time
signal.signal({int(signum)}, lambda *_: sys.exit(42))
print("ready", flush=True)
time.sleep(60)"""
    env = {**os.environ, "CONTACTDD_RUN": "here"}
    command = [RUN, sys.executable, "-c", code]
    with subprocess.Popen(command, stdout=subprocess.PIPE, env=env, text=True) as process:
        assert process.stdout.readline() == "ready\n"
        process.send_signal(signum)
        assert process.wait(timeout=30) == 42


def test_killed_command():
    assert launch("sh", "-c", "kill -TERM $$").returncode == -signal.SIGTERM


@pytest.mark.parametrize("argument", ["--help", "-h"])
def test_help(argument):
    done = launch(argument)
    assert done.returncode == 0
    assert "CONTACTDD_RUN" in done.stdout
    assert "./run demos/groove.py" in done.stdout
    assert done.stderr == ""


def test_no_command():
    assert launch().returncode != 0


def test_unknown_place():
    done = launch("true", CONTACTDD_RUN="moon")
    assert done.returncode != 0
    assert "moon" in done.stderr


def test_the_dockerfile_reads_the_same_packages():
    packages = launch("--packages").stdout.split()
    assert {"python3-dolfinx", "libopenblas0-pthread"} <= set(packages)
    assert len(packages) == len(set(packages))
    assert all(re.fullmatch(r"[a-z0-9][a-z0-9+.-]+", name) for name in packages)

    sed = re.search(r"\$\((sed '[^']*') \S*\.debian-packages\)", (ROOT / "Dockerfile").read_text())
    assert sed, "the Dockerfile reads .debian-packages"
    listed = subprocess.run(f"{sed[1]} .debian-packages", shell=True, cwd=ROOT, capture_output=True, text=True)
    assert listed.stdout.split() == packages


def test_finds_dolfinx_in_the_current_python():
    done = launch("true", CONTACTDD_RUN="")
    assert done.returncode == 0
    assert "it has dolfinx" in done.stderr


@pytest.mark.parametrize("version", [None, "0.8.0"])
def test_without_dolfinx_a_container_is_next(version, stand_in, tmp_path):
    """An engine that answers gets the command as it is, the calling user, the checkout and the current directory."""
    if version:
        (tmp_path / "dolfinx.py").write_text(f"__version__ = {version!r}")
        path = stand_in("python3", f'PYTHONPATH="{tmp_path}" exec {sys.executable} "$@"')
    else:
        path = stand_in("python3", "exit 1")
    stand_in("docker", "exit 1  # a client without an engine")
    stand_in("podman", 'case $1 in info | image) ;; *) for word; do printf "%s\\n" "$word"; done ;; esac')
    work = tmp_path / "work"
    work.mkdir()
    done = launch("cat", "two words", cwd=work, PATH=path, CONTACTDD_RUN="", XDG_CACHE_HOME=str(tmp_path))
    words = done.stdout.split("\n")
    assert words[0] == "run"
    assert words[-3:] == ["cat", "two words", ""]
    assert f"{ROOT}:{ROOT}" in words
    assert words[words.index("--workdir") + 1] == str(work)
    owner = os.stat(ROOT) if os.getuid() == 0 else None
    ids = f"{owner.st_uid}:{owner.st_gid}" if owner else f"{os.getuid()}:{os.getgid()}"
    assert words[words.index("--user") + 1] == ids
    assert "docker does not answer" in done.stderr


def test_forced_engine_must_answer(stand_in):
    done = launch("true", PATH=stand_in("docker", "exit 1"), CONTACTDD_RUN="docker")
    assert done.returncode != 0
    assert "does not answer" in done.stderr


def test_a_failed_build_leaves_no_tree(stand_in, tmp_path):
    """mmdebstrap's words are shown and kept, its half a tree is not."""
    path = stand_in("mmdebstrap", 'echo "E: no network"; mkdir -p "$XDG_CACHE_HOME"; exit 25')
    stand_in("unshare", 'while [ "$1" != true ]; do shift; done  # the test that a plain user may')
    stand_in("newuidmap", "")
    stand_in("apt-get", "exit 1")
    done = launch("true", PATH=path, CONTACTDD_RUN="tree", XDG_CACHE_HOME=str(tmp_path))
    assert done.returncode == 1
    assert "could not be built" in done.stderr or "could not install" in done.stderr
    assert not [entry for entry in (tmp_path / "contactdd").glob("tree-*") if entry.is_dir()]
