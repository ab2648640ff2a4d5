"""Bulk data of Nastran and geometries: volumes, surfaces and bodies of files made here."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from test_universal import gmsh, quarter_ring, sizes

import contactdd as cd

STEEL = cd.Isotropic(2.1e5, 0.3)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("kind", ["triangle", "quadrilateral", "tetrahedron", "hexahedron"])
def test_bulk_data_of_gmsh(tmp_path, kind, order):
    """All kinds of cells and both orders; gmsh numbers the properties by its entities."""
    path = tmp_path / "ring.bdf"
    quarter_ring(path, kind, order, of_nodes=False)
    if kind in ("triangle", "quadrilateral"):  # gmsh writes curved lines as two-node bars, and then leaves some out
        path.write_text("".join(line for line in path.open() if not line.startswith(("CBAR", "CROD"))))
    mesh = cd.read_mesh(path)
    assert mesh.domain.topology.cell_name() == kind
    volume, surfaces = sizes(mesh)
    high = 0.5 if mesh.dim == 3 else 1
    error = (np.pi / 12) ** 2 if order == 1 else (np.pi / 12) ** 4 / 20
    assert volume == pytest.approx(np.pi / 4 * 3 * high, rel=error)
    if mesh.dim == 3:
        assert sum(np.isclose(area, np.pi * high, rtol=error) for area in surfaces.values()) == 1


#: Two hexahedra on each other, of two properties, and a shell between them and one on top, in all ways to write fields.
FREE = """$ made by hand
BEGIN BULK
GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
GRID,3,,1.,1.,0.
GRID,4,,0.,1.,0.
GRID*                  5                              0.              0.
*                     1.
GRID    6               1.      0.      10.-1
GRID    7               1.      1.      1.0+0
GRID    8               0.      1.      0.1D1
GRID,9,,0.,0.,2.
GRID,10,,1.,0.,2.
GRID,11,,1.,1.,2.
GRID,12,,0.,1.,2.
CHEXA   1       4       1       2       3       4       5       6       +A
+A      7       8
CHEXA,2,5,5,6,7,8,9,10,+B
+B,11,12
CQUAD4,11,7,9,10,11,12,0.0,0.0
PSOLID,4,1
MAT1,1,2.1+5,,0.3
ENDDATA
"""


def test_fields_and_properties(tmp_path):
    path = tmp_path / "two.bdf"
    path.write_text(FREE)
    bodies = cd.read_bodies(path)
    assert {name: sizes(mesh) for name, mesh in bodies.items()} == {
        "4": (pytest.approx(1.0), {}),
        "5": (pytest.approx(1.0), {"7": pytest.approx(1.0)}),
    }
    both = cd.read_mesh(path)
    assert {name: len(cells) for name, cells in both.subdomains.items()} == {"4": 1, "5": 1}


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("GRID,2,,", "GRID,2,3,", "coordinate system 3"),
        ("GRID,2,,1.", "GRID,2,,one", "cannot be read"),
        ("CHEXA,2,5,5,6", "CHEXA,2,5,5,", "node 0, which is not there"),
        ("+B,11,12", "+B,11,12,1", "lacks some of the nodes"),
    ],
)
def test_refused_bulk_data(tmp_path, old, new, words):
    path = tmp_path / "two.bdf"
    assert old in FREE
    path.write_text(FREE.replace(old, new))
    with pytest.raises(ValueError, match=words):
        cd.read_mesh(path)


def written(path: Path, made) -> Path:
    """A file of gmsh's; made: adds the geometry and, for meshes, generates them."""
    gmsh.initialize(["tests", "-v", "1"], interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        made(gmsh.model)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()
    return path


def two_boxes(model) -> None:
    model.occ.addBox(0, 0, 0, 2, 1, 1)
    model.occ.addBox(0, 0, 1, 2, 1, 0.5)
    model.occ.synchronize()


def shell(model) -> None:
    """The surface of a cylinder 1 high, of radius 1."""
    model.occ.addCylinder(0, 0, 0, 0, 0, 1, 1)
    model.occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.2)
    model.mesh.generate(2)


def test_two_solids_of_a_step_file(tmp_path):
    """An assembly, meshed with a size, in pieces, its surfaces named by where they lie; they press each other."""
    path = written(tmp_path / "two.step", two_boxes)
    at = lambda z: lambda x: np.isclose(x[2], z)  # noqa: E731
    mesh = cd.read_geometry(path, 0.5, bottom=at(0), middle=at(1), top=at(1.5))
    low, high = sorted(mesh.pieces(), key=lambda piece: piece.domain.geometry.x[:, 2].min())
    assert sizes(low)[0] == pytest.approx(2)
    assert sizes(high) == (
        pytest.approx(1.0),
        {"middle": pytest.approx(2), "top": pytest.approx(2)},
    )
    assert cd.read_geometry(path, 0.25).cells > 4 * mesh.cells
    lower = cd.Body("low", low, STEEL, supports=[cd.Fixed("bottom")])
    upper = cd.Body("high", high, STEEL, loads=[cd.Pressure("top", 3.0)])
    scene = cd.Scene([lower, upper], [cd.Contact((lower, "middle"), (upper, "middle"), cd.LinearLayer(1e4))])
    assert cd.solve(scene).contact().force == pytest.approx(6.0, rel=1e-8)


def test_inside_of_an_stl(tmp_path):
    """A closed surface of triangles is filled: the volume is that of its facets."""
    path = written(tmp_path / "cylinder.stl", shell)
    mesh = cd.read_geometry(path, 0.4, base=lambda x: x[2] < 1e-6, lid=lambda x: x[2] > 1 - 1e-6)
    volume, surfaces = sizes(mesh)
    # Chords of 0.2 to 0.4 of a circle of radius 1 miss up to θ²/6 of its area.
    assert volume == pytest.approx(np.pi, rel=0.03)
    assert surfaces == {"base": pytest.approx(np.pi, rel=0.03), "lid": pytest.approx(np.pi, rel=0.03)}


def test_med_without_h5py(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "h5py", None)
    path = tmp_path / "ring.med"
    path.write_bytes(b"\x89HDF\r\n\x1a\n\0\0")
    with pytest.raises(ValueError, match="MED file, which needs h5py"):
        cd.read_mesh(path)


def test_refused_geometries(tmp_path):
    path = tmp_path / "open.stl"
    corners = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
    path.write_text(f"solid a\nfacet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\nendsolid\n")
    with pytest.raises(ValueError, match=r"3 edges have not two triangles"):
        cd.read_geometry(path, 0.1)
    deck = tmp_path / "a.inp"
    deck.write_text("*NODE\n1, 0, 0\n")
    with pytest.raises(ValueError, match=r"cd.read_geometry reads STEP and STL"):
        cd.read_geometry(deck, 1.0)
    with pytest.raises(ValueError, match="size = -1"):
        cd.read_geometry(path, -1)
