# %% [markdown]
# # A cylinder on a block: the NAFEMS benchmark against Hertz
#
# A steel cylinder of radius $R = 50$ mm lies on an aluminium block and is pressed
# down with $P = 35$ kN per mm of its length. It is a standard benchmark of contact
# solvers, as it has what makes them fail: a curved surface on a flat one, meshes
# that do not match, a contact that begins as a line, and a pressure with a vertical
# slope at its edge.
#
# ## Known beforehand
#
# Hertz replaced both bodies by half-planes. With the contact modulus $E^*$ of the
# pair,
#
# $$\frac1{E^*} = \frac{1-\nu_1^2}{E_1} + \frac{1-\nu_2^2}{E_2}, \qquad
#   a = \sqrt{\frac{4 P R}{\pi E^*}}, \qquad p(x) = p_0 \sqrt{1 - (x/a)^2}, \qquad p_0 = \frac{2P}{\pi a} ,$$
#
# $E_1 = 210$ GPa, $E_2 = 70$ GPa and $\nu = 0.3$ give a half-width $a = 6.21$ mm
# and a peak $p_0 = 3585$ MPa. The bodies here are finite and the cylinder is round,
# not a parabola: with $a/R = 1/8$ the two agree to a percent or two, not better.
#
# ## A layer where there is none
#
# In Hertz' problem nothing lies between the bodies. contactdd always has a layer; a
# linear one, $p = -k\,w$, that hardly yields is the penalty method. The stiffness
# $k = 5 \cdot 10^6$ N/mm³ is chosen by what it spoils: under the peak pressure the
# layer yields $p_0/k = 7 \cdot 10^{-4}$ mm. The gap that closes at the edge of
# contact is $a^2/(2R) = 0.39$ mm, five hundred times as much. Ten times as stiff
# changes the peak by 0.05 % and takes twice as many of Newton's steps.

# %%
import numpy as np
from studies.results import MESHES, Report

import contactdd as cd

report = Report("cylinder", "NAFEMS' cylinder on a block against Hertz")
RADIUS, LOAD, STIFFNESS = 50.0, 35e3, 5e6  # mm, N/mm, N/mm³

# %% [markdown]
# ## The scene
#
# Symmetry leaves the right half. The circle is meshed by curved elements of degree
# 2, and the displacements are quadratic too; towards the contact the cells shrink
# to 0.25 mm, a twenty-fifth of $a$. The block stands on a smooth floor. Of the
# cylinder only the lower half is there, with its load spread over the cut; it
# floats, held by the contact alone. `contact` and `top` are the surfaces that may
# touch; where they do is found. The initial gap comes from the two meshes
# themselves, measured along the normals.

# %%
steel, aluminium = cd.Isotropic(E=210e3, nu=0.3), cd.Isotropic(E=70e3, nu=0.3)
script, axis = MESHES / "cylinder_on_block.geo", cd.Symmetry("axis")
mesh = {body: cd.read_gmsh(script, body=body, order=2, fine=0.25, radius=RADIUS) for body in ("cylinder", "block")}
push = cd.Pressure("cylinder_top", LOAD / (2 * RADIUS))
cylinder = cd.Body("cylinder", mesh["cylinder"], steel, supports=[axis], loads=[push], degree=2)
block = cd.Body("block", mesh["block"], aluminium, supports=[axis, cd.Symmetry("bottom")], degree=2)
contact = cd.Contact((cylinder, "contact"), (block, "top"), cd.LinearLayer(stiffness=STIFFNESS))
scene = cd.Scene([cylinder, block], [contact])

# %% [markdown]
# ## The solution
#
# `solution.contact().area` is the length in contact, half of $2a$. A second
# estimate does not hang on single facets: fit Hertz' ellipse $p^2 = p_0^2\,(1 -
# x^2/a^2)$, a straight line over $x^2$, to the points that carry more than a third
# of the peak.

# %%
solution = cd.solve(scene)
result = solution.contact()
hertz = cd.reference.hertz_cylinder(LOAD, RADIUS, steel.E, steel.nu, E2=aluminium.E, nu2=aluminium.nu)
inside = result.pressure > 0.3 * result.pressure.max()
x, p = result.x[inside, 0], result.pressure[inside]
constant, slope = np.linalg.lstsq(np.column_stack([np.ones_like(x), -(x**2)]), p**2, rcond=None)[0]
numbers = {
    "half_width": result.area,
    "peak_pressure": float(result.pressure.max()),
    "fitted_half_width": float(np.sqrt(constant / slope)),
    "fitted_peak_pressure": float(np.sqrt(constant)),
    "hertz_half_width": hertz.half_width,
    "hertz_peak_pressure": hertz.peak_pressure,
    "force": result.force,
    "iterations": solution.iterations,
    "imbalance": solution.imbalance,
}
line = "{0:13} {1:9.3f} {4:3} (ellipse {2:.3f}), Hertz {3:.3f}"
print(f"{solution}\n")
for name, key, unit in (("half-width", "half_width", "mm"), ("peak pressure", "peak_pressure", "MPa")):
    print(line.format(name, numbers[key], numbers[f"fitted_{key}"], numbers[f"hertz_{key}"], unit))

# %% [markdown]
# ## Pictures
#
# The pressure with Hertz' ellipse, and the vertical stress, which spreads out below
# the contact.

# %%
figure = solution.plot_contact()
points = np.linspace(0.0, 1.2 * hertz.half_width, 400)
figure.axes[0].plot(points, hertz.pressure(points), "k--", linewidth=0.9, label="Hertz")
figure.axes[0].legend(frameon=False)
figure.savefig(report.path("contact.png"), dpi=150)
solution.plot_bodies(component="yy", path=report.path("bodies.png"))
report.summary(numbers)

# %% [markdown]
# ## What must hold
#
# Both estimates of both numbers within the two percent that Hertz' half-planes are
# good for. The forces on each body vanish to the residual, times the stiff layer.
# The pressure follows the normals of the turned surface, so its sum is a little
# more than the vertical load on this half.

# %%
for value, nafems in (("half_width", 6.21), ("peak_pressure", 3585.0)):
    assert abs(numbers[value] / nafems - 1) < 0.02
    assert abs(numbers[f"fitted_{value}"] / nafems - 1) < 0.02
assert solution.imbalance < 1e-9
assert 0 < result.force / (LOAD / 2) - 1 < 2e-3
