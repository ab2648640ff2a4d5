"""Meshes made for a wanted accuracy: solve, estimate the error, refine where it comes from, and again."""

from __future__ import annotations

import time
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from dolfinx import fem

from .base.arrays import Floats, Integers
from .base.checks import as_count, check_choice, positive
from .body import Body
from .error_estimate import ErrorEstimate, cell_energies, error_estimate
from .errors import ContactWarning
from .interface.surface import ContactSurface
from .meshless import MeshlessBody
from .scene import Scene
from .solution import Solution
from .solve import solve

#: What part of the error of the pressure the refined cells carry: of what the displacement's error in cells does to it,
#: and of its square on the contacts' own facets. Smaller parts save a few cells and cost more rounds.
INFLUENCE_SHARE, PRESSURE_SHARE = 0.7, 0.3

#: Errors that differ by less are alike: bodies that are copies of each other stay so, and are condensed once.
ALIKE = 1e-6

#: The error has to fall below this part of its value within so many rounds, or it does not fall any more.
FALLING, PATIENCE = 0.9, 4


@dataclass(frozen=True)
class Round:
    """One mesh of an adaptation.

    Args:
        unknowns: The degrees of freedom of all bodies.
        cells: The number of cells of every body, by name.
        error: The estimated relative error of the contact pressure in L².
        energy_error: The estimated relative error of the energy.
        cpu_seconds: The CPU time since the start, with all rounds before (s).
    """

    unknowns: int
    cells: dict[str, int]
    error: float
    energy_error: float
    cpu_seconds: float


@dataclass(frozen=True)
class Adaptation:
    """A solution on meshes made for a wanted accuracy.

    Args:
        estimate: The errors of the last solution, with a better one.
        rounds: The meshes on the way, their errors and costs.
        accuracy: The relative error of the contact pressure in L² that was asked for.
        status: "reached", "unknowns limit", "time limit", "rounds limit" or "stalled".
    """

    estimate: ErrorEstimate
    rounds: tuple[Round, ...]
    accuracy: float
    status: str

    @property
    def solution(self) -> Solution:
        """The last solution, of which the errors are."""
        return self.estimate.solution

    @property
    def scene(self) -> Scene:
        """The scene with the last meshes."""
        return self.solution.scene

    @property
    def reached(self) -> bool:
        """Whether the estimated error is at most what was asked for."""
        return self.status == "reached"

    def __repr__(self) -> str:
        head = f"Adaptation: {self.status}, pressure {self.rounds[-1].error:.2g} of {self.accuracy:.2g} asked for"
        rows = (f"{r.unknowns:>9d} unknowns  error {r.error:.3e}  {r.cpu_seconds:.3g} s" for r in self.rounds)
        return "\n  ".join([head, *rows])


