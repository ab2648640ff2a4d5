"""Elastic half-planes, half-spaces and strips by influence functions: closed forms, finite elements, each other."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from test_ranks import launch

import contactdd as cd
from contactdd.partners import influence

E, NU = 1e3, 0.3
SOFT = cd.Isotropic(E, NU)
MODULUS = E / (1 - NU**2)


def solved(first, second, stiffness, gap=0.0, **options):
    contact = cd.Contact(first, second, cd.LinearLayer(stiffness), gap=gap)
    bodies = [side if isinstance(side, cd.MeshlessBody) else side[0] for side in (first, second)]
    return cd.solve(cd.Scene(bodies, [contact]), **options)


def roll(force=None, moved=0.0, radius=10.0, **options):
    motion = {"displacement": (0, moved)} if force is None else {"displacement": (0, None), "force": (0, -force)}
    return cd.RigidBody("roll", cd.Cylinder((0, radius), radius), **motion, **options)


def ground(half_width=1.0, count=61, reference=100.0, **options):
    return cd.HalfPlane("ground", SOFT, np.linspace(-half_width, half_width, count), reference, **options)


# Formulas by themselves


def test_hats_are_integrals_of_line_loads():
    nodes = np.array([0.0, 0.3, 0.7, 1.5])
    x = np.array([-0.4, 0.3, 0.55, 2.0])
    s, weight = np.polynomial.legendre.leggauss(400)
    expected = np.zeros((4, 4))
    for row, at in enumerate(x):
        cuts = np.unique(np.append(nodes, np.clip(at, 0.0, 1.5)))
        for low, high in pairwise(cuts):
            # s = t² towards either end of an interval takes the logarithm's edge off.
            t = 0.5 * (s + 1)
            place, share = low + (high - low) * t**2 * (3 - 2 * t), (high - low) * 0.5 * weight * 6 * t * (1 - t)
            kernel = (2 / np.pi) * np.log(5.0 / np.abs(at - place))
            expected[row] += [np.sum(share * kernel * np.interp(place, nodes, unit)) for unit in np.eye(4)]
    assert influence.line_load_hats(x, nodes, 5.0) == pytest.approx(expected, rel=1e-6)


def test_rings_add_up():
    nodes = np.linspace(0, 2, 9)
    r = np.array([0.0, 0.3, 1.0, 2.0, 5.0])
    # All hats together are a disc of pressure 1; they with their radii as weights a cone turned upside down.
    assert influence.ring_hats(r, nodes).sum(axis=1) == pytest.approx(influence.disc(r, np.array(2.0)), rel=1e-12)
    assert influence.disc(np.zeros(1), np.array(2.0)) == pytest.approx(2 * 2.0)  # 2 (1 − ν²) p a / E
    assert influence.disc(np.array([1e3]), np.array(2.0)) == pytest.approx(
        np.pi * 4 / (np.pi * 1e3), rel=1e-5
    )  # P/(π r)
    # p = 1 − r/a: u_n(0) = ∫ p dr · 2 = a.
    assert influence.ring_hats(np.zeros(1), nodes) @ (1 - nodes / 2) == pytest.approx([2.0], rel=1e-6)


def test_rectangles_are_loads_far_away_and_add_up():
    far = influence.rectangle(np.array([300.0]), np.array([400.0]), 1.0, 2.0)
    assert far == pytest.approx(2.0 / (np.pi * 500.0), rel=1e-5)
    middle = influence.rectangle(np.zeros(1), np.zeros(1), 2.0, 2.0)
    assert middle == pytest.approx(8 * np.arcsinh(1.0) / np.pi)  # Johnson (3.26)
    halves = sum(influence.rectangle(np.array([at]), np.zeros(1), 1.0, 2.0) for at in (-0.5, 0.5))
    assert halves == pytest.approx(middle)


def test_thick_strips_are_half_planes_and_thin_ones_columns():
    k = np.array([0.01, 1.0, 50.0])
    for wave in (influence.sliding_strip_wave(k, 1e4), influence.bonded_strip_wave(k, 1e4, 1.8)):
        assert wave == pytest.approx(influence.half_plane_wave(k), rel=1e-12)
    assert influence.sliding_strip_wave(np.zeros(1), 0.7) == pytest.approx(0.7)
    held = 0.7 * (1 + NU) * (1 - 2 * NU) / (1 - NU) / (1 - NU**2)  # the oedometric column, in parts of 1/E*
    assert influence.bonded_strip_wave(np.zeros(1), 0.7, 3 - 4 * NU) == pytest.approx(held, rel=1e-8)
    compliance = cd.reference.surface_compliance(k, 1.3, E, NU)  # a strip that is pressed on both sides alike
    assert influence.sliding_strip_wave(k, 1.3 / 2).shape == compliance.shape


# Hertz and others


def test_a_roll_is_hertz():
    hertz = cd.reference.hertz_cylinder(10.0, 10.0, E, NU)
    solution = solved(ground(1.5 * hertz.half_width), roll(force=10.0), 1e3 * MODULUS / hertz.half_width)
    result = solution.contact()
    assert result.force == pytest.approx(10.0, rel=1e-9)
    # The layer takes a part in 1e3, 20 nodes on the half width the rest.
    assert result.pressure.max() == pytest.approx(hertz.peak_pressure, rel=2e-3)
    approach = 10.0 / (np.pi * MODULUS) * (2 * np.log(2 * 100.0 / hertz.half_width) + 1)
    assert solution.displacement("roll")[1] == pytest.approx(-approach, rel=1e-3)
    assert solution.forces("ground")["contact"] == pytest.approx([0.0, -10.0])
    assert solution.forces("ground")["supports"] == pytest.approx([0.0, 10.0])
    assert max(solution.residual, solution.imbalance) < 1e-9


def test_cylinder_on_block_of_nafems():
    """CGS-1: R = 50 mm, E = 210 and 70 GPa, 35 kN/mm; each body a half-plane, the upper one under the force."""
    nodes = np.linspace(-9, 9, 81)
    upper = cd.HalfPlane(
        "upper", cd.Isotropic(210e3, 0.3), nodes, 1e3, normal=(0, -1), displacement=None, force=35e3
    )  # fmt: skip
    lower = cd.HalfPlane("lower", cd.Isotropic(70e3, 0.3), nodes, 1e3)
    result = solved(lower, upper, 1e7, gap=lambda x: x[0] ** 2 / 100).contact()
    assert result.pressure.max() == pytest.approx(3585.36, rel=5e-3)
    assert result.area / 2 == pytest.approx(6.2146, abs=9 / 40)  # a node more or less
    assert result.force == pytest.approx(35e3, rel=1e-9)


def test_spheres_of_code_aster():
    """SSNV104: R = 50, E = 2e4, ν = 0.3, approach 4: a = 10, p0 = 2798.33, F = 586 081."""
    nodes = np.linspace(0, 14, 57)
    spheres = [
        cd.AxisymmetricHalfSpace(name, cd.Isotropic(2e4, 0.3), nodes, up=up, displacement=2.0)
        for name, up in (("lower", True), ("upper", False))
    ]
    result = solved(*spheres, 1e7, gap=lambda x: x[0] ** 2 / 50).contact()
    assert result.force == pytest.approx(586081, rel=1e-3)
    assert result.pressure.max() == pytest.approx(2798.33, rel=5e-3)
    assert np.sqrt(result.area / np.pi) == pytest.approx(10.0, abs=0.25)


def test_sphere_of_moose():
    """A rigid sphere, R = 2, on an elastic one, R = 2, depth 0.01: a = 0.1, p0 = 9.5493e5, F = 2e4; in both ways."""
    material = cd.Isotropic(1.40625e7, 0.25)
    shape = cd.Profile(lambda r: r**2 / 2)
    ring = cd.AxisymmetricHalfSpace("ground", material, np.linspace(0, 0.14, 57))
    ball = cd.RigidBody("ball", shape, displacement=(0, -0.01), kinematics="axisymmetric")
    space = cd.HalfSpace("ground", material, (0.24, 0.24), (30, 30))
    solid = cd.RigidBody("ball", cd.Profile(lambda x, y: (x**2 + y**2) / 2, 3), displacement=(0, 0, -0.01))
    for pair, bound in (((ring, ball), 2e-3), ((space, solid), 1e-2)):
        result = solved(*pair, 1e4 * 1.5e7 / 0.1).contact()
        assert result.force == pytest.approx(2e4, rel=bound)
        assert result.pressure.max() == pytest.approx(9.5493e5, rel=1.5 * bound + 3e-3)


@pytest.mark.parametrize("space", [False, True])
def test_cone_of_sneddon(space):
    """F = (2/π) E* δ² tan α on the radius (2/π) δ tan α."""
    half_angle, depth = 1.4, 0.1
    radius = 2 / np.pi * depth * np.tan(half_angle)
    force = 2 / np.pi * MODULUS * depth**2 * np.tan(half_angle)
    if space:
        body = cd.HalfSpace("ground", SOFT, (2.5 * radius, 2.5 * radius), (32, 32))
        cone = cd.RigidBody("cone", cd.Cone((0, 0, 0), half_angle), displacement=(0, 0, -depth))
    else:
        body = cd.AxisymmetricHalfSpace("ground", SOFT, np.linspace(0, 1.5 * radius, 61))
        cone = cd.RigidBody("cone", cd.Cone((0, 0), half_angle), displacement=(0, -depth), kinematics="axisymmetric")
    result = solved(body, cone, 1e4 * MODULUS / radius).contact()
    assert result.force == pytest.approx(force, rel=1e-3)
    assert np.sqrt(result.area / np.pi) == pytest.approx(radius, rel=0.02)


def test_flat_punches():
    """F = 2 E* a δ and p(0) = F/(2πa²) of a disc, p(0) = F/(πa) of a strip."""
    radius, depth = 0.5, 0.01
    towards_edge = radius * np.sin(np.linspace(0, np.pi / 2, 41))
    body = cd.AxisymmetricHalfSpace("ground", SOFT, towards_edge)
    punch = cd.RigidBody("punch", cd.FlatPunch((0, 0), radius), displacement=(0, -depth), kinematics="axisymmetric")
    result = solved(body, punch, 1e5 * MODULUS / radius).contact()
    assert result.force == pytest.approx(2 * MODULUS * radius * depth, rel=1e-3)
    assert result.pressure[0] == pytest.approx(MODULUS * depth / (np.pi * radius), rel=2e-3)
    inner = body.nodes < 0.9 * radius
    expected = MODULUS * depth / (np.pi * np.sqrt(radius**2 - body.nodes[inner] ** 2))
    assert result.pressure[inner] == pytest.approx(expected, rel=5e-3)
    nodes = np.concatenate([-towards_edge[:0:-1], towards_edge])
    strip = cd.HalfPlane("ground", SOFT, nodes, 100.0)
    punch = cd.RigidBody("punch", cd.FlatPunch((0, 0), radius), displacement=(0, None), force=(0, -7.0))
    result = solved(strip, punch, 1e5 * MODULUS / radius).contact()
    assert result.pressure[40] == pytest.approx(7.0 / (np.pi * radius), rel=2e-3)


@pytest.mark.parametrize("part", [0.2, 0.6, 2.0])
def test_wavy_surface_of_westergaard(part):
    """A wave 2Δ high, of length λ, under parts of p* = π E* Δ/λ, which closes it (Johnson, §13.2)."""
    wave, height, count = 2 * np.pi, 0.01, 256
    closing = np.pi * MODULUS * height / wave
    body = cd.PeriodicHalfPlane("ground", SOFT, wave, count)
    profile = cd.Profile(lambda x: height * (1 - np.cos(2 * np.pi * x / wave)))
    rigid = cd.RigidBody("wave", profile, displacement=(0, None), force=(0, -part * closing * wave))
    result = solved(body, rigid, 1e4 * MODULUS / wave).contact()
    phase = np.pi * result.x[:, 0] / wave
    if part >= 1:
        expected = closing * (part + np.cos(2 * phase))
    else:
        root = np.sqrt(np.maximum(part - np.sin(phase) ** 2, 0.0))
        expected = 2 * closing * np.abs(np.cos(phase)) * root
        half_width = wave / np.pi * np.arcsin(np.sqrt(part))
        assert result.area / 2 == pytest.approx(half_width, abs=wave / count)
    error = np.sqrt(np.mean((result.pressure - expected) ** 2) / np.mean(expected**2))
    assert error < 5e-3
    assert result.pressure.max() == pytest.approx(expected.max(), rel=1e-3)


def test_a_rigid_sphere_on_an_elastic_foundation():
    """BENCHMARKS 13, the layer alone: F = k π h² (3R − h)/3 on a body as good as rigid."""
    k, radius, depth = 50.0, 2.0, 0.5
    body = cd.AxisymmetricHalfSpace("bed", cd.Isotropic(1e10, 0.3), np.linspace(0, 1.6, 321))
    ball = cd.RigidBody("ball", cd.Sphere((0, radius), radius), displacement=(0, -depth), kinematics="axisymmetric")
    force = solved(body, ball, k).contact().force
    assert force == pytest.approx(k * np.pi * depth**2 * (3 * radius - depth) / 3, rel=5e-5)


# Each other, and what may not matter


def test_force_displacement_and_sides_say_the_same():
    loaded = solved(ground(), roll(force=10.0), 1e5)
    moved = solved(roll(moved=float(loaded.displacement("roll")[1])), ground(), 1e5)
    assert moved.contact().force == pytest.approx(10.0, rel=1e-8)
    peak = loaded.contact().pressure.max()
    assert moved.contact().pressure == pytest.approx(loaded.contact().pressure, abs=1e-7 * peak)
    assert moved.contact().normal == pytest.approx(-loaded.contact().normal)
    # The half-plane comes up instead of the roll coming down, by a number or under a force.
    depth = -float(loaded.displacement("roll")[1])
    lifted = solved(ground(displacement=depth), roll(), 1e5)
    assert lifted.contact().pressure == pytest.approx(loaded.contact().pressure, abs=1e-7 * peak)
    pushed = solved(ground(displacement=None, force=10.0), roll(), 1e5)
    assert pushed.displacement("ground")[0] == pytest.approx(depth, rel=1e-7)


def test_the_reference_changes_the_approach_alone():
    one, other = (solved(ground(reference=d), roll(force=10.0), 1e5) for d in (10.0, 1000.0))
    peak = one.contact().pressure.max()
    assert other.contact().pressure == pytest.approx(one.contact().pressure, abs=1e-8 * peak)
    further = one.displacement("roll")[1] - other.displacement("roll")[1]
    assert further == pytest.approx(10.0 * 2 / (np.pi * MODULUS) * np.log(100.0), rel=1e-8)


@pytest.mark.parametrize("method", ["auto", "newton-krylov", "newton-chord", "chord", "anderson"])
def test_every_method_takes_a_half_plane(method):
    found, expected = (
        solved(ground(), roll(force=10.0), 300.0, method=name, max_iterations=500) for name in (method, "newton")
    )
    peak = expected.contact().pressure.max()
    assert found.contact().pressure == pytest.approx(expected.contact().pressure, abs=1e-6 * peak)  # solved to 1e-10


def test_a_turned_scene_is_the_same():
    angle = 0.7
    normal = np.array([-np.sin(angle), np.cos(angle)])
    place = np.array([3.0, -2.0])
    turned = cd.HalfPlane("ground", SOFT, np.linspace(-1, 1, 61), 100.0, origin=place, normal=normal)
    rigid = cd.RigidBody("roll", cd.Cylinder(place + 10 * normal, 10.0), displacement=-0.05 * normal)
    found, expected = solved(turned, rigid, 1e5).contact(), solved(ground(), roll(moved=-0.05), 1e5).contact()
    assert found.pressure == pytest.approx(expected.pressure, abs=1e-9 * expected.pressure.max())


def test_units_do_not_matter():
    scale = 1e3
    expected = solved(ground(), roll(force=10.0), 1e5).contact()
    small = cd.HalfPlane("ground", cd.Isotropic(E * 1e-6, NU), np.linspace(-scale, scale, 61), 100.0 * scale)
    found = solved(small, roll(force=10.0 * 1e-6 * scale, radius=10.0 * scale), 1e5 * 1e-6 / scale).contact()
    assert found.pressure == pytest.approx(1e-6 * expected.pressure, abs=1e-14 * expected.pressure.max())


def test_plane_and_space_agree():
    """A long grid under a roll is the half-plane, in its middle."""
    space = cd.HalfSpace("ground", SOFT, (0.8, 12.0), (16, 60))
    bar = cd.RigidBody(
        "roll", cd.Cylinder((0, 0, 10), 10.0, axis=(0, 1, 0)), displacement=(0, 0, None), force=(0, 0, -10.0 * 12)
    )
    result = solved(space, bar, 1e5).contact()
    middle = np.abs(result.x[:, 1]) < 2.0
    per_length = result.weights[middle] @ result.pressure[middle] / 4.0
    # 60 rows of 0.2: of those within 2 the outermost end at 2; the pressure rises towards both ends.
    hertz = cd.reference.hertz_cylinder(per_length, 10.0, E, NU)
    assert per_length < 10.0
    assert result.pressure[middle].max() == pytest.approx(hertz.peak_pressure, rel=0.02)


def test_units_of_one_cell_do_not_matter_in_space():
    """Love's rectangles and rings of cones, both on the same ball: one force."""
    ring = cd.AxisymmetricHalfSpace("ground", SOFT, np.linspace(0, 1.2, 49))
    square = cd.HalfSpace("ground", SOFT, (2.4, 2.4), (28, 28))
    ball = cd.RigidBody("ball", cd.Sphere((0, 10), 10.0), displacement=(0, -0.1), kinematics="axisymmetric")
    solid = cd.RigidBody("ball", cd.Sphere((0, 0, 10), 10.0), displacement=(0, 0, -0.1))
    layer = 2e3  # about as stiff as the half-space
    forces = [solved(*pair, layer).contact().force for pair in ((ring, ball), (square, solid))]
    assert forces[1] == pytest.approx(forces[0], rel=2e-3)


