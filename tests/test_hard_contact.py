"""Contact without a layer: against Hertz, Westergaard and the punch, and free of any parameter that matters."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from dolfinx import mesh as dmesh
from mpi4py import MPI

import contactdd as cd

E, NU, R = 2.1e5, 0.3, 100.0
STEEL = cd.Isotropic(E, NU)
STAR = E / (2 * (1 - NU**2))  # E* of two equal bodies


def line(fine, cells, end, more):
    """Even cells up to `fine`, then growing ones to `end`."""
    return np.concatenate([np.linspace(0, fine, cells + 1), fine * np.geomspace(1, end / fine, more + 1)[1:]])


def half_spaces(kinematics, gap, load, *, cells=(48, 61), length=20.0, degree=2, swapped=False, contact=None):
    """Two bodies large beside the contact of half width one, of unlike meshes, on a plane or axis of symmetry."""
    meshes = []
    for n, more, side in zip(cells, (14, 17), (-1, 1), strict=True):
        x, y = line(1.5, n, length, more), line(0.75, max(n // 3, 2), length, more)
        low, high = ((0, -length), (length, 0)) if side < 0 else ((0, 0), (length, length))
        meshes.append(cd.rectangle(low, high, (x, -y[::-1] if side < 0 else y), shape="quadrilateral"))
    kw = {"degree": degree, "kinematics": kinematics}
    lower = cd.Body("lower", meshes[0], STEEL, supports=[cd.Symmetry("left", "bottom")], **kw)
    upper = cd.Body("upper", meshes[1], STEEL, supports=[cd.Symmetry("left")], loads=[cd.Pressure("top", load)], **kw)
    pair = [(lower, "top"), (upper, "bottom")][:: -1 if swapped else 1]
    return cd.Scene([lower, upper], [cd.Contact(*pair, contact or cd.HardContact(), gap=gap)])


def pressed_blocks(cells=(24, 35), shape="quadrilateral", contact=None, gap=0.0, load=None, **body):
    """Two blocks between walls under an uneven pressure, 5 to 15, on unlike meshes."""
    load = load or (lambda x: 10 * (1 + 0.5 * np.cos(np.pi * x[0] / 4)))
    walls = cd.Symmetry("left", "right")
    low, high = (cd.rectangle((0, y), (4, y + 1), (n, n // 4), shape=shape) for y, n in enumerate(cells))
    lower = cd.Body("lower", low, STEEL, supports=[walls, cd.Symmetry("bottom")], **body)
    upper = cd.Body("upper", high, STEEL, supports=[walls], loads=[cd.Pressure("top", load)], **body)
    return cd.Scene(
        [lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), contact or cd.HardContact(), gap=gap)]
    )


def in_order(result):
    order = np.lexsort(result.x.T)
    return result.x[order], result.pressure[order]


def wavering(pressure):
    """The sum of second differences over that of a pressure that rises and falls once."""
    return np.abs(np.diff(pressure, 2)).sum() / (2 * np.abs(np.diff(pressure)).max())


# ----------------------------------------------------------------------------------------- known answers


@pytest.mark.parametrize("kinematics", ["plane strain", "axisymmetric"])
@pytest.mark.parametrize("degree", [1, 2])
def test_hertz(kinematics, degree):
    """Cylinder and sphere on unlike meshes, 1/32 of the contact's half width: within 1 % of the peak, but in its last
    facet, where the pressure has a root; nothing wavers."""
    if kinematics == "axisymmetric":
        force = 4 * STAR / (3 * R)
        load, exact = force / (np.pi * 20.0**2), cd.reference.hertz_sphere(force, R, E, NU, E2=E, nu2=NU)
    else:
        force = np.pi * STAR / (4 * R)
        load, exact = force / (2 * 20.0), cd.reference.hertz_cylinder(force, R, E, NU, E2=E, nu2=NU)
    solution = cd.solve(half_spaces(kinematics, lambda x: x[0] ** 2 / (2 * R), load, degree=degree))
    result = solution.contact()
    x, pressure = in_order(result)
    error = np.abs(pressure - exact.pressure(x[:, 0])) / exact.peak_pressure
    assert pressure.max() == pytest.approx(exact.peak_pressure, rel=2e-3)
    # Linear elements have u_r/r wrong in the first ring: 1.2 % at the axis itself.
    near = 1.5 / 48 if degree == 1 and kinematics == "axisymmetric" else -1.0
    assert error[(np.abs(x[:, 0] - 1) > 2 * 1.5 / 48) & (x[:, 0] > near)].max() < 0.01
    assert error[0] < 0.013
    assert wavering(pressure[x[:, 0] < 0.9]) < 1.0
    assert result.gap.min() > -1e-9  # of a shape that is 5e-3 deep at the edge of contact
    assert np.all(pressure >= 0.0)
    assert np.abs(result.pressure * result.gap).max() < 1e-6 * exact.peak_pressure * 5e-3


def test_edge_of_contact():
    """Where the pressure ends and the gap begins: within a facet of Hertz' half width, as the facets' own status is."""
    force = np.pi * STAR / (4 * R)
    solution = cd.solve(half_spaces("plane strain", lambda x: x[0] ** 2 / (2 * R), force / 40.0))
    result = solution.contact()
    assert result.edge[:, 0] == pytest.approx([1.0], abs=1.5 / 48)
    assert result.area == pytest.approx(1.0, abs=1.5 / 48)
    for second in (False, True):
        surface = solution.contact_surface(second=second)
        assert surface.areas @ surface.pressure == pytest.approx(force / 2, rel=1e-9)
        assert surface.areas @ surface.closed == pytest.approx(1.0, abs=2 * 1.5 / 48)


def test_wavy_surface():
    """Westergaard (Johnson, 13.2) at half the closing pressure and beyond it, both bodies a wave length high."""
    depth, length = 1e-4, 1.0
    closing = np.pi * STAR * depth / length
    for share in (0.5, 2.0):
        scene = wavy(depth, length, share * closing)
        x, pressure = in_order(cd.solve(scene).contact())
        # The crest is at x = 0 with the gap D (1 − cos 2πx/L).
        angle = np.pi * x[:, 0] / length
        if share < 1:
            inside = np.maximum(share - np.sin(angle) ** 2, 0)
            exact = 2 * closing * np.cos(angle) * np.sqrt(inside)
        else:
            exact = closing * (share + np.cos(2 * angle))
        edge = np.abs(np.sin(angle) ** 2 - share) < 0.06
        assert np.abs(pressure - exact)[~edge].max() < 0.01 * exact.max()


def wavy(depth, length, load):
    walls, kw = cd.Symmetry("left", "right"), {"degree": 2}
    heights = np.concatenate(([0], np.geomspace(0.01, 1, 24))) * length
    low = cd.rectangle((0, -length), (length / 2, 0), (64, -heights[::-1]), shape="quadrilateral")
    high = cd.rectangle((0, 0), (length / 2, length), (45, heights), shape="quadrilateral")
    lower = cd.Body("lower", low, STEEL, supports=[walls, cd.Symmetry("bottom")], **kw)
    upper = cd.Body("upper", high, STEEL, supports=[walls], loads=[cd.Pressure("top", load)], **kw)
    gap = lambda x: depth * (1 - np.cos(2 * np.pi * x[0] / length))  # noqa: E731
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.HardContact(), gap=gap)])


def test_flat_punch():
    """A stiff punch of half width 1 on a wide block: p = P / (π √(a² − x²)), so ∫₀^x p = P/π arcsin(x/a)."""
    length, load = 20.0, 10.0
    x = np.concatenate([1 - np.geomspace(1, 0.01, 25)[:-1], [1.0]])
    wide = np.concatenate([x, 1 + np.geomspace(0.01, length - 1, 25)])
    y = np.concatenate([[0], np.geomspace(0.01, length, 30)])
    base = cd.rectangle((0, -length), (length, 0), (wide, -y[::-1]), shape="quadrilateral")
    top = cd.rectangle((0, 0), (1, 1), (17, 5), shape="quadrilateral")
    block = cd.Body("block", base, STEEL, supports=[cd.Symmetry("left", "bottom")], degree=2)
    punch = cd.Body(
        "punch",
        top,
        cd.Isotropic(1e4 * E, 0.0),
        supports=[cd.Symmetry("left")],
        loads=[cd.Pressure("top", load)],
        degree=2,
    )
    solution = cd.solve(cd.Scene([block, punch], [cd.Contact((block, "top"), (punch, "bottom"), cd.HardContact())]))
    fine = solution.contact(degree=6)
    for edge in (0.3, 0.6, 0.9):
        force = fine.weights @ (fine.pressure * (fine.x[:, 0] < edge))
        assert force == pytest.approx(2 * load / np.pi * np.arcsin(edge), rel=0.02)
    assert fine.force == pytest.approx(load, rel=1e-9)
    assert solution.forces("block")["contact"][1] == pytest.approx(-load, rel=1e-9)
    assert solution.forces("block")["supports"][1] == pytest.approx(load, rel=1e-9)


@pytest.mark.parametrize("kinematics", ["plane strain", "plane stress", "axisymmetric"])
@pytest.mark.parametrize(("shape", "degree"), [("triangle", 1), ("quadrilateral", 2)])
def test_patch(kinematics, shape, degree):
    scene = pressed_blocks((7, 11), shape, load=lambda x: 10 + 0 * x[0], kinematics=kinematics, degree=degree)
    result = cd.solve(scene).contact()
    # The multipliers settle to 1e-6 of the pressure, what is left is a tenth of that.
    assert result.pressure == pytest.approx(10.0, rel=1e-6)
    assert abs(result.gap).max() < 1e-6 * 10 / E


@pytest.mark.parametrize(("shape", "degree"), [("tetrahedron", 1), ("hexahedron", 2)])
def test_patch_in_space(shape, degree):
    walls, kw = cd.Symmetry("left", "right", "front", "back"), {"degree": degree}
    low, high = (
        cd.box((0, 0, 0), (1, 1.3, 0.5), (3, 4, 1), shape=shape),
        cd.box((0, 0, 0.5), (1, 1.3, 1), (5, 3, 1), shape=shape),
    )
    lower = cd.Body("lower", low, STEEL, supports=[walls], loads=[cd.Pressure("bottom", 10.0)], **kw)
    upper = cd.Body("upper", high, cd.Isotropic(1e5, 0.35), supports=[walls], loads=[cd.Pressure("top", 10.0)], **kw)
    result = cd.solve(
        cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.HardContact())])
    ).contact()
    assert result.pressure == pytest.approx(10.0, rel=1e-6)


# ------------------------------------------------------------------------------------- no parameter matters


def test_penalty_changes_nothing():
    """Half and double the penalty, and hundreds of it: the same pressure to the multipliers' tolerance."""
    pressures = []
    for penalty in (15.0, 30.0, 60.0, 3000.0):
        scene = half_spaces(
            "plane strain", lambda x: x[0] ** 2 / (2 * R), 9.0, cells=(12, 19), contact=cd.HardContact(penalty)
        )
        pressures.append(in_order(cd.solve(scene).contact())[1])
    assert np.ptp(pressures, axis=0).max() < 1e-5 * pressures[0].max()


