"""The estimated error beside the true one: scenes of known contact pressure, degrees 1 to 4, uniform and adapted.

The estimate is `cd.error_estimate`: the same scene solved again one degree higher. Effectivity is estimate / true
error, of the relative L² error of p at the points of `Solution.contact`. Exact are the manufactured contact in the
plane and in space, the groove between strips, and two rings of which one is pressed into the other. The groove and the
cylinder of Hertz on blocks of sixteen widths of the contact, with a layer that is about as stiff as their elements, a
punch with corners and three blocks are compared with solutions on meshes made for a far smaller error: closed forms are
those of infinite bodies without a layer, which these are not to the accuracy needed.

Then the bound of the energy's error (`cd.energy_bound`) on the groove, whose exact energy is known, and meshes made for
an accuracy (`cd.adapt`) against uniform ones there: unknowns and CPU time to an error.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import chain, pairwise, product
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
    """A scene, made anew for every solve, and its exact pressure."""

    name: str
    element: str
    make: Callable[[], cd.Scene]
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
    return Case(
        "groove",
        f"P{degree}",
        lambda: blocks(n, degree, groove_shape, LAYER),
        lambda x: exact.pressure(np.clip(x[:, 0], 0, 4)),
    )


def wide(n: int, degree: int, gap: Any, load: float) -> cd.Scene:
    """Blocks of sixteen widths of the contact, a layer about as stiff as their elements between them."""
    return blocks(n, degree, gap, cd.LinearLayer(2e6), length=16.0, height=16.0, graded=60.0, load=load)


@cache
def far_finer(make: Callable[[int, int], cd.Scene]) -> cd.Solution:
    """The solution on a mesh made for an error of 2e-5, better by a degree."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", cd.ContactWarning)  # some digits less do, too
        return cd.adapt(make(8, 3), 2e-5, max_unknowns=60_000).estimate.better


def against_finer(name: str, make: Callable[[int, int], cd.Scene], n: int, degree: int) -> Case:
    """A scene that has no closed form, its contacts at different heights."""

    def exact(x: Floats) -> Floats:
        results = [far_finer(make).contact(contact) for contact in far_finer(make).scene.contacts]
        return min(results, key=lambda result: abs(result.x[0, 1] - x[0, 1])).at(x)["pressure"]

    return Case(name, f"P{degree}", lambda: make(n, degree), exact)


def half_planes(n: int, degree: int) -> cd.Scene:
    return wide(n, degree, groove_shape, 10.0)


def hertz(n: int, degree: int) -> cd.Scene:
    """Half of a contact of the half-width 1 or so."""
    return wide(n, degree, lambda x: x[0] ** 2 / 1000.0, 181.0 / 32)


def punch(n: int, degree: int) -> cd.Scene:
    """Half of a punch with sharp corners on a block four times as wide, cells graded towards the corner."""
    near = (20.0 ** np.linspace(0, 1, n + 1) - 1) / 19.0
    x = np.concatenate([1 - near[::-1], 1 + 3 * near[1:]])
    symmetry, layer = cd.Symmetry("left"), cd.LinearLayer(2e6)
    low = cd.rectangle((0, -4), (4, 0), (x, -4 * near[::-1]))
    high = cd.rectangle((0, 0), (1, 1), (x[: n + 1], near))
    ground = cd.Body("ground", low, STEEL, supports=[symmetry, cd.Fixed("bottom")], degree=degree)
    tool = cd.Body("punch", high, STEEL, supports=[symmetry], loads=[cd.Pressure("top", 100.0)], degree=degree)
    return cd.Scene([ground, tool], [cd.Contact((ground, "top"), (tool, "bottom"), layer)])


def three_blocks(n: int, degree: int) -> cd.Scene:
    return blocks(n, degree, groove_shape, LAYER, floors=3)


