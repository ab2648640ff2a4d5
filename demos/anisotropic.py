# %% [markdown]
# # Turned fibres: an anisotropic block whose contact pressure leans
#
# A block of spruce, glued to its base, lies under a steel block whose lower face is
# crowned, with the radius $R = 2$ m. The steel's top face is moved down step by
# step. Shape, supports and loading are symmetric about $x = 0$. The fibres are not:
# they lie in the plane, turned by an angle $\theta$ from the $x$ axis.
#
# ## Hooke's law
#
# Wood is orthotropic: three planes of symmetry, nine constants. In the axes of the
# fibres (1 along, 2 radial, 3 tangential) its compliance is
#
# $$\begin{pmatrix}\varepsilon_{11}\\ \varepsilon_{22}\\ \varepsilon_{33}\end{pmatrix} = \begin{pmatrix}
#   1/E_1 & -\nu_{12}/E_1 & -\nu_{13}/E_1 \\ & 1/E_2 & -\nu_{23}/E_2 \\ \text{sym.} & & 1/E_3
#   \end{pmatrix} \begin{pmatrix}\sigma_{11}\\ \sigma_{22}\\ \sigma_{33}\end{pmatrix},
#   \qquad 2\varepsilon_{ij} = \sigma_{ij}/G_{ij} .$$
#
# Turned by a rotation $Q$ the stiffness becomes $C_{ijkl} = Q_{ip} Q_{jq} Q_{kr}
# Q_{ls}\,C^0_{pqrs}$, and for an angle other than 0° and 90° it couples normal
# stresses to shear strains: pressed straight down, the block also shears sideways.
# That is what makes the pressure lean.
#
# ## Known beforehand
#
# - At 0° and 90° the material has the symmetry of the scene, and so must the
#   pressure, $p(x) = p(-x)$.
# - Fibres at $-\theta$ are the mirror image of fibres at $\theta$, so
#   $p_{-\theta}(x) = p_\theta(-x)$.
# - Along the fibre spruce is twelve times as stiff as across, so the steeper the
#   fibres the larger the force that the same approach needs; not by twelve times,
#   as the layer and the free ends take their part.
#
# Both statements on symmetry hold to rounding, since the mesh of squares is its own
# mirror image.

# %%
import numpy as np
from matplotlib.figure import Figure
from studies.results import Report

import contactdd as cd

report = Report("anisotropic", "a wooden block with turned fibres under a crowned steel block")

# %% [markdown]
# ## The scene
#
# mm and MPa; a nonlinear layer $w = -B\,p^a$ between the two. The approach is a
# `Parameter`: a number that a support, a load or a gap follows, so that a scene
# need not be made anew for every step. `field` makes of it a function of the
# coordinates.

# %%
WIDTH, HEIGHT, RADIUS, APPROACH, ANGLE = 40.0, 10.0, 2000.0, 0.06, 30.0
spruce = cd.Orthotropic(E1=11e3, E2=900, E3=500, nu12=0.38, nu13=0.45, nu23=0.45, G12=700, G13=650, G23=40)
steel, layer = cd.Isotropic(E=2.1e5, nu=0.3), cd.PowerLayer(B=2e-4, a=1.1)
approaches = np.linspace(0.2, 1.0, 5) * APPROACH


def block(name, floor, material, support):
    """A block of 40 × 10 squares of 1 mm, with quadratic displacements."""
    corners = (-WIDTH / 2, floor), (WIDTH / 2, floor + HEIGHT)
    mesh = cd.rectangle(*corners, (40, 10), shape="quadrilateral")
    return cd.Body(name, mesh, material, supports=[support], degree=2)


def crowned(degrees, approach):
    """Spruce below, its fibres turned; steel above, its top moved down and its lower face a parabola x² / 2R."""
    wood = block("wood", 0, spruce.rotated(np.radians(degrees)), cd.Fixed("bottom"))
    down = approach.field(lambda depth, x: np.full(x.shape[1], -depth))
    punch = block("steel", HEIGHT, steel, cd.Displacement("top", (None, down)))
    contact = cd.Contact((wood, "top"), (punch, "bottom"), layer, gap=lambda x: x[0] ** 2 / (2 * RADIUS))
    return cd.Scene([wood, punch], [contact])


# %% [markdown]
# ## One solution
#
# Fibres at 30° and the whole approach at once. The integration points of the
# contact lie mirrored about $x = 0$, so that a pressure can be compared with its
# own mirror image point by point: `lean` is zero for a symmetric one.


# %%
def along(solution):
    """x and the pressure along the contact, from left to right."""
    result = solution.contact()
    order = np.argsort(result.x[:, 0])
    return result.x[order, 0], result.pressure[order]


def lean(solution):
    """How unlike its mirror image the pressure is: max |p(x) − p(−x)| / max p."""
    pressure = along(solution)[1]
    return float(np.abs(pressure - pressure[::-1]).max() / pressure.max())


