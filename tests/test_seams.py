"""Where features meet: tensors as functions, UFL in materials, hints about bonds, decks, hot bodies, exports."""

import numpy as np
import pytest
import ufl
from dolfinx import fem
from test_deck_scene import cubes

import contactdd as cd

SOFT = cd.Isotropic(E=1e3, nu=0.3)
LINEAR = cd.LinearLayer(1e3)


def pair(low, high, layer=LINEAR, **options):
    """The first body's top against the second one's bottom."""
    return cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), layer, **options)])


def floor(mesh, material=SOFT, **options):
    """A body that stands on its bottom."""
    return cd.Body("low", mesh, material, supports=[cd.Fixed("bottom")], **options)


@pytest.mark.parametrize("kinematics", ["plane strain", "plane stress", "axisymmetric"])
def test_a_free_body_takes_on_its_eigenstrain(kinematics):
    """ε₀ is the strain of u = s (x² y, 0), so that nothing is stressed, whatever ν; the bond below is too soft to."""
    s, ring = 1e-3, kinematics == "axisymmetric"

    def eigenstrain(x):
        r, y, nothing = x[0], x[1], 0 * x[0]
        around = r * y if ring else nothing
        return s * np.array([[2 * r * y, r**2 / 2, nothing], [r**2 / 2, nothing, nothing], [nothing, nothing, around]])

    mesh = cd.rectangle((1, 0), (2, 1), (2, 2))
    free = cd.Body("free", mesh, SOFT, degree=3, kinematics=kinematics, loads=[cd.Eigenstrain(eigenstrain)])
    bond = cd.BondedLayer(cd.LinearLayer(1e-7), shear_stiffness=1e-7)
    solution = cd.solve(pair(floor(mesh.moved((0, -1)), kinematics=kinematics), free, bond))
    size = s * SOFT.E
    assert np.abs(solution.stress("free").x.array).max() < 1e-8 * size  # the bond's stiffness is 1e-10 of the bodies'
    assert solution.elastic_energy("free") < 1e-12 * s * size  # a difference of energies of that size, to rounding
    longer = np.diff(solution.displacement_at("free", [[1, 1], [2, 1]])[:, 0])
    assert longer == pytest.approx(3 * s, rel=1e-7)


def test_tensors_that_are_not_symmetric_are_refused():
    load = cd.Eigenstrain(lambda x: 1e-3 * np.array([[x[0], x[0], 0 * x[0]], [x[1], x[1], 0 * x[0]], 3 * [0 * x[0]]]))
    mesh = cd.rectangle((0, 0), (2, 1), (2, 1))
    scene = pair(floor(mesh, loads=[load]), cd.Body("high", mesh.moved((0, 1)), SOFT, supports=[cd.Fixed("top")]))
    with pytest.raises(ValueError, match="not symmetric everywhere"):
        cd.solve(scene)


def test_expansion_that_jumps_where_materials_do():
    """A function of the place that jumps between cells is the Function with one value in each; so are body forces."""
    mesh, found = cd.rectangle((0, 0), (2, 1), (4, 2)), []
    in_cells = fem.Function(fem.functionspace(mesh.domain, ("DG", 0)))
    in_cells.x.array[:] = np.where(mesh.middles[:, 0] < 1, 1e-2, 2e-2)
    for alpha in (in_cells, lambda x: np.where(x[0] < 1, 1e-2, 2e-2), lambda x: np.where(x[0] <= 1, 1e-2, 2e-2)):
        hot = floor(mesh, loads=[cd.ThermalStrain(alpha, 2.0)])
        held = cd.Body("high", mesh.moved((0, 1)), SOFT, supports=[cd.Fixed("top")])
        found.append(cd.solve(pair(hot, held)).contact().pressure)
    assert found[1] == pytest.approx(found[0], rel=1e-9)
    assert found[2] == pytest.approx(found[0], rel=1e-9)
    weight = cd.BodyForce(lambda x: [0 * x[0], np.where(x[0] < 1, -3.0, 0.0)])
    loaded = cd.solve(pair(floor(mesh, loads=[weight]), held)).forces("low")["loads"]
    assert loaded[1] == pytest.approx(-3.0, rel=1e-12)  # on half of the body, of area 1


