"""A state of a run as plain data, so that what was interrupted can go on to the same digits.

The file is a NumPy .npz archive of arrays of numbers; the description stands in it as JSON. Nothing in it is executed
on reading.
"""

from __future__ import annotations

import json
import os
import secrets
import threading
import time
import warnings
import zipfile
from contextlib import ExitStack
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np

from ..base.ranks import Ranks
from ..errors import CheckpointError
from ..history import History, Record
from ..system.ensemble import Ensemble, Forces
from ..system.state import State
from .claim import Claim, claim
from .interruption import saved_on_signals
from .run import Run, Snapshot

FORMAT = "contactdd checkpoint"


VERSION = 2


#: Largest difference of two scenes, relative to the largest number: rounding on another machine.
SAME = 1e-8


class CheckpointWriter:
    """Keeps a run's state in a file: at intervals, at the end and when the run is interrupted; None keeps nothing.

    A state that cannot be written is no reason to lose the run: it goes on with a warning, and the last state stays.
    """

    def __init__(self, path: str | Path | None, interval: float, run: Run) -> None:
        self._asked, self._interval, self._run = path, interval, run
        self._header = {} if path is None else _header(run.ensemble, run.scheme.name)
        self._claim: Claim | None = None
        self._kept: Snapshot | None = None
        self._failed: tuple[type, int | None] | None = None
        self._began = self._written = time.monotonic()
        self._writing = threading.RLock()  # a signal may come while the file is written
        self._open = ExitStack()

    def __enter__(self) -> CheckpointWriter:
        if self._asked is not None:
            self._claim = claim(Path(self._asked), self._foreign)
            if self._claim.refused:
                asked, path = str(self._asked), str(self._claim.path)
                _warn(f"checkpoint = {asked!r}: {self._claim.refused}; the state of this run is kept in {path!r}")
            self._open.callback(self._claim.release)
            self._open.enter_context(saved_on_signals(self.save))
        return self

    def __exit__(self, *error: object) -> None:
        with self._open:
            self.save()
        if self._claim is not None and self._kept is not self._run.snapshot:
            kept = "no state is kept" if self._kept is None else f"the state after {self._kept.done} iterations is kept"
            _warn(f"checkpoint = {str(self._claim.path)!r}: the last state was not written; {kept}")

    def update(self) -> None:
        """Write if it is time to."""
        if self._claim is not None and time.monotonic() - self._written >= self._interval:
            self.save()
            self._written = time.monotonic()

    def save(self) -> None:
        """Write the last complete iterate, if that has not been done."""
        if self._claim is None:
            return
        with self._writing:
            snapshot = self._run.snapshot
            if snapshot is self._kept:
                return
            try:
                _write(self._claim.path, self._header, self._run, snapshot)
                self._kept = snapshot
            except Exception as error:  # a full disk, a law that fails here too
                kind = (type(error), getattr(error, "errno", None))
                if kind != self._failed:  # told of once
                    self._failed = kind
                    _warn(f"checkpoint = {str(self._claim.path)!r}: not written ({error}); the run goes on")

    def _foreign(self, path: Path) -> str:
        """The reason not to overwrite a file; empty if there is none."""
        try:
            if path.stat().st_size == 0:
                return ""
        except FileNotFoundError:
            return ""
        except OSError as error:
            return f"it cannot be read ({error})"
        if not path.is_file():
            return "it is no file"
        try:
            with np.load(path, allow_pickle=False) as file:
                found = _from_bytes(file["header"])
        except Exception:
            return "it is no checkpoint and stays as it is"
        if not isinstance(found, dict) or found.get("format") != FORMAT:
            return "it is no checkpoint and stays as it is"
        other = [key for key in self._header if key != "version" and found.get(key) != self._header[key]]
        return f"it is a checkpoint of another run (other {' and '.join(other)}) and stays as it is" if other else ""


