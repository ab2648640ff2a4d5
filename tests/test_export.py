"""Every file that a solution writes, read back by pyvista, holds the solution's own numbers."""

from __future__ import annotations

import os
import textwrap
from xml.etree import ElementTree

import numpy as np
import pytest
import test_numbers_out
import test_own_bodies
from scenes import groove
from test_ranks import launch

import contactdd as cd
from contactdd.view.export import file_name

pyvista = pytest.importorskip("pyvista")

#: Files hold the same 64 bits.
EXACT = {"rtol": 0.0, "atol": 0.0}


@pytest.fixture(scope="module")
def solution():
    """Unlike meshes, degrees 2 and 1, a groove that stays open."""
    return cd.solve(test_numbers_out.blocks(lambda x: groove(x, middle=1.5)))


def read(files):
    return {file.stem: pyvista.read(file) for file in files if file.suffix == ".vtu"}


def in_space(values):
    return np.pad(values, ((0, 0), (0, 3 - values.shape[1])))


def test_bodies(solution, tmp_path):
    files = solution.export(tmp_path / "made" / "fields")
    grids = read(files)
    assert list(grids) == [
        "lower",
        "upper",
        "lower-upper points",
        "lower-upper on lower",
        "lower-upper on upper",
    ]
    for name in ("lower", "upper"):
        grid, body = grids[name], solution.body(name)
        np.testing.assert_allclose(grid.points, in_space(body.points), **EXACT)
        np.testing.assert_allclose(grid.point_data["displacement"], in_space(body.displacement), **EXACT)
        np.testing.assert_allclose(grid.point_data["von Mises"], body.von_mises, **EXACT)
        stress = grid.GetPointData().GetArray("stress")
        names = [stress.GetComponentName(place) for place in range(6)]
        assert names == ["XX", "YY", "ZZ", "XY", "YZ", "XZ"]
        for place, component in enumerate(names):
            own = body.stress[:, ["XX", "YY", "ZZ", "YZ", "XZ", "XY"].index(component)]
            np.testing.assert_allclose(grid.point_data["stress"][:, place], own, **EXACT)
    assert grids["lower"].celltypes[0] == pyvista.CellType.LAGRANGE_TRIANGLE
    assert grids["lower"].cells[0] == 6
    # Constant stresses in the cells of degree one: the solution's own, cell by cell.
    own = solution.stress("upper").x.array.reshape(-1, 6)[:, [0, 1, 2, 5, 3, 4]]
    np.testing.assert_allclose(grids["upper"].cell_data["stress of cell"], own, rtol=1e-14, atol=1e-14)


def test_contact(solution, tmp_path):
    grids, result = read(solution.export(tmp_path)), solution.contact()
    points = grids["lower-upper points"]
    np.testing.assert_allclose(points.points, in_space(result.x), **EXACT)
    for name in ("pressure", "gap", "compression"):
        np.testing.assert_allclose(points.point_data[name], getattr(result, name), **EXACT)
    np.testing.assert_array_equal(points.point_data["status"] == 3, result.closed)
    for body in ("lower", "upper"):
        facets = grids[f"lower-upper on {body}"]
        sizes = facets.compute_cell_sizes(length=True)["Length"]
        # Means over facets keep the force; lengths by VTK are those of straight facets, which these are.
        assert sizes @ facets.cell_data["pressure"] == pytest.approx(result.force, rel=1e-12)
        status, gap = facets.cell_data["status"], facets.cell_data["gap"]
        assert set(status) == {1, 2, 3}  # the groove stays open, its edges lie within facets
        assert np.all(gap[status == 1] >= 0.0)
        assert np.all(gap[status == 3] < 0.0)
        # The compression is that of the whole contact, facet by facet.
        assert sizes @ facets.cell_data["compression"] == pytest.approx(result.weights @ result.compression, rel=1e-12)


