"""Rigid bodies on meshed ones: Hertz, elastic foundations, forces and moments, motions that parameters drive."""

from __future__ import annotations

import numpy as np
import pytest

import contactdd as cd

E, NU = 1e3, 0.3
SOFT = cd.Isotropic(E, NU)
STIFF = cd.Isotropic(1e12, 0.0)


def graded(fine, far, cells=24, growth=20):
    """Coordinates from 0: even up to `fine`, then ever longer steps up to `far`."""
    return np.concatenate([np.linspace(0, fine, cells + 1)[:-1], np.geomspace(fine, far, growth)])


def ring_block(fine=1.5, far=12.0):
    x = graded(fine, far)
    mesh = cd.rectangle((0, -far), (far, 0), (x, -x[::-1]), shape="quadrilateral")
    return cd.Body(
        "block",
        mesh,
        SOFT,
        supports=[cd.Symmetry("left"), cd.Fixed("bottom")],
        degree=2,
        kinematics="axisymmetric",
    )


def solved(body, rigid, layer, swapped=False, **options):
    sides = [(body, "top"), rigid]
    contact = cd.Contact(*(sides[::-1] if swapped else sides), layer)
    return cd.solve(cd.Scene([body, rigid], [contact]), **options)


def ball(force=None, moved=0.0, shape=None, radius=10.0):
    """A ball on an axis, under a force or moved."""
    return cd.RigidBody(
        "ball",
        shape or cd.Sphere((0, radius), radius),
        displacement=(0, moved if force is None else None),
        force=(0, -(force or 0.0)),
        kinematics="axisymmetric",
    )


LAYER = cd.LinearLayer(1e6)


def test_a_rigid_ball_is_hertz():
    hertz = cd.reference.hertz_sphere(140.0, 10.0, E, NU)
    result = solved(ring_block(), ball(force=140.0), LAYER).contact()
    assert hertz.radius == pytest.approx(1.0, rel=0.02)
    # The layer (k a/E* = 900), the finite block (12 a) and a ball that is no paraboloid (a/R = 0.1).
    assert result.force == pytest.approx(140.0, rel=1e-9)
    assert result.pressure.max() == pytest.approx(hertz.peak_pressure, rel=0.01)
    inner = result.x[:, 0] < 0.8 * hertz.radius
    assert result.pressure[inner] == pytest.approx(hertz.pressure(result.x[inner, 0]), rel=0.02)
    assert np.sqrt(result.area / np.pi) == pytest.approx(hertz.radius, rel=0.03)  # facets of a/16


def test_force_displacement_and_sides_say_the_same():
    loaded = solved(ring_block(), ball(force=140.0), LAYER)
    depth = float(loaded.displacement("ball")[0])
    assert depth < 0
    moved = solved(ring_block(), ball(moved=depth), LAYER, swapped=True)
    assert moved.contact().force == pytest.approx(140.0, rel=1e-8)  # both are solved to 1e-10
    # Action and reaction, and what holds the ball.
    assert moved.forces("ball")["contact"] == pytest.approx([0.0, 140.0], rel=1e-8)
    assert moved.forces("ball")["supports"] == pytest.approx([0.0, -140.0], rel=1e-8)
    assert moved.forces("block")["contact"] == pytest.approx([0.0, -140.0], rel=1e-8)
    assert loaded.forces("ball")["loads"].tolist() == [0.0, -140.0]
    peak = loaded.contact().pressure.max()
    assert moved.contact().pressure == pytest.approx(loaded.contact().pressure, abs=1e-7 * peak)
    assert max(loaded.imbalance, moved.imbalance) < 1e-8


@pytest.mark.parametrize("method", ["auto", "newton-krylov", "newton-chord", "chord", "anderson"])
def test_every_method_takes_a_rigid_body(method):
    layer = cd.PowerLayer(1e-3, 1.1)  # soft enough for the plain chord
    found, expected = (
        solved(ring_block(), ball(moved=-0.15), layer, method=name, max_iterations=400).contact().pressure
        for name in (method, "newton")
    )
    assert found == pytest.approx(expected, abs=1e-6 * expected.max())


