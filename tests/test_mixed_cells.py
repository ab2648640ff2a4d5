"""Bodies of triangles and quadrilaterals are read as triangles; what cannot be read leaves the other bodies there."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from test_universal import gmsh, sizes

import contactdd as cd
from contactdd.files.simplices import halves

HEAD = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"


def half_ring(path: Path, degree: int, high: float = 0.0, **options: float) -> Path:
    """Half a ring 1 < r < 2 in one group, of quadrilaterals where x < 0 and of triangles elsewhere.

    high: if it is not 0, that of the solid of hexahedra and prisms over it.
    """
    gmsh.initialize(["tests", "-v", "1"], interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        for name, value in options.items():
            gmsh.option.setNumber(f"Mesh.{name}", value)
        geo, dim = gmsh.model.geo, 3 if high else 2
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
        cells, outside, right, left = parts, arcs[1], across[:1], across[2:]
        if high:
            made = [geo.extrude([(2, part)], 0, 0, high, numElements=[2], recombine=True) for part in parts]
            cells, outside = [each[1][1] for each in made], [each[3][1] for each in made]
            right, left = [made[0][2][1]], [made[1][4][1]]
        geo.synchronize()
        for which, members, name in ((dim, cells, "ring"), (dim - 1, outside, "outside")):
            gmsh.model.addPhysicalGroup(which, members, name=name)
        for members, name in ((right, "right"), (left, "left")):
            gmsh.model.addPhysicalGroup(dim - 1, members, name=name)
        gmsh.model.mesh.generate(dim)
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
    with pytest.warns(cd.ContactWarning, match="in the group 'ring', which are cut into"):
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


@pytest.mark.parametrize("ending", [".msh", ".inp", ".unv"])
def test_prisms_and_hexahedra_are_tetrahedra(tmp_path, ending):
    """No side inside is left open: the whole boundary is that of the solid, whose top and bottom are half rings."""
    path = half_ring(tmp_path / f"ring{ending}", 1, 0.5)
    if ending == ".inp":
        path.write_text(path.read_text().replace("outside", "OUTSIDE"))
    with pytest.warns(cd.ContactWarning, match="6-node prisms and 8-node hexahedra.* which are cut into 4-node tetra"):
        mesh = cd.read_mesh(path).with_surfaces(whole=lambda x: np.full(x.shape[1], True))
    assert mesh.domain.topology.cell_name() == "tetrahedron"
    assert mesh.cells == 3 * 6 * 2 * (2 * 3 + 6)  # of a square's two prisms three each, of its hexahedron six
    volume, surfaces = sizes(mesh)
    error = (np.pi / 12) ** 2  # of chords of 15°
    assert volume == pytest.approx(3 * np.pi / 4, rel=error)
    assert surfaces["whole"] == pytest.approx(2 * 3 * np.pi / 2 + 2 * 0.5 + 3 * np.pi * 0.5, rel=error)
    assert surfaces["OUTSIDE" if ending == ".inp" else "outside"] == pytest.approx(np.pi, rel=error)


def solid(path: Path, points: list, elements: list[str], groups: dict[int, str]) -> Path:
    """A .msh file; elements: gmsh's type, the number of the group, and the nodes."""
    nodes = "".join(f"{i} {x} {y} {z}\n" for i, (x, y, z) in enumerate(points, 1))
    names = "".join(f'3 {number} "{name}"\n' for number, name in groups.items())
    rows = [each.split() for each in elements]
    cells = "".join(f"{i} {row[0]} 2 {row[1]} {row[1]} {' '.join(row[2:])}\n" for i, row in enumerate(rows, 1))
    path.write_text(
        f"{HEAD}$PhysicalNames\n{len(groups)}\n{names}$EndPhysicalNames\n$Nodes\n{len(points)}\n{nodes}$EndNodes\n"
        f"$Elements\n{len(elements)}\n{cells}$EndElements\n"
    )
    return path


CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


