"""Where one rank fails, or does something else than the others, all of them end with words, and none waits."""

from __future__ import annotations

import pickle

import pytest
from test_ranks import SCENE, all_ranks_say, launch

import contactdd as cd
from contactdd.base.ranks import _portable

#: What one rank does in the middle of a solve, and what all of them say then.
FAULTS = {
    "callback": (
        """
def callback(record):
    if comm.rank == 1 and record.iteration == 2:
        raise RuntimeError("a mistake in the callback")
cd.solve(scene, "chord", callback=callback)
""",
        "RuntimeError: a mistake in the callback",
    ),
    "an exit in the callback": (
        """
def callback(record):
    if comm.rank == 1 and record.iteration == 2:
        sys.exit("leave")
cd.solve(scene, "newton-krylov", callback=callback)
""",
        "leave",
    ),
    "layer, between the products with matrices that one rank holds": (
        """
calls = None  # until the layer's own checks are done: what fails before a solve the ranks cannot tell each other
def g(w):
    if calls is not None:
        calls.append(w)
        if comm.rank == 1 and len(calls) > 20:
            raise ZeroDivisionError("a mistake in the layer")
    return 2.5e6 * w
other = scene.with_layer(cd.CustomLayer(g, compression_range=1e-3))
calls = []
cd.solve(other, "chord", local_solver="assembled")
""",
        "ZeroDivisionError: a mistake in the layer",
    ),
    "gamma": (
        """
cd.solve(scene, "chord", gamma=lambda k: 0.6 if k < 3 or comm.rank == 0 else -1.0)
""",
        "ValueError: gamma = -1.0",
    ),
    "an argument": (
        """
cd.solve(scene, "chord", tolerance=1e-8 if comm.rank == 0 else -1)
""",
        "ValueError: tolerance = -1",
    ),
    "an error that cannot be sent": (
        """
class Mine(Exception):
    def __init__(self, one, two):
        super().__init__("mine alone")
def callback(record):
    if comm.rank == 1:
        raise Mine(1, 2)
cd.solve(scene, "chord", callback=callback)
""",
        "mine alone",
    ),
    "a record of a programme": (
        """
def record(solution):
    if comm.rank == 1 and load.value == 2.0:
        raise RuntimeError("a mistake in the record")
    return 0.0
cd.programme(scene, load, [1.0, 2.0, 3.0], record={"x": record})
""",
        "RuntimeError: a mistake in the record",
    ),
    "other values of a programme": (
        """
cd.programme(scene, load, [1.0, 2.0, 3.0][: 3 - comm.rank])
""",
        "values: their numbers on the ranks are [3, 2]",
    ),
    "method": (
        """
cd.solve(scene, "chord" if comm.rank == 0 else "newton")
""",
        "method: 'newton, direct' (first rank: 'chord, decomposed') on rank 1",
    ),
    "load": (
        """
load.value = 10.0 + comm.rank
cd.solve(scene)
""",
        "body 'block 0', Pressure 1, value 0: differs from that of the first rank on rank 1",
    ),
    "gap": (
        """
other = [cd.Contact((a, "top"), (b, "bottom"), LAYER, gap=lambda x: (1 + 1e-9 * comm.rank) * groove(x))
         for a, b in zip(bodies, bodies[1:])]
cd.solve(cd.Scene(bodies, other, comm=comm))
""",
        ", gap: differs from that of the first rank on rank 1",
    ),
    "law": (
        """
mine = cd.CustomLayer(lambda w: (1.0 + comm.rank) * 2.5e6 * w, compression_range=1e-3)
cd.solve(scene.with_layer(mine))
""",
        ", law of the layer: differs from that of the first rank on rank 1",
    ),
    "material": (
        """
steels = cd.Isotropic(2.1e5 + comm.rank, 0.3)
made = [cd.Body(b.name, b.mesh, steels, supports=b.supports, loads=b.loads) for b in bodies]
other = [cd.Contact((a, "top"), (b, "bottom"), LAYER, gap=groove) for a, b in zip(made, made[1:])]
cd.solve(cd.Scene(made, other, comm=comm))
""",
        "body 'block 0', material: differs",
    ),
    "bodies": (
        """
less = bodies[: 3 - comm.rank]
cd.Scene(less, scene.contacts[: len(less) - 1], comm=comm)
""",
        "expected the same scene on all",
    ),
}


@pytest.mark.parametrize("what", FAULTS)
def test_all_ranks_end_together(what):
    code, message = FAULTS[what]
    marked = "\n".join("    " + line for line in code.strip().splitlines())
    done = launch(2, f"{SCENE}\ntry:\n{marked}\nexcept BaseException as error:\n"
                     "    print('rank', comm.rank, 'says', type(error).__name__ + ':', error, flush=True)\n"
                     "    raise SystemExit(3)\n")  # fmt: skip
    all_ranks_say(done, message)


def test_ranks_go_on_after_an_error():
    """Who handles the error solves again, also when the fault was in a solve within a callback."""
    code = """
def inner(record):
    def fail(record):
        if comm.rank == 1:
            raise RuntimeError("inside")
    try:
        cd.solve(scene, "newton", callback=fail)
    except RuntimeError as error:
        caught.append(str(error))
    return record.iteration == 3

caught = []
stopped = cd.solve(scene, "chord", callback=inner)
assert stopped.status == "stopped" and caught == ["inside"] * 3
after = cd.solve(scene)
assert after.converged and comm.allgather(after.iterations) == [after.iterations] * 2

def outer(record):
    cd.solve(scene, "newton")
    if comm.rank == 1 and record.iteration == 2:
        raise RuntimeError("outside")
    cd.solve(scene, "newton")

try:
    cd.solve(scene, "chord", callback=outer)
except RuntimeError as error:
    caught.append(str(error))
assert caught[-1] == "outside" and cd.solve(scene).converged
"""
    done = launch(2, SCENE + code)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("solver", ["condensed", "assembled", "multigrid"])
def test_the_first_rank_writes_and_reads_alone(solver, tmp_path):
    """A checkpoint of matrices that one rank holds too: none waits for products that only one asks for."""
    code = f"""
options = dict(gamma=0.6, local_solver={solver!r}, max_iterations=12, on_failure="return")
whole = cd.solve(scene, "chord", **options)
options["checkpoint"] = sys.argv[1]
cd.solve(scene, "chord", **options, checkpoint_every=1e-9, callback=lambda r: r.iteration == 5)
resumed = cd.solve(scene, "chord", **options, resume=True)
assert resumed.iterations == whole.iterations == 12
assert abs(resumed.contact().pressure - whole.contact().pressure).max() == 0.0
"""
    done = launch(2, SCENE + code, str(tmp_path / "state.npz"))
    assert done.returncode == 0, done.stderr


def test_an_error_crosses_to_other_ranks_whole_or_in_words():
    loose = cd.LooseBodyError("a", "the rotation")
    assert str(pickle.loads(pickle.dumps(_portable(loose)))) == str(loose)

    class Local(Exception):
        pass

    told = _portable(Local("words"))
    assert type(told) is RuntimeError
    assert str(told) == "Local: words"
