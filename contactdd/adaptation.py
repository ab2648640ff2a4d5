"""Meshes made for a wanted accuracy: solve, estimate the error, refine where it comes from, and again."""

from __future__ import annotations

import time
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .base.checks import as_count, check_choice, positive
from .body import Body
from .error_estimate import ErrorEstimate, error_estimate
from .errors import ContactWarning
from .meshless import MeshlessBody
from .remeshing import planned, remade
from .scene import Scene
from .solution import Solution
from .solve import solve

#: The residual that is left to a solve, as a part of the wanted error: digits that meshes do not have are not paid for.
#: Pressures were off by less than a thousandth of their error then. Residuals below ROUNDING are not to be had.
DIGITS, ROUNDING = 1e-3, 1e-10

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
        solve_seconds: The CPU time of the solve on this mesh alone, without its estimate (s).
    """

    unknowns: int
    cells: dict[str, int]
    error: float
    energy_error: float
    cpu_seconds: float
    solve_seconds: float


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
    a large error. Far cells count little, whatever their own error is. Meshes of straight plane triangles are smoothed
    then: nodes move and edges flip until cells have the sizes that make them equally important, with a node at every
    edge of contact from degree 2 on. Nodes of the first meshes' outline stay, but those of contact surfaces, unless the
    layer is far stiffer than the elements. Other meshes are halved only, and each solve starts from the one before.
    Residuals are made smaller than the wanted accuracy by three digits. Names of surfaces, materials, supports and
    loads stay; the scene itself is left as it is.

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
    ranks, rounds, first = scene.ranks, list[Round](), scene
    tolerance = max(ROUNDING, DIGITS * limits.accuracy)
    began, cpu, start = time.monotonic(), time.process_time(), None
    while True:
        estimate = error_estimate(solve(scene, start=start, **{"tolerance": tolerance, **options}), tolerance=tolerance)
        rounds.append(_round(estimate, time.process_time() - cpu))
        status = ranks.agree(limits.ending(rounds, time.monotonic() - began))
        if status:
            return estimate, rounds, status
        # What is decided by rounding is decided once: all ranks have the same meshes.
        plan = ranks.agree(planned(estimate, limits.accuracy))
        scene = remade(scene, plan, first)
        if _unknowns(scene) > limits.unknowns:
            return estimate, rounds, "unknowns limit"
        start = None if plan.sizes else estimate.better  # nothing is carried over to nodes that have moved


def _refuse_what_stays(body: Body | MeshlessBody) -> None:
    """Refuse a body whose mesh cannot be refined, or that cannot be put on another one."""
    if isinstance(body, Body):
        body.mesh.refuse_other_than_simplices()
        body.refuse_expressions()


def _round(estimate: ErrorEstimate, seconds: float) -> Round:
    solution, scene = estimate.solution, estimate.solution.scene
    cells = {body.name: body.mesh.cells for body in scene.bodies if body.mesh is not None}
    errors = estimate.pressure.relative, estimate.energy.relative
    return Round(_unknowns(scene), cells, *errors, seconds, solution.cpu_seconds)


def _unknowns(scene: Scene) -> int:
    return sum(body.dofs for body in scene.bodies if body.mesh is not None)


def _stalled(rounds: Sequence[Round]) -> bool:
    """Whether the error has not fallen over some rounds."""
    if len(rounds) <= PATIENCE:
        return False
    return min(each.error for each in rounds[-PATIENCE:]) > FALLING * rounds[-PATIENCE - 1].error
