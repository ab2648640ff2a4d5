"""What is one's own on several ranks: heat, materials by parts, forms, coefficients, relaxations and orders."""

from __future__ import annotations

import numpy as np
from test_ranks import launch

CODE = """
import sys
import numpy as np
from mpi4py import MPI
import contactdd as cd
from scenes import LAYER, STEEL, block, groove, stack

comm = MPI.COMM_WORLD
rise = cd.Parameter(10.0)
form = cd.LinearForm(lambda body, v: body.elements.over_surface(-20.0 * v[1], "top"))
mesh = cd.rectangle((0, 1), (4, 2), (16, 8)).with_subdomains(left=lambda x: x[0] < 2, right=lambda x: x[0] > 2)
parts = {"left": STEEL, "right": cd.Isotropic(1e5, 0.2)}
bodies = [
    block("low", 0, (16, 8), supports=[cd.Fixed("bottom")], loads=[cd.ThermalStrain(12e-6, rise)]),
    cd.Body("middle", mesh, parts, supports=[cd.Symmetry("left", "right")]),
    block("high", 2, (12, 6), loads=[form, cd.PointForce([[2.0, 3.0]], (0.0, -1.0))]),
]
scene = stack(bodies, comm=comm)

def two_sided(layer, z, z_previous, x, sides):
    a, b = sides.moduli
    return np.array([[1 + a / b], [1 + b / a]]) * layer.divided_difference(z_previous, z)

def aitken(k, now):
    if now.previous is None:
        return 0.5
    change = now.correction - now.previous
    return abs(now.history[-1].gamma * (now.previous @ change) / (change @ change))

secant = lambda layer, z, old, x: layer.divided_difference(old, z)
ways = {
    "newton": ("auto", None),
    "rows": (cd.Scheme("rows", two_sided, "decomposed", ""), aitken),
    "order": (cd.Scheme("order", secant, "decomposed", "", order=[["low", "high"], "middle"]), 0.9),
}
results = {}
for name, (method, gamma) in ways.items():
    solution = cd.solve(scene, method, gamma=gamma, tolerance=1e-8, max_iterations=60, on_failure="return")
    results[name] = np.concatenate([solution.contact(i).pressure for i in range(2)])
    results[name + " numbers"] = [solution.elastic_energy("low"), solution.elastic_energy(), solution.iterations]
rise.value = 20.0
hot = cd.solve(scene)
results["stress"] = hot.stress("low").x.array
if comm.rank == 0:
    np.savez(sys.argv[1], **results)
"""


def test_the_same_on_two_ranks(tmp_path):
    """To rounding, which sixty iterations that need not have converged may enlarge to 1e-8."""
    found = {}
    for count in (1, 2):
        path = tmp_path / f"{count}.npz"
        done = launch(count, CODE, str(path))
        assert done.returncode == 0, done.stderr
        found[count] = np.load(path)
    for name in found[1]:
        one, several = found[1][name], found[2][name]
        np.testing.assert_allclose(several, one, rtol=0, atol=1e-8 * np.abs(one).max(), err_msg=name)
