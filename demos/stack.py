"""A stack of eight unlike blocks, each with a groove in its top: seven contacts at once between floating bodies.

Heights, moduli, meshes and grooves differ from block to block; the meshes do not match anywhere.
"""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from report import Report

import contactdd as cd

# cm and MPa, as the paper's problem
LENGTH, LOAD = 4.0, 10.0
HEIGHTS = (1.0, 0.6, 1.4, 0.8, 1.2, 0.5, 1.0, 0.7)
MODULI = (2.1e5, 1.0e5, 7.0e4, 2.1e5, 4.5e4, 1.2e5, 2.1e5, 7.0e4)
CELLS = (32, 27, 36, 29, 40, 31, 34, 26)
LAYER = cd.PowerLayer(B=4e-6, a=1.1)


def groove(middle: float, half_width: float, depth: float):
    """A groove of the paper's shape anywhere."""
    return lambda x: depth * np.maximum(1 - ((x[0] - middle) / half_width) ** 2, 0) ** 1.5


def grooves() -> list[tuple[float, float, float]]:
    """Middle, half-width and depth of the seven grooves, from the lowest."""
    return [(0.5 + 0.5 * i, 0.5 + 0.1 * (i % 3), 4e-4 + 1e-4 * (i % 4)) for i in range(len(HEIGHTS) - 1)]


def scene(refine: int = 1) -> cd.Scene:
    """The lowest block stands on the ground; all sides slide along walls."""
    floors = np.concatenate([[0.0], np.cumsum(HEIGHTS)])
    bodies = []
    for i, (height, E, cells) in enumerate(zip(HEIGHTS, MODULI, CELLS, strict=True)):
        count = (cells * refine, max(2, round(cells * refine * height / LENGTH)))
        mesh = cd.rectangle((0, floors[i]), (LENGTH, floors[i + 1]), count, diagonal="crossed" if i % 2 else "right")
        supports = [cd.Symmetry("left", "right", *(["bottom"] if i == 0 else []))]
        loads = [cd.Pressure("top", LOAD)] if i == len(HEIGHTS) - 1 else []
        bodies.append(cd.Body(f"block {i + 1}", mesh, cd.Isotropic(E, 0.3), supports=supports, loads=loads))
    pairs = zip(bodies[:-1], bodies[1:], grooves(), strict=True)
    return cd.Scene(
        bodies, [cd.Contact((lower, "top"), (upper, "bottom"), LAYER, gap=groove(*g)) for lower, upper, g in pairs]
    )


def draw(solution: cd.Solution, path) -> None:
    """All seven pressures, one above the other as the contacts are."""
    figure = Figure(figsize=(7, 9), layout="constrained")
    for axes, contact in zip(
        figure.subplots(len(HEIGHTS) - 1, sharex=True), solution.scene.contacts[::-1], strict=True
    ):
        result = solution.contact(contact)
        order = np.argsort(result.x[:, 0])
        axes.plot(result.x[order, 0], result.pressure[order], color="#1f5f8b")
        axes.set_title(contact.name, fontsize=8, loc="left", pad=2)
        axes.set_ylim(0, None)
        axes.margins(x=0)
    axes.set_xlabel("x")
    figure.supylabel("contact pressure")
    figure.savefig(path, dpi=150)


def main(arguments: list[str] | None = None) -> None:
    report = Report(__file__, __doc__, arguments)
    solution = cd.solve(scene(), "newton", gamma="search", tolerance=1e-10)
    print(f"{solution}\n")
    contacts = []
    for contact in solution.scene.contacts:
        result = solution.contact(contact)
        open_width = float(result.weights[~result.closed].sum())
        contacts.append(
            {
                "name": contact.name,
                "force": result.force,
                "peak_pressure": float(result.pressure.max()),
                "open": open_width,
            }
        )
        print(f"{contact.name}: force {result.force:.9f}, peak {result.pressure.max():.4f}, open {open_width:.4f}")
    draw(solution, report.path("contacts.png"))
    solution.plot_bodies(component="yy", path=report.path("bodies.png"))
    report.summary({"contacts": contacts, "iterations": solution.iterations, "imbalance": solution.imbalance})


if __name__ == "__main__":
    main()
