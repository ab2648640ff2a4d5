"""Decks of Abaqus and CalculiX: elements, orders of nodes, sets, surfaces by element faces."""

from __future__ import annotations

import doctest
import itertools
from pathlib import Path

import numpy as np
import pytest
from dolfinx import fem

import contactdd as cd
from contactdd.base.facets import facet_nodes
from contactdd.files import read

STEEL = cd.Isotropic(2.1e5, 0.3)


def volume(mesh: cd.Mesh) -> float:
    """∫ 1 dx."""
    body = cd.Body("body", mesh, STEEL)
    return fem.assemble_scalar(fem.form(body.elements.over_volume(fem.Constant(mesh.domain, 1.0))))


def written(folder: Path, text: str) -> Path:
    path = folder / "deck.inp"
    path.write_text(text)
    return path


def table(rows) -> str:
    return "\n".join(", ".join(map(str, row)) for row in rows)


#: The corners of one cell of each shape, of volume 1/2, 1, 1/6 and 1.
CORNERS = {
    "triangle": [(0, 0), (1, 0), (0, 1)],
    "quadrilateral": [(0, 0), (1, 0), (1, 1), (0, 1)],
    "tetrahedron": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
    "hexahedron": [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))],
}
VOLUMES = {"triangle": 1 / 2, "quadrilateral": 1.0, "tetrahedron": 1 / 6, "hexahedron": 1.0}

#: Which corners, counted from 1, each node in the middle of an edge lies between, by the manuals of both programs.
EDGES = {
    "triangle": [(1, 2), (2, 3), (3, 1)],
    "quadrilateral": [(1, 2), (2, 3), (3, 4), (4, 1)],
    "tetrahedron": [(1, 2), (2, 3), (3, 1), (1, 4), (2, 4), (3, 4)],
    "hexahedron": [
        *[(1, 2), (2, 3), (3, 4), (4, 1), (5, 6), (6, 7)],
        *[(7, 8), (8, 5), (1, 5), (2, 6), (3, 7), (4, 8)],
    ],
}
#: Where the nodes 21 to 27 of a C3D27 lie: in the middle of the cell, then of the sides S1 to S6.
MIDDLES = [(0.5, 0.5, 0.5), (0.5, 0.5, 0), (0.5, 0.5, 1), (0.5, 0, 0.5), (1, 0.5, 0.5), (0.5, 1, 0.5), (0, 0.5, 0.5)]

#: The sides of one cell as the manuals of both programs number them, by the plane (normal, offset) that each lies in.
PLANES = {
    "triangle": {"S1": (1, 0.0), "S3": (0, 0.0)},
    "quadrilateral": {"S1": (1, 0.0), "S2": (0, 1.0), "S3": (1, 1.0), "S4": (0, 0.0)},
    "tetrahedron": {"S1": (2, 0.0), "S2": (1, 0.0), "S4": (0, 0.0)},
    "hexahedron": {"S1": (2, 0.0), "S2": (2, 1.0), "S3": (1, 0.0), "S4": (0, 1.0), "S5": (1, 1.0), "S6": (0, 0.0)},
}


def bent(x: np.ndarray) -> np.ndarray:
    """A map of degree two that keeps volumes: shears by squares of y."""
    shear = [0.2, 0.0, 0.1][: x.shape[1]]
    return x + np.outer(x[:, 1] ** 2, shear)


def one_cell(shape: str, count: int) -> np.ndarray:
    """The nodes of a cell in the order of a deck."""
    corners = np.array(CORNERS[shape], dtype=float)
    edges = np.array([(corners[a - 1] + corners[b - 1]) / 2 for a, b in EDGES[shape]])
    if count == len(corners):
        return corners
    nodes = np.vstack([corners, edges])
    return bent(np.vstack([nodes, MIDDLES]) if count == 27 else nodes)


