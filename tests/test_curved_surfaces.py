"""Curved contact surfaces whose facets do not match: the gap is that of the smooth surfaces behind the facets."""

import warnings

import gmsh
import numpy as np
import pytest
from dolfinx import mesh as dmesh
from mpi4py import MPI

import contactdd as cd
from contactdd.interface.discretise import discretise
from contactdd.interface.smooth import smoothed
from contactdd.interface.surface import ContactSurface
from contactdd.quadrature import find_quadrature

E, NU, LAYER, MISFIT = 2.1e5, 0.3, 1e6, 0.0025
BORE, SEAT, RIM = 10.0, 20.0, 30.0

KINDS = {"triangle": dmesh.CellType.triangle, "quadrilateral": dmesh.CellType.quadrilateral}


def arc(inner, outer, cells, shape="quadrilateral", span=0.5 * np.pi, turned=0.0):
    """A ring's sector of straight cells, `cells` along the arc."""
    domain = dmesh.create_rectangle(MPI.COMM_SELF, [[inner, 0.0], [outer, span]], [5, cells], KINDS[shape])
    surfaces = {
        "inside": lambda x: np.isclose(x[0], inner),
        "outside": lambda x: np.isclose(x[0], outer),
        "low": lambda x: np.isclose(x[1], 0.0),
        "high": lambda x: np.isclose(x[1], span),
    }
    mesh = cd.from_dolfinx(domain, **surfaces)
    x = domain.geometry.x
    radius, angle = x[:, 0].copy(), x[:, 1] + turned
    x[:, 0], x[:, 1] = radius * np.cos(angle), radius * np.sin(angle)
    return cd.Mesh(domain, mesh.surfaces)


def fit(cells, shape="quadrilateral", kinematics="plane stress", swapped=False, layer=LAYER, **contact):
    """A shaft pressed into a hub, a quarter of each."""
    shaft, hub = (
        cd.Body(
            name,
            arc(*radii, count, shape),
            cd.Isotropic(E, NU),
            supports=[cd.Symmetry("low", "high")],
            kinematics=kinematics,
        )
        for name, radii, count in (("shaft", (BORE, SEAT), cells[0]), ("hub", (SEAT, RIM), cells[1]))
    )
    sides = [(shaft, "outside"), (hub, "inside")]
    contact = {"gap": -MISFIT, **contact}
    return cd.Scene([shaft, hub], [cd.Contact(*sides[:: -1 if swapped else 1], cd.LinearLayer(layer), **contact)])


def lame(kinematics="plane stress", layer=LAYER):
    """The pressure of the press fit: Lamé's two rings and the layer in series."""
    modulus, nu = (E, NU) if kinematics == "plane stress" else (E / (1 - NU**2), NU / (1 - NU))
    shaft = SEAT / modulus * ((SEAT**2 + BORE**2) / (SEAT**2 - BORE**2) - nu)
    hub = SEAT / modulus * ((RIM**2 + SEAT**2) / (RIM**2 - SEAT**2) + nu)
    return MISFIT / (shaft + hub + 1 / layer)


# ------------------------------------------------------------------------------------------------- Lamé's press fits


@pytest.mark.parametrize("kinematics", ["plane stress", "plane strain"])
@pytest.mark.parametrize("cells", [(12, 17), (12, 24), (24, 34), (17, 12)])
def test_a_press_fit_of_straight_facets_has_lames_pressure_everywhere(cells, kinematics):
    """The sagitta of twelve cells, 0.043 mm, is seventeen times the interference."""
    result = cd.solve(fit(cells, kinematics=kinematics)).contact()
    # Five linear cells across each ring: 0.2 % by themselves, as on meshes that match.
    assert np.abs(result.pressure / lame(kinematics) - 1).max() < 5e-3


