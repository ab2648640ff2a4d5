# %% [markdown]
# # A sphere on a plate
#
# A steel ball of radius $R$ is pressed on an aluminium plate with the force $F$. Hertz gives the radius of contact $a$
# and the peak pressure for a plate that is thick; what if it is only a few $a$ thick, and lies on a hard table?
#
# The ball is far harder than the plate and needs no mesh: `RigidBody` with a `Sphere`, free along the axis and pressed
# by the force. The plate is a mesh of revolution with cells that shrink towards the contact. Hertz knows no layer;
# `HardContact` has none: $p \ge 0$, gap $\ge 0$, and $p = 0$ where there is a gap.
#
# $$ a^3 = \frac{3 F R}{4 E^*}, \qquad p_0 = \frac{3 F}{2 \pi a^2}, \qquad E^* = \frac{E}{1 - \nu^2} . $$

# %%
import numpy as np

import contactdd as cd

R, F = 20.0, 100.0  # mm, N
aluminium = cd.Isotropic(E=7e4, nu=0.33)
hertz = cd.reference.hertz_sphere(F, R, aluminium.E, aluminium.nu)
a = hertz.radius


def pressed(thickness):
    """The ball on a plate of a thickness."""
    fine = np.linspace(0, 1.5 * a, 31)
    radii = np.concatenate([fine, np.geomspace(1.5 * a, 30 * a, 24)[1:]])
    near = fine[fine < thickness / 2]
    depths = np.concatenate([near, np.geomspace(near[-1], thickness, 20)[1:]])
    mesh = cd.rectangle((0, -thickness), (30 * a, 0), (radii, -depths[::-1]), shape="quadrilateral")
    supports = [cd.Symmetry("left"), cd.Fixed("bottom")]
    plate = cd.Body("plate", mesh, aluminium, supports=supports, degree=1, kinematics="axisymmetric")
    ball = cd.RigidBody("ball", cd.Sphere((0, R), R), displacement=(0, None), force=(0, -F), kinematics="axisymmetric")
    return cd.solve(cd.Scene([plate, ball], [cd.Contact((plate, "top"), ball, cd.HardContact())]))


print(f"Hertz:                 a = {a:.4f} mm, p0 = {hertz.peak_pressure:6.1f} MPa")
solutions = {thickness: pressed(thickness * a) for thickness in (30, 4, 2, 1)}
for thickness, solution in solutions.items():
    disc = solution.contact()
    radius = np.sqrt(disc.area / np.pi)
    print(f"plate {thickness:2} a thick:       a = {radius:.4f} mm, p0 = {disc.peak_pressure:6.1f} MPa")

# %% [markdown]
# The thick plate is Hertz' half-space to the width of a cell, $a/20$; the thinnest is stiffer, with a smaller contact
# and a higher peak. The pressures over the radius:

# %%
import matplotlib.pyplot as plt

figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
for (thickness, solution), colour in zip(solutions.items(), ("#0072B2", "#009E73", "#E69F00", "#D55E00"), strict=True):
    disc = solution.contact().sorted()
    axes.plot(disc.x[:, 0] / a, disc.pressure, color=colour, label=f"{thickness} a thick")
r = np.linspace(0, 1, 200)
axes.plot(r, hertz.peak_pressure * np.sqrt(1 - r**2), "k:", label="Hertz")
axes.set(xlabel="r / a", ylabel="pressure [MPa]", xlim=(0, 1.3), ylim=(0, None))
axes.legend(frameon=False)
figure.savefig("sphere.png", dpi=120)

# %% [markdown]
# Against Hertz, radius and peak of the thick plate:

# %%
assert abs(np.sqrt(solutions[30].contact().area / np.pi) / a - 1) < 0.05  # a cell
assert abs(solutions[30].contact().peak_pressure / hertz.peak_pressure - 1) < 0.02
