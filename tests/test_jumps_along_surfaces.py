"""A function's jump is looked for along the surface that it acts on: what it is elsewhere says nothing about it."""

from __future__ import annotations

import numpy as np
import pytest
import ufl
from dolfinx import fem
from test_jumping_loads import STEEL, resultant

import contactdd as cd

STRIP = cd.rectangle((0, 0), (4, 1), (16, 4))


@pytest.mark.parametrize("shape", ["triangle", "quadrilateral"])
@pytest.mark.parametrize("degree", [1, 2, 3])
def test_a_function_that_is_zero_under_the_surface(shape, degree):
    """The whole load arrives, though a step into the cells finds none of it."""
    mesh = cd.rectangle((0, 0), (4, 1), (16, 4), shape=shape)
    on_top = cd.Pressure("top", lambda x: np.where(x[1] >= 1.0, 10.0, 0.0))
    assert resultant(on_top, mesh, degree) == pytest.approx([0, -40], abs=1e-12)
    part = cd.Pressure("top", lambda x: 10.0 * ((x[1] >= 1.0) & (x[0] <= 1.0)))
    assert resultant(part, mesh, degree) == pytest.approx([0, -10], abs=1e-12)


@pytest.mark.parametrize("shape", ["tetrahedron", "hexahedron"])
def test_the_same_in_space(shape):
    mesh = cd.box((0, 0, 0), (2, 2, 1), (4, 4, 2), shape=shape)
    down = np.array([[0.0], [0.0], [-8.0]])
    quarter = cd.Traction("top", lambda x: down * ((x[2] >= 1) & (x[0] <= 1) & (x[1] <= 1)))
    assert resultant(quarter, mesh, 1) == pytest.approx([0, 0, -8.0], abs=1e-12)


@pytest.mark.parametrize("tolerance", [1e-14, 1e-8, -1e-8])
def test_steps_with_a_tolerance(tolerance):
    step = cd.Pressure("top", lambda x: np.where(x[0] <= 1 + tolerance, 10.0, 0.0))
    assert resultant(step, STRIP, 1) == pytest.approx([0, -10], abs=1e-12)


def test_large_values_elsewhere_hide_no_step():
    load = cd.Pressure("top", lambda x: np.where(x[1] < 0.5, 1e6, np.where(x[0] <= 1, 10.0, 0.0)))
    assert resultant(load, STRIP, 1) == pytest.approx([0, -10], abs=1e-12)


def test_a_small_body_far_away():
    """Coordinates of 1e6 have rounding of 1e-10, which is 1e-7 of the loaded length."""
    mesh = cd.rectangle((1e6, 0), (1e6 + 4e-3, 1e-3), (16, 4))
    load = cd.Pressure("top", lambda x: np.where(x[0] <= 1e6 + 1e-3, 10.0, 0.0))
    assert resultant(load, mesh, 1) == pytest.approx([0, -0.01], rel=1e-6, abs=1e-12)


def test_a_step_around_an_axis():
    """On a disc of the radius 1 of a plate of the radius 4: the force p π r² of the full ring."""
    load = cd.Pressure("top", lambda x: np.where(x[0] <= 1, 10.0, 0.0))
    body = cd.Body("plate", STRIP, STEEL, supports=[cd.Fixed("bottom")], kinematics="axisymmetric")
    assert total(load.form(body.elements, ufl.TestFunction(body.elements.space)))[1] == pytest.approx(-10 * np.pi)


def test_a_bed_of_springs_under_a_part():
    """The force of springs k on the length 1 that are lifted by 1."""
    bed = cd.Spring("bottom", lambda x: np.where((x[0] <= 1) & (x[1] <= 0), 50.0, 0.0), direction="normal")
    body = cd.Body("block", STRIP, STEEL, supports=[bed])
    lifted = fem.Constant(STRIP.domain, (0.0, 1.0))
    force = total(bed.form(body.elements, lifted, ufl.TestFunction(body.elements.space)))
    assert force == pytest.approx([0, 50], abs=1e-12)


def total(form) -> np.ndarray:
    """The sum (2,) of a linear form over all nodes."""
    return fem.assemble_vector(fem.form(form)).array.reshape(-1, 2).sum(axis=0)


def test_parameters_and_the_number_of_calls():
    """A function of a parameter has its present value; a load is asked twice, the second time on its surface alone."""
    points = []

    def step(p, x):
        points.append(x.shape[1])
        return np.where(x[0] <= 1, p, 0.0)

    q = cd.Parameter(10.0)
    load = cd.Pressure("top", q.field(step))
    assert resultant(load, STRIP, 1) == pytest.approx([0, -10], abs=1e-12)
    assert points == [2 * 16 * 4 * 10, 16 * 4]  # polynomials of degree 3
    q.value = 20.0
    assert resultant(load, STRIP, 1) == pytest.approx([0, -20], abs=1e-12)
