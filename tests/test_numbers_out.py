"""Numbers that leave a solution: resultants, arc length, values at points, tables, saved solutions."""

from __future__ import annotations

import csv
import json
import warnings

import numpy as np
import pytest
from scenes import groove

import contactdd as cd
from contactdd.base.polyline import polyline

STEEL = cd.Isotropic(E=2.1e5, nu=0.3)
SIDES = cd.Symmetry("left", "right")


def blocks(gap=0.0, cells=(8, 11), degree=(2, 1), load=10.0, names=("lower", "upper")) -> cd.Scene:
    """Two blocks, 4 wide and 1 high, whose meshes do not match, pressed together by a pressure at both ends."""
    lower = cd.Body(
        names[0],
        cd.rectangle((0, 0), (4, 1), (cells[0], 4)),
        STEEL,
        supports=[SIDES],
        loads=[cd.Pressure("bottom", load)],
        degree=degree[0],
    )
    upper = cd.Body(
        names[1],
        cd.rectangle((0, 1), (4, 2), (cells[1], 4)),
        STEEL,
        supports=[SIDES],
        loads=[cd.Pressure("top", load)],
        degree=degree[1],
    )
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.PowerLayer(4e-6, 1.1), gap=gap)])


@pytest.fixture(scope="module")
def uniform():
    return cd.solve(blocks())


@pytest.fixture(scope="module")
def grooved():
    return cd.solve(blocks(lambda x: groove(x, middle=1.5), cells=(24, 33)))


def test_uniform_compression(uniform):
    """Every number in closed form: p = q, w = −B q^a."""
    result, q = uniform.contact("lower-upper"), 10.0
    closed = 4e-6 * q**1.1
    exact = {
        "force": 4 * q,
        "area": 4.0,
        "nominal_area": 4.0,
        "peak_pressure": q,
        "mean_pressure": q,
        "mean_approach": closed,
    }
    for name, value in exact.items():
        assert getattr(result, name) == pytest.approx(value, rel=1e-8), name  # the tolerance of solve, on p
    np.testing.assert_allclose(result.force_vector, [0.0, -4 * q], rtol=1e-8, atol=1e-8 * q)
    np.testing.assert_allclose(result.centre_of_pressure, [2.0, 1.0], rtol=1e-8)
    assert result.moment() == pytest.approx(-2.0 * 4 * q, rel=1e-8)
    assert result.moment([2.0, 5.0]) == pytest.approx(0.0, abs=1e-7 * q)
    assert result.edge.shape == (0, 2)
    at = result.at([[0.0, 1.0], [1.7, 1.0], [4.0, 1.0]])
    np.testing.assert_allclose(at["pressure"], q, rtol=1e-8)
    np.testing.assert_allclose(at["compression"], -closed, rtol=1e-8)


def test_force_vector_is_the_contact_part_of_a_bodys_forces(grooved):
    """Found from the points, and from the nodal forces: action on the first body, reaction on the second."""
    force = grooved.contact().force_vector
    for body, sign in (("lower", 1.0), ("upper", -1.0)):
        np.testing.assert_allclose(grooved.forces(body)["contact"], sign * force, rtol=0, atol=1e-10 * 40)


def test_edge_is_where_the_curve_of_the_gap_crosses_zero(grooved):
    result = grooved.contact()
    edge = result.edge
    assert edge.shape == (2, 2)
    left, right = edge[:, 0]
    assert left + right == pytest.approx(2 * 1.5, abs=0.1)  # nearly the groove's own symmetry; the walls are not
    inside = (result.x[:, 0] > left) & (result.x[:, 0] < right)
    np.testing.assert_array_equal(result.closed, ~inside)
    assert result.area + (right - left) == pytest.approx(4.0, abs=2 * 4 / 33)  # to the points' distance at either edge