def test_a_force_off_the_middle_turns_a_plate():
    """A plate on a half-plane under an eccentric force: its pressures carry the force where it acts."""
    plate = cd.RigidBody(
        "plate", cd.FlatPunch((0, 0), 0.5), displacement=(0, None), rotation=None, force=(0, -5.0), about=(0.1, 0)
    )
    solution = solved(ground(0.5, 41), plate, 1e4)
    assert solution.contact().centre_of_pressure[0] == pytest.approx(0.1, rel=1e-7)
    assert solution.displacement("plate")[2] < 0


def test_two_rolls_on_one_half_plane():
    body = cd.HalfPlane("ground", SOFT, np.linspace(-2, 2, 121), 100.0)
    rolls = [
        cd.RigidBody(name, cd.Cylinder((x, 10), 10.0), displacement=(0, None), force=(0, -10.0))
        for name, x in (("left", -1.0), ("right", 1.0))
    ]
    contacts = [cd.Contact(body, each, cd.LinearLayer(1e5)) for each in rolls]
    solution = cd.solve(cd.Scene([body, *rolls], contacts))
    alone = solved(ground(), roll(force=10.0), 1e5)
    left, right = (solution.displacement(name)[1] for name in ("left", "right"))
    assert left == pytest.approx(right, rel=1e-6)
    # Each sinks by what the other, 2 away, moves the surface: 2 F/(π E*) ln(100/2).
    sunk = float(alone.displacement("roll")[1]) - 20.0 / (np.pi * MODULUS) * np.log(100.0 / 2)
    assert left == pytest.approx(sunk, rel=2e-3)