def adapt(
    scene: Scene,
    accuracy: float,
    *,
    max_unknowns: int = 300_000,
    max_rounds: int = 30,
    time_limit: float | None = None,
    on_failure: str = "warn",
    **options: Any,
) -> Adaptation:
    """A solution whose estimated error of the contact pressure is at most what is asked for.

    Starts with the scene's own meshes, which should show every contact by a few facets, and refines them where the
    estimated error of p comes from: a cell's part is the energy norm of the displacement's error there times that of
    the error of its influence, the displacement z of `Solution.influence` for that error of p; and cells at facets with
    a large error. Far cells count little, whatever their own error is.
    Each solve starts from the one before. Names of surfaces, materials, supports and loads stay; the scene itself is
    left as it is.

    Args:
        scene: With meshes of triangles or tetrahedra, in elements of any degree.
        accuracy: The relative error of the contact pressure of all contacts in L² (no unit).
        max_unknowns: The most degrees of freedom of all bodies, those of the estimate's solves not counted.
        max_rounds: The most meshes.
        time_limit: The time after which no further round is begun (s), by default unlimited.
        on_failure: "warn" where the accuracy is not reached (`ContactWarning`), or "ignore" it; the status tells.
        options: Of every `solve`, such as `local_solver`.

    Raises:
        TypeError, ValueError: An argument is none of these, a mesh cannot be refined, or its error not be estimated.
        NotConvergedError: A solve does not end.

    Example:
        >>> import contactdd as cd
        >>> meshes = [cd.rectangle((0, y), (2, y + 1), (8, 4)) for y in (0, 1)]
        >>> steel = cd.Isotropic(E=2.1e5, nu=0.3)
        >>> low = cd.Body("low", meshes[0], steel, supports=[cd.Fixed("bottom")])
        >>> high = cd.Body("high", meshes[1], steel, loads=[cd.Pressure("top", lambda x: 1 + x[0])])
        >>> scene = cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(1e6))])
        >>> cd.adapt(scene, 1e-2).reached
        True
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"scene = {scene!r}: expected a cd.Scene")
    limits = _Limits(
        positive("accuracy", accuracy),
        as_count("max_unknowns", max_unknowns),
        as_count("max_rounds", max_rounds),
        np.inf if time_limit is None else positive("time_limit", time_limit),
    )
    check_choice("on_failure", on_failure, ("warn", "ignore"))
    scene.refuse_deferred("adapt")
    for body in scene.bodies:
        _refuse_what_stays(body)
    estimate, rounds, status = _refined_until(scene, limits, options)
    if status != "reached" and on_failure == "warn" and scene.ranks.comm.rank == 0:
        warnings.warn(
            f"adapt: {status}, the estimated error of the pressure is {rounds[-1].error:.2g} and not "
            f"{limits.accuracy:.2g}",
            ContactWarning,
            stacklevel=2,
        )
    return Adaptation(estimate, tuple(rounds), limits.accuracy, status)


@dataclass(frozen=True)
class _Limits:
    """accuracy: the wanted relative error; unknowns, rounds, seconds: the most of each."""

    accuracy: float
    unknowns: int
    rounds: int
    seconds: float

    def ending(self, rounds: Sequence[Round], seconds: float) -> str:
        """The status with which the rounds so far end; empty if they go on."""
        if rounds[-1].error <= self.accuracy:
            return "reached"
        if _stalled(rounds):
            return "stalled"
        if len(rounds) >= self.rounds:
            return "rounds limit"
        return "time limit" if seconds >= self.seconds else ""


def _refined_until(scene: Scene, limits: _Limits, options: dict[str, Any]) -> tuple[ErrorEstimate, list[Round], str]:
    """The last estimate, all rounds and the status."""
    ranks, rounds = scene.ranks, list[Round]()
    began, cpu, start = time.monotonic(), time.process_time(), None
    while True:
        estimate = error_estimate(solve(scene, start=start, **options))
        rounds.append(_round(estimate, time.process_time() - cpu))
        status = ranks.agree(limits.ending(rounds, time.monotonic() - began))
        if status:
            return estimate, rounds, status
        # What is decided by rounding is decided once: all ranks have the same meshes.
        scene = scene.refined(ranks.agree(_marked(estimate)))
        if _unknowns(scene) > limits.unknowns:
            return estimate, rounds, "unknowns limit"
        start = estimate.better


def _refuse_what_stays(body: Body | MeshlessBody) -> None:
    """Refuse a body whose mesh cannot be refined, or that cannot be put on another one."""
    if isinstance(body, Body):
        body.mesh.refuse_other_than_simplices()
        body.refuse_expressions()


def _round(estimate: ErrorEstimate, seconds: float) -> Round:
    scene = estimate.solution.scene
    cells = {body.name: body.mesh.cells for body in scene.bodies if body.mesh is not None}
    return Round(_unknowns(scene), cells, estimate.pressure.relative, estimate.energy.relative, seconds)


def _unknowns(scene: Scene) -> int:
    return sum(body.dofs for body in scene.bodies if body.mesh is not None)


def _stalled(rounds: Sequence[Round]) -> bool:
    """Whether the error has not fallen over some rounds."""
    if len(rounds) <= PATIENCE:
        return False
    return min(each.error for each in rounds[-PATIENCE:]) > FALLING * rounds[-PATIENCE - 1].error


def _marked(estimate: ErrorEstimate) -> dict[str, Integers]:
    """The cells of every body to be refined."""
    bodies = estimate.solution.scene.bodies
    chosen: list[set[int]] = [set() for _ in bodies]
    facets = _facet_errors(estimate)
    for (place, cell), keep in zip(facets, _largest(list(facets.values()), PRESSURE_SHARE), strict=True):
        if keep:
            chosen[place].add(cell)
    influences = _cell_influences(estimate)
    kept = _largest(np.concatenate(influences), INFLUENCE_SHARE)
    for place, part in enumerate(np.split(kept, np.cumsum([len(each) for each in influences])[:-1])):
        chosen[place].update(int(cell) for cell in np.flatnonzero(part))
    return {body.name: np.array(sorted(cells)) for body, cells in zip(bodies, chosen, strict=True) if cells}


def _largest(values: Sequence[float] | Floats, share: float) -> Any:
    """Which values (n,) are the fewest that make up a share of their sum, and others like the least of them."""
    array = np.asarray(values, dtype=float)
    order = np.argsort(-array, kind="stable")
    before = np.concatenate([[0.0], np.cumsum(array[order])[:-1]])
    kept = np.zeros(len(array), dtype=bool)
    kept[order] = (before < share * array.sum()) & (array[order] > 0.0)
    return kept | (array >= (1 - ALIKE) * array[kept].min(initial=np.inf))


def _facet_errors(estimate: ErrorEstimate) -> dict[tuple[int, int], float]:
    """∫ (p − p_better)² over the facets of both sides of all contacts, by body and cell."""
    found: dict[tuple[int, int], float] = {}
    for interface, contact in zip(estimate.solution.interfaces, estimate.contacts, strict=True):
        for side in interface.sides:
            surface = side.surface
            if not isinstance(surface, ContactSurface):
                continue
            squares = surface.weights * (side.transfer @ contact.pressure_error**2)
            for cell, error in zip(surface.entities[:, 0], squares.reshape(len(surface.facets), -1), strict=True):
                key = side.body, int(cell)
                found[key] = found.get(key, 0.0) + float(error.sum())
    return found


def _cell_influences(estimate: ErrorEstimate) -> list[Floats]:
    """‖e‖ ‖z − I z‖ in the energy norm over every cell of every body, (cells,) each, empty for one without a mesh.

    e is the displacement's estimated error, z its influence on ∫ (p − p_better)² and I z that in the solution's own
    elements: those that they can show cause no error.
    """
    better, bodies = estimate.better, estimate.solution.scene.bodies
    influences = better.influence(_errors_at_better_points(estimate))
    found: list[Floats] = []
    for own, body, z in zip(bodies, better.scene.bodies, influences, strict=True):
        if body.mesh is None:
            found.append(np.zeros(0))
            continue
        error = estimate.displacement_error(body.name).x.array
        energies = cell_energies(body, [error, z - _shown(z, body, own)])
        found.append(np.sqrt(energies[0] * energies[1]))
    return found


def _shown(z: Floats, body: Body, own: Body) -> Floats:
    """A displacement (dofs,) of a body as the elements of a lower degree show it."""
    whole, shown, again = (fem.Function(each.space) for each in (body, own, body))
    whole.x.array[:] = z
    shown.interpolate(whole)
    again.interpolate(shown)
    return again.x.array


def _errors_at_better_points(estimate: ErrorEstimate) -> list[Floats]:
    """p − p_better at the points of the better solution's contacts."""
    contacts = zip(estimate.better.interfaces, estimate.contacts, strict=True)
    return [estimate.solution.contact_at(interface)[1] - contact.better.pressure for interface, contact in contacts]
