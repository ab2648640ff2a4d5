"""Meshes: what is refused, and what comes from gmsh scripts."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from scenes import STEEL, block, groove, stack

import contactdd as cd
from contactdd.files import mesh_cache
from contactdd.interface.surface import ContactSurface
from contactdd.quadrature import find_quadrature

gmsh = pytest.importorskip("gmsh")

MESHES = Path(__file__).parents[1] / "meshes"


def area(mesh: cd.Mesh, surface: str) -> float:
    body = cd.Body("body", mesh, STEEL)
    return float(ContactSurface(body, surface, find_quadrature("gauss", 3)).weights.sum())


# ----------------------------------------------------------------------------------------------------- refusals


def blocks() -> list:
    plane = [cd.rectangle((0, 0), (1, 1), (4, 4), shape=shape) for shape in ("triangle", "quadrilateral")]
    return plane + [cd.box((0, 0, 0), (1, 1, 1), (3, 3, 3), shape=shape) for shape in ("tetrahedron", "hexahedron")]


@pytest.mark.parametrize("kind", range(4), ids=["triangle", "quadrilateral", "tetrahedron", "hexahedron"])
def test_inverted_cells_are_refused(kind):
    mesh = blocks()[kind]
    x = mesh.domain.geometry.x
    x[np.argmin(np.linalg.norm(x[:, : mesh.dim] - 0.4, axis=1)), 0] += 0.6  # beyond its neighbour
    with pytest.raises(ValueError, match=r"cells are .*inverted.*one of them around"):
        cd.Mesh(mesh.domain, mesh.surfaces)


@pytest.mark.parametrize("kind", range(4), ids=["triangle", "quadrilateral", "tetrahedron", "hexahedron"])
def test_degenerate_cells_are_refused(kind):
    mesh = blocks()[kind]
    x = mesh.domain.geometry.x
    x[x[:, 0] < 0.3, 0] = 0.0
    x[(x[:, 0] > 0.2) & (x[:, 0] < 0.4), 0] = 0.0
    with pytest.raises(ValueError, match="degenerate"):
        cd.Mesh(mesh.domain, mesh.surfaces)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_coordinates_that_are_not_numbers_are_refused(bad):
    mesh = cd.rectangle((0, 0), (1, 1), (2, 2))
    mesh.domain.geometry.x[4, 1] = bad
    with pytest.raises(ValueError, match=r"node 4 has coordinates .*expected finite numbers"):
        cd.Mesh(mesh.domain, mesh.surfaces)


def test_a_surface_without_facets_is_refused():
    mesh = cd.rectangle((0, 0), (1, 1), (2, 2))
    with pytest.raises(ValueError, match="surface 'crack' has no facets"):
        mesh.with_surfaces(crack=lambda x: x[0] > 2)


def test_a_surface_inside_is_refused():
    mesh = cd.rectangle((0, 0), (1, 1), (2, 2))
    with pytest.raises(ValueError, match=r"surface 'all'.*are inside the body"):
        cd.Mesh(mesh.domain, {"all": np.arange(16, dtype=np.int32)})


def test_a_misspelt_surface_is_refused_with_those_there():
    mesh = cd.rectangle((0, 0), (1, 1), (2, 2))
    with pytest.raises(ValueError, match=r"surface = 'tpo'.*'bottom', 'left', 'right', 'top'"):
        cd.Body("a", mesh, STEEL, supports=[cd.Fixed("tpo")])


@pytest.mark.parametrize(
    ("low", "high", "cells", "message"),
    [
        ((0, 0), (1, 1e-13), (2, 2), "8 cells are degenerate"),
        ((0, 0), (1, 1), (2, [0, 1e-13, 1]), "degenerate"),
        ((0, 0), (np.inf, 1), (2, 2), "expected two points of 2 finite coordinates"),
        ((0, 0, 0), (1, 1e-9, 1e-9), (1, 1, 1), "degenerate"),
    ],
)
def test_structured_meshes_of_bad_cells_are_refused(low, high, cells, message):
    with pytest.raises(ValueError, match=message):
        (cd.rectangle if len(low) == 2 else cd.box)(low, high, cells)


# ------------------------------------------------------------------------------------------------------ structured


@pytest.mark.parametrize(
    "options",
    [{"diagonal": "left"}, {"diagonal": "crossed"}, {"shape": "quadrilateral"}],
    ids=lambda o: "-".join(o.values()),
)
def test_nodes_of_a_graded_rectangle(options):
    lines = [0.1, 0.4, 0.45, 1.2], [-0.3, 0.1 + 0.2, 1.1]
    x = cd.rectangle((0.1, -0.3), (1.2, 1.1), lines, **options).domain.geometry.x
    corners = set(itertools.product(*lines))
    halves = [[(a + b) / 2 for a, b in itertools.pairwise(line)] for line in lines]
    middles = set(itertools.product(*halves)) if options.get("diagonal") == "crossed" else set()
    there = {(float(a), float(b)) for a, b, _ in x}
    assert corners <= there
    others = sorted(there - corners)
    assert len(others) == len(middles)
    assert np.allclose(others, sorted(middles), rtol=1e-15)


@pytest.mark.parametrize("kind", range(4), ids=["triangle", "quadrilateral", "tetrahedron", "hexahedron"])
def test_sides_of_a_structured_mesh(kind):
    mesh = blocks()[kind]
    names = (
        [("left", "right"), ("bottom", "top")]
        if mesh.dim == 2
        else [("left", "right"), ("front", "back"), ("bottom", "top")]
    )
    sides = {name: (axis, end) for axis, pair in enumerate(names) for end, name in enumerate(pair)}
    again = cd.from_dolfinx(
        mesh.domain, **{name: lambda x, a=axis, e=end: np.abs(x[a] - e) < 1e-9 for name, (axis, end) in sides.items()}
    )
    assert list(mesh.surfaces) == list(again.surfaces)
    for name, facets in again.surfaces.items():
        assert np.array_equal(mesh.facets(name), facets)
        assert mesh.facets(name).dtype == np.int32


# --------------------------------------------------------------------------------------------------------- gmsh


@pytest.fixture
def cache(tmp_path, monkeypatch) -> Path:
    """An empty cache."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return mesh_cache()


