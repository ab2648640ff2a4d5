"""Every kind of local solver is dealt out: a rank assembles the bodies that it holds and no others."""

from __future__ import annotations

import pytest
from test_ranks import launch

CODE = """
import sys
import numpy as np
from mpi4py import MPI
import contactdd as cd
from contactdd.local import stiffness

comm = MPI.COMM_WORLD
made = []
assemble = stiffness.stiffness_matrix
stiffness.stiffness_matrix = lambda body: (made.append(body.name), assemble(body))[1]

steel, layer = cd.Isotropic(E=2.1e5, nu=0.3), cd.PowerLayer(B=4e-6, a=1.1)
bodies = []
for i in range(4):
    loads = [cd.Pressure("top", 10.0)] if i == 3 else []
    supports = [cd.Symmetry("left", "right", *(["bottom"] if i == 0 else []))]
    mesh = cd.rectangle((0, i), (2, i + 1), (5 + i, 3))
    bodies.append(cd.Body(f"block {i}", mesh, steel, supports=supports, loads=loads))
contacts = [cd.Contact((a, "top"), (b, "bottom"), layer) for a, b in zip(bodies, bodies[1:])]
scene = cd.Scene(bodies, contacts, comm=comm)
solver, method = sys.argv[1:]
solution = cd.solve(scene, method, local_solver=solver, tolerance=1e-10)
# Every rank has the whole solution: a stack under an even pressure carries it everywhere.
for i in range(3):
    assert np.abs(solution.contact(i).pressure - 10.0).max() < 1e-6, solver
own = [body.name for i, body in enumerate(bodies) if scene.ranks.owns(i)]
assert set(made) == set(own), (comm.rank, made, own)
assert solution.residual < 1e-8
assert abs(solution.energy - comm.bcast(solution.energy)) < 1e-12 * abs(solution.energy)
"""


@pytest.mark.parametrize("method", ["auto", "chord"])
@pytest.mark.parametrize("solver", ["condensed", "assembled", "multigrid"])
def test_a_rank_assembles_its_own_bodies_only(solver, method):
    done = launch(2, CODE, solver, method)
    assert done.returncode == 0, done.stderr
