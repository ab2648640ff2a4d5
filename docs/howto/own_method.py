# %% [markdown]
# # A method of your own
#
# All methods are one iteration with different Robin coefficients $\varphi$, see [Theory](../theory.md). The one-point
# methods take $\varphi = \psi\,g'(z)$ with a function $\psi$ that is 1 on the part of the contact that gets the Robin
# condition and 0 elsewhere: $\psi = 0$ is the parallel Neumann scheme, $\psi = 1$ Robin's everywhere, and the paper's
# best is 1 where the gap is closed. Here is another: 1 where the gap is closed *or nearly so*, so that points on the
# verge of contact are held back, too.
#
# `cd.one_point(psi)` makes a method of a function of the gap $z$ and the place $x$; it is used like a built-in one.

# %%
import numpy as np

import contactdd as cd

steel, sides = cd.Isotropic(E=2.1e5, nu=0.3), [cd.Symmetry("left", "right")]
mesh = cd.rectangle((0, 0), (4, 1), (32, 16))
lower = cd.Body("lower", mesh, steel, supports=sides, loads=[cd.Pressure("bottom", 10)])
upper = cd.Body("upper", mesh.mirrored("y", at=1.0), steel, supports=sides, loads=[cd.Pressure("bottom", 10)])


def groove(x):
    return 5e-4 * np.maximum(1 - x[0] ** 2, 0) ** 1.5


contact = cd.Contact((lower, "top"), (upper, "top"), cd.PowerLayer(B=4e-6, a=1.1), gap=groove)
scene = cd.Scene([lower, upper], [contact])
reference = cd.solve(scene)  # Newton's method: the answer that all must come to
methods = {
    "closed (the paper's)": cd.one_point(lambda z, x: z < 0),
    "closed or within 1e-4 cm": cd.one_point(lambda z, x: z < 1e-4),
    "chord": "chord",
}
runs = {}
for name, method in methods.items():
    solution = cd.solve(scene, method, gamma=0.5, tolerance=1e-8)
    off = np.abs(solution.contact().pressure - reference.contact().pressure).max()
    runs[name] = solution.history
    print(f"{name:26} {solution.iterations:3} steps, peak off by {off:.1e} MPa")
    assert off < 1e-5  # MPa: the residual of 1e-8, and contraction by a half

# %% [markdown]
# The wider subset pays: what is held back where nothing presses comes to its place more slowly. How they converge;
# `history.plot()` draws one, with the factor per iteration that is fitted
# to it:

# %%
from matplotlib.figure import Figure

figure = Figure(figsize=(7, 4), layout="constrained")
axes = figure.subplots()
for (name, history), style in zip(runs.items(), ("o-", "s--", "^:"), strict=True):
    axes.semilogy(history.residual, style, markersize=4, label=name)
axes.set(xlabel="iteration", ylabel="residual")
axes.legend(frameon=False)
figure.savefig("methods.png", dpi=120)
figure
