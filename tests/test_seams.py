"""Where two features meet: tensors that are functions, constants of UFL in materials, hints about bonds."""

import numpy as np
import pytest
import ufl
from dolfinx import fem

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


@pytest.mark.parametrize(
    ("in_ufl", "as_plain"),
    [
        (lambda mesh: cd.Isotropic(fem.Constant(mesh.domain, 1e3), fem.Constant(mesh.domain, 0.3)), SOFT),
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