def test_a_press_fit_of_triangles_is_right_but_at_the_ends():
    """Triangles that meet at a symmetry plane differ from each other: matching meshes have 6 % there."""
    result = cd.solve(fit((24, 34), "triangle")).contact()
    angle = np.arctan2(result.x[:, 1], result.x[:, 0])
    inner = np.abs(angle - np.pi / 4) < 0.9 * np.pi / 4
    assert np.abs(result.pressure[inner] / lame() - 1).max() < 0.02
    assert np.abs(result.pressure / lame() - 1).max() < 0.07


def test_measured_and_given_gap_of_zero_are_the_same():
    measured, given = (cd.solve(fit((12, 17), measure_gap=measure)).contact() for measure in (True, False))
    assert np.abs(measured.pressure - given.pressure).max() < 1e-6 * lame()


def test_a_misfit_that_is_drawn_is_measured():
    """The shaft is drawn too large by the interference; small strains tell 1e-4 of it from one that is given."""
    shaft = cd.Body(
        "shaft",
        arc(BORE, SEAT + MISFIT, 12),
        cd.Isotropic(E, NU),
        supports=[cd.Symmetry("low", "high")],
        kinematics="plane stress",
    )
    hub = cd.Body(
        "hub", arc(SEAT, RIM, 17), cd.Isotropic(E, NU), supports=[cd.Symmetry("low", "high")], kinematics="plane stress"
    )
    scene = cd.Scene([shaft, hub], [cd.Contact((shaft, "outside"), (hub, "inside"), cd.LinearLayer(LAYER))])
    assert scene.interfaces[0].geometric_gap == pytest.approx(-MISFIT, rel=1e-6)  # of two circles fitted to nodes
    assert cd.solve(scene).contact().pressure == pytest.approx(lame(), rel=5e-3)


def test_exchanged_bodies_have_the_same_pressure():
    here, there = (cd.solve(fit((12, 17), swapped=swapped)).contact() for swapped in (False, True))
    assert here.force == pytest.approx(there.force, rel=1e-9)
    assert here.pressure.max() == pytest.approx(there.pressure.max(), rel=1e-8)


def test_a_function_as_gap_is_asked_on_the_smooth_surface():
    """d = r − 20: on the facets' chords that is the sagitta, on the circles zero; also where meshes match."""
    for cells in ((12, 17), (12, 12)):
        interface = fit(cells, gap=lambda x: np.hypot(x[0], x[1]) - SEAT).interfaces[0]
        assert np.abs(interface.gap).max() < 1e-9 * SEAT


def test_meshes_that_match_are_not_touched():
    """Facet opposite facet: x stays on the facets and the gap is exactly none."""
    interface = fit((12, 12)).interfaces[0]
    assert interface.facets is not None
    assert np.all(interface.geometric_gap == 0.0)
    radius = np.hypot(*interface.x.T)
    assert radius.min() < SEAT * np.cos(np.pi / 48) * (1 + 1e-3)


# ------------------------------------------------------------------------------------------------- other curves, rates


def measured_gap(lower, upper, cells, reach=1.0):
    """The measured gap between the graphs y = lower(x) and y = upper(x), its points."""
    below, above = cd.rectangle((0, -1), (2, 0), (cells[0], 1)), cd.rectangle((0, 0), (2, 1), (cells[1], 1))
    for mesh, curve, at in ((below, lower, 0.0), (above, upper, 0.0)):
        x = mesh.domain.geometry.x
        edge = np.isclose(x[:, 1], at)
        x[edge, 1] = curve(x[edge, 0])
    bodies = [
        cd.Body(n, cd.Mesh(m.domain, m.surfaces), cd.Isotropic(1.0, 0.0)) for n, m in (("a", below), ("b", above))
    ]
    contact = cd.Contact((bodies[0], "top"), (bodies[1], "bottom"), cd.LinearLayer(1.0), search_distance=reach)
    return discretise(contact, (0, 1))


