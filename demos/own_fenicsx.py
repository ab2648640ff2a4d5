# %% [markdown]
# # Coming from FEniCSx: your meshes, tags, forms and functions
#
# Someone has a FEniCSx code: dolfinx meshes with cell and facet tags, loads as UFL forms,
# fields as Functions, Constants that change from solve to solve, and output of their own.
# This page brings all that into a scene, solves it, and takes the solution back into
# dolfinx. Nothing is written to files in between.
#
# ## The problem
#
# A machine's foot presses a pad of rubber with a steel plate on it. The ground under the
# pad has settled by a slope that was measured. Contact between plate and foot is rough,
# $p = (w/B)^{1/a}$. In every body
#
# $$a(u, v) = \int \sigma(u) : \varepsilon(v)\,dx, \qquad
#   l(v) = -\int_{\Gamma_{top}} q\, n\cdot v\,ds - \int \varrho g\, v_y\,dx, \qquad
#   u = u_0 \text{ on the ground},$$
#
# with $E$, $\nu$ by cells, $l$ the user's own form with the Constant $q$, and $u_0$ the
# user's Function. What is known beforehand: the contact carries $F = \int q\,ds + \int
# \varrho g\,dx$ of the foot, whatever the slope, and so does the ground, with the weight
# of pad and plate, here neglected.

# %%
import contactdd as cd  # first: it finds the libraries of dolfinx' wheel, where that is installed

# isort: split
import dolfinx.io
import matplotlib.pyplot as plt
import numpy as np
import ufl
from dolfinx import fem
from dolfinx import mesh as dmesh
from mpi4py import MPI
from studies.results import Report

report = Report(__file__, "A scene from dolfinx' meshes, tags, forms and functions")

# %% [markdown]
# ## What is there already
#
# Meshes belong to `MPI.COMM_SELF`: every rank has them whole, and the ranks of a scene
# share its bodies. Lengths are in mm, stresses in MPa, forces in N per mm of thickness.
# The pad is 40 wide and 20 high, its lower half rubber (tag 3), its upper one steel
# (tag 7). Facets have the tags 1 (ground), 2 (top) and 4 (sides).


# %%
def tagged_facets(domain, floor, ceiling):
    """The tags 1 below, 2 above and 4 at the sides, as a mesh generator would give them."""
    domain.topology.create_connectivity(1, 2)
    facets = dmesh.exterior_facet_indices(domain.topology)
    y = dmesh.compute_midpoints(domain, 1, facets)[:, 1]
    values = np.where(np.isclose(y, floor), 1, np.where(np.isclose(y, ceiling), 2, 4)).astype(np.int32)
    return dmesh.meshtags(domain, 1, facets, values)


pad = dmesh.create_rectangle(MPI.COMM_SELF, [(0.0, 0.0), (40.0, 20.0)], (48, 24))
pad_facets = tagged_facets(pad, 0, 20)
cells = np.arange(pad.topology.index_map(2).size_local, dtype=np.int32)
middles = dmesh.compute_midpoints(pad, 2, cells)
pad_cells = dmesh.meshtags(pad, 2, cells, np.where(middles[:, 1] < 10, 3, 7).astype(np.int32))

foot = dmesh.create_rectangle(MPI.COMM_SELF, [(0.0, 20.0), (40.0, 50.0)], (40, 30), dmesh.CellType.quadrilateral)
foot_facets = tagged_facets(foot, 20, 50)

# %% [markdown]
# The load is a form with a test function from any space of vectors on the foot's mesh.
# `q` is a Constant. The settlement is a Function on the pad's mesh.

# %%
q = fem.Constant(foot, 0.5)
weight = fem.Constant(foot, 7.7e-5)
v = ufl.TestFunction(fem.functionspace(foot, ("Lagrange", 1, (2,))))
ds = ufl.Measure("ds", domain=foot, subdomain_data=foot_facets)
load = -q * ufl.dot(ufl.FacetNormal(foot), v) * ds(2) - weight * v[1] * ufl.dx

settled = fem.Function(fem.functionspace(pad, ("Lagrange", 1, (2,))))
settled.interpolate(lambda x: np.stack([0 * x[0], -5e-3 * x[0] / 40]))

# %% [markdown]
# ## The scene
#
# `cd.from_dolfinx` names the tags. A dictionary gives each named part of a mesh its
# material; `cd.Isotropic(E=E, nu=nu)` with Functions of one value in each cell would do
# the same. `cd.LinearForm` takes the form, `cd.Displacement` the Function.
#
# What belongs to another mesh than the body's is refused, and so is a mesh that is
# spread over ranks. A form may also be a function `(body, v) -> form`, which is asked
# again in elements of a higher degree or on a finer mesh: `cd.error_estimate` takes
# both, `cd.adapt`, which makes new meshes, only the function.

