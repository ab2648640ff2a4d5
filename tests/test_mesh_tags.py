"""Meshes of dolfinx with tags, meshes in pieces, hanging nodes, facet indices."""

from __future__ import annotations

import itertools

import basix.ufl
import numpy as np
import pytest
from dolfinx import mesh as dmesh
from mpi4py import MPI

import contactdd as cd
from contactdd.base import compat

STEEL = cd.Isotropic(2.1e5, 0.3)


def made(shape: str, cells, x) -> dmesh.Mesh:
    """A mesh from arrays; the nodes of quadrilaterals and hexahedra row by row."""
    x = np.array(x, dtype=float)
    element = basix.ufl.element("Lagrange", shape, 1, shape=(x.shape[1],))
    return dmesh.create_mesh(MPI.COMM_SELF, cells=np.array(cells, dtype=np.int64), x=x, e=element)


def tagged(domain: dmesh.Mesh, groups) -> dmesh.MeshTags:
    """Tags of facets by where they lie."""
    dim = domain.topology.dim - 1
    found = {tag: dmesh.locate_entities(domain, dim, where) for tag, where in groups.items()}
    facets = np.concatenate(list(found.values()))
    order = np.argsort(facets)
    values = np.concatenate([np.full(len(each), tag, dtype=np.int32) for tag, each in found.items()])
    return dmesh.meshtags(domain, dim, facets[order], values[order])


# --------------------------------------------------------------------------------------------------------- tags


@pytest.fixture
def square() -> tuple[dmesh.Mesh, dmesh.MeshTags]:
    domain = dmesh.create_unit_square(MPI.COMM_SELF, 4, 4)
    near = lambda axis, at: lambda x: np.isclose(x[axis], at)  # noqa: E731
    return domain, tagged(domain, {1: near(1, 0), 2: near(1, 1), 3: near(0, 0), 7: near(0, 0.5)})


def areas(mesh: cd.Mesh) -> dict[str, float]:
    body = cd.Body("body", mesh, STEEL)
    return {name: body.area(name) for name in mesh.surfaces}


def test_surfaces_from_tags(square):
    domain, tags = square
    assert areas(cd.from_dolfinx(domain, tags)) == pytest.approx({"1": 1, "2": 1, "3": 1})
    mesh = cd.from_dolfinx(domain, tags, names={"top": 2, "outside": [1, 2, 3]}, right=lambda x: np.isclose(x[0], 1))
    assert areas(mesh) == pytest.approx({"top": 1, "outside": 3, "right": 1})


def test_tags_inside_are_kept_out_of_the_way(square):
    domain, tags = square
    mesh = cd.from_dolfinx(domain, facet_tags=tags)
    with pytest.raises(ValueError, match=r"surface = '7': 4 facets of that group are inside the body"):
        mesh.facets("7")
    with pytest.raises(ValueError, match="'crack': 4 facets"):
        cd.from_dolfinx(domain, tags, names={"crack": 7}).facets("crack")


def test_a_solution_with_tags_is_that_with_functions(square):
    domain, tags = square
    base = cd.rectangle((0, -1), (1, 0), (3, 3))

    def force(mesh: cd.Mesh) -> np.ndarray:
        upper = cd.Body("upper", mesh, STEEL, loads=[cd.Pressure("top", 2.0)], supports=[cd.Symmetry("left")])
        lower = cd.Body("lower", base, STEEL, supports=[cd.Fixed("bottom")])
        contact = cd.Contact((upper, "foot"), (lower, "top"), cd.LinearLayer(1e5))
        return cd.solve(cd.Scene([upper, lower], [contact])).contact().pressure

    by_tags = cd.from_dolfinx(domain, tags, names={"foot": 1, "top": 2, "left": 3})
    by_place = cd.from_dolfinx(
        domain,
        foot=lambda x: np.isclose(x[1], 0),
        top=lambda x: np.isclose(x[1], 1),
        left=lambda x: np.isclose(x[0], 0),
    )
    assert np.array_equal(force(by_tags), force(by_place))


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"names": {"top": 5}}, ValueError, r"'top' is the tag 5, which no facet has \(there are \[1, 2, 3, 7\]\)"),
        ({"names": {"top": 2.0}}, TypeError, "'top' is 2.0; expected a name and its whole number"),
        ({"names": {"top": True}}, TypeError, "'top' is True; expected a name and its whole number"),
        ({"facet_tags": 5}, TypeError, "facet_tags = 5: expected MeshTags of dolfinx"),
        ({"facet_tags": None, "names": {"top": 2}}, ValueError, "expected facet_tags beside them"),
    ],
)
def test_tags_that_say_nothing_are_refused(square, options, error, message):
    domain, tags = square
    with pytest.raises(error, match=message):
        cd.from_dolfinx(domain, **{"facet_tags": tags, **options})


