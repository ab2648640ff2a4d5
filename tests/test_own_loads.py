"""Loads of the user's own: linear forms in UFL, arithmetic with parameters, and what changes between solves."""

from __future__ import annotations

import numpy as np
import pytest
import ufl
from dolfinx import fem
from scenes import STEEL, block, stack

import contactdd as cd

#: Both blocks are 1 high and 4 long; what presses the upper one down is felt by the contact.
K = 1e4


def scene(*loads: object, mesh: cd.Mesh | None = None, **options: object) -> cd.Scene:
    """A block on another one, under loads of its own."""
    low = block("low", 0.0, (4, 2), supports=[cd.Fixed("bottom")])
    walls = [cd.Symmetry("left", "right")]
    high = cd.Body("high", mesh or upper(), STEEL, supports=walls, loads=loads, **options)
    return stack([low, high], cd.LinearLayer(K), 0.0)


def force(of: cd.Scene) -> float:
    return cd.solve(of).contact().force


def upper() -> cd.Mesh:
    return cd.rectangle((0, 1), (4, 2), (4, 2))


def test_form_of_a_function():
    """Weight by a function of body and test function is weight by a body force, in elements of any degree."""
    own = cd.LinearForm(lambda body, v: body.elements.over_volume(-3.0 * v[1]))
    for degree in (1, 2):
        built_in = cd.solve(scene(cd.BodyForce((0.0, -3.0)), degree=degree))
        mine = cd.solve(scene(own, degree=degree))
        np.testing.assert_allclose(
            mine.displacement("high").x.array, built_in.displacement("high").x.array, rtol=0, atol=1e-12
        )
        assert mine.forces("high")["loads"][1] == pytest.approx(-12.0, rel=1e-12)


def test_form_with_its_own_test_function_and_constant():
    """A form on the user's own space; changed Constants and Functions are seen; solutions keep theirs."""
    mesh = upper()
    space = fem.functionspace(mesh.domain, ("Lagrange", 2, (2,)))  # not the body's: of another degree
    q, f = fem.Constant(mesh.domain, 40.0), fem.Function(fem.functionspace(mesh.domain, ("DG", 0)))
    v, n = ufl.TestFunction(space), ufl.FacetNormal(mesh.domain)
    facets = [(7, mesh.entities("top").ravel())]
    top = ufl.Measure("ds", domain=mesh.domain, subdomain_data=facets)(7)
    pressed = scene(cd.LinearForm(-q * ufl.dot(v, n) * top - f * v[1] * ufl.dx), mesh=mesh)
    first = cd.solve(pressed)
    assert first.contact().force == pytest.approx(160.0, rel=1e-9)
    q.value = 80.0
    assert force(pressed) == pytest.approx(320.0, rel=1e-9)
    f.x.array[:] = 5.0
    assert force(pressed) == pytest.approx(340.0, rel=1e-9)
    f.x.array[3] = np.nan
    with pytest.raises(ValueError, match="finite"):
        cd.solve(pressed)
    f.x.array[3] = 5.0
    assert force(pressed) == pytest.approx(340.0, rel=1e-9)
    estimate = cd.error_estimate(first)  # of the loads that it was found with
    assert estimate.better.contact().force == pytest.approx(160.0, rel=1e-9)
    assert q.value == 80.0


def test_constants_in_loads_that_are_not_forms():
    """A Constant in a UFL expression of a pressure is seen as well."""
    mesh = upper()
    q = fem.Constant(mesh.domain, 10.0)
    pressed = scene(cd.Pressure("top", 2 * q), mesh=mesh)
    assert force(pressed) == pytest.approx(80.0, rel=1e-9)
    q.value = 20.0
    assert force(pressed) == pytest.approx(160.0, rel=1e-9)


def test_arithmetic_with_parameters():
    """2q, −q, [0, −q], q² + 1 and arrays times q follow q; the signs are those of the loads."""
    q = cd.Parameter(3.0)
    for load, expected in (
        (cd.Pressure("top", 2 * q), 8.0),
        (cd.Pressure("top", 1 * q), 4.0),
        (cd.Traction("top", [0, -q]), 4.0),
        (cd.Resultant("top", np.array([0.0, -1.0]) * q), 1.0),
        (cd.BodyForce([0, 1 - q / 0.5 - 1]), 8.0),
    ):
        pressed = scene(load)
        for value in (3.0, 5.0):
            q.value = value
            assert force(pressed) == pytest.approx(expected * value, rel=1e-9), load
    assert cd.programme(scene(cd.Pressure("top", q**2 + 1)), q, [1.0, 2.0]).solutions[1].contact().force == (
        pytest.approx(20.0, rel=1e-9)
    )


def test_a_function_that_reads_a_parameter():
    """`follows` tells a solve to ask the function again."""
    q = cd.Parameter(1.0)
    form = cd.LinearForm(lambda body, v: body.elements.over_surface(-q.value * v[1], "top"), follows=[q])
    pressed = scene(form)
    assert force(pressed) == pytest.approx(4.0, rel=1e-9)
    q.value = 2.0
    assert force(pressed) == pytest.approx(8.0, rel=1e-9)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: cd.LinearForm(3.0), "form = 3.0"),
        (lambda: cd.LinearForm(lambda body, v: 3.0), "returned 3.0"),
        (lambda: cd.LinearForm(lambda body, v: ufl.inner(v, ufl.TrialFunction(body.space)) * ufl.dx), "2 arguments"),
        (lambda: cd.LinearForm(lambda body, v: ufl.TestFunction(scalars(body)) * ufl.dx), r"shape \(\)"),
        (lambda: cd.LinearForm(ufl.TestFunction(vectors())[1] * ufl.dx), "another mesh"),
        (lambda: cd.Pressure("top", fem.Constant(upper().domain, 1.0)), "another mesh"),
        (lambda: cd.LinearForm(lambda body, v: v[1] * ufl.ds(2)), "without parts"),
        (lambda: cd.Pressure("top", 1 / cd.Parameter(0.0)), "finite"),
        (lambda: cd.Parameter(1.0) * "two", "operand"),
    ],
)
def test_refusals(make, words):
    with pytest.raises((TypeError, ValueError), match=words):
        cd.solve(scene(make()))


def scalars(body: cd.Body) -> fem.FunctionSpace:
    return fem.functionspace(body.mesh.domain, ("Lagrange", 1))


def vectors() -> fem.FunctionSpace:
    return fem.functionspace(upper().domain, ("Lagrange", 1, (2,)))
