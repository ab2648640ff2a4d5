"""Contact surfaces as one XDMF file in plain text, to be read without any library, or by ParaView."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from ..surface_result import SurfaceResult

#: XDMF's names of facets by their number of corners.
SHAPES = {2: "Polyline", 3: "Triangle", 4: "Quadrilateral"}


def write_surfaces(path: Path, surfaces: Sequence[SurfaceResult]) -> Path:
    """The .xdmf file written: a grid of each surface's straight facets that lie opposite the other surface."""
    grids = [_grid(surface, surface.status > 0) for surface in surfaces]
    text = "\n".join(['<?xml version="1.0"?>', '<Xdmf Version="3.0">', "<Domain>", *grids, "</Domain>", "</Xdmf>", ""])
    path.write_text(text, encoding="utf-8")
    return path


def _grid(surface: SurfaceResult, told: NDArray[np.bool_]) -> str:
    outlines = surface.outlines[told]
    facets, corners, dim = outlines.shape
    points = np.pad(outlines.reshape(-1, dim), ((0, 0), (0, 3 - dim)))
    shape = f'TopologyType="{SHAPES[corners]}" NumberOfElements="{facets}" NodesPerElement="{corners}"'
    values = {
        "pressure": surface.pressure,
        "gap": surface.gap,
        "compression": surface.compression,
        "status": surface.status,
    }
    return "\n".join(
        [
            f'<Grid Name={quoteattr(f"{surface.name} on {surface.body}")} GridType="Uniform">',
            f"<Topology {shape}>{_item(np.arange(facets * corners).reshape(facets, corners))}</Topology>",
            f'<Geometry GeometryType="XYZ">{_item(points)}</Geometry>',
            *(_attribute(name, value[told]) for name, value in values.items()),
            "</Grid>",
        ]
    )


def _attribute(name: str, values: NDArray) -> str:
    return f'<Attribute Name="{name}" AttributeType="Scalar" Center="Cell">{_item(values)}</Attribute>'


def _item(values: NDArray) -> str:
    """Numbers as text, in as many digits as they have."""
    kind = 'NumberType="Int"' if values.dtype.kind == "i" else 'NumberType="Float" Precision="8"'
    rows = [" ".join(map(repr, row)) for row in np.atleast_2d(values.T).T.tolist()]
    dimensions = " ".join(map(str, values.shape))
    return "\n".join([f'<DataItem Dimensions="{dimensions}" {kind} Format="XML">', *rows, "</DataItem>"])
