"""Every method on every hard scene: which arrive, in how many steps, and that none arrives where it should not.

Each run has to bring the weak residual to 1e-10 of the forces, or say that it cannot. What converged is compared with
a coupled solution found in another way (all displacements of all bodies in one sparse system, chord coefficients), or
with a closed form. Scenes without equilibrium have to be refused as such, and a law that ends before the answer has to
be named.
"""

from __future__ import annotations

import csv
import time
import warnings
from dataclasses import asdict, dataclass

import numpy as np
from hard_scenes import Case, all_cases, two_blocks
from matplotlib.figure import Figure
from results import Report

import contactdd as cd

TOLERANCE = 1e-10
#: The residual turns into errors by the condition of the contact's compliance: a factor of 7 is the most seen.
LARGEST_ERROR = 1e-8
#: The most iterations: what `auto` and the other globalised methods are allowed, and the plain ones.
FEW, MANY = 40, 300
METHODS: dict[str, tuple[str, dict]] = {
    "auto": ("auto", {"max_iterations": FEW}),
    "newton-krylov": ("newton-krylov", {"max_iterations": FEW}),
    "newton": ("newton", {"max_iterations": FEW}),
    "newton-chord": ("newton-chord", {"max_iterations": FEW}),
    "newton-kurchatov": ("newton-kurchatov", {"max_iterations": FEW}),
    "anderson": ("anderson", {"max_iterations": MANY}),
    "one-point": ("one-point", {"max_iterations": MANY}),
    "chord": ("chord", {"max_iterations": MANY}),
    "kurchatov": ("kurchatov", {"max_iterations": MANY}),
    "neumann": ("neumann", {"max_iterations": MANY}),
    "robin": ("robin", {"max_iterations": MANY}),
    "one-point, γ searched": ("one-point", {"gamma": "search", "max_iterations": MANY}),
    "chord, γ searched": ("chord", {"gamma": "search", "max_iterations": MANY}),
    "kurchatov, γ searched": ("kurchatov", {"gamma": "search", "max_iterations": MANY}),
}
#: How a run's end is written in the table where it is not a number of iterations.
MARKS = {"diverged": "÷", "iteration limit": "–", "stalled": "s", "no equilibrium": "∄"}


@dataclass(frozen=True)
class Outcome:
    """One run. expected: how it has to end; error: of pressures and elastic energy, against the coupled solution or a
    closed form; allowed: of that.
    """

    scene: str
    expected: str
    method: str
    status: str
    iterations: int
    body_solves: int
    residual: float | None
    error: float | None
    allowed: float
    cpu_seconds: float

    @property
    def solvable(self) -> bool:
        """Whether there is an equilibrium to be found."""
        return self.expected == "converged"

    @property
    def mark(self) -> str:
        """The cell in the table."""
        return str(self.iterations) if self.status == "converged" else MARKS[self.status]


def study(case: Case, methods: dict[str, tuple[str, dict]] = METHODS) -> list[Outcome]:
    """All methods on one scene."""
    scene = case.build()
    with warnings.catch_warnings():
        for category in (cd.LargeStrainWarning, cd.ContactWarning):  # loads are far too large on purpose
            warnings.simplefilter("ignore", category)
        exact = coupled_solution(scene)
        return [_run(case, scene, name, *way, exact) for name, way in methods.items()]


def _run(case: Case, scene: cd.Scene, name: str, method: str, options: dict, exact: cd.Solution) -> Outcome:
    """One method on a scene."""
    start = case.start if case.before is None else cd.solve(case.before())
    given = options | {"tolerance": TOLERANCE, "local_solver": case.local_solver, "on_failure": "return"}
    began = time.process_time()
    solution = cd.solve(scene, method, start=start, **given)
    return _outcome(case, name, solution, exact, time.process_time() - began)


def coupled_solution(scene: cd.Scene) -> cd.Solution:
    """The solution as far as rounding lets it come: where ten times more is out of reach, to about 1e-10."""
    return cd.solve(
        scene, "newton-chord", local_solver="assembled", tolerance=1e-11, max_iterations=30, on_failure="return"
    )


def _outcome(case: Case, method: str, solution: cd.Solution, exact: cd.Solution, seconds: float) -> Outcome:
    residual = solution.residual
    return Outcome(
        scene=case.name,
        expected=case.status,
        method=method,
        status=solution.status,
        iterations=solution.iterations,
        body_solves=int(solution.history.body_solves[-1]) if solution.iterations else 0,
        residual=residual if np.isfinite(residual) else None,
        error=error(solution, exact, case.pressure) if solution.converged else None,
        allowed=case.error or LARGEST_ERROR,
        cpu_seconds=round(seconds, 4),
    )


def error(solution: cd.Solution, exact: cd.Solution, uniform: float | None = None) -> float:
    """The larger of the relative L2 error of the pressures and the relative error of the elastic energy.

    uniform: the exact pressure where it is the same everywhere. Where an exact value is zero the error is absolute.
    """
    square = size = 0.0
    for index in range(len(solution.scene.contacts)):
        found, right = solution.contact(index), exact.contact(index)
        pressure = right.pressure if uniform is None else uniform
        square += found.weights @ (found.pressure - pressure) ** 2
        size += found.weights @ np.broadcast_to(pressure, found.weights.shape) ** 2
    energy, right_energy = solution.elastic_energy(), exact.elastic_energy()
    return float(max(_relative(np.sqrt(square), np.sqrt(size)), _relative(abs(energy - right_energy), right_energy)))