def press_fit(n: int, degree: int) -> Case:
    """Rings 1–2 and 2–3 between frictionless plates, an interference δ closed by a linear layer: Lamé in both."""
    k, interference, E, nu = 1e6, 1e-3, STEEL.E, STEEL.nu

    def make() -> cd.Scene:
        inner, outer = (cd.rectangle((r, 0), (r + 1, 0.5), (n, n)) for r in (1, 2))
        plates = cd.Symmetry("bottom", "top")
        bodies = [
            cd.Body(name, mesh, STEEL, supports=[plates], kinematics="axisymmetric", degree=degree)
            for name, mesh in (("inner", inner), ("outer", outer))
        ]
        fit = cd.Contact((bodies[0], "right"), (bodies[1], "left"), cd.LinearLayer(k), gap=-interference)
        return cd.Scene(bodies, [fit])

    def compliance(a: float, b: float, out: bool) -> float:
        """Of the radius r = 2 of a thick ring a–b in plane strain under a pressure there."""
        r = a if out else b
        free = b if out else a
        return (1 + nu) / E * r * ((1 - 2 * nu) * r**2 + free**2) / (b**2 - a**2)

    p = interference / (1 / k + compliance(1, 2, False) + compliance(2, 3, True))
    return Case("ring press fit", f"P{degree}", make, lambda x: np.full(len(x), p))


def manufactured(n: int, degree: int, dim: int) -> Case:
    problem = Manufactured(dim) if dim == 2 else Manufactured(3, half_width=1.0, exponent=4)
    name = "manufactured" if dim == 2 else "manufactured, solid"
    return Case(name, f"P{degree}", lambda: problem.scene(n, degree), lambda x: problem.pressure(x.T))