# %%
names = {"ground": 1, "top": 2, "sides": 4}
pad_mesh = cd.from_dolfinx(pad, pad_facets, names=names, cell_tags=pad_cells, subdomains={"rubber": 3, "steel": 7})
foot_mesh = cd.from_dolfinx(foot, foot_facets, names={"bottom": 1, "top": 2, "sides": 4})
steel = cd.Isotropic(E=2.1e5, nu=0.3)
lower = cd.Body(
    "pad",
    pad_mesh,
    {"rubber": cd.Isotropic(E=50.0, nu=0.45), "steel": steel},
    supports=[cd.Displacement("ground", settled)],
    degree=2,
)
walls = [cd.Displacement("sides", (0, None))]
upper = cd.Body("foot", foot_mesh, steel, supports=walls, loads=[cd.LinearForm(load)])
contact = cd.Contact((lower, "top"), (upper, "bottom"), cd.PowerLayer(B=1e-3, a=0.5))
scene = cd.Scene([lower, upper], [contact], comm=MPI.COMM_WORLD)

# %% [markdown]
# ## Solving, and solving again with another Constant
#
# The second solve sees that `q` has another value: loads are assembled anew, and nothing
# is factored again. A Constant or a Function in a *material* must not change, since the
# stiffness is made once; that is refused. `first` keeps the load that it was found with.
#
# A law that stiffens gives less and less: three times the load, $a = 1/2$, closes the
# rough surfaces by $\sqrt 3$ only, and the pressures' pattern changes with it.

# %%
first = cd.solve(scene)
q.value = 1.5
second = cd.solve(scene, start=first)
forces = [solution.contact().force for solution in (first, second)]
print("contact force:", ", ".join(f"{force:.6f} N/mm" for force in forces))

# %% [markdown]
# ## Back in dolfinx
#
# `solution.displacement` and `solution.stress` are Functions on the user's own meshes, for
# forms of their own: the vertical force on the ground, from the stresses, is near that of
# the contact (at the glued corners of the rubber stresses are infinite, and elements
# waver there). The sum of the nodal reactions, `solution.forces`, is exact.

# %%
stress, ground = second.stress("pad"), ufl.Measure("ds", domain=pad, subdomain_data=pad_facets)(1)
from_stress = -fem.assemble_scalar(fem.form(stress[1] * ground))
from_nodes = second.forces("pad")["supports"][1]
print(f"force on the ground: {from_stress:.3f} from stresses, {from_nodes:.6f} from nodes, N/mm")

# %% [markdown]
# The user's own output, here the size of the displacement as a field of dolfinx, stands
# beside what `solution.export` writes for ParaView: all bodies and the contact. The
# pictures show the stress in both bodies, their displacements ten times too large, and
# the pressures: the slope of the ground turns them, the rubber's free sides let the
# plate bend.

# %%
size = fem.Function(fem.functionspace(pad, ("Lagrange", 1)), name="own_field")
u = second.displacement("pad")
size.interpolate(fem.Expression(ufl.sqrt(ufl.dot(u, u)), cd.compat.expression_points(size.function_space.element)))
second.export(report.path("paraview"))
if MPI.COMM_WORLD.rank == 0:
    with dolfinx.io.XDMFFile(MPI.COMM_SELF, report.path("own_field.xdmf"), "w") as file:
        file.write_mesh(pad)
        file.write_function(size)
    figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
    for solution, told in ((first, "q = 0.5 MPa"), (second, "q = 1.5 MPa")):
        result = solution.contact()
        order = np.argsort(result.x[:, 0])
        axes.plot(result.x[order, 0], result.pressure[order], label=told)
    axes.set(xlabel="x, mm", ylabel="contact pressure, MPa", title="between plate and foot", ylim=(0, None))
    axes.legend()
    figure.savefig(report.path("pressures.png"), dpi=150)
    second.plot_bodies(component="yy", scale=10, limits=(-3, 0), path=report.path("bodies.png"))

# %% [markdown]
# ## What must hold
#
# The contact carries the form's load, 40 q and the weight of 40 × 30, to the residual of
# the solve. The ground carries the same. The first solution still balances its own load.

# %%
numbers = {"forces": forces, "from_stress": from_stress, "from_nodes": from_nodes, "imbalance": first.imbalance}
numbers["peaks"] = [solution.contact().peak_pressure for solution in (first, second)]
if MPI.COMM_WORLD.rank == 0:
    report.summary({name: np.asarray(value).tolist() for name, value in numbers.items()})
for force, pressure in zip(forces, (0.5, 1.5), strict=True):
    assert abs(force - (40 * pressure + 7.7e-5 * 40 * 30)) < 1e-6 * force
assert abs(from_nodes - forces[1]) < 1e-6 * forces[1]
assert abs(from_stress - forces[1]) < 0.05 * forces[1]
assert first.imbalance < 1e-8
