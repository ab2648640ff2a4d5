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
    contact = cd.Contact((lower, "top"), (upper, "bottom"), LAYER)
    with pytest.raises(ValueError, match="prescribe different displacements"):
        cd.Scene([lower, upper], [contact])


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


def scene(comm):
    lower, upper, contact = pair()
    return cd.Scene([lower, upper], [contact], comm=comm)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: cd.Body("a", square(), STEEL, degree=None), "degree = None: expected a whole number"),
        (lambda: cd.Body("a", square(), STEEL, degree=np.nan), "degree = nan: expected a whole number"),
        (lambda: cd.Body("a", square(), STEEL, degree=np.inf), "degree = inf: expected a whole number"),
        (lambda: cd.Body("a", square(), STEEL, degree=[1]), r"degree = \[1\]: expected a whole number"),
        (lambda: cd.Body("a", square(), STEEL, degree="2"), "degree = '2': expected a whole number"),
        (lambda: cd.rectangle((0, 0), (1, 1), 4), "cells = 4: expected 2 entries"),
        (lambda: cd.rectangle((0, 0), (1, 1), None), "cells = None: expected 2 entries"),
        (lambda: cd.rectangle((0, 0), (1, 1), "ab"), "cells = 'ab': expected 2 entries"),
        (lambda: cd.rectangle((0, 0), (1, 1), (np.nan, 2)), "cells = nan: expected a whole number"),
        (lambda: cd.rectangle((0, 0), (1, 1), (np.inf, 2)), "cells = inf: expected a whole number"),
        (lambda: cd.box((0, 0, 0), (1, 1, 1), (None, 2, 2)), "cells = None: expected a whole number"),
        (lambda: cd.rectangle((0, 0), (1, 1), ([0, "a", 1], 2)), "cells = .*expected increasing coordinates"),
        (lambda: cd.rectangle("ab", (1, 1), (2, 2)), "corner = 'ab': expected a point of 2 finite coordinates"),
        (lambda: cd.rectangle((-np.inf, 0), (1, 1), (2, 2)), "corners .*expected two points"),
        (lambda: pair(quadrature_degree="a"), "quadrature_degree = 'a': expected a whole number"),
        (lambda: pair(quadrature_degree=1.5), "quadrature_degree = 1.5: expected a whole number"),
        (lambda: pair(gap="x"), "gap = 'x': expected a finite number"),
        (lambda: pair(gap=None), "gap = None: expected a finite number"),
        (lambda: pair(gap=[1, 2]), r"gap = \[1, 2\]: expected a finite number"),
        (lambda: pair(gap=cd.Parameter([0.0, 0.0])), r"gap = Parameter\(.*expected a finite number"),
        (lambda: pair(name=5), "name = 5: expected a text"),
        (lambda: cd.Pressure("top", "10"), "pressure = '10': expected a finite number"),
        (lambda: cd.Pressure("top", None), "pressure = None: expected a finite number"),
        (lambda: cd.Pressure("top", 1j), "pressure = 1j: expected a finite number"),
        (lambda: cd.Pressure("top", cd.Parameter([0, 0])), r"pressure = Parameter\(.*expected a finite number"),
        (lambda: cd.Traction("top", 1.0), "traction = 1.0: expected 2 or 3 finite numbers"),
        (lambda: cd.BodyForce("ab"), "body force = 'ab': expected 2 or 3 finite numbers"),
        (lambda: cd.Resultant("top", "ab"), "force = 'ab': expected 2 or 3 finite numbers"),
        (lambda: cd.Body("a", square(), STEEL, loads=[cd.Pressure(None, 1.0)]), "surface = None: .*'bottom', 'left'"),
        (lambda: cd.Body("a", square(), STEEL, supports=[cd.Fixed(["top"])]), r"surface = \['top'\]: the mesh has no"),
        (lambda: cd.Displacement("left", 0.0), "values = 0.0: expected a list, one entry per coordinate"),
        (lambda: cd.Displacement("left", cd.Parameter([0, 0])), r"values = Parameter\(.*expected a list, one entry"),
        (lambda: cd.Displacement("left", ("a", None)), "displacement = 'a': expected a finite number"),
        (lambda: cd.Displacement("left", ([1, 2], None)), r"displacement = \[1, 2\]: expected a finite number"),
        (lambda: cd.Parameter("a"), "value = 'a': expected finite numbers"),
        (lambda: cd.Parameter([[1], [1, 2]]), "value = .*expected finite numbers"),
        (lambda: square().moved("ab"), "offset = 'ab': expected 2 finite numbers"),
        (lambda: STEEL.rotated("a"), "rotation = 'a': expected an angle or an orthogonal matrix"),
        (lambda: cd.Anisotropic("a"), "C = 'a': expected a matrix"),
        (lambda: cd.from_dolfinx(5), "domain = 5: expected a dolfinx mesh"),
        (lambda: scene(comm=None), "comm = None: expected an MPI communicator"),
        (lambda: square().with_surfaces(lid=5), "lid = 5: expected a function"),
        (lambda: square().with_surfaces(lid=lambda x: None), r"lid: the function returned object of shape \(\)"),
        (lambda: square().with_surfaces(lid=lambda x: x[0]), "lid: the function returned float64.*expected bool"),
        (lambda: square().with_surfaces(lid=lambda x: True), r"lid: the function returned bool of shape \(\)"),
    ],
)
def test_what_is_no_such_thing_at_all(make, message):
    with pytest.raises((TypeError, ValueError), match=message):
        make()


@pytest.mark.parametrize("wrong", [lambda x: "a", lambda x: None])
def test_a_gap_function_that_returns_no_numbers(wrong):
    lower, upper, contact = pair(gap=wrong)
    with pytest.raises((TypeError, ValueError), match="gap"):
        _ = cd.Scene([lower, upper], [contact]).interfaces


def test_whole_numbers_and_masks_of_numpy_are_taken():
    mesh = cd.rectangle((0, 0), (1, 1), np.array([2, 3])).with_surfaces(half=lambda x: (x[0] < 0.6).astype(int))
    assert len(mesh.facets("half")) == 5
    assert cd.Body("a", mesh, STEEL, degree=np.int64(2)).degree == 2
    assert cd.Body("a", mesh, STEEL, degree=2.0).degree == 2
    assert pair(gap=np.float32(0.5))[2].gap == 0.5