scene = crowned(ANGLE, cd.Parameter(APPROACH))
solution = cd.solve(scene)
print(f"{solution}\nfibres at {ANGLE:g}°: the pressure leans by {lean(solution):.3f}\n")

# %% [markdown]
# ## Load programmes
#
# For every angle the approach grows in five steps. Each starts from the last one's
# displacements, and nothing is factored again: a prescribed displacement enters the
# right-hand side only. Contact without friction has no memory, so the steps are
# there for the curve and not for the answer, which is the same in one step.
# `record` keeps what is of interest at each step: the force, the width in contact,
# the peak of the pressure and its lean.
#
# The table shows how the lean comes and goes: it is zero where the axes of the wood
# are those of the block, and largest not at 45° but near 30°.


# %%
def press(degrees):
    """The load programme for one angle."""
    approach = cd.Parameter(0.0)
    record = {
        "force": lambda s: s.contact().force,
        "area": lambda s: s.contact().area,
        "peak": lambda s: s.contact().pressure.max(),
        "lean": lean,
    }
    return cd.programme(crowned(degrees, approach), approach, approaches, record=record, tolerance=1e-11)


paths = {degrees: press(degrees) for degrees in (0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0)}
last = {degrees: path.solutions[-1] for degrees, path in paths.items()}
angles = [
    {"angle": degrees} | {name: float(values[-1]) for name, values in path.records.items()}
    for degrees, path in paths.items()
]
print("fibres     force   peak p     area    lean")
for row in angles:
    print("{angle:5.0f}° {force:9.3f} {peak:8.3f} {area:8.3f} {lean:7.4f}".format(**row))

# %% [markdown]
# ## The mirror image
#
# The same programme with the fibres at −30°: its pressure read from right to left.
# This is a sharp test of the rotation of the stiffness: a wrong sign in one of the
# coupling terms would leave the scenes with 0° and 90° as they are, and change this
# one. The force balance printed below is what is left of all forces on the bodies;
# the rounding of the steel, twenty times as stiff as the wood along its fibres,
# enters it.

# %%
turned, mirrored = last[ANGLE], press(-ANGLE).solutions[-1]
there, image = along(turned)[1], along(mirrored)[1][::-1]
numbers = {
    "angle": ANGLE,
    "peak_pressure": float(there.max()),
    "force": turned.contact().force,
    "asymmetry": lean(turned),
    "asymmetry_angle_0": lean(last[0.0]),
    "mirror_difference": float(np.abs(there - image).max() / there.max()),
    "force_balance": turned.imbalance,
    "iterations": [step.iterations for step in paths[ANGLE].solutions],
    "angles": angles,
}
print(f"\nasymmetry at {ANGLE:g}°: {numbers['asymmetry']:.4f}, at 0°: {numbers['asymmetry_angle_0']:.1e}")
print(f"difference of 30° and the mirror image of −30°: {numbers['mirror_difference']:.1e}")
print(f"force balance: {numbers['force_balance']:.1e}")

# %% [markdown]
# ## Pictures
#
# The pressure for 0°, 30° and −30°, and the force against the approach: it grows
# faster than linearly, as the contact widens. In the third the blocks are drawn
# with their displacements enlarged: the wood leans, and its vertical stress is
# turned towards the fibres.


# %%
def curves(name, label, lines):
    """A picture of named lines (x, y, style)."""
    figure = Figure(figsize=(7, 4.2), layout="constrained")
    axes = figure.subplots()
    for title, (x, y, style) in lines.items():
        axes.plot(x, y, style, label=f"fibres at {title:g}°")
    axes.set(xlabel=label[0], ylabel=label[1])
    axes.legend(frameon=False)
    axes.grid(alpha=0.3)
    figure.savefig(report.path(name), dpi=150)


pressures = {0.0: (*along(last[0.0]), "-"), ANGLE: (*along(turned), "-"), -ANGLE: (*along(mirrored), "--")}
curves("pressure.png", ("x, mm", "contact pressure, MPa"), pressures)
forces = {degrees: (path.values, path.records["force"], ".-") for degrees, path in paths.items()}
curves("paths.png", ("approach, mm", "force per thickness, N/mm"), forces)
turned.plot_bodies(component="yy", path=report.path("bodies.png"))
report.summary(numbers)

# %% [markdown]
# ## What must hold
#
# What was known beforehand; and that the programme ends where the single solve did.

# %%
assert max(numbers["mirror_difference"], numbers["asymmetry_angle_0"], lean(last[90.0])) < 1e-9
assert numbers["asymmetry"] > 0.1
assert np.all(np.diff([row["force"] for row in angles]) > 0)
assert np.allclose(along(solution)[1], there, rtol=0, atol=1e-7 * there.max())