def test_stiffer_layers_tend_to_it():
    """The limit of layers: the difference falls with 1/k."""
    hard = cd.solve(pressed_blocks()).contact().pressure
    differences = []
    for stiffness in (1e8, 1e9):
        low, high = pressed_blocks().bodies
        contact = cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(stiffness), quadrature="mortar")
        differences.append(np.abs(cd.solve(cd.Scene([low, high], [contact])).contact().pressure - hard).max())
    assert differences[1] == pytest.approx(differences[0] / 10, rel=0.05)


def test_swapped_bodies():
    """The same answer whichever body is first."""
    gap, load = (lambda x: x[0] ** 2 / (2 * R)), 9.0
    _, pressure = in_order(cd.solve(half_spaces("plane strain", gap, load, cells=(12, 19))).contact())
    _, swapped = in_order(cd.solve(half_spaces("plane strain", gap, load, cells=(12, 19), swapped=True)).contact())
    assert swapped == pytest.approx(pressure, abs=1e-6 * pressure.max())


def test_no_wavering_on_linear_elements():
    """Where a stiff layer at Gauss points wavers by four times its pressure, this one is smooth."""
    _, pressure = in_order(cd.solve(pressed_blocks(shape="triangle", degree=1)).contact())
    _, right = in_order(cd.solve(pressed_blocks((96, 96), degree=2)).contact())
    assert pressure == pytest.approx(right[::4], abs=0.02 * right.max())  # linear triangles at a corner
    assert wavering(pressure[2:-2]) < 1.2 * wavering(right[::4][2:-2])


