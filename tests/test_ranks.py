"""The same answer on 1 to 5 ranks, also with several ranks for one body; an error of one rank ends all of them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest
from under_mpirun import environment, mpirun

import contactdd as cd
from contactdd.base.ranks import deal_out

ROOT = Path(__file__).parents[1]

SCENE = """
import sys
import numpy as np
from mpi4py import MPI
import contactdd as cd
from scenes import LAYER, block, groove, stack

comm = MPI.COMM_WORLD
load = cd.Parameter(10.0)

loads = [[cd.Pressure("bottom", load)], [], [cd.Pressure("top", load)]]
bodies = [block(f"block {i}", i, (n, n // 2), loads=loads[i]) for i, n in enumerate((16, 24, 12))]
scene = stack(bodies, comm=comm)
"""

SOLVE = """
results = {}
for method, solver in (("auto", "auto"), ("newton-krylov", "condensed"), ("anderson", "condensed"),
                       ("auto", "multigrid"), ("anderson", "assembled")):
    load.value = 10.0
    solution = cd.solve(scene, method, local_solver=solver, tolerance=1e-11)
    load.value = 20.0
    again = cd.solve(scene, method, local_solver=solver, tolerance=1e-11, start=solution)
    for name, run in (("first", solution), ("second", again)):
        key = f"{method} {solver} {name}"
        results[key + " pressure"] = np.concatenate([run.contact(i).pressure for i in range(2)])
        u = run.displacement("block 1").x.array.reshape(-1, 2)
        results[key + " displacement"] = u - u.mean(axis=0)  # nothing holds the whole stack in its place
        results[key + " numbers"] = [run.elastic_energy(), run.layer_energy, run.iterations]
        assert run.residual < 1e-10 and run.imbalance < 1e-10
if comm.rank == 0:
    np.savez(sys.argv[1], **results)
"""


def launch(ranks: int, code: str, *arguments: str, timeout: float = 120) -> subprocess.CompletedProcess:
    command = mpirun(ranks, sys.executable, "-c", code, *arguments)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        env = environment(folder, ROOT, ROOT / "tests")
        process = subprocess.Popen(
            command, env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
        )
        try:
            out, error = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)  # mpirun alone would leave its ranks behind
            raise
    return subprocess.CompletedProcess(command, process.returncode, out, error)


def all_ranks_say(done: subprocess.CompletedProcess, message: str) -> None:
    """Assert that each of two ranks has ended with one line "rank … says …" that has the message in it."""
    assert done.returncode == 3, done.stderr
    for rank in range(2):
        said = [line for line in done.stdout.splitlines() if line.startswith(f"rank {rank} says")]
        assert len(said) == 1, done.stdout + done.stderr
        assert message in said[0]


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    file = tmp_path_factory.mktemp("ranks") / "alone.npz"
    done = launch(1, SCENE + SOLVE, str(file))
    assert done.returncode == 0, done.stderr
    with np.load(file) as content:
        return dict(content)


@pytest.mark.parametrize("ranks", [2, 3, 4, 5])
def test_same_answer(alone, ranks, tmp_path):
    file = tmp_path / "result.npz"
    done = launch(ranks, SCENE + SOLVE, str(file))
    assert done.returncode == 0, done.stderr
    with np.load(file) as content:
        for key, expected in alone.items():
            # Every rank computes with the same numbers; 1e-10 is what the issue asks for.
            np.testing.assert_allclose(content[key], expected, rtol=1e-10, atol=1e-10 * np.abs(expected).max())


def test_an_error_ends_all_ranks():
    code = SCENE + 'bodies[1].supports += (cd.Displacement("left", (1.0, None)),)\ncd.solve(scene)'
    done = launch(2, code, timeout=60)
    assert done.returncode != 0
    assert "prescribe different displacements" in done.stderr


def test_a_mesh_on_several_ranks_is_refused():
    code = """
from mpi4py import MPI
from dolfinx import mesh
import contactdd as cd
cd.from_dolfinx(mesh.create_unit_square(MPI.COMM_WORLD, 4, 4), everywhere=lambda x: x[0] >= 0)
"""
    done = launch(2, code, timeout=60)
    assert done.returncode != 0
    assert "spread over 2 ranks; expected a mesh on one" in done.stderr


def test_bodies_are_dealt_out_by_size():
    assert deal_out(1, [1.0, 2.0]) == [[0], [0]]
    assert deal_out(2, [1.0, 5.0, 3.0, 1.0]) == [[1], [0], [1], [1]]
    assert deal_out(5, [1.0, 5.0, 3.0]) == [[0], [1, 3], [2, 4]]


def test_one_rank_holds_all():
    bodies = [cd.Body(n, cd.rectangle((0, y), (1, y + 1), (2, 2)), cd.Isotropic(1, 0.3)) for y, n in enumerate("ab")]
    scene = cd.Scene(bodies, [cd.Contact((bodies[0], "top"), (bodies[1], "bottom"), cd.LinearLayer(1.0))])
    assert scene.ranks.alone
    assert all(scene.ranks.owns(place) for place in range(2))


def test_checkpoints_and_time_limits_are_decided_once(tmp_path):
    """One rank writes the file and looks at the clock; the others follow, also when a run goes on from the file."""
    code = (
        SCENE
        + """
import sys
file = sys.argv[1]
whole = cd.solve(scene, "chord", gamma=0.6)
cd.solve(scene, "chord", gamma=0.6, checkpoint=file, checkpoint_every=1e-9, callback=lambda r: r.iteration == 5)
resumed = cd.solve(scene, "chord", gamma=0.6, checkpoint=file, resume=True)
assert resumed.iterations == whole.iterations
assert abs(resumed.contact().pressure - whole.contact().pressure).max() == 0.0
for limit in (1e-6, 2e-3, 5e-3, 1e-2):
    short = cd.solve(scene, "chord", gamma=0.01, time_limit=limit, on_failure="return")
    assert scene.ranks.comm.allgather(short.iterations) == [short.iterations] * scene.ranks.comm.size
"""
    )
    done = launch(2, code, str(tmp_path / "state.npz"), timeout=60)
    assert done.returncode == 0, done.stderr
