"""Bodies that only their owners make: the same answer on 1, 2, 4 ranks, and on each rank no more than it holds."""

from __future__ import annotations

import numpy as np
import pytest
from test_ranks import launch

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