# ------------------------------------------------------------------------------------------ how it is solved


def test_methods_and_local_solvers_agree():
    """Newton's methods, Krylov, multigrid, and decomposed ones, which take a softer penalty."""
    _, expected = in_order(cd.solve(pressed_blocks((12, 17))).contact())
    for method, local in (
        ("newton", "auto"),
        ("newton-kurchatov", "auto"),
        ("newton-krylov", "auto"),
        ("auto", "assembled"),
        ("newton-krylov", "multigrid"),
        ("anderson", "auto"),
        ("chord", "auto"),
        ("one-point", "assembled"),
    ):
        solution = cd.solve(pressed_blocks((12, 17)), method, local_solver=local)
        # Each of the two is known to a millionth of its pressures.
        assert in_order(solution.contact())[1] == pytest.approx(expected, abs=2e-6 * expected.max())
        assert solution.imbalance < 1e-8


def test_energy():
    """Closed all over and no gap: nothing is stored in the contact, and the bodies store half the loads' work."""
    scene = pressed_blocks((12, 17), load=lambda x: 10 + 0 * x[0])
    solution = cd.solve(scene)
    assert solution.layer_energy == pytest.approx(0.0, abs=1e-9 * solution.elastic_energy())
    # Walls on both sides: strain −q/M across two unit heights, on a length of 4.
    modulus = E * (1 - NU) / ((1 + NU) * (1 - 2 * NU))
    assert solution.elastic_energy() == pytest.approx(0.5 * 10.0**2 / modulus * 8, rel=1e-6)
    assert solution.energy == pytest.approx(-solution.elastic_energy(), rel=1e-6)


