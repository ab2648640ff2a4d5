# %% [markdown]
# # Methods of your own: φ, γ and the order of the bodies
#
# Each iteration solves every body $\alpha$ on its own, with a Robin term on its contact
# faces, and then relaxes:
#
# $$a_\alpha(\tilde u_\alpha, v) + \int \varphi\,(\tilde u_{\alpha n} - u^k_{\alpha n})\,v_n
#   = l_\alpha(v) + \int g^-(z^k)\,v_n , \qquad u^{k+1} = u^k + \gamma\,(\tilde u - u^k) .$$
#
# The paper's three methods differ in $\varphi$: the layer's derivative (one-point), its
# divided difference between the last two gaps (chord), or between reflected ones
# (Kurchatov). Three things can be your own, and this page tries one of each:
# $\varphi$, $\gamma$, and the order in which the bodies are solved.
#
# ## A coefficient that sees both bodies
#
# Look at one wave along the contact. A body's surface answers a pressure by $s_\alpha$
# (stress per length), and the layer has the tangent $k$. If $r$ is the pressure that
# is not balanced yet, the same for both bodies, Newton's method asks for
#
# $$\begin{pmatrix} s_1 + k & k \\ k & s_2 + k \end{pmatrix}
#   \begin{pmatrix} \delta_1 \\ \delta_2 \end{pmatrix} = \begin{pmatrix} r \\ r \end{pmatrix}
#   \quad\Rightarrow\quad s_1 \delta_1 = s_2 \delta_2
#   \quad\Rightarrow\quad \bigl[s_1 + k\,(1 + s_1/s_2)\bigr]\,\delta_1 = r .$$
#
# So a body that is solved alone takes Newton's step if its own coefficient is
#
# $$\varphi_1 = k\,(1 + s_1/s_2), \qquad \varphi_2 = k\,(1 + s_2/s_1), \qquad \gamma = 1 .$$
#
# Surfaces of deep bodies have $s = E\kappa/(2(1-\nu^2))$ for waves of the number
# $\kappa$, of which the ratio keeps the moduli only. A coefficient that takes a fifth
# argument is given the contact with its two bodies, and may return a row for each.
# The reasoning fails where one body is held and the other floats, which as a whole has
# $s = 0$, or where they are held in unlike ways.

# %%
import matplotlib.pyplot as plt
import numpy as np
from studies.results import Report

import contactdd as cd

report = Report(__file__, "Own Robin coefficients, relaxations and orders against the paper's methods")


def two_sided(layer, z, z_previous, x, sides):
    first, second = sides.moduli
    return np.array([[1 + first / second], [1 + second / first]]) * layer.divided_difference(z_previous, z)


def chord(layer, z, z_previous, x):
    return layer.divided_difference(z_previous, z)


# %% [markdown]
# ## A relaxation from the history
#
# Aitken's rule, in Irons and Tuck's form for vectors, takes $\gamma$ from the last two
# corrections $r = \tilde u - u$, which a function of two arguments is given:
#
# $$\gamma^k = -\gamma^{k-1}\,\frac{r^{k-1}\cdot(r^k - r^{k-1})}{\|r^k - r^{k-1}\|^2} .$$


# %%
def aitken(k, now):
    if now.previous is None:
        return 0.6
    change = now.correction - now.previous
    return abs(now.history[-1].gamma * (now.previous @ change) / (change @ change))


# %% [markdown]
# ## An order
#
# With `order=["lower", "upper"]` the upper body is solved with the displacement that
# the lower one has just got: the alternating method, block Gauss-Seidel where all at
# once is block Jacobi. Bodies in a list of their own, `[["a", "c"], "b"]`, are solved
# at once, as the colours of a chequerboard. A coefficient of a wrong shape, negative or
# no number, and a body that is misspelt or missing in the order are refused in words.
#
# ## Three scenes
#
# The groove of the paper with unlike strips, the upper one ten times as soft: pressed
# from both ends and held by nothing but each other; pressed between two plates that
# are held; and standing on a held plate under a pressure.

# %%
SCENES = {"both float": (False, False), "both held": (True, True), "lower held": (True, False)}
METHODS = {
    "one-point, γ = 0.6": ("one-point", 0.6),
    "chord, γ = 0.6": ("chord", 0.6),
    "Kurchatov, γ = 0.6": ("kurchatov", 0.6),
    "two-sided φ, γ = 1": (cd.Scheme("two-sided", two_sided, "decomposed", "own"), 1.0),
    "chord, Aitken's γ": ("chord", aitken),
    "chord, alternating, γ = 1": (cd.Scheme("alternating", chord, "decomposed", "own", order=["lower", "upper"]), 1.0),
    "two-sided φ, Aitken's γ": (cd.Scheme("two-sided", two_sided, "decomposed", "own"), aitken),
}