def test_one_ball_however_it_is_described():
    shapes = [
        cd.Sphere((0, 10), 10.0),
        cd.Profile(lambda r: 10 - np.sqrt(np.maximum(100 - r**2, 0))),
        cd.LevelSet(lambda x: np.hypot(x[0], x[1] - 10) - 10, (0, 10), reach=20.0),
    ]
    pressures = [
        solved(ring_block(far=8.0), ball(moved=-0.1, shape=shape), LAYER).contact().pressure for shape in shapes
    ]
    for other in pressures[1:]:
        assert other == pytest.approx(pressures[0], abs=1e-8 * pressures[0].max())
    points = np.column_stack([np.linspace(0, 9, 400), 10 - np.sqrt(100 - np.linspace(0, 9, 400) ** 2)])
    measured = solved(ring_block(far=8.0), ball(moved=-0.1, shape=cd.Profile(points)), LAYER).contact().pressure
    # Points 0.02 apart leave gaps of about 1e-7 against a depth of 0.1, the layer of 1e6 makes 0.1 of them.
    assert measured == pytest.approx(pressures[0], abs=5e-3 * pressures[0].max())


def test_a_meshed_shape_presses_like_the_round_one():
    """A cylinder of facets h long on a bed of springs: F and where it presses, to (h/R)² of the depth."""
    angle = np.linspace(-0.2, 0.2, 81) - np.pi / 2
    circle = np.column_stack([np.cos(angle), np.sin(angle) + 1]) * 10.0
    mesh = cd.rectangle((-1.5, -1), (1.5, 0), (60, 2), shape="quadrilateral")
    body = cd.Body("bed", mesh, STIFF, supports=[cd.Fixed("bottom")])
    shapes = [cd.FacetedSurface(np.stack([circle[:-1], circle[1:]], axis=1)), cd.Cylinder((0, 10), 10.0)]
    rolls = [cd.RigidBody("roll", shape, displacement=(0, -0.05), about=(0, 10)) for shape in shapes]
    faceted, round_ = (solved(body, each, cd.LinearLayer(100.0)).contact() for each in rolls)
    assert faceted.force == pytest.approx(round_.force, rel=1e-3)  # h = 0.05: gaps of h²/(8R) = 3e-5 against 0.05
    assert faceted.force < round_.force


def test_a_rigid_ball_on_an_elastic_foundation():
    """F = k π h² (3R − h)/3 of the ball, not the paraboloid, on a bed of springs (BENCHMARKS 13)."""
    k, radius, depth = 50.0, 2.0, 0.5
    mesh = cd.rectangle((0, -1), (1.6, 0), (400, 1), shape="quadrilateral")
    supports = [cd.Fixed("bottom"), cd.Symmetry("left")]
    body = cd.Body("bed", mesh, STIFF, supports=supports, kinematics="axisymmetric")
    sphere = ball(moved=-depth, radius=radius)
    force = solved(body, sphere, cd.LinearLayer(k)).contact().force
    # Gauss points feel the kink at the edge of contact by the square of a cell.
    assert force == pytest.approx(k * np.pi * depth**2 * (3 * radius - depth) / 3, rel=1e-4)
    mesh = cd.box((0, 0, -1), (1.6, 1.6, 0), (40, 40, 1), shape="hexahedron")
    quarter = cd.Body("bed", mesh, STIFF, supports=[cd.Fixed("bottom")])
    sphere = cd.RigidBody("ball", cd.Sphere((0, 0, radius), radius), displacement=(0, 0, -depth))
    found = (
        cd.solve(cd.Scene([quarter, sphere], [cd.Contact((quarter, "top"), sphere, cd.LinearLayer(k))])).contact().force
    )
    assert 4 * found == pytest.approx(force, rel=1e-3)


@pytest.mark.parametrize("given", ["force", "moment"])
def test_a_plate_on_springs_tilts(given):
    """A force off the middle of a rigid plate of width 2b on springs k: depth F/(2bk), rotation F e/(k (2b)³/12)."""
    k, force, e, b = 100.0, 10.0, 0.1, 1.0
    mesh = cd.rectangle((-b, -1), (b, 0), (8, 4), shape="quadrilateral")
    body = cd.Body("bed", mesh, STIFF, supports=[cd.Fixed("bottom")])
    about, moment = ((e, 0), 0.0) if given == "force" else ((0, 0), -force * e)
    options = {"displacement": (0, None), "rotation": None, "force": (0, -force), "moment": moment, "about": about}
    plate = cd.RigidBody("plate", cd.Plane((0, 0), (0, -1)), **options)
    solution = solved(body, plate, cd.LinearLayer(k))
    turn = -force * e / (k * (2 * b) ** 3 / 12)
    depth = -force / (2 * b * k) + turn * about[0]
    assert solution.displacement("plate") == pytest.approx([0.0, depth, turn], rel=1e-8)
    held = cd.RigidBody("plate", cd.Plane((0, 0), (0, -1)), displacement=(0, depth), rotation=turn, about=about)
    assert solved(body, held, cd.LinearLayer(k)).contact().force == pytest.approx(force, rel=1e-7)


