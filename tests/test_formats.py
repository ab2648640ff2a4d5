"""The table of files in docs/files.md, read from the page: each row by files made here."""

from __future__ import annotations

import importlib
from pathlib import Path

import basix
import numpy as np
import pytest
from mpi4py import MPI
from test_universal import sizes

import contactdd as cd
from contactdd.base.facets import facet_type, surface_points
from contactdd.files.contents import Contents

gmsh = pytest.importorskip("gmsh")

KINDS = {
    "triangles": "triangle",
    "quadrilaterals": "quadrilateral",
    "tetrahedra": "tetrahedron",
    "hexahedra": "hexahedron",
}
#: The names of the cells, of the arc r = 2 and of all other sides, as each word of the table says that they are kept.
NAMES = {"named": ("ring", "outside", "rest"), "in capitals": ("RING", "OUTSIDE", "REST"), "numbered": ("1", "2", "3")}


def table() -> list[dict[str, str]]:
    """The rows of the page's table."""
    lines = (Path(__file__).parents[1] / "docs" / "files.md").read_text().splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("|")]
    return [dict(zip(cells[0], row, strict=True)) for row in cells[2:]]


ROWS = {row["file"]: row for row in table()}


def script(kind: str, factory: str = "Built-in") -> str:
    """A quarter of a ring 1 < r < 2, its solid 0.5 high, in arcs of 15° that are 1/3 thick."""
    quads = kind in ("quadrilateral", "hexahedron")
    text = f"""SetFactory("{factory}");
        Point(1) = {{0, 0, 0, 0.25}}; Point(2) = {{1, 0, 0, 0.25}}; Point(3) = {{2, 0, 0, 0.25}};
        Point(4) = {{0, 2, 0, 0.25}}; Point(5) = {{0, 1, 0, 0.25}};
        Line(1) = {{2, 3}}; Circle(2) = {{3, 1, 4}}; Line(3) = {{4, 5}}; Circle(4) = {{5, 1, 2}};
        Curve Loop(1) = {{1:4}}; Plane Surface(1) = {{1}};
        Transfinite Curve {{1, 3}} = 4; Transfinite Curve {{2, 4}} = 7; Transfinite Surface {{1}};
        {"Recombine Surface {1};" if quads else ""}
    """
    if kind in ("triangle", "quadrilateral"):
        return (
            text
            + """Physical Surface("ring", 1) = {1};
            Physical Curve("outside", 2) = {2}; Physical Curve("rest", 3) = {1, 3, 4};\n"""
        )
    return (
        text
        + f"""made[] = Extrude {{0, 0, 0.5}} {{ Surface{{1}}; Layers{{2}}; {"Recombine;" if quads else ""} }};
        Physical Volume("ring", 1) = {{made[1]}}; Physical Surface("outside", 2) = {{made[3]}};
        Physical Surface("rest", 3) = {{1, made[0], made[2], made[4], made[5]}};\n"""
    )


@pytest.fixture
def session(tmp_path, monkeypatch):
    """gmsh, open, and a cache of its own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    gmsh.initialize(["tests", "-v", "1"], interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    yield gmsh
    if gmsh.isInitialized():
        gmsh.finalize()


def opened(folder: Path, kind: str, factory: str = "Built-in") -> Path:
    """The script as gmsh's model."""
    path = folder / "ring.geo"
    path.write_text(script(kind, factory))
    gmsh.open(str(path))
    return path


def meshed(folder: Path, kind: str, degree: int, **options: float) -> None:
    """The ring as gmsh's mesh."""
    opened(folder, kind)
    for name, value in options.items():
        gmsh.option.setNumber(f"Mesh.{name}", value)
    gmsh.model.mesh.generate(gmsh.model.getDimension())
    gmsh.model.mesh.setOrder(degree)


def saved(folder: Path, ending: str) -> Path:
    path = folder / f"ring{ending}"
    gmsh.write(str(path))
    gmsh.finalize()
    return path


