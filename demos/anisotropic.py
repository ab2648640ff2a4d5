"""A wooden block whose fibres are turned, under a crowned steel block, through a nonlinear layer.

The scene is symmetric but for the fibres: their angle alone makes the contact pressure lean to one side. With fibres
along an axis it is symmetric again, and fibres at −30° give the mirror image of those at 30°.
"""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from report import Report

import contactdd as cd

# Lengths in mm, stresses in MPa. Spruce: along the fibre (1), radial (2), tangential (3).
SPRUCE = cd.Orthotropic(E1=11e3, E2=900, E3=500, nu12=0.38, nu13=0.45, nu23=0.45, G12=700, G13=650, G23=40)
STEEL = cd.Isotropic(E=2.1e5, nu=0.3)
LAYER = cd.PowerLayer(B=2e-4, a=1.1)
WIDTH, HEIGHT, RADIUS, APPROACH = 40.0, 10.0, 2000.0, 0.06
ANGLE = 30.0
ANGLES = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0)


def scene(degrees: float, approach: cd.Parameter) -> cd.Scene:
    """Spruce below, glued to its base; steel above, its top face moved down by `approach`, its lower face crowned."""
    half, cells = WIDTH / 2, (40, 10)
    wood = cd.Body(
        "wood",
        cd.rectangle((-half, 0), (half, HEIGHT), cells, shape="quadrilateral"),
        SPRUCE.rotated(np.radians(degrees)),
        supports=[cd.Fixed("bottom")],
        degree=2,
    )
    steel = cd.Body(
        "steel",
        cd.rectangle((-half, HEIGHT), (half, 2 * HEIGHT), cells, shape="quadrilateral"),
        STEEL,
        supports=[cd.Displacement("top", (None, approach.field(lambda depth, x: np.full(x.shape[1], -depth))))],
        degree=2,
    )

    def crown(x: np.ndarray) -> np.ndarray:
        return x[0] ** 2 / (2 * RADIUS)

    return cd.Scene([wood, steel], [cd.Contact((wood, "top"), (steel, "bottom"), LAYER, gap=crown)])


def press(degrees: float, approaches: np.ndarray) -> cd.LoadPath:
    """The load programme for one angle: the approach in steps, with what is of interest at each."""
    approach = cd.Parameter(0.0)
    record = {
        "force": lambda s: s.contact().force,
        "area": lambda s: s.contact().area,
        "peak": lambda s: s.contact().pressure.max(),
        "lean": lean,
    }
    options = {"method": "newton", "gamma": "search", "tolerance": 1e-11}
    return cd.programme(scene(degrees, approach), approach, approaches, record=record, **options)


def along(solution: cd.Solution) -> tuple[np.ndarray, np.ndarray]:
    """x and the pressure along the contact, from left to right."""
    result = solution.contact()
    order = np.argsort(result.x[:, 0])
    return result.x[order, 0], result.pressure[order]


def lean(solution: cd.Solution) -> float:
    """How unlike its mirror image the pressure is: the largest |p(x) − p(−x)| over the largest p."""
    pressure = along(solution)[1]
    return float(np.abs(pressure - pressure[::-1]).max() / pressure.max())


def mirror_difference(one: cd.Solution, other: cd.Solution) -> float:
    """The largest |p(x) − p'(−x)| of two solutions over the largest p."""
    first, second = along(one)[1], along(other)[1]
    return float(np.abs(first - second[::-1]).max() / first.max())


def draw_pressures(solutions: dict[float, cd.Solution], path: str) -> None:
    figure = Figure(figsize=(7, 4.2), layout="constrained")
    axes = figure.subplots()
    for degrees, solution in solutions.items():
        axes.plot(*along(solution), "--" if degrees < 0 else "-", label=f"fibres at {degrees:g}°")
    axes.set_xlabel("x, mm")
    axes.set_ylabel("contact pressure, MPa")
    axes.legend(frameon=False)
    axes.grid(alpha=0.3)
    figure.savefig(path, dpi=150)


def draw_paths(paths: dict[float, cd.LoadPath], path: str) -> None:
    """Force against approach for every angle: how stiff the fibres make the wood."""
    figure = Figure(figsize=(7, 4.2), layout="constrained")
    axes = figure.subplots()
    for degrees, run in paths.items():
        axes.plot(run.values, run.records["force"], ".-", label=f"{degrees:g}°")
    axes.set_xlabel("approach, mm")
    axes.set_ylabel("force per thickness, N/mm")
    axes.legend(title="fibres at", frameon=False)
    axes.grid(alpha=0.3)
    figure.savefig(path, dpi=150)


def main(arguments: list[str] | None = None) -> None:
    report = Report(__file__, __doc__, arguments)
    approaches = np.linspace(0.2, 1.0, 5) * APPROACH
    paths = {degrees: press(degrees, approaches) for degrees in ANGLES}
    last = {degrees: run.solutions[-1] for degrees, run in paths.items()}
    mirrored = press(-ANGLE, approaches).solutions[-1]

    print("fibres     force   peak p     area    lean")
    for degrees, run in paths.items():
        row = [run.records[name][-1] for name in ("force", "peak", "area", "lean")]
        print(f"{degrees:5.0f}° {row[0]:9.3f} {row[1]:8.3f} {row[2]:8.3f} {row[3]:7.4f}")
    turned = last[ANGLE]
    print(f"\n{turned}")
    numbers = {
        "angle": ANGLE,
        "peak_pressure": float(turned.contact().pressure.max()),
        "force": turned.contact().force,
        "asymmetry": lean(turned),
        "asymmetry_angle_0": lean(last[0.0]),
        "mirror_difference": mirror_difference(turned, mirrored),
        "force_balance": turned.imbalance,
        "iterations": [step.iterations for step in paths[ANGLE].solutions],
        "angles": [
            {"angle": degrees} | {name: float(values[-1]) for name, values in run.records.items()}
            for degrees, run in paths.items()
        ],
    }
    print(f"\nasymmetry at {ANGLE:g}°: {numbers['asymmetry']:.4f}, at 0°: {numbers['asymmetry_angle_0']:.1e}")
    print(f"difference of 30° and the mirror image of −30°: {numbers['mirror_difference']:.1e}")
    print(f"force balance: {numbers['force_balance']:.1e}")
    draw_pressures({0.0: last[0.0], ANGLE: turned, -ANGLE: mirrored}, report.path("pressure.png"))
    draw_paths(paths, report.path("paths.png"))
    turned.plot_bodies(component="yy", path=report.path("bodies.png"))
    report.summary(numbers)


if __name__ == "__main__":
    main()
