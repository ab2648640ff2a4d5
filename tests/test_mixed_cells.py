"""Bodies of triangles and quadrilaterals are read as triangles; what cannot be read leaves the other bodies there."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from test_universal import gmsh, sizes

import contactdd as cd
from contactdd.files.kinds import halves

HEAD = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"


def half_ring(path: Path, degree: int, **options: float) -> Path:
    """Half a ring 1 < r < 2 in one group, of quadrilaterals where x < 0 and of triangles elsewhere."""
    gmsh.initialize(["tests", "-v", "1"], interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        for name, value in options.items():
            gmsh.option.setNumber(f"Mesh.{name}", value)
        geo = gmsh.model.geo
        centre = geo.addPoint(0, 0, 0)
        inner, outer = ([geo.addPoint(r * x, r * y, 0) for x, y in ((1, 0), (0, 1), (-1, 0))] for r in (1, 2))
        across = [geo.addLine(a, b) for a, b in zip(inner, outer, strict=True)]
        arcs = [[geo.addCircleArc(a, centre, b) for a, b in itertools.pairwise(ends)] for ends in (inner, outer)]
        parts = [
            geo.addPlaneSurface([geo.addCurveLoop([across[i], arcs[1][i], -across[i + 1], -arcs[0][i]])])
            for i in (0, 1)
        ]
        for curve, count in [*((each, 4) for each in across), *((each, 7) for ends in arcs for each in ends)]:
            geo.mesh.setTransfiniteCurve(curve, count)
        for part in parts:
            geo.mesh.setTransfiniteSurface(part)
        geo.mesh.setRecombine(2, parts[1])
        geo.synchronize()
        gmsh.model.addPhysicalGroup(2, parts, name="ring")
        gmsh.model.addPhysicalGroup(1, arcs[1], name="outside")
        gmsh.model.addPhysicalGroup(1, [across[0]], name="right")
        gmsh.model.addPhysicalGroup(1, [across[2]], name="left")
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(degree)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()
    return path


@pytest.mark.parametrize(("degree", "serendipity"), [(1, 0), (2, 0), (2, 1)])
@pytest.mark.parametrize("ending", [".msh", ".unv"])
def test_triangles_and_quadrilaterals_are_one_body(tmp_path, degree, serendipity, ending):
    """The area and the surfaces are those of the ring to the error of its arcs: all nodes are in the right places."""
    options = {"SecondOrderIncomplete": serendipity}
    if ending == ".unv":
        options |= {"SaveGroupsOfElements": 1, "SecondOrderIncomplete": 1}
    path = half_ring(tmp_path / f"ring{ending}", degree, **options)
    with pytest.warns(cd.ContactWarning, match="triangles and quadrilaterals in the group 'ring'.*cut in two"):
        mesh = cd.read_bodies(path)["ring"]
    assert mesh.domain.topology.cell_name() == "triangle"
    assert mesh.cells == 4 * 3 * 6  # two squares of 3 × 6 cells, each cell two triangles
    volume, surfaces = sizes(mesh)
    # Of arcs of 15° a chord misses θ²/6 of the area, a parabola the order of θ⁴.
    error = (np.pi / 12) ** 2 if degree == 1 else (np.pi / 12) ** 4 / 20
    assert volume == pytest.approx(3 * np.pi / 2, rel=error)
    assert surfaces == {
        "outside": pytest.approx(2 * np.pi, rel=error),
        "right": pytest.approx(1),
        "left": pytest.approx(1),
    }


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("first", range(4))
@pytest.mark.parametrize("tip", [(0.3, 0.4), (1.0, 1.0), (2.0, 2.0)])
def test_halves_lie_inside(tip, first, turned):
    """Also of an arrowhead, which one of both diagonals would leave; a square's cut is that of its smallest number."""
    x = np.array([(0, 0, 0), (1, 0, 0), (*tip, 0), (0, 1, 0)], dtype=float)
    cell = np.roll([0, 1, 2, 3], first)[:: -1 if turned else 1]
    made = halves(cell[None, :], x)
    sides = x[made[:, 1:]] - x[made[:, :1]]
    areas = np.cross(sides[:, 0], sides[:, 1])[:, 2] / 2 * (-1 if turned else 1)
    assert min(areas) > 0
    assert sum(areas) == pytest.approx(sum(tip) / 2)
    assert all(0 in half and 2 in half for half in made.tolist())


