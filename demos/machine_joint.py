# %% [markdown]
# # The stiffness of a machine joint
#
# A column is bolted to a bed. Both surfaces are ground or scraped, and touch at their
# asperities only: half of the compliance of a machine tool is in such joints. They get
# stiffer the more they are pressed, so bolts are tightened.
#
# ## The law
#
# Measurements of flat joints follow a power of the pressure,
#
# $$\lambda = c\,p^m, \qquad m \approx \tfrac12,$$
#
# $\lambda$ the approach in µm, $p$ the pressure in N/mm², $c$ some 0.2 to 3 by the
# finish. That is the power layer of the paper; `PowerLayer.machined_joint` takes the
# constants in the units of that literature. Its stiffness per area is
#
# $$k = \frac{dp}{d\lambda} = \frac{p^{1-m}}{m\,c},$$
#
# so that a joint of the area $A$ under the force $F$ between bodies that are far
# stiffer has $K = A\,k(F/A)$, which grows with the root of the force. Elastic bodies
# are in series with it: an even column of the lengths $L_i$ has
#
# $$\frac1K = \frac{1}{A\,k} + \sum_i \frac{L_i}{E' A}, \qquad E' = \frac{E(1-\nu)}{(1+\nu)(1-2\nu)},$$
#
# $E'$ between walls that let nothing move sideways.

# %%
import matplotlib.pyplot as plt
import numpy as np
from studies.results import Report

import contactdd as cd

report = Report("machine_joint", "The stiffness of machine joints over the load against their law")
E, NU, HEIGHT, WIDTH = 1.1e5, 0.25, 60.0, 100.0  # cast iron; N, mm
MODULUS, IRON = E * (1 - NU) / ((1 + NU) * (1 - 2 * NU)), cd.Isotropic(E, NU)
FINISHES = {"ground": (0.3, 0.5), "scraped": (0.8, 0.5), "milled": (2.0, 0.45)}

# %% [markdown]
# ## Two scenes
#
# 1. The whole upper face is pushed down between walls: the pressure is even, and the
#    sum above is exact.
# 2. A bolt's head, a tenth of the width in the middle, is pushed down, the sides are
#    free. Then the blocks give under the head as well, and bend: the stiffer the joint,
#    the more of its pressure is under the bolt, and the less of the area takes part.
#
# `solution.normal_stiffness()` is $dF/d\delta$ of the joint and the bodies between what
# holds them, from the tangent of the solution: no second solve is needed, no
# difference. It would be zero if a load pressed the column: loads fix their force.


# %%
def joint(layer: cd.Layer, depth: cd.Parameter, bolted: bool) -> cd.Scene:
    cells = (np.linspace(0, WIDTH, 41), np.linspace(0, HEIGHT, 21))
    low = cd.rectangle((0, 0), (WIDTH, HEIGHT), cells, shape="quadrilateral")
    high = low.moved((0, HEIGHT))
    high = high.with_surfaces(bolt=lambda x: (abs(x[1] - 2 * HEIGHT) < 1e-9) & (abs(x[0] / WIDTH - 0.5) < 0.0501))
    walls = [] if bolted else [cd.Symmetry("left", "right")]
    pushed = cd.Displacement("bolt" if bolted else "top", (0.0, depth))
    bed = cd.Body("bed", low, IRON, supports=[cd.Fixed("bottom"), *walls], degree=2)
    column = cd.Body("column", high, IRON, supports=[pushed, *walls], degree=2)
    return cd.Scene([bed, column], [cd.Contact((bed, "top"), (column, "bottom"), layer)])


def law(pressure: np.ndarray, c: float, m: float) -> np.ndarray:
    """The stiffness of the joint alone."""
    return WIDTH * pressure ** (1 - m) / (m * c * 1e-3)