@pytest.mark.parametrize("seed", range(3))
def test_arc_length_does_not_depend_on_the_order_of_the_facets(seed):
    """A quarter circle and a line, cut finely: the length is the closed form's, the start the end with smaller x."""
    angle = np.linspace(np.pi, np.pi / 2, 400)
    curve = np.column_stack([2 * np.cos(angle), 2 * np.sin(angle)])
    curve = np.vstack([curve, curve[-1] + np.outer(np.linspace(0, 3, 50)[1:], [1, 0])])
    rng = np.random.default_rng(seed)
    segments = np.stack([curve[:-1], curve[1:]], axis=1)[rng.permutation(len(curve) - 1)]
    turned = rng.random(len(segments)) < 0.5
    segments[turned] = segments[turned, ::-1]
    line = polyline(segments)
    arc, _, away = line.locate(curve[[0, 399, -1]])
    # Chords are shorter than their arc by (Δφ)²/24, here 6e-7.
    np.testing.assert_allclose(arc, [0.0, np.pi, np.pi + 3.0], rtol=1e-6, atol=1e-12)
    assert np.all(away < 1e-12)
    assert line.length == pytest.approx(np.pi + 3.0, rel=1e-6)


def test_arc_length_of_pieces_and_of_a_closed_curve():
    angle = np.linspace(0, 2 * np.pi, 201)
    circle = np.column_stack([np.cos(angle), -np.sin(angle)])  # given clockwise
    closed = np.stack([circle[:-1], circle[1:]], axis=1)
    arc, chain, _ = polyline(closed).locate(np.array([[0.0, -1.0], [1.0, 0.0], [0.0, 1.0]]))
    np.testing.assert_allclose(arc, np.pi * np.array([0.5, 1.0, 1.5]), rtol=1e-4)  # from (−1, 0), counter-clockwise
    pieces = polyline(np.array([[[3.0, 0.0], [4.0, 0.0]], [[1.0, 0.0], [0.0, 0.0]]]))
    arc, chain, _ = pieces.locate(np.array([[0.5, 0.0], [3.5, 0.0]]))
    np.testing.assert_allclose(arc, [0.5, 1.5])
    np.testing.assert_array_equal(chain, [0, 1])


def test_points_outside_are_refused(uniform):
    with pytest.raises(ValueError, match="away from the contact"):
        uniform.contact().at([[2.0, 3.5]])
    with pytest.raises(ValueError, match="shape"):
        uniform.contact().at([1.0, 2.0, 3.0])
    with pytest.raises(ValueError, match="1 of 2 are outside of body 'lower'"):
        uniform.displacement_at("lower", [[1.0, 0.5], [1.0, 1.5]])
    with pytest.raises(ValueError, match="expected an index or one of 'lower-upper'"):
        uniform.contact("lower")


def test_fields_at_points(uniform):
    """Uniform compression is linear in y, and both elements hold it exactly."""
    nu, q = STEEL.nu, 10.0
    shortening = q * (1 + nu) * (1 - 2 * nu) / (STEEL.E * (1 - nu))
    points = np.array([[0.3, 0.1], [2.9, 0.85], [4.0, 1.0]])
    u = uniform.displacement_at("lower", points)
    base = uniform.displacement_at("lower", [[1.0, 0.0]])[0, 1]
    np.testing.assert_allclose(u[:, 1] - base, -shortening * points[:, 1], rtol=1e-7)
    stress = uniform.stress_at("lower", points)
    side = nu / (1 - nu) * q
    np.testing.assert_allclose(stress[:, :3], np.tile([-side, -q, -side], (3, 1)), rtol=1e-6)


