"""A state of a run as plain data, so that what was interrupted can go on to the same digits.

The file is a NumPy .npz archive of arrays of numbers; the description stands in it as JSON. Nothing in it is executed
on reading.
"""

from __future__ import annotations

import json
import os
import time
import zipfile
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import CheckpointError
from ..history import History, Record
from ..system.state import State

if TYPE_CHECKING:
    from ..system.ensemble import Ensemble
    from .run import Run


FORMAT = "contactdd checkpoint"


VERSION = 2


#: What two scenes may differ by, relative to the largest number: rounding on another machine.
SAME = 1e-8


class CheckpointWriter:
    """Keeps a run's state in a file: at intervals, at the end and when the run is interrupted; None keeps nothing."""

    def __init__(self, path: str | Path | None, interval: float, run: Run) -> None:
        self._path, self._interval, self._run = path, interval, run
        self._written = time.monotonic()

    def __enter__(self) -> CheckpointWriter:
        return self

    def __exit__(self, *error: object) -> None:
        if self._path is not None:
            write(self._path, self._run)

    def update(self) -> None:
        """Write if it is time to."""
        if self._path is not None and time.monotonic() - self._written >= self._interval:
            write(self._path, self._run)
            self._written = time.monotonic()


def write(path: str | Path, run: Run) -> None:
    """Write the state of a run.

    The file appears whole or not at all: an interruption while writing leaves the last one.
    """
    path = Path(path)
    header = _header(run.ensemble, run.scheme.name)
    arrays = {"header": _as_bytes(header)}
    for name, parts in (_taken_apart(run.state) | _told_by(run.ensemble, run.state)).items():
        arrays |= {f"{name} {i}": part for i, part in enumerate(parts)}
    if run.anderson is not None:
        arrays |= {f"memory {i}": part for i, part in enumerate(run.anderson.memory)}
    arrays["history"] = _as_bytes([asdict(record) for record in run.history])
    partial = path.with_name(path.name + ".part")
    with open(partial, "wb") as file:
        np.savez(file, **arrays)
        file.flush()
        os.fsync(file.fileno())
    os.replace(partial, path)


def read(path: str | Path, ensemble: Ensemble, method: str) -> tuple[State, History, list[np.ndarray]]:
    """The state, the history and an accelerated method's memory.

    Raises CheckpointError for a file that is damaged, is something else, or belongs to another scene or method: other
    loads, gaps, layers or bodies would make its state pass for a solution.
    """
    path = Path(path)
    if not path.is_file():
        raise CheckpointError(f"checkpoint = {str(path)!r}: no such file")
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        found = _from_bytes(arrays["header"])
        records = [Record(**entry) for entry in _from_bytes(arrays["history"])]
    except (OSError, EOFError, KeyError, TypeError, ValueError, zipfile.BadZipFile) as error:
        raise CheckpointError(f"checkpoint = {str(path)!r}: damaged, or not a checkpoint ({error})") from error
    expected = _header(ensemble, method)
    for key in expected:
        if not isinstance(found, dict) or found.get(key) != expected[key]:
            there = found.get(key) if isinstance(found, dict) else found
            raise CheckpointError(f"checkpoint = {str(path)!r}: its {key} is {there!r}, expected {expected[key]!r}")
    unknowns, points = [ensemble.size], [len(interface.weights) for interface in ensemble.interfaces]
    sizes = {"unknowns": unknowns, "deformation": unknowns, "gaps": points, "previous_gaps": points}
    (y,), (deformation,), *gaps = (_parts(path, arrays, name, sizes[name]) for name in sizes)
    state = State(y, deformation, *gaps)
    for name, here in _told_by(ensemble, state).items():
        for one, other in zip(_parts(path, arrays, name, [len(part) for part in here]), here, strict=True):
            if np.abs(one - other).max() > SAME * max(np.abs(one).max(), np.abs(other).max()):
                raise CheckpointError(f"checkpoint = {str(path)!r}: made with other {name}; expected the same scene")
    history = History()
    for record in records:
        history.append(record)
    memory = [arrays[f"memory {i}"] for i in range(sum(name.startswith("memory ") for name in arrays))]
    return state, history, memory


def _header(ensemble: Ensemble, method: str) -> dict[str, Any]:
    """What a checkpoint must have in common with the run that goes on from it."""
    return {
        "format": FORMAT,
        "version": VERSION,
        "method": method,
        "bodies": [[problem.name, problem.size] for problem in ensemble.problems],
        "contacts": [[interface.contact.name, len(interface.weights)] for interface in ensemble.interfaces],
    }


def _taken_apart(state: State) -> dict[str, list[np.ndarray]]:
    """The arrays of a state by name: of all bodies together, or one for each interface."""
    parts = {field.name: getattr(state, field.name) for field in fields(state)}
    return {name: part if isinstance(part, list) else [part] for name, part in parts.items()}


def _told_by(ensemble: Ensemble, state: State) -> dict[str, list[np.ndarray]]:
    """What a scene gives at a state, by what of the scene it tells."""
    forces = ensemble.forces(state)
    return {
        "loads or prescribed displacements": [ensemble.load],
        "geometry or gaps": ensemble.gaps(state.unknowns),
        "layers": [forces.tractions],
        "materials or cells": [forces.elastic],
    }


def _as_bytes(value: Any) -> np.ndarray:
    """Plain data as JSON, in an array of bytes."""
    return np.frombuffer(json.dumps(value).encode(), dtype=np.uint8)


def _from_bytes(array: np.ndarray) -> Any:
    """The plain data in such an array."""
    return json.loads(array.astype(np.uint8).tobytes().decode())


def _parts(path: Path, arrays: dict[str, np.ndarray], name: str, sizes: list[int]) -> list[np.ndarray]:
    """The arrays of one name that a state needs, their sizes as given, each checked."""
    parts = []
    for i, size in enumerate(sizes):
        part = arrays.get(f"{name} {i}")
        if part is None or part.dtype != np.float64 or part.shape != (size,) or not np.all(np.isfinite(part)):
            raise CheckpointError(
                f"checkpoint = {str(path)!r}: damaged, its {name} {i} should be {size} finite numbers"
            )
        parts.append(part)
    return parts