# --------------------------------------------------------------------------- files, of groups of sides or of nodes


def msh(version: float):
    def write(folder: Path, kind: str, degree: int, of_nodes: bool) -> Path:
        meshed(folder, kind, degree, MshFileVersion=version)
        return saved(folder, ".msh")

    return write


def geo(folder: Path, kind: str, degree: int, of_nodes: bool) -> Path:
    path = opened(folder, kind)
    gmsh.finalize()
    return path


def inp(folder: Path, kind: str, degree: int, of_nodes: bool) -> Path:
    """gmsh's deck, with *SURFACEs by the faces of elements."""
    meshed(folder, kind, degree, SecondOrderIncomplete=1, SaveGroupsOfNodes=of_nodes)
    surfaces = "" if of_nodes else "".join(faces(group) for group in gmsh.model.getPhysicalGroups(DIMS[kind] - 1))
    path = saved(folder, ".inp")
    path.write_text(path.read_text() + surfaces)
    return path


def faces(group: tuple[int, int]) -> str:
    """The *SURFACE of a group of sides."""
    lines = [f"*SURFACE, NAME={gmsh.model.getPhysicalName(*group)}"]
    sides = {
        frozenset(side)
        for entity in gmsh.model.getEntitiesForPhysicalGroup(*group)
        for side in corners(group[0], entity)
    }
    (numbers,) = gmsh.model.mesh.getElements(group[0] + 1)[1]
    for number, cell in zip(numbers, corners(group[0] + 1), strict=True):
        lines += [
            f"{number}, S{place}"
            for place, side in enumerate(FACES[len(cell)] if group[0] == 2 else PLANE_FACES[len(cell)], 1)
            if frozenset(cell[[corner - 1 for corner in side]]) in sides
        ]
    return "\n".join(lines) + "\n"


#: The corners of the sides S1, S2, ... by the manuals of Abaqus and CalculiX, by the number of a cell's corners.
PLANE_FACES = {3: [(1, 2), (2, 3), (3, 1)], 4: [(1, 2), (2, 3), (3, 4), (4, 1)]}
FACES = {
    4: [(1, 2, 3), (1, 4, 2), (2, 4, 3), (3, 4, 1)],
    8: [(1, 2, 3, 4), (5, 8, 7, 6), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 8, 4), (4, 8, 5, 1)],
}


def corners(dim: int, entity: int = -1) -> np.ndarray:
    """The corner nodes (elements, corners) of the model's elements, which are of one kind."""
    (kind,), _, (nodes,) = gmsh.model.mesh.getElements(dim, entity)
    _, _, _, count, _, first = gmsh.model.mesh.getElementProperties(kind)
    return nodes.reshape(-1, count)[:, :first]


def unv(folder: Path, kind: str, degree: int, of_nodes: bool) -> Path:
    meshed(folder, kind, degree, SecondOrderIncomplete=1, SaveGroupsOfNodes=of_nodes, SaveGroupsOfElements=not of_nodes)
    return saved(folder, ".unv")


def bdf(folder: Path, kind: str, degree: int, of_nodes: bool) -> Path:
    meshed(folder, kind, degree, SecondOrderIncomplete=1, SaveElementTagType=2)
    return saved(folder, ".bdf")


def med(folder: Path, kind: str, degree: int, of_nodes: bool) -> Path:
    test_med = pytest.importorskip("test_med")  # of which h5py, which reads MED files, may not be installed
    meshed(folder, kind, degree)
    test_med.write_med(folder / "ring.med", of_nodes=of_nodes)
    gmsh.finalize()
    return folder / "ring.med"


def step(folder: Path, kind: str, degree: int, of_nodes: bool) -> Path:
    opened(folder, kind, "OpenCASCADE")
    return saved(folder, ".step")


def stl(folder: Path, kind: str, degree: int, of_nodes: bool) -> Path:
    opened(folder, kind)
    gmsh.model.mesh.generate(2)
    return saved(folder, ".stl")