def test_a_ring_presses_all_round():
    """Press fit of two rings: the resultant vanishes, the mean pressure is Lamé's with the fit's interference."""
    inner, outer = (
        cd.Body(
            name,
            cd.rectangle((a, 0), (b, 5), (12, 3)),
            STEEL,
            degree=2,
            supports=[cd.Symmetry("bottom", "top")],
            kinematics="axisymmetric",
        )
        for name, a, b in (("inner", 10, 20), ("outer", 20, 30))
    )
    contact = cd.Contact((inner, "right"), (outer, "left"), cd.LinearLayer(1e7), gap=-0.01)
    result = cd.solve(cd.Scene([inner, outer], [contact])).contact()
    np.testing.assert_array_equal(result.force_vector, [0.0, 0.0])
    plane = STEEL.E / (1 - STEEL.nu**2)  # both ends are held: plane strain
    lame = 20 / plane * ((20**2 + 10**2) / (20**2 - 10**2) + (30**2 + 20**2) / (30**2 - 20**2)) + 1e-7
    assert result.mean_pressure == pytest.approx(0.01 / lame, rel=1e-4)  # elements of degree 2, twelve along the radius
    # The cells' diagonals are not symmetric to the middle.
    np.testing.assert_allclose(result.centre_of_pressure, [0.0, 2.5], atol=1e-4)
    assert result.moment() == 0.0
    assert result.nominal_area == pytest.approx(2 * np.pi * 20 * 5, rel=1e-12)
    assert result.mean_approach == pytest.approx(-0.01 + result.mean_pressure / 1e7, rel=1e-10)


@pytest.mark.parametrize("cell", ["tetrahedron", "hexahedron"])
def test_a_solid(cell):
    """A block under even pressure: force, moment and values at points in space."""
    q, held = 5.0, cd.Symmetry("left", "right", "front", "back")
    low = cd.Body("low", cd.box((0, 0, 0), (2, 1, 1), (4, 3, 2), shape=cell), STEEL)
    high = cd.Body("high", cd.box((0, 0, 1), (2, 1, 2), (5, 2, 2), shape=cell), STEEL)
    low.supports, high.supports, high.loads = (held, cd.Symmetry("bottom")), (held,), (cd.Pressure("top", q),)
    scene = cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(1e6))])
    result = cd.solve(scene).contact()
    # The tolerance of solve is on the residual; k h/E = 2 hardly enlarges it.
    np.testing.assert_allclose(result.force_vector, [0, 0, -2 * q], atol=1e-7 * q)
    np.testing.assert_allclose(result.moment(), [-q, 2 * q, 0.0], atol=1e-7 * q)
    np.testing.assert_allclose(result.at([[0.3, 0.4, 1.0], [1.9, 0.99, 1.0]])["pressure"], q, rtol=1e-7)
    with pytest.raises(ValueError, match="no arc length"):
        _ = result.arc_length


def test_csv_holds_every_digit(grooved, tmp_path):
    result = grooved.contact().sorted()
    assert np.all(np.diff(result.arc_length) > 0.0)
    with open(grooved.contact().to_csv(tmp_path / "contact.csv"), newline="") as file:
        rows = list(csv.DictReader(file))
    for column, values in (("x", result.x[:, 0]), ("pressure", result.pressure), ("gap", result.gap)):
        np.testing.assert_array_equal([float(row[column]) for row in rows], values)
    with open(grooved.history.to_csv(tmp_path / "history.csv"), newline="") as file:
        rows = list(csv.DictReader(file))
    np.testing.assert_array_equal([float(row["residual"]) for row in rows], grooved.history.residual)


def test_a_load_path_as_a_table(tmp_path):
    q = cd.Parameter(0.0)
    record = {"force": lambda s: s.contact().force, "edge": lambda s: s.forces("lower")["contact"]}
    path = cd.programme(blocks(load=q), q, [5.0, 10.0, 5.0], record=record)
    with open(path.to_csv(tmp_path / "path.csv"), newline="") as file:
        rows = list(csv.reader(file))
    assert rows[0] == ["parameter", "force", "edge_0", "edge_1"]
    values = np.array(rows[1:], dtype=float)
    np.testing.assert_array_equal(values[:, 0], [5.0, 10.0, 5.0])
    np.testing.assert_allclose(values[:, 1], [20.0, 40.0, 20.0], rtol=1e-8)
    np.testing.assert_allclose(values[:, 3], -values[:, 1], rtol=1e-8)


def test_frames(grooved):
    pandas = pytest.importorskip("pandas")
    frame = grooved.contact().frame()
    assert isinstance(frame, pandas.DataFrame)
    assert (frame.weight * frame.pressure).sum() == pytest.approx(grooved.contact().force, rel=1e-12)
    assert len(grooved.history.frame()) == len(grooved.history)