@pytest.mark.parametrize(
    ("in_ufl", "as_plain"),
    [
        (lambda mesh: cd.Isotropic(fem.Constant(mesh.domain, 1e3), fem.Constant(mesh.domain, 0.3)), SOFT),
        (lambda mesh: cd.Isotropic(1e3 + 0 * ufl.SpatialCoordinate(mesh.domain)[0], 0.3), SOFT),
        (
            lambda mesh: cd.Isotropic(1e3 * (1 + ufl.SpatialCoordinate(mesh.domain)[0]), 0.3),
            cd.Isotropic(lambda x: 1e3 * (1 + x[0]), 0.3),
        ),
    ],
)
def test_material_of_constants_and_coordinates(in_ufl, as_plain):
    """A material in UFL needs no Function."""
    mesh = cd.rectangle((0, 0), (2, 1), (4, 2))
    load = cd.Pressure("top", lambda x: 1 + x[0])
    solutions = [
        cd.solve(pair(floor(mesh, material), cd.Body("high", mesh.moved((0, 1)), SOFT, loads=[load])))
        for material in (in_ufl(mesh), as_plain)
    ]
    one, other = (solution.contact().pressure for solution in solutions)
    assert one == pytest.approx(other, rel=1e-9)


@pytest.mark.parametrize(
    ("bond", "symmetric"),
    [
        (cd.BondedLayer(LINEAR, shear_stiffness=100.0), True),
        (cd.BondedLayer(LINEAR, shear_stiffness=lambda x: 100 * (1 + x[0])), False),
        (cd.BondedLayer(LINEAR, tension=cd.VaryingLayer(cd.LinearLayer, stiffness=lambda x: 100 * (1 + x[0]))), False),
    ],
)
def test_a_symmetric_scene_has_symmetric_bonds(bond, symmetric):
    """In shear and in tension, too: what the hint says of the scene, its solution shows."""
    mesh = cd.rectangle((0, 0), (2, 1), (4, 2), shape="quadrilateral")
    scene = pair(floor(mesh), cd.Body("high", mesh.moved((0, 1)), SOFT, loads=[cd.Pressure("top", -1.0)]), bond)
    pressure = cd.solve(scene).contact().sorted().pressure
    assert (np.abs(pressure - pressure[::-1]).max() < 1e-9) == symmetric
    assert any("symmetric about x = 1" in hint for hint in scene.hints()) == symmetric


LINEAR_LAW = "PRESSURE-OVERCLOSURE=LINEAR\n1.E7,\n"


def test_pressures_of_a_deck_that_are_nearly_the_same(tmp_path):
    """Both are loads: of the faces below and above the upper block, 0.04 each, they add up to 0.04 (p₁ − p₂)."""
    low, high = 25.0, 25.00002  # the same in six digits
    deck = cubes(LINEAR_LAW, f"*DLOAD\nUPPER, P1, {high}\nUPPER, P2, {low}\n")
    deck.text = deck.text.replace("UPPER_ABOVE, 3, 3, 0.\n", "UPPER_ABOVE, 3, 3, -1.E-4\n")
    loads = cd.solve(cd.read_scene(deck.write(tmp_path))).forces("UPPER")["loads"]
    assert loads[2] == pytest.approx(0.04 * (high - low), rel=1e-6)  # a difference that keeps nine of 16 digits


