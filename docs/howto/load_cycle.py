# %% [markdown]
# # A load that comes and goes
#
# A bridge bearing: a steel rocker on a rubber pad, of which the load rises to a maximum, and falls again. One
# parameter drives it; each step starts from the last, and nothing is factored again. The path is a table, a picture of
# the contact in every step, small multiples, and an animation.
#
# The rubber is a layer with a measured, stiffening curve. It is elastic here, as all layers of contactdd are: on the
# way back the pressures are those of the way up.

# %%
import numpy as np

import contactdd as cd

R, LENGTH = 200.0, 60.0  # mm
steel, concrete = cd.Isotropic(E=2.1e5, nu=0.3), cd.Isotropic(E=3e4, nu=0.2)
rubber = cd.TableLayer(compressions=[0.5, 1.0, 1.5, 2.0, 2.5], pressures=[0.8, 2.0, 4.5, 10.0, 22.0])
load = cd.Parameter(0.0)


def rocker(x):
    """The gap under the rocker's arc."""
    return x[0] ** 2 / (2 * R)


sides = [cd.Symmetry("left")]
foot = cd.rectangle((0, -40), (LENGTH, 0), (60, 20), shape="quadrilateral")
head = cd.rectangle((0, 0), (LENGTH, 30), (60, 15), shape="quadrilateral")
pier = cd.Body("pier", foot, concrete, supports=[*sides, cd.Fixed("bottom")])
bearing = cd.Body("bearing", head, steel, supports=sides, loads=[cd.Pressure("top", load)])
contact = cd.Contact((pier, "top"), (bearing, "bottom"), rubber, gap=rocker, name="rubber")
cycle = [1.0, 2.0, 4.0, 2.0]  # MPa
record = {"force": lambda s: s.contact().force, "contact": lambda s: s.contact().area}
path = cd.programme(cd.Scene([pier, bearing], [contact]), load, cycle, record=record)
path.to_csv("cycle.csv")
for step, (q, force, width) in enumerate(zip(path.values, *path.records.values(), strict=True), 1):
    print(f"step {step}: {q:.0f} MPa, force {force:6.1f} N/mm, in contact {width:5.2f} mm")
path.plot_contact(label="step {step}: {value} MPa", path="steps.png", stress_unit="MPa", length_unit="mm")

# %%
path.plot_bodies(columns=2, component="yy", unit="MPa", path="multiples.png")

# %% [markdown]
# `path.animate("cycle.gif")` draws the same as an animation, `path.export(folder)` writes a series for ParaView. What
# came back is what was there:

# %%
path.animate("cycle.gif", component="yy", per_second=2, size=(480, 320))
up, down = (path.solutions[step].contact().pressure for step in (1, 3))
assert np.abs(up - down).max() < 1e-8 * up.max()  # both to the iteration's residual, 1e-10 of the forces
