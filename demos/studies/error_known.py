"""The estimated error beside the true one: scenes of known contact pressure, degrees 1 to 4, uniform and adapted.

The estimate is `cd.error_estimate`: the same scene solved again one degree higher. Effectivity is estimate / true
error, of the relative L² error of p at the points of `Solution.contact`. Exact are the manufactured contact in the
plane and in space, the groove between strips, and two rings of which one is pressed into the other. The groove and the
cylinder of Hertz on blocks of sixteen widths of the contact, with a layer that is about as stiff as their elements, and
three blocks are compared with solves on far finer meshes: closed forms are those of infinite bodies without a layer,
which these are not to the accuracy needed.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).parent))

from manufactured import Manufactured
from results import Report

import contactdd as cd

Floats = NDArray[np.float64]
STEEL = cd.Isotropic(E=2.1e5, nu=0.3)
LAYER = cd.PowerLayer(B=4e-6, a=1.1)
#: The pressure at points x (n, dim).
Pressure = Callable[[Floats], Floats]


@dataclass(frozen=True)
class Case:
    """A scene and its exact pressure."""

    name: str
    element: str
    scene: cd.Scene
    exact: Pressure


def blocks(
    n: int, degree: int, gap: Any, layer: Any, *, length: float = 4.0, height: float = 1.0, floors: int = 2,
    graded: float = 1.0, load: float = 10.0, quadrature: str | None = None,
) -> cd.Scene:  # fmt: skip
    """Blocks on each other between walls, pressed together from both ends, their cells finer towards x = 0."""
    ends = np.linspace(0, 1, 2 * n + 1)
    x = length * (ends if graded == 1.0 else (graded**ends - 1) / (graded - 1))
    bodies = []
    for floor in range(floors):
        y = floor * height
        depth = np.linspace(0, 1, n + 1) if graded == 1.0 else (graded ** np.linspace(0, 1, n + 1) - 1) / (graded - 1)
        lines = y + height * (depth if floor else np.sort(1 - depth))
        mesh = cd.rectangle((0, y), (length, y + height), (x, lines), diagonal="left" if floor % 2 else "right")
        loads = [cd.Pressure(face, load) for at, face in ((0, "bottom"), (floors - 1, "top")) if floor == at]
        supports = [cd.Symmetry("left", "right")]
        bodies.append(cd.Body(f"block {floor}", mesh, STEEL, supports=supports, loads=loads, degree=degree))
    pairs = pairwise(bodies)
    contacts = [cd.Contact((a, "top"), (b, "bottom"), layer, gap=gap, quadrature=quadrature) for a, b in pairs]
    return cd.Scene(bodies, contacts)


def groove_shape(x: Floats) -> Floats:
    return 5e-4 * np.maximum(1 - x[0] ** 2, 0) ** 1.5


def groove(n: int, degree: int) -> Case:
    exact = cd.reference.groove()
    return Case("groove", f"P{degree}", blocks(n, degree, groove_shape, LAYER), lambda x: exact.pressure(x[:, 0]))


def wide(n: int, degree: int, gap: Any, load: float) -> cd.Scene:
    """Blocks of sixteen widths of the contact, a layer about as stiff as their elements between them."""
    return blocks(n, degree, gap, cd.LinearLayer(2e6), length=16.0, height=16.0, graded=60.0, load=load)


def half_planes(n: int, degree: int) -> Case:
    fine = cd.solve(wide(6 * n, 2, groove_shape, 10.0))
    scene = wide(n, degree, groove_shape, 10.0)
    return Case("half-planes", f"P{degree}", scene, lambda x: fine.contact().at(x)["pressure"])


def hertz(n: int, degree: int) -> Case:
    """Half of a contact of the half-width 1 or so."""

    def gap(x: Floats) -> Floats:
        return x[0] ** 2 / 1000.0

    fine = cd.solve(wide(6 * n, 2, gap, 181.0 / 32))
    scene = wide(n, degree, gap, 181.0 / 32)
    return Case("Hertz cylinder", f"P{degree}", scene, lambda x: fine.contact().at(x)["pressure"])


def press_fit(n: int, degree: int) -> Case:
    """Rings 1–2 and 2–3 between frictionless plates, an interference δ closed by a linear layer: Lamé in both."""
    k, interference, E, nu = 1e6, 1e-3, STEEL.E, STEEL.nu
    inner, outer = (cd.rectangle((r, 0), (r + 1, 0.5), (n, n)) for r in (1, 2))
    plates = cd.Symmetry("bottom", "top")
    bodies = [
        cd.Body(name, mesh, STEEL, supports=[plates], kinematics="axisymmetric", degree=degree)
        for name, mesh in (("inner", inner), ("outer", outer))
    ]
    contact = cd.Contact((bodies[0], "right"), (bodies[1], "left"), cd.LinearLayer(k), gap=-interference)

    def compliance(a: float, b: float, out: bool) -> float:
        """Of the radius r = 2 of a thick ring a–b in plane strain under a pressure there."""
        r = a if out else b
        free = b if out else a
        return (1 + nu) / E * r * ((1 - 2 * nu) * r**2 + free**2) / (b**2 - a**2)

    p = interference / (1 / k + compliance(1, 2, False) + compliance(2, 3, True))
    return Case("ring press fit", f"P{degree}", cd.Scene(bodies, [contact]), lambda x: np.full(len(x), p))


def three_blocks(n: int, degree: int) -> Case:
    fine = cd.solve(blocks(8 * n, min(degree + 1, 3), groove_shape, LAYER, floors=3))
    scene = blocks(n, degree, groove_shape, LAYER, floors=3)
    return Case("three blocks", f"P{degree}", scene, lambda x: fine.contact(int(x[0, 1] > 1.5)).at(x)["pressure"])


def manufactured(n: int, degree: int, dim: int) -> Case:
    problem = Manufactured(dim) if dim == 2 else Manufactured(3, half_width=1.0, exponent=4)
    scene = problem.scene(n, degree)
    name = "manufactured" if dim == 2 else "manufactured, solid"
    return Case(name, f"P{degree}", scene, lambda x: problem.pressure(x.T))


def cases(quick: bool) -> Iterator[Case]:
    sizes = (8,) if quick else (8, 16, 32)
    for degree in (1, 2, 3) if quick else (1, 2, 3, 4):
        for n in sizes:
            yield groove(n, degree)
            yield manufactured(n, degree, 2)
        yield press_fit(2 if quick else 4, degree)
    for n, degree in ((12, 1),) if quick else ((12, 1), (12, 2), (24, 1)):
        yield half_planes(n, degree)
        yield hertz(n, degree)
    yield three_blocks(4, 1)
    if not quick:
        yield three_blocks(4, 2)
        yield three_blocks(8, 2)
    for n, degree in ((2, 1),) if quick else ((2, 1), (4, 1), (2, 2)):
        yield manufactured(n, degree, 3)


def true_error(solution: cd.Solution, exact: Pressure) -> float:
    """The relative L² error of the pressures of all contacts at their points."""
    squares = np.zeros(2)
    for contact in solution.scene.contacts:
        result = solution.contact(contact)
        p = exact(result.x)
        squares += [result.weights @ (result.pressure - p) ** 2, result.weights @ p**2]
    return float(np.sqrt(squares[0] / squares[1]))


def unknowns(scene: cd.Scene) -> int:
    return sum(body.dofs for body in scene.bodies)


def measured(case: Case) -> dict[str, Any]:
    """One row: the estimate is made twice, as the first may compile forms."""
    solution = cd.solve(case.scene)
    cd.error_estimate(solution)
    estimate = cd.error_estimate(solution)
    true, told = true_error(solution, case.exact), estimate.pressure.relative
    return {
        "scene": case.name,
        "element": case.element,
        "unknowns": unknowns(case.scene),
        "true_error": true,
        "estimate": told,
        "effectivity": told / true,
        "cost": estimate.cost,
    }


def adapted(degree: int, accuracy: float) -> list[dict[str, Any]]:
    """The groove on meshes made for an accuracy: a row for every mesh on the way."""
    start, exact = groove(4, degree), cd.reference.groove()
    made = cd.adapt(start.scene, accuracy)
    last = true_error(made.solution, lambda x: exact.pressure(np.clip(x[:, 0], 0, 4)))
    rows = [
        {"element": f"P{degree}", "unknowns": r.unknowns, "estimate": r.error, "cpu_seconds": r.cpu_seconds}
        for r in made.rounds
    ]
    rows[-1] |= {"true_error": last, "accuracy": accuracy, "status": made.status}
    return rows


def draw(rows: list[dict[str, Any]], ways: list[list[dict[str, Any]]], path: Path) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 4.5), layout="constrained")
    left, right = figure.subplots(1, 2)
    for scene in dict.fromkeys(row["scene"] for row in rows):
        some = [row for row in rows if row["scene"] == scene]
        left.loglog([r["true_error"] for r in some], [r["estimate"] for r in some], "o", label=scene)
    ends = np.array([min(row["true_error"] for row in rows), max(row["true_error"] for row in rows)])
    for factor, style in ((1.0, "k-"), (0.5, "k:"), (2.5, "k:")):
        left.loglog(ends, factor * ends, style, linewidth=0.8)
    left.set(xlabel="true relative L² error of p", ylabel="estimate", title="dotted: effectivity 0.5 and 2.5")
    left.legend(fontsize="small")
    for way in ways:
        label = f"{way[0]['element']} adapted"
        right.loglog([r["unknowns"] for r in way], [r["estimate"] for r in way], "o-", label=label)
    for element in dict.fromkeys(row["element"] for row in rows if row["scene"] == "groove"):
        some = [row for row in rows if (row["scene"], row["element"]) == ("groove", element)]
        right.loglog([r["unknowns"] for r in some], [r["true_error"] for r in some], "x--", label=f"{element} uniform")
    right.set(xlabel="degrees of freedom", ylabel="relative L² error of p", title="groove")
    right.legend(fontsize="small")
    figure.savefig(path, dpi=150)


def main() -> None:
    report = Report(__file__, __doc__, quick="fewer and coarser meshes")
    print(f"{'scene':20} {'element':9} {'unknowns':>8} {'true':>9} {'estimate':>9} {'eff.':>5} {'cost':>5}")
    rows = []
    for case in cases(report.quick):
        row = measured(case)
        rows.append(row)
        numbers = f"{row['true_error']:9.2e} {row['estimate']:9.2e} {row['effectivity']:5.2f} {row['cost']:5.1f}"
        print(f"{row['scene']:20} {row['element']:9} {row['unknowns']:8d} {numbers}", flush=True)
    ways = [adapted(1, 5e-3 if report.quick else 1e-3), adapted(2, 1e-3 if report.quick else 1e-4)]
    for way in ways:
        last = way[-1]
        found = f"{last['status']}, true {last['true_error']:.2e} with {last['unknowns']} unknowns, {len(way)} meshes"
        print(f"adapted {last['element']}: {last['accuracy']:g} asked for, {found}")
    told = np.array([row["effectivity"] for row in rows])
    print(f"effectivity from {told.min():.2f} to {told.max():.2f}, median {np.median(told):.2f}")
    draw(rows, ways, report.path("error_known.png"))
    report.summary({"rows": rows, "adapted": ways, "median_effectivity": float(np.median(told))})


if __name__ == "__main__":
    main()
