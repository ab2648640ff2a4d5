# %% [markdown]
# # A stack of eight blocks: seven contacts at once between floating bodies
#
# Eight blocks lie one on the other between two smooth walls. The lowest stands on
# the ground, the topmost is pressed by $q = 10$ MPa; those between are held up by
# their contacts alone. Heights, moduli and meshes differ from block to block, and
# each top has a groove of another middle $c$, half-width $b$ and depth $r_0$,
#
# $$d(x) = r_0 \left\{\left[1 - \left((x_1 - c)/b\right)^2\right]^+\right\}^{3/2} ,$$
#
# so nothing in the scene is symmetric and no two meshes match. Every interface
# carries the paper's layer, $w = -B\,p^a$ with $B = 4 \cdot 10^{-6}\ \mathrm{cm/MPa}^a$ and
# $a = 1.1$.
#
# ## Why a stack is hard for a method that takes bodies one by one
#
# A decomposed step solves each body with a Robin condition, $\sigma_n +
# \varphi\,u_n = \dots$, and so hands news on from a body to its neighbours only.
# The load at the top has to travel down through seven contacts, and the slow modes
# are those in which whole groups of blocks move together: with plain relaxation the
# number of steps grows with the number of bodies, from hundreds to thousands. A
# coupled Newton's method sees all contacts at once,
#
# $$\left(A + \sum \int g'(z^k)\,[u_{\alpha n} + u_{\beta n}]\,[v_{\alpha n} + v_{\beta n}]\right) \delta
#   = -F_1'(u^k) ,$$
#
# and does not care; its step length is the minimum of the convex energy $F_1$ along
# $\delta$. Each body is condensed to the displacements at its contacts beforehand,
# so that this system has a few hundred unknowns and not the five thousand of the
# meshes. `solve` chooses this by itself.
#
# ## Known beforehand
#
# The walls are smooth and the contacts frictionless, so every interface carries the
# whole load: $\int p\,dS = q\,l$ for each of the seven, wherever its groove stays
# open. The pressure over an open groove is zero, hence larger than $q$ beside it.
# How far each groove closes depends on the two blocks around it: a thin or soft one
# bends into it.

# %%
from itertools import pairwise

import numpy as np
from matplotlib.figure import Figure
from studies.results import Report

import contactdd as cd

report = Report("stack", "eight unlike blocks with grooves between them")

# %% [markdown]
# ## The scene
#
# cm and MPa, as in the paper's problem. The cells of one block are a little
# narrower or wider than those of the next, and every second mesh is cut along both
# diagonals of its cells. Where two meshes do not match, the contact is integrated
# over the pieces that both of their facets cut out of each other, so neither of the
# two is the master.
#
# The sides slide along the walls: $u_1 = 0$ and no shear. `Symmetry` is this
# support, on any plane face.

# %%
LENGTH, LOAD = 4.0, 10.0
HEIGHTS = (1.0, 0.6, 1.4, 0.8, 1.2, 0.5, 1.0, 0.7)
MODULI = (2.1e5, 1.0e5, 7.0e4, 2.1e5, 4.5e4, 1.2e5, 2.1e5, 7.0e4)
CELLS = (32, 27, 36, 29, 40, 31, 34, 26)
layer = cd.PowerLayer(B=4e-6, a=1.1)


def groove(i):
    """The gap of contact i, counted from below: a groove that wanders to the right."""
    middle, half_width, r0 = 0.5 + 0.5 * i, 0.5 + 0.1 * (i % 3), 4e-4 + 1e-4 * (i % 4)
    return lambda x: r0 * np.maximum(1 - ((x[0] - middle) / half_width) ** 2, 0) ** 1.5


floors = np.concatenate([[0.0], np.cumsum(HEIGHTS)])
blocks = []
for i, (height, E, cells) in enumerate(zip(HEIGHTS, MODULI, CELLS, strict=True)):
    count = (cells, round(cells * height / LENGTH))
    mesh = cd.rectangle((0, floors[i]), (LENGTH, floors[i + 1]), count, diagonal="crossed" if i % 2 else "right")
    held = cd.Symmetry("left", "right", "bottom") if i == 0 else cd.Symmetry("left", "right")
    loads = [cd.Pressure("top", LOAD)] if i == len(HEIGHTS) - 1 else []
    blocks.append(cd.Body(f"block {i + 1}", mesh, cd.Isotropic(E, 0.3), supports=[held], loads=loads))
pairs = enumerate(pairwise(blocks))
contacts = [cd.Contact((low, "top"), (high, "bottom"), layer, gap=groove(i)) for i, (low, high) in pairs]
scene = cd.Scene(blocks, contacts)

# %% [markdown]
# ## The solution
#
# Floating bodies are the difficulty of such a scene: without its contacts a block
# may move up and down freely, its stiffness is singular, and as long as a contact
# is open nothing tells the block where to go. `solve` starts with the blocks moved
# together until their contacts carry the load on average, and then lets Newton's
# steps find the details. A contact that opens for a moment on the way is survived,
# as no step may raise the energy.

# %%
solution = cd.solve(scene)
print(f"{solution}\n")
results = [solution.contact(contact) for contact in contacts]
numbers = [
    {
        "name": contact.name,
        "force": result.force,
        "peak_pressure": float(result.pressure.max()),
        "open": float(result.weights[~result.closed].sum()),
    }
    for contact, result in zip(contacts, results, strict=True)
]
for row in numbers:
    print("{name}: force {force:.9f}, peak {peak_pressure:.4f}, open {open:.4f}".format(**row))

# %% [markdown]
# ## Pictures
#
# All seven pressures, one above the other as the contacts are. Each is zero where
# its groove is open and has a peak at either rim; the grooves above and below leave
# their traces as bumps.

# %%
figure = Figure(figsize=(7, 9), layout="constrained")
rows = zip(figure.subplots(len(contacts), sharex=True), contacts[::-1], results[::-1], strict=True)
for axes, contact, result in rows:
    order = np.argsort(result.x[:, 0])
    axes.plot(result.x[order, 0], result.pressure[order], color="#1f5f8b")
    axes.set_title(contact.name, fontsize=8, loc="left", pad=2)
    axes.set_ylim(0, None)
    axes.margins(x=0)
axes.set_xlabel("x")
figure.supylabel("contact pressure")
figure.savefig(report.path("contacts.png"), dpi=150)
solution.plot_bodies(component="yy", path=report.path("bodies.png"))
report.summary({"contacts": numbers, "iterations": solution.iterations, "imbalance": solution.imbalance})

# %% [markdown]
# ## What must hold
#
# The numbers printed above are tests as well. The forces hang on the equilibrium of
# every single block: a force of the third contact that is wrong in the ninth digit
# would mean that block three or four is not in equilibrium.
#
# Every contact hands on the whole load; every groove is open in part, never wider
# than it was cut; Newton's steps are few, as for two blocks.

# %%
for i, row in enumerate(numbers):
    assert abs(row["force"] / (LOAD * LENGTH) - 1) < 1e-8, row
    assert 0 < row["open"] < 2 * (0.5 + 0.1 * (i % 3)), row
assert solution.imbalance < 1e-8
assert solution.iterations <= 10