def test_parameters_drive_a_half_plane():
    force = cd.Parameter(0.0)
    body, rigid = ground(displacement=None, force=force), roll()
    scene = cd.Scene([body, rigid], [cd.Contact(body, rigid, cd.LinearLayer(1e6))])
    path = cd.programme(scene, force, [2.5, 10.0], record={"peak": lambda s: s.contact().pressure.max()})
    assert path.records["peak"][1] / path.records["peak"][0] == pytest.approx(2.0, rel=0.02)  # Hertz: √F


# Finite elements


def foundation(size, **options):
    """A square of elements below y = 0, fine where the block stands."""
    fine = np.linspace(0, 0.5, 13)
    x = np.concatenate([fine[:-1], np.geomspace(0.5, size, 6 + 6 * int(np.log2(size)))])
    mesh = cd.rectangle(
        (-size, -size), (size, 0), (np.concatenate([-x[:0:-1], x]), -x[::-1]), shape="quadrilateral"
    )  # fmt: skip
    return cd.Body("ground", mesh, SOFT, supports=[cd.Fixed("bottom")], degree=2, **options)


def block():
    mesh = cd.rectangle((-0.5, 0), (0.5, 0.5), (24, 12), shape="quadrilateral")
    loads = [cd.Pressure("top", lambda x: 10 * (1 + x[0]))]
    return cd.Body("block", mesh, cd.Isotropic(3 * E, NU), loads=loads, degree=2)