def test_tags_of_cells_are_refused(square):
    cells = np.arange(4, dtype=np.int32)
    tags = dmesh.meshtags(square[0], 2, cells, cells)
    with pytest.raises(ValueError, match="tags of entities of dimension 2; expected 1, the facets'"):
        cd.from_dolfinx(square[0], tags)


@pytest.mark.parametrize(
    ("facets", "error", "message"),
    [
        ([-1], ValueError, "surface 'a': the facet -1 is not there; expected indices from 0 to 15"),
        ([3, 10**6], ValueError, "the facet 1000000 is not there"),
        ([0.5], TypeError, "expected the indices of its facets"),
        ([[0, 1]], TypeError, "expected the indices of its facets"),
    ],
)
def test_facet_indices_that_are_none_are_refused(facets, error, message):
    domain = cd.rectangle((0, 0), (1, 1), (2, 2)).domain
    with pytest.raises(error, match=message):
        cd.Mesh(domain, {"a": np.array(facets)})


def test_a_mesh_of_nothing_is_refused():
    with pytest.raises(TypeError, match="domain = None: expected a dolfinx mesh"):
        cd.Mesh(None, {})


# ------------------------------------------------------------------------------------------------ hanging nodes


def quads(*corners) -> tuple[list, list]:
    """Rectangles (x0, x1, y0, y1) whose nodes at one place are one, as cells and nodes."""
    nodes: dict[tuple, int] = {}
    cells = []
    for x0, x1, y0, y1 in corners:
        cells.append([nodes.setdefault(p, len(nodes)) for p in ((x0, y0), (x1, y0), (x0, y1), (x1, y1))])
    return cells, list(nodes)


@pytest.mark.parametrize("parts", [2, 3, 5])
def test_hanging_nodes_of_the_plane_are_refused(parts):
    """One large cell beside a column of small ones."""
    ends = np.linspace(0, 1, parts + 1).tolist()
    cells, nodes = quads((0.0, 1.0, 0.0, 1.0), *((1.0, 1.5, a, b) for a, b in itertools.pairwise(ends)))
    with pytest.raises(ValueError, match=rf"mesh: {parts - 1} hanging nodes, one of them at \[1\."):
        cd.from_dolfinx(made("quadrilateral", cells, nodes))


def test_hanging_nodes_of_space_are_refused():
    """A cube on top of four: the middle of its face and of the face's edges hang; the middle joins no two ends."""
    nodes: dict[tuple, int] = {}

    def cube(low, size):
        corners = [
            (low[0] + i * size, low[1] + j * size, low[2] + k * size) for k in (0, 1) for j in (0, 1) for i in (0, 1)
        ]
        return [nodes.setdefault(corner, len(nodes)) for corner in corners]

    cells = [cube((0.0, 0.0, 1.0), 1.0)] + [cube((x, y, 0.5), 0.5) for x in (0.0, 0.5) for y in (0.0, 0.5)]
    with pytest.raises(ValueError, match="mesh: 4 hanging nodes"):
        cd.from_dolfinx(made("hexahedron", cells, list(nodes)))


def test_a_crack_is_no_fault():
    """Two rows of cells, joined at x = 0 only: beyond, the nodes of the one lie between those of the other."""
    lower, nodes = quads((0.0, 1.0, 0.0, 1.0), (1.0, 2.0, 0.0, 1.0))
    upper, others = quads((0.0, 1.0, 1.0, 2.0), (1.0, 1.5, 1.0, 2.0), (1.5, 2.0, 1.0, 2.0))
    tip = nodes.index((0.0, 1.0)), others.index((0.0, 1.0))
    cells = lower + [[tip[0] if n == tip[1] else n + len(nodes) for n in cell] for cell in upper]
    used, cells = np.unique(cells, return_inverse=True)
    x = np.array(nodes + others)[used]
    assert cd.from_dolfinx(made("quadrilateral", cells.reshape(-1, 4), x)).cells == 5


@pytest.mark.parametrize("degree", [1, 2])
def test_sound_meshes_have_no_hanging_nodes(degree):
    """Rings and boxes of every kind of cell, also strongly graded ones."""
    fine = np.geomspace(1, 100, 9) / 100
    for shape in ("triangle", "quadrilateral"):
        cd.Mesh(cd.rectangle((0.01, 0), (1, 1), (fine, 2), shape=shape).domain, {})
    for shape in ("tetrahedron", "hexahedron"):
        cd.Mesh(cd.box((0.01, 0, 0), (1, 1, 1), (fine, 2, degree), shape=shape).domain, {})


