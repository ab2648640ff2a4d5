# %% [markdown]
# # Every layer law, and a column pressed through each
#
# A layer takes a pressure $p$ at the compression $c$. The laws here, with their
# parameters' units:
#
# - power, the paper's: $c = B p^a$; a joint of machined surfaces has $a = 1/2$;
# - linear: $p = k c$; a sheet of thickness $h$ on a rigid base has $k = M/h$;
# - hyperbolic (Barton, Bandis): $p = K c / (1 - c/V)$, with a wall at $V$;
# - logarithmic: $p = -M \log(1 - c/h)$, a coating that is pressed through at $h$;
# - exponential: $p = p_0 (e^{c/w_0} - 1)$, or without an end, as CalculiX has it,
#   $p = p_0 e^{\beta d}$ of the overclosure $d$;
# - overclosure (Abaqus): $p = p_0/(e - 1)\, s\,(e^s - 1)$, $s = 1 + d/c_0$;
# - rough surfaces (Greenwood, Williamson):
#   $p = \tfrac43 E^* \eta \sqrt R \sigma^{3/2} \int_{u/\sigma}^\infty (s - u/\sigma)^{3/2} \varphi(s)\, ds$;
# - a table, smooth or straight from point to point, and straight beyond its end;
# - layers in series: $c(p) = c_1(p) + c_2(p)$.
#
# CalculiX' law, Abaqus' and that of rough surfaces begin at a distance of the
# surfaces, their *clearance*; a contact takes it off its gap.
#
# ## Known beforehand: one equation for the pressure
#
# Two columns of height $H$ with $\nu = 0$ stand on each other, a layer between, and
# their ends are brought together by $\Delta$. The columns shorten by $p H/E$ each:
#
# $$ \frac{2 p H}{E} + c(p) = \Delta + \text{clearance} . $$

# %%
import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import brentq
from studies.results import Report

import contactdd as cd

report = Report("layers", "every layer law, and a column pressed through each of them")
E, HEIGHT, WIDTH = 2.1e5, 1.0, 2.0  # N, mm, MPa
TABLE = ([0.5e-3, 1e-3, 1.75e-3, 2.5e-3], [1.2, 5.0, 18.0, 42.0])

# %% [markdown]
# ## The laws
#
# Each with the overclosure up to which it is drawn.

# %%
coating = cd.LogarithmicLayer(modulus=30.0, thickness=2e-3)
joint = cd.PowerLayer.machined_joint(c=0.4, m=0.5)
summits = cd.GreenwoodWilliamsonLayer(modulus=1e5, density=300.0, radius=0.05, deviation=1e-3)
laws = {
    "power, a = 1.1": (cd.PowerLayer(B=4e-5, a=1.1), 2.5e-3),
    "machined joint": (joint, 2.5e-3),
    "foundation": (cd.LinearLayer.elastic_foundation(E=10.0, nu=0.3, thickness=1e-3), 2.5e-3),
    "hyperbolic": (cd.HyperbolicLayer(stiffness=5e3, closure=2e-3), 1.7e-3),
    "logarithmic": (coating, 1.6e-3),
    "exponential": (cd.ExponentialLayer(p0=3.0, w0=1e-3), 2.5e-3),
    "CalculiX exponential": (cd.ExponentialLayer.calculix(p0=5.0, c0=2e-3), 1e-3),
    "overclosure": (cd.OverclosureLayer(p0=3.0, c0=1e-3), 1.5e-3),
    "Greenwood–Williamson": (summits, 0.0),
    "table": (cd.TableLayer(*TABLE), 3e-3),
    "table, straight": (cd.TableLayer(*TABLE, smooth=False), 3e-3),
    "coating and joint": (cd.SeriesLayer(coating, joint), 2.5e-3),
}

# %% [markdown]
# ## The columns, solved and in closed form
#
# A scene for each law: two bodies between walls, and the layer between them.


# %%
def column(layer: cd.Layer, closure: float) -> cd.Scene:
    """Two columns between walls, the ends brought together by `closure` (mm)."""
    steel, sides = cd.Isotropic(E, 0.0), cd.Symmetry("left", "right")
    lower = cd.Body("lower", cd.rectangle((0, 0), (WIDTH, HEIGHT), (4, 2)), steel, supports=[sides, cd.Fixed("bottom")])
    push = cd.Displacement("top", [0, -closure])
    mesh = cd.rectangle((0, HEIGHT), (WIDTH, 2 * HEIGHT), (4, 2))
    upper = cd.Body("upper", mesh, steel, supports=[sides, push])
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), layer)])


def exact_pressure(layer: cd.Layer, closure: float) -> float:
    """The p of 2 p H/E + c(p) = Δ + clearance."""
    total = closure + layer.clearance
    excess = lambda p: 2 * p * HEIGHT / E - float(layer.compression(-p)) - total  # noqa: E731
    return brentq(excess, 0.0, total * E / (2 * HEIGHT), rtol=1e-14)


numbers, pressed = {}, {}
for name, (layer, end) in laws.items():
    closure = 0.4 * end if end > 0.0 else 1e-4
    result = cd.solve(column(layer, closure), tolerance=1e-12).contact()
    exact, found = exact_pressure(layer, closure), float(result.pressure.mean())
    pressed[name] = (-float(result.compression.mean()) - layer.clearance, found)
    numbers[name] = {"pressure": found, "exact": exact, "error": abs(found / exact - 1)}
    print(f"{name:22} p = {found:.10g} MPa, exactly {exact:.10g}")

# %% [markdown]
# ## A picture of all
#
# Pressure over overclosure, with the columns' pressures as dots. Where a law is not
# known any more, beyond a table's end, it goes on straight (dotted), and a solution
# that has passed that point warns.

# %%
figure = Figure(figsize=(11, 8), layout="constrained")
for axes, (name, (layer, end)) in zip(figure.subplots(3, 4).flat, laws.items(), strict=True):
    overclosure = np.linspace(-3e-3 if layer.clearance > 0 else -0.5e-3, end, 400)
    pressure = -layer.contact_stress(-overclosure - layer.clearance)
    known = overclosure + layer.clearance <= layer.compression_limit
    axes.plot(1e3 * overclosure[known], pressure[known], color="#1f5f8b")
    axes.plot(1e3 * overclosure[~known], pressure[~known], color="#1f5f8b", linestyle=":")
    axes.plot(1e3 * pressed[name][0], pressed[name][1], "o", color="#c1440e", markersize=5)
    if name.startswith("table"):
        axes.plot(1e3 * np.array(layer.compressions), layer.pressures, ".", color="0.2", markersize=5)
    axes.axvline(0.0, color="0.8", linewidth=0.8, zorder=0)
    axes.set_title(name, fontsize=10, loc="left")
    axes.set_ylim(0, None)
    axes.spines[["top", "right"]].set_visible(False)
figure.supxlabel("overclosure, µm (below 0: distance)")
figure.supylabel("pressure, MPa")
figure.savefig(report.path("layers.png"), dpi=150)
report.summary(numbers)

# %% [markdown]
# ## What must hold
#
# Every column obeys its equation, to the residual of $10^{-12}$ with a margin for a
# layer that takes but a small part of the closure.

# %%
for name, law in numbers.items():
    assert law["error"] < 1e-9, name