def test_growing_foundations_tend_to_the_half_plane():
    """A meshed block, pressed unevenly: what it feels of a foundation of size H tends to the half-plane as H⁻²."""
    nodes = 0.5 * np.sin(0.5 * np.pi * np.linspace(-1, 1, 49))  # finer towards the block's edges
    half_plane = solved((block(), "bottom"), cd.HalfPlane("ground", SOFT, nodes, 100.0), E).contact()
    assert half_plane.force == pytest.approx(10.0, rel=1e-9)
    sizes = (2.0, 4.0, 8.0, 16.0)
    found = [solved((block(), "bottom"), (foundation(size), "top"), E).contact() for size in sizes]
    steps = [np.abs(b.pressure - a.pressure).max() for a, b in pairwise(found)]
    assert -np.polyfit(np.log(sizes[:-1]), np.log(steps), 1)[0] == pytest.approx(2.0, abs=0.15)
    last, expected = found[-1], half_plane.at(found[-1].x)["pressure"]
    error = np.sqrt(last.weights @ (last.pressure - expected) ** 2 / (last.weights @ expected**2))
    assert error < 2e-3  # what both discretisations leave at the edges; foundations of size 2 are 6e-3 away


@pytest.mark.parametrize("bonded", [True, False])
def test_strips_are_finite_elements_of_theirs(bonded):
    """A roll on a strip on a rigid base, meshed and by its Fourier kernel."""
    thickness, length = 0.5, 6.0
    x = np.concatenate([np.linspace(0, 0.6, 31)[:-1], np.linspace(0.6, length / 2, 21)])
    y = np.linspace(-thickness, 0, 13)
    mesh = cd.rectangle(
        (-length / 2, -thickness), (length / 2, 0), (np.concatenate([-x[:0:-1], x]), y), shape="quadrilateral"
    )  # fmt: skip
    supports = [cd.Fixed("bottom") if bonded else cd.Symmetry("bottom")]
    meshed = cd.Body("strip", mesh, SOFT, supports=supports, degree=2)
    kernel = cd.ElasticStrip("strip", SOFT, thickness, length, 300, bonded=bonded, origin=(-length / 2, 0))
    expected = solved((meshed, "top"), roll(moved=-0.01), 1e5).contact()
    found = solved(kernel, roll(moved=-0.01), 1e5).contact()
    assert found.force == pytest.approx(expected.force, rel=5e-3)
    assert found.pressure.max() == pytest.approx(expected.pressure.max(), rel=5e-3)