def _write(path: Path, header: dict[str, Any], run: Run, snapshot: Snapshot) -> None:
    """Write the state of a run.

    The file appears whole or not at all: an interruption while writing leaves the last one.
    """
    arrays = {"header": _as_bytes(header)}
    for name, parts in (_taken_apart(snapshot.state) | _told_by(run.ensemble, snapshot.state, snapshot.forces)).items():
        arrays |= {f"{name} {i}": part for i, part in enumerate(parts)}
    arrays |= {f"memory {i}": part for i, part in enumerate(snapshot.memory)}
    laws = [interface.layer for interface in run.ensemble.interfaces]
    arrays |= {
        f"closures {i}": law.closures  # type: ignore[attr-defined]
        for i, law in enumerate(laws)
        if law.remembers
    }
    arrays["history"] = _as_bytes([asdict(run.history[i]) for i in range(snapshot.done)])
    partial = path.with_name(f"{path.name}.{os.getpid()}-{secrets.token_hex(4)}.part")
    try:
        with open(partial, "xb") as file:
            np.savez(file, **arrays)  # type: ignore[arg-type]  # no name is `allow_pickle`, which is a bool
            file.flush()
            os.fsync(file.fileno())
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)


def _warn(text: str) -> None:
    """Tell the user, at the line that called `solve`."""
    warnings.warn(text, RuntimeWarning, stacklevel=2)


def read(path: str | Path, ensemble: Ensemble, method: str, ranks: Ranks) -> tuple[State, History, list[np.ndarray]]:
    """The state, the history and an accelerated method's memory.

    Raises CheckpointError for a file that is damaged, is something else, or belongs to another scene or method: other
    loads, gaps, layers or bodies would make its state pass for a solution.
    """
    path = Path(path)
    found, records, arrays = ranks.once(lambda: _contents(path))
    expected = _header(ensemble, method)
    for key in expected:
        if not isinstance(found, dict) or found.get(key) != expected[key]:
            there = found.get(key) if isinstance(found, dict) else found
            raise CheckpointError(f"checkpoint = {str(path)!r}: its {key} is {there!r}, expected {expected[key]!r}")
    unknowns, points = [ensemble.size], [len(interface.weights) for interface in ensemble.interfaces]
    sizes = {"unknowns": unknowns, "deformation": unknowns, "gaps": points, "previous_gaps": points}
    (y,), (deformation,), *gaps = (_parts(path, arrays, name, sizes[name]) for name in sizes)
    state = State(y, deformation, *gaps)
    for name, here in _told_by(ensemble, state, ensemble.forces(state)).items():
        for one, other in zip(_parts(path, arrays, name, [len(part) for part in here]), here, strict=True):
            if np.abs(one - other).max() > SAME * max(np.abs(one).max(), np.abs(other).max()):
                raise CheckpointError(f"checkpoint = {str(path)!r}: made with other {name}; expected the same scene")
    history = History()
    for record in records:
        history.append(record)
    memory = [arrays[f"memory {i}"] for i in range(sum(name.startswith("memory ") for name in arrays))]
    return state, history, memory


def closures(path: str | Path, ranks: Ranks) -> dict[int, np.ndarray]:
    """What the layers of a checkpoint's scene remembered, by the contacts' indices; empty if they did nothing."""
    arrays = ranks.once(lambda: _contents(Path(path)))[2]
    return {int(name.split()[1]): array for name, array in arrays.items() if name.startswith("closures ")}


def _contents(path: Path) -> tuple[Any, list[Record], dict[str, np.ndarray]]:
    """The header, the history and all arrays of a file, unchecked but for its form."""
    if not path.is_file():
        raise CheckpointError(f"checkpoint = {str(path)!r}: no such file")
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        records = [Record(**entry) for entry in _from_bytes(arrays["history"])]
        return _from_bytes(arrays["header"]), records, arrays
    except (OSError, EOFError, KeyError, TypeError, ValueError, zipfile.BadZipFile) as error:
        raise CheckpointError(f"checkpoint = {str(path)!r}: damaged, or not a checkpoint ({error})") from error


def _header(ensemble: Ensemble, method: str) -> dict[str, Any]:
    """The quantities that a checkpoint must share with the run that goes on from it."""
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


def _told_by(ensemble: Ensemble, state: State, forces: Forces) -> dict[str, list[np.ndarray]]:
    """Quantities that identify a scene at a given state, by the part of the scene they depend on."""
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