def full_cell(shape: str, count: int) -> np.ndarray:
    """The nodes of a cell with those in the middle of faces and of itself."""
    if count in (8, 9, 20, 27) and (shape, count) != ("hexahedron", 8):
        dim = len(CORNERS[shape][0])
        return bent(np.array(list(itertools.product((0, 0.5, 1), repeat=dim))))
    return one_cell(shape, count)


def as_set(x: np.ndarray) -> list:
    """Points in an order of their own."""
    return sorted(map(tuple, (np.round(x, 12) + 0.0).tolist()))


TYPES = [
    *itertools.product(("CPE3", "CPS3", "CAX3"), ["triangle"], [3]),
    *itertools.product(("CPE6", "CPS6", "CAX6M"), ["triangle"], [6]),
    *itertools.product(("CPE4", "CPS4R", "CAX4"), ["quadrilateral"], [4]),
    *itertools.product(("CPE8", "CPS8", "CAX8R"), ["quadrilateral"], [8]),
    ("C3D4", "tetrahedron", 4),
    ("C3D10", "tetrahedron", 10),
    ("C3D10M", "tetrahedron", 10),
    ("C3D8", "hexahedron", 8),
    ("C3D8R", "hexahedron", 8),
    ("C3D20", "hexahedron", 20),
    ("C3D20R", "hexahedron", 20),
    ("C3D27", "hexahedron", 27),
]


@pytest.mark.parametrize(("name", "shape", "count"), TYPES)
def test_node_orders_by_volume_and_sides_by_where_they_lie(tmp_path, name, shape, count):
    """A cell that a map of determinant one has bent keeps its volume; with nodes in another order it does not."""
    x = one_cell(shape, count)
    sides = "\n".join(f"*SURFACE, NAME={side}\n1, {side}" for side in PLANES[shape])
    deck = f"*NODE\n{table((i, *node) for i, node in enumerate(x, 1))}\n*ELEMENT, TYPE={name}\n"
    mesh = cd.read_mesh(written(tmp_path, deck + table([(1, *range(1, count + 1))]) + f"\n{sides}\n"))
    assert volume(mesh) == pytest.approx(VOLUMES[shape], rel=1e-12)
    assert as_set(mesh.domain.geometry.x[:, : mesh.dim]) == as_set(full_cell(shape, count))
    assert set(mesh.surfaces) == set(PLANES[shape])
    straight = np.array(CORNERS[shape], dtype=float)
    corners = bent(straight) if count > len(straight) else straight
    for side, (axis, at) in PLANES[shape].items():
        nodes = facet_nodes(mesh.domain, mesh.entities(side)).ravel()
        there = corners[np.isclose(straight[:, axis], at)]
        assert as_set(mesh.domain.geometry.x[nodes, : mesh.dim]) == as_set(there)


def grid(first: int, x0: float, x1: float, y0: float, y1: float, cells: int) -> tuple[list, list]:
    """Nodes and elements of a square of bilinear cells, numbered from `first`."""
    side = cells + 1
    nodes = [
        (first + i * side + j, x0 + (x1 - x0) * i / cells, y0 + (y1 - y0) * j / cells)
        for i, j in itertools.product(range(side), repeat=2)
    ]
    place = lambda i, j: first + i * side + j  # noqa: E731
    elements = [
        (first + i * cells + j, place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1))
        for i, j in itertools.product(range(cells), repeat=2)
    ]
    return nodes, elements


