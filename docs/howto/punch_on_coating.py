# %% [markdown]
# # A punch on a coated surface
#
# A flat punch with rounded edges is pressed into a steel part that has a soft coating. Without the coating the pressure
# peaks at the punch's edge; the coating spreads it. How thick has it to be to halve the peak?
#
# The punch is a `Profile`: flat up to its half width $b$, then an arc. The coating is a `LogarithmicLayer`,
# $p = -M\log(1 - c/h)$: a sheet of thickness $h$ and modulus $M$ between two hard bodies, soft at first, and never
# pressed through. The steel part is an elastic half-plane known by its influence functions, so it needs no mesh.

# %%
import numpy as np

import contactdd as cd

b, R, P = 5.0, 2.0, 400.0  # mm: half width, radius of the edges; N per mm of thickness
steel = cd.Isotropic(E=2.1e5, nu=0.3)
half = np.concatenate([np.linspace(0, 4.5, 46)[:-1], np.linspace(4.5, 5.6, 89)])  # fine where the edges are
part = cd.HalfPlane("part", steel, np.concatenate([-half[:0:-1], half]), reference=100.0)


def shape(x):
    """The height of the punch's end over its middle: flat, then an arc."""
    return np.maximum(np.abs(x) - b, 0) ** 2 / (2 * R)


punch = cd.RigidBody("punch", cd.Profile(shape), displacement=(0, None), force=(0, -P))
solutions = {}
for h in (0.002, 0.01, 0.05, 0.2):
    coating = cd.LogarithmicLayer(modulus=4e3, thickness=h)
    scene = cd.Scene([part, punch], [cd.Contact(part, punch, coating, name="coating")])
    solutions[h] = cd.solve(scene)
    result = solutions[h].contact("coating")
    worn = -result.compression.min() / h
    print(f"h = {h:5.3f} mm: peak {result.peak_pressure:6.1f} MPa, coating compressed by {worn:5.1%} at most")
    assert abs(result.force / P - 1) < 1e-8

# %% [markdown]
# The mean pressure, $P/2b$, is 40 MPa. All four in one picture; `contact(...).frame()` gives the same numbers to
# pandas, `to_csv` to a file.

# %%
import matplotlib.pyplot as plt

figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
colours = ("#0072B2", "#009E73", "#E69F00", "#D55E00")
for (h, solution), colour in zip(solutions.items(), colours, strict=True):
    result = solution.contact().sorted()
    axes.plot(result.x[:, 0], result.pressure, color=colour, label=f"h = {h} mm")
axes.set(xlabel="x [mm]", ylabel="pressure [MPa]", ylim=(0, None))
axes.legend(frameon=False)
figure.savefig("punch.png", dpi=120)
