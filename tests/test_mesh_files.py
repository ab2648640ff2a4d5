"""What gmsh's models and files hold: groups, kinds of cells, several bodies, and what is refused before dolfinx."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import contactdd as cd
from contactdd.files import mesh_cache
from contactdd.files.contents import Block, Contents
from contactdd.files.kinds import Kind

gmsh = pytest.importorskip("gmsh")

STEEL = cd.Isotropic(2.1e5, 0.3)


@pytest.fixture
def model() -> Iterator[object]:
    """An open gmsh model."""
    gmsh.initialize(["tests", "-v", "1"], interruptible=False)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.25)
    yield gmsh.model
    gmsh.finalize()


def areas(mesh: cd.Mesh) -> dict[str, float]:
    """The size of each surface."""
    body = cd.Body("body", mesh, STEEL)
    return {name: body.area(name) for name in mesh.surfaces}


def volume(mesh: cd.Mesh) -> float:
    """∫ 1 dx."""
    from dolfinx import fem

    body = cd.Body("body", mesh, STEEL)
    return fem.assemble_scalar(fem.form(body.elements.over_volume(fem.Constant(mesh.domain, 1.0))))


def two_squares(model) -> None:
    """[0, 1] x [0, 1] and [1, 2] x [0, 1], which share the curve at x = 1."""
    left = model.occ.addRectangle(0, 0, 0, 1, 1)
    right = model.occ.addRectangle(1, 0, 0, 1, 1)
    model.occ.fragment([(2, left)], [(2, right)])
    model.occ.synchronize()


def curves_at(model, axis: int, value: float) -> list[int]:
    """The curves of a model all of whose points have that coordinate."""
    ends = {tag: np.array(model.getBoundingBox(1, tag)).reshape(2, 3)[:, axis] for _, tag in model.getEntities(1)}
    return [tag for tag, span in ends.items() if np.allclose(span, value, atol=1e-6)]


def written(folder: Path, nodes: list, elements: list[str], names: str = "") -> Path:
    """A .msh file of gmsh 2."""
    path = folder / "mesh.msh"
    lines = [f"{i} {' '.join(map(str, x))}" for i, x in enumerate(nodes, 1)]
    numbered = [f"{i} {element}" for i, element in enumerate(elements, 1)]
    path.write_text(
        f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{names}$Nodes\n{len(lines)}\n"
        + "\n".join(lines)
        + f"\n$EndNodes\n$Elements\n{len(numbered)}\n"
        + "\n".join(numbered)
        + "\n$EndElements\n"
    )
    return path


SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
TWO_TRIANGLES = ["2 2 201 1 1 2 3", "2 2 201 1 1 3 4"]


# ------------------------------------------------------------------------------------------------------- groups


def test_groups_without_names_are_named_by_their_numbers(tmp_path):
    edges = ["1 2 101 1 1 2", "1 2 102 2 2 3", "1 2 103 3 3 4", "1 2 104 4 4 1"]
    path = written(tmp_path, SQUARE, edges + TWO_TRIANGLES)
    mesh = cd.read_gmsh(path)
    assert areas(mesh) == pytest.approx({"101": 1, "102": 1, "103": 1, "104": 1}, rel=1e-15)
    assert cd.read_gmsh(path, body="201").cells == 2


def test_a_file_without_groups_loads_and_its_sides_are_named_by_where_they_lie(tmp_path):
    mesh = cd.read_gmsh(written(tmp_path, SQUARE, ["2 2 0 1 1 2 3", "2 2 0 1 1 3 4"]))
    assert mesh.cells == 2
    assert not mesh.surfaces
    top = mesh.with_surfaces(top=lambda x: np.isclose(x[1], 1))
    assert areas(top) == pytest.approx({"top": 1.0})


def test_a_script_without_groups_loads(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    script = tmp_path / "square.geo"
    script.write_text('SetFactory("OpenCASCADE");\nRectangle(1) = {0, 0, 0, 1, 1};\nPhysical Curve(7) = {3};\n')
    mesh = cd.read_gmsh(script)  # the group of a curve alone would keep the cells from gmsh's own files
    assert volume(mesh) == pytest.approx(1.0, rel=1e-12)
    assert areas(mesh) == pytest.approx({"7": 1.0})


def test_blanks_around_names_are_no_part_of_them(model):
    two_squares(model)
    model.addPhysicalGroup(2, [1, 2], name=" body ")
    model.addPhysicalGroup(1, curves_at(model, 1, 1.0), name="top   ")
    model.mesh.generate(2)
    assert areas(cd.from_gmsh(model, body="body")) == pytest.approx({"top": 2.0})


@pytest.mark.parametrize("order", [1, 2])
def test_a_facet_in_several_groups_belongs_to_each_surface(model, order):
    two_squares(model)
    top, outer = (
        curves_at(model, 1, 1.0),
        [tag for axis in (0, 1) for x in (0, 1, 2) for tag in curves_at(model, axis, x)],
    )
    outer.remove(*curves_at(model, 0, 1.0))
    for name, curves in {"loaded": top, "top": top, "outer": outer, "sides": outer[:2] + top}.items():
        model.addPhysicalGroup(1, curves, name=name)
    model.addPhysicalGroup(2, [1, 2], name="body")
    model.mesh.generate(2)
    model.mesh.setOrder(order)
    expected = {"loaded": 2, "top": 2, "outer": 6, "sides": 4}
    assert areas(cd.from_gmsh(model)) == pytest.approx(expected, rel=1e-12)


def test_the_resultant_of_a_pressure_on_overlapping_groups(model):
    """A group that shares facets with others carries the load on all of its area: forces balance at the foot."""
    two_squares(model)
    model.addPhysicalGroup(1, curves_at(model, 1, 1.0)[:1], name="half")
    model.addPhysicalGroup(1, curves_at(model, 1, 1.0), name="top")
    model.addPhysicalGroup(1, curves_at(model, 1, 0.0), name="foot")
    model.mesh.generate(2)
    mesh = cd.from_gmsh(model)
    body = cd.Body("upper", mesh, STEEL, loads=[cd.Pressure("top", 3.0), cd.Pressure("half", 2.0)])
    base = cd.Body("base", cd.rectangle((0, -1), (2, 0), (8, 4)), STEEL, supports=[cd.Fixed("bottom")])
    scene = cd.Scene([body, base], [cd.Contact((body, "foot"), (base, "top"), cd.LinearLayer(1e5))])
    assert cd.solve(scene).contact().force == pytest.approx(3.0 * 2 + 2.0 * 1, rel=1e-9)


@pytest.mark.parametrize("dims", [(1, 2), (2, 1)])
def test_a_surface_named_like_the_volume_is_kept(model, dims):
    two_squares(model)
    for dim in dims:
        model.addPhysicalGroup(dim, curves_at(model, 1, 1.0) if dim == 1 else [1, 2], name="steel")
    model.mesh.generate(2)
    assert areas(cd.from_gmsh(model, body="steel")) == pytest.approx({"steel": 2.0})


def test_groups_of_one_name_are_one(model):
    two_squares(model)
    for curve, name in zip(curves_at(model, 1, 1.0), ("top", "top "), strict=True):
        model.addPhysicalGroup(1, [curve], name=name)
    model.mesh.generate(2)
    assert areas(cd.from_gmsh(model)) == pytest.approx({"top": 2.0})


def test_a_group_between_two_bodies_is_a_surface_of_each_and_none_of_both(model):
    two_squares(model)
    fault = curves_at(model, 0, 1.0)
    model.addPhysicalGroup(1, fault, name="fault")
    model.addPhysicalGroup(1, fault + curves_at(model, 0, 0.0), name="both")
    model.addPhysicalGroup(1, curves_at(model, 0, 2.0), name="right")
    model.addPhysicalGroup(2, [1], name="a")
    model.addPhysicalGroup(2, [2], name="b")
    model.mesh.generate(2)
    assert areas(cd.from_gmsh(model, body="a")) == pytest.approx({"fault": 1.0, "both": 2.0})
    assert areas(cd.from_gmsh(model, body="b")) == pytest.approx({"fault": 1.0, "both": 1.0, "right": 1.0})
    whole = cd.from_gmsh(model)
    assert set(whole.surfaces) == {"right"}
    with pytest.raises(ValueError, match=r"surface = 'fault': \d facets of that group are inside the body"):
        cd.Body("body", whole, STEEL, supports=[cd.Fixed("fault")])
    with pytest.raises(ValueError, match=r"surface = 'right': no facet of that group belongs to this body"):
        cd.from_gmsh(model, body="a").facets("right")
    # What is known of a name is known of the mesh's copies too.
    with pytest.raises(ValueError, match=r"surface = 'fault': \d facets of that group are inside the body"):
        whole.moved((1, 0)).with_surfaces(left=lambda x: np.isclose(x[0], 1)).facets("fault")


def test_two_bodies_of_one_open_model_which_stays_as_it_is(model):
    two_squares(model)
    model.addPhysicalGroup(2, [1], name="a")
    model.addPhysicalGroup(2, [2], name="b")
    model.mesh.generate(2)
    before = model.getEntities(), model.mesh.getNodes()[0].tolist(), model.mesh.getElements()[1][0].tolist()
    meshes = [cd.from_gmsh(model, body=name) for name in "abab"]
    after = model.getEntities(), model.mesh.getNodes()[0].tolist(), model.mesh.getElements()[1][0].tolist()
    assert before == after
    assert [mesh.domain.geometry.x[:, 0].min() for mesh in meshes] == pytest.approx([0, 1, 0, 1])
    assert cd.from_gmsh(model).cells == meshes[0].cells + meshes[1].cells


def test_reading_a_file_leaves_an_open_session_as_it_is(model, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    model.add("mine")
    two_squares(model)
    script = tmp_path / "square.geo"
    script.write_text('SetFactory("OpenCASCADE");\nRectangle(1) = {0, 0, 0, 3, 1};\n')
    assert volume(cd.read_gmsh(script)) == pytest.approx(3.0)
    assert volume(cd.read_gmsh(written(tmp_path, SQUARE, TWO_TRIANGLES))) == pytest.approx(1.0)
    assert model.getCurrent() == "mine"
    assert len(model.getEntities(2)) == 2
    assert not mesh_cache().exists()  # options of the session may have shaped the mesh


def test_a_script_is_run_anew_when_a_file_that_it_names_changes(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    script, other = tmp_path / "square.geo", tmp_path / "width.geo"
    script.write_text('SetFactory("OpenCASCADE");\nInclude "width.geo";\nRectangle(1) = {0, 0, 0, width, 1};\n')
    for width in (1.0, 2.0):
        other.write_text(f"width = {width};\n")
        assert volume(cd.read_gmsh(script)) == pytest.approx(width)


# -------------------------------------------------------------------------------------------------- kinds of cells


def curved_block(model, kind: str) -> float:
    """A quarter of a ring, in the plane or with a height, and how large it is."""
    quads = kind in ("quadrilateral", "hexahedron")
    solid = kind in ("tetrahedron", "hexahedron")
    inner, outer, height = 1.0, 2.0, 0.5
    centre = model.geo.addPoint(0, 0, 0)
    points = [model.geo.addPoint(*x, 0) for x in ((inner, 0), (outer, 0), (0, outer), (0, inner))]
    lines = [
        model.geo.addLine(points[0], points[1]),
        model.geo.addCircleArc(points[1], centre, points[2]),
        model.geo.addLine(points[2], points[3]),
        model.geo.addCircleArc(points[3], centre, points[0]),
    ]
    surface = model.geo.addPlaneSurface([model.geo.addCurveLoop(lines)])
    for line, count in zip(lines, (4, 7, 4, 7), strict=True):
        model.geo.mesh.setTransfiniteCurve(line, count)
    model.geo.mesh.setTransfiniteSurface(surface)
    if quads:
        model.geo.mesh.setRecombine(2, surface)
    model.geo.synchronize()
    arcs = [lines[1]]
    if solid:
        made = model.geo.extrude([(2, surface)], 0, 0, height, numElements=[2], recombine=quads)
        model.geo.synchronize()
        arcs = [made[3][1]]
    model.addPhysicalGroup(3 if solid else 2, [made[1][1] if solid else surface], name="ring")
    model.addPhysicalGroup(2 if solid else 1, arcs, name="outside")
    model.mesh.generate(3 if solid else 2)
    return np.pi / 4 * (outer**2 - inner**2) * (height if solid else 1)


@pytest.mark.parametrize(
    ("kind", "order", "serendipity"),
    [
        *itertools.product(("triangle", "quadrilateral", "tetrahedron"), (1, 2, 3), (False,)),
        ("hexahedron", 1, False),
        ("hexahedron", 2, False),
        ("quadrilateral", 2, True),
        ("hexahedron", 2, True),
    ],
)
def test_volumes_and_surfaces_of_every_kind_and_order(model, kind, order, serendipity):
    """Nodes in the right order give the right volume; arcs of 15° miss it by the chord's, or the parabola's, error."""
    exact = curved_block(model, kind)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", serendipity)
    model.mesh.setOrder(order)
    mesh = cd.from_gmsh(model)
    assert mesh.domain.topology.cell_name() == kind
    angle = np.pi / 12
    area = np.pi * (0.5 if mesh.dim == 3 else 1.0)
    # Of a chord θ²/6 of the area and θ²/24 of the length are missing; a parabola is good to θ⁴, a cubic no worse.
    error = angle**2 if order == 1 else angle**4 / 20
    assert volume(mesh) == pytest.approx(exact, rel=error)
    assert areas(mesh) == pytest.approx({"outside": area}, rel=error)


def test_cells_of_8_nodes_have_the_shape_of_their_own_map(tmp_path):
    """One cell whose edges are parabolas: its area is that of the square and of four segments 2/3 · chord · rise."""
    rises = np.array([0.1, 0.07, -0.05, 0.12])  # outward
    middles = [(0.5, -rises[0], 0), (1 + rises[1], 0.5, 0), (0.5, 1 + rises[2], 0), (-rises[3], 0.5, 0)]
    mesh = cd.read_gmsh(written(tmp_path, SQUARE + middles, ["16 2 1 1 1 2 3 4 5 6 7 8"]))
    assert volume(mesh) == pytest.approx(1 + 2 / 3 * rises.sum(), rel=1e-14)


# ------------------------------------------------------------------------------- refused before dolfinx is called


def contents(elements: dict[Kind, list], nodes=SQUARE, **groups) -> Contents:
    """Cells given by the numbers of their nodes, counted from 1."""
    blocks, count = [], 0
    for kind, rows in elements.items():
        blocks.append(Block(kind, np.arange(count, count + len(rows)), np.array(rows)))
        count += len(rows)
    x = np.array(nodes, dtype=float)
    return Contents("the test", 2, np.arange(1, len(x) + 1), x, blocks, **groups)


TRIANGLE, QUADRILATERAL = Kind("triangle", 3), Kind("quadrilateral", 4)


@pytest.fixture
def no_dolfinx(monkeypatch):
    """dolfinx must not be reached."""
    monkeypatch.setattr("contactdd.base.compat.from_arrays", lambda *_: pytest.fail("dolfinx was called"))


@pytest.mark.usefixtures("no_dolfinx")
@pytest.mark.parametrize(
    ("elements", "message"),
    [
        (
            {TRIANGLE: [[1, 2, 3]], Kind("triangle", 6): [[1, 2, 3, 4, 5, 6]]},
            "several kinds: 3-node triangles and 6-node triangles.*one kind",
        ),
        (
            {Kind("triangle", 15): [list(range(1, 16))]},
            "15-node triangles, which cannot be computed with; mesh it with",
        ),
        ({TRIANGLE: [[1, 2, 3], [1, 3, 9]]}, "a cell has the node 9, which is not there"),
        ({TRIANGLE: [[1, 2, 3], [1, 3, 3]]}, r"1 of the 3-node triangles have a node twice .*\[1, 3, 3\]"),
        ({TRIANGLE: [[1, 2, 3], [1, 2, 4], [2, 1, 5]]}, "1 facets have more than two cells"),
        (
            {Kind("triangle", 6): [[1, 2, 3, 4, 5, 6], [1, 4, 7, 8, 9, 10]]},
            "1 hanging nodes, each a corner of one cell and",
        ),
        ({}, "no cells of dimension 2"),
    ],
)
def test_bad_cells_are_refused(elements, message):
    nodes = SQUARE + [(0.5, -1, 0), (2, 2, 0), (3, 2, 0), (4, 2, 0)] if message[0] == "1" else SQUARE
    nodes = nodes + [(5.0, k, 0) for k in range(2)] if "hanging" in message else nodes
    with pytest.raises(ValueError, match=message):
        contents(elements, nodes).mesh()


@pytest.mark.usefixtures("no_dolfinx")
@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([[1, 2], [2, 4]], "1 of the 2 facets of the group 'lid' belong to no cell"),
        ([[1, 7]], "the group 'lid' has the node 7, which is not there"),
    ],
)
def test_groups_of_facets_that_belong_to_no_cell_are_refused(rows, message):
    with pytest.raises(ValueError, match=message):
        contents({TRIANGLE: [[1, 2, 3], [1, 3, 4]]}, surfaces={"lid": [np.array(rows)]}).mesh()


@pytest.mark.usefixtures("no_dolfinx")
@pytest.mark.parametrize(
    ("node", "message"),
    [
        ((0, np.nan, 0), r"node 4 has coordinates .*expected finite numbers"),
        ((0, 1, 0.5), r"the plane cells reach from z = 0 to 0\.5"),
    ],
)
def test_coordinates_that_no_plane_mesh_has_are_refused(node, message):
    with pytest.raises(ValueError, match=message):
        contents({TRIANGLE: [[1, 2, 3], [1, 3, 4]]}, SQUARE[:3] + [node]).mesh()


def test_a_cell_that_is_there_twice_is_one():
    groups = {"bodies": {"a": np.array([0, 1]), "b": np.array([1, 2])}}
    several = contents({TRIANGLE: [[1, 2, 3], [1, 3, 4], [3, 4, 1]]}, **groups)
    assert volume(several.mesh()) == pytest.approx(1.0, rel=1e-15)
    assert volume(several.mesh("b")) == pytest.approx(0.5, rel=1e-15)


def test_cells_of_other_kinds_may_be_in_other_bodies():
    both = contents(
        {TRIANGLE: [[1, 2, 3], [1, 3, 4]], QUADRILATERAL: [[4, 3, 5, 6]]},
        SQUARE + [(1, 2, 0), (0, 2, 0)],
        bodies={"low": np.array([0, 1]), "high": np.array([2])},
        surfaces={"joint": [np.array([[3, 4]])], "top": [np.array([[5, 6]])]},
    )
    assert areas(both.mesh("low")) == pytest.approx({"joint": 1.0})
    assert areas(both.mesh("high")) == pytest.approx({"joint": 1.0, "top": 1.0})
    with pytest.warns(cd.ContactWarning, match="which are cut into"):
        assert volume(both.mesh()) == pytest.approx(2.0)


def test_a_plane_mesh_is_asked_for_in_a_solid_one(model):
    model.occ.addBox(0, 0, 0, 1, 1, 1)
    model.occ.synchronize()
    model.addPhysicalGroup(3, [1], name="box")
    model.mesh.generate(3)
    assert cd.from_gmsh(model).dim == 3
    with pytest.raises(ValueError, match="expected a mesh in a plane"):
        cd.from_gmsh(model, 2)


# ------------------------------------------------------------------------------------------------- other formats

GOOD = 'SetFactory("OpenCASCADE");\nRectangle(1) = {0, 0, 0, 1, 1};\n'

OTHERS = {
    "cube.inp": ("*NODE\n1,0,0,0\n", "Abaqus or CalculiX deck.*cd.read_mesh reads it"),
    "deck.msh": ("*HEADING\na deck\n*NODE\n1,0,0\n", "Abaqus or CalculiX deck"),
    "deck.geo": ("** a comment\n*NODE\n1,0,0\n", "Abaqus or CalculiX deck"),
    "freefem.msh": ("4 2 4\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n1 2 3 0\n", "FreeFem mesh.*savegmsh"),
    "gid.msh": ("MESH dimension 2 ElemType Triangle Nnode 3\nCoordinates\n1 0 0\n", "GiD mesh"),
    "getfem.mesh": ("% GETFEM MESH FILE\n\nBEGIN POINTS LIST\n", "GetFEM mesh"),
    "mfem.mesh": ("MFEM mesh v1.0\n\ndimension\n2\n", "MFEM mesh"),
    "medit.mesh": ("MeshVersionFormatted 2\nDimension 2\n", "Medit mesh"),
    "plate.bdf": ("BEGIN BULK\nGRID,1,,0.,0.,0.\n", "Nastran deck"),
    "comment.nas": ("$ made by hand\nGRID,1,,0.,0.,0.\n", "Nastran deck"),
    "part.step": ("ISO-10303-21;\nHEADER;\n", "STEP file"),
    "part.stl": ("solid part\n facet normal 0 0 1\n", "STL file"),
    "part.med": ("\x89HDF\r\n\x1a\n\0\0", "MED file"),
    "mesh.vtk": ("# vtk DataFile Version 3.0\n", "VTK file"),
    "dyna.k": ("*KEYWORD\n*NODE\n", "LS-DYNA deck"),
    "notes.txt": ("these are my notes\n", "a file in no known format"),
    "notes.msh": ("these are my notes\n", "a file in no known format"),
    "binary.geo": ("\x92GiD\0ÿþ\x10", "a file in no known format"),
    "empty.msh": ("", "an empty file"),
    "blank.geo": (" \n\n", "an empty file"),
}


@pytest.mark.parametrize("name", OTHERS)
def test_other_formats_are_named_before_gmsh_sees_them(tmp_path, monkeypatch, name):
    monkeypatch.setattr(gmsh, "open", lambda _: pytest.fail("gmsh was asked"))
    text, message = OTHERS[name]
    path = tmp_path / name
    path.write_text(text, encoding="latin-1")
    with pytest.raises(ValueError, match=message):
        cd.read_gmsh(path)


@pytest.mark.parametrize("bad", ["Point(1 = {0, 0, 0};\nfoo bar;\n", "Line(1) = {1, 2;\n" + "a b (c) = {2, ;\n" * 40])
def test_a_good_script_is_read_after_a_bad_one(tmp_path, monkeypatch, bad):
    """gmsh's parser keeps words of what it refused: they must not be taken for the start of the next script."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    script, good = tmp_path / "bad.geo", tmp_path / "good.geo"
    script.write_text(bad)
    good.write_text(GOOD)
    with pytest.raises(ValueError, match=r"bad\.geo'.*gmsh cannot read it.*syntax error"):
        cd.read_gmsh(script)
    assert volume(cd.read_gmsh(good)) == pytest.approx(1.0)


