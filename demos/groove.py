# %% [markdown]
# # The groove: two blocks, a nonlinear layer, and the paper's Table 1
#
# Two equal rectangles of steel, each of height $h = 1$ cm and length $l = 4$ cm,
# lie one on the other in plane strain. Pressures of $q = 10$ MPa on the outer faces
# press them together. The lower one has a shallow groove in its top,
#
# $$d(x) = r_0 \left\{\left[1 - (x_1/b)^2\right]^+\right\}^{3/2},
#   \qquad b = 1\ \mathrm{cm},\quad r_0 = 5 \cdot 10^{-4}\,b ,$$
#
# of which the right half is modelled: the sides are planes of symmetry, $u_n = 0$
# without shear. No other support holds the bodies; both float, and only their
# contact keeps them apart.
#
# ## What happens in the contact
#
# Both faces carry a thin layer, a coating or a rough surface, that is compressed by
# $w \le 0$ under the normal stress
#
# $$\sigma_n = g(w) = B^{-1/a}\,\mathrm{sgn}(w)\,|w|^{1/a},
#   \qquad B = 4 \cdot 10^{-6}\ \mathrm{cm/MPa}^a,\quad a = 1.1 .$$
#
# The displacements along the outward normals, $u_{1n}$ and $u_{2n}$, leave the
# deformed gap $z = d - u_{1n} - u_{2n}$. The contact is frictionless and
# unilateral: $\sigma_n = g(z)$ where $z < 0$, and zero where the gap is open. So
# neither the edge of the contact nor the pressure is known beforehand. Of all
# displacements the right ones minimise the energy
#
# $$F_1(u) = \tfrac12 A(u, u) - L(u) + \int_{S_{12}} \int_0^{z(u)} g^-(s)\, ds\, dS, \qquad g^-(z) = g(\min(z, 0)),$$
#
# which is convex: there is one solution but for the common vertical motion, which
# nothing resists.

# %%
import csv
import time

import numpy as np
from studies import table_1
from studies.results import Report

import contactdd as cd

report = Report("groove", "the paper's groove: Table 1, Fig. 3, and the contact beside the semi-analytic reference")

# %% [markdown]
# ## The scene
#
# Lengths in cm, stresses in MPa. Each mesh has 32 × 16 cells, each cut in two, so
# 32 facets along $S_{12}$; the upper mesh mirrors the lower. A body is a mesh, a
# material, supports and loads; its surfaces have names. A contact is two named
# surfaces, a layer and a gap. `quadrature` says where on a facet the law $g$ is
# evaluated: at Gauss points, or at the ends of the facets ("vertex"), which
# reproduces the paper's table.

# %%
LENGTH, HEIGHT, GROOVE, DEPTH, LOAD = 4.0, 1.0, 1.0, 5e-4, 10.0
steel, layer = cd.Isotropic(E=2.1e5, nu=0.3), cd.PowerLayer(B=4e-6, a=1.1)
sides = [cd.Symmetry("left", "right")]
lower_mesh = cd.rectangle((0, 0), (LENGTH, HEIGHT), (32, 16))
upper_mesh = cd.rectangle((0, HEIGHT), (LENGTH, 2 * HEIGHT), (32, 16), diagonal="left")
lower = cd.Body("lower", lower_mesh, steel, supports=sides, loads=[cd.Pressure("bottom", LOAD)])
upper = cd.Body("upper", upper_mesh, steel, supports=sides, loads=[cd.Pressure("top", LOAD)])


def depth(x):
    """d(x) of the groove at the coordinates x (2, n)."""
    return DEPTH * np.maximum(1 - (x[0] / GROOVE) ** 2, 0) ** 1.5


def touching(quadrature):
    """Both bodies in contact, the layer's law evaluated at the points of that rule."""
    contact = cd.Contact((lower, "top"), (upper, "bottom"), layer, gap=depth, quadrature=quadrature)
    return cd.Scene([lower, upper], [contact])


# %% [markdown]
# ## The methods of the paper
#
# A step of each method solves, for either body on its own, a linear problem of
# elasticity with a Robin term,
#
# $$a_\alpha(\tilde u_\alpha, v) + \int \varphi\,\tilde u_{\alpha n} v_n
#   = l_\alpha(v) + \int \left(\varphi\,u^k_{\alpha n} + g^-(z^k)\right) v_n ,
#   \qquad u^{k+1} = \gamma\,\tilde u + (1-\gamma)\,u^k .$$
#
# Method I, one-point, takes for $\varphi$ the derivative $g'(z^k)$ where the gap is
# closed; II, chord, the divided difference of $g^-$ between the last two iterates;
# III, Kurchatov's, the one between $2z^k - z^{k-1}$ and $z^{k-1}$. The number of
# iterations depends on the relaxation $\gamma$. Table 1 of the paper counts them,
# from $u^0_n = 10^{-4}\,b$ to the relative change $10^{-3}$; here it is again, all
# 66 runs. Up to $\gamma = 0.6$ the three are alike. Beyond, the first ends at once,
# as the whole contact opens; the third soon; the chord method goes on to 0.999.
# With $\gamma = 1$ it fails too: each body sees $\varphi$ where the coupled problem
# has the sum of both sides.