def two_blocks() -> str:
    """Two blocks of a column, written in the ways that decks have: sets by name, ranges, faces of sets."""
    lower, upper = grid(1, 0, 1, 0, 1, 2), grid(101, 0, 1, 1, 2, 3)
    return f"""** two blocks
*Heading
 a column
*Node, nset=All nodes
{table(lower[0])}
*node
{table((a, f"{x:.12E}".replace("E", "D"), y) for a, x, y in upper[0])}
*Element, type=CPE4,
 elset=Lower
{table(lower[1])}
*ELEMENT, TYPE = CPE4 , ELSET = "Upper"
{table(upper[1])}
*ELSET, ELSET=top row
{upper[1][2][0]}, {upper[1][5][0]},
 {upper[1][8][0]}
*ELSET, ELSET=bottom row, GENERATE
{upper[1][0][0]}, {upper[1][6][0]}, 3
*NSET, NSET=foot, GENERATE
1, 7, 3
*NSET, NSET=feet
foot
*NSET, NSET=corner
1
*SURFACE, NAME=lid
top row, S3
*SURFACE, NAME=interface, TYPE=ELEMENT
bottom row, S1
*SURFACE, NAME=interface
{lower[1][1][0]}, S3
{lower[1][3][0]}, S3
*MATERIAL, NAME=steel
*ELASTIC
210000., .3
*STEP
*STATIC
*END STEP
"""


def test_sets_and_surfaces_by_name(tmp_path):
    path = written(tmp_path, two_blocks())
    lower, upper = cd.read_mesh(path, "LOWER"), cd.read_mesh(path, "UPPER")
    a, b = (cd.Body(name, mesh, STEEL) for name, mesh in (("a", lower), ("b", upper)))
    assert set(lower.surfaces) == {"INTERFACE", "FOOT", "FEET", "ALL NODES"}
    assert [a.area(name) for name in ("INTERFACE", "FOOT", "FEET", "ALL NODES")] == pytest.approx([1, 1, 1, 4])
    assert set(upper.surfaces) == {"INTERFACE", "LID"}
    assert [b.area(name) for name in upper.surfaces] == pytest.approx([1, 1])
    with pytest.raises(ValueError, match=r"surface = 'CORNER': no outer facet of this body has all its corners"):
        lower.facets("CORNER")
    with pytest.raises(ValueError, match=r"body = 'steel'.*'BOTTOM ROW', 'LOWER', 'TOP ROW', 'UPPER'"):
        cd.read_mesh(path, "steel")
    assert set(cd.read_bodies(path)) == {"LOWER", "UPPER", "TOP ROW", "BOTTOM ROW"}


def test_a_column_from_a_deck_in_equilibrium(tmp_path):
    """The pressure that lies on the lid goes through the layer and to the foot; the layer gives way by p / k."""
    path, p, k = written(tmp_path, two_blocks()), 5.0, 1e4
    left = {"left": lambda x: np.isclose(x[0], 0)}
    lower, upper = (cd.read_mesh(path, name).with_surfaces(**left) for name in ("LOWER", "UPPER"))
    a = cd.Body("lower", lower, STEEL, supports=[cd.Symmetry("FOOT", "left")])
    b = cd.Body("upper", upper, STEEL, supports=[cd.Symmetry("left")], loads=[cd.Pressure("LID", p)])
    contact = cd.solve(cd.Scene([a, b], [cd.Contact((a, "INTERFACE"), (b, "INTERFACE"), cd.LinearLayer(k))])).contact()
    assert contact.pressure == pytest.approx(p, rel=1e-9)
    assert contact.force == pytest.approx(p, rel=1e-9)


def rings(*spans: tuple[float, float], cells: int, height: float) -> str:
    """Rings r0 < r < r1 of CAX8: element sets RING1, ... with surfaces I1 (inside), O1 (outside) and FOOT1, ..."""
    nodes, elements, faces = [], [], []
    for number, (r0, r1) in enumerate(spans, 1):
        first, side = 1000 * number, 2 * cells + 1
        at = lambda i, j, first=first: first + 3 * i + j  # noqa: E731
        nodes += [
            (at(i, j), r0 + (r1 - r0) * i / (side - 1), height * j / 2)
            for i in range(side)
            for j in range(3)
            if not i * j % 2
        ]
        places = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
        elements.append(
            f"*ELEMENT, TYPE=CAX8, ELSET=RING{number}\n"
            + table((first + i, *(at(2 * i + a, b) for a, b in places)) for i in range(cells))
        )
        faces.append(f"*SURFACE, NAME=I{number}\n{first}, S4\n*SURFACE, NAME=O{number}\n{first + cells - 1}, S2")
        faces.append(f"*SURFACE, NAME=FOOT{number}\nRING{number}, S1")
    return "\n".join([f"*NODE\n{table(nodes)}", *elements, *faces, ""])