def test_a_block_on_the_half_space():
    mesh = cd.box((-0.5, -0.5, 0), (0.5, 0.5, 0.5), (6, 6, 3), shape="hexahedron")
    body = cd.Body("block", mesh, SOFT, loads=[cd.Pressure("top", 2.0)])
    space = cd.HalfSpace("ground", SOFT, (1.0, 1.0), (18, 18))
    one, other = solved((body, "bottom"), space, 1e4), solved(space, (body, "bottom"), 1e4)
    assert one.contact().force == pytest.approx(2.0, rel=1e-9)
    assert other.contact().pressure == pytest.approx(one.contact().pressure, abs=1e-7 * one.contact().pressure.max())
    assert one.imbalance < 1e-8
    # Symmetric about both middle planes, and higher towards the edges.
    pressure, x = one.contact().pressure, one.contact().x
    order, mirrored = (np.lexsort(np.round((sign * x[:, 0], x[:, 1]), 9)) for sign in (1, -1))
    assert pressure[order] == pytest.approx(pressure[mirrored], rel=1e-6)
    inner = np.linalg.norm(x[:, :2], axis=1) < 0.2
    assert pressure[inner].mean() < 2.0 < pressure.max()


# Words


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ground(reference=1.0), "reference = 1.0: expected at least the extent of the nodes, 2"),
        (lambda: cd.HalfPlane("g", SOFT, [0, 0, 1], 9), "nodes: expected .*each larger than the one before"),
        (lambda: cd.HalfPlane("g", cd.Isotropic(lambda x: x[0], 0.3), [0, 1], 9), "material = .*: expected a cd.Iso"),
        (lambda: ground(kinematics="axisymmetric"), "kinematics = 'axisymmetric': expected one of 'plane strain'"),
        (lambda: ground(displacement="up"), "displacement = 'up': expected a finite number"),
        (lambda: ground(force=np.nan), "force = nan: expected a finite number"),
        (lambda: ground(origin=(0, 0, 0)), "origin = .*: expected 2 numbers"),
        (lambda: cd.AxisymmetricHalfSpace("g", SOFT, [1, 2]), "nodes\\[0\\] = 1: expected radii from 0"),
        (lambda: cd.HalfSpace("g", SOFT, (1, 0), (4, 4)), "size = .*: expected two numbers > 0"),
        (lambda: cd.HalfSpace("g", SOFT, (1, 1), (4, 1)), "cells = .*: expected two whole numbers >= 2"),
        (lambda: cd.HalfSpace("g", SOFT, (1, 1), (100, 100)), "10000 rectangles; expected 8000 at most"),
        (lambda: cd.HalfSpace("g", SOFT, (1, 1), (4, 4), along=(0, 0, 1)), "along = .*not along the normal"),
        (lambda: cd.ElasticStrip("g", SOFT, 0, 1, 4), "thickness = 0: expected a number > 0"),
        (lambda: cd.PeriodicHalfPlane("g", SOFT, 1, 0), "count = 0: expected a whole number"),
    ],
)
def test_what_is_refused(make, message):
    with pytest.raises((ValueError, TypeError), match=message):
        make()