def quarter_ring(inner, outer, cells):
    """A quarter ring about the origin, straight facets."""
    grid = [[inner, 0.0], [outer, np.pi / 2]], [5, cells]
    domain = dmesh.create_rectangle(MPI.COMM_SELF, *grid, dmesh.CellType.quadrilateral)
    x = domain.geometry.x
    x[:, 0], x[:, 1] = x[:, 0] * np.cos(x[:, 1]), x[:, 0] * np.sin(x[:, 1])
    return cd.from_dolfinx(
        domain,
        inside=lambda x: np.isclose(np.hypot(x[0], x[1]), inner),
        outside=lambda x: np.isclose(np.hypot(x[0], x[1]), outer),
        x=lambda x: np.abs(x[0]) < 1e-9,
        y=lambda x: np.abs(x[1]) < 1e-9,
    )


@pytest.mark.parametrize("cells", [(12, 17), (24, 24)])
def test_press_fit(cells):
    """Lamé's pressure between rings, whose straight facets' sagitta is 17 times the interference at 12 cells."""
    inner, middle, outer, interference = 10.0, 20.0, 30.0, 0.0025
    compliance = middle / E * sum((b**2 + a**2) / (b**2 - a**2) for a, b in ((inner, middle), (middle, outer)))
    kw = {"supports": [cd.Symmetry("x", "y")], "kinematics": "plane stress"}
    shaft = cd.Body("shaft", quarter_ring(inner, middle, cells[0]), STEEL, **kw)
    hub = cd.Body("hub", quarter_ring(middle, outer, cells[1]), STEEL, **kw)
    contact = cd.Contact((shaft, "outside"), (hub, "inside"), cd.HardContact(), gap=-interference)
    result = cd.solve(cd.Scene([shaft, hub], [contact])).contact()
    # Five cells through each wall leave 2e-3.
    assert result.pressure == pytest.approx(interference / compliance, rel=5e-3)


class RigidCylinder(cd.MeshlessBody):
    """A rigid cylinder under a force along y, which it may follow."""

    def __init__(self, centre, radius, force):
        super().__init__("cylinder")
        self.centre, self.radius, self.force = np.array(centre), radius, force

    def gap(self, x, direction):
        offset = self.centre - x
        along = np.sum(offset * direction, axis=1)
        return along - np.sqrt(self.radius**2 - (np.sum(offset**2, axis=1) - along**2))

    def normal_displacement(self, x, direction):
        return -np.column_stack([direction, 0 * x[:, 0]])

    def load(self):
        return np.array([0.0, -self.force, 0.0])

    def prescribed(self):
        return np.array([0.0, np.nan, 0.0])