def test_surfaces_that_overlap_in_part(tmp_path):
    """A punch narrower than what it presses: beside it there is nothing opposite, and no gap that could be told."""
    base = cd.Body("base", cd.rectangle((0, 0), (4, 1), (13, 4)), test_numbers_out.STEEL, supports=[cd.Fixed("bottom")])
    punch = cd.Body("punch", cd.rectangle((1, 1), (2.5, 2), (5, 4)), test_numbers_out.STEEL, degree=2)
    punch.supports, punch.loads = (cd.Symmetry("left", "right"),), (cd.Pressure("top", 10.0),)
    solution = cd.solve(cd.Scene([base, punch], [cd.Contact((base, "top"), (punch, "bottom"), cd.LinearLayer(1e5))]))
    below, above = solution.contact_surface(), solution.contact_surface(second=True)
    middle = below.outlines.mean(axis=1)[:, 0]
    half = 0.5 * 4 / 13
    np.testing.assert_array_equal(below.status == 0, (middle + half < 1.0) | (middle - half > 2.5))
    np.testing.assert_array_equal(np.isnan(below.gap), below.status == 0)
    assert below.areas @ below.covered == pytest.approx(1.5, rel=1e-12)
    np.testing.assert_allclose(above.covered, 1.0, rtol=1e-12)
    assert below.areas @ below.pressure == pytest.approx(15.0, rel=1e-8)  # the tolerance of solve
    grid = read(solution.export(tmp_path))["base-punch on base"]
    np.testing.assert_array_equal(grid.cell_data["gap"], below.gap)


@pytest.mark.parametrize("cell", ["tetrahedron", "hexahedron"])
def test_solids_of_degree_two(cell, tmp_path):
    """The grids have the bodies' volumes, and the facets' nodes lie where the bodies' do."""
    held = cd.Symmetry("left", "right", "front", "back")
    low = cd.Body("low", cd.box((0, 0, 0), (2, 1, 1), (2, 2, 1), shape=cell), test_numbers_out.STEEL, degree=2)
    high = cd.Body("high", cd.box((0, 0, 1), (2, 1, 2), (3, 1, 1), shape=cell), test_numbers_out.STEEL, degree=2)
    low.supports, high.supports, high.loads = (held, cd.Symmetry("bottom")), (held,), (cd.Pressure("top", 5.0),)
    solution = cd.solve(cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(1e6))]))
    grids = read(solution.export(tmp_path))
    for name in ("low", "high"):
        # VTK measures curved cells by flat pieces of them; these cells are straight.
        assert abs(grids[name].volume) == pytest.approx(2.0, rel=1e-6)
    facets = grids["low-high on low"]
    assert facets.compute_cell_sizes()["Area"].sum() == pytest.approx(2.0, rel=1e-6)
    owner = solution.displacement_at("low", facets.points)
    np.testing.assert_allclose(facets.point_data["displacement"], owner, rtol=0, atol=1e-12 * np.abs(owner).max())


def test_contacts_as_text(solution, tmp_path):
    """Read by nothing but an XML parser, since not every VTK reads XDMF."""
    grids = ElementTree.parse(solution.export(tmp_path)[-1]).getroot().findall("Domain/Grid")
    assert [grid.get("Name") for grid in grids] == ["lower–upper on lower", "lower–upper on upper"]
    for second, grid in enumerate(grids):
        surface = solution.contact_surface(second=bool(second))
        for attribute in grid.findall("Attribute"):
            numbers = np.array(attribute.findtext("DataItem").split(), dtype=float)
            np.testing.assert_array_equal(numbers, getattr(surface, attribute.get("Name")))
        points = np.array(grid.findtext("Geometry/DataItem").split(), dtype=float).reshape(-1, 2, 3)
        np.testing.assert_array_equal(points[:, :, :2], surface.outlines)


@pytest.mark.parametrize("swapped", [False, True])
def test_a_body_without_a_mesh(swapped, tmp_path):
    """What is told of its partner is written, saved and drawn; of itself there is nothing to show."""
    punch = test_own_bodies.RigidCylinder((0.0, 10.0), 10.0, force=10.0)
    solution = test_own_bodies.pressed(punch, swapped)
    names = {file.stem for file in solution.export(tmp_path)}
    contact = "cylinder-block" if swapped else "block-cylinder"
    assert names == {"block", "contacts", f"{contact} points", f"{contact} on block"}
    up = 1.0 if swapped else -1.0  # the force on the first body
    np.testing.assert_allclose(solution.contact().force_vector, [0.0, up * 10.0], atol=1e-7 * 10)
    again = cd.load_solution(solution.save(tmp_path / "saved"))
    np.testing.assert_array_equal(again.forces("cylinder")["loads"], [0.0, -10.0])
    assert again.contact_surface(second=swapped).body == "block"
    for told in (solution, again):
        with pytest.raises(ValueError, match="no mesh"):
            told.contact_surface(second=not swapped)
    with pytest.raises(ValueError, match="body = 'cylinder': it has no mesh"):
        solution.body("cylinder")
    edge = solution.contact().edge
    assert edge[0, 0] == pytest.approx(-edge[1, 0], abs=1 / 40)  # a facet
    assert len(solution.plot_contact().axes) == 2


