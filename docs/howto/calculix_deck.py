# %% [markdown]
# # Coming from Abaqus or CalculiX: a deck as a scene
#
# `cd.read_scene` takes a whole deck: mesh, `*ELASTIC`, `*EXPANSION`, `*SURFACE BEHAVIOR` (linear, exponential, tabular,
# hard), `*CONTACT PAIR`, `*CLEARANCE`, `*BOUNDARY`, `*CLOAD`, `*DLOAD`, `*DSLOAD`, `*TEMPERATURE`, `*AMPLITUDE`; the
# loads and supports at the end of the last step count. What changes the solution and is not understood is listed and
# refused; what of it may be left out is yours to say, by `ignore=[...]`.
#
# Here a ring is pressed into another one, too large by $\delta = 10^{-4}$, through a linear pressure–overclosure $k$.
# Lamé's rings (free ends) of inner, common and outer radius $i, c, o$ give
#
# $$ \frac{\delta}{p} = \frac1k
#   + \frac{c}{E} \left[ \frac{o^2 + c^2}{o^2 - c^2} + \frac{c^2 + i^2}{c^2 - i^2} \right] . $$

# %%
from pathlib import Path

import contactdd as cd

i, c, o, delta, E, k = 0.95, 1.05, 1.15, 1e-4, 2.1e5, 1e7
nodes, cells = "", ""
for ring, (low, high) in enumerate([(i + delta, c + delta), (c, o)]):
    for n in range(10):  # two rows of five nodes
        x, y = low + (high - low) * (n % 5) / 4, 0.05 * (n // 5)
        nodes += f"{100 * ring + n + 1}, {x:.15g}, {y:.15g}\n"
    cells += f"*ELEMENT, TYPE=CAX4, ELSET={('INNER', 'OUTER')[ring]}\n"
    for n in range(4):
        corners = [100 * ring + n + place for place in (1, 2, 7, 6)]
        cells += f"{10 * ring + n + 1}, {str(corners)[1:-1]}\n"
Path("rings.inp").write_text(f"""*NODE, NSET=ALL
{nodes}{cells}*NSET, NSET=FLOOR
1, 2, 3, 4, 5, 101, 102, 103, 104, 105
*MATERIAL, NAME=STEEL
*ELASTIC
{E}, 0.3
*SOLID SECTION, ELSET=INNER, MATERIAL=STEEL
*SOLID SECTION, ELSET=OUTER, MATERIAL=STEEL
*SURFACE, NAME=SHAFT
4, S2
*SURFACE, NAME=HUB
11, S4
*SURFACE INTERACTION, NAME=COAT
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
{k},
*CONTACT PAIR, INTERACTION=COAT, TYPE=SURFACE TO SURFACE
SHAFT, HUB
*BOUNDARY
FLOOR, 2, 2
""")

# %% [markdown]
# The sets and surfaces of the deck are the names of bodies and surfaces; all that a scene can do is open now: methods,
# other layers, load programmes, `cd.error_estimate`.

# %%
scene = cd.read_scene("rings.inp")
print(scene)
pressure = cd.solve(scene).contact("SHAFT-HUB").mean_pressure
lame = delta / (1 / k + c / E * ((o**2 + c**2) / (o**2 - c**2) + (c**2 + i**2) / (c**2 - i**2)))
print(f"p = {pressure:.4f}, Lamé {lame:.4f}")
assert abs(pressure / lame - 1) < 5e-3  # four linear cells across each ring