def test_temperatures_of_a_new_step(tmp_path):
    """OP=NEW takes back those of the step before, as its neighbours' cards do with theirs."""
    heat = "*TEMPERATURE\nUPPER_ALL, 100.\n*END STEP\n*STEP\n*STATIC\n*TEMPERATURE, OP=NEW\nLOWER_ALL, 0.\n"
    deck = cubes(LINEAR_LAW, heat)
    deck.text = deck.text.replace("*DENSITY", "*EXPANSION\n1.E-5\n*DENSITY")
    assert not any(body.loads for body in cd.read_scene(deck.write(tmp_path)).bodies)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("INTERACTION=SI, TYPE", "INTERACTION=SI, TIED, TYPE", r"\*CONTACTPAIR, TIED"),
        ("SURFACE BEHAVIOR, PRESS", "SURFACE BEHAVIOR, NO SEPARATION, PRESS", r"\*SURFACEBEHAVIOR, NOSEPARATION"),
        ("ELSET=LOWER, MATERIAL=STEEL", "ELSET=LOWER, MATERIAL=STEEL, ORIENTATION=O", "SOLIDSECTION, ORIENTATION"),
        ("*STATIC\n", "*STATIC\n*DSLOAD, OP=NEW\nBELOW, P, -5.\n", r"\*DSLOAD, OP"),
        ("*STATIC\n", "*STATIC\n*BOUNDARY, FIXED\nUPPER_ABOVE, 3, 3\n", r"\*BOUNDARY, FIXED"),
        ("*CONTACT PAIR", "*CLEARANCE, SLAVE=SLAVE, MASTER=MASTER, VALUE=1.\n*CONTACT PAIR", r"no \*CONTACT PAIR of"),
        ("*STATIC\n", "*STATIC\n*NSET, NSET=ALL, ELSET=UPPER\n", "nodes of an ELSET"),
        (", MATERIAL=STEEL\n", "\n", "MATERIAL"),
        ("*MATERIAL", "*ELEMENT, TYPE=CPS3\n7, 1, 2, 3\n*MATERIAL", "ELEMENT of the plane beside solid ones"),
    ],
)  # fmt: skip
def test_what_a_deck_says_is_not_passed_over(old, new, words, tmp_path):
    deck = cubes(LINEAR_LAW, "*DLOAD\nUPPER, P1, -25.\n")
    assert old in deck.text
    deck.text = deck.text.replace(old, new)
    with pytest.raises(ValueError, match=words):
        cd.read_scene(deck.write(tmp_path))


#: Two blocks of two CPS4 each; only one of the lower block's has a section where HALF says so.
PLANE = """*NODE
1, 0, 0
2, 1, 0
3, 2, 0
4, 0, 1
5, 1, 1
6, 2, 1
11, 0, 1
12, 1, 1
13, 2, 1
14, 0, 2
15, 1, 2
16, 2, 2
*ELEMENT, TYPE=CPS4, ELSET=LOW
1, 1, 2, 5, 4
2, 2, 3, 6, 5
*ELEMENT, TYPE=CPS4, ELSET=HIGH
11, 11, 12, 15, 14
12, 12, 13, 16, 15
*ELSET, ELSET=HALF
1,
*SURFACE, NAME=S
LOW, S3
*SURFACE, NAME=M
HIGH, S1
*MATERIAL, NAME=STEEL
*ELASTIC
1000., 0.3
*SOLID SECTION, ELSET={section}, MATERIAL=STEEL
2.
*SOLID SECTION, ELSET=HIGH, MATERIAL=STEEL
{thickness}
*SURFACE INTERACTION, NAME=SI
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
1.E3,
*CONTACT PAIR, INTERACTION=SI
S, M
*BOUNDARY
1, 1, 2
2, 2
3, 2
*STEP
*STATIC
*CLOAD
14, 2, -1.
15, 2, -2.
16, 2, -1.
*END STEP
"""