@pytest.mark.parametrize("swapped", [False, True])
def test_body_without_a_mesh(swapped):
    """A rigid cylinder on a block, half of it: Hertz with a rigid second body, in force and in peak."""
    x, y = line(1.5, 40, 20.0, 14), line(0.75, 16, 20.0, 14)
    mesh = cd.rectangle((0, -20), (20, 0), (x, -y[::-1]), shape="quadrilateral")
    block = cd.Body("block", mesh, STEEL, supports=[cd.Symmetry("left", "bottom")], degree=2)
    force = np.pi * 2 * STAR / (4 * R)
    cylinder = RigidCylinder((0.0, R), R, force / 2)
    pair = [(block, "top"), cylinder][:: -1 if swapped else 1]
    solution = cd.solve(cd.Scene([block, cylinder], [cd.Contact(*pair, cd.HardContact())]))
    exact = cd.reference.hertz_cylinder(force, R, E, NU)
    assert solution.contact().force == pytest.approx(force / 2, rel=1e-9)
    assert solution.contact().pressure.max() == pytest.approx(exact.peak_pressure, rel=5e-3)


def test_interference():
    """Blocks that overlap by g between fixed ends: p = M g / 2, and no overlap is left."""
    walls = cd.Symmetry("left", "right", "bottom"), cd.Symmetry("left", "right", "top")
    lower = cd.Body("lower", cd.rectangle((0, 0), (4, 1), (7, 3)), STEEL, supports=[walls[0]])
    upper = cd.Body("upper", cd.rectangle((0, 1), (4, 2), (11, 3)), STEEL, supports=[walls[1]])
    contact = cd.Contact((lower, "top"), (upper, "bottom"), cd.HardContact(), gap=-1e-3)
    result = cd.solve(cd.Scene([lower, upper], [contact])).contact()
    modulus = E * (1 - NU) / ((1 + NU) * (1 - 2 * NU))
    assert result.pressure == pytest.approx(modulus * 1e-3 / 2, rel=1e-6)
    assert result.penetration < 1e-9


def test_apart():
    """Bodies that do not reach each other: no pressure, no contact, the whole gap."""
    walls = cd.Symmetry("left", "right", "bottom"), cd.Symmetry("left", "right"), cd.Displacement("top", [None, -4e-4])
    lower = cd.Body("lower", cd.rectangle((0, 0), (4, 1), (7, 3)), STEEL, supports=[walls[0]])
    upper = cd.Body("upper", cd.rectangle((0, 1), (4, 2), (11, 3)), STEEL, supports=list(walls[1:]))
    contact = cd.Contact((lower, "top"), (upper, "bottom"), cd.HardContact(), gap=1e-3)
    result = cd.solve(cd.Scene([lower, upper], [contact])).contact()
    assert np.all(result.pressure == 0.0)
    assert not result.closed.any()
    assert result.gap == pytest.approx(6e-4, rel=1e-9)


def test_load_programme():
    """A parameter runs up and down: the way back is the way there, step by step, from the step before."""
    load = cd.Parameter(0.0)
    gap = lambda x: x[0] ** 2 / (2 * R)  # noqa: E731
    path = cd.programme(
        half_spaces("plane strain", gap, load, cells=(12, 19)),
        load,
        [1.0, 5.0, 9.0, 5.0, 1.0],
        record={"area": lambda s: s.contact().area, "peak": lambda s: s.contact().pressure.max()},
    )
    assert path.records["area"][[3, 4]] == pytest.approx(path.records["area"][[1, 0]])
    assert path.records["peak"][[3, 4]] == pytest.approx(path.records["peak"][[1, 0]], rel=1e-5)
    assert len(path.solutions[3].history) < 20
    fresh = cd.solve(half_spaces("plane strain", gap, 5.0, cells=(12, 19))).contact()
    assert path.solutions[3].contact().pressure == pytest.approx(fresh.pressure, abs=1e-5 * fresh.pressure.max())


def test_beside_a_layer():
    """A hard and a layered contact in one stack carry the same force; only the layer is compressed."""
    walls = cd.Symmetry("left", "right")
    bodies = [
        cd.Body("a", cd.rectangle((0, 0), (4, 1), (7, 3)), STEEL, supports=[walls, cd.Symmetry("bottom")]),
        cd.Body("b", cd.rectangle((0, 1), (4, 2), (11, 3)), STEEL, supports=[walls]),
        cd.Body("c", cd.rectangle((0, 2), (4, 3), (8, 3)), STEEL, supports=[walls], loads=[cd.Pressure("top", 10.0)]),
    ]
    layer = cd.PowerLayer(4e-6, 1.1)
    contacts = [
        cd.Contact((bodies[0], "top"), (bodies[1], "bottom"), cd.HardContact()),
        cd.Contact((bodies[1], "top"), (bodies[2], "bottom"), layer),
    ]
    solution = cd.solve(cd.Scene(bodies, contacts))
    hard, soft = solution.contact(0), solution.contact(1)
    assert hard.pressure == pytest.approx(10.0, rel=1e-6)
    assert soft.gap == pytest.approx(float(layer.compression(-10.0)), rel=1e-6)
    assert solution.layer_energy == pytest.approx(4 * float(layer.energy(layer.compression(-10.0))), rel=1e-6)


