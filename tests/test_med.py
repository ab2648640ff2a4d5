"""MED files, written here by h5py as the format's documentation says, and by gmsh and medcoupling where they are."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from test_universal import quarter_ring, sizes

import contactdd as cd

gmsh = pytest.importorskip("gmsh")
h5py = pytest.importorskip("h5py", reason="h5py, which reads MED files, is not installed")

#: The name of each geometry, and each of its nodes by the corners in whose middle it lies.
EDGES = {
    "Line": [(0, 1)],
    "Triangle": [(0, 1), (1, 2), (2, 0)],
    "Quadrilateral": [(0, 1), (1, 2), (2, 3), (3, 0)],
    "Tetrahedron": [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
    "Hexahedron": [(i, (i + 1) % 4) for i in range(4)]
    + [(i + 4, (i + 1) % 4 + 4) for i in range(4)]
    + [(i, i + 4) for i in range(4)],
}
FACES = {
    "Quadrilateral": [(0, 1, 2, 3)],
    "Hexahedron": [(0, 1, 2, 3), *((i, (i + 1) % 4, (i + 1) % 4 + 4, i + 4) for i in range(4)), (4, 5, 6, 7), range(8)],
}
NAMES = {
    1: {2: "SE2", 3: "SE3"},
    2: {3: "TR3", 6: "TR6", 4: "QU4", 8: "QU8", 9: "QU9"},
    3: {4: "TE4", 10: "T10", 8: "HE8", 20: "H20", 27: "H27"},
}


def places(shape: str, at: np.ndarray, corners: int) -> list[int]:
    """Where a cell's nodes stand in gmsh's order; at: gmsh's nodes (n, dim) in the reference cell.

    The first face of a solid turns anticlockwise seen from inside the cell, as the documentation draws it.
    """
    order = {"Tetrahedron": [0, 2, 1, 3], "Hexahedron": [0, 3, 2, 1, 4, 7, 6, 5]}.get(shape, list(range(corners)))
    means = [at[[order[i] for i in each]].mean(axis=0) for each in [*EDGES[shape], *FACES.get(shape, [])]]
    found = [int(np.argmin(np.linalg.norm(at - mean, axis=1))) for mean in means]
    return [*order, *found[: len(at) - corners]]


def write_med(path: Path, *, fill: bytes = b" ", of_nodes: bool = False) -> None:
    """gmsh's model as a MED file, its groups of sides as families of elements or of nodes.

    fill: what names are filled up with to 80 characters.
    """
    model = gmsh.model
    dim, (tags, x, _) = model.getDimension(), model.mesh.getNodes()
    number = {int(tag): place for place, tag in enumerate(tags, 1)}
    with h5py.File(path, "w") as file:
        file.create_group("INFOS_GENERALES").attrs.update(MAJ=4, MIN=2, REL=0)
        file.create_group("ENS_MAA/ring").attrs.update(DIM=dim, ESP=dim, TYP=0)
        step = file["ENS_MAA/ring"].create_group(f"{-1:020d}{-1:020d}")
        columns(step, "NOE/COO", x.reshape(-1, 3)[:, :dim])
        cells: dict[str, list] = {}
        for which, tag in [each for each in model.getEntities() if each[0] in (dim, dim - 1)]:
            groups = [model.getPhysicalName(which, group) for group in model.getPhysicalGroupsForEntity(which, tag)]
            number_of = -100 * which - tag
            if not (of_nodes and which < dim):
                family(file, "ELEME", number_of, groups, fill)
            for kind, _, nodes in zip(*model.mesh.getElements(which, tag), strict=True):
                name, _, _, count, at, corners = model.mesh.getElementProperties(kind)
                rows = np.vectorize(number.get)(nodes.reshape(-1, count))
                order = places(name.split()[0], at.reshape(count, -1), corners)
                cells.setdefault(NAMES[which][count], []).append((rows[:, order], np.full(len(rows), number_of)))
        for geometry, parts in cells.items():
            for name, rows in zip(("NOD", "FAM"), zip(*parts, strict=True), strict=True):
                columns(step, f"MAI/{geometry}/{name}", np.concatenate(rows))
        if of_nodes:
            of_node = np.zeros(len(tags), dtype=np.int64)
            for bit, group in enumerate(model.getPhysicalGroups(dim - 1)):
                ours = [number[int(tag)] - 1 for tag in model.mesh.getNodesForPhysicalGroup(*group)[0]]
                of_node[ours] += 2**bit
            for each in range(1, 2 ** len(model.getPhysicalGroups(dim - 1))):
                groups = [group for bit, group in enumerate(model.getPhysicalGroups(dim - 1)) if each & 2**bit]
                family(file, "NOEUD", each, [model.getPhysicalName(*group) for group in groups], fill)
            columns(step, "NOE/FAM", of_node)


def columns(group, name: str, rows: np.ndarray) -> None:
    """A dataset in which the columns stand one after another."""
    group.create_dataset(name, data=rows.T.ravel()).attrs["NBR"] = len(rows)


def family(file, which: str, number: int, groups: list[str], fill: bytes) -> None:
    """A family of elements or of nodes that is in groups."""
    made = file.create_group(f"FAS/ring/{which}/FAM_{number}")
    made.attrs["NUM"] = number
    if groups:
        names = made.create_dataset("GRO/NOM", (len(groups),), dtype=np.dtype((np.int8, (80,))))
        names[:] = [np.frombuffer(name.encode().ljust(80, fill), dtype=np.int8) for name in groups]


@pytest.fixture
def model():
    """Two cubes on each other, of tetrahedra, and the square between them."""
    gmsh.initialize(["tests", "-v", "1"], interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    for z in (0, 1):
        gmsh.model.occ.addBox(0, 0, z, 1, 1, 1)
    gmsh.model.occ.fragment(gmsh.model.occ.getEntities(3), [])
    gmsh.model.occ.synchronize()
    for name, tag in (("lower", 1), ("upper", 2)):
        gmsh.model.addPhysicalGroup(3, [tag], name=name)
    gmsh.model.addPhysicalGroup(3, [1, 2], name="both, größer")
    (between,) = gmsh.model.getEntitiesInBoundingBox(-0.1, -0.1, 0.9, 1.1, 1.1, 1.1, 2)
    gmsh.model.addPhysicalGroup(2, [between[1]], name="joint")
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
    gmsh.model.mesh.generate(3)
    yield gmsh.model
    gmsh.finalize()


@pytest.mark.parametrize("fill", [b" ", b"\0"])
@pytest.mark.usefixtures("model")
def test_names_and_families_of_several_groups(tmp_path, fill):
    """Names are stripped of what fills them up; a family that is in two groups belongs to both."""
    write_med(tmp_path / "two.med", fill=fill)
    bodies = cd.read_bodies(tmp_path / "two.med")
    assert {name: sizes(mesh)[0] for name, mesh in bodies.items()} == pytest.approx(
        {"lower": 1.0, "upper": 1.0, "both, größer": 2.0}
    )
    assert sizes(bodies["upper"])[1] == pytest.approx({"joint": 1.0})
    with pytest.raises(ValueError, match="inside the body"):
        bodies["both, größer"].facets("joint")


def test_what_gmsh_writes(tmp_path):
    """gmsh's own file, where it has MED: cells of both solid kinds and degree 2."""
    gmsh.initialize(["tests", "-v", "1"], interruptible=False)
    able = "Med" in gmsh.option.getString("General.BuildOptions").split()
    gmsh.finalize()
    if not able:
        pytest.skip("this gmsh was built without MED")
    for kind, degree in itertools.product(("quadrilateral", "tetrahedron", "hexahedron"), (1, 2)):
        quarter_ring(tmp_path / "ring.med", kind, degree, of_nodes=False)
        mesh = cd.read_mesh(tmp_path / "ring.med", "ring")
        volume, surfaces = sizes(mesh)
        high = 0.5 if mesh.dim == 3 else 1.0
        # Of arcs of 15° a chord misses θ²/6 of the area, a parabola the order of θ⁴.
        error = (np.pi / 12) ** 2 if degree == 1 else (np.pi / 12) ** 4 / 20
        assert volume == pytest.approx(3 * np.pi / 4 * high, rel=error)
        assert surfaces["outside"] == pytest.approx(np.pi * high, rel=error)


