"""Load programmes: a parameter runs through values, each solve starts where the one before ended."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .base.arrays import Floats
from .base.checks import as_bool, check_choice
from .base.table import frame, html_table, numbered_columns, write_csv
from .body_result import BodyResult
from .contact import Contact
from .errors import ContactError, NotConvergedError
from .parameter import Parameter
from .scene import Scene
from .solution import Solution
from .solve import solve
from .system.start import Given

#: What a picture calls a step.
LABEL = "step {step}: {value}"


@dataclass
class LoadPath:
    """The steps of a load programme: the parameter's values, the solutions and what was recorded of each.

    Attributes:
        values: The parameter's values that were solved for.
        solutions: The solution for each value; empty if they were not to be kept.
        records: {name: array (steps, ...)} of the recorded quantities.
        status: "converged", or the status of the step that failed or was stopped ("stalled", "stopped", ...).
        reason: The reason of that, in words.
        failed: The last iterate of the step that failed; None if none did.

    Example:
        >>> import contactdd as cd
        >>> path = cd.LoadPath(values=[1.0, 2.0], records={"force": np.array([3.0, 6.0])}, reason="2 steps")
        >>> path.converged, len(path), path.columns()["force"].tolist()
        (True, 2, [3.0, 6.0])
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
        """The parameter and the recorded quantities as columns by name, one row per step; one column per array entry.

        Returns:
            {"parameter": (steps,), name of a record: (steps,)}, with numbered names for the entries of arrays.
        """
        table = numbered_columns("parameter", np.array(self.values, dtype=float))
        for name, record in self.records.items():
            table |= numbered_columns(name, record)
        return table

    def frame(self) -> Any:
        """The path as a pandas DataFrame, one row per step.

        Raises:
            ImportError: pandas is not installed.
        """
        return frame(self.columns())

    def to_csv(self, path: str | os.PathLike[str]) -> Path:
        """The CSV file written, one line per step.

        Args:
            path: The path of the file.
        """
        return write_csv(path, self.columns())

    def export(self, folder: str | os.PathLike[str], name: str = "series") -> list[Path]:
        """The files written for ParaView: the series name.pvd, then those of `Solution.export` for each step.

        The time of the series is the step's number; each file holds the parameter's value as field data. Collective:
        on several ranks all have to call it; the first writes.

        Args:
            folder: The path of the folder, which is made if missing.
            name: The name of the series' file.

        Raises:
            ValueError: The path kept no solutions.
        """
        from .view.export import export_series

        steps = [(solution._exported, value) for solution, value in zip(self._kept(), self.values, strict=True)]
        return self.solutions[0].scene.ranks.once(lambda: export_series(steps, Path(folder), name))

    def plot_contact(self, contact: str | int | Contact = 0, *, label: str = LABEL, **options: Any) -> Any:
        """A matplotlib figure of a contact's pressure in every step, of plane bodies.

        Args:
            contact: Its name, its index in the scene or the `Contact`.
            label: The name of each step, a text with {step} and {value}, such as "q = {value} MPa".
            options: `along`, `path`, `stress_unit`, `length_unit`, as of `Solution.plot_contact`.

        Raises:
            ValueError: The path kept no solutions.
        """
        from .view.path_plot import plot_steps

        return plot_steps([solution.contact(contact) for solution in self._kept()], self._labels(label), **options)

    def plot_bodies(self, *, label: str = LABEL, **options: Any) -> Any:
        """A matplotlib figure of the bodies of all steps beside each other, drawn alike, with one bar.

        Args:
            label: The name of each step, a text with {step} and {value}.
            options: `columns`, and those of `Solution.plot_bodies` but `title`.

        Raises:
            ValueError: The path kept no solutions.
        """
        from .view.path_plot import plot_multiples

        return plot_multiples(self._bodies(), self._labels(label), **options)

    def animate(self, path: str | os.PathLike[str], *, label: str = LABEL, **options: Any) -> Path:
        """The GIF or MP4 written, one frame a step.

        Args:
            path: The path of the file, which ends in .gif or .mp4.
            label: The name of each step, a text with {step} and {value}.
            options: `per_second`, and those of `Solution.plot_bodies` but `title` and `path`.

        Raises:
            ValueError: The path kept no solutions, or the file ends otherwise.
            RuntimeError: An MP4 needs ffmpeg, which is not there.
        """
        from .view.path_plot import animate

        return animate(self._bodies(), self._labels(label), path, **options)

    def _kept(self) -> list[Solution]:
        """The solutions of the steps."""
        if not self.solutions:
            raise ValueError("keep_solutions = False: this path kept no solutions that could be shown or written")
        return self.solutions

    def _bodies(self) -> list[list[BodyResult]]:
        return [[solution.body(body) for body in solution._with_mesh()] for solution in self._kept()]

    def _labels(self, label: str) -> list[str]:
        """The names of all steps."""
        values = [", ".join(f"{number:g}" for number in np.ravel(value)) for value in self.values]
        return [label.format(step=step, value=value) for step, value in enumerate(values, 1)]

    def __len__(self) -> int:
        return len(self.values)

    def __repr__(self) -> str:
        names = ", ".join(self.records) or "nothing"
        return f"LoadPath of {len(self)} steps: {self.status} ({self.reason}); recorded: {names}"

    def _repr_html_(self) -> str:
        columns = {name: values for name, values in self.columns().items() if len(values) == len(self)}
        rows = ([f"{value:.6g}" for value in row] for row in zip(*columns.values(), strict=True))
        return f"<p><b>{escape(self.status)}</b>: {escape(self.reason)}</p>{html_table(columns, rows)}"


