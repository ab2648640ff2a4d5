"""The quadrature "mortar", the law at the nodes of one surface, and the pressure projected onto a surface's nodes."""

from __future__ import annotations

import numpy as np
import pytest

import contactdd as cd

STEEL, SOFTER = cd.Isotropic(2.1e5, 0.3), cd.Isotropic(1e5, 0.35)
LAYER = cd.PowerLayer(4e-6, 1.1)
LOAD = 10.0


def groove(x):
    return 5e-4 * np.maximum(1 - x[0] ** 2, 0) ** 1.5


def blocks(cells, *, layer=LAYER, gap=0.0, quadrature="mortar", swapped=False, upper=SOFTER, width=4.0, **body):
    """Two blocks between walls, pressed together; the upper one may be narrower."""
    shape = body.pop("shape", "triangle")
    walls = cd.Symmetry("left", "right")
    low = cd.rectangle((0, 0), (4, 1), cells[0], shape=shape)
    high = cd.rectangle((0, 1), (width, 2), cells[1], shape=shape)
    lower = cd.Body("lower", low, STEEL, supports=[walls], loads=[cd.Pressure("bottom", LOAD)], **body)
    if width < 4.0:
        lower = cd.Body("lower", low, STEEL, supports=[walls, cd.Symmetry("bottom")], **body)
    held = walls if width == 4.0 else cd.Symmetry("left")
    pressed = cd.Body("upper", high, upper, supports=[held], loads=[cd.Pressure("top", LOAD)], **body)
    pair = [(lower, "top"), (pressed, "bottom")][:: -1 if swapped else 1]
    return cd.Scene([lower, pressed], [cd.Contact(*pair, layer, gap=gap, quadrature=quadrature)])


def solids(shape, degree, cells=((3, 4, 1), (5, 3, 1))):
    walls, kw = cd.Symmetry("left", "right", "front", "back"), {"degree": degree}
    low, high = (
        cd.box((0, 0, 0), (1, 1.3, 0.5), cells[0], shape=shape),
        cd.box((0, 0, 0.5), (1, 1.3, 1), cells[1], shape=shape),
    )
    lower = cd.Body("lower", low, STEEL, supports=[walls], loads=[cd.Pressure("bottom", LOAD)], **kw)
    upper = cd.Body("upper", high, SOFTER, supports=[walls], loads=[cd.Pressure("top", LOAD)], **kw)
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), LAYER, quadrature="mortar")])


def by_place(result):
    return result.pressure[np.lexsort(result.x.T)]


@pytest.mark.parametrize("cells", [((7, 3), (11, 2)), ((8, 3), (8, 2))], ids=["unlike", "matching"])
@pytest.mark.parametrize("kinematics", ["plane strain", "axisymmetric"])
@pytest.mark.parametrize(("shape", "degree"), [("triangle", 1), ("quadrilateral", 2), ("triangle", 3)])
def test_patch(cells, kinematics, shape, degree):
    """A constant pressure passes between any meshes to rounding, and every node's weight is positive."""
    scene = blocks(cells, shape=shape, degree=degree, kinematics=kinematics)
    result = cd.solve(scene, tolerance=1e-12).contact()
    assert result.pressure == pytest.approx(LOAD, rel=1e-12)
    assert result.weights.min() > 0.0
    assert len(result.x) == 1 + min(cells)[0]  # the nodes of one surface


@pytest.mark.parametrize(("shape", "degree"), [("tetrahedron", 1), ("hexahedron", 2)])
def test_patch_in_space(shape, degree):
    result = cd.solve(solids(shape, degree), tolerance=1e-12).contact()
    assert result.pressure == pytest.approx(LOAD, rel=1e-12)
    assert result.force == pytest.approx(1.3 * LOAD, rel=1e-12)