def test_contacts_that_reach_too_far_are_refused():
    with pytest.raises(
        ValueError, match=r"body 'ground': a contact reaches from -0.495304 to 0.495304 .* nodes from -0.2 to 0.2"
    ):
        solved((block(), "bottom"), ground(0.2), 1e3)
    with pytest.raises(ValueError, match=r"body 'ground': the surface opposite .* faces away"):
        solved((block(), "top"), ground(0.5), 1e3)


# What is told of a contact without meshes


def test_hard_contact_without_meshes():
    """No layer at all: Hertz, and no penetration."""
    hertz = cd.reference.hertz_cylinder(10.0, 10.0, E, NU)
    body, rigid = ground(1.5 * hertz.half_width), roll(force=10.0)
    result = cd.solve(cd.Scene([body, rigid], [cd.Contact(body, rigid, cd.HardContact())])).contact()
    assert result.force == pytest.approx(10.0, rel=1e-8)
    assert result.pressure.max() == pytest.approx(hertz.peak_pressure, rel=2e-3)
    assert result.penetration < 1e-8 * hertz.half_width**2 / 10.0
    stiff = solved(body, rigid, 1e7 * MODULUS / hertz.half_width).contact()
    assert result.pressure == pytest.approx(stiff.pressure, abs=1e-4 * hertz.peak_pressure)