def test_a_saved_solution_is_the_solution(grooved, tmp_path):
    """Every array to the last bit, and nothing but numbers and text in the files."""
    folder = grooved.save(tmp_path / "saved")
    again = cd.load_solution(folder)
    assert sorted(file.name for file in folder.iterdir()) == ["solution.json", "solution.npz"]
    for name in ("x", "normal", "weights", "gap", "compression", "pressure", "initial_gap", "corners"):
        np.testing.assert_array_equal(getattr(again.contact(), name), getattr(grooved.contact(), name))
    assert again.contact().unpaired_area == grooved.contact().unpaired_area
    for body in ("lower", "upper"):
        for name in ("points", "cells", "displacement", "stress", "cell_stress"):
            np.testing.assert_array_equal(getattr(again.body(body), name), getattr(grooved.body(body), name))
        np.testing.assert_array_equal(again.body(body).drawn(300.0), grooved.body(body).drawn(300.0))
        np.testing.assert_array_equal(again.forces(body)["contact"], grooved.forces(body)["contact"])
    for second in (False, True):
        mine, other = (solution.contact_surface(second=second) for solution in (again, grooved))
        np.testing.assert_array_equal(mine.pressure, other.pressure)
        np.testing.assert_array_equal(mine.status, other.status)
    assert again.numbers["energy"] == grooved.energy
    np.testing.assert_array_equal(again.history.residual, grooved.history.residual)
    assert again.converged
    assert "SavedSolution" in repr(again)


@pytest.mark.parametrize("damage", ["missing", "text", "cut", "format", "pickle", "field"])
def test_a_damaged_folder_is_refused(uniform, tmp_path, damage):
    folder = uniform.save(tmp_path / "saved")
    description, arrays = folder / "solution.json", folder / "solution.npz"
    if damage == "missing":
        arrays.unlink()
    elif damage == "text":
        description.write_text("{")
    elif damage == "cut":
        arrays.write_bytes(arrays.read_bytes()[:200])
    elif damage == "pickle":
        np.savez(arrays, **{"body 0 points": np.array([{"a": 1}], dtype=object)})
    else:
        told = json.loads(description.read_text())
        if damage == "format":
            told["version"] = 99
        else:
            del told["bodies"][0]["name"]
        description.write_text(json.dumps(told))
    with pytest.raises(ValueError, match="folder = "):
        cd.load_solution(folder)


def test_old_names_still_work(uniform):
    with pytest.warns(DeprecationWarning, match="LoadPath"):
        assert cd.Path is cd.LoadPath
    with pytest.warns(DeprecationWarning, match="unpaired_area"):
        assert uniform.contact().unmatched == (0.0, 0.0)


def between_plates(closing: float, gap=0.0) -> cd.Scene:
    """The two blocks between a fixed base and a plate that comes down by `closing`."""
    low = cd.Body("low", cd.rectangle((0, 0), (4, 1), (16, 4)), STEEL, supports=[SIDES, cd.Fixed("bottom")], degree=2)
    down = cd.Displacement("top", [None, -closing])
    high = cd.Body("high", cd.rectangle((0, 1), (4, 2), (21, 4)), STEEL, supports=[SIDES, down])
    return cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), cd.PowerLayer(4e-6, 1.1), gap=gap)])


def test_stiffness_of_columns():
    """The layer and the two columns in series: δ = F/A (2/M) + B (F/A)^a, M the modulus of held sides."""
    solution = cd.solve(between_plates(3e-4))
    modulus = STEEL.E * (1 - STEEL.nu) / ((1 + STEEL.nu) * (1 - 2 * STEEL.nu))
    p = solution.contact().mean_pressure
    assert 2 * p / modulus + 4e-6 * p**1.1 == pytest.approx(3e-4, rel=1e-8)
    compliance = 2 / modulus + 1.1 * 4e-6 * p**0.1
    assert solution.normal_stiffness() == pytest.approx(4 / compliance, rel=1e-8)