@pytest.mark.parametrize("width", [2.45, 2.25, 2.25 + 1e-7])
def test_partly_overlapping(width):
    """Force and moment pass where one surface ends within the other's facets, also a hair beyond a node."""
    solution = cd.solve(blocks(((16, 4), (10, 5)), width=width))
    result = solution.contact()
    assert result.force == pytest.approx(width * LOAD, rel=1e-10)
    assert result.unpaired_area[0] == pytest.approx(4 - width)
    for body, sign in (("lower", -1.0), ("upper", 1.0)):
        assert solution.forces(body)["contact"][1] == pytest.approx(sign * width * LOAD, rel=1e-10)


def test_methods_and_local_solvers_agree():
    """All ways to solve meet in one solution, whichever body comes first."""
    expected = cd.solve(blocks(((14, 7), (22, 11)), gap=groove), tolerance=1e-12).contact()
    ways = [("newton-krylov", "condensed"), ("anderson", "condensed"), ("auto", "assembled"), ("newton", "condensed")]
    ways += [("newton-krylov", "multigrid"), ("anderson", "assembled")]
    for swapped in (False, True):
        for method, local in ways:
            scene = blocks(((14, 7), (22, 11)), gap=groove, swapped=swapped)
            solution = cd.solve(scene, method, local_solver=local, tolerance=1e-9)
            # The residual is relative to the forces; the pressure of a node follows to a few of it.
            assert by_place(solution.contact()) == pytest.approx(by_place(expected), abs=1e-7 * LOAD)
            assert solution.imbalance < 1e-8


def test_decomposed_methods_converge():
    """One solve per body and step; floating bodies take the paper's methods many steps, so a coarse rule is met."""
    scene = blocks(((14, 7), (22, 11)), gap=groove)
    auto = cd.solve(scene, tolerance=1e-11).contact()
    for method in ("chord", "one-point", "kurchatov"):
        apart = cd.solve(scene, method, tolerance=1e-5).contact()
        assert by_place(apart) == pytest.approx(by_place(auto), abs=1e-3 * LOAD)


def test_converges_at_the_groove():
    """The error of the pressure about halves, or better, with the facets."""
    exact = cd.reference.groove()
    errors = []
    for n in (1, 2, 4):
        scene = blocks(((15 * n, 8 * n), (13 * n, 7 * n)), gap=groove, upper=STEEL)
        result = cd.solve(scene).contact()
        right = exact.pressure(np.clip(result.x[:, 0], 0, 4))
        errors.append(np.sqrt(result.weights @ (result.pressure - right) ** 2 / (result.weights @ right**2)))
    assert errors[2] < 0.55 * errors[1] < 0.55**2 * errors[0] < 0.02


@pytest.mark.parametrize("quadrature", ["gauss", "facet"])
def test_projected_pressure_of_a_stiff_layer(quadrature):
    """680 times as stiff as the facets: the law's pressure is wrong by 0.9 (0.78) in L², the projected one by 0.14."""
    scene = blocks(((28, 14), (45, 22)), layer=cd.LinearLayer(1e9), gap=groove, upper=STEEL, quadrature=quadrature)
    result = cd.solve(scene, tolerance=1e-9).contact()
    right = cd.reference.groove(B=1e-9, a=1.0).pressure(np.clip(result.x[:, 0], 0, 4))

    def error(pressure):
        return np.sqrt(result.weights @ (pressure - right) ** 2 / (result.weights @ right**2))

    assert result.stiffness_ratio == pytest.approx(1e9 * (4 / 28) / 2.1e5)
    assert error(result.pointwise_pressure) > 0.7
    assert error(result.projected_pressure) < 0.16
    assert np.array_equal(result.pressure, result.projected_pressure)
    assert "waver" in repr(result)
    assert result.weights @ result.projected_pressure == pytest.approx(4 * LOAD, rel=1e-10)