def test_a_load_programme(tmp_path):
    q = cd.Parameter(0.0)
    path = cd.programme(test_numbers_out.blocks(load=q), q, [5.0, 10.0, 5.0])
    files = path.export(tmp_path, "cycle")
    assert files[0].name == "cycle.pvd"
    assert len(files) == 1 + 3 * 5
    reader = pyvista.PVDReader(files[0])
    assert reader.time_values == [1.0, 2.0, 3.0]
    for number, (solution, load) in enumerate(zip(path.solutions, path.values, strict=True)):
        reader.set_active_time_point(number)
        blocks = reader.read()
        assert len(blocks) == 5
        np.testing.assert_allclose(blocks[2].point_data["pressure"], solution.contact().pressure, **EXACT)
        assert blocks[0].field_data["parameter"][0] == float(load)
    with pytest.raises(ValueError, match="kept no solutions"):
        cd.programme(test_numbers_out.blocks(load=q), q, [5.0], keep_solutions=False).export(tmp_path)


def test_a_saved_solution_writes_the_same_files(solution, tmp_path):
    files = solution.export(tmp_path / "own")
    again = cd.load_solution(solution.save(tmp_path / "saved")).export(tmp_path / "again")
    for one, other in zip(files, again, strict=True):
        assert one.name == other.name
        assert one.read_bytes() == other.read_bytes()


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("a–b", "a-b"),
        ("../x", "-x"),
        ("/etc/passwd", "-etc-passwd"),
        ("a:b*c?", "a-b-c-"),
        ("NUL", "_NUL"),
        ("вал", "вал"),
        ("..", "_"),
        ("x" * 300, "x" * 120),
    ],
)
def test_file_names(name, expected):
    assert file_name(name) == expected


def test_files_stay_in_their_folder(tmp_path):
    """Names that lead elsewhere, or are one file where large and small letters are the same."""
    names = ("../Block", "..-block")
    files = cd.solve(test_numbers_out.blocks(names=names)).export(tmp_path / "inner")
    assert {file.parent for file in files} == {tmp_path / "inner"}
    assert len({file.name.casefold() for file in files}) == len(files) == 6
    assert os.listdir(tmp_path) == ["inner"]


RANKS = """
    import sys
    import numpy as np
    from mpi4py import MPI
    sys.path.insert(0, {tests!r})
    import contactdd as cd, test_numbers_out
    from scenes import groove
    scene = test_numbers_out.blocks(lambda x: groove(x, middle=1.5))
    scene = cd.Scene(scene.bodies, scene.contacts, comm=MPI.COMM_WORLD)
    solution = cd.solve(scene)
    files = solution.export({folder!r})
    assert all(file.is_file() for file in files), files
    assert len(cd.load_solution(solution.save({folder!r} + "/saved")).bodies) == 2
    try:
        solution.export("/dev/null/nowhere")
    except OSError:
        print("refused")
"""


def test_several_ranks_write_what_one_does(solution, tmp_path):
    folder = tmp_path / "two"
    script = textwrap.dedent(RANKS.format(tests=os.path.dirname(__file__), folder=str(folder)))
    done = launch(2, script)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("refused") == 2  # the first rank's error is raised on both
    for one in solution.export(tmp_path / "one"):
        if one.suffix != ".vtu":
            continue
        mine, other = pyvista.read(one), pyvista.read(folder / one.name)
        for name in mine.array_names:
            size = np.nanmax(np.abs(mine[name])) if mine[name].size else 0.0
            # Ranks add in another order; pressures follow gaps by a layer 50 times stiffer than the bodies.
            np.testing.assert_allclose(other[name], mine[name], rtol=0, atol=1e-8 * size)
