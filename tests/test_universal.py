"""Universal files, written by gmsh: elements of both orders, groups of elements and of nodes by name."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from dolfinx import fem

import contactdd as cd

gmsh = pytest.importorskip("gmsh")

STEEL = cd.Isotropic(2.1e5, 0.3)


def sizes(mesh: cd.Mesh) -> tuple[float, dict[str, float]]:
    """The volume and the size of each surface."""
    body = cd.Body("body", mesh, STEEL)
    volume = fem.assemble_scalar(fem.form(body.elements.over_volume(fem.Constant(mesh.domain, 1.0))))
    return volume, {name: body.elements.area(name) for name in mesh.surfaces}


def quarter_ring(path: Path, kind: str, order: int, *, of_nodes: bool) -> None:
    """A quarter of a ring 1 < r < 2, its solid 0.5 high, with the group "outside" at r = 2."""
    quads, solid = kind in ("quadrilateral", "hexahedron"), kind in ("tetrahedron", "hexahedron")
    gmsh.initialize(["tests", "-v", "1"], interruptible=False)
    try:
        geo, model = gmsh.model.geo, gmsh.model
        centre = geo.addPoint(0, 0, 0)
        points = [geo.addPoint(*x, 0) for x in ((1, 0), (2, 0), (0, 2), (0, 1))]
        lines = [
            geo.addLine(points[0], points[1]),
            geo.addCircleArc(points[1], centre, points[2]),
            geo.addLine(points[2], points[3]),
            geo.addCircleArc(points[3], centre, points[0]),
        ]
        surface = geo.addPlaneSurface([geo.addCurveLoop(lines)])
        for line, count in zip(lines, (4, 7, 4, 7), strict=True):
            geo.mesh.setTransfiniteCurve(line, count)
        geo.mesh.setTransfiniteSurface(surface)
        if quads:
            geo.mesh.setRecombine(2, surface)
        cells, outside = surface, lines[1]
        if solid:
            made = geo.extrude([(2, surface)], 0, 0, 0.5, numElements=[2], recombine=quads)
            cells, outside = made[1][1], made[3][1]
        geo.synchronize()
        dim = 3 if solid else 2
        model.addPhysicalGroup(dim, [cells], name="ring")
        model.addPhysicalGroup(dim - 1, [outside], name="outside")
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
        gmsh.option.setNumber("Mesh.SaveGroupsOfNodes", of_nodes)
        gmsh.option.setNumber("Mesh.SaveGroupsOfElements", not of_nodes)
        model.mesh.generate(dim)
        model.mesh.setOrder(order)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("kind", ["triangle", "quadrilateral", "tetrahedron", "hexahedron"])
@pytest.mark.parametrize("of_nodes", [False, True])
def test_kinds_orders_and_groups(tmp_path, kind, order, of_nodes):
    path = tmp_path / "ring.unv"
    quarter_ring(path, kind, order, of_nodes=of_nodes)
    mesh = cd.read_mesh(path)
    solid = mesh.dim == 3
    assert mesh.domain.topology.cell_name() == kind
    volume, surfaces = sizes(mesh)
    # Of arcs of 15° a chord misses θ²/6 of the area, a parabola the order of θ⁴.
    error = (np.pi / 12) ** 2 if order == 1 else (np.pi / 12) ** 4 / 20
    assert volume == pytest.approx(np.pi / 4 * 3 * (0.5 if solid else 1), rel=error)
    assert surfaces["outside"] == pytest.approx(np.pi * (0.5 if solid else 1), rel=error)
    if not of_nodes:
        assert set(surfaces) == {"outside"}
        assert cd.read_mesh(path, "ring").cells == mesh.cells
        assert list(cd.read_bodies(path)) == ["ring"]


@pytest.mark.parametrize("dataset", ["2467", "2477", "2435", "2452"])
def test_groups_of_every_dataset_are_kept(tmp_path, dataset):
    path = tmp_path / "ring.unv"
    quarter_ring(path, "triangle", 1, of_nodes=False)
    text = path.read_text()
    assert "\n  2477\n" in text
    path.write_text(text.replace("\n  2477\n", f"\n  {dataset}\n"))
    assert set(cd.read_mesh(path, "ring").surfaces) == {"outside"}


def test_a_file_that_breaks_off_is_refused(tmp_path):
    path = tmp_path / "ring.unv"
    quarter_ring(path, "triangle", 1, of_nodes=False)
    lines = path.read_text().splitlines()
    start = next(i for i, line in enumerate(lines) if line.strip() == "2412")
    path.write_text("\n".join([*lines[: start + 2], "    -1", ""]))
    with pytest.raises(ValueError, match="a dataset 2412 that cannot be read"):
        cd.read_mesh(path)
    bad = lines[: start + 1] + ["  1  93  1  0  7  9", "  1 2 3 4 5 6 7 8", "  9", "    -1", ""]
    path.write_text("\n".join(bad))
    with pytest.raises(ValueError, match="elements of type 93 with 9 nodes are not known here"):
        cd.read_mesh(path)
    path.write_text("    -1\n  2411\n    -1\n")
    with pytest.raises(ValueError, match="no cells of dimension 2"):
        cd.read_mesh(path)
