"""Cells that a file has once for each of their groups are one cell, also where they are cut."""

from __future__ import annotations

import pytest
from test_mixed_cells import HEAD
from test_universal import sizes

import contactdd as cd

POINTS = ((0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0), (1, 0.5), (0.5, 1), (0, 0.5), (2, 0), (1.5, 0), (1.5, 0.5))
QUADRILATERAL, TRIANGLE = "1 2 3 4 5 6 7 8", "2 9 3 10 11 6"


def test_a_quadrilateral_in_two_groups_beside_a_triangle(tmp_path):
    """Of second order; the whole file, its larger group and its smaller one."""
    groups = '3\n2 1 "all"\n2 2 "part"\n1 3 "below"\n'
    nodes = "".join(f"{number} {x} {y} 0\n" for number, (x, y) in enumerate(POINTS, 1))
    cells = (f"16 2 1 1 {QUADRILATERAL}", f"9 2 1 1 {TRIANGLE}", f"16 2 2 2 {QUADRILATERAL}")
    elements = (*cells, "8 2 3 3 1 2 5", "8 2 3 3 2 9 10")
    rows = "".join(f"{number} {element}\n" for number, element in enumerate(elements, 1))
    path = tmp_path / "twice.msh"
    path.write_text(
        f"{HEAD}$PhysicalNames\n{groups}$EndPhysicalNames\n$Nodes\n{len(POINTS)}\n{nodes}$EndNodes\n"
        f"$Elements\n{len(elements)}\n{rows}$EndElements\n"
    )
    for body, count, area in ((None, 3, 1.5), ("all", 3, 1.5)):
        with pytest.warns(cd.ContactWarning, match="cut into 6-node triangles"):
            mesh = cd.read_mesh(path, body)
        assert mesh.cells == count
        assert sizes(mesh) == (pytest.approx(area), {"below": pytest.approx(2)})
    assert sizes(cd.read_mesh(path, "part")) == (pytest.approx(1), {"below": pytest.approx(1)})