@pytest.mark.parametrize("local_solver", ["condensed", "multigrid"])
def test_stiffness_is_the_slope_of_the_force(local_solver):
    """With a groove that closes step by step, against central differences, by factors and by conjugate gradients."""

    def force(closing):
        scene = between_plates(closing, lambda x: groove(x, middle=1.5))
        solution = cd.solve(scene, tolerance=1e-12, local_solver=local_solver)
        return solution.contact().force, solution

    (more, _), (less, _), (_, solution) = (force(closing) for closing in (3.001e-4, 2.999e-4, 3e-4))
    # Differences over 7e-4 of δ err by its square times the curve's third derivative, and by a point that opens.
    assert solution.normal_stiffness() == pytest.approx((more - less) / 2e-7, rel=1e-4)


def test_loads_alone_leave_no_stiffness(uniform):
    stiffness = uniform.normal_stiffness()
    assert stiffness == pytest.approx(0.0, abs=1e-8 * 4 / (4e-6 * 1.1 * 10**0.1))  # the layer's own, by rounding


def test_markup_in_names_is_text():
    solution = cd.solve(blocks(names=("<b>lower", "upper & <script>")))
    html = solution._repr_html_()
    assert "<b>lower" not in html
    assert "<script>" not in html
    assert "&lt;b&gt;lower" in html


def pressed_by(depth: float, modulus: float = 1.0) -> cd.Solution:
    """A rubber block on a stiff one, its top moved down by `depth` of its height, free at the sides."""
    low = cd.Body("stiff", cd.rectangle((-1, -1), (3, 0), (8, 2)), cd.Isotropic(1e4 * modulus, 0.3))
    low.supports = (cd.Fixed("bottom"),)
    high = cd.Body("rubber", cd.rectangle((0, 0), (2, 1), (8, 4)), cd.Isotropic(modulus, 0.0))
    high.supports = (cd.Displacement("top", [None, -depth]), cd.Symmetry("left"))
    return cd.solve(cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(1e5 * modulus))]))


def test_large_strains_are_told():
    """With ν = 0 the strain of the block is its shortening, whatever the unit of stress."""
    with pytest.warns(cd.LargeStrainWarning, match="body 'rubber': strains up to 0.3"):
        large = pressed_by(0.3, modulus=7.0)
    assert large.largest_strain == pytest.approx(0.3, rel=1e-3)  # layer and stiff block take 1e-4 of it
    assert "linear theory is doubtful" in repr(large)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        small = pressed_by(0.05)
    assert small.largest_strain == pytest.approx(0.05, rel=1e-3)
    assert small.largest_rotation < 1e-3
    assert "doubtful" not in repr(small)


def test_the_size_of_a_rotation():
    """A rigid turn by a small angle is that rotation, in the plane and in space, without strain."""
    from contactdd.small_strains import strain_size

    for mesh in (cd.rectangle((0, 0), (2, 1), (3, 2)), cd.box((0, 0, 0), (1, 1, 2), (2, 2, 2))):
        body = cd.Body("any", mesh, STEEL, degree=2)
        x = body.space.tabulate_dof_coordinates()[:, : mesh.dim]
        turn = np.zeros_like(x)
        turn[:, 0], turn[:, 1] = -0.07 * x[:, 1], 0.07 * x[:, 0]
        size = strain_size(body, turn.ravel())
        assert size.rotation == pytest.approx(0.07, rel=1e-12)
        assert size.strain < 1e-15


def test_the_hoop_strain_counts():
    from contactdd.small_strains import strain_size

    body = cd.Body("ring", cd.rectangle((1, 0), (2, 1), (4, 4)), STEEL, kinematics="axisymmetric")
    x = body.space.tabulate_dof_coordinates()
    outward = np.column_stack([np.full(len(x), 0.2), np.zeros(len(x))])
    # u_r/r at the middle of the innermost cells, at r = 1 + 1/12 or 1 + 2/12
    assert strain_size(body, outward.ravel()).strain == pytest.approx(0.2 / (1 + 1 / 12), rel=1e-12)