@pytest.mark.parametrize("turn", range(8))
def test_pyramids_of_a_cube_under_pressure(tmp_path, turn):
    """Six pyramids around an uneven middle, however the nodes are numbered: a linear field, which they have exactly."""
    points = [*CUBE, (0.4, 0.55, 0.6)]
    number = {old: (old + turn) % 9 + 1 for old in range(9)}
    sides = [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]
    elements = [f"7 1 {' '.join(str(number[corner]) for corner in (*side, 8))}" for side in sides]
    places = [points[old] for old in sorted(number, key=lambda old: number[old])]
    path = solid(tmp_path / "cube.msh", places, elements, {1: "cube"})
    with pytest.warns(cd.ContactWarning, match="5-node pyramids in the group 'cube', which are cut"):
        mesh = cd.read_bodies(path)["cube"]
    assert mesh.cells == 12
    at = {name: (lambda x, i=i, v=v: np.isclose(x[i], v)) for name, i, v in
          (("left", 0, 0), ("front", 1, 0), ("bottom", 2, 0), ("top", 2, 1))}  # fmt: skip
    steel, planes = cd.Isotropic(1000.0, 0.25), [cd.Symmetry("left"), cd.Symmetry("front")]
    cube = cd.Body("cube", mesh.with_surfaces(**at), steel, supports=[*planes, cd.Symmetry("bottom")])
    lid = cd.box((0, 0, 1), (1, 1, 2), (1, 1, 1), shape="hexahedron")
    lid = cd.Body("lid", lid, steel, supports=planes, loads=[cd.Pressure("top", 10.0)])
    solution = cd.solve(cd.Scene([cube, lid], [cd.Contact((cube, "top"), (lid, "bottom"), cd.LinearLayer(1e4))]))
    assert solution.displacement_at("cube", [[1.0, 1.0, 1.0]])[0] == pytest.approx([0.0025, 0.0025, -0.01], rel=1e-8)


def test_other_mixtures_leave_the_other_bodies(tmp_path):
    """A group that cannot be cut is left out with a warning, the tetrahedron beside it is read."""
    points = [*CUBE, (0.5, 0.5, 2), (5, 0, 0), (6, 0, 0), (5, 1, 0), (5, 0, 1)]
    # Two tetrahedra on one side of a hexahedron, whose cut need not be theirs.
    elements = ["5 1 1 2 3 4 5 6 7 8", "4 1 5 6 8 9", "4 1 6 7 8 9", "4 2 10 11 12 13"]
    path = solid(tmp_path / "three.msh", points, elements, {1: "mixed", 2: "sound"})
    with pytest.warns(cd.ContactWarning, match="left out: .* 2 triangular sides of cells lie on a side"):
        bodies = cd.read_bodies(path)
    assert list(bodies) == ["sound"]
    assert sizes(bodies["sound"])[0] == pytest.approx(1 / 6)
    with pytest.raises(ValueError, match="triangular sides of cells"):
        cd.read_mesh(path, "mixed")
    solid(path, points, elements[:3], {1: "mixed"})
    with pytest.raises(ValueError, match="triangular sides"):  # nothing is left
        cd.read_bodies(path)


def test_groups_of_sides_of_other_bodies_are_left_alone(tmp_path):
    """A prism beside two hexahedra of a body of their own: each has its part of the group of sides at z = 0."""
    points = [*CUBE, (2, 0, 0), (2, 0, 1), (-1, 0, 0), (-1, 1, 0), (-1, 0, 1), (-1, 1, 1)]
    cells = ["5 1 1 2 3 4 5 6 7 8", "5 1 11 1 4 12 13 5 8 14", "6 2 2 9 3 6 10 7"]
    path = solid(tmp_path / "two.msh", points, [*cells, "3 9 1 2 3 4", "2 9 2 9 3", "3 8 2 9 10 6"], {1: "a", 2: "b"})
    with pytest.warns(cd.ContactWarning, match="6-node prisms in the group 'b'"):
        bodies = cd.read_bodies(path)
    assert bodies["a"].domain.topology.cell_name() == "hexahedron"
    assert sizes(bodies["a"]) == (pytest.approx(2.0), {"9": pytest.approx(1.0)})
    assert sizes(bodies["b"]) == (pytest.approx(0.5), {"9": pytest.approx(0.5), "8": pytest.approx(1.0)})


def test_distorted_cells_are_not_cut(tmp_path):
    """A hexahedron whose corner has gone through the opposite side."""
    points = [*CUBE[:6], (-0.5, -0.5, -0.5), CUBE[7], (2, 0, 0), (2, 0, 1)]
    path = solid(tmp_path / "bad.msh", points, ["5 1 1 2 3 4 5 6 7 8", "6 1 2 9 3 6 10 7"], {1: "bad"})
    with pytest.raises(ValueError, match="1 of the 8-node hexahedra are too distorted to be cut"):
        cd.read_mesh(path)


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
    with pytest.warns(cd.ContactWarning, match="which are cut into"):
        solution = cd.solve(cd.read_scene(path))
    np.testing.assert_allclose(solution.contact().pressure, 10.0, rtol=1e-8)  # the solve's residual is 1e-10
    corner = solution.displacement_at("STRIP", [[3.0, 1.0]])[0]
    assert corner == pytest.approx([3 * 0.25 * 10 / 1000, -10 / 1000])
