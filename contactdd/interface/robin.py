"""The Robin term ∫ φ u_n v_n ds of a contact surface in UFL (22), or its part of ∫ φ u_t·v_t ds."""

from __future__ import annotations

import numpy as np
import scipy
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from ..base import compat
from ..base.arrays import Floats
from .surface import ContactSurface


class RobinTerm:
    """∫ φ u_n v_n ds in UFL, φ a function on the submesh of the contact facets, refreshed at every iteration.

    Along a tangent it is an equal share of ∫ φ u_t·v_t ds: φ is the same along both of them.
    """

    def __init__(self, surface: ContactSurface) -> None:
        body = surface.body
        submesh, parents, entity_map = compat.facet_submesh(body.mesh.domain, surface.facets)
        space = fem.functionspace(submesh, surface.rule.element(submesh.topology.cell_name()))
        self.phi = fem.Function(space, name="robin_coefficient")
        self._dofs = _value_dofs(surface, space, parents)
        u, v = ufl.TrialFunction(body.space), ufl.TestFunction(body.space)
        form = body.robin_form if surface.across is None else body.sliding_form
        expression = form(u, v, self.phi, surface.surface, surface.rule.metadata)
        self._form = compat.form(expression, entity_map)
        self._matrix = fem.create_matrix(self._form)

    def matrix(self, phi: Floats) -> scipy.sparse.csr_matrix:
        """The assembled Robin term for the coefficient's values; its sparsity is always the same."""
        self.phi.x.array[self._dofs] = phi
        self.phi.x.scatter_forward()
        self._matrix.set_value(0.0)
        fem.assemble_matrix(self._matrix, self._form)
        return self._matrix.to_scipy().tocsr()


def _value_dofs(surface: ContactSurface, space: fem.FunctionSpace, parents: NDArray[np.int32]) -> NDArray[np.int32]:
    """The degree of freedom of φ that belongs to each of the surface's values.

    The points of a facet come in the submesh's own order, so they are recognised by where they are.
    """
    cells = np.argsort(parents)  # the surface's facets are sorted
    dofs = space.dofmap.list[cells]
    dim = surface.body.mesh.dim
    there = space.tabulate_dof_coordinates()[dofs][:, :, :dim]
    here = surface.mean(surface.points.x).reshape(len(cells), -1, dim)
    nearest = np.argmin(np.linalg.norm(here[:, :, None] - there[:, None], axis=-1), axis=2)
    return np.take_along_axis(dofs, nearest, axis=1).ravel()
