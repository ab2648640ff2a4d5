"""Files of VTK's XML formats, written as they are specified: unstructured grids (.vtu) and series of them (.pvd)."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, Indices

TYPES = {"float64": "Float64", "int64": "Int64", "uint8": "UInt8"}


#: The components of a symmetric tensor in VTK's order, and their positions among xx, yy, zz, yz, xz, xy.
TENSOR = {"XX": 0, "YY": 1, "ZZ": 2, "XY": 5, "YZ": 3, "XZ": 4}


@dataclass(frozen=True)
class Grid:
    """An unstructured grid of equal cells.

    points: (n, dim); cells: (c, k) in VTK's node order; cell_type: VTK's number; point_data, cell_data, field_data:
    {name: values}, vectors of the plane get a third component, arrays (n, 6) are symmetric tensors in the order xx, yy,
    zz, yz, xz, xy.
    """

    points: Floats
    cells: Indices
    cell_type: int
    point_data: Mapping[str, NDArray] = field(default_factory=dict)
    cell_data: Mapping[str, NDArray] = field(default_factory=dict)
    field_data: Mapping[str, NDArray] = field(default_factory=dict)

    def write(self, path: Path) -> Path:
        """The .vtu file written."""
        count, nodes = self.cells.shape
        cells = {
            "connectivity": self.cells.ravel(),
            "offsets": nodes * np.arange(1, count + 1),
            "types": np.full(count, self.cell_type, dtype=np.uint8),
        }
        parts = [
            _section("FieldData", {name: np.ravel(value) for name, value in self.field_data.items()}),
            f'<Piece NumberOfPoints="{len(self.points)}" NumberOfCells="{count}">',
            _section("PointData", self.point_data),
            _section("CellData", self.cell_data),
            _section("Points", {"points": self.points}),
            _section("Cells", cells),
            "</Piece>",
        ]
        return _write(path, "UnstructuredGrid", parts)


@dataclass(frozen=True)
class SeriesEntry:
    """One file of a series: at what time, which part of the model, and where it is from the series' file."""

    time: float
    part: int
    name: str
    file: str


def write_series(path: Path, entries: Sequence[SeriesEntry]) -> Path:
    """The .pvd file written, which shows the files in the order of their times."""
    lines = [
        f'<DataSet timestep="{entry.time!r}" part="{entry.part}" name={quoteattr(entry.name)} '
        f"file={quoteattr(entry.file)}/>"
        for entry in entries
    ]
    return _write(path, "Collection", lines)


def _write(path: Path, kind: str, parts: Sequence[str]) -> Path:
    # Files before 2.2 have the edges of hexahedra of higher degree in another order.
    head = f'<VTKFile type="{kind}" version="2.2" byte_order="LittleEndian" header_type="UInt64">'
    text = "\n".join(['<?xml version="1.0"?>', head, f"<{kind}>", *parts, f"</{kind}>", "</VTKFile>", ""])
    path.write_text(text, encoding="utf-8")
    return path


def _section(tag: str, arrays: Mapping[str, NDArray]) -> str:
    return "\n".join([f"<{tag}>", *(_array(name, values, tag) for name, values in arrays.items()), f"</{tag}>"])


def _array(name: str, values: NDArray, tag: str) -> str:
    """One array, its bytes after their number in base 64."""
    values = np.asarray(values)
    attributes = f"Name={quoteattr(name)}"
    if tag == "FieldData":
        attributes += f' NumberOfTuples="{len(values)}"'
    elif values.ndim == 2:
        values = _in_space(values)
        attributes += f' NumberOfComponents="{values.shape[1]}"'
        if values.shape[1] == 6:
            attributes += "".join(f' ComponentName{position}="{name}"' for position, name in enumerate(TENSOR))
    kind = np.dtype(np.uint8) if values.dtype == np.uint8 else np.dtype("<i8" if values.dtype.kind in "iub" else "<f8")
    raw = np.ascontiguousarray(values, dtype=kind).tobytes()
    # The number and the data are one text in base 64.
    text = base64.b64encode(np.uint64(len(raw)).astype("<u8").tobytes() + raw).decode()
    return f'<DataArray type="{TYPES[kind.name]}" {attributes} format="binary">{text}</DataArray>'


def _in_space(values: NDArray) -> NDArray:
    """Vectors with three components; symmetric tensors in VTK's order."""
    if values.shape[1] == 6:
        return values[:, list(TENSOR.values())]
    return np.pad(values, ((0, 0), (0, 3 - values.shape[1])))