# %%
began = time.process_time()
rows = table_1.table(touching("vertex"))
seconds = time.process_time() - began
table_1.print_table(rows)
print(f"\nall {len(rows) * len(table_1.METHODS)} runs: {seconds:.2f} s CPU")
table_1.draw_iterations(rows, report.path("iterations.png"))
with open(report.path("table.csv"), "w", newline="") as file:
    writer = csv.DictWriter(file, ["gamma", *table_1.METHODS])
    writer.writeheader()
    writer.writerows(rows)

# %% [markdown]
# ## The solution
#
# Who only wants the answer lets `solve` choose: Newton's method with an exact line
# search on $F_1$, which needs no $\gamma$ and goes on until the unbalanced forces
# are $10^{-10}$ of those at work.

# %%
scene = touching("gauss")
solution = cd.solve(scene)
print(f"\n{solution}\n")

# %% [markdown]
# ## The contact beside a known answer
#
# For two equal rectangles the closing of the contact faces is a cosine series along
# $S_{12}$, whose coefficients `cd.reference.groove()` finds to many digits. The
# pressure peaks just inside the groove's rim, at $x \approx 0.985$, where the faces
# bend to close it; the contact ends at $x \approx 0.51$. Linear triangles of this
# size find $p(x)$ to about a percent in the $L_2$ norm.

# %%
exact = cd.reference.groove()
result = solution.contact(degree=16)  # at points enough to see the pressure between the nodes too
order = np.argsort(result.x[:, 0])
x, z, p, weights = (values[order] for values in (result.x[:, 0], result.gap, result.pressure, result.weights))
first = int(np.argmax(z < 0))  # the gap changes its sign between this point and the one before
peak = int(np.argmax(p))
numbers = {
    "peak_pressure": float(p[peak]),
    "peak_x": float(x[peak]),
    "contact_edge": float(np.interp(0.0, -z[first - 1 : first + 1], x[first - 1 : first + 1])),
    "error_l2": float(np.sqrt(weights @ (p - exact.pressure(x)) ** 2 / (weights @ exact.pressure(x) ** 2))),
}
print(f"peak pressure   {numbers['peak_pressure']:10.5f} at x = {numbers['peak_x']:.5f}")
print(f"   reference    {exact.peak_pressure:10.5f} at x = {exact.peak_x:.5f}")
print(f"edge of contact {numbers['contact_edge']:10.5f}, reference {exact.contact_edge:.5f}")
print(f"relative L2 error of p(x): {numbers['error_l2']:.2e}")

# %% [markdown]
# ## Pictures
#
# Iterations against $\gamma$, Fig. 3 of the paper, have been drawn above. Here are
# pressure and gap along the contact, with the reference dashed, and the blocks with
# their displacements enlarged, coloured by the vertical stress. Over the open
# groove the blocks carry nothing and bulge towards each other.

# %%
figure = solution.plot_contact()
points = np.linspace(0.0, LENGTH, 801)
for axes, values in zip(figure.axes, (exact.pressure(points), exact.gap(points)), strict=True):
    axes.plot(points, values, "k--", linewidth=0.9, label="reference")
figure.axes[0].legend(frameon=False)
figure.savefig(report.path("contact.png"), dpi=150)
solution.plot_bodies(component="yy", path=report.path("bodies.png"))
report.summary({"table": rows} | numbers | {"cpu_seconds": seconds})

# %% [markdown]
# ## What must hold
#
# The contact carries the whole load, $\int p\, dS = q\,l$, to the residual. Where
# the pressure is positive the gap is closed, and nowhere does a surface pull. At
# the paper's best $\gamma$ each method needs as many iterations as there: seven.

# %%
assert abs(solution.contact().force / (LOAD * LENGTH) - 1) < 1e-8
assert np.all(p >= 0)
assert np.all(p[z >= 0] == 0)
assert all(row[column] == 7 for row in rows if row["gamma"] == 0.6 for column in table_1.METHODS)
assert numbers["error_l2"] < 1.6e-2
