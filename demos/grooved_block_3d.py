"""A block with a groove cut into it, under another block, in space: tetrahedra against hexahedra that do not match.

The groove is in the mesh itself. Between walls on all four sides the bodies are in plane strain and the paper's plane
problem is the answer; with the back free the material gives way there and the groove closes further.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from report import Report

import contactdd as cd

# cm and MPa, the paper's data
LENGTH, HEIGHT, WIDTH, LOAD = 4.0, 1.0, 1.0, 10.0
STEEL = cd.Isotropic(E=2.1e5, nu=0.3)
LAYER = cd.PowerLayer(B=4e-6, a=1.1)
MESH = Path(__file__).parents[1] / "meshes" / "grooved_block.geo"


def scene(size: float = 0.25, degree: int = 2, free_back: bool = False) -> cd.Scene:
    """Both blocks float: only the contact holds them against each other."""
    walls = cd.Symmetry("left", "right", "front", *([] if free_back else ["back"]))
    lower_mesh = cd.read_gmsh(MESH, dim=3, size=size, width=WIDTH, length=LENGTH, height=HEIGHT, order=2)
    cells = (round(0.8 * LENGTH / size), round(0.8 * WIDTH / size), max(2, round(0.5 * HEIGHT / size)))
    upper_mesh = cd.box((0, 0, HEIGHT), (LENGTH, WIDTH, 2 * HEIGHT), cells, shape="hexahedron")
    lower = cd.Body("lower", lower_mesh, STEEL, supports=[walls], loads=[cd.Pressure("bottom", LOAD)], degree=degree)
    upper = cd.Body("upper", upper_mesh, STEEL, supports=[walls], loads=[cd.Pressure("top", LOAD)], degree=degree)
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), LAYER)])


def open_width(result: cd.ContactResult, low: float, high: float) -> float:
    """The mean width of the open groove between two sections y = low and y = high."""
    there = (result.x[:, 1] > low) & (result.x[:, 1] < high)
    return float(result.weights[there & ~result.closed].sum() / (high - low))


def main(arguments: list[str] | None = None) -> None:
    report = Report(__file__, __doc__, arguments)
    held = cd.solve(scene(), "newton", gamma="search", tolerance=1e-9)
    free = cd.solve(scene(free_back=True), "newton", gamma="search", tolerance=1e-9)
    exact = cd.reference.groove()
    numbers = {"reference_edge": exact.contact_edge, "reference_peak": exact.peak_pressure}
    for name, solution in (("held", held), ("free", free)):
        result = solution.contact()
        numbers[name] = {
            "force": result.force,
            "peak_pressure": float(result.pressure.max()),
            "open_front": open_width(result, 0.0, 0.25 * WIDTH),
            "open_back": open_width(result, 0.75 * WIDTH, WIDTH),
            "iterations": solution.iterations,
            "imbalance": solution.imbalance,
        }
        print(f"{name} at the back: {solution}")
        print("  open width at the front {open_front:.4f}, at the back {open_back:.4f}\n".format(**numbers[name]))
    error = held.contact().pressure - exact.pressure(held.contact().x[:, 0])
    numbers["error_l2"] = float(np.sqrt(held.contact().weights @ error**2 / (LOAD**2 * LENGTH * WIDTH)))
    print(f"plane reference: open width {exact.contact_edge:.4f}, peak {exact.peak_pressure:.3f}")
    print(f"pressure of the held blocks against it: {numbers['error_l2']:.2e} of the load in the mean square")
    free.plot_contact(path=report.path("contact.png"))
    free.plot_bodies(component="zz", path=report.path("bodies.png"))
    report.summary(numbers)


if __name__ == "__main__":
    main()