class StepFailedError(ContactError):
    """A load programme that was ended early by a step that did not converge.

    Attributes:
        path: The `LoadPath` up to that step; a pickled copy has no solutions.
    """

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
    """The solutions of a scene for one value of a parameter after another, each started from the one before.

    A step that a callback or the time limit stops has not converged either: it ends the programme, "stopped".
    Afterwards the parameter has the last value that was tried. Layers that remember, such as gaskets, begin each step
    as the one before has left them; `solutions[-1].scene_after` goes on.

    Args:
        scene: The scene.
        parameter: A parameter that a load, a prescribed displacement or a gap of the scene follows.
        values: Its values, one a step, in its own unit.
        record: {name: function of each step's `Solution`}: quantities to be kept as arrays.
        keep_solutions: Whether the solutions are kept, too.
        on_failure: "raise" an error when a step does not converge, or "return" the path so far with its status.
        start: The start of the first step, as of `solve`.
        solve_options: Other arguments of every `solve`.

    Returns:
        The path, with one value, solution and record for each step that converged.

    Raises:
        TypeError, ValueError: An argument is none of these; the scene does not follow the parameter; the values are not
            the same on all ranks.
        StepFailedError: A step did not converge, or was stopped.

    Example:
        >>> import contactdd as cd
        >>> q = cd.Parameter(0.0)
        >>> steel, mesh = cd.Isotropic(E=2e5, nu=0.0), cd.rectangle((0, 0), (2, 1), (2, 1))
        >>> lower = cd.Body("lower", mesh, steel, supports=[cd.Fixed("bottom")])
        >>> rollers = [cd.Symmetry("left"), cd.Symmetry("right")]
        >>> upper = cd.Body("upper", mesh.moved((0, 1)), steel, supports=rollers, loads=[cd.Pressure("top", q)])
        >>> scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.LinearLayer(1e4))])
        >>> path = cd.programme(scene, q, [1, 5], record={"force": lambda solution: solution.contact().force})
        >>> path.records["force"].round(6).tolist()  # 2 q
        [2.0, 10.0]
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
        start, scene = solution, solution.scene_after
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
    """The functions of a solution that are recorded at each step, by name, checked."""
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
    """The solution if it converged; an error if the solve was stopped, since a stopped solve is no step of a path."""
    if not solution.converged:
        raise NotConvergedError(solution.status, solution.reason, solution)
    return solution
