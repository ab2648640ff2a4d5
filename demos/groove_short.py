# %% [markdown]
# # The groove in a dozen lines
#
# Two steel blocks, 4 cm long and 1 cm high, are pressed together with $q = 10$ MPa.
# The lower one has a shallow groove in its top, $d(x) = r_0 [1 - x_1^2]^{3/2}$ for
# $x_1 < 1$ cm; by symmetry the right half is enough. Between them is a layer that
# is compressed by $w$ under the normal stress
#
# $$\sigma_n = g(w) = B^{-1/a}\,\mathrm{sgn}(w)\,|w|^{1/a} .$$
#
# A body is a mesh with named surfaces, a material, supports and loads; a contact is
# two surfaces, a layer and a gap; a scene is all bodies and contacts. `solve` finds
# the displacements that minimise the convex energy $F_1$, and with them where the
# blocks touch: $z = d - u_{1n} - u_{2n} < 0$ and $\sigma_n = g(z)$ there, no stress
# elsewhere. `demos/groove.py` tells more of this scene.

# %%
import numpy as np

import contactdd as cd

steel = cd.Isotropic(E=2.1e5, nu=0.3)  # MPa; lengths in cm
sides = [cd.Symmetry("left", "right")]
mesh = cd.rectangle((0, 0), (4, 1), (32, 16))
lower = cd.Body("lower", mesh, steel, supports=sides, loads=[cd.Pressure("bottom", 10)])
mesh = cd.rectangle((0, 1), (4, 2), (32, 16))
upper = cd.Body("upper", mesh, steel, supports=sides, loads=[cd.Pressure("top", 10)])


def groove(x):
    return 5e-4 * np.maximum(1 - x[0] ** 2, 0) ** 1.5


layer = cd.PowerLayer(B=4e-6, a=1.1)
contact = cd.Contact((lower, "top"), (upper, "bottom"), layer, gap=groove)
solution = cd.solve(cd.Scene([lower, upper], [contact]))
print(solution)
solution.plot_contact(path="contact.png")
solution.plot_bodies(component="yy", path="bodies.png")

# %% [markdown]
# Nothing else holds the blocks, so the contact carries the whole load, $\int p\,dS
# = q\,l = 40$ MPa cm per unit of thickness; nowhere does it pull, and over the
# middle of the groove it is open.

# %%
result = solution.contact()
assert abs(result.force / 40 - 1) < 1e-8
assert result.pressure.min() == 0
assert result.gap.max() > 0