def _relative(difference: float, size: float) -> float:
    return difference / size if size > 0.0 else difference


def print_table(outcomes: list[Outcome]) -> None:
    """Iterations by scene and method."""
    names = list(METHODS)
    print("Iterations; ÷ diverged, – not there after the most, s stalled, ∄ no equilibrium\n")
    for i, name in enumerate(names):
        print(" " * 36 + " " * 5 * i + name)
    for scene in dict.fromkeys(outcome.scene for outcome in outcomes):
        cells = {outcome.method: outcome.mark for outcome in outcomes if outcome.scene == scene}
        print(f"{scene:36}" + "".join(f"{cells[name]:<5}" for name in names))


def judge(outcomes: list[Outcome]) -> dict[str, int]:
    """What every run must satisfy, counted: how many do not."""
    reached = [outcome for outcome in outcomes if outcome.status == "converged"]
    auto = [outcome for outcome in outcomes if outcome.method == "auto"]
    return {
        "scenes": len(auto),
        "runs": len(outcomes),
        "false convergence": sum(not (o.solvable and o.error is not None and o.error <= o.allowed) for o in reached),
        "false refusal": sum(o.status == "no equilibrium" != o.expected for o in outcomes),
        "auto ends otherwise than it must": sum(o.status != o.expected for o in auto),
    }


def print_methods(outcomes: list[Outcome]) -> None:
    """What each method can, as the table of the README."""
    print("\n| method | solved | refused rightly | steps, median (most) | body solves, median |\n|---|---|---|---|---|")
    for name in METHODS:
        solvable = [o for o in outcomes if o.method == name and o.solvable]
        refused = [o.status == o.expected for o in outcomes if o.method == name and not o.solvable]
        done = [o for o in solvable if o.status == "converged"]
        steps, solves = [o.iterations for o in done], [o.body_solves for o in done]
        print(
            f"| {name} | {len(done)} of {len(solvable)} | {sum(refused)} of {len(refused)} "
            f"| {np.median(steps):.0f} ({max(steps)}) | {np.median(solves):.0f} |"
        )


def locking() -> list[dict[str, float | str]]:
    """Nearly incompressible bodies: the error of the pressure by element, against the semi-analytic reference."""
    elements = {
        "linear triangles, one diagonal": {},
        "linear triangles, crossed": {"diagonal": "crossed"},
        "quadratic triangles": {"degree": 2},
    }
    rows = []
    for name, options in elements.items():
        row: dict[str, float | str] = {"element": name}
        for nu in (0.3, 0.49, 0.4999):
            result = cd.solve(two_blocks(nu=nu, **options)).contact(degree=16)
            exact = cd.reference.groove(nu=nu).pressure(result.x[:, 0])
            row[f"nu = {nu}"] = float(
                np.sqrt(result.weights @ (result.pressure - exact) ** 2 / (result.weights @ exact**2))
            )
        rows.append(row)
    return rows


def draw(outcomes: list[Outcome], path: str) -> None:
    """How many of the solvable scenes each method solves within a number of body solves."""
    figure = Figure(figsize=(9, 4.6), layout="constrained")
    axes = figure.subplots()
    count = len({outcome.scene for outcome in outcomes if outcome.solvable})
    for i, name in enumerate(METHODS):
        solves = sorted(o.body_solves for o in outcomes if o.method == name and o.status == "converged")
        steps, done = [1, *(max(n, 1) for n in solves)], range(len(solves) + 1)
        axes.step(steps, done, where="post", label=name, color=f"C{i % 7}", linestyle="-" if i < 7 else "--")
    axes.axhline(count, color="black", linewidth=0.6)
    axes.set_xscale("log")
    axes.set_xlabel("solves of single bodies")
    axes.set_ylabel(f"scenes solved, of {count}")
    axes.legend(frameon=False, fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.savefig(path, dpi=130)


def main(arguments: list[str] | None = None) -> None:
    report = Report(__file__, __doc__, arguments)
    began = time.process_time()
    outcomes = [outcome for case in all_cases() for outcome in study(case)]
    print_table(outcomes)
    rows = [asdict(outcome) for outcome in outcomes]
    with open(report.path("table.csv"), "w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    print_methods(outcomes)
    print("\nAuto: steps, solves of single bodies, residual, error, seconds")
    for o in outcomes:
        if o.method == "auto" and o.solvable:
            numbers = f"{o.residual:.1e}  {o.error:.1e}  {o.cpu_seconds:.2f}"
            print(f"{o.scene:36}{o.iterations:4}{o.body_solves:6}  {numbers}")
    print("\nError of the pressure as the bodies become incompressible")
    for row in locking():
        print("  " + ", ".join(f"{k}: {v:.1e}" if isinstance(v, float) else str(v) for k, v in row.items()))
    print()
    for name, value in judge(outcomes).items():
        print(f"{name}: {value}")
    print(f"{time.process_time() - began:.0f} s CPU")
    draw(outcomes, report.path("methods.png"))
    report.summary(rows)


if __name__ == "__main__":
    main()
