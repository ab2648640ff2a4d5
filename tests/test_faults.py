"""A handful of the random faults of `faults.py`; each is a real process to which something happens."""

from __future__ import annotations

import os
import shutil
import signal
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import contactdd as cd

sys.path.insert(0, str(Path(__file__).parent))

import faults


@pytest.mark.parametrize("name", ["kill -9", "SIGTERM", "SIGINT", "full disk", "two writers"])
def test_nothing_is_lost(name):
    faults.run(name, seed=7)


@pytest.mark.parametrize("name", ["exception on a rank", "kill -9 of a rank", "SIGTERM to mpirun"])
def test_nothing_is_lost_on_two_ranks(name):
    faults.run(name, seed=7)


@pytest.fixture(scope="module")
def scene() -> cd.Scene:
    return faults.scene()


def stopped(scene: cd.Scene, file: Path, method: str = "chord", at: int = 3) -> cd.Solution:
    return cd.solve(scene, method, checkpoint=file, callback=lambda record: record.iteration == at)


def test_what_is_no_checkpoint_stays(scene, tmp_path):
    """The run is kept beside it, under the same name every time, and goes on from there."""
    thesis = tmp_path / "thesis.tex"
    thesis.write_text("precious")
    for _ in range(2):
        with pytest.warns(RuntimeWarning, match="thesis.tex': it is no checkpoint.*thesis-2.tex"):
            stopped(scene, thesis)
    assert thesis.read_text() == "precious"
    assert sorted(tmp_path.iterdir()) == [tmp_path / "thesis-2.tex", thesis]
    whole = cd.solve(scene, "chord")
    assert cd.solve(scene, "chord", checkpoint=tmp_path / "thesis-2.tex", resume=True).iterations == whole.iterations
    with pytest.raises(cd.CheckpointError, match="not a checkpoint"):
        cd.solve(scene, "chord", checkpoint=thesis, resume=True)


def test_a_checkpoint_of_another_method_or_of_other_bodies_stays(scene, tmp_path):
    file = tmp_path / "state.npz"
    stopped(scene, file)
    before = file.read_bytes()
    with pytest.warns(RuntimeWarning, match="another run .other method.*state-2.npz"):
        stopped(scene, file, "one-point")
    lower, upper = scene.bodies
    finer = cd.Body("lower", cd.rectangle((0, 0), (4, 1), (20, 8)), lower.material, supports=lower.supports)
    other = cd.Scene([finer, upper], [cd.Contact((finer, "top"), (upper, "bottom"), scene.contacts[0].layer)])
    with pytest.warns(RuntimeWarning, match="another run .other bodies and contacts.*state-3.npz"):
        stopped(other, file)
    assert file.read_bytes() == before


def test_the_same_run_anew_and_an_empty_file_are_written_over(scene, tmp_path, recwarn):
    file = tmp_path / "state.npz"
    file.touch()
    for at in (5, 3):
        stopped(scene, file, at=at)
        assert faults.kept(file) == at
    assert not recwarn.list


def test_a_link_stays_one(scene, tmp_path):
    (tmp_path / "far").mkdir()
    link = tmp_path / "state.npz"
    link.symlink_to(tmp_path / "far" / "away.npz")
    stopped(scene, link)
    assert link.is_symlink()
    assert faults.kept(tmp_path / "far" / "away.npz") == 3


def test_files_beside_it_of_the_users_stay(scene, tmp_path):
    """A lock, or an unfinished file, of somebody else: neither is written, followed or removed."""
    file, victim = tmp_path / "state.npz", tmp_path / "victim"
    victim.write_text("precious")
    (tmp_path / "state.npz.part").symlink_to(victim)
    (tmp_path / "state.npz.lock").write_text("locked by another program")
    (tmp_path / "state.npz.9-abcdef01.part").write_text("of a run that was killed")
    stopped(scene, file)
    assert victim.read_text() == "precious"
    assert (tmp_path / "state.npz.lock").read_text() == "locked by another program"
    assert sorted(other.name for other in tmp_path.iterdir()) == [
        "state.npz",
        "state.npz.lock",
        "state.npz.part",
        "victim",
    ]


def test_a_folder_that_vanishes_does_not_take_the_run_with_it(scene, tmp_path):
    folder = tmp_path / "gone"
    folder.mkdir()

    def remove(record):
        if record.iteration == 3:
            shutil.rmtree(folder)

    with pytest.warns(RuntimeWarning) as told:
        found = cd.solve(scene, "chord", checkpoint=folder / "state.npz", checkpoint_every=1e-9, callback=remove)
    assert found.converged
    words = [str(each.message) for each in told]
    assert len(words) == 2
    assert "not written" in words[0]
    assert "the state after" in words[1]


def test_a_law_that_fails_leaves_the_state_before(scene, tmp_path):
    """The forces in a checkpoint are those that were found: a law that has begun to raise is not asked again."""
    file, broken = tmp_path / "state.npz", []

    def law(w):
        if broken:
            raise ZeroDivisionError("the law")
        return 1e5 * w

    def callback(record):
        if record.iteration == 4:
            broken.append(True)

    layer = cd.CustomLayer(law, compression_range=1e-3)
    with pytest.raises(ZeroDivisionError, match="the law"):
        cd.solve(scene.with_layer(layer), "chord", checkpoint=file, callback=callback)
    broken.clear()
    whole = cd.solve(scene.with_layer(layer), "chord")
    resumed = cd.solve(scene.with_layer(layer), "chord", checkpoint=file, resume=True)
    assert resumed.iterations == whole.iterations
    np.testing.assert_array_equal(resumed.contact().pressure, whole.contact().pressure)


def test_signals_of_the_users_are_left_alone(scene, tmp_path):
    """Who handles SIGTERM goes on doing so; and afterwards everything is as before."""
    heard = []
    before = signal.signal(signal.SIGTERM, lambda number, frame: heard.append(number))
    try:
        found = cd.solve(
            scene,
            "chord",
            checkpoint=tmp_path / "state.npz",
            callback=lambda record: os.kill(os.getpid(), signal.SIGTERM) if record.iteration == 3 else None,
        )
    finally:
        signal.signal(signal.SIGTERM, before)
    assert found.converged
    assert heard == [signal.SIGTERM]
    threads = threading.active_count()
    handlers = [signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT)]
    stopped(scene, tmp_path / "state.npz")
    assert [signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT)] == handlers
    assert threading.active_count() == threads


def test_a_solve_in_a_thread_keeps_its_state_too(scene, tmp_path):
    """Signals are for the main thread; elsewhere the file is written all the same."""
    file = tmp_path / "state.npz"
    thread = threading.Thread(target=stopped, args=(scene, file))
    thread.start()
    thread.join()
    assert faults.kept(file) == 3