def test_a_plate_in_space_tilts():
    k, force, b = 100.0, 10.0, (1.0, 1.5)
    mesh = cd.box((-b[0], -b[1], -1), (b[0], b[1], 0), (4, 6, 2), shape="hexahedron")
    body = cd.Body("bed", mesh, STIFF, supports=[cd.Fixed("bottom")])
    plate = cd.RigidBody(
        "plate", cd.Plane((0, 0, 0), (0, 0, -1)), displacement=(0, 0, None), rotation=(None, None, 0),
        force=(0, 0, -force), about=(0.1, 0.2, 0.0),
    )  # fmt: skip
    solution = cd.solve(cd.Scene([body, plate], [cd.Contact((body, "top"), plate, cd.LinearLayer(k))]))
    area = 4 * b[0] * b[1]
    about_x = -force * 0.2 / (k * area * (2 * b[1]) ** 2 / 12)
    about_y = force * 0.1 / (k * area * (2 * b[0]) ** 2 / 12)
    depth = -force / (k * area) + about_x * 0.2 - about_y * 0.1
    assert solution.displacement("plate") == pytest.approx([0, 0, depth, about_x, about_y, 0], rel=1e-7, abs=1e-12)
    assert solution.contact().centre_of_pressure[:2] == pytest.approx([0.1, 0.2], rel=1e-7)


def test_a_cylinder_in_space_is_one_in_the_plane():
    x, z = np.concatenate([-graded(1, 6, 6, 6)[:0:-1], graded(1, 6, 6, 6)]), -graded(1, 6, 6, 6)[::-1]
    flat = cd.rectangle((-6, -6), (6, 0), (x, z), shape="quadrilateral")
    solid = cd.box((-6, 0, -6), (6, 1, 0), (x, np.array([0.0, 1.0]), z), shape="hexahedron")
    bodies = [
        cd.Body("block", flat, SOFT, supports=[cd.Fixed("bottom")]),
        cd.Body("block", solid, SOFT, supports=[cd.Fixed("bottom"), cd.Symmetry("front", "back")]),
    ]
    rolls = [
        cd.RigidBody("roll", cd.Cylinder((0, 10), 10.0), displacement=(0, -0.1)),
        cd.RigidBody("roll", cd.Cylinder((0, 0, 10), 10.0, axis=(0, 1, 0)), displacement=(0, 0, -0.1)),
    ]
    plane, space = (solved(*pair, cd.LinearLayer(1e4)).contact() for pair in zip(bodies, rolls, strict=True))
    # Both meshes and rules are the same along x.
    assert space.force == pytest.approx(plane.force, rel=1e-8)
    assert space.pressure.max() == pytest.approx(plane.pressure.max(), rel=1e-8)


def test_parameters_drive_a_rigid_body():
    depth = cd.Parameter(0.0)
    body, moving = ring_block(far=8.0), ball(moved=depth)
    scene = cd.Scene([body, moving], [cd.Contact((body, "top"), moving, LAYER)])
    path = cd.programme(scene, depth, [-0.05, -0.1, -0.2], record={"force": lambda s: s.contact().force})
    alone = solved(ring_block(far=8.0), ball(moved=-0.2), LAYER)
    assert path.records["force"][-1] == pytest.approx(alone.contact().force, rel=1e-8)
    # F ~ depth^(3/2) on a half-space; the block is finite and stiffens it.
    rates = np.diff(np.log(path.records["force"])) / np.log(2)
    assert rates == pytest.approx(1.5, abs=0.1)
    force = cd.Parameter([0.0, 0.0])
    loaded = cd.RigidBody(
        "ball", cd.Sphere((0, 10), 10.0), displacement=(0, None), force=force, kinematics="axisymmetric"
    )
    scene = cd.Scene([body, loaded], [cd.Contact((body, "top"), loaded, LAYER)])
    path = cd.programme(scene, force, [[0, -f] for f in path.records["force"]])
    assert [float(s.displacement("ball")[0]) for s in path.solutions] == pytest.approx([-0.05, -0.1, -0.2], rel=1e-7)


