"""What stands for a body on other ranks tells the same of its contact surfaces as the body, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

import contactdd as cd
from contactdd.base import compat
from contactdd.interface.discretise import discretise
from contactdd.mesh import from_arrays
from contactdd.skin import skin

STEEL = cd.Isotropic(2.1e5, 0.3)
VARYING = cd.Isotropic(E=lambda x: 1e5 * (1 + x[0] ** 2 + x[1]), nu=0.3)


def bent(mesh: cd.Mesh) -> cd.Mesh:
    """The mesh with its top bent, so that other meshes do not match it and its facets do not tell everything."""
    x = mesh.domain.geometry.x
    x[:, mesh.dim - 1] -= 0.05 * x[:, mesh.dim - 1] * (x[:, 0] - 1) ** 2
    return cd.Mesh(mesh.domain, mesh.surfaces)


def curved() -> cd.Mesh:
    """Triangles of second order, their top a parabola."""
    x = np.array([[0, 0], [2, 0], [2, 1], [0, 1], [1, 0], [2, 0.5], [1, 0.5], [1, 1.05], [0, 0.5]], dtype=float)
    cells = np.array([[0, 1, 2, 5, 6, 4], [0, 2, 3, 7, 8, 6]])
    mesh = from_arrays(cells, x, compat.coordinate_element("triangle", 2), {"top": np.array([[1, 0]])}, {})
    return mesh.refined().refined()


MESHES = {
    "triangles": lambda: cd.rectangle((0, 0), (2, 1), (7, 3)),
    "bent quadrilaterals": lambda: bent(cd.rectangle((0, 0), (2, 1), (7, 3), shape="quadrilateral")),
    "curved triangles": curved,
    "bent tetrahedra": lambda: bent(cd.box((0, 0, 0), (2, 1, 1), (4, 3, 2))),
    "hexahedra": lambda: cd.box((0, 0, 0), (2, 1, 1), (4, 3, 2), shape="hexahedron"),
}


@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("kind", MESHES)
def test_contacts_are_discretised_alike(kind, degree):
    """At Gauss points and at nodes: points, areas, gaps, moduli, and the traces of a displacement."""
    mesh = MESHES[kind]()
    body = cd.Body("low", mesh, VARYING if degree == 2 else STEEL, degree=degree)
    plane = mesh.dim == 2
    upper = cd.rectangle((-0.2, 1.1), (2, 2), (5, 2)) if plane else cd.box((-0.2, 0, 1.1), (2, 1.3, 2), (3, 3, 2))
    partner = cd.Body("high", upper, STEEL)
    told, known = skin(body, ["top"])
    there, order = told.body()
    assert there.mesh.cells < mesh.cells
    assert there.mesh.size == mesh.size
    u = np.random.default_rng(1).standard_normal(body.dofs)
    for rule in ("gauss", "mortar"):
        contacts = [
            cd.Contact((each, "top"), (partner, "bottom"), cd.LinearLayer(1.0), quadrature=rule)
            for each in (body, there)
        ]
        one, other = (discretise(contact, (0, 1)) for contact in contacts)
        for name in ("x", "normal", "weights", "gap", "facet_stiffness", "unpaired_area"):
            np.testing.assert_array_equal(getattr(other, name), getattr(one, name), err_msg=name)
        whole, part = one.sides[0], other.sides[0]
        np.testing.assert_array_equal(part.meshed.moduli, whole.meshed.moduli)
        # Sums of the same numbers in another order.
        np.testing.assert_allclose(part.trace @ u[known][order], whole.trace @ u, rtol=0, atol=1e-13)


def test_rings_of_several_materials():
    mesh = cd.rectangle((0, 0), (2, 1), (4, 3)).with_subdomains(core=lambda x: x[0] < 1, rim=lambda x: x[0] > 1)
    body = cd.Body("ring", mesh, {"core": STEEL, "rim": cd.Isotropic(1e5, 0.2)}, kinematics="axisymmetric")
    there, _ = skin(body, ["top", "right"])[0].body()
    plane = cd.RigidBody("plane", cd.Plane((0, 1), (0, -1)), kinematics="axisymmetric")
    contacts = [cd.Contact((each, "top"), plane, cd.LinearLayer(1.0)) for each in (body, there)]
    one, other = (discretise(contact, (0, 1)) for contact in contacts)
    np.testing.assert_array_equal(other.weights, one.weights)
    # The corner's cell lies at two surfaces, one of which is asked.
    np.testing.assert_array_equal(other.sides[0].meshed.moduli, one.sides[0].meshed.moduli)
    assert other.sides[0].meshed.moduli.min() < 1.1e5 < other.sides[0].meshed.moduli.max()
    assert there.area("right") == body.area("right")
