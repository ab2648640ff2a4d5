# %% [markdown]
# # Coming from asimov-contact: both bodies in one dolfinx mesh
#
# There, and in many FEniCSx codes, all bodies are parts of one mesh that share no node, facet tags tell the surfaces,
# and pairs of tags the contacts, held by Nitsche's method or a penalty. Here each part is a body of its own:
# `mesh.pieces()` takes them apart, with those of the named surfaces that each has. A contact is one object for both
# sides, and what closes it is a law: `cd.HardContact()` is what Nitsche's method approximates, `cd.LinearLayer(k)` a
# penalty $k$ that is meant.
#
# Two blocks of heights $h_1, h_2$, on meshes that do not match, are pressed together by $\Delta$ between walls. With
# $M_i = E_i(1-\nu_i)/((1+\nu_i)(1-2\nu_i))$ and without a layer
#
# $$ p = \frac{\Delta}{h_1/M_1 + h_2/M_2} . $$

# %%
import numpy as np

import contactdd as cd

# isort: split
import basix.ufl
from dolfinx import mesh as dmesh
from mpi4py import MPI


def grid(y0, y1, nx, ny, first):
    """Nodes and quadrilaterals of a block 2 wide; first: the number of its first node."""
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(0, 2, nx + 1), np.linspace(y0, y1, ny + 1)))
    low = (np.arange(nx) + (nx + 1) * np.arange(ny)[:, None]).ravel() + first
    return np.column_stack([x, y]), np.column_stack([low, low + 1, low + nx + 1, low + nx + 2])


nodes, cells = zip(grid(0, 1, 8, 4, 0), grid(1, 3, 5, 5, 45), strict=True)
element = basix.ufl.element("Lagrange", "quadrilateral", 1, shape=(2,))
domain = dmesh.create_mesh(MPI.COMM_SELF, cells=np.vstack(cells), x=np.vstack(nodes), e=element)
domain.topology.create_connectivity(1, 2)
facets = dmesh.exterior_facet_indices(domain.topology)
x, y = dmesh.compute_midpoints(domain, 1, facets)[:, :2].T
owner = domain.topology.connectivity(1, 2).array[domain.topology.connectivity(1, 2).offsets[facets]]
upper = dmesh.compute_midpoints(domain, 2, owner.astype(np.int32))[:, 1] > 1
tags = np.select([np.isclose(y, 0), np.isclose(y, 3), ~np.isclose(y, 1), upper], [1, 4, 5, 3], 2).astype(np.int32)
facet_tags = dmesh.meshtags(domain, 1, facets, tags)

# %% [markdown]
# That is what there is; now the scene. The pieces are told by the surfaces that they have.

# %%
names = {"floor": 1, "lower face": 2, "upper face": 3, "lid": 4, "walls": 5}
pieces = {"floor" in each.surfaces: each for each in cd.from_dolfinx(domain, facet_tags, names=names).pieces()}
soft, hard, closing = cd.Isotropic(E=1e3, nu=0.3), cd.Isotropic(E=5e3, nu=0.2), 1e-3
walls = cd.Displacement("walls", (0.0, None))
low = cd.Body("low", pieces[True], soft, supports=[walls, cd.Fixed("floor")])
high = cd.Body("high", pieces[False], hard, supports=[walls, cd.Displacement("lid", (0.0, -closing))])
contact = cd.Contact((low, "lower face"), (high, "upper face"), cd.HardContact())
pressure = cd.solve(cd.Scene([low, high], [contact])).contact().pressure
exact = closing / (1 / soft.stiffness()[0, 0] + 2 / hard.stiffness()[0, 0])
print(f"p = {pressure.min():.9f} to {pressure.max():.9f}, exact {exact:.9f}")
assert np.allclose(pressure, exact, rtol=1e-6)