BLOCKS = 2 * HEIGHT / (MODULUS * WIDTH)  # their compliance between walls
down, rows = cd.Parameter(0.0), {}
record = {"K": lambda s: s.normal_stiffness(), "mean": lambda s: s.contact().force / WIDTH}
record["peak"] = lambda s: s.contact().peak_pressure * WIDTH / s.contact().force
for name, (c, m) in FINISHES.items():
    layer, wanted = cd.PowerLayer.machined_joint(c, m), np.array([0.1, 0.3, 1.0, 3.0, 10.0])
    depths = -(c * 1e-3 * wanted**m + BLOCKS * WIDTH * wanted)
    even, bolted = (
        cd.programme(joint(layer, down, head), down, depths, record=record).records for head in (False, True)
    )
    alone = 1 / (1 / even["K"] - BLOCKS)  # what is left for the joint
    row = rows[name] = {"mean": wanted.tolist(), "even": even["K"].tolist(), "bolted": bolted["K"].tolist()}
    row |= {"bolted mean": bolted["mean"].tolist(), "peak": bolted["peak"].tolist()}
    row["exponent"] = float(np.polyfit(np.log(wanted), np.log(alone), 1)[0])
    row["error"] = float(np.abs(alone / law(wanted, c, m) - 1).max())
    print(
        f"{name:8} K ~ p^{row['exponent']:.5f}, off the law by {row['error']:.0e}; bolted: of the law and blocks",
        end=" ",
    )
    row["part"] = (bolted["K"] * (1 / law(bolted["mean"], c, m) + BLOCKS)).tolist()
    print(np.round(row["part"], 3), "peak over mean", np.round(bolted["peak"], 2))

# %% [markdown]
# Reading: less what the blocks take, the even joint is the law to rounding, over two
# decades of the pressure. Of that stiffness the bolted one reaches half to four fifths:
# the stiffer the joint is, by its finish or its load, the more the blocks count, and
# the farther is the peak pressure from the mean. A milled joint is so soft at first
# that its pressure stays nearly even.
#
# What follows for the designer: a finer finish helps where the pressure is small, and
# there a factor of ten in the bolts' force is a factor of three in the stiffness. From
# some 3 N/mm² on all three finishes come to nearly the same, for the blocks give more
# than the joint; more bolts, or a thicker flange under them, then do more than tighter
# ones.
#
# One more solve shows the pressure under the bolt for the ground surfaces, 60 mm below
# its head. It is a quarter larger in the middle than the mean, and nowhere zero: the
# joint is closed up to its edges.

# %%
down.value = -5e-3
scene = joint(cd.PowerLayer.machined_joint(*FINISHES["ground"]), down, bolted=True)
solution = cd.solve(scene)
result = solution.contact().sorted()

# %% [markdown]
# ## Pictures
#
# Left the stiffness over the mean pressure: dots are the even joint, the line its law
# with the blocks in series, crosses the bolted one. Both axes are logarithmic: at first
# the lines rise with the slope $1-m$, then the blocks' own stiffness bounds them. Right
# the pressure under the bolt.

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.8), layout="constrained")
for colour, (name, (c, m)) in zip(("C0", "C1", "C2"), FINISHES.items(), strict=True):
    pressure = np.geomspace(0.02, 12, 50)
    left.loglog(pressure, 1 / (1 / law(pressure, c, m) + BLOCKS), color=colour, label=name)
    left.loglog(rows[name]["mean"], rows[name]["even"], "o", color=colour, markersize=4)
    left.loglog(rows[name]["bolted mean"], rows[name]["bolted"], "x", color=colour, markersize=5)
right.plot(result.x[:, 0], result.pressure, color="C0")
left.set(xlabel="mean pressure (N/mm²)", ylabel="stiffness per thickness (N/mm²)")
right.set(xlabel="x (mm)", ylabel="pressure (N/mm²)", ylim=(0, None), title="ground, bolted")
left.legend(frameon=False)
figure.savefig(report.path("stiffness.png"), dpi=150)
report.summary(rows)

# %% [markdown]
# ## What must hold
#
# The even joint's stiffness is its law's, and so is the exponent $1 - m$; the tolerance
# is that of the solves, magnified by taking the blocks away. The bolted joint is softer,
# and beside its law the softer the stiffer its surfaces are.

# %%
for name, (_, m) in FINISHES.items():
    assert rows[name]["error"] < 1e-6
    assert abs(rows[name]["exponent"] - (1 - m)) < 1e-6
    assert all(np.diff(rows[name]["part"]) < 0)
assert rows["ground"]["peak"][-1] > rows["milled"]["peak"][-1] > rows["milled"]["peak"][0] > 1
assert solution.imbalance < 1e-9