def test_the_gap_of_a_wave_falls_faster_than_the_sagitta():
    """y = 0.1 cos 2x on both sides. The facets' sagitta falls as h², what is left of it as h³: near the inflection
    points a facet sees the curvature change by more than it is."""
    wave = lambda x: 0.1 * np.cos(2 * x)  # noqa: E731
    errors = [np.abs(measured_gap(wave, wave, (n, int(1.4 * n))).geometric_gap).max() for n in (20, 40, 80)]
    sagitta = 0.4 * (2 / 20) ** 2 / 8
    assert errors[0] < 0.4 * sagitta
    assert np.all(np.log2(np.array(errors[:-1]) / errors[1:]) > 2.6)


def test_flat_surfaces_cost_nothing_and_stay_as_they_are():
    flat = measured_gap(lambda x: 0 * x, lambda x: 0 * x + 0.01, (7, 11))
    for side in flat.sides:
        assert smoothed(side.surface) is None
    assert np.abs(flat.geometric_gap - 0.01).max() < 1e-15
    inclined = measured_gap(lambda x: 0.3 * x, lambda x: 0.3 * x, (7, 11))
    assert np.all(inclined.geometric_gap == 0.0)


NOTCH = {
    "notch": lambda x: -0.1 * np.clip(1 - np.abs(x - 1) / 0.1, 0, 1),
    "step": lambda x: 0.05 * np.clip((x - 1) / 0.1, 0, 1),
    "wedge": lambda x: -0.1 * np.abs(x - 1),
    "trapezoid": lambda x: -0.05 * np.clip(2 - np.abs(x - 1) / 0.1, 0, 1),
}


@pytest.mark.parametrize("shape", NOTCH)
def test_shapes_of_the_size_of_a_facet_are_not_smoothed_away(shape):
    """Vertical distances: all points of the profile are where its straight facets are."""
    interface = measured_gap(NOTCH[shape], lambda x: 0 * x + 0.2, (20, 33))
    assert np.abs(interface.x[:, 1] - NOTCH[shape](interface.x[:, 0])).max() < 1e-12


@pytest.mark.parametrize("size", [1e-2, 3e-3, 1e-4])
@pytest.mark.parametrize("seed", range(3))
def test_a_rough_profile_stays_as_it_is_meshed(size, seed):
    """Heights by chance, as large as the facets or a hundredth of that, explain no curve: a few facets look like one by
    chance (1 % of the fits), and none is moved by more than its roughness."""
    heights = size * np.random.default_rng(seed).standard_normal(201)
    nodes = np.linspace(0, 2, 201)
    rough = lambda x: np.interp(x, nodes, heights)  # noqa: E731
    interface = measured_gap(rough, lambda x: 0 * x + 0.2, (200, 3))
    off = np.abs(interface.x[:, 1] - rough(interface.x[:, 0]))
    assert np.mean(off > 1e-12) < 0.07
    assert off.max() < size


def test_beside_a_crease_the_curve_is_seen_from_one_side():
    """Two arcs that meet at an angle: the gap to their copy of another mesh is as small as without the crease."""
    arcs = lambda x: 0.05 * (np.abs(x - 1) - 1) ** 2  # noqa: E731
    error = np.abs(measured_gap(arcs, arcs, (20, 30)).geometric_gap).max()
    assert error < 1e-2 * 0.1 * (2 / 20) ** 2 / 8  # a hundredth of the sagitta


# ------------------------------------------------------------------------------------------------- order 2, space


