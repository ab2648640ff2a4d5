"""Load programmes: a parameter runs through values, each solve starts where the one before ended."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .base.arrays import Floats
from .base.checks import as_bool, check_choice
from .base.table import frame, numbered_columns, write_csv
from .body_result import BodyResult
from .contact import Contact
from .errors import ContactError, NotConvergedError
from .parameter import Parameter
from .scene import Scene
from .solution import Solution
from .solve import solve
from .system.start import Given


@dataclass
class LoadPath:
    """What a load programme went through.

    Args:
        values: the parameter's values that were solved for.
        solutions: one for each, unless they were not to be kept.
        records: {name: array (steps, ...)} of what was recorded at each.
        status: "converged", or that of the step that failed or was stopped ("stalled", "stopped", ...).
        reason: in words.
        failed: the last state of that step.
    """

    values: list[Any] = field(default_factory=list)
    solutions: list[Solution] = field(default_factory=list)
    records: dict[str, Floats] = field(default_factory=dict)
    status: str = "converged"
    reason: str = ""
    failed: Solution | None = None

    @property
    def converged(self) -> bool:
        """Whether every step converged."""
        return self.status == "converged"

    def columns(self) -> dict[str, Any]:
        """The parameter and what was recorded as columns by name, one row per step; arrays one column per entry."""
        table = numbered_columns("parameter", np.array(self.values, dtype=float))
        for name, record in self.records.items():
            table |= numbered_columns(name, record)
        return table

    def frame(self) -> Any:
        """The path as a pandas DataFrame, one row per step. Raises ImportError where pandas is not installed."""
        return frame(self.columns())

    def to_csv(self, path: str | os.PathLike[str]) -> Path:
        """The CSV file written, one line per step.

        Args:
            path: of the file.
        """
        return write_csv(path, self.columns())

    def export(self, folder: str | os.PathLike[str], name: str = "series") -> list[Path]:
        """The files written for ParaView: a series name.pvd, the first, and what `Solution.export` writes of each step.

        The time of the series is the step's number; each file holds the parameter's value as field data. On several
        ranks all have to call it; the first writes.

        Args:
            folder: where; it is made if missing.
            name: of the series' file.

        Raises:
            ValueError: for a path that kept no solutions.
        """
        from .view.export import export_series

        steps = [(solution._exported, value) for solution, value in zip(self._kept(), self.values, strict=True)]
        return self.solutions[0].scene.ranks.once(lambda: export_series(steps, Path(folder), name))

    def plot_contact(self, contact: str | int | Contact = 0, **options: Any) -> Any:
        """A matplotlib figure of a contact's pressure in every step, of plane bodies.

        Args:
            contact: its name, its place in the scene or the `Contact`.
            options: `along`, `path`, `stress_unit`, `length_unit`, as of `Solution.plot_contact`.
        """
        from .view.path_plot import plot_steps

        return plot_steps([solution.contact(contact) for solution in self._kept()], self._labels(), **options)

    def plot_bodies(self, **options: Any) -> Any:
        """A matplotlib figure of the bodies of all steps beside each other, drawn alike.

        Options: `columns`, `path`, and those of `Solution.plot_bodies`.
        """
        from .view.path_plot import plot_multiples

        return plot_multiples(self._bodies(), self._labels(), **options)

    def animate(self, path: str | os.PathLike[str], **options: Any) -> Path:
        """The GIF written, one frame a step.

        Args:
            path: of the file, which ends in .gif.
            options: `per_second`, and those of `Solution.plot_bodies`.
        """
        from .view.path_plot import animate

        return animate(self._bodies(), self._labels(), path, **options)

    def _kept(self) -> list[Solution]:
        """The solutions of the steps."""
        if not self.solutions:
            raise ValueError("keep_solutions = False: this path kept no solutions that could be shown or written")
        return self.solutions

    def _bodies(self) -> list[list[BodyResult]]:
        return [[solution.body(body) for body in solution._with_mesh()] for solution in self._kept()]

    def _labels(self) -> list[str]:
        """Each step's number and the parameter's value."""
        values = [", ".join(f"{number:g}" for number in np.ravel(value)) for value in self.values]
        return [f"step {number}: {value}" for number, value in enumerate(values, 1)]

    def __len__(self) -> int:
        return len(self.values)

    def __repr__(self) -> str:
        names = ", ".join(self.records) or "nothing"
        return f"LoadPath of {len(self)} steps: {self.status} ({self.reason}); recorded: {names}"


class StepFailedError(ContactError):
    """A load programme that a step ended early. Attribute: `path`, what was done before and the failed step."""

    def __init__(self, path: LoadPath) -> None:
        super().__init__(f"{path.status}: {path.reason}")
        self.path = path

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (replace(self.path, solutions=[], failed=None),)  # what a pickled copy can hold


def programme(
    scene: Scene,
    parameter: Parameter,
    values: Iterable[ArrayLike],
    *,
    record: Mapping[str, Callable[[Solution], ArrayLike]] | None = None,
    keep_solutions: bool = True,
    on_failure: str = "raise",
    start: Given | Solution | None = None,
    **solve_options: Any,
) -> LoadPath:
    """Solve a scene for one value of a parameter after another, each step started from the one before.

    record: {name: function of each step's `Solution`} to be kept as arrays; keep_solutions: whether to keep the
    solutions too; on_failure: "raise" StepFailedError when a step does not converge, or "return" the path so far with
    its status; start: of the first step; solve_options: of every `solve`. Afterwards the parameter has its last value.

    A step that a callback or the time limit stops has not converged either: it ends the programme, "stopped".

        q = cd.Parameter(0.0)
        ... cd.Pressure("top", q) ...
        path = cd.programme(scene, q, [1, 2, 5, 10], record={"force": lambda s: s.contact().force}, method="newton")
    """
    check_choice("on_failure", on_failure, ("raise", "return"))
    if not isinstance(parameter, Parameter):
        raise TypeError(f"parameter = {parameter!r}: expected a cd.Parameter")
    if not scene.follows(parameter):
        raise ValueError(f"parameter = {parameter!r}: no load, support or gap of the scene follows it")
    values, record = _values(values), _functions(record)
    keep_solutions = as_bool("keep_solutions", keep_solutions)
    with scene.ranks.together():
        path = _run(scene, parameter, values, record, keep_solutions, start, solve_options)
        if not path.converged and on_failure == "raise":
            raise StepFailedError(path)
        return path


def _run(
    scene: Scene,
    parameter: Parameter,
    values: Sequence[ArrayLike],
    record: Mapping[str, Callable[[Solution], ArrayLike]],
    keep_solutions: bool,
    start: Given | Solution | None,
    options: Mapping[str, Any],
) -> LoadPath:
    """The steps of a load programme, up to the first that fails."""
    path = LoadPath()
    rows: dict[str, list[Floats]] = {name: [] for name in record}
    lengths = scene.ranks.gather(len(values))
    if len(set(lengths)) > 1:
        raise ValueError(f"values: their numbers on the ranks are {lengths}; expected the same values on all")
    for number, value in enumerate(values, 1):
        parameter.value = value
        try:
            solution = _step(scene, start, options)
        except NotConvergedError as error:
            path.status, path.failed = error.status, error.solution
            path.reason = f"step {number} of {len(values)}, value {parameter.value}: {error.reason}"
            break
        start = solution
        path.values.append(parameter.value)
        for name, function in record.items():
            rows[name].append(np.asarray(function(solution), dtype=float))
        if keep_solutions:
            path.solutions.append(solution)
    else:
        path.reason = f"{len(values)} steps"
    path.records = {name: np.array(row) for name, row in rows.items()}
    return path


def _values(values: Iterable[ArrayLike]) -> Sequence[ArrayLike]:
    """The values of a programme, each checked before the first step."""
    wrong = not isinstance(values, Iterable) or isinstance(values, str | bytes | Mapping)
    if wrong or (isinstance(values, np.ndarray) and values.ndim == 0):
        raise TypeError(f"values = {values!r}: expected a sequence of numbers or arrays")
    found = list(values)
    for value in found:
        Parameter(value)  # refuses what none can have
    return found


def _functions(
    record: Mapping[str, Callable[[Solution], ArrayLike]] | None,
) -> Mapping[str, Callable[[Solution], ArrayLike]]:
    """What is to be recorded at each step, by name."""
    if record is None:
        return {}
    if not isinstance(record, Mapping):
        raise TypeError(f"record = {record!r}: expected a dictionary of functions of a solution")
    for name, function in record.items():
        if not isinstance(name, str) or not callable(function):
            raise TypeError(f"record = {{{name!r}: {function!r}}}: expected a function of a solution")
    return record


def _step(scene: Scene, start: Given | Solution | None, options: Mapping[str, Any]) -> Solution:
    """One step; where the state before leads astray (an open contact holds nothing), the default start has a try."""
    try:
        return _converged(solve(scene, start=start, **options))
    except NotConvergedError as error:
        if error.status != "diverged" or not isinstance(start, Solution):
            raise
        return _converged(solve(scene, **options))


def _converged(solution: Solution) -> Solution:
    """The same, refused where it was stopped: `solve` returns that as asked, but it is no step of a path."""
    if not solution.converged:
        raise NotConvergedError(solution.status, solution.reason, solution)
    return solution