def test_history_tells_the_penetration():
    solution = cd.solve(pressed_blocks((12, 17)))
    notes = [record.note for record in solution.history if "multipliers" in record.note]
    depths = [float(note.split("penetration ")[1].split(",")[0]) for note in notes]
    assert len(depths) >= 2
    assert np.all(np.diff(depths) < 0)
    assert [record.iteration for record in solution.history] == list(range(1, len(solution.history) + 1))
    assert solution.contact().penetration < 1e-2 * depths[0]
    assert "penetration" in repr(solution.contact())
    assert "multipliers updated" in solution.reason


# -------------------------------------------------------------------------------------------------- refusals


def test_refusals(tmp_path):
    low, high = pressed_blocks((7, 11)).bodies
    pair = (low, "top"), (high, "bottom")
    for rule in ("gauss", "facet", "vertex"):
        with pytest.raises(ValueError, match=f"quadrature = '{rule}' with a hard contact"):
            cd.Contact(*pair, cd.HardContact(), quadrature=rule)
    for penalty, error in ((0.0, ValueError), (np.nan, ValueError), ("stiff", TypeError)):
        with pytest.raises(error, match="penalty"):
            cd.HardContact(penalty)
    with pytest.raises(ValueError, match=r"checkpoint.*hard contacts"):
        cd.solve(pressed_blocks((7, 11)), checkpoint=tmp_path / "state")
    layered = cd.Scene([low, high], [cd.Contact(*pair, cd.LinearLayer(1e6))])
    with pytest.raises(ValueError, match="expected a contact with quadrature='mortar'"):
        layered.with_layer(cd.HardContact())


@pytest.mark.parametrize("seed", range(8))
def test_any_stack(seed):
    """Stacks of unlike blocks, materials over four decades, gaps of any kind: action = reaction and complementarity."""
    rng = np.random.default_rng(seed)
    kinematics = ("plane strain", "plane stress", "axisymmetric")[seed % 3]
    bodies, contacts = [], []
    for i, width in enumerate((4.0, 4.0, rng.uniform(2, 4))):
        cells, degree = (int(rng.integers(3, 26)), int(rng.integers(1, 6))), int(rng.integers(1, 3))
        mesh = cd.rectangle((0, i), (width, i + 1), cells, shape=("triangle", "quadrilateral")[rng.integers(2)])
        held = cd.Symmetry("left", *(["bottom"] if i == 0 else []))
        load, tilt = 10 ** rng.uniform(-1, 1), rng.uniform(-0.8, 0.8)
        pressure = cd.Pressure("top", lambda x, q=load, a=tilt: q * (1 + a * np.cos(np.pi * x[0] / 4)))
        material = cd.Isotropic(10 ** rng.uniform(3, 7), rng.uniform(0, 0.49))
        kw = {"supports": [held], "loads": [pressure] if i == 2 else [], "degree": degree, "kinematics": kinematics}
        bodies.append(cd.Body(f"block {i}", mesh, material, **kw))
    for lower, upper in itertools.pairwise(bodies):
        depth, middle = 10 ** rng.uniform(-6, -2), rng.uniform(0, 4)
        gap = (-depth, lambda x, d=depth, c=middle: d * (x[0] - c) ** 2)[rng.integers(2)]
        pair = [(lower, "top"), (upper, "bottom")][:: rng.choice([1, -1])]
        contacts.append(cd.Contact(*pair, cd.HardContact(), gap=gap))
    solution = cd.solve(cd.Scene(bodies, contacts))
    assert solution.imbalance < 1e-8
    for index in range(2):
        result, stiffness = solution.contact(index), solution.interfaces[index].layer.stiffness
        # min(k z, p) = 0 to the multipliers' tolerance
        assert np.abs(np.minimum(stiffness * result.gap, result.pressure)).max() < 2e-6 * result.pressure.max()