def sector(inner, outer, cells, order, dim):
    """A quarter of a ring of `cells` cells along the arc, curved with its order, in space 5 high."""
    gmsh.initialize(["x", "-v", "1"], interruptible=False)
    geo = gmsh.model.geo
    centre = geo.addPoint(0, 0, 0)
    p = [geo.addPoint(*xy, 0) for xy in ((inner, 0), (outer, 0), (0, outer), (0, inner))]
    lines = [
        geo.addLine(p[0], p[1]),
        geo.addCircleArc(p[1], centre, p[2]),
        geo.addLine(p[2], p[3]),
        geo.addCircleArc(p[3], centre, p[0]),
    ]
    face = geo.addPlaneSurface([geo.addCurveLoop(lines)])
    for line, count in zip(lines, (5, cells, 5, cells), strict=True):
        geo.mesh.setTransfiniteCurve(line, count + 1)
    geo.mesh.setTransfiniteSurface(face)
    geo.mesh.setRecombine(2, face)
    names = ["low", "outside", "high", "inside"]
    groups = dict(zip(names, ([line] for line in lines), strict=True))
    body = face
    if dim == 3:
        out = geo.extrude([(2, face)], 0, 0, 5, [2], recombine=True)
        body = out[1][1]
        groups = {"foot": [face]} | dict(zip(names, ([tag] for _, tag in out[2:]), strict=True))
    geo.synchronize()
    gmsh.model.addPhysicalGroup(dim, [body], name="ring")
    for name, tags in groups.items():
        gmsh.model.addPhysicalGroup(dim - 1, tags, name=name)
    gmsh.model.mesh.generate(dim)
    gmsh.model.mesh.setOrder(order)
    mesh = cd.from_gmsh(gmsh.model, dim)
    gmsh.finalize()
    return mesh


@pytest.mark.parametrize(("order", "dim", "tolerance"), [(2, 2, 1e-3), (1, 3, 1e-2), (2, 3, 2e-3)])
def test_press_fits_in_space_and_of_second_order(order, dim, tolerance):
    """Off by what meshes that match are off by: curved cells 0.1 %, in space with their ends free 0.2 %."""
    planes = ["low", "high"] + (["foot"] if dim == 3 else [])
    shaft, hub = (
        cd.Body(
            name,
            sector(*radii, cells, order, dim),
            cd.Isotropic(E, NU),
            supports=[cd.Symmetry(*planes)],
            degree=order,
            kinematics="plane stress" if dim == 2 else None,
        )
        for name, radii, cells in (("shaft", (BORE, SEAT), 12), ("hub", (SEAT, RIM), 17))
    )
    contact = cd.Contact((shaft, "outside"), (hub, "inside"), cd.LinearLayer(LAYER), gap=-MISFIT)
    scene = cd.Scene([shaft, hub], [contact])
    assert np.abs(scene.interfaces[0].geometric_gap).max() < 1e-9 * SEAT
    result = cd.solve(scene).contact()
    assert result.force / result.weights.sum() == pytest.approx(lame(), rel=tolerance)
    assert result.pressure == pytest.approx(lame(), rel=0.02 if order == 1 else 2e-3)


def ball(inner, outer, size, order):
    """An eighth of a hollow ball of tetrahedra."""
    gmsh.initialize(["x", "-v", "1"], interruptible=False)
    occ = gmsh.model.occ
    spheres = [occ.addSphere(0, 0, 0, r, -1, 0, 0.5 * np.pi, 0.5 * np.pi) for r in (outer, inner)]
    cut, _ = occ.cut([(3, spheres[0])], [(3, spheres[1])])
    occ.synchronize()
    gmsh.model.addPhysicalGroup(3, [cut[0][1]], name="shell")
    for _, tag in gmsh.model.getEntities(2):
        box = np.array(gmsh.model.getBoundingBox(2, tag))
        if gmsh.model.getType(2, tag) == "Plane":
            name = "xyz"[int(np.argmin(box[3:] - box[:3]))]
        else:
            name = "inside" if box[3:].max() < 0.5 * (inner + outer) else "outside"
        gmsh.model.addPhysicalGroup(2, [tag], name=name)
    gmsh.option.setNumber("Mesh.MeshSizeMin", size)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(order)
    mesh = cd.from_gmsh(gmsh.model, 3)
    gmsh.finalize()
    return mesh