def objects(folder: Path, kind: str, degree: int, of_nodes: bool):
    """The mesh and the tags of cells and facets that dolfinx makes of gmsh's model."""
    meshed(folder, kind, degree)
    try:
        reader = importlib.import_module("dolfinx.io.gmsh")
    except ImportError:
        reader = importlib.import_module("dolfinx.io.gmshio")
    found = reader.model_to_mesh(gmsh.model, MPI.COMM_SELF, 0, gdim=DIMS[kind])[:3]
    gmsh.finalize()
    return found


MADE = {
    "`.msh` 2 of gmsh": msh(2.2),
    "`.msh` 4 of gmsh": msh(4.1),
    "`.geo` of gmsh": geo,
    "`.inp` of Abaqus and CalculiX": inp,
    "`.unv`, universal": unv,
    "`.bdf` of Nastran": bdf,
    "`.med` of Salome": med,
    "`.step`": step,
    "`.stl`": stl,
    "dolfinx objects": objects,
}
DIMS = {"triangle": 2, "quadrilateral": 2, "tetrahedron": 3, "hexahedron": 3}


def read(row: dict[str, str], given, degree: int) -> cd.Mesh:
    """The mesh by the row's reader; surfaces by place are named here."""
    outside = lambda x: np.hypot(x[0], x[1]) > 1.96  # noqa: E731 - a chord of 0.3 comes to 1.989
    match row["reader"]:
        case "`cd.read_mesh`":
            return cd.read_mesh(given)
        case "`cd.read_gmsh`":
            return cd.read_gmsh(given, order=degree)
        case "`cd.read_geometry`":
            return cd.read_geometry(given, 0.25, order=degree, outside=outside)
        case "`cd.from_dolfinx`":
            domain, cells, facets = given
            names = {"outside": 2, "rest": 3}
            return cd.from_dolfinx(domain, facets, names=names, cell_tags=cells, subdomains={"ring": 1})
    raise AssertionError(row["reader"])


# ------------------------------------------------------------------------------------------------------ the rows


def degrees(row: dict[str, str], cells: str) -> list[int]:
    return [int(degree) for degree in row[cells].split(",") if degree != "–"]


CASES = [
    (file, KINDS[cells], degree) for file, row in ROWS.items() for cells in KINDS for degree in degrees(row, cells)
]


def volume_by_sides(mesh: cd.Mesh) -> float:
    """∫ x·n over the whole boundary, by the dimension: the volume, if every normal points outwards."""
    dim = mesh.dim
    mesh.domain.topology.create_connectivity(dim - 1, dim)
    whole = mesh.with_surfaces(whole=lambda x: np.full(x.shape[1], True))
    rule, weights = basix.make_quadrature(facet_type(mesh.domain), 8)
    at = surface_points(mesh.domain, whole.entities("whole"), rule)
    return (
        float(
            np.einsum("fq,q->", (np.einsum("nd,nd->n", at.x, at.normal) * at.area).reshape(-1, len(weights)), weights)
        )
        / dim
    )


def test_the_table_has_a_row_for_every_file_that_is_made_here():
    assert set(ROWS) == set(MADE)
    assert {degree for _, _, degree in CASES} == {1, 2, 3}