SCRIPT = """
DefineConstant[ size = {0.5, Name "Parameters/size"} ];
Point(1) = {0, 0, 0, size}; Point(2) = {1, 0, 0, size}; Point(3) = {0, 1, 0, size};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 1};
Curve Loop(1) = {1, 2, 3}; Plane Surface(1) = {1};
"""
GROUPS = 'Physical Surface("body") = {1}; Physical Curve("bottom") = {1}; Physical Curve("slope") = {2};\n'


def written(folder: Path, text: str) -> Path:
    path = folder / "triangle.geo"
    path.write_text(text)
    return path


def test_a_script_becomes_a_mesh_with_named_surfaces(tmp_path, cache):
    mesh = cd.read_gmsh(written(tmp_path, SCRIPT + GROUPS), size=0.25)
    assert set(mesh.surfaces) == {"bottom", "slope"}
    assert area(mesh, "bottom") == pytest.approx(1.0, rel=1e-14)
    assert area(mesh, "slope") == pytest.approx(np.sqrt(2), rel=1e-12)


def test_meshes_are_cached_by_what_makes_them(tmp_path, cache, monkeypatch):
    script = written(tmp_path, SCRIPT + GROUPS)
    first = cd.read_gmsh(script)
    assert len(list(cache.glob("triangle-*.msh"))) == 1
    monkeypatch.setattr(gmsh.model.mesh, "generate", lambda dim: pytest.fail("meshed again"))
    assert cd.read_gmsh(script).cells == first.cells
    monkeypatch.undo()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert cd.read_gmsh(script, size=0.2).cells > first.cells
    cd.read_gmsh(script, order=2)
    script.write_text(SCRIPT + GROUPS + "// changed\n")
    cd.read_gmsh(script)
    assert len(list(cache.iterdir())) == 4


def test_a_script_forgets_its_former_numbers(tmp_path, cache):
    """In contactdd's own session of gmsh and in the user's: each size makes the mesh of that size."""
    script = written(tmp_path, SCRIPT + GROUPS)
    own = [cd.read_gmsh(script, size=size).cells for size in (0.5, 0.1, 0.25)]
    gmsh.initialize(["test", "-v", "1"], interruptible=False)
    gmsh.parser.setNumber("size", [7.0])
    gmsh.parser.setString("word", ["kept"])
    try:
        assert [cd.read_gmsh(script, size=size).cells for size in (0.5, 0.1, 0.25)] == own
        assert gmsh.parser.getNumber("size") == [7.0]
        assert gmsh.parser.getString("word") == ["kept"]
    finally:
        gmsh.finalize()
    assert own[0] < own[2] < own[1]


