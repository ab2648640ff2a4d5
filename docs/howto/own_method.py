# %% [markdown]
# # A method of your own
#
# Every iteration solves each body on its own, with a Robin term on its contact faces, and then relaxes:
#
# $$a_\alpha(\tilde u_\alpha, v) + \int \varphi\,(\tilde u_{\alpha n} - u^k_{\alpha n})\,v_n
#   = l_\alpha(v) + \int g^-(z^k)\,v_n , \qquad u^{k+1} = u^k + \gamma\,(\tilde u - u^k) .$$
#
# The coefficient $\varphi$ and the relaxation $\gamma$ are functions that you may write. Here is the groove between
# two plates, which the paper's chord method solves first: its $\varphi$ is the layer's divided difference between the
# last two gaps.

# %%
import numpy as np

import contactdd as cd

steel, sides = cd.Isotropic(E=2.1e5, nu=0.3), cd.Symmetry("left", "right")  # MPa, cm
mesh = cd.rectangle((0, 0), (4, 1), (32, 16))
down = cd.Displacement("top", (None, -3e-4))
lower = cd.Body("lower", mesh, steel, supports=[sides, cd.Fixed("bottom")])
upper = cd.Body("upper", mesh.moved((0, 1)), steel, supports=[sides, down])


def groove(x):
    return 5e-4 * np.maximum(1 - x[0] ** 2, 0) ** 1.5


contact = cd.Contact((lower, "top"), (upper, "bottom"), cd.PowerLayer(B=4e-6, a=1.1), gap=groove)
scene = cd.Scene([lower, upper], [contact])
paper = cd.solve(scene, "chord", gamma=0.6)

# %% [markdown]
# ## A coefficient
#
# The mean of the tangents at the last two gaps costs no more than their divided difference. A function of the layer,
# both gaps and the points is all that a `Scheme` needs; what it returns is checked in every iteration.


# %%
def mean_tangent(layer, z, z_previous, x):
    return (layer.contact_derivative(z) + layer.contact_derivative(z_previous)) / 2


mine = cd.Scheme("mean tangent", mean_tangent, "decomposed", "own")
fixed = cd.solve(scene, mine, gamma=0.6)

# %% [markdown]
# ## A relaxation
#
# Aitken's rule takes $\gamma$ from the last two corrections $r = \tilde u - u$, which a function of two arguments sees:
#
# $$\gamma^k = -\gamma^{k-1}\,\frac{r^{k-1}\cdot(r^k - r^{k-1})}{\|r^k - r^{k-1}\|^2} .$$


# %%
def aitken(k, now):
    if now.previous is None:
        return 0.6
    change = now.correction - now.previous
    return abs(now.history[-1].gamma * (now.previous @ change) / (change @ change))


relaxed = cd.solve(scene, mine, gamma=aitken)

# %% [markdown]
# ## Which is best?
#
# The runs beside each other, with the factor by which the residual falls in each iteration, fitted over the second
# half. The two coefficients do the same here; it is the relaxation that counts.

# %%
others = {"mean tangent": fixed.history, "mean tangent, Aitken": relaxed.history}
paper.history.plot(name="chord", beside=others, path="residuals.png")

# %% [markdown]
# Whatever the method, it is the same solution. More that can be your own, the order of the bodies and coefficients that
# see both of them, is in [this demo](../demos/own_method.py).

# %%
for run in (fixed, relaxed):
    assert np.allclose(run.contact().pressure, paper.contact().pressure, rtol=1e-6, atol=1e-6)
assert relaxed.iterations < fixed.iterations
