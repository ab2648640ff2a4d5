# %% [markdown]
# # A bolted flange with a gasket
#
# A pipe flange is pressed on its gasket by bolts; then the pressure in the pipe comes up, pushes the flanges apart and
# takes load off the gasket. It leaks where the pressure on the gasket falls below the pressure inside. How much of the
# bolts' force is left, and where?
#
# The gasket is a layer: its law is the loading curve measured on a sheet, compression over pressure, as a table.
# Where the sheet ends, contact ends: the surface `gasket` is the part of the flange's face that it covers. A coating on
# its faces, a power law, is a second layer in series with it: both carry the same pressure. A gasket that unloads on
# another curve than it was loaded on is a `cd.GasketLayer`, in [this demo](../demos/flange.py).
#
# Both flanges are alike, so one is enough: the other is its image behind a `MirrorPlane`. The bolts' force $F$ is a
# traction on the ring under their heads. The pressure $p$ acts on the bore, and pulls at the end of the pipe with
# $p\,\pi r_i^2$.

# %%
import numpy as np

import contactdd as cd

BORE, PIPE, SEAL, BOLTS, RIM = 50.0, 58.0, (54.0, 68.0), (74.0, 82.0), 90.0  # radii in mm
FORCE = 120e3  # N, of all bolts together
steel = cd.Isotropic(E=2.1e5, nu=0.3)  # MPa
sheet = cd.TableLayer(compressions=[0.05, 0.1, 0.2, 0.3, 0.4], pressures=[2.0, 6.0, 20.0, 45.0, 90.0])
layer = cd.SeriesLayer(cd.PowerLayer(B=4e-4, a=0.8), sheet)  # the coating, on the sheet

radii = [50, 52, *np.linspace(54, 68, 29), *np.linspace(70, 90, 11)]
mesh = cd.rectangle((BORE, 0), (RIM, 24), (radii, 12), shape="quadrilateral").with_surfaces(
    gasket=lambda x: (x[1] < 1e-9) & (x[0] > SEAL[0] - 1e-9) & (x[0] < SEAL[1] + 1e-9),
    washers=lambda x: (x[1] > 24 - 1e-9) & (x[0] > BOLTS[0] - 1e-9) & (x[0] < BOLTS[1] + 1e-9),
    pipe=lambda x: (x[1] > 24 - 1e-9) & (x[0] < PIPE + 1e-9),
)
pressure = cd.Parameter(0.0)
end = pressure.field(lambda p, x: np.array([0 * x[0], 0 * x[0] + p * BORE**2 / (PIPE**2 - BORE**2)]))
loads = [cd.Resultant("washers", (0, -FORCE)), cd.Pressure("left", pressure), cd.Traction("pipe", end)]
flange = cd.Body("flange", mesh, steel, loads=loads, degree=2, kinematics="axisymmetric")
other = cd.MirrorPlane("other flange", (0, 0), (0, 1), kinematics="axisymmetric")
contact = cd.Contact((flange, "gasket"), other, layer, name="gasket")
scene = cd.Scene([flange, other], [contact])

# %% [markdown]
# `programme` lets the pressure go through values, each solve started from the last. What is wanted of every step is
# recorded: the force on the gasket, and the pressure at its inner edge.

# %%
record = {
    "force on the gasket": lambda s: s.contact("gasket").force,
    "at the inner edge": lambda s: s.contact("gasket").at([[SEAL[0], 0]])["pressure"][0],
}
path = cd.programme(scene, pressure, [0, 2, 4, 6, 8], record=record)
for p, force, inner in zip(path.values, *path.records.values(), strict=True):
    tight = "tight" if inner > p else "LEAKS"
    print(f"{p:3.0f} MPa inside: {force / 1e3:6.1f} kN on the gasket, {inner:5.1f} MPa at its inner edge, {tight}")
path.plot_contact(label="{value} MPa inside", path="gasket.png", stress_unit="MPa", length_unit="mm")

# %% [markdown]
# The bolts turn the flange over its gasket: it is pressed hardest at its outer edge, and the pressure in the pipe takes
# from the inner one. The flange under the highest pressure, its displacements enlarged:

# %%
path.solutions[-1].plot_bodies(component="von Mises", unit="MPa", path="flange.png")

# %% [markdown]
# Equilibrium says what is left on the gasket, $F - p\,\pi r_i^2$, to the iteration's residual:

# %%
for p, force in zip(path.values, path.records["force on the gasket"], strict=True):
    assert abs(force - (FORCE - p * np.pi * BORE**2)) < 1e-6 * FORCE