# ------------------------------------------------------------------------------------------------------- pieces


def pair(shape: str = "quadrilateral") -> cd.Mesh:
    """Two unit squares apart from each other in one mesh."""
    cells, nodes = quads(*((a, a + 0.5, b, b + 0.5) for a in (0.0, 0.5, 2.0, 2.5) for b in (0.0, 0.5)))
    return cd.from_dolfinx(
        made(shape, cells, nodes),
        bottom=lambda x: np.isclose(x[1], 0),
        top=lambda x: np.isclose(x[1], 1),
        left=lambda x: np.isclose(x[0], 0),
    )


def test_pieces_are_meshes_with_their_surfaces():
    first, second = pair().pieces()
    assert areas(first) == pytest.approx({"bottom": 1, "top": 1, "left": 1})
    assert areas(second) == pytest.approx({"bottom": 1, "top": 1})
    assert second.domain.geometry.x[:, 0].min() == 2.0
    with pytest.raises(ValueError, match="surface = 'left': no facet of it belongs to this piece"):
        second.facets("left")
    assert first.pieces() == [first]
    for shape in ("triangle", "quadrilateral"):
        whole = cd.rectangle((0, 0), (1, 1), (2, 2), shape=shape)
        assert whole.pieces() == [whole]
        assert len(cd.Mesh(whole.domain, {}).pieces()) == 1


@pytest.mark.parametrize(
    ("supports", "loose"),
    [
        ([], 2),
        ([cd.Fixed("left")], 1),
        ([cd.Symmetry("bottom")], 2),
        ([cd.Symmetry("bottom", "left")], 1),
        ([cd.Spring("bottom", 1.0), cd.Symmetry("left")], 0),
        ([cd.Displacement("bottom", [0.0, None]), cd.Displacement("top", [None, 0.1])], 0),
    ],
)
def test_a_body_in_pieces_is_one_if_each_is_held(supports, loose):
    if loose:
        with pytest.raises(
            ValueError, match=rf"2 pieces that share no node .*do not hold {loose}; make a body of each"
        ):
            cd.Body("pair", pair(), STEEL, supports=supports)
    else:
        cd.Body("pair", pair(), STEEL, supports=supports)


def test_rings_in_pieces_can_only_slip_along_the_axis():
    options = {"kinematics": "axisymmetric"}
    cd.Body("rings", pair(), STEEL, supports=[cd.Symmetry("bottom")], **options)
    with pytest.raises(ValueError, match="do not hold 2"):
        cd.Body("rings", pair(), STEEL, supports=[cd.Symmetry("left")], **options)


def test_bodies_made_of_pieces_find_their_place_by_contact():
    """What one mesh cannot, two bodies can: each piece stands on a layer of its own, p / k lower."""
    p, k = 3.0, 1e3
    halves = {"piece 0": lambda x: (x[1] > -0.1) & (x[0] < 1.6), "piece 1": lambda x: (x[1] > -0.1) & (x[0] > 1.4)}
    ground = cd.rectangle((-1, -1), (4, 0), (10, 1)).with_surfaces(**halves)
    base = cd.Body("base", ground, cd.Isotropic(1e9, 0.0), supports=[cd.Fixed("bottom")])
    pieces = dict(zip(halves, pair().pieces(), strict=True))
    bodies = [cd.Body(name, piece, STEEL, loads=[cd.Pressure("top", p)]) for name, piece in pieces.items()]
    contacts = [cd.Contact((body, "bottom"), (base, body.name), cd.LinearLayer(k), name=body.name) for body in bodies]
    solution = cd.solve(cd.Scene([base, *bodies], contacts))
    for body in bodies:
        assert solution.contact(body.name).force == pytest.approx(p, rel=1e-9)


def test_copies_know_the_pieces():
    mesh = pair()
    count = mesh.piece_of_cell.max() + 1
    for copy in (mesh.moved((0, 1)), mesh.mirrored("x", 0.0), mesh.with_surfaces(all=lambda x: x[0] > -1)):
        assert copy.piece_of_cell.max() + 1 == count == len(copy.pieces())


def test_what_dolfinx_gets_is_what_it_gives():
    """The cells of a mesh from arrays are those of the mesh from which the arrays were taken."""
    whole = cd.box((0, 0, 0), (1, 2, 3), (2, 2, 2)).domain
    cells = compat.geometry_dofmap(whole).astype(np.int64)
    again = compat.from_arrays(cells, whole.geometry.x.copy(), compat.coordinate_element("tetrahedron", 1))
    assert np.allclose(np.sort(again.geometry.x, axis=0), np.sort(whole.geometry.x, axis=0))