def test_start_from_another_solution():
    """With the displacements and pressures of a solution the run is over at once, whatever method has found it."""
    scene = pressed_blocks((12, 17))
    for method in ("auto", "anderson"):
        again = cd.solve(scene, start=cd.solve(scene, method))
        assert again.iterations <= 2
        assert again.contact().pressure == pytest.approx(cd.solve(scene).contact().pressure, rel=1e-5)


def test_with_layer():
    """A mortar contact may become hard, and back."""
    low, high = pressed_blocks((7, 11)).bodies
    contact = cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(1e6), quadrature="mortar")
    scene = cd.Scene([low, high], [contact])
    hard = scene.with_layer(cd.HardContact())
    assert cd.solve(hard).contact().pressure == pytest.approx(cd.solve(pressed_blocks((7, 11))).contact().pressure)
    back = hard.with_layer(cd.LinearLayer(1e6))
    assert cd.solve(back).contact().pressure == pytest.approx(cd.solve(scene).contact().pressure)


# -------------------------------------------------------------------------------------- ends that are no solution


def test_pulled_apart():
    """Nothing holds a body that is pulled away: no equilibrium, as with any layer."""
    walls = cd.Symmetry("left", "right")
    lower = cd.Body("lower", cd.rectangle((0, 0), (4, 1), (7, 3)), STEEL, supports=[walls, cd.Symmetry("bottom")])
    upper = cd.Body(
        "upper", cd.rectangle((0, 1), (4, 2), (11, 3)), STEEL, supports=[walls], loads=[cd.Pressure("top", -1.0)]
    )
    scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.HardContact())])
    with pytest.raises(cd.NoEquilibriumError):
        cd.solve(scene)


def test_overlap_that_no_pressure_can_close():
    """Both surfaces held in place, an interference between them: told, not answered with any pressure."""
    lower = cd.Body("lower", cd.rectangle((0, 0), (4, 1), (7, 3)), STEEL, supports=[cd.Fixed("bottom", "top")])
    upper = cd.Body("upper", cd.rectangle((0, 1), (4, 2), (11, 3)), STEEL, supports=[cd.Fixed("top", "bottom")])
    contact = cd.Contact((lower, "top"), (upper, "bottom"), cd.HardContact(), gap=-1e-3)
    solution = cd.solve(cd.Scene([lower, upper], [contact]), on_failure="return")
    assert solution.status == "stalled"
    assert "do not settle" in solution.reason
    assert solution.contact().penetration == pytest.approx(1e-3)


@pytest.mark.long
def test_sphere_in_space():
    """Hertz' sphere as a quarter of two solids of unlike hexahedra: the peak to 1 %, the force to rounding."""
    force = 4 * STAR / (3 * R)
    exact = cd.reference.hertz_sphere(force, R, E, NU, E2=E, nu2=NU)
    length, bodies = 12.0, []
    for side, cells, more in ((-1, 8, 6), (1, 11, 7)):
        x, y = line(1.3, cells, length, more), line(0.6, 3, length, 7)
        low, high = ((0, 0, -length), (length, length, 0)) if side < 0 else ((0, 0, 0), (length,) * 3)
        mesh = cd.box(low, high, (x, x, -y[::-1] if side < 0 else y), shape="hexahedron")
        held = cd.Symmetry("left", "front", *(["bottom"] if side < 0 else []))
        loads = [] if side < 0 else [cd.Pressure("top", force / 4 / length**2)]
        bodies.append(cd.Body("lower" if side < 0 else "upper", mesh, STEEL, supports=[held], loads=loads))
    contact = cd.Contact(
        (bodies[0], "top"), (bodies[1], "bottom"), cd.HardContact(), gap=lambda x: (x[0] ** 2 + x[1] ** 2) / (2 * R)
    )
    result = cd.solve(cd.Scene(bodies, [contact])).contact()
    assert result.force == pytest.approx(force / 4, rel=1e-9)
    assert result.pressure.max() == pytest.approx(exact.peak_pressure, rel=0.01)
    radius = np.hypot(*result.x.T[:2])
    inner = radius < 0.6  # six facets from the middle to the edge of contact
    assert result.pressure[inner] == pytest.approx(exact.pressure(radius[inner]), abs=0.07 * exact.peak_pressure)