def test_press_fit_of_rings_from_a_deck(tmp_path):
    """Two rings that overlap by δ on a layer of stiffness k, free axially: Lamé's p = δ / (c_i + c_o + 1/k), where
    c = R/E ((a² + b²)/|b² − a²| ± ν); and CalculiX' displacements of the same rings (its test ring2)."""
    E, nu, k = 2.1e5, 0.3, 1e7
    path = written(tmp_path, rings((0.9501, 1.0501), (1.05, 1.15), cells=10, height=0.1))
    bodies = [
        cd.Body(
            name,
            cd.read_mesh(path, name.upper()),
            cd.Isotropic(E, nu),
            degree=2,
            kinematics="axisymmetric",
            supports=[cd.Symmetry(f"FOOT{name[-1]}")],
        )
        for name in ("ring1", "ring2")
    ]
    inner, outer = bodies
    solution = cd.solve(cd.Scene(bodies, [cd.Contact((inner, "O1"), (outer, "I2"), cd.LinearLayer(k))]))

    def compliance(radius: float, other: float, sign: float) -> float:
        squares = radius**2, other**2
        return radius / E * (sum(squares) / abs(squares[1] - squares[0]) + sign * nu)

    p = 1e-4 / (compliance(1.0501, 0.9501, -1.0) + compliance(1.05, 1.15, 1.0) + 1 / k)
    # The pressure acts at 1.0501 on one ring and at 1.05 on the other, which the formula does not tell apart.
    assert solution.contact().pressure == pytest.approx(p, rel=2e-4)
    places = {"ring1": [1.0501, 0.9501], "ring2": [1.05, 1.15]}
    calculix = {"ring1": [-4.615912e-5, -4.734676e-5], "ring2": [5.373072e-5, 5.209029e-5]}
    for name, radii in places.items():
        u = solution.displacement_at(name, [(r, 0.05) for r in radii])[:, 0]
        # Its contact is between nodes and faces, of large displacements: the strains of 5e-5 are that order off.
        assert u == pytest.approx(calculix[name], rel=1e-3)


def test_two_pieces_in_one_set_are_taken_apart(tmp_path):
    path = written(tmp_path, two_blocks())
    whole = cd.read_mesh(path)
    pieces = whole.pieces()
    assert [volume(piece) for piece in pieces] == pytest.approx([1, 1])
    assert {name for piece in pieces for name in piece.surfaces} == set(whole.surfaces)
    with pytest.raises(ValueError, match=r"mesh of body 'column': 2 pieces that share no node .*4 cells around"):
        cd.Body("column", whole, STEEL, supports=[cd.Fixed("FOOT")])
    # Each held by itself they are a body: nothing has to be found by contact.
    cd.Body("column", whole, STEEL, supports=[cd.Fixed("FOOT", "LID")])


def test_included_files(tmp_path):
    text = two_blocks()
    nodes = text[text.index("*Node") : text.index("*Element")]
    (tmp_path / "nodes.txt").write_text(nodes)
    path = written(tmp_path, text.replace(nodes, "*INCLUDE, INPUT=nodes.txt\n"))
    assert [volume(piece) for piece in cd.read_mesh(path).pieces()] == pytest.approx([1, 1])
    (tmp_path / "nodes.txt").write_text("*INCLUDE, INPUT=deck.inp\n")
    with pytest.raises(ValueError, match="includes itself"):
        cd.read_mesh(path)
    (tmp_path / "nodes.txt").unlink()
    with pytest.raises(ValueError, match=r"includes 'nodes\.txt', which is not there"):
        cd.read_mesh(path)