def strips(lower_held, upper_held):
    walls = cd.Symmetry("left", "right")
    down = [cd.Displacement("top", (0, -4e-4))] if upper_held else []
    lower = cd.Body(
        "lower",
        cd.rectangle((0, 0), (4, 1), (32, 16)),
        cd.Isotropic(E=2.1e5, nu=0.3),
        supports=[walls, cd.Fixed("bottom")] if lower_held else [walls],
        loads=[] if lower_held else [cd.Pressure("bottom", 10)],
    )
    upper = cd.Body(
        "upper",
        cd.rectangle((0, 1), (4, 2), (32, 16), diagonal="left"),
        cd.Isotropic(E=2.1e4, nu=0.3),
        supports=[walls, *down],
        loads=[] if upper_held else [cd.Pressure("top", 10)],
    )
    layer = cd.PowerLayer(4e-6, 1.1)
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), layer, gap=groove)])


def groove(x):
    return 5e-4 * np.maximum(1 - x[0] ** 2, 0) ** 1.5


counts, pressures = {}, {}
for place, held in SCENES.items():
    scene = strips(*held)
    pressures[place] = cd.solve(scene).contact().pressure
    for name, (method, gamma) in METHODS.items():
        solution = cd.solve(scene, method, gamma=gamma, tolerance=1e-8, on_failure="return")
        off = np.abs(solution.contact().pressure - pressures[place]).max() / pressures[place].max()
        counts[name, place] = {"iterations": solution.iterations, "status": solution.status, "off": float(off)}
print(f"{'iterations':27}" + "".join(f"{place:>14}" for place in SCENES))
for name in METHODS:
    rows = [counts[name, place] for place in SCENES]
    told = [str(row["iterations"]) if row["status"] == "converged" else row["status"] for row in rows]
    print(f"{name:27}" + "".join(f"{each:>14}" for each in told))

# %% [markdown]
# ## The picture
#
# Iterations to a residual of 1e-8, in a logarithmic scale; what does not converge has
# no bar but a word. Aitken's rule helps the chord method everywhere. The two-sided
# coefficient is Newton's method in disguise where both bodies float or both are held
# alike, and no good where one of each meet: there the order counts.
#
# Two bodies that float are the worst case for methods that solve them apart: nothing
# but the contact holds the pair together, and what moves both alike is damped slowly.
# The two-sided rows leave that motion at rest, since both bodies get the same force.

# %%
figure, axes = plt.subplots(figsize=(8, 4.6), layout="constrained")
width = 0.8 / len(METHODS)
colours = ["0.75", "0.6", "0.45", "C3", "C0", "C2", "C1"]
for i, (name, colour) in enumerate(zip(METHODS, colours, strict=True)):
    for j, place in enumerate(SCENES):
        row, at = counts[name, place], j + (i - len(METHODS) / 2 + 0.5) * width
        good = row["status"] == "converged"
        height, told = (row["iterations"], str(row["iterations"])) if good else (1, row["status"])
        axes.bar(at, height, width, color=colour, label=name if j == 0 else None)
        axes.text(at, 1.08 * height, told, ha="center", fontsize=7, rotation=0 if good else 90)
axes.set_yscale("log")
axes.set_ylim(1, 6000)
axes.set_ylabel("iterations")
axes.set_xticks(range(len(SCENES)), list(SCENES))
axes.legend(fontsize=8, ncols=2, frameon=False, loc="upper right")
figure.savefig(report.path("iterations.png"), dpi=150)
report.summary([{"method": name, "scene": place, **row} for (name, place), row in counts.items()])

# %% [markdown]
# ## What must hold
#
# Whatever the method, the solution is the same to the residual. The two-sided
# coefficient needs a quarter of the chord method's iterations at most where its
# argument holds, and Aitken's rule never costs one.

# %%
for (name, place), row in counts.items():
    assert row["status"] != "converged" or row["off"] < 1e-5, (name, place)
for place in ("both float", "both held"):
    assert 4 * counts["two-sided φ, γ = 1", place]["iterations"] < counts["chord, γ = 0.6", place]["iterations"]
for place in SCENES:
    assert counts["chord, Aitken's γ", place]["iterations"] < counts["chord, γ = 0.6", place]["iterations"]
