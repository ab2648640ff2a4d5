"""Columns of numbers as a CSV file, as a pandas frame or in HTML."""

from __future__ import annotations

import csv
import os
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from .arrays import Floats

#: Columns of equal length by name.
Columns = Mapping[str, Any]


def write_csv(path: str | os.PathLike[str], columns: Columns) -> Path:
    """The file written: one line of names, then one of values per row, floats in as many digits as they have."""
    file = Path(path)
    with open(file, "w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(columns)
        writer.writerows(zip(*(np.asarray(column).tolist() for column in columns.values()), strict=True))
    return file


def frame(columns: Columns) -> Any:
    """The columns as a pandas DataFrame. Raises ImportError where pandas is not installed."""
    try:
        import pandas
    except ImportError as error:
        raise ImportError("frame() needs pandas, which is not installed; to_csv() works without it") from error
    return pandas.DataFrame({name: np.asarray(column) for name, column in columns.items()})


def html_table(head: Iterable[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in HTML of texts that are no HTML."""
    titles = "".join(f"<th>{escape(name)}</th>" for name in head)
    cells = ("".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows)
    return f"<table><tr>{titles}</tr>{''.join(f'<tr>{row}</tr>' for row in cells)}</table>"


def vector_columns(name: str, values: Floats) -> dict[str, Floats]:
    """The components of vectors (n, 2) or (n, 3) as columns `name_x`, `name_y`, …; `x`, `y`, … without a name."""
    prefix = f"{name}_" if name else ""
    return {prefix + axis: values[:, column] for column, axis in enumerate("xyz"[: values.shape[1]])}


def numbered_columns(name: str, values: Floats) -> dict[str, Floats]:
    """An array (n, ...) as one column, or as one for each of its entries per row: `name_0`, `name_1`, …"""
    if values.ndim == 1:
        return {name: values}
    flat = values.reshape(len(values), -1)
    return {f"{name}_{column}": flat[:, column] for column in range(flat.shape[1])}