@pytest.mark.parametrize(("order", "size", "tolerance"), [(1, 0.2, 0.03), (2, 0.3, 0.01)])
def test_a_ball_in_a_shell_has_lames_pressure(order, size, tolerance):
    """Hollow balls 0.5, 1 and 1, 1.5, pressed by 0.0025: the sagitta of facets of 0.2 is twice that."""
    inner, seat, outer, layer = 0.5, 1.0, 1.5, 1e5

    def yielding(free):
        return seat / E * ((1 - 2 * NU) * seat**3 + 0.5 * (1 + NU) * free**3) / abs(free**3 - seat**3)

    exact = MISFIT / (yielding(inner) + yielding(outer) + 1 / layer)
    bodies = [
        cd.Body(n, ball(*r, h, order), cd.Isotropic(E, NU), degree=order, supports=[cd.Symmetry("x", "y", "z")])
        for n, r, h in (("ball", (inner, seat), size), ("shell", (seat, outer), 0.8 * size))
    ]
    sides = [(bodies[0], "outside"), (bodies[1], "inside")]
    scene = cd.Scene(bodies, [cd.Contact(*sides, cd.LinearLayer(layer), gap=-MISFIT)])
    assert np.abs(scene.interfaces[0].geometric_gap).max() < 1e-3 * MISFIT
    result = cd.solve(scene).contact()
    assert result.pressure == pytest.approx(exact, rel=tolerance)


def turned(mesh, rotation):
    mesh.domain.geometry.x[:, : mesh.dim] = mesh.domain.geometry.x[:, : mesh.dim] @ rotation.T
    return cd.Mesh(mesh.domain, mesh.surfaces)


def test_a_turned_cylinder_has_the_same_normals_and_patches():
    rotation = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    shapes = []
    for turn in (np.eye(3), rotation):
        body = cd.Body("a", turned(sector(BORE, SEAT, 9, 1, 3), turn), cd.Isotropic(E, NU))
        surface = ContactSurface(body, "outside", find_quadrature("gauss", 1))
        shapes.append(smoothed(surface))
    assert np.abs(shapes[1].slopes - shapes[0].slopes).max() < 1e-9 * SEAT
    assert np.abs(shapes[1].tilt - shapes[0].tilt @ rotation.T).max() < 1e-9
    assert len(shapes[0].glides) == len(shapes[1].glides) == 2  # a cylinder turns and shifts along itself


# ------------------------------------------------------------------------------------------------- varying pressure


@pytest.mark.parametrize(
    ("shape", "cells", "tolerance"), [("quadrilateral", (24, 34), 2e-3), ("quadrilateral", (48, 68), 1e-3)]
)
def test_two_rings_under_a_pressure_that_varies(shape, cells, tolerance):
    """code_aster's SSNP167 with a layer between: outside 1e7 + 1e5 cos 2θ, plane strain, k = 1e9: 6.11413e6 +
    121967 cos 2θ. The right amplitude needs normal pressure and no shear from facets that slide on each other."""
    young, nu = 1e9, 0.2
    inner, outer = (
        cd.Body(
            name,
            arc(*radii, count, shape),
            cd.Isotropic(young, nu),
            supports=[cd.Symmetry("low", "high")],
            loads=loads,
        )
        for name, radii, count, loads in (
            ("inner", (0.2, 0.6), cells[0], []),
            ("outer", (0.6, 1.0), cells[1], [cd.Pressure("outside", _wavering)]),
        )
    )
    result = cd.solve(
        cd.Scene([inner, outer], [cd.Contact((inner, "outside"), (outer, "inside"), cd.LinearLayer(1e9))])
    ).contact()
    double = 2 * np.arctan2(result.x[:, 1], result.x[:, 0])
    mean = result.force / result.weights.sum()
    amplitude = 2 * (result.weights * result.pressure) @ np.cos(double) / result.weights.sum()
    assert mean == pytest.approx(6.11413e6, rel=tolerance)
    assert amplitude == pytest.approx(121967, rel=tolerance)


def _wavering(x):
    return 1e7 + 1e5 * np.cos(2 * np.arctan2(x[1], x[0]))


# ------------------------------------------------------------------------------------------------- pins, warnings


