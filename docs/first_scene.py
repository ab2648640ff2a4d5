# %% [markdown]
# # A first scene in ten minutes
#
# A steel block with a shallow groove lies under another one, and both are pressed together. Where do they touch, and
# how hard? This page builds the scene step by step. Type along in `./run python3`, or run the whole page:
# `./run docs/first_scene.py`.
#
# ## Units
#
# There are none: any consistent set does. Here lengths are in cm and stresses in MPa, so forces per unit of thickness
# are in MPa cm.
#
# ## Meshes and surfaces
#
# A mesh has *named surfaces*; supports, loads and contacts refer to them. A rectangle has `left`, `right`, `bottom` and
# `top`. (Others: `cd.box`, `cd.read_mesh("part.inp")`, any dolfinx mesh by `cd.from_dolfinx`.)

# %%
import numpy as np

import contactdd as cd

mesh = cd.rectangle((0, 0), (4, 1), (32, 16))
mesh

# %% [markdown]
# ## Bodies
#
# A body is a mesh, a material, supports and loads. The sides are planes of symmetry; each block is pressed from outside
# with 10 MPa. Neither is held up or down: the contact has to do that.

# %%
steel = cd.Isotropic(E=2.1e5, nu=0.3)
sides = [cd.Symmetry("left", "right")]
lower = cd.Body("lower", mesh, steel, supports=sides, loads=[cd.Pressure("bottom", 10)])
upper = cd.Body("upper", mesh.moved((0, 1)), steel, supports=sides, loads=[cd.Pressure("top", 10)])
upper

# %% [markdown]
# ## The contact
#
# Two surfaces, a layer between them, and a gap. The layer is what makes contacts here differ from those of most
# programs: rough surfaces, coatings and gaskets compress by $w$ under the stress $\sigma_n = g(w)$, here
# $|w| = B\,p^a$. (`cd.HardContact()` is contact without a layer.) The gap is the groove, a function of the coordinates;
# to it comes the distance of the two meshes, zero here.


# %%
def groove(x):
    return 5e-4 * np.maximum(1 - x[0] ** 2, 0) ** 1.5


layer = cd.PowerLayer(B=4e-6, a=1.1)
contact = cd.Contact((lower, "top"), (upper, "bottom"), layer, gap=groove, name="joint")
scene = cd.Scene([lower, upper], [contact])

# %% [markdown]
# ## Solve
#
# The solution tells how it ended. A run that fails raises an error that says why; it never returns a wrong answer as a
# right one.

# %%
solution = cd.solve(scene)
solution

# %% [markdown]
# ## Look
#
# Pressure and gap along the contact, and the stress across the blocks, their displacements enlarged. With `path=...`
# both are saved, the first also as a vector picture (`.pdf`, `.svg`).

# %%
solution.plot_contact("joint", stress_unit="MPa", length_unit="cm")

# %%
solution.plot_bodies(component="yy", unit="MPa")

# %% [markdown]
# ## Numbers
#
# Everything is there as numbers, too, for [your own evaluation](results.md).

# %%
joint = solution.contact("joint")
print(f"force {joint.force:.3f} MPa cm, peak {joint.peak_pressure:.2f} MPa, in contact {joint.area:.2f} of 4 cm")
print(f"pressure at x = 2: {joint.at([[2, 1]])['pressure'][0]:.3f} MPa")
print(f"the edge of contact: x = {joint.edge[:, 0]} cm")

# %% [markdown]
# ## How good is it?
#
# `cd.error_estimate` solves once more, one degree higher, and tells how far the numbers are from the truth;
# `cd.adapt(scene, accuracy=1e-3)` refines until they are near enough.

# %%
cd.error_estimate(solution)

# %% [markdown]
# ## Change something
#
# A `Parameter` makes a load programme; `scene.with_layer` another layer. Neither assembles anything again.

# %%
softer = cd.solve(scene.with_layer(cd.PowerLayer(B=4e-5, a=1.1)))
print(f"peak under a layer ten times softer: {softer.contact().peak_pressure:.2f} MPa")
assert abs(joint.force / 40 - 1) < 1e-8  # 10 MPa over 4 cm
assert softer.contact().peak_pressure < joint.peak_pressure
