# %% [markdown]
# # Coming from FEniCSx: your meshes, tags, forms, Constants and Functions
#
# Someone has dolfinx meshes with cell and facet tags, a load as a UFL form with a Constant, and a motion as a Function.
# All that goes into a scene as it is, and the solution comes back as Functions on the same meshes. The
# [demo](../demos/own_fenicsx.py) has the same at length, with output of one's own beside the export.
#
# A column of two materials, its lower half soft, stands on a ground that is lifted by a Function $u_0$; a block is
# pressed on it with $q$, an own form $l(v) = -\int q\,v_y\,ds$. Between walls all fields are uniform: with
# $M = E(1-\nu)/((1+\nu)(1-2\nu))$ and a layer $k$ the lid comes down by
#
# $$ -u_y = q \left( \frac{1/2}{M_1} + \frac{1/2}{M_2} + \frac1k + \frac1{M_2} \right) - u_0 . $$

# %%
import contactdd as cd  # first: it finds the libraries of dolfinx' wheel, where that is installed

# isort: split
import numpy as np
import ufl
from dolfinx import fem
from dolfinx import mesh as dmesh
from mpi4py import MPI


def tagged(domain, dim, *places):
    """The tags 1, 2, ... of the cells or outer facets whose middles lie at the places, 9 elsewhere."""
    domain.topology.create_connectivity(dim, 2)
    cells = np.arange(domain.topology.index_map(2).size_local, dtype=np.int32)
    entities = cells if dim == 2 else dmesh.exterior_facet_indices(domain.topology)
    x = dmesh.compute_midpoints(domain, dim, entities).T
    tags = np.select([place(x) for place in places], range(1, len(places) + 1), 9)
    return dmesh.meshtags(domain, dim, entities, tags.astype(np.int32))


column = dmesh.create_rectangle(MPI.COMM_SELF, [(0.0, 0.0), (2.0, 1.0)], (8, 4))
block = dmesh.create_rectangle(MPI.COMM_SELF, [(0.0, 1.0), (2.0, 2.0)], (6, 3), dmesh.CellType.quadrilateral)
parts = tagged(column, 2, lambda x: x[1] < 0.5)
at = [lambda x, y=y: np.isclose(x[1], y) for y in range(3)]
sides = [tagged(column, 1, *at[:2]), tagged(block, 1, *at[1:])]
q, v = fem.Constant(block, 10.0), ufl.TestFunction(fem.functionspace(block, ("Lagrange", 1, (2,))))
load = -q * v[1] * ufl.Measure("ds", domain=block, subdomain_data=sides[1])(2)
lifted = fem.Function(fem.functionspace(column, ("Lagrange", 1, (2,))))
lifted.interpolate(lambda x: np.stack([0 * x[0], 1e-4 + 0 * x[0]]))

# %% [markdown]
# That is what there is; now the scene.

# %%
names = {"bottom": 1, "top": 2, "walls": 9}
low = cd.from_dolfinx(column, sides[0], names=names, cell_tags=parts, subdomains={"soft": 1, "hard": 9})
high = cd.from_dolfinx(block, sides[1], names=names)
soft, hard, k = cd.Isotropic(E=5e3, nu=0.4), cd.Isotropic(E=2.1e5, nu=0.3), 1e5
walls, ground = cd.Displacement("walls", (0, None)), cd.Displacement("bottom", lifted)
lower = cd.Body("column", low, {"soft": soft, "hard": hard}, supports=[walls, ground])
upper = cd.Body("block", high, hard, supports=[walls], loads=[cd.LinearForm(load)])
scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.LinearLayer(k))])
M1, M2 = soft.stiffness()[0, 0], hard.stiffness()[0, 0]
for q.value in (10.0, 30.0):  # the second solve sees the new value; nothing is factored again
    u = cd.solve(scene).displacement("block")  # a Function on the user's mesh
    top = fem.assemble_scalar(fem.form(u[1] * ufl.Measure("ds", domain=block, subdomain_data=sides[1])(2))) / 2
    exact = 1e-4 - q.value * (0.5 / M1 + 0.5 / M2 + 1 / k + 1 / M2)
    print(f"q = {q.value}: the lid moves by {top:.9f}, exact {exact:.9f}")
    assert abs(top / exact - 1) < 1e-7  # linear elements have linear fields; the solve's residual is 1e-10
