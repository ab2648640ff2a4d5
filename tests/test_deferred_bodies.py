"""Bodies that only their owners make: the same answer on 1, 2, 4 ranks, and on each rank no more than it holds."""

from __future__ import annotations

import numpy as np
import pytest
from test_ranks import all_ranks_say, launch

import contactdd as cd

SCENE = """
import sys
import numpy as np
from mpi4py import MPI
import contactdd as cd

comm = MPI.COMM_WORLD
load, made = cd.Parameter(10.0), []
stiff = cd.Isotropic(E=lambda x: 2.1e5 * (1 + 0.2 * x[0]), nu=0.3)  # of another value at every point

def block(i, deferred=True, **options):
    def make():
        made.append(i)
        mesh = cd.box((0, 0, i), (2, 1, i + 1), (5 + i, 3, 3), shape="hexahedron" if i == 1 else "tetrahedron")
        supports = [cd.Symmetry("left", "front"), *([cd.Displacement("bottom", (None, None, 1e-4))] if i == 0 else [])]
        loads = [cd.Pressure("top", load)] if i == 3 else [cd.ThermalStrain(1e-6, 20.0)] if i == 2 else []
        return cd.Body(f"block {i}", mesh, stiff if i == 1 else cd.Isotropic(2.1e5 + i, 0.3), supports=supports,
                       loads=loads, degree=1 + (i == 2), **options)
    return cd.DeferredBody(f"block {i}", make, work=1.0 + i) if deferred else make()

def bump(x):
    return 2e-4 * ((x[0] - 1) ** 2 + x[1] ** 2)

def stack(bodies, layer=cd.PowerLayer(B=4e-6, a=1.1)):
    contacts = [cd.Contact((a, "top"), (b, "bottom"), layer, gap=bump) for a, b in zip(bodies, bodies[1:])]
    return cd.Scene(bodies, contacts, comm=comm)
"""

SOLVE = """
results = {}
def keep(key, solution):
    for i in range(3):
        results[f"{key} pressure {i}"] = solution.contact(i).pressure
        results[f"{key} fine gap {i}"] = solution.contact(i, degree=6).gap
        results[f"{key} surface {i}"] = solution.contact_surface(i, second=True).displacement
    numbers = [solution.energy, solution.elastic_energy(), solution.elastic_energy("block 2"), solution.largest_strain]
    results[f"{key} numbers"] = numbers
    results[f"{key} forces"] = np.array([solution.forces(f"block {i}")["contact"] for i in range(4)])
    results[f"{key} stress"] = solution.body("block 1").stress
    results[f"{key} point"] = solution.displacement_at("block 3", [[1.0, 0.5, 3.5]])
    assert solution.residual < 1e-9 and solution.imbalance < 1e-9

scene = stack([block(i) for i in range(4)])
owned = [i for i in range(4) if scene.ranks.owns(i)]
assert made == owned, (made, owned)
ways = {"condensed": "auto", "multigrid": "auto", "assembled": "newton-krylov"}
for solver, method in ways.items():
    load.value = 10.0
    solution = cd.solve(scene, method, local_solver=solver, tolerance=1e-12)
    keep(solver, solution)
    load.value = 20.0
    keep(solver + " again", cd.solve(scene, method, local_solver=solver, tolerance=1e-12, start=solution))
solution.save(sys.argv[1] + "/saved")
files = solution.export(sys.argv[1] + "/exported")
results["files"] = sorted(str(file).rpartition("/")[2] for file in files)
assert made == owned
if comm.rank == 0:
    np.savez(sys.argv[1] + "/result.npz", **results)
"""


def solved(ranks, folder, code=SCENE + SOLVE):
    done = launch(ranks, code, str(folder))
    assert done.returncode == 0, done.stderr
    with np.load(folder / "result.npz") as content:
        return dict(content)


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    folder = tmp_path_factory.mktemp("alone")
    return solved(1, folder), cd.load_solution(folder / "saved")


@pytest.mark.parametrize("ranks", [2, 4])
def test_same_answer_on_several_ranks(alone, ranks, tmp_path):
    """Pressures, gaps, forces, energies, stresses and files; 1e-10 is what is asked for, of the largest value."""
    found = solved(ranks, tmp_path)
    for key, expected in alone[0].items():
        if expected.dtype.kind == "U":
            assert found[key].tolist() == expected.tolist()
        else:
            np.testing.assert_allclose(found[key], expected, rtol=0, atol=1e-10 * np.abs(expected).max(), err_msg=key)
    saved = cd.load_solution(tmp_path / "saved")
    for one, other in zip(alone[1].bodies, saved.bodies, strict=True):
        np.testing.assert_allclose(other.stress, one.stress, rtol=0, atol=1e-10 * np.abs(one.stress).max())