def cases(quick: bool) -> Iterator[Case]:
    sizes, degrees = ((8,), (1, 2, 3)) if quick else ((8, 16, 32), (1, 2, 3, 4))
    for degree in degrees:
        for n in sizes:
            yield groove(n, degree)
            yield manufactured(n, degree, 2)
        yield press_fit(2 if quick else 4, degree)
        for n in (12,) if quick else (12, 24):
            yield against_finer("half-planes", half_planes, n, degree)
            yield against_finer("Hertz cylinder", hertz, n, degree)
            yield against_finer("punch with corners", punch, n // 2, degree)
            yield against_finer("three blocks", three_blocks, n // 2, degree)
    for n, degree in ((2, 1),) if quick else ((2, 1), (4, 1), (2, 2), (2, 3), (2, 4)):
        yield manufactured(n, degree, 3)


def adapted_cases(quick: bool) -> Iterator[Case]:
    """The last meshes of adaptations."""
    for degree in (1, 2) if quick else (1, 2, 3, 4):
        for start in (
            groove(4, degree),
            *(against_finer(*each, degree) for each in (
                ("half-planes", half_planes, 6), ("Hertz cylinder", hertz, 6), ("punch with corners", punch, 4),
                ("three blocks", three_blocks, 4),
            )),
        ):  # fmt: skip
            for accuracy in (1e-2,) if quick else (1e-2, 1e-3):
                yield adapted_case(start, accuracy)


def adapted_case(start: Case, accuracy: float) -> Case:
    scene = cd.adapt(start.make(), accuracy).scene
    meshes = {body.name: body.mesh for body in scene.bodies}

    def make() -> cd.Scene:
        fresh = start.make()
        return fresh.with_bodies({body.name: body.on(meshes[body.name]) for body in fresh.bodies})

    return Case(start.name, f"{start.element} adapted", make, start.exact)


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
    """One row: all is done twice, as the first time may compile forms."""
    cd.error_estimate(cd.solve(case.make()))
    solution = cd.solve(case.make())
    estimate = cd.error_estimate(solution)
    true, told = true_error(solution, case.exact), estimate.pressure.relative
    return {
        "scene": case.name,
        "element": case.element,
        "unknowns": unknowns(solution.scene),
        "true_error": true,
        "estimate": told,
        "effectivity": told / true,
        "cost": estimate.cost,
    }


def adapted(degree: int, accuracies: Sequence[float]) -> list[dict[str, Any]]:
    """The groove on meshes made for accuracies, each from the coarsest mesh on: CPU time is that of all its solves."""
    case, rows = groove(4, degree), []
    cd.adapt(case.make(), 10 * accuracies[0])  # compiles
    for accuracy in accuracies:
        began = time.process_time()
        made = cd.adapt(case.make(), accuracy)
        rows.append({
            "element": f"P{degree}", "accuracy": accuracy, "status": made.status, "meshes": len(made.rounds),
            "unknowns": made.rounds[-1].unknowns, "estimate": made.rounds[-1].error,
            "true_error": true_error(made.solution, case.exact), "cpu_seconds": time.process_time() - began,
            "solve_seconds": sum(each.solve_seconds for each in made.rounds),
        })  # fmt: skip
    return rows


def uniform(degree: int, sizes: Sequence[int]) -> list[dict[str, Any]]:
    """The groove on uniform meshes, solved once and not estimated."""
    rows = []
    for n in sizes:
        case, began = groove(n, degree), time.process_time()
        solution = cd.solve(case.make())
        spent = time.process_time() - began
        error, count = true_error(solution, case.exact), unknowns(solution.scene)
        seconds = {"cpu_seconds": spent, "solve_seconds": solution.cpu_seconds}
        rows.append({"element": f"P{degree}", "unknowns": count, "true_error": error, **seconds})
    return rows


def bounded(degree: int, n: int) -> dict[str, Any]:
    """The bound of the energy's error (`cd.energy_bound`) on the groove, whose exact energy is known."""
    exact = cd.reference.groove()
    energy = exact.elastic_energy + exact.layer_energy - 10.0 * exact.length * exact.approach
    solution = cd.solve(groove(n, degree).make())
    cd.energy_bound(solution)  # compiles
    began = time.process_time()
    bound = cd.energy_bound(solution)
    error = bound.energy - energy
    spent = time.process_time() - began
    count, ratio = unknowns(solution.scene), bound.error / error
    return {
        "element": f"P{degree}", "unknowns": count, "true_error": error, "bound": bound.error, "effectivity": ratio,
        "norm": bound.relative, "cpu_seconds": spent,
    }  # fmt: skip


def rate(rows: Sequence[dict[str, Any]], by: str = "unknowns") -> float:
    """The fitted power with which the true error falls."""
    return float(-np.polyfit(np.log([row[by] for row in rows]), np.log([row["true_error"] for row in rows]), 1)[0])


def needed(rows: Sequence[dict[str, Any]], what: str, error: float) -> float:
    """Unknowns or CPU seconds to an error, by the power law through the two rows on either side, or the last two."""
    ordered = sorted(rows, key=lambda row: -row["true_error"])
    after = next((i for i, row in enumerate(ordered) if row["true_error"] <= error), len(ordered) - 1)
    pair = ordered[max(after - 1, 0) : max(after - 1, 0) + 2]
    slope, at = np.polyfit(np.log([row["true_error"] for row in pair]), np.log([row[what] for row in pair]), 1)
    return float(np.exp(slope * np.log(error) + at))


def gain(even: Sequence[dict[str, Any]], made: Sequence[dict[str, Any]], error: float) -> dict[str, Any]:
    """Unknowns, CPU time and that of solves alone of uniform meshes to an error, by those of adapted ones."""
    what = "unknowns", "cpu_seconds", "solve_seconds"
    ratios = {each: needed(even, each, error) / needed(made, each, error) for each in what}
    return {"element": made[0]["element"], "error": error, "rate": rate(made), "uniform_rate": rate(even)} | ratios


def draw(rows: list[dict[str, Any]], even: list[Any], made: list[Any], path: Path) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(15, 4.6), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    for scene in dict.fromkeys(row["scene"] for row in rows):
        for marker, kind in (("o", False), ("x", True)):
            some = [row for row in rows if row["scene"] == scene and ("adapted" in row["element"]) == kind]
            label = scene if not kind else None
            colour = f"C{list(dict.fromkeys(row['scene'] for row in rows)).index(scene)}"
            values = [r["true_error"] for r in some], [r["estimate"] for r in some]
            left.loglog(*values, marker, color=colour, label=label, markersize=5)
    ends = np.array([min(row["true_error"] for row in rows), max(row["true_error"] for row in rows)])
    for factor, style in ((1.0, "k-"), (0.5, "k:"), (2.5, "k:")):
        left.loglog(ends, factor * ends, style, linewidth=0.8)
    title = "o uniform, × adapted; dotted: effectivity 0.5, 2.5"
    left.set(xlabel="true relative L² error of p", ylabel="estimate", title=title)
    left.legend(fontsize="small")
    for axes, what, name in ((middle, "unknowns", "degrees of freedom"), (right, "cpu_seconds", "CPU time (s)")):
        for place, (flat, fine) in enumerate(zip(even, made, strict=True)):
            colour, element = f"C{place}", fine[0]["element"]
            for each, style, label in ((flat, "x--", "uniform"), (fine, "o-", "adapted")):
                numbers = [r[what] for r in each], [r["true_error"] for r in each]
                axes.loglog(*numbers, style, color=colour, label=f"{element} {label}")
            axes.loglog([r[what] for r in fine], [r["estimate"] for r in fine], "s:", color=colour, mfc="none",
                        label=f"{element} adapted, estimate")  # fmt: skip
        axes.set(xlabel=name, ylabel="relative L² error of p", title="groove")
    right.legend(fontsize="small")
    figure.savefig(path, dpi=150)


def main() -> None:
    report = Report(__file__, __doc__, quick="fewer and coarser meshes")
    print(f"{'scene':20} {'element':10} {'unknowns':>8} {'true':>9} {'estimate':>9} {'eff.':>5} {'cost':>5}")
    rows = []
    for case in chain(cases(report.quick), adapted_cases(report.quick)):
        row = measured(case)
        rows.append(row)
        numbers = f"{row['true_error']:9.2e} {row['estimate']:9.2e} {row['effectivity']:5.2f} {row['cost']:5.1f}"
        print(f"{row['scene']:20} {row['element']:10} {row['unknowns']:8d} {numbers}", flush=True)
    told = np.array([row["effectivity"] for row in rows])
    print(f"effectivity from {told.min():.2f} to {told.max():.2f}, median {np.median(told):.2f}\n")
    print(f"{'energy':7} {'unknowns':>8} {'true':>9} {'bound':>9} {'eff.':>6} {'CPU s':>6}")
    bounds = [bounded(k, n) for k, n in (((1, 4), (2, 4)) if report.quick else product((1, 2, 3), (4, 8, 16)))]
    for row in bounds:
        numbers = f"{row['true_error']:9.2e} {row['bound']:9.2e} {row['effectivity']:6.3f} {row['cpu_seconds']:6.2f}"
        print(f"{row['element']:7} {row['unknowns']:8d} {numbers}")
    print()
    sizes = ((32, 64), (16, 32)) if report.quick else ((16, 32, 64, 128, 256), (8, 16, 32, 64, 96))
    wanted = ((1e-2, 5e-3), (3e-3, 1e-3)) if report.quick else ((1e-2, 1e-3, 3e-4, 1e-4), (1e-2, 1e-3, 1e-4, 3e-5))
    even, made = ([make(k + 1, each[k]) for k in (0, 1)] for make, each in ((uniform, sizes), (adapted, wanted)))
    print(f"{'':3} {'asked for':>9} {'true':>9} {'unknowns':>9} {'meshes':>6} {'CPU s':>6}")
    for row in chain(*made):
        numbers = f"{row['true_error']:9.2e} {row['unknowns']:9d} {row['meshes']:6d} {row['cpu_seconds']:6.2f}"
        print(f"{row['element']:3} {row['accuracy']:9.0e} {numbers} {row['status']}")
    gains = [gain(*pair, 5e-3 if report.quick else 1e-4) for pair in zip(even, made, strict=True)]
    for each in gains:
        print(
            f"{each['element']} to {each['error']:.0e}: {each['unknowns']:.1f} times the unknowns and "
            f"{each['cpu_seconds']:.2f} times the CPU of adapted meshes on uniform ones (of solves alone "
            f"{each['solve_seconds']:.2f} times); the error falls like "
            f"N^-{each['rate']:.2f}, uniform N^-{each['uniform_rate']:.2f}"
        )
    draw(rows, even, made, report.path("error_known.png"))
    numbers = {"rows": rows, "adapted": made, "uniform": even, "gains": gains, "bounds": bounds}
    report.summary(numbers | {"median_effectivity": float(np.median(told))})


if __name__ == "__main__":
    main()