def test_a_msh_file_is_read_as_it_is(tmp_path, cache):
    cd.read_gmsh(written(tmp_path, SCRIPT + GROUPS))
    [file] = cache.iterdir()
    assert set(cd.read_gmsh(file).surfaces) == {"bottom", "slope"}
    with pytest.raises(ValueError, match=r"parameters and order are for \.geo scripts"):
        cd.read_gmsh(file, size=0.1)


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        (SCRIPT + GROUPS.strip(), {}, "expected a line break at the end"),
        (SCRIPT + GROUPS, {"body": "bdoy"}, "body = 'bdoy'.*'body'"),
        (SCRIPT + GROUPS, {"sizes": 0.1}, r"sizes = 0\.1.*no such parameter.*'size'"),
        (SCRIPT + GROUPS, {"size": np.nan}, "size = nan: expected a finite number"),
    ],
)
def test_scripts_that_cannot_be_used_are_refused(tmp_path, cache, text, options, message):
    with pytest.raises(ValueError, match=message):
        cd.read_gmsh(written(tmp_path, text), **options)


def test_a_missing_script_is_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match="no such file"):
        cd.read_gmsh(tmp_path / "nothing.geo")


# ------------------------------------------------------------------------------------------- the project's scripts


def test_bodies_of_one_script():
    cylinder, block = (
        cd.read_gmsh(MESHES / "cylinder_on_block.geo", body=name, order=2, radius=40, fine=1.0)
        for name in ("cylinder", "block")
    )
    assert set(cylinder.surfaces) == {"contact", "cylinder_top", "axis"}
    assert set(block.surfaces) == {"top", "bottom", "axis"}
    # Quadratic arcs of 15 mm miss the circle's length by (15/40)⁴ / 2880 of it.
    assert area(cylinder, "contact") == pytest.approx(40 * np.pi / 2, rel=1e-5)
    assert area(block, "axis") == pytest.approx(200.0, rel=1e-12)
    assert area(cylinder, "axis") == pytest.approx(40.0, rel=1e-12)


def test_the_mirror_image_of_a_curved_mesh():
    mesh = cd.read_gmsh(MESHES / "cylinder_on_block.geo", body="cylinder", order=2, radius=40, fine=1.0)
    image = mesh.mirrored("y", 0.0)
    for name in mesh.surfaces:
        original, copy = (
            ContactSurface(cd.Body("body", m, STEEL), name, find_quadrature("gauss", 3)) for m in (mesh, image)
        )
        assert np.allclose(copy.weights, original.weights, rtol=1e-12)
        assert np.allclose(copy.points.normal, original.points.normal * [1, -1], rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", ["left_block", "right_block", "wedge"])
def test_keystone(name):
    mesh = cd.read_gmsh(MESHES / "keystone.geo", body=name)
    if name == "wedge":
        assert area(mesh, "slope_left") == pytest.approx(0.9 * np.sqrt(2), rel=1e-12)
    else:
        assert area(mesh, "slope") == pytest.approx(np.sqrt(2), rel=1e-12)
        assert area(mesh, "middle") == pytest.approx(1.0, rel=1e-12)


def test_bump():
    mesh = cd.read_gmsh(MESHES / "bump.geo", dim=3, order=2, fine=0.3)
    assert set(mesh.surfaces) == {"bump", "left", "front", "bottom"}
    # A quarter of the cap, 2π R · rise; quadratic facets of 0.5 on a sphere of 5 miss it by less than 1e-4.
    assert area(mesh, "bump") == pytest.approx(2 * np.pi * 5 * 0.4 / 4, rel=1e-3)
    assert area(mesh, "bottom") == pytest.approx(9.0, rel=1e-12)


def test_a_groove_in_the_mesh_is_the_groove_given_as_a_gap():
    """The same problem with the groove cut into the mesh, and with a flat mesh and d(x)."""

    def solve(lower: cd.Mesh, gap) -> cd.ContactResult:
        sides = [cd.Symmetry("left", "right")]
        a = cd.Body("a", lower, STEEL, supports=sides, loads=[cd.Pressure("bottom", 10)], degree=2)
        b = block("b", 1, (29, 8), loads=[cd.Pressure("top", 10)], degree=2)
        return cd.solve(stack([a, b], gap=gap), "newton", gamma="search", tolerance=1e-10).contact()

    cut = solve(cd.read_gmsh(MESHES / "groove.geo", order=2), 0.0)
    given = solve(cd.rectangle((0, 0), (4, 1), (32, 8)), groove)
    exact = cd.reference.groove()
    for result in (cut, given):
        error = result.pressure - exact.pressure(result.x[:, 0])
        # Facets of 1/8 of the groove, kinks at the edge of contact inside them: 7e-3 in the first, 5e-3 in the second.
        assert np.sqrt(result.weights @ error**2 / (4 * 10**2)) < 1.5e-2
        assert result.force == pytest.approx(40.0, rel=1e-6)  # slopes of the groove, 1e-3, turn the pressure