def test_sections_of_a_deck(tmp_path):
    """Forces by the thickness, 4 / 2; sections of part of a body, or of other thicknesses, are refused."""
    path = tmp_path / "deck.inp"

    def scene(section, thickness):
        path.write_text(PLANE.format(section=section, thickness=thickness))
        return cd.read_scene(path)

    assert cd.solve(scene("LOW", 2.0)).contact().force == pytest.approx(2.0, rel=1e-9)
    with pytest.raises(ValueError, match=r"1 of the 2 elements of 'LOW', one of them 2, have no \*SOLID SECTION"):
        scene("HALF", 2.0)
    with pytest.raises(ValueError, match="several thicknesses"):
        scene("LOW", 1.0)


@pytest.mark.parametrize(
    ("line", "words"),
    [("INCLUDE 'mesh.bdf'", "includes another"), ("GRDSET,,7", "coordinate system 7")],
)
def test_bulk_data_whose_nodes_are_elsewhere(line, words, tmp_path):
    corners = "".join(f"GRID,{n},,{x},{y},0.\n" for n, (x, y) in enumerate([(0, 0), (1, 0), (1, 1), (0, 1)], 1))
    path = tmp_path / "square.bdf"
    path.write_text(f"BEGIN BULK\n{corners}CQUAD4,1,1,1,2,3,4\nENDDATA\n")
    assert cd.read_mesh(path).cells == 1
    path.write_text(f"BEGIN BULK\n{line}\n{corners}CQUAD4,1,1,1,2,3,4\nENDDATA\n")
    with pytest.raises(ValueError, match=words):
        cd.read_mesh(path)


@pytest.mark.parametrize(("method", "options"), [("auto", {}), ("anderson", {}), ("chord", {"gamma": 0.5})])
@pytest.mark.parametrize("local_solver", ["condensed", "multigrid"])
def test_a_hot_body_pressed_a_little(method, options, local_solver):
    """The force is that of the load, however large the forces are with which eigenstrains balance themselves.

    These are E α ΔT = 2500 here, and the load is 0.01: were they taken for forces at work, a run would end with forces
    wrong by 1e-6 to 2e-5. Of what counts, a thousandth of them, 1e-10 is left, 3e-8 of the load.
    """
    steel, mesh, load = cd.Isotropic(E=2.1e5, nu=0.3), cd.rectangle((0, 0), (2, 1), (8, 4)), 0.01
    heat = cd.ThermalStrain(1.2e-5, lambda x: 1000.0 * (x[1] - 1))
    hot = cd.Body(
        "hot", mesh.moved((0, 1)), steel, supports=[cd.Symmetry("left")], loads=[heat, cd.Pressure("top", load)]
    )
    scene = pair(floor(mesh, steel), hot, cd.PowerLayer(B=4e-4, a=0.5))
    solution = cd.solve(scene, method=method, local_solver=local_solver, **options)
    assert solution.contact().force == pytest.approx(2 * load, rel=1e-7)
    assert solution.imbalance < 1e-10


def test_slip_and_closures_are_exported(tmp_path):
    """Of a bond the slip and the shear, of a gasket the closures; ParaView's own reader finds the numbers."""
    pyvista = pytest.importorskip("pyvista")
    mesh = cd.rectangle((0, 0), (2, 1), (4, 2))
    bond = cd.BondedLayer(LINEAR, shear_stiffness=100.0)
    for layer, names in ((bond, ["slip", "shear"]), (cd.GasketLayer(LINEAR, unloading=4e3), ["largest_closure"])):
        load = cd.Traction("top", (0.1 * layer.bonded, -1.0))
        solution = cd.solve(pair(floor(mesh), cd.Body("high", mesh.moved((0, 1)), SOFT, loads=[load]), layer))
        solution.export(tmp_path)
        read = pyvista.read(tmp_path / "low-high points.vtu").point_data
        for name in names:
            values = getattr(solution.contact(), name)
            columns = (slice(None), slice(2))[: values.ndim]  # ParaView's vectors have three components
            assert np.array_equal(read[name.replace("_", " ")][columns], values)