FEATURES = """
import sys
import numpy as np
from mpi4py import MPI
import contactdd as cd

comm, load, folder = MPI.COMM_WORLD, cd.Parameter(5.0), sys.argv[1]

def disc():
    mesh = cd.rectangle((0, 0), (1, 1), (6, 4), shape="quadrilateral")
    x = mesh.domain.geometry.x
    x[:, 1] += 0.05 * x[:, 0] ** 2 * x[:, 1]
    return cd.Body("disc", cd.Mesh(mesh.domain, mesh.surfaces), cd.Isotropic(2e3, 0.3), kinematics="axisymmetric",
                   supports=[cd.Symmetry("left")], loads=[cd.Pressure("top", load)], degree=2)

def floor():
    return cd.Body("floor", cd.rectangle((0, -1), (1.3, 0), (9, 5)), cd.Isotropic(3e3, 0.2), kinematics="axisymmetric",
                   supports=[cd.Symmetry("left"), cd.Spring("bottom", 1e5)], local_solver=cd.LOCAL_SOLVERS["condensed"])

disc, floor = cd.DeferredBody("disc", disc), cd.DeferredBody("floor", floor)
die = cd.RigidBody("die", cd.Plane((0, -1), (0, 1)), kinematics="axisymmetric")
bonds = cd.Contact((floor, "bottom"), die, cd.LinearLayer(1e5))
def gap(x):
    return 0.01 * x[0] ** 2

def scene(layer):
    pressed = cd.Contact((disc, "bottom"), (floor, "top"), layer, gap=gap)
    return cd.Scene([disc, floor, die], [pressed, bonds], comm=comm)

results = {}
soft = scene(cd.LinearLayer(1e4))
path = cd.programme(soft, load, [5.0, 10.0], record={"force": lambda s: s.contact().force}, tolerance=1e-12)
results["forces"] = path.records["force"]
path.export(folder + "/series")
for name, each in {
    "hard": scene(cd.HardContact()), "stiffer": soft.with_layer(cd.PowerLayer(1e-5, 0.7)),
    "bonded": scene(cd.BondedLayer(cd.LinearLayer(1e4), shear_stiffness=2e3)),
}.items():
    solution = cd.solve(each, tolerance=1e-11)
    results[name] = solution.contact(0).pressure
    results[name + " shift"] = solution.contact_surface(bonds).displacement
    results[name + " stiffness"] = solution.normal_stiffness(bonds)  # beside the spring
kept = dict(checkpoint=folder + "/state.npz", on_failure="return", gamma=0.6, max_iterations=int(sys.argv[2]))
results["went on"] = cd.solve(soft, "chord", resume=True, **kept).contact(0).pressure
if comm.rank == 0:
    np.savez(folder + "/result.npz", **results)
"""


def test_what_else_a_scene_may_hold(tmp_path):
    """Curved rings, springs, own solvers, rigid bodies, hard contact, bonds, programmes; what one number of ranks kept
    another goes on with."""
    found, files = {}, {}
    for ranks in (1, 2):
        folder = tmp_path / str(ranks)
        folder.mkdir()
        for count, iterations in ((3 - ranks, 10), (ranks, 20)):
            done = launch(count, FEATURES, str(folder), str(iterations))
            assert done.returncode == 0, done.stderr
        with np.load(folder / "result.npz") as content:
            found[ranks] = dict(content)
        files[ranks] = sorted(path.name for path in (folder / "series").iterdir())
    for key, expected in found[1].items():
        np.testing.assert_allclose(found[2][key], expected, rtol=0, atol=1e-10 * np.abs(expected).max(), err_msg=key)
    assert files[1] == files[2]


FAULTS = {
    "a body that cannot be made": (
        "assert comm.rank == 0, 'no such mesh'",
        "cd.solve(stack([low, high]))",
        "AssertionError: no such mesh",
    ),
    "a body of another name": ("name = 'other'", "stack([low, high])", "gives a body of the name 'other'"),
    "a surface that it has not": ("", "stack([low, high], 'side')", "the mesh has no surface of that name"),
    "supports that contradict": (
        "supports.append(cd.Displacement('left', (1.0, None)))",
        "stack([low, high])",
        "prescribe different displacements",
    ),
    "a field on another rank": (
        "",
        "cd.solve(stack([low, high])).displacement('high' if comm.rank else 'low')",
        "holds its field",
    ),
    "an estimate of the error": ("", "cd.error_estimate(cd.solve(stack([low, high])))", "is deferred"),
    "a finer mesh": ("", "stack([low, high]).refined()", "is deferred"),
}

FAULT = """
from mpi4py import MPI
import contactdd as cd

comm = MPI.COMM_WORLD

def deferred(own, y):
    def make():
        name, supports = own, [cd.Symmetry("left", "right"), *([cd.Fixed("bottom")] if y == 0 else [])]
        {change}
        loads = [cd.Pressure("top", 1.0)] if y else []
        return cd.Body(name, cd.rectangle((0, y), (2, y + 1), (3, 2)), cd.Isotropic(1e3, 0.3), supports=supports,
                       loads=loads)
    return cd.DeferredBody(own, make)

def stack(bodies, top="top"):
    return cd.Scene(bodies, [cd.Contact((low, top), (high, "bottom"), cd.LinearLayer(1e3))], comm=comm)

low, high = deferred("low", 0), deferred("high", 1)
try:
    {asked}
except BaseException as error:
    print("rank", comm.rank, "says", type(error).__name__ + ":", error, flush=True)
    raise SystemExit(3)
"""


@pytest.mark.parametrize("what", FAULTS)
def test_all_ranks_end_with_the_same_words(what):
    change, asked, message = FAULTS[what]
    done = launch(2, FAULT.replace("{change}", change).replace("{asked}", asked), timeout=60)
    all_ranks_say(done, message)


def test_arguments_are_refused():
    with pytest.raises(TypeError, match="expected a text"):
        cd.DeferredBody("", lambda: None)
    with pytest.raises(TypeError, match="expected a function"):
        cd.DeferredBody("a", "mesh.msh")
    with pytest.raises(ValueError, match="work = 0"):
        cd.DeferredBody("a", lambda: None, work=0)
    with pytest.raises(TypeError, match=r"expected a cd\.Body"):
        cd.DeferredBody("a", lambda: None).made()
    deferred, other = cd.DeferredBody("a", lambda: None), cd.DeferredBody("b", lambda: None)
    contact = cd.Contact((deferred, "top"), (other, "bottom"), cd.LinearLayer(1.0))
    with pytest.raises(ValueError, match="body 'b' is not in the scene"):
        cd.Scene([deferred, cd.DeferredBody("c", lambda: None)], [contact])