def test_results_without_meshes(tmp_path):
    solution = solved(ground(), roll(force=10.0), 1e5)
    result = solution.contact()
    assert cd.load_solution(solution.save(tmp_path / "saved")).contact().force == pytest.approx(10.0)
    assert all(path.stat().st_size for path in solution.export(tmp_path / "exported"))
    solution.plot_contact(path=tmp_path / "contact.png")
    assert (tmp_path / "contact.png").stat().st_size > 5_000
    half_width = cd.reference.hertz_cylinder(10.0, 10.0, E, NU).half_width
    assert np.abs(result.edge[:, 0]) == pytest.approx(half_width, abs=2 / 60)
    assert result.at([[0.0, 0.0]])["pressure"] == pytest.approx(result.pressure.max(), rel=1e-3)
    assert "force 10" in repr(solution)
    assert solution.largest_strain == 0.0
    with pytest.raises(ValueError, match="degree = 4: neither body of the contact has facets"):
        solution.contact(degree=4)
    with pytest.raises(ValueError, match="no body of the scene has a mesh"):
        solution.plot_bodies()
    with pytest.raises(ValueError, match="neither body has elements, whose degree could be raised"):
        cd.error_estimate(solution)


def test_results_on_a_grid():
    ball = cd.RigidBody("ball", cd.Sphere((0, 0, 10), 10.0), displacement=(0, 0, -0.1))
    result = solved(cd.HalfSpace("ground", SOFT, (2.4, 2.4), (16, 16)), ball, 1e5).contact()
    assert result.at([[0.0, 0.0, 0.0]])["pressure"] == pytest.approx(result.pressure.max(), rel=0.02)
    assert result.corners.shape == (256, 4, 3)
    assert result.corners.mean(axis=1) == pytest.approx(result.x)


