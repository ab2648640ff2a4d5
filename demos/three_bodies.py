# %% [markdown]
# # A keystone: three bodies, each touching both others
#
# Two blocks stand side by side on a smooth floor and lean on each other along $x =
# 0$. Above, their inner edges are cut off at 45°, and a wedge is pressed down into
# the notch. The left block stands against a wall; the right one is pushed to it by
# a pressure $s$ on its outer side. The wedge is held by nothing but its two
# neighbours, and of the right block only the floor is fixed: a solver that tears
# the bodies apart must find three contact forces that depend on each other.
#
# Each pair of surfaces obeys the same conditions, with the layer's law $g$ of its
# own:
#
# $$z = d - u_{\alpha n} - u_{\beta n},
#   \qquad \sigma_n = g(z) \ \text{where}\ z < 0, \qquad \sigma_n = 0 \ \text{elsewhere}, $$
#
# without friction. Two of the layers are rough, $w = -B\,p^a$, the third is linear,
# $p = -k\,w$. None of the meshes match: each contact is integrated over the common
# refinement of both its surfaces.
#
# ## Known beforehand: the forces
#
# Cut the wedge free. Its top, of width $b = 2$ mm, carries $P = p\,b$ downwards
# (per mm of thickness). Both slopes are frictionless and turned by 45°, so each
# pushes with a force $N$ along its normal, and
#
# $$2 N \cos 45^\circ = P \quad\Longrightarrow\quad N = P/\sqrt2 .$$
#
# On either block, $N$ has the horizontal part $P/2$, which pushes the blocks apart.
# The right one, of height $H = 2$ mm at its outer side, is pushed back by $s H$;
# the middle contact carries what is left:
#
# $$M = s H - P/2 .$$
#
# Neither moduli nor layers nor meshes enter. They decide where on the surfaces the
# forces act, not how large they are. That makes a sharp test: the three forces must
# be these to the residual of the run, on any mesh.

# %%
import numpy as np
from studies.results import MESHES, Report

import contactdd as cd

report = Report("three_bodies", "a wedge between two blocks: contact forces against statics")
LOAD, SIDE_LOAD, TOP_WIDTH, SIDE_HEIGHT = 30.0, 40.0, 2.0, 2.0  # N and mm; the lengths are those of the mesh script

# %% [markdown]
# ## The scene
#
# The geometry is a gmsh script with a named physical group for each surface;
# `read_gmsh` meshes one body of it after the other. Quadratic triangles of 0.1 mm
# on the left, smaller ones on the right and in the wedge.

# %%
mesh = {
    name: cd.read_gmsh(MESHES / "keystone.geo", body=name, size=0.1) for name in ("left_block", "right_block", "wedge")
}
steel, brass, aluminium = cd.Isotropic(2.1e5, 0.3), cd.Isotropic(1.0e5, 0.35), cd.Isotropic(7.0e4, 0.33)
left = cd.Body("left", mesh["left_block"], steel, supports=[cd.Symmetry("bottom", "outside")], degree=2)
push = cd.Pressure("outside", SIDE_LOAD)
right = cd.Body("right", mesh["right_block"], brass, supports=[cd.Symmetry("bottom")], loads=[push], degree=2)
wedge = cd.Body("wedge", mesh["wedge"], aluminium, loads=[cd.Pressure("top", LOAD)], degree=2)
rough, soft = cd.PowerLayer(B=2e-5, a=1.2), cd.LinearLayer(stiffness=5e4)
contacts = [
    cd.Contact((left, "middle"), (right, "middle"), rough),
    cd.Contact((wedge, "slope_left"), (left, "slope"), rough),
    cd.Contact((wedge, "slope_right"), (right, "slope"), soft),
]
scene = cd.Scene([left, right, wedge], contacts)

# %% [markdown]
# ## The solution
#
# The wedge has three free motions, the right block one. `solve` finds them before
# it begins, and would refuse the scene if the loads could drive one of them for
# ever.

# %%
solution = cd.solve(scene)
print(f"{solution}\n")

# %%
down = LOAD * TOP_WIDTH
statics = {
    "left–right": SIDE_LOAD * SIDE_HEIGHT - down / 2,
    "wedge–left": down / np.sqrt(2),
    "wedge–right": down / np.sqrt(2),
}
numbers = {}
for contact, balance in statics.items():
    result = solution.contact(contact)
    numbers[contact] = {"force": result.force, "statics": balance, "peak_pressure": float(result.pressure.max())}
    print(f"{contact:12} force {result.force:.9f} N/mm, statics {balance:.9f}, alone {result.unpaired_area} mm")

# %% [markdown]
# ## Pictures
#
# The stress shows what statics cannot: the wedge presses hardest at the upper ends
# of its slopes, and the blocks press each other a little more below the notch than
# at the floor. The wedge's tip is cut off, so the lowest $\sqrt2/10$ mm of either
# slope lies opposite nothing: the printed area "alone".

# %%
for index, contact in enumerate(scene.contacts):
    solution.plot_contact(contact, path=report.path(f"contact{index + 1}.png"))
solution.plot_bodies(component="von Mises", path=report.path("bodies.png"))
report.summary(numbers | {"iterations": solution.iterations, "imbalance": solution.imbalance})

# %% [markdown]
# ## What must hold
#
# The three forces of statics, to the residual of $10^{-10}$ with a margin for the
# sums; and all forces on each body together vanish.

# %%
for contact, balance in statics.items():
    assert abs(numbers[contact]["force"] / balance - 1) < 1e-8, contact
assert solution.imbalance < 1e-8
