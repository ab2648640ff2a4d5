"""Three bodies in the plane, each touching both others: a wedge pressed between two blocks, held by contact alone.

The right block, too, is held sideways only by what touches it. The contact forces follow from statics, whatever the
bodies, the layers and the meshes, none of which match.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from report import Report

import contactdd as cd

# N, mm, MPa; the dimensions are those of the mesh script
LOAD, SIDE_LOAD = 30.0, 40.0
STEEL, BRASS, ALUMINIUM = cd.Isotropic(2.1e5, 0.3), cd.Isotropic(1.0e5, 0.35), cd.Isotropic(7.0e4, 0.33)
MESH = Path(__file__).parents[1] / "meshes" / "keystone.geo"
TOP_WIDTH, SIDE_HEIGHT = 2.0, 2.0


def scene(size: float = 0.1, degree: int = 2) -> cd.Scene:
    """The left block stands against a wall, the right one is pushed to it, the wedge is pushed down between them."""
    mesh = {name: cd.read_gmsh(MESH, body=name, size=size) for name in ("left_block", "right_block", "wedge")}
    left = cd.Body("left", mesh["left_block"], STEEL, supports=[cd.Symmetry("bottom", "outside")], degree=degree)
    right = cd.Body(
        "right",
        mesh["right_block"],
        BRASS,
        supports=[cd.Symmetry("bottom")],
        loads=[cd.Pressure("outside", SIDE_LOAD)],
        degree=degree,
    )
    wedge = cd.Body("wedge", mesh["wedge"], ALUMINIUM, loads=[cd.Pressure("top", LOAD)], degree=degree)
    rough, soft = cd.PowerLayer(B=2e-5, a=1.2), cd.LinearLayer(stiffness=5e4)
    return cd.Scene(
        [left, right, wedge],
        [
            cd.Contact((left, "middle"), (right, "middle"), rough),
            cd.Contact((wedge, "slope_left"), (left, "slope"), rough),
            cd.Contact((wedge, "slope_right"), (right, "slope"), soft),
        ],
    )


def statics() -> dict[str, float]:
    """The contact forces that balance the loads: slopes at 45° carry P/√2 each, and push the blocks apart by P/2."""
    down = LOAD * TOP_WIDTH
    return {
        "left–right": SIDE_LOAD * SIDE_HEIGHT - down / 2,
        "wedge–left": down / np.sqrt(2),
        "wedge–right": down / np.sqrt(2),
    }


def main(arguments: list[str] | None = None) -> None:
    report = Report(__file__, __doc__, arguments)
    solution = cd.solve(scene(), "newton", gamma="search", tolerance=1e-10)
    print(f"{solution}\n")
    numbers = {}
    for contact, balance in statics().items():
        result = solution.contact(contact)
        numbers[contact] = {"force": result.force, "statics": balance, "peak_pressure": float(result.pressure.max())}
        print(f"{contact:12} force {result.force:.9f} N/mm, statics {balance:.9f}, alone {result.unpaired_area} mm")
    for index, contact in enumerate(solution.scene.contacts):
        solution.plot_contact(contact, path=report.path(f"contact{index + 1}.png"))
    solution.plot_bodies(component="von Mises", path=report.path("bodies.png"))
    report.summary(numbers | {"iterations": solution.iterations, "imbalance": solution.imbalance})


if __name__ == "__main__":
    main()