def test_checkpoints_without_meshes(tmp_path):
    file = tmp_path / "checkpoint.npz"
    body, rigid = ground(), roll(force=10.0)
    scene = cd.Scene([body, rigid], [cd.Contact(body, rigid, cd.LinearLayer(1e5))])
    stopped = cd.solve(scene, max_iterations=2, checkpoint=file, on_failure="return")
    assert not stopped.converged
    assert cd.solve(scene, checkpoint=file).contact().force == pytest.approx(10.0, rel=1e-8)


def test_ranks_agree_on_bodies_without_meshes():
    code = """
from mpi4py import MPI
import numpy as np
import contactdd as cd
soft = cd.Isotropic(1e3, 0.3)
plane = cd.HalfPlane("ground", soft, np.linspace(-1, 1, 61), 100.0)
roll = cd.RigidBody("roll", cd.Cylinder((0, 10), 10.0), displacement=(0, None), force=(0, -10.0))
space = cd.PeriodicHalfSpace("ground", soft, (1.0, 1.0), (16, 16))
plate = cd.RigidBody("plate", cd.Plane((0, 0, 0), (0, 0, -1)), displacement=(0, 0, None), force=(0, 0, -3.0))
wave = lambda x: 0.01 * (1 - np.cos(2 * np.pi * x[0]))
for pair, gap, force in (((plane, roll), 0.0, 10.0), ((space, plate), wave, 3.0)):
    contact = cd.Contact(*pair, cd.LinearLayer(1e4), gap=gap)
    solution = cd.solve(cd.Scene(pair, [contact], comm=MPI.COMM_WORLD))
    peaks = MPI.COMM_WORLD.allgather(solution.contact().pressure.max())
    assert len(peaks) == 2 and peaks[0] == peaks[1]
    assert abs(solution.contact().force - force) < 1e-8
"""
    done = launch(2, code)
    assert done.returncode == 0, done.stderr