def disc(radius, hole, size, order):
    """A full ring or, without a hole, a disc, of triangles."""
    gmsh.initialize(["x", "-v", "1"], interruptible=False)
    occ = gmsh.model.occ
    tag = occ.addDisk(0, 0, 0, radius, radius)
    if hole:
        tag = occ.cut([(2, tag)], [(2, occ.addDisk(0, 0, 0, hole, hole))])[0][0][1]
        occ.rotate([(2, tag)], 0, 0, 0, 0, 0, 1, 0.1)
    occ.synchronize()
    gmsh.model.addPhysicalGroup(2, [tag], name="volume")
    for _, edge in gmsh.model.getEntities(1):
        far = max(abs(v) for v in gmsh.model.getBoundingBox(1, edge)) > (radius + hole) / 2
        gmsh.model.addPhysicalGroup(1, [edge], name="rim" if far else "bore")
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(order)
    mesh = cd.from_gmsh(gmsh.model)
    gmsh.finalize()
    return mesh


@pytest.mark.parametrize("order", [1, 2, 3])
def test_a_pin_in_a_hole_turns_without_resistance_and_does_not_turn(order):
    """Clearance 0.05, its own weight: nothing tells the pin's angle, so it is none; the contact carries the weight."""
    steel, weight = cd.Isotropic(2.1e5, 0.3), 100.0
    pin = cd.Body("pin", disc(1.0, 0.0, 0.2, order), steel, loads=[cd.BodyForce([0, -weight])], degree=order)
    hole = cd.Body("hole", disc(2.0, 1.05, 0.16, order), steel, supports=[cd.Fixed("rim")], degree=order)
    scene = cd.Scene([pin, hole], [cd.Contact((pin, "rim"), (hole, "bore"), cd.LinearLayer(1e5))])
    # Between cubic facets the gap is off by what these are off the circle, less than a thousandth of the clearance.
    assert np.abs(scene.interfaces[0].geometric_gap - 0.05).max() < (1e-9 if order < 3 else 1e-5)
    solution = cd.solve(scene)
    u = solution.displacement("pin").x.array.reshape(-1, 2)
    x = pin.space.tabulate_dof_coordinates()[:, :2]
    rotation = (x[:, 0] @ u[:, 1] - x[:, 1] @ u[:, 0]) / (x**2).sum()
    assert abs(rotation) < 1e-3
    force = solution.forces("pin")
    assert force["contact"] == pytest.approx(-force["loads"], abs=1e-8 * weight)


def test_the_peak_under_a_pin_does_not_depend_on_the_mesh():
    """Coarse straight facets against fine curved ones: sixteen facets on a pin are enough for 2 %."""
    steel, peaks = cd.Isotropic(2.1e5, 0.3), []
    for size, order in ((0.4, 1), (0.1, 2)):
        pin = cd.Body("pin", disc(1.0, 0.0, size, order), steel, loads=[cd.BodyForce([0, -100.0])], degree=order)
        hole = cd.Body("hole", disc(2.0, 1.05, 0.8 * size, order), steel, supports=[cd.Fixed("rim")], degree=order)
        scene = cd.Scene([pin, hole], [cd.Contact((pin, "rim"), (hole, "bore"), cd.LinearLayer(1e5))])
        peaks.append(cd.solve(scene).contact().pressure.max())
    assert peaks[0] == pytest.approx(peaks[1], rel=0.02)


def test_facets_too_few_to_tell_a_curve_are_told():
    """Two and three facets on a quarter: 45° and 30° from facet to facet may be a curve or a polygon."""
    with pytest.warns(cd.ContactWarning, match=r"gap may be off by .* compressed by"):
        cd.solve(fit((2, 3)))
    with warnings.catch_warnings():
        warnings.simplefilter("error", cd.ContactWarning)
        cd.solve(fit((12, 17)))
        cd.solve(fit((2, 3), measure_gap=False))
        cd.solve(fit((2, 2)))