SQUARE = "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n5, 2, 0\n*ELEMENT, TYPE=CPE4, ELSET=E\n1, 1, 2, 3, 4\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("*HEADING\nnothing\n", "no elements of the plane, of revolution or of space"),
        ("*NODE\n1, 0, 0\n*ELEMENT, TYPE=B31\n1, 1, 2\n", r"no elements of the plane.*it has B31"),
        (
            SQUARE + "*ELEMENT, TYPE=CPE6\n2, 2, 5, 3, 6, 7, 8\n",
            "several kinds: 4-node quadrilaterals and 6-node triangles",
        ),
        (
            "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D15\n" + ", ".join(map(str, range(1, 17))) + "\n",
            "15-node prisms, which cannot be computed with",
        ),
        (SQUARE + "*SURFACE, NAME=LID\n1, S5\n", "the face 'S5' of 4-node quadrilaterals; expected S1 to S4"),
        (SQUARE + "*SURFACE, NAME=LID\n1, SPOS\n", "the face 'SPOS'"),
        (SQUARE + "*SURFACE, NAME=LID\nNOBODY, S1\n", "no ELSET 'NOBODY'"),
        (SQUARE + "*NSET, NSET=A\nB\n*NSET, NSET=B\nA\n", "no NSET 'A' that does not contain itself"),
        (SQUARE + "*NSET\n1\n", r"a \*NSET that cannot be read .*expected a name"),
        (SQUARE.replace("1, 1, 2, 3, 4", "1, 1, 2, 3"), r"a \*ELEMENT that cannot be read .*expected 5 numbers"),
        (SQUARE.replace("1, 1, 2, 3, 4", "1, 1, 2, 3, 9"), "a cell has the node 9, which is not there"),
        (SQUARE.replace("1, 1, 2, 3, 4", "1, 1, 2, 3, 3"), "have a node twice"),
        (SQUARE.replace("3, 1, 1", "3, one, 1"), r"a \*NODE that cannot be read .*'ONE'"),
        (SQUARE.replace("CPE4", "CPE5"), "elements of type CPE5 are not known here"),
        (SQUARE.replace("*NODE", "*NODE, SYSTEM=C"), "nodes in cylindrical coordinates"),
        (
            "*PART, NAME=A\n" + SQUARE + "*END PART\n*PART, NAME=B\n" + SQUARE,
            "several parts, or moves one; write it flat",
        ),
        ("*PART, NAME=A\n" + SQUARE + "*INSTANCE, NAME=A1, PART=A\n1., 0., 0.\n", "several parts, or moves one"),
    ],
)
def test_decks_that_cannot_be_used_are_refused(tmp_path, text, message):
    with pytest.raises(ValueError, match=message):
        cd.read_mesh(written(tmp_path, text))


def test_elements_over_several_lines_and_with_more_nodes_than_needed(tmp_path):
    """As CalculiX has it: an element begins a line, goes on while it lacks nodes, and what is over is left."""
    x = one_cell("hexahedron", 20)
    nodes = f"*NODE\n{table((i, *node) for i, node in enumerate(x, 1))}\n"
    whole = "1, 1, 2, 3, 4, 5, 6, 7,\n8, 9, 10, 11, 12, 13, 14,\n15, 16, 17, 18, 19, 20\n"
    curved = cd.read_mesh(written(tmp_path, f"{nodes}*ELEMENT, TYPE=C3D20\n{whole}"))
    straight = cd.read_mesh(written(tmp_path, f"{nodes}*ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10,\n"))
    assert len(curved.domain.geometry.x) == 27
    assert len(straight.domain.geometry.x) == 8
    assert [volume(curved), volume(straight)] == pytest.approx([1, 1])


def test_the_example():
    assert doctest.testmod(read).failed == 0


def test_parameters_are_for_scripts(tmp_path):
    with pytest.raises(ValueError, match=r"parameters and order are for \.geo scripts"):
        cd.read_mesh(written(tmp_path, SQUARE), size=0.1)
