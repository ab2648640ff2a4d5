"""Surface loads given by functions that jump at a node: each side of it has its own value, whatever the node has."""

from __future__ import annotations

import numpy as np
import pytest
import ufl
from dolfinx import fem

import contactdd as cd

STEEL = cd.Isotropic(2.1e5, 0.3)


def resultant(load, mesh: cd.Mesh, degree: int) -> np.ndarray:
    """The force of a load, (dim,)."""
    body = cd.Body("body", mesh, STEEL, supports=[cd.Fixed("bottom")], loads=[load], degree=degree)
    form = load.form(body.elements, ufl.TestFunction(body.elements.space))
    return fem.assemble_vector(fem.form(form)).array.reshape(-1, mesh.dim).sum(axis=0)


@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("shape", ["triangle", "quadrilateral"])
def test_the_resultant_of_a_step_is_exact(shape, degree):
    """A load on a part of a side that ends at nodes, where it has the one value or the other."""
    mesh = cd.rectangle((0, 0), (4, 1), (16, 4), shape=shape)
    closed, opened, both = (
        lambda x: np.where(x[0] <= 1, 10.0, 0.0),
        lambda x: np.where(x[0] < 1, 10.0, 0.0),
        lambda x: 10.0 * (np.abs(x[0] - 2) <= 1),
    )
    for step, length in ((closed, 1), (opened, 1), (both, 2)):
        assert resultant(cd.Pressure("top", step), mesh, degree) == pytest.approx([0, -10 * length], abs=1e-12)
    sheared = cd.Traction("top", lambda x: np.stack([np.where(x[0] >= 3, 2.0, -1.0), 0 * x[0]]))
    assert resultant(sheared, mesh, degree) == pytest.approx([2 - 3, 0], abs=1e-12)


def test_a_step_in_space():
    mesh = cd.box((0, 0, 0), (2, 2, 1), (4, 4, 2))
    quarter = cd.Pressure("top", lambda x: 8.0 * ((x[0] <= 1) & (x[1] <= 1)))
    assert resultant(quarter, mesh, 1) == pytest.approx([0, 0, -8.0])


def test_smooth_loads_are_their_interpolants():
    """Polynomials of two degrees more than the displacements, as they were before any jump was looked for."""
    mesh = cd.rectangle((0, 0), (4, 1), (16, 4))
    field = fem.Function(fem.functionspace(mesh.domain, ("Discontinuous Lagrange", 4)))
    field.interpolate(lambda x: np.sin(x[0]))
    smooth = resultant(cd.Pressure("top", lambda x: np.sin(x[0])), mesh, 2)
    assert smooth == pytest.approx(resultant(cd.Pressure("top", field), mesh, 2), rel=1e-14)
