"""Every layer law beside its formula, and a column pressed through each of them.

A layer takes the pressure p at the compression c. The laws and their units (stress, length):

- power, the paper's: c = B p^a; a joint of machined surfaces has a = 1/2;
- linear: p = k c, also an elastic foundation k = M/h of a sheet of thickness h, bonded or sliding;
- hyperbolic (Barton, Bandis): p = K c / (1 - c/V), with a wall at V;
- logarithmic: p = -M log(1 - c/h), a coating that is pressed through at h;
- exponential: p = p₀ (e^(c/w₀) - 1); where it has no end, p = p₀ e^(-u/w₀) of the separation u, as CalculiX has it;
- overclosure (Abaqus): p = p₀/(e - 1) s (e^s - 1), s = 1 + d/c₀, from the clearance c₀ on;
- Greenwood and Williamson: p = (4/3) E* η R^(1/2) σ^(3/2) ∫ (s - u/σ)^(3/2) φ(s) ds, from the separation 8σ on;
- a table, smooth or from point to point, straight beyond its last point;
- two laws in series: c(p) = c₁(p) + c₂(p).

Between two columns of height H, with ν = 0, whose ends are brought together by Δ, each of them obeys 2 p H/E + c(p) = Δ
plus the clearance: an equation for p that is solved here without the solver, and has to agree with it.
"""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from report import Report
from scipy.optimize import brentq

import contactdd as cd

# N, mm, MPa
E, HEIGHT, WIDTH = 2.1e5, 1.0, 2.0
TABLE = ([0.5e-3, 1e-3, 1.75e-3, 2.5e-3], [1.2, 5.0, 18.0, 42.0])


def layers() -> dict[str, tuple[cd.Layer, float]]:
    """The laws by name, each with the compression up to which it is drawn."""
    coating = cd.LogarithmicLayer(modulus=30.0, thickness=2e-3)
    return {
        "power, a = 1.1": (cd.PowerLayer(B=4e-5, a=1.1), 2.5e-3),
        "machined joint": (cd.PowerLayer.machined_joint(c=0.4, m=0.5), 2.5e-3),
        "foundation": (cd.LinearLayer.elastic_foundation(E=10.0, nu=0.3, thickness=1e-3), 2.5e-3),
        "hyperbolic": (cd.HyperbolicLayer(stiffness=5e3, closure=2e-3), 1.7e-3),
        "logarithmic": (coating, 1.6e-3),
        "exponential": (cd.ExponentialLayer(p0=3.0, w0=1e-3), 2.5e-3),
        "CalculiX exponential": (cd.ExponentialLayer.calculix(p0=5.0, c0=2e-3), 1e-3),
        "overclosure": (cd.OverclosureLayer(p0=3.0, c0=1e-3), 1.5e-3),
        "Greenwood–Williamson": (
            cd.GreenwoodWilliamsonLayer(modulus=1e5, density=300.0, radius=0.05, deviation=1e-3),
            0.0,
        ),
        "table": (cd.TableLayer(*TABLE), 3e-3),
        "table, straight": (cd.TableLayer(*TABLE, smooth=False), 3e-3),
        "coating and joint": (cd.SeriesLayer(coating, cd.PowerLayer.machined_joint(c=0.4, m=0.5)), 2.5e-3),
    }


def column(layer: cd.Layer, closure: float) -> cd.Scene:
    """Two columns between walls, the ends brought together by `closure` (length)."""
    steel, sides = cd.Isotropic(E, 0.0), cd.Symmetry("left", "right")
    lower = cd.Body("lower", cd.rectangle((0, 0), (WIDTH, HEIGHT), (4, 2)), steel, supports=[sides, cd.Fixed("bottom")])
    upper = cd.Body(
        "upper",
        cd.rectangle((0, HEIGHT), (WIDTH, 2 * HEIGHT), (4, 2)),
        steel,
        supports=[sides, cd.Displacement("top", [0, -closure])],
    )
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), layer)])


def exact_pressure(layer: cd.Layer, closure: float) -> float:
    """p of 2 p H/E + c(p) = Δ + clearance."""
    total = closure + layer.clearance
    highest = total * E / (2 * HEIGHT)
    return brentq(lambda p: 2 * p * HEIGHT / E - float(layer.compression(-p)) - total, 0.0, highest, rtol=1e-14)


def draw(laws: dict[str, tuple[cd.Layer, float]], pressed: dict[str, tuple[float, float]], path) -> None:
    """Pressure over overclosure of every law, its limit, and the columns' pressures."""
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
    figure.supxlabel("overclosure, µm (below 0: distance); dotted: beyond what the law knows; dot: the column")
    figure.supylabel("pressure, MPa")
    figure.savefig(path, dpi=150)


def main(arguments: list[str] | None = None) -> None:
    report = Report(__file__, __doc__, arguments)
    laws, numbers, pressed = layers(), {}, {}
    for name, (layer, end) in laws.items():
        closure = 0.4 * end if end > 0.0 else 1e-4
        result = cd.solve(column(layer, closure), tolerance=1e-12).contact()
        exact, found = exact_pressure(layer, closure), float(result.pressure.mean())
        pressed[name] = (-float(result.compression.mean()) - layer.clearance, found)
        numbers[name] = {"pressure": found, "exact": exact, "error": abs(found / exact - 1)}
        print(f"{name:22} p = {found:.10g} MPa, exactly {exact:.10g}")
        assert numbers[name]["error"] < 1e-9, f"{name}: {found} where {exact} is exact"
    draw(laws, pressed, report.path("layers.png"))
    report.summary(numbers)


if __name__ == "__main__":
    main()