def test_projected_pressure_keeps_nodal_forces():
    """∫ p ψ_i is that of the law's pressure for every node: also on a surface that is only partly covered."""
    for quadrature in ("gauss", "facet"):
        scene = blocks(((16, 4), (10, 5)), width=2.45, quadrature=quadrature)
        solution = cd.solve(scene)
        result, functions = solution.contact(), solution.interfaces[0].functions
        work = functions.at_values.T @ (result.weights * result.pressure)
        assert np.allclose(result.node_x[:, 1], 1.0)  # where the surfaces meet
        assert work.sum() == pytest.approx(result.force, rel=1e-12)
        again = functions.projected(result.projected_pressure, result.weights)
        if quadrature == "gauss":  # a linear field is its own projection
            assert again == pytest.approx(result.nodal_pressure, rel=1e-10)
        assert "waver" not in repr(result)


def test_soft_layers_and_matching_meshes_keep_the_laws_pressure():
    stiff = cd.LinearLayer(1e9)
    for scene in (
        blocks(((28, 14), (45, 22)), quadrature="gauss"),
        blocks(((28, 14), (28, 22)), quadrature="gauss", layer=stiff),
        blocks(((28, 14), (45, 22)), layer=stiff),
    ):
        result = cd.solve(scene).contact()
        assert np.array_equal(result.pressure, result.pointwise_pressure)
        assert np.array_equal(result.pressure, -scene.contacts[0].layer.contact_stress(result.gap))
        assert "waver" not in repr(result)


def test_pressure_between_nodes():
    """At Gauss points the pressure of nodes is the linear field that the bodies feel: force and moment are kept."""
    solution = cd.solve(blocks(((14, 7), (22, 11)), gap=groove))
    nodal, fine = solution.contact(), solution.contact(degree=4)
    assert fine.force == pytest.approx(nodal.force, rel=1e-12)
    right = np.interp(fine.x[:, 0], np.sort(nodal.x[:, 0]), by_place(nodal))
    assert fine.pressure == pytest.approx(right, rel=1e-12)


def test_nodes_belong_to_the_softer_or_coarser_surface():
    """A rigid block of few facets under a fine soft one must not decide how finely pressure is resolved."""
    coarse_and_stiff = blocks(((3, 2), (20, 5)), upper=cd.Isotropic(1e3, 0.3))
    assert len(coarse_and_stiff.interfaces[0].weights) == 21
    assert len(blocks(((7, 3), (11, 2))).interfaces[0].weights) == 8
    assert len(blocks(((7, 3), (11, 2)), swapped=True).interfaces[0].weights) == 8


def test_parameter_in_the_gap():
    """A mortar contact follows a changed gap."""
    depth = cd.Parameter(0.0)
    scene = blocks(((7, 3), (11, 2)), gap=depth.field(lambda d, x: d * groove(x)))
    flat = cd.solve(scene).contact().pressure
    depth.value = 1.0
    assert flat == pytest.approx(LOAD)
    fixed = cd.solve(blocks(((7, 3), (11, 2)), gap=groove)).contact()
    assert cd.solve(scene).contact().pressure == pytest.approx(fixed.pressure, rel=1e-8)


@pytest.mark.parametrize("quadrature", ["gauss", "mortar"])
def test_surfaces_and_files_hold_the_nodal_pressure(quadrature, tmp_path):
    """The surface that carries the nodes shows the field; saved and read back it is the same."""
    scene = blocks(((14, 7), (22, 11)), gap=groove, quadrature=quadrature)
    solution = cd.solve(scene)
    result = solution.contact()
    surfaces = solution.contact_surface(), solution.contact_surface(second=True)
    shown = [surface for surface in surfaces if surface.projected_pressure is not None]
    assert len(shown) == 1
    order, own = np.argsort(shown[0].points[:, 0]), np.argsort(result.node_x[:, 0])
    assert shown[0].projected_pressure[order] == pytest.approx(result.nodal_pressure[own], rel=1e-12)
    read = cd.load_solution(solution.save(tmp_path / "saved")).contact()
    for name in ("projected_pressure", "nodal_pressure", "node_x", "pointwise_pressure", "stiffness_ratio", "hard"):
        assert np.array_equal(getattr(read, name), getattr(result, name))
