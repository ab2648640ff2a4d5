"""Materials: their axes, their reduction to the plane, what varies in space, and bodies that are made of them."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import LAYER, STEEL
from scipy.spatial.transform import Rotation

import contactdd as cd
from contactdd.material import VOIGT

# Pine-like: the moduli differ by a factor of 20 and no ratio is a round one. MPa; lengths in cm.
WOOD = cd.Orthotropic(E1=12e3, E2=900.0, E3=600.0, nu12=0.42, nu13=0.39, nu23=0.31, G12=750.0, G13=700.0, G23=70.0)
Q = 10.0

# Sums of a few dozen products of numbers of like size: each rounds by 1e-16.
ROUNDING = 1e-13


def relative(value, exact):
    return np.abs(np.asarray(value) - exact).max() / np.abs(exact).max()


def pressed(material, *, sides=True, cells=(3, 2), dim=2, lower=None, shape=None, **options):
    """Two blocks of 3 × 2 (× 1) pressed together from below and above; `sides`: their lateral faces stay plane."""
    shape = {} if shape is None else {"shape": shape}
    if dim == 2:
        meshes = [cd.rectangle((0, y), (3, y + 2), cells, **shape) for y in (0, 2)]
        names = ("left", "right")
    else:
        meshes = [cd.box((0, 0, z), (3, 1, z + 2), cells, **shape) for z in (0, 2)]
        names = ("left", "right", "front", "back")
    supports = [cd.Symmetry(*names)] if sides else []
    loads = [[cd.Pressure("bottom", Q)], [cd.Pressure("top", Q)]]
    bodies = [
        cd.Body(name, mesh, each, supports=supports, loads=load, **options)
        for name, mesh, each, load in zip(("lower", "upper"), meshes, (lower or material, material), loads, strict=True)
    ]
    return cd.Scene(bodies, [cd.Contact((bodies[0], "top"), (bodies[1], "bottom"), LAYER)])


def solved(scene):
    return cd.solve(scene, "newton", gamma="search", tolerance=1e-13)


def shortening(solution, body):
    """How much closer the mean of the top and of the bottom of a body have come."""
    u = solution.displacement(body)
    x, axis = u.function_space.tabulate_dof_coordinates(), u.function_space.mesh.topology.dim - 1
    move, height = u.x.array.reshape(len(x), -1)[:, axis], x[:, axis]
    return move[np.isclose(height, height.min())].mean() - move[np.isclose(height, height.max())].mean()


# The tensors


def test_quarter_turn_swaps_the_first_two_axes():
    turned = WOOD.rotated(np.pi / 2)
    swapped = cd.Orthotropic(
        E1=WOOD.E2,
        E2=WOOD.E1,
        E3=WOOD.E3,
        nu12=WOOD.nu12 * WOOD.E2 / WOOD.E1,
        nu13=WOOD.nu23,
        nu23=WOOD.nu13,
        G12=WOOD.G12,
        G13=WOOD.G23,
        G23=WOOD.G13,
    )
    assert relative(turned.stiffness(), swapped.stiffness()) < ROUNDING


@pytest.mark.parametrize("seed", range(3))
def test_rotation_turns_every_index_of_the_tensor(seed):
    matrix = Rotation.random(random_state=seed).as_matrix()
    expected = np.einsum("ia,jb,kc,ld,abcd", *[matrix] * 4, WOOD.tensor())
    assert relative(WOOD.rotated(matrix).tensor(), expected) < ROUNDING
    assert relative(STEEL.rotated(matrix).stiffness(), STEEL.stiffness()) < ROUNDING
    assert relative(WOOD.rotated(matrix).rotated(matrix.T).stiffness(), WOOD.stiffness()) < ROUNDING


def test_turns_in_the_plane_add_up():
    expected = WOOD.rotated(0.7).stiffness()
    assert relative(WOOD.rotated(0.4).rotated(0.3).stiffness(), expected) < ROUNDING
    assert relative(WOOD.rotated(Rotation.from_euler("z", 0.7).as_matrix()).stiffness(), expected) < ROUNDING


def test_hookes_law_of_the_tensor_is_that_of_voigts_matrix():
    strain = np.random.default_rng(1).normal(size=(3, 3))
    strain += strain.T
    stress = np.einsum("ijkl,kl", WOOD.rotated(0.3).tensor(), strain)
    engineering = [strain[i, j] * (1 if i == j else 2) for i, j in VOIGT]
    assert relative(WOOD.rotated(0.3).stiffness() @ engineering, [stress[i, j] for i, j in VOIGT]) < ROUNDING


def test_anisotropic_takes_the_matrix_and_the_tensor():
    turned = WOOD.rotated(Rotation.random(random_state=4).as_matrix())
    for given in (turned.stiffness(), turned.tensor()):
        assert relative(cd.Anisotropic(given).stiffness(), turned.stiffness()) < ROUNDING


def test_orthotropic_constants_are_those_of_the_compliance():
    compliance = np.linalg.inv(WOOD.stiffness())
    assert compliance[0, 0] == pytest.approx(1 / WOOD.E1, rel=ROUNDING)
    assert -compliance[1, 0] / compliance[0, 0] == pytest.approx(WOOD.nu12, rel=ROUNDING)
    assert -compliance[2, 1] / compliance[1, 1] == pytest.approx(WOOD.nu23, rel=ROUNDING)
    assert 1 / compliance[3, 3] == pytest.approx(WOOD.G23, rel=ROUNDING)
    assert 1 / compliance[5, 5] == pytest.approx(WOOD.G12, rel=ROUNDING)


def test_orthotropic_with_equal_axes_is_isotropic():
    E, nu = 3.0, 0.2
    G = E / (2 * (1 + nu))
    same = cd.Orthotropic(E, E, E, nu, nu, nu, G, G, G)
    assert relative(same.stiffness(), cd.Isotropic(E, nu).stiffness()) < ROUNDING


# Bodies made of them. The states are uniform, so elements of any kind have them exactly; the solve's tolerance is
# 1e-13 of the forces, and the smallest stiffness stands to the largest as 1 to 20: 1e-11 leaves room for both.
EXACT = 1e-11


@pytest.mark.parametrize("kinematics", ["plane strain", "plane stress"])
@pytest.mark.parametrize("angle", [0.0, np.pi / 2])
def test_orthotropic_uniform_compression_between_walls(kinematics, angle):
    material = WOOD.rotated(angle)
    solution = solved(pressed(material, kinematics=kinematics))
    free = [1] if kinematics == "plane strain" else [1, 2]  # the directions that can give way
    C = material.stiffness()
    strain = np.zeros(3)
    strain[free] = np.linalg.solve(C[np.ix_(free, free)], [-Q, 0.0][: len(free)])
    assert relative(solution.contact().pressure, Q) < EXACT
    assert shortening(solution, "lower") == pytest.approx(-2 * strain[1], rel=EXACT)
    stress = solution.stress("lower").x.array.reshape(-1, 6)
    assert relative(stress[:, :3], C[:3, :3] @ strain) < EXACT


def test_orthotropic_uniform_compression_in_space():
    material = WOOD.rotated(Rotation.from_euler("y", np.pi / 2).as_matrix())  # the stiff axis along the load
    solution = solved(pressed(material, dim=3, cells=(2, 1, 2)))
    stiffness = material.stiffness()[2, 2]
    assert stiffness == pytest.approx(WOOD.stiffness()[0, 0], rel=ROUNDING)
    assert shortening(solution, "upper") == pytest.approx(2 * Q / stiffness, rel=EXACT)


@pytest.mark.parametrize("angle", [0.0, np.pi / 6, np.pi / 2])
def test_uniaxial_plane_stress_gives_youngs_modulus(angle):
    """Nothing holds the sides: the block shortens by q h / E and shears freely."""
    solution = solved(pressed(WOOD.rotated(angle), sides=False, kinematics="plane stress"))
    c, s = np.sin(angle), np.cos(angle)  # of the load's direction in the material's axes
    compliance = c**4 / WOOD.E1 + s**4 / WOOD.E2 + (1 / WOOD.G12 - 2 * WOOD.nu12 / WOOD.E1) * (c * s) ** 2
    assert shortening(solution, "lower") == pytest.approx(2 * Q * compliance, rel=EXACT)
    stress = solution.stress("upper").x.array.reshape(-1, 6)
    assert relative(stress, [0.0, -Q, 0.0, 0.0, 0.0, 0.0]) < EXACT


@pytest.mark.parametrize("kinematics", ["plane strain", "plane stress"])
def test_functions_that_are_constant_give_the_constant_material(kinematics):
    """Two ways to the same matrices, so the results differ by rounding, enlarged by the condition of the system."""
    wood = pressed(WOOD.rotated(0.5), lower=STEEL, kinematics=kinematics)
    turned = WOOD.rotated(lambda x: 0.5 + 0 * x[0])
    steel = cd.Isotropic(E=lambda x: np.full(x.shape[1], STEEL.E), nu=lambda x: STEEL.nu)
    varying = pressed(turned, lower=steel, kinematics=kinematics)
    expected, found = solved(wood), solved(varying)
    for body in ("lower", "upper"):
        assert relative(found.displacement(body).x.array, expected.displacement(body).x.array) < 1e-9
        assert relative(found.stress(body).x.array, expected.stress(body).x.array) < 1e-9


def test_modulus_that_jumps_between_cells():
    """Two springs in series, exact: the modulus is taken inside the cells, never on their edges."""
    material = cd.Isotropic(E=lambda x: np.where(x[1] % 2 < 1, 1e3, 4e3), nu=0.0)
    solution = solved(pressed(material, kinematics="plane stress"))
    assert shortening(solution, "lower") == pytest.approx(Q / 1e3 + Q / 4e3, rel=EXACT)
    assert relative(solution.stress("lower").x.array.reshape(-1, 6)[:, 1], -Q) < EXACT


@pytest.mark.parametrize(("degree", "rate"), [(1, 2.0), (2, 4.0)])
@pytest.mark.parametrize("shape", ["triangle", "quadrilateral"])
def test_column_of_varying_modulus_shortens_as_its_integral(degree, rate, shape):
    """q ∫ dy / E over the height, from the work q · shortening; it converges at twice the rate of the strains."""
    material = cd.Isotropic(E=lambda x: 1e3 * (1 + x[1] % 2), nu=0.0)
    exact = Q / 1e3 * np.log(3.0)
    cells, errors = [4, 8, 16], []
    for n in cells:
        scene = pressed(material, cells=(1, n), degree=degree, shape=shape)
        errors.append(abs(2 * solved(scene).elastic_energy("lower") / (3 * Q) / exact - 1))
    fitted = -np.polyfit(np.log(cells), np.log(errors), 1)[0]
    assert fitted > rate - 0.15  # the coarsest mesh isn't quite in the asymptotic range
    assert errors[-1] < 1e-3


def test_fibres_that_turn_with_the_place_are_the_tensor_that_turns():
    scene = pressed(WOOD.rotated(lambda x: 0.3 * x[0]))
    given = cd.Anisotropic(lambda x: np.moveaxis(WOOD.rotated(lambda y: 0.3 * y[0]).tensor(x), 0, -1))
    expected, found = solved(scene), solved(pressed(given))
    # Both enter as the same matrices to rounding; the systems' condition enlarges it.
    assert relative(found.displacement("upper").x.array, expected.displacement("upper").x.array) < 1e-9
    assert np.ptp(expected.contact().pressure) > 0.1 * Q  # and the pressure is not a uniform one


# What is refused


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: cd.Isotropic(E=0.0, nu=0.3), ValueError, "E = 0: expected a number > 0"),
        (lambda: cd.Isotropic(E=-1.0, nu=0.3), ValueError, "E = -1"),
        (lambda: cd.Isotropic(E=np.nan, nu=0.3), ValueError, "E = nan: expected a finite number"),
        (lambda: cd.Isotropic(E="steel", nu=0.3), TypeError, "E = 'steel': expected a number"),
        (lambda: cd.Isotropic(E=1.0, nu=0.5), ValueError, "nu = 0.5: expected -1 < nu < 0.5"),
        (lambda: cd.Isotropic(E=1.0, nu=-1.0), ValueError, "nu = -1"),
        (lambda: cd.Isotropic(E=cd.Parameter(1.0), nu=0.2), TypeError, "E = Parameter"),
        (lambda: cd.Orthotropic(1, 1, 1, 1.1, 0, 0, 1, 1, 1), ValueError, "nu12 = 1.1: expected nu12² < E1/E2"),
        (lambda: cd.Orthotropic(1, 1, 4, 0, 0.6, 0, 1, 1, 1), ValueError, "nu13 = 0.6: expected nu13² < E1/E3"),
        (lambda: cd.Orthotropic(1, 1, 1, 0.6, 0.6, 0.6, 1, 1, 1), ValueError, "nu12, nu13, nu23.* = -0.512"),
        (lambda: cd.Orthotropic(1, 1, 1, 0, 0, 0, 1, -2, 1), ValueError, "G13 = -2: expected a number > 0"),
        (lambda: cd.Anisotropic(np.eye(5)), ValueError, "C: expected values of shape"),
        (lambda: cd.Anisotropic(np.diag([1, 1, 1, 1, 1, -0.5])), ValueError, "eigenvalue is -0.5; .*positive definite"),
        (lambda: cd.Anisotropic(np.diag([1, 1, 1, 1, 1, 0.0])), ValueError, "positive definite"),
        (lambda: cd.Anisotropic(np.eye(6) + np.eye(6, k=1) * 0.1), ValueError, "C_12 = 0.1, its partner 0: .*C_klij"),
        (lambda: cd.Anisotropic(np.full((6, 6), np.nan)), ValueError, "C: not finite"),
        (lambda: cd.Anisotropic(np.einsum("ik,jl->ijkl", np.eye(3), np.eye(3))), ValueError, "C_jikl"),
        (lambda: WOOD.rotated(np.eye(3) * 1.1), ValueError, "expected an angle or an orthogonal matrix"),
        (lambda: WOOD.rotated(np.inf), ValueError, "rotation: not finite"),
        (lambda: cd.Body("b", cd.rectangle((0, 0), (1, 1), (1, 1)), 3.0), TypeError, "material = 3.0"),
    ],
)
def test_wrong_materials_are_refused_by_name(make, error, message):
    with pytest.raises(error, match=message):
        make()


@pytest.mark.parametrize(
    ("material", "message"),
    [
        (cd.Isotropic(E=lambda x: x[1] - 1.0, nu=0.3), r"E = -\d.* at x = \[.*expected a number > 0"),
        (cd.Isotropic(E=1.0, nu=lambda x: 0.6 * x[1]), r"nu = .* at x = .*expected -1 < nu < 0.5"),
        (cd.Isotropic(E=lambda x: np.log(x[1] - 1.0), nu=0.3), r"E: not finite at x = "),
        (cd.Anisotropic(lambda x: np.multiply.outer(np.eye(6), 1 - x[1])), r"C at x = .*positive definite"),
        (WOOD.rotated(lambda x: np.ones((2, 2))), "rotation: expected values of shape"),
    ],
)
@pytest.mark.filterwarnings("ignore:invalid value")
def test_varying_materials_are_checked_where_they_are_used(material, message):
    with pytest.raises(ValueError, match=message):
        solved(pressed(material))
