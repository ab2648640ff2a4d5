"""Bad input is refused before any assembly, by name, with what was given and what was expected."""

from __future__ import annotations

import numpy as np
import pytest

import contactdd as cd

STEEL = cd.Isotropic(E=1.0, nu=0.3)
LAYER = cd.LinearLayer(1.0)


def square(y=0.0, n=2):
    return cd.rectangle((0, y), (1, y + 1), (n, n))


def pair(n=(2, 2), **options):
    lower, upper = cd.Body("lower", square(0, n[0]), STEEL), cd.Body("upper", square(1, n[1]), STEEL)
    return lower, upper, cd.Contact((lower, "top"), (upper, "bottom"), LAYER, **options)


@pytest.mark.parametrize("E", [0.0, -1.0, np.nan, np.inf])
def test_youngs_modulus(E):
    with pytest.raises(ValueError, match="E = "):
        cd.Isotropic(E=E, nu=0.3)


@pytest.mark.parametrize("nu", [0.5, 0.7, -1.0, np.nan])
def test_poissons_ratio(nu):
    with pytest.raises(ValueError, match="nu = "):
        cd.Isotropic(E=1.0, nu=nu)


def test_text_is_no_number():
    with pytest.raises(TypeError, match="E = '1'"):
        cd.Isotropic(E="1", nu=0.3)


def test_unknown_surfaces_are_refused_with_the_known_ones():
    with pytest.raises(ValueError, match=r"'lid'.*'bottom', 'left', 'right', 'top'"):
        cd.Body("a", square(), STEEL, loads=[cd.Pressure("lid", 1.0)])
    with pytest.raises(ValueError, match="'lid'"):
        cd.Body("a", square(), STEEL, supports=[cd.Fixed("lid")])
    body = cd.Body("a", square(), STEEL)
    with pytest.raises(ValueError, match="'lid'"):
        cd.Contact((body, "lid"), (body, "top"), LAYER)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: cd.rectangle((0, 0), (0, 1), (2, 2)), "corners"),
        (lambda: cd.rectangle((0, 0), (1, 1), (0, 2)), "cells"),
        (lambda: cd.rectangle((0, 0), (1, 1), (2, 2), shape="pentagon"), "shape"),
        (lambda: cd.box((0, 0, 0), (1, 1, 1), (2, 2)), "cells"),
        (lambda: cd.Body("a", square(), STEEL, degree=0), "degree"),
        (lambda: cd.Body("a", square(), STEEL, kinematics="solid"), "kinematics"),
        (lambda: cd.Body("a", square(), STEEL, kinematics="flat"), "kinematics"),
        (lambda: pair(quadrature="random"), "quadrature"),
    ],
)
def test_values(make, message):
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: cd.Body("", square(), STEEL), "name"),
        (lambda: cd.Body("a", "mesh", STEEL), "mesh"),
        (lambda: cd.Body("a", square(), 2.1e5), "material"),
        (lambda: cd.Contact("a", "b", LAYER), "first"),
        (lambda: cd.Body("a", square(), STEEL, supports=cd.Fixed("top")), "supports = .*expected a list of Fixed or"),
        (lambda: cd.Body("a", square(), STEEL, loads=[10.0]), "loads = .*expected a list of Pressure or"),
        (lambda: cd.Scene(["a", "b"], []), "bodies = .*expected a list of Body"),
        (lambda: cd.Contact(pair()[2].sides[0], pair()[2].sides[1], 1e5), "layer"),
    ],
)
def test_types(make, message):
    with pytest.raises(TypeError, match=message):
        make()


def test_a_scene_needs_bodies_that_touch():
    lower, upper, _ = pair()
    for bodies in ([], [lower], [lower, upper]):
        with pytest.raises(ValueError, match="expected at least two bodies and a contact"):
            cd.Scene(bodies, [])


def test_names_used_twice():
    lower, upper, contact = pair()
    twin = cd.Body("lower", square(3), STEEL)
    with pytest.raises(ValueError, match="'lower' is used 2 times"):
        cd.Scene([lower, upper, twin], [contact])


def test_surface_used_twice():
    lower, upper, contact = pair()
    third = cd.Body("third", square(1), STEEL)
    again = cd.Contact((lower, "top"), (third, "bottom"), LAYER)
    with pytest.raises(ValueError, match=r"'top' of body 'lower'.*uses already"):
        cd.Scene([lower, upper, third], [contact, again])


def test_body_that_is_not_in_the_scene():
    lower, _, contact = pair()
    with pytest.raises(ValueError, match="'upper' is not in the scene"):
        cd.Scene([lower], [contact])


def test_body_without_contact():
    lower, upper, contact = pair()
    with pytest.raises(ValueError, match=r"'alone'.*no contact"):
        cd.Scene([lower, upper, cd.Body("alone", square(5), STEEL)], [contact])


def test_gap_with_nan():
    lower, upper, contact = pair(gap=lambda x: np.where(x[0] < 0.5, np.nan, 0.0))
    with pytest.raises(ValueError, match="gap: not finite at x"):
        _ = cd.Scene([lower, upper], [contact]).interfaces


def test_gap_of_a_wrong_shape():
    lower, upper, contact = pair(gap=lambda x: np.zeros((2, 2, 2)))
    with pytest.raises(ValueError, match="gap: expected values of shape"):
        _ = cd.Scene([lower, upper], [contact]).interfaces


def test_layer_that_is_not_monotone():
    with pytest.raises(ValueError, match="increas"):
        cd.CustomLayer(np.sin, compression_range=10.0)


def test_conflicting_supports():
    supports = [cd.Displacement("left", (0.1, None)), cd.Displacement("bottom", (0.0, 0.0))]
    lower = cd.Body("lower", square(), STEEL, supports=supports)
    upper = cd.Body("upper", square(1), STEEL)
    scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), LAYER)])
    with pytest.raises(ValueError, match="prescribe different displacements"):
        cd.solve(scene)


def test_symmetry_plane_that_is_not_flat():
    mesh = square().with_surfaces(two_sides=lambda x: np.isclose(x[0], 0) | np.isclose(x[1], 0))
    body = cd.Body("lower", mesh, STEEL, supports=[cd.Symmetry("two_sides")])
    upper = cd.Body("upper", square(1), STEEL)
    scene = cd.Scene([body, upper], [cd.Contact((body, "top"), (upper, "bottom"), LAYER)])
    with pytest.raises(ValueError, match="flat surface"):
        cd.solve(scene)


def test_vertex_rule_on_quadratic_elements():
    lower, upper = (cd.Body(name, square(y), STEEL, degree=2) for name, y in (("lower", 0), ("upper", 1)))
    scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), LAYER, quadrature="vertex")])
    with pytest.raises(ValueError, match="vertex"):
        _ = scene.interfaces
