# %% [markdown]
# # The stiffness of a machined joint
#
# Two ground steel blocks are bolted together. Their surfaces touch at the tips of their roughness, so the joint is
# softer than the blocks, and gets stiffer with the load: its approach is $\lambda = c\,p^m$ with $m \approx 1/2$ (Back,
# Burdekin and Cowley). What is the stiffness of the whole, $dF/d\delta$, over the preload?
#
# `solution.normal_stiffness` takes it from the tangent of the solved problem, exactly: no difference of two solutions.
# On paper, bars of the area $A$ and heights $H$ in series with a joint of the stiffness
# $\partial p/\partial\lambda = p^{1-m}/(c\,m)$ per area give
#
# $$ \frac1K = \frac{1}{A} \left( \frac{2H}{E'} + c\,m\,p^{\,m-1} \right), \qquad E' = \frac{E}{1-\nu^2} $$
#
# in plane strain with free sides.

# %%
import numpy as np

import contactdd as cd

H, WIDTH = 20.0, 30.0  # mm
steel = cd.Isotropic(E=2.1e5, nu=0.3)  # MPa
joint = cd.PowerLayer.machined_joint(c=0.8, m=0.5)  # µm and MPa, as in the tables; our unit is mm
preload = cd.Parameter(1.0)
mesh = cd.rectangle((0, 0), (WIDTH, H), (12, 8), shape="quadrilateral")
foot = [cd.Symmetry("bottom"), cd.Symmetry("left")]
low = cd.Body("low", mesh, steel, supports=foot, degree=2)
# The upper block is pressed by a plate that stays plane: its top is moved, and the force is what comes of it.
up = cd.Body("up", mesh.moved((0, H)), steel, supports=[cd.Symmetry("left"), cd.Symmetry("top")], degree=2)
approach = preload.field(lambda d, x: -d + 0 * x[0])
scene = cd.Scene([low, up], [cd.Contact((low, "top"), (up, "bottom"), joint, gap=approach, name="joint")])
record = {"p": lambda s: s.contact().mean_pressure, "K": lambda s: s.normal_stiffness("joint")}
path = cd.programme(scene, preload, np.array([0.5, 1, 2, 4, 8, 16]) * 1e-3, record=record)

# %%
for d, p, K in zip(path.values, path.records["p"], path.records["K"], strict=True):
    paper = WIDTH / (2 * H * (1 - steel.nu**2) / steel.E + joint.B * joint.a * p ** (joint.a - 1))
    print(f"closed by {d * 1e3:4.1f} µm: p = {p:6.2f} MPa, K = {K:8.0f} N/mm per mm (on paper {paper:8.0f})")
    assert abs(K / paper - 1) < 1e-6  # the pressure is even, so the elements are exact

# %% [markdown]
# Stiffness over pressure, from the path's table (`path.frame()` is the same for pandas, `path.to_csv` a file):

# %%
import matplotlib.pyplot as plt

figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
axes.plot(path.records["p"], path.records["K"], "o-", color="#0072B2")
axes.set(xlabel="pressure in the joint [MPa]", ylabel="K [N/mm per mm]", ylim=(0, None), xlim=(0, None))
figure.savefig("stiffness.png", dpi=120)
