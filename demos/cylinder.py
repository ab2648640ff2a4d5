"""NAFEMS' cylinder on a block: a steel cylinder pressed into an aluminium block, against Hertz.

R = 50 mm, E = 210 and 70 GPa, nu = 0.3, 35 kN per mm of length: half-width 6.21 mm, peak pressure 3585 MPa. Curved
elements of degree 2, meshes that do not match, and a linear layer so stiff that it hardly yields.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from report import Report

import contactdd as cd

# N, mm, MPa
RADIUS, LOAD = 50.0, 35e3
STEEL, ALUMINIUM = cd.Isotropic(E=210e3, nu=0.3), cd.Isotropic(E=70e3, nu=0.3)
# Of the layer: at the peak pressure it yields 7e-4 mm, a five hundredth of the gap at the edge of contact.
STIFFNESS = 5e6
MESH = Path(__file__).parents[1] / "meshes" / "cylinder_on_block.geo"


def scene(fine: float = 0.25, degree: int = 2) -> cd.Scene:
    """The right half of both bodies; the cylinder is held by the contact alone."""
    cylinder_mesh, block_mesh = (
        cd.read_gmsh(MESH, body=body, order=2, fine=fine, radius=RADIUS) for body in ("cylinder", "block")
    )
    axis = cd.Symmetry("axis")
    cylinder = cd.Body(
        "cylinder",
        cylinder_mesh,
        STEEL,
        supports=[axis],
        loads=[cd.Pressure("cylinder_top", LOAD / (2 * RADIUS))],
        degree=degree,
    )
    block = cd.Body("block", block_mesh, ALUMINIUM, supports=[axis, cd.Symmetry("bottom")], degree=degree)
    layer = cd.LinearLayer(stiffness=STIFFNESS)
    return cd.Scene([cylinder, block], [cd.Contact((cylinder, "contact"), (block, "top"), layer)])


def half_width(result: cd.ContactResult) -> float:
    """Of the contact: half of it is modelled."""
    return result.area


def fitted(result: cd.ContactResult) -> tuple[float, float]:
    """Half-width and peak of the ellipse p² = peak² (1 − x²/half²) that fits the pressure inside best."""
    inside = result.pressure > 0.3 * result.pressure.max()
    x, p = result.x[inside, 0], result.pressure[inside]
    constant, slope = np.linalg.lstsq(np.column_stack([np.ones_like(x), -(x**2)]), p**2, rcond=None)[0]
    return float(np.sqrt(constant / slope)), float(np.sqrt(constant))


def draw(solution: cd.Solution, path: Path) -> None:
    """The pressure with Hertz' ellipse."""
    figure = solution.plot_contact()
    x = np.linspace(0.0, 1.2 * hertz().half_width, 400)
    figure.axes[0].plot(x, hertz().pressure(x), "k--", linewidth=0.9, label="Hertz")
    figure.axes[0].legend(frameon=False)
    figure.savefig(path, dpi=150)


def hertz() -> cd.reference.HertzCylinder:
    return cd.reference.hertz_cylinder(LOAD, RADIUS, STEEL.E, STEEL.nu, E2=ALUMINIUM.E, nu2=ALUMINIUM.nu)


def main(arguments: list[str] | None = None) -> None:
    report = Report(__file__, __doc__, arguments)
    solution = cd.solve(scene(), "newton", gamma="search", tolerance=1e-9)
    result, exact = solution.contact(), hertz()
    width, peak = fitted(result)
    numbers = {
        "half_width": half_width(result),
        "peak_pressure": float(result.pressure.max()),
        "fitted_half_width": width,
        "fitted_peak_pressure": peak,
        "hertz_half_width": exact.half_width,
        "hertz_peak_pressure": exact.peak_pressure,
        "force": result.force,
        "iterations": solution.iterations,
        "imbalance": solution.imbalance,
    }
    print(f"{solution}\n")
    print(f"half-width    {numbers['half_width']:9.4f} mm  (ellipse {width:.4f}), Hertz {exact.half_width:.4f}")
    print(f"peak pressure {numbers['peak_pressure']:9.2f} MPa (ellipse {peak:.2f}), Hertz {exact.peak_pressure:.2f}")
    draw(solution, report.path("contact.png"))
    solution.plot_bodies(component="yy", path=report.path("bodies.png"))
    report.summary(numbers)


if __name__ == "__main__":
    main()
