# %% [markdown]
# # For the study of domain decomposition: rates against theory
#
# Every iteration solves each body on its own, with a Robin term on its contact faces, and relaxes. $\varphi$, $\gamma$,
# the order of the bodies ([](../demos/own_method.py)) and a body's solver ([](../demos/own_local_solver.py)) are yours
# to give; `solution.history` holds residual, change, $\gamma$, the range of $\varphi$ and the number of solves of
# single bodies after every iteration.
#
# Two columns of stiffness $s_1, s_2$ (stress per length) are held at their far ends, with a linear layer $k$ between
# them. With $\varphi = k$ the errors $e_1, e_2$ of their ends obey
#
# $$ (s_1 + k)\,\tilde e_1 = -k\,e_2, \quad (s_2 + k)\,\tilde e_2 = -k\,e_1, \quad
#    e \leftarrow \gamma \tilde e + (1-\gamma)\,e \quad\Rightarrow\quad
#    \text{rate} = 1 - \gamma\,(1 - \varrho), \quad \varrho = \frac{k}{\sqrt{(s_1 + k)(s_2 + k)}} $$
#
# for $\gamma \le 1$; one after the other (alternating, $\gamma = 1$) the rate is $\varrho^2$.

# %%
import numpy as np
from matplotlib.figure import Figure

import contactdd as cd

hard, soft, k = cd.Isotropic(E=2.1e5, nu=0.3), cd.Isotropic(E=2.1e4, nu=0.3), 2e5
walls, mesh = cd.Symmetry("left", "right"), cd.rectangle((0, 0), (4, 1), (8, 4))
low = cd.Body("low", mesh, hard, supports=[walls, cd.Fixed("bottom")])
high = cd.Body("high", mesh.moved((0, 1)), soft, supports=[walls, cd.Displacement("top", (0, -1e-3))])
scene = cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(k))])


def secant(layer, z, z_previous, x):
    return layer.divided_difference(z_previous, z)


def run(gamma, order=None):
    """A run, and its rate over the last six iterations, of two eigenvalues each."""
    method = cd.Scheme("own", secant, "decomposed", "own", order=order)
    history = cd.solve(scene, method, gamma=gamma, start=1e-3, tolerance=1e-9).history
    return history, (history.residual[-1] / history.residual[-7]) ** (1 / 6)


s = [material.stiffness()[0, 0] for material in (hard, soft)]  # of a column one high between walls
rho = k / np.sqrt((s[0] + k) * (s[1] + k))
runs = {f"γ = {gamma}": (*run(gamma), 1 - gamma * (1 - rho)) for gamma in (0.4, 0.6, 0.8, 1.0)}
runs["alternating"] = (*run(1.0, ["low", "high"]), rho**2)
for name, (history, rate, theory) in runs.items():
    counts = f"{len(history):3} iterations, {history.body_solves[-1]:3} solves"
    print(f"{name:12} {counts}: rate {rate:.4f}, theory {theory:.4f}")
    assert abs(rate / theory - 1) < 1e-3  # the smaller eigenvalue has not quite died out

# %% [markdown]
# The columns' fields are uniform, so that this is all there is; with a groove, waves of every length have a rate of
# their own. Residuals over the solves of single bodies, which is what an iteration costs:

# %%
figure = Figure(figsize=(6, 3.6), layout="constrained")
axes = figure.subplots()
for (name, (history, _, _)), colour in zip(
    runs.items(), ("#0072B2", "#009E73", "#E69F00", "#D55E00", "k"), strict=True
):
    axes.semilogy(history.body_solves, history.residual, color=colour, label=name)
axes.set(xlabel="solves of single bodies", ylabel="relative residual")
axes.legend(frameon=False)
figure.savefig("rates.png", dpi=120)
figure