def test_other_mixtures_leave_the_other_bodies(tmp_path):
    """A group of tetrahedra and a pyramid is left out with a warning, the tetrahedron beside it is read."""
    points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1)]
    points += [(5, 0, 0), (6, 0, 0), (5, 1, 0), (5, 0, 1)]
    lines = "".join(f"{i} {x} {y} {z}\n" for i, (x, y, z) in enumerate(points, 1))
    elements = ["7 2 1 1 1 2 3 4 5", "4 2 1 1 2 3 5 6", "4 2 2 2 7 8 9 10"]
    names = '$PhysicalNames\n2\n3 1 "mixed"\n3 2 "sound"\n$EndPhysicalNames\n'
    text = "".join(f"{i} {each}\n" for i, each in enumerate(elements, 1))
    path = tmp_path / "three.msh"
    path.write_text(f"{HEAD}{names}$Nodes\n10\n{lines}$EndNodes\n$Elements\n3\n{text}$EndElements\n")
    with pytest.warns(cd.ContactWarning, match="left out: .*several kinds in the group 'mixed': 4-node tet"):
        bodies = cd.read_bodies(path)
    assert list(bodies) == ["sound"]
    assert sizes(bodies["sound"])[0] == pytest.approx(1 / 6)
    with pytest.raises(ValueError, match="several kinds in the group 'mixed'"):
        cd.read_mesh(path, "mixed")
    path.write_text(path.read_text().replace('3 2 "sound"', '3 2 "mixed"').replace("4 2 2 2", "4 2 1 2"))
    with pytest.raises(ValueError, match="several kinds in the group 'mixed'"):  # nothing is left to be read
        cd.read_bodies(path)


DECK = """*NODE
1, 0, 0\n2, 1, 0\n3, 3, 0\n4, 3, 1\n5, 1.4, 1\n6, 0, 1
11, 0, 1\n12, 3, 1\n13, 3, 2\n14, 0, 2
*ELEMENT, TYPE=CPS3, ELSET=STRIP
1, 1, 2, 5\n2, 1, 5, 6
*ELEMENT, TYPE=CPS4, ELSET=STRIP
3, 2, 3, 4, 5
*ELEMENT, TYPE=CPS4, ELSET=BLOCK
4, 11, 12, 13, 14
*MATERIAL, NAME=M
*ELASTIC
1000., 0.25
*SOLID SECTION, ELSET=STRIP, MATERIAL=M
*SOLID SECTION, ELSET=BLOCK, MATERIAL=M
*SURFACE, NAME=TOP\n2, S2\n3, S3
*SURFACE, NAME=BOTTOM\n4, S1
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
1.E4,
*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE
TOP, BOTTOM
*BOUNDARY
1, 1, 2\n2, 2\n3, 2\n6, 1\n11, 1\n14, 1
*STEP\n*STATIC\n*DLOAD\n4, P3, 10.\n*END STEP
"""


def test_a_deck_of_both_is_a_scene(tmp_path):
    """A strip of two triangles and an uneven quadrilateral under a block: a linear field, which the elements have."""
    path = tmp_path / "strip.inp"
    path.write_text(DECK)
    with pytest.warns(cd.ContactWarning, match="cut in two"):
        solution = cd.solve(cd.read_scene(path))
    np.testing.assert_allclose(solution.contact().pressure, 10.0, rtol=1e-8)  # the solve's residual is 1e-10
    corner = solution.displacement_at("STRIP", [[3.0, 1.0]])[0]
    assert corner == pytest.approx([3 * 0.25 * 10 / 1000, -10 / 1000])
