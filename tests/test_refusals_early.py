"""What cannot be is refused where it is given, by name, before anything is assembled."""

from __future__ import annotations

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest
import ufl

import contactdd as cd

STEEL = cd.Isotropic(2.1e5, 0.3)
LAYER = cd.PowerLayer(4e-6, 1.1)
K = 2.5e6


def square(y: float = 0.0) -> cd.Mesh:
    return cd.rectangle((0, y), (1, y + 1), (2, 2))


def body(name: str = "lower", **given) -> cd.Body:
    return cd.Body(name, square(), STEEL, **given)


def scene(supports=(), loads=None, **contact) -> cd.Scene:
    lower = body(supports=[cd.Fixed("bottom"), *supports])
    pressed = [cd.Pressure("top", 10.0)] if loads is None else loads
    upper = cd.Body("upper", square(1.0), STEEL, supports=[cd.Symmetry("left")], loads=pressed)
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), LAYER, **contact)])


def contact(**given) -> cd.Contact:
    return cd.Contact((body(), "top"), (cd.Body("upper", square(1.0), STEEL), "bottom"), LAYER, **given)


def x_of(mesh: cd.Mesh):
    return ufl.SpatialCoordinate(mesh.domain)[0]


REFUSED = {
    "three prescribed values in the plane": (
        lambda: body(supports=[cd.Displacement("top", [0, 0, 0])]),
        ValueError,
        "values = .*expected 2 entries",
    ),
    "three tractions in the plane": (
        lambda: body(loads=[cd.Traction("top", [1, 2, 3])]),
        ValueError,
        r"traction = \[1, 2, 3\]: expected 2 finite numbers",
    ),
    "three body forces in the plane": (
        lambda: body(loads=[cd.BodyForce(np.ones(3))]),
        ValueError,
        "body force = .*expected 2 finite numbers",
    ),
    "a parameter of three numbers in the plane": (
        lambda: body(loads=[cd.Traction("top", cd.Parameter([1.0, 2.0, 3.0]))]),
        ValueError,
        "traction = .*expected 2 finite numbers",
    ),
    "a resultant of three numbers in the plane": (
        lambda: body(loads=[cd.Resultant("top", (0, 1, 2))]),
        ValueError,
        "force = .*expected 2 finite numbers",
    ),
    "a function as a resultant": (lambda: cd.Resultant("top", lambda x: x), TypeError, "force = "),
    "a scalar expression as a traction": (
        lambda: body(loads=[cd.Traction("top", x_of(square()))]),
        ValueError,
        r"traction: expected a UFL expression of shape \(2,\)",
    ),
    "an expression of another mesh as a displacement": (
        lambda: body(supports=[cd.Displacement("top", [x_of(square()), None])]),
        ValueError,
        "Displacement of body 'lower': .* another mesh",
    ),
    "an expression as a gap": (lambda: contact(gap=x_of(square())), TypeError, "gap = .*function of the coordinates"),
    "a spring along nothing": (lambda: cd.Spring("top", 1.0, (0, 0)), ValueError, r"direction = \(0, 0\)"),
    "a spring along one number": (lambda: cd.Spring("top", 1.0, 1.0), ValueError, "direction = 1.0"),
    "a spring along texts": (lambda: cd.Spring("top", 1.0, ("0", "1")), TypeError, "direction = "),
    "a spring along not a number": (lambda: cd.Spring("top", 1.0, (np.nan, 1)), ValueError, "direction = "),
    "a spring into space in the plane": (
        lambda: body(supports=[cd.Spring("top", 1.0, (0, 0, 1))]),
        ValueError,
        "direction = .*expected 2 finite numbers",
    ),
    "contradictory displacements": (
        lambda: scene([cd.Displacement("left", [1e-3, None])]),
        ValueError,
        "body 'lower'.*different displacements",
    ),
    "measure_gap as a text": (lambda: contact(measure_gap="no"), TypeError, "measure_gap = 'no': expected True or"),
    "a plane body on a solid one": (
        lambda: cd.Contact(
            (body(), "top"), (cd.Body("b", cd.box((0, 0, 1), (1, 1, 2), (1, 1, 1)), STEEL), "bottom"), LAYER
        ),
        ValueError,
        "both in the plane or both in space",
    ),
    "elements of degree 50": (lambda: body(degree=50), ValueError, "degree = 50: expected at most"),
    "a law of complex numbers": (lambda: cd.CustomLayer(lambda w: K * w * (1 + 0.1j)), TypeError, "g = .*complex"),
    "a law of one number only": (
        lambda: cd.CustomLayer(lambda w: K * w if w < 0 else 0.0),
        TypeError,
        "g = .*function of arrays.*np.where",
    ),
    "a law that flattens": (
        lambda: cd.CustomLayer(lambda w: K * np.ravel(w), compression_range=1e-3),
        ValueError,
        r"g = .*maps shape \(\d+, 1\) to",
    ),
    "a derivative that flattens": (
        lambda: cd.CustomLayer(lambda w: K * w, derivative=lambda w: np.full(np.size(w), K)),
        ValueError,
        "derivative = .*maps shape",
    ),
    "a derivative below zero where few samples are": (
        lambda: cd.CustomLayer(
            lambda w: K * w, derivative=lambda w: np.where(np.abs(w) < 1e-6, K, -K), compression_range=1e-2
        ),
        ValueError,
        "derivative: -2.5e.06 at w = ",
    ),
    "a table of texts": (lambda: cd.TableLayer(["1", "2"], ["1", "2"]), ValueError, "compressions = "),
    "a step that is none": (
        lambda: replace(cd.SCHEMES["newton"], step="kryolv"),
        ValueError,
        "step = 'kryolv': expected one of",
    ),
    "a scheme without a coefficient": (
        lambda: cd.Scheme("mine", 3.0, "direct", ""),
        TypeError,
        "coefficient = 3.0: expected a function",
    ),
    "ψ that is no function": (lambda: cd.one_point(1.0), TypeError, "psi = 1.0"),
    "a method that is a list": (lambda: cd.solve(scene(), ["chord"]), ValueError, "method = "),
    "an answer that is a list": (lambda: cd.solve(scene(), on_failure=["raise"]), ValueError, "on_failure = "),
    "progress as a text": (lambda: cd.solve(scene(), progress="no"), TypeError, "progress = 'no'"),
    "resume as a text": (lambda: cd.solve(scene(), resume="no"), TypeError, "resume = 'no'"),
    "a device as a checkpoint": (lambda: cd.solve(scene(), checkpoint="/dev/null"), ValueError, "checkpoint = "),
}