def test_a_good_script_is_read_after_the_user_has_given_gmsh_a_bad_one(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    script, good = tmp_path / "bad.geo", tmp_path / "good.geo"
    script.write_text("Point(1 = {0, 0, 0};\nfoo bar;\n")
    good.write_text(GOOD)
    gmsh.initialize(["tests", "-v", "0"], interruptible=False)
    with pytest.raises(Exception, match="syntax error"):
        gmsh.open(str(script))
    gmsh.finalize()
    assert volume(cd.read_gmsh(good)) == pytest.approx(1.0)


def test_a_comment_in_an_old_encoding(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    script = tmp_path / "square.geo"
    script.write_text("// Länge\n" + GOOD, encoding="latin-1")
    assert volume(cd.read_gmsh(script)) == pytest.approx(1.0)


# ------------------------------------------------------------------------------------------------- several bodies


def test_every_group_of_a_file_is_a_body(tmp_path):
    names = '$PhysicalNames\n3\n1 7 "joint"\n2 1 "low"\n2 2 "high "\n$EndPhysicalNames\n'
    nodes = SQUARE + [(1, 2, 0), (0, 2, 0)]
    path = written(tmp_path, nodes, ["1 2 7 1 4 3", "2 2 1 1 1 2 3", "2 2 1 1 1 3 4", "3 2 2 2 4 3 5 6"], names)
    bodies = cd.read_bodies(path)
    assert list(bodies) == ["low", "high"]
    assert [mesh.domain.topology.cell_name() for mesh in bodies.values()] == ["triangle", "quadrilateral"]
    assert all(areas(mesh) == pytest.approx({"joint": 1.0}) for mesh in bodies.values())
    with pytest.raises(ValueError, match="no groups of cells"):
        cd.read_bodies(written(tmp_path, SQUARE, ["2 2 0 1 1 2 3"]))


@pytest.mark.parametrize("path", ["nothing.msh", "nothing.inp"])
def test_a_missing_file_is_refused(path):
    with pytest.raises(FileNotFoundError, match="no such file"):
        cd.read_mesh(path)
