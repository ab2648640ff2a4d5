"""An interrupted run goes on to the same digits; what is not its checkpoint is refused."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import scenes

import contactdd as cd

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def scene():
    return scenes.paper("vertex")


@pytest.mark.parametrize("method", ["chord", "kurchatov", "anderson", "auto", "newton-krylov"])
def test_same_digits(scene, method, tmp_path):
    file = tmp_path / "state.npz"
    whole = cd.solve(scene, method)
    cd.solve(scene, method, checkpoint=file, callback=lambda record: record.iteration == 3)
    resumed = cd.solve(scene, method, checkpoint=file, resume=True)
    assert resumed.iterations == whole.iterations
    np.testing.assert_array_equal(resumed.contact().pressure, whole.contact().pressure)
    np.testing.assert_array_equal(resumed.history.residual, whole.history.residual)


def test_sequence_of_gamma_goes_on(scene, tmp_path):
    file = tmp_path / "state.npz"

    def gamma(k):
        return 0.4 + 0.2 * (k % 2)

    whole = cd.solve(scene, "chord", gamma=gamma)
    cd.solve(scene, "chord", gamma=gamma, checkpoint=file, callback=lambda record: record.iteration == 4)
    resumed = cd.solve(scene, "chord", gamma=gamma, checkpoint=file, resume=True)
    np.testing.assert_array_equal(resumed.history.gamma, whole.history.gamma)


def test_exception_in_the_callback_leaves_a_state(scene, tmp_path):
    file = tmp_path / "state.npz"

    def interrupt(record):
        if record.iteration == 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        cd.solve(scene, "chord", checkpoint=file, callback=interrupt)
    resumed = cd.solve(scene, "chord", checkpoint=file, resume=True)
    np.testing.assert_array_equal(resumed.contact().pressure, cd.solve(scene, "chord").contact().pressure)


@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGKILL])
def test_killed_process(scene, tmp_path, ending):
    """A process that is really killed in the middle of a run that never ends."""
    file = tmp_path / "state.npz"
    code = f"""import sys
