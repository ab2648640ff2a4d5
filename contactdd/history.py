"""The records of a run's iterations, as arrays and as a table."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import astuple, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .base.checks import check_choice
from .base.table import frame, html_table, write_csv


@dataclass(frozen=True)
class Record:
    """One iteration, from u^k to u^{k+1}.

    Attributes:
        iteration: k + 1.
        gamma: γ^k, the relaxation.
        change: The largest ‖u_n^{k+1} − u_n^k‖₂ / ‖u_n^{k+1}‖₂ of any body: at the nodes of the contacts where this is
            the stopping rule, as in the paper, else at their points.
        residual: ‖F₁'(u^{k+1})‖ relative to the forces at work.
        energy: F₁(u^{k+1}), eq. (13) (force · length).
        contact: The area where z^{k+1} < 0 (length per unit thickness in the plane).
        phi_min, phi_max: The range of φ^k over the points (stress / length).
        body_solves: The number of solves of single bodies so far.
        seconds: CPU time since the start of the run (s).
        note: The method's decisions in words, such as the linear solver that it chose.
    """

    iteration: int
    gamma: float
    change: float
    residual: float
    energy: float
    contact: float
    phi_min: float
    phi_max: float
    body_solves: int
    seconds: float
    note: str = ""


COLUMNS = tuple(field.name for field in fields(Record))


class History:
    """The records of a run; each column is an attribute: `history.change` is an array (iterations,).

    Example:
        >>> import contactdd as cd
        >>> history = cd.History()
        >>> history.append(cd.Record(1, 1.0, 0.5, 1e-3, -2.0, 1.0, 0.0, 50.0, 2, 0.01))
        >>> history.residual
        array([0.001])
    """

    def __init__(self) -> None:
        self._records: list[Record] = []

    def append(self, record: Record) -> None:
        """Add an iteration.

        Args:
            record: The record of the iteration.
        """
        self._records.append(record)

    def __len__(self) -> int:
        return len(self._records)

    def __iter__(self) -> Iterator[Record]:
        return iter(self._records)

    def __getitem__(self, index: int) -> Record:
        return self._records[index]

    def __getattr__(self, name: str) -> NDArray[np.float64]:
        if name not in COLUMNS:
            raise AttributeError(f"{name!r}: expected one of {', '.join(COLUMNS)}")
        return np.array([getattr(record, name) for record in self._records])

    def columns(self) -> dict[str, Any]:
        """The records as columns by name, those of `frame` and `to_csv`."""
        return {name: [getattr(record, name) for record in self._records] for name in COLUMNS}

    def frame(self) -> Any:
        """The history as a pandas DataFrame, one row per iteration.

        Raises:
            ImportError: pandas is not installed.
        """
        return frame(self.columns())

    def to_csv(self, path: str | os.PathLike[str]) -> Path:
        """The CSV file written, one line per iteration.

        Args:
            path: The path of the file.
        """
        return write_csv(path, self.columns())

    def plot(
        self,
        *,
        quantity: str = "residual",
        name: str = "",
        beside: Mapping[str, History] | None = None,
        path: str | os.PathLike[str] | None = None,
    ) -> Any:
        """A matplotlib figure of how the run converged, with the fitted rate.

        Args:
            quantity: "residual" or "change".
            name: The run's name in the legend.
            beside: {name: `History`} of other runs, drawn beside it.
            path: The path of a file to save the figure in, too.

        Raises:
            ValueError: The quantity is another, or two runs have one name.
        """
        from .view.convergence_plot import plot_convergence

        check_choice("quantity", quantity, ("residual", "change"))
        if name in (beside or {}):
            raise ValueError(f"name = {name!r}: another run is called so; expected a name of its own")
        runs = {name: self, **(beside or {})}
        return plot_convergence({run: getattr(runs[run], quantity) for run in runs}, quantity, path=path)

    def table(self, last: int | None = None) -> str:
        """The iterations as text.

        Args:
            last: The number of the last iterations to print; by default all.
        """
        rows = self._records if last is None else self._records[-last:]
        head = " ".join(f"{name:>11}" for name in COLUMNS)
        return "\n".join([head] + [" ".join(_cell(value) for value in astuple(row)).rstrip() for row in rows])

    def __repr__(self) -> str:
        return f"History of {len(self)} iterations\n{self.table(last=10)}"

    def _repr_html_(self) -> str:
        return html_table(COLUMNS, ([_cell(value) for value in astuple(row)] for row in self._records))


def _cell(value: float | str) -> str:
    if isinstance(value, str):
        return value
    return f"{value:>11d}" if isinstance(value, int) else f"{value:>11.4g}"