def test_a_seat_takes_a_shaft():
    """An elastic ring pressed evenly by a rigid shaft that is too thick: Lamé."""
    inner, outer, over = 1.0, 2.0, 1e-3
    mesh = cd.rectangle((inner, 0), (outer, 0.5), (40, 4), shape="quadrilateral")
    tube = cd.Body("tube", mesh, SOFT, supports=[cd.Symmetry("bottom", "top")], kinematics="axisymmetric", degree=2)
    shaft = cd.RigidBody(
        "shaft", cd.Profile(lambda z: np.full_like(z, inner + over), axis=0, body="below"), kinematics="axisymmetric"
    )
    k = 1e7
    result = cd.solve(cd.Scene([tube, shaft], [cd.Contact((tube, "left"), shaft, cd.LinearLayer(k))])).contact()
    soft = (1 + NU) / E * inner * ((1 - 2 * NU) * inner**2 + outer**2) / (outer**2 - inner**2) + 1 / k
    assert result.pressure == pytest.approx(over / soft, rel=1e-6)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"displacement": (0, 0, 0)}, "displacement = .*: expected 2 finite numbers"),
        ({"displacement": "down"}, "displacement = 'down': expected 2 finite numbers"),
        ({"force": (0, None)}, "force = .*: expected 2 finite numbers"),
        ({"force": 3.0}, "force = 3.0: expected 2 finite numbers"),
        ({"rotation": np.inf}, "rotation = inf: expected a finite number"),
        ({"about": (0, 0, 0)}, "about = .*: expected 2 numbers"),
        ({"kinematics": "solid"}, "kinematics = 'solid': the shape has 2 coordinates"),
        ({"kinematics": "axisymmetric", "displacement": (1, 0)}, "a ring moves along its axis only"),
        ({"kinematics": "axisymmetric", "moment": 1.0}, "moment = 1.0: a body of revolution does not turn"),
    ],
)
def test_what_is_refused(options, message):
    with pytest.raises((ValueError, TypeError), match=message):
        cd.RigidBody("ball", cd.Sphere((0, 1), 1.0), **options)


def test_what_else_is_refused():
    with pytest.raises(TypeError, match=r"shape = 3: expected a shape"):
        cd.RigidBody("ball", 3)
    ball, plane = cd.RigidBody("ball", cd.Sphere((0, 1), 1.0)), cd.RigidBody("plane", cd.Plane((0, 0), (0, 1)))
    with pytest.raises(ValueError, match="expected one with a mesh, or with points of its own"):
        cd.Contact(ball, plane, LAYER)
    parameter = cd.Parameter([0.0, -1.0])
    moving = cd.RigidBody("ball", cd.Sphere((0, 10), 10.0), displacement=parameter)
    parameter.value = 3.0
    with pytest.raises(ValueError, match=r"displacement = .*: expected 2 finite numbers"):
        moving.prescribed()


def test_shapes_that_lie_opposite_nothing_are_refused():
    """A punch beside the block, or a plane with its normal the wrong way round, is no open contact but a mistake."""
    block = cd.Body("block", cd.rectangle((0, -1), (1, 0), (4, 4)), SOFT, supports=[cd.Fixed("bottom")])
    for shape in (cd.FlatPunch((100, 1), 1.0), cd.Plane((0, 0), (0, 1)), cd.LevelSet(lambda x: 5 - x[1], (0, 5), 1.0)):
        with pytest.raises(ValueError, match=r"body 'tool': from none of the contact's \d+ points"):
            solved(block, cd.RigidBody("tool", shape), LAYER)


def test_nothing_holds_a_ball_that_is_pulled():
    lifted = cd.RigidBody("tool", cd.Plane((0, 0), (0, -1)), displacement=(0, None), force=(0, 1.0))
    block = cd.Body("block", cd.rectangle((0, -1), (1, 0), (4, 4)), SOFT, supports=[cd.Fixed("bottom")])
    with pytest.raises(cd.ContactError):
        solved(block, lifted, LAYER)
