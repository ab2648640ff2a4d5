# %% [markdown]
# # A grooved block in space: tetrahedra against hexahedra that do not match
#
# The paper's groove again, as a solid: a block of 4 × 1 × 1 cm with a groove along
# $y$ cut into its top lies under another block, and pressures of $q = 10$ MPa press
# them together. This time the groove is not a function $d(x)$ but is in the mesh,
# and the gap is measured between the two meshes along the normals. The lower mesh
# is made of curved tetrahedra by gmsh, the upper one of hexahedra, so that no node
# meets a node.
#
# ## Integrating over two meshes
#
# The virtual work of the contact,
#
# $$\int_{S} g^-(z)\,(v_{1n} + v_{2n})\,dS, \qquad z = d - u_{1n} - u_{2n} ,$$
#
# needs $u_{1n}$ and $u_{2n}$ at the same place. Evaluated at Gauss points of one
# mesh's facets, the other side's kinks fall inside of them, and a constant pressure
# is not reproduced. So the facets of both sides are cut against each other, and the
# integral runs over the pieces, on which both are smooth: the common refinement. It
# treats both bodies alike and passes the patch test to rounding.
#
# ## Two scenes, one of them with a known answer
#
# Between smooth walls on all four sides, $u_n = 0$ on left, right, front and back,
# nothing depends on $y$: strain there is plane, and the semi-analytic reference of
# the plane problem is the answer of the solid one too. Each section must show the
# same open width and the same pressure.
#
# With the wall at the back taken away the bodies may expand there, the stress
# $\sigma_{yy}$ vanishes at the free face, and the material behaves as in plane
# stress: softer, with $E$ in the place of $E/(1-\nu^2)$. The groove must close
# further at the back than at the front, where the wall still is.

# %%
import numpy as np
from studies.results import MESHES, Report

import contactdd as cd

report = Report("grooved_block_3d", "a grooved block under another one in space, between walls and with a free back")

# %% [markdown]
# ## The scenes
#
# cm and MPa. Displacements of degree 2. The gmsh script takes its dimensions as
# parameters; its surfaces are named there. `Symmetry` on a wall keeps $u_n = 0$ and
# lets the body slide along it. Both blocks float: only the contact holds them
# against each other.

# %%
LENGTH, HEIGHT, WIDTH, LOAD, SIZE = 4.0, 1.0, 1.0, 10.0, 0.25
steel, layer = cd.Isotropic(E=2.1e5, nu=0.3), cd.PowerLayer(B=4e-6, a=1.1)
script = MESHES / "grooved_block.geo"
lower_mesh = cd.read_gmsh(script, dim=3, size=SIZE, width=WIDTH, length=LENGTH, height=HEIGHT, order=2)
cells = (round(0.8 * LENGTH / SIZE), round(0.8 * WIDTH / SIZE), round(0.5 * HEIGHT / SIZE))
upper_mesh = cd.box((0, 0, HEIGHT), (LENGTH, WIDTH, 2 * HEIGHT), cells, shape="hexahedron")


def between(*walls):
    """Both blocks between those walls."""
    held = [cd.Symmetry(*walls)]
    lower = cd.Body("lower", lower_mesh, steel, supports=held, loads=[cd.Pressure("bottom", LOAD)], degree=2)
    upper = cd.Body("upper", upper_mesh, steel, supports=held, loads=[cd.Pressure("top", LOAD)], degree=2)
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), layer)])


# %% [markdown]
# ## The solutions
#
# A solid of this size is condensed to its contact surface like a plane body; above
# 60 000 unknowns per body `solve` takes multigrid instead, which factors nothing.
#
# The open width of a section is the open area of a slice divided by its thickness:
# near the front, $y < 1/4$, and near the back, $y > 3/4$.

# %%
scene = between("left", "right", "front", "back")
held = cd.solve(scene)
free = cd.solve(between("left", "right", "front"))


def open_width(result, low, high):
    """The mean width of the open groove between the sections y = low and y = high."""
    there = (result.x[:, 1] > low) & (result.x[:, 1] < high)
    return float(result.weights[there & ~result.closed].sum() / (high - low))


exact = cd.reference.groove()
numbers = {"reference_edge": exact.contact_edge, "reference_peak": exact.peak_pressure}
for name, solution in (("held", held), ("free", free)):
    result = solution.contact()
    numbers[name] = {
        "force": result.force,
        "peak_pressure": float(result.pressure.max()),
        "open_front": open_width(result, 0.0, 0.25 * WIDTH),
        "open_back": open_width(result, 0.75 * WIDTH, WIDTH),
        "iterations": solution.iterations,
        "imbalance": solution.imbalance,
    }
    print(f"{name} at the back: {solution}")
    print("  open width at the front {open_front:.4f}, at the back {open_back:.4f}\n".format(**numbers[name]))
result = held.contact()
error = result.pressure - exact.pressure(result.x[:, 0])
numbers["error_l2"] = float(np.sqrt(result.weights @ error**2 / (LOAD**2 * LENGTH * WIDTH)))
print(f"plane reference: open width {exact.contact_edge:.4f}, peak {exact.peak_pressure:.3f}")
print(f"pressure of the held blocks against it: {numbers['error_l2']:.2e} of the load in the mean square")

# %% [markdown]
# ## Pictures
#
# Of the blocks with the free back: the pressure over the contact, and the vertical
# stress. The edge of contact bends where the material gives way.

# %%
free.plot_contact(path=report.path("contact.png"))
free.plot_bodies(component="zz", path=report.path("bodies.png"))
report.summary(numbers)

# %% [markdown]
# ## What must hold
#
# Between walls: the plane reference, as well as quadratic elements of this size can
# follow the kink of $p$ at the edge of contact; the points tell the edge to about a
# third of a facet. With the free back: a groove that is narrower there, by more
# than that, and unchanged at the front. In both the contact carries the load.

# %%
widths = [numbers[name][where] for name in ("held", "free") for where in ("open_front", "open_back")]
assert np.allclose(widths[:3], exact.contact_edge, atol=0.02)
assert widths[3] < widths[1] - 0.02
assert numbers["error_l2"] < 0.015
for solution in (held, free):
    assert abs(solution.contact().force / (LOAD * LENGTH * WIDTH) - 1) < 1e-7