@pytest.mark.parametrize("degree", [1, 2])
def test_what_medcoupling_writes(tmp_path, degree):
    """The format's own authors: their file of version 4.2, which gmsh refuses."""
    mc = pytest.importorskip("medcoupling", reason="medcoupling is not installed")
    grid = mc.MEDCouplingCMesh()
    grid.setCoords(*[mc.DataArrayDouble(each) for each in ([0.0, 1.0, 3.0], [0.0, 1.0], [0.0, 1.0])])
    cells = grid.buildUnstructured()
    if degree == 2:
        cells.convertLinearCellsToQuadratic(0)
    sides = cells.buildDescendingConnectivity()[0]
    far = [i for i, x in enumerate(sides.computeCellCenterOfMass().getValuesAsTuple()) if x[0] == 3]
    file = mc.MEDFileUMesh()
    for level, mesh, name, members in ((0, cells, "right", [1]), (-1, sides, "far", far)):
        mesh.setName("grid")
        file[level] = mesh
        group = mc.DataArrayInt(members)
        group.setName(name)
        file.setGroupsAtLevel(level, [group])
    file.write(str(tmp_path / "grid.med"), 2)
    volume, surfaces = sizes(cd.read_mesh(tmp_path / "grid.med", "right"))
    assert volume == pytest.approx(2.0)
    assert surfaces == pytest.approx({"far": 1.0})


@pytest.mark.usefixtures("model")
def test_what_is_no_mesh_is_refused(tmp_path):
    path = tmp_path / "two.med"
    write_med(path)
    with h5py.File(path, "a") as file:
        file["ENS_MAA"].copy("ring", "second")
    with pytest.raises(ValueError, match="2 meshes: ring, second; expected one"):
        cd.read_mesh(path)
    with h5py.File(path, "w") as file:
        file.create_group("ENS_MAA/field")
    with pytest.raises(ValueError, match="cannot be read as MED"):
        cd.read_mesh(path)
    path.write_bytes(b"\x89HDF\r\n\x1a\n\0\0")
    with pytest.raises(ValueError, match="cannot be read as MED"):
        cd.read_mesh(path)