@pytest.mark.usefixtures("session")
@pytest.mark.parametrize(("file", "kind", "degree"), CASES)
def test_what_the_table_says_is_kept(tmp_path, file, kind, degree):
    row = ROWS[file]
    given = MADE[file](tmp_path, kind, degree, False)
    mesh = read(row, given, degree)
    assert mesh.domain.topology.cell_name() == kind
    assert mesh.domain.geometry.cmap.degree == degree
    volume, surfaces = sizes(mesh)
    # Of arcs of 15° a chord misses θ²/6 of the area, a parabola the order of θ⁴; a cubic is no worse.
    error = (np.pi / 12) ** 2 if degree == 1 else (np.pi / 12) ** 4 / 20
    high = 0.5 if mesh.dim == 3 else 1.0
    assert volume == pytest.approx(3 * np.pi / 4 * high, rel=error)
    assert volume_by_sides(mesh) == pytest.approx(volume, rel=1e-11)  # rounding: the rules are exact on both
    ring = NAMES.get(row["bodies"], (None,))[0]
    if ring is not None:
        assert ring in (mesh.subdomains if file == "dolfinx objects" else cd.read_bodies(given))
    _, outside, rest = NAMES.get(row["surfaces"], (None, "outside", None))
    assert surfaces[outside] == pytest.approx(np.pi * high, rel=error)
    if rest is not None:
        flat = 2 * 3 * np.pi / 4 if mesh.dim == 3 else 0.0
        assert surfaces[rest] == pytest.approx((np.pi / 2 + 2) * high + flat, rel=error)
    if row["sets of nodes"] != "–":
        gmsh.initialize(["tests", "-v", "1"], interruptible=False)
        of_nodes = sizes(cd.read_mesh(MADE[file](tmp_path, kind, degree, True)))[1]
        assert of_nodes[NAMES[row["sets of nodes"]][1]] == pytest.approx(surfaces[outside], rel=1e-6)


# ------------------------------------------------------------------------------------------------ what trials found


@pytest.mark.usefixtures("session")
@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("kind", ["tetrahedron", "hexahedron"])
def test_groups_of_faces_in_a_deck_of_gmsh_are_surfaces(tmp_path, kind, degree):
    """gmsh writes them as sets of plane elements; without their nodes' sets nothing else tells of them."""
    meshed(tmp_path, kind, degree, SecondOrderIncomplete=1)
    path = saved(tmp_path, ".inp")
    mesh = cd.read_mesh(path)
    assert list(cd.read_bodies(path)) == ["VOLUME1", "RING"]
    error = (np.pi / 12) ** 2 if degree == 1 else (np.pi / 12) ** 4 / 20
    assert sizes(mesh)[1]["OUTSIDE"] == pytest.approx(np.pi / 2, rel=error)
    whole = sizes(mesh)[1]["OUTSIDE"] + sizes(mesh)[1]["REST"]
    assert whole == pytest.approx(np.pi / 2 + np.pi / 4 + 1 + 3 * np.pi / 2, rel=error)


@pytest.mark.usefixtures("session")
def test_bodies_of_a_row_have_the_surfaces_between_them(tmp_path, monkeypatch):
    """A strip of ten squares, a body each; the groups of sides are compared with the cells once, not for each body."""
    count, checked, on_cells = 10, [], Contents._on_cells
    monkeypatch.setattr(Contents, "_on_cells", lambda self, rows: checked.append(1) or on_cells(self, rows))
    for place in range(count):
        gmsh.model.occ.addRectangle(place, 0, 0, 1, 1)
    gmsh.model.occ.fragment(gmsh.model.occ.getEntities(2), [])
    gmsh.model.occ.synchronize()
    for place in range(count + 1):
        (upright,) = gmsh.model.getEntitiesInBoundingBox(place - 0.1, -0.1, -0.1, place + 0.1, 1.1, 0.1, 1)
        gmsh.model.addPhysicalGroup(1, [upright[1]], name=f"x = {place}")
    for place in range(count):
        (square,) = gmsh.model.getEntitiesInBoundingBox(place - 0.1, -0.1, -0.1, place + 1.1, 1.1, 0.1, 2)
        gmsh.model.addPhysicalGroup(2, [square[1]], name=f"square {place}")
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
    gmsh.model.mesh.generate(2)
    bodies = cd.read_bodies(saved(tmp_path, ".msh"))
    for place in range(count):
        volume, surfaces = sizes(bodies[f"square {place}"])
        assert volume == pytest.approx(1.0)
        assert surfaces == pytest.approx({f"x = {place}": 1.0, f"x = {place + 1}": 1.0})
    with pytest.raises(ValueError, match="no facet of that group belongs to this body"):
        bodies["square 3"].facets("x = 7")
    assert len(checked) == count + 1