sys.path.insert(0, {str(ROOT / "tests")!r})
import signal, time, scenes, contactdd as cd
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell that starts something behind itself has it ignored
slowly = lambda record: time.sleep(0.1)
cd.solve(scenes.paper("vertex"), "chord", gamma=1e-3, checkpoint={str(file)!r}, checkpoint_every=0.2, callback=slowly)
"""
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    process = subprocess.Popen([sys.executable, "-c", code], env=env, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 60
    while not file.exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    process.send_signal(ending)
    assert process.wait(timeout=60) != 0
    resumed = cd.solve(scene, "chord", gamma=1e-3, checkpoint=file, resume=True, callback=lambda record: True)
    assert resumed.iterations > 1
    assert np.array_equal(resumed.history.iteration, np.arange(1, resumed.iterations + 1))


def test_time_limit(scene, tmp_path):
    file = tmp_path / "state.npz"
    solution = cd.solve(scene, "chord", gamma=1e-3, time_limit=0.1, checkpoint=file)
    assert solution.status == "stopped"
    assert file.exists()


def damaged(file: Path) -> list[bytes]:
    content = file.read_bytes()
    middle = len(content) // 2
    flipped = content[:middle] + bytes([content[middle] ^ 0xFF]) + content[middle + 1 :]
    return [b"", b"not a checkpoint", content[:middle], flipped]


def test_damaged_and_foreign_files_are_refused(scene, tmp_path):
    file = tmp_path / "state.npz"
    cd.solve(scene, "chord", checkpoint=file, callback=lambda record: record.iteration == 3)
    for content in damaged(file):
        broken = tmp_path / "broken.npz"
        broken.write_bytes(content)
        with pytest.raises(cd.CheckpointError, match="damaged"):
            cd.solve(scene, "chord", checkpoint=broken, resume=True)
    with pytest.raises(cd.CheckpointError, match="method is 'chord', expected 'kurchatov'"):
        cd.solve(scene, "kurchatov", checkpoint=file, resume=True)
    with pytest.raises(cd.CheckpointError, match="bodies is"):
        cd.solve(scenes.paper("gauss", refine=2), "chord", checkpoint=file, resume=True)


def test_nothing_is_executed(scene, tmp_path):
    """An archive with a pickled object in it is refused, and the object does not run."""

    class Trap:
        def __reduce__(self):
            return (os.mkdir, (str(tmp_path / "executed"),))

    file = tmp_path / "state.npz"
    np.savez(file, header=np.array([Trap()], dtype=object), history=np.zeros(1))
    with pytest.raises(cd.CheckpointError, match="damaged"):
        cd.solve(scene, "chord", checkpoint=file, resume=True)
    assert not (tmp_path / "executed").exists()


def test_numbers_that_are_none(scene, tmp_path):
    """A file whose arrays were changed to NaN is refused even though it can be read."""
    file = tmp_path / "state.npz"
    cd.solve(scene, "chord", checkpoint=file, callback=lambda record: record.iteration == 3)
    with np.load(file) as content:
        arrays = dict(content)
    assert json.loads(arrays["header"].tobytes())["format"] == "contactdd checkpoint"
    arrays["gaps 0"] = np.full_like(arrays["gaps 0"], np.nan)
    np.savez(file, **arrays)
    with pytest.raises(cd.CheckpointError, match="gaps 0"):
        cd.solve(scene, "chord", checkpoint=file, resume=True)


def test_another_scene_is_refused(scene, tmp_path):
    """A state that belongs to other loads, gaps, layers or materials must not pass for a solution of these."""
    file = tmp_path / "state.npz"
    load, depth = cd.Parameter(10.0), cd.Parameter(1.0)

    def blocks(modulus: float = 2.1e5, softness: float = 4e-6) -> cd.Scene:
        bodies = [
            cd.Body(
                name,
                cd.rectangle((0, y), (2, y + 1), (4, 2)),
                cd.Isotropic(modulus, 0.3),
                supports=[cd.Symmetry("left", side) if side == "bottom" else cd.Symmetry("left")],
                loads=[] if side == "bottom" else [cd.Pressure(side, load)],
            )
            for name, y, side in (("lower", 0, "bottom"), ("upper", 1, "top"))
        ]
        gap = depth.field(lambda value, x: 1e-4 * value * x[0])
        layer = cd.PowerLayer(B=softness, a=1.1)
        return cd.Scene(bodies, [cd.Contact((bodies[0], "top"), (bodies[1], "bottom"), layer, gap=gap)])

    same = blocks()
    right = cd.solve(same, checkpoint=file).contact().pressure
    again = cd.solve(blocks(), checkpoint=file, resume=True)
    assert again.iterations == len(again.history)
    np.testing.assert_array_equal(again.contact().pressure, right)
    for other, what in ((blocks(modulus=1e5), "materials"), (blocks(softness=5e-6), "layers")):
        with pytest.raises(cd.CheckpointError, match=f"made with other {what}"):
            cd.solve(other, checkpoint=file, resume=True)
    depth.value = 2.0
    with pytest.raises(cd.CheckpointError, match="made with other geometry or gaps"):
        cd.solve(same, checkpoint=file, resume=True)
    depth.value, load.value = 1.0, 11.0
    with pytest.raises(cd.CheckpointError, match="made with other loads"):
        cd.solve(same, checkpoint=file, resume=True)


def test_fewer_iterations_than_are_done(scene, tmp_path):
    file = tmp_path / "state.npz"
    cd.solve(scene, "chord", checkpoint=file, callback=lambda record: record.iteration == 8)
    resumed = cd.solve(scene, "chord", checkpoint=file, resume=True, max_iterations=5, on_failure="return")
    assert resumed.status == "iteration limit"
    assert resumed.iterations == 8