@pytest.mark.parametrize("what", REFUSED)
def test_refused(what):
    make, error, message = REFUSED[what]
    with pytest.raises(error, match=message):
        make()


def phi_of(values):
    return cd.Scheme("mine", lambda layer, z, z_previous, x: values(layer.contact_derivative(z)), "decomposed", "")


@pytest.mark.parametrize(
    ("values", "error", "message"),
    [
        (lambda phi: -phi, ValueError, "scheme 'mine': φ = -.* expected φ >= 0"),
        (lambda phi: phi * np.nan, ValueError, "scheme 'mine': φ = nan"),
        (lambda phi: phi[:-1], ValueError, r"scheme 'mine': φ has the shape"),
        (lambda phi: float(phi[0]), ValueError, r"scheme 'mine': φ has the shape \(\)"),
        (lambda phi: phi[:, None], ValueError, r"scheme 'mine': φ has the shape"),
        (lambda phi: phi * 1j, TypeError, "(?s)phi = .*expected an array of"),
        (lambda phi: None, ValueError, r"scheme 'mine': φ has the shape \(\)"),
    ],
)
def test_a_coefficient_is_a_number_of_at_least_0_at_every_point(values, error, message):
    with pytest.raises(error, match=message):
        cd.solve(scene(), phi_of(values))


def test_a_coefficient_of_the_users_is_taken():
    """The law's own derivative, given by the user, is the one-point method to the last digit."""
    mine, theirs = cd.solve(scene(), phi_of(lambda phi: phi)), cd.solve(scene(), "one-point")
    np.testing.assert_array_equal(mine.contact().pressure, theirs.contact().pressure)


@pytest.mark.parametrize(
    ("psi", "error", "message"),
    [
        (lambda z, x: z, ValueError, "psi: .*expected 0 or 1"),
        (lambda z, x: np.ones(len(z) + 1), ValueError, "psi: shape"),
        (lambda z, x: z * np.nan, ValueError, "psi: nan"),
        (lambda z, x: "all", TypeError, "psi = 'all'"),
    ],
)
def test_a_subset_is_0_or_1_at_every_point(psi, error, message):
    with pytest.raises(error, match=message):
        cd.solve(scene(), cd.one_point(psi))


def test_displacements_that_follow_a_parameter_may_contradict_at_first():
    q = cd.Parameter(1e-3)
    moved = scene([cd.Displacement("left", [q, None])])
    with pytest.raises(ValueError, match="different displacements"):
        cd.solve(moved)
    q.value = 0.0
    assert cd.solve(moved).converged


@pytest.mark.parametrize("values", [None, 5.0, "123", {"a": 1}, np.array(3.0), [1.0, None], [1.0, np.nan], ["1"]])
def test_values_of_a_programme(values):
    q = cd.Parameter(1.0)
    made = scene(loads=[cd.Pressure("top", q)])
    with pytest.raises((TypeError, ValueError), match="value"):
        cd.programme(made, q, values)
    assert q.value == 1.0  # no step was begun


def test_records_of_a_programme():
    q = cd.Parameter(1.0)
    made = scene(loads=[cd.Pressure("top", q)])
    for record in ("force", {"force": 3}, [len]):
        with pytest.raises(TypeError, match="record = "):
            cd.programme(made, q, [1.0], record=record)


def test_a_mesh_is_neither_pickled_nor_copied():
    for action in (copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="function that makes the scene anew"):
            action(scene())


@pytest.mark.parametrize(
    "error", [cd.LooseBodyError("a", "x"), cd.NotConvergedError("s", "r", 1), cd.NoEquilibriumError("a", "x", 1)]
)
def test_errors_cross_to_other_processes(error):
    there = pickle.loads(pickle.dumps(error))
    assert type(there) is type(error)
    assert str(there) == str(error)
