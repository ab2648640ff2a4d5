"""The normal displacement at points of a surface, as an operator on a body's degrees of freedom."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import scipy
from dolfinx import fem
from numpy.typing import NDArray

from ..base.arrays import Floats
from ..base.basis import basis_values
from ..base.facets import FacetPoints, _rule_table


def normal_trace(
    space: fem.FunctionSpace, points: FacetPoints, normal: Floats | None = None
) -> scipy.sparse.csr_matrix:
    """The sparse operator from the degrees of freedom of `space` to u·n at the points, (n, dofs).

    normal: (n, dim), another direction than the outward normal.
    """
    basis = basis_values(space.element.basix_element, points.reference)
    point, node = np.nonzero(np.abs(basis) > 1e-14)
    nodes = space.dofmap.list[points.cells[point], node]
    return _normal_operator(space, point, nodes, basis[point, node], points.normal if normal is None else normal)


def surface_trace(
    space: fem.FunctionSpace, entities: NDArray[np.int32], points: Floats, normal: Floats
) -> scipy.sparse.csr_matrix:
    """The same operator at the points of `surface_points`, with the normals there, (n · p, dofs)."""
    nodes, basis = _rule_basis(space.ufl_element().basix_element, points.tobytes())
    cells, local = entities.T
    point = np.repeat(np.arange(len(normal)), nodes.shape[1])
    seen = np.repeat(space.dofmap.list[cells[:, None], nodes[local]], len(points), axis=0)
    return _normal_operator(space, point, seen.ravel(), basis[local].ravel(), normal)


def _normal_operator(
    space: fem.FunctionSpace, point: NDArray[np.intp], nodes: NDArray[np.int32], basis: Floats, direction: Floats
) -> scipy.sparse.csr_matrix:
    """The operator from nodal displacements to u along directions (n, dim) at n points, from the basis functions (m,)
    there: point by point, each one's node and value."""
    dim, size = space.dofmap.bs, space.dofmap.index_map.size_local
    values = basis[:, None] * direction[point]
    # Exact zeros (inner nodes, the components along a flat surface) must not become unknowns of the contact.
    pair, component = np.nonzero(np.abs(values) > 1e-14)
    columns = nodes[pair] * dim + component
    ends = np.searchsorted(point[pair], np.arange(len(direction) + 1))
    entries = (values[pair, component], columns.astype(np.int32), ends.astype(np.int32))
    operator = scipy.sparse.csr_matrix(entries, shape=(len(direction), dim * size))
    operator.sort_indices()
    return operator


@cache
def _rule_basis(element: Any, rule: bytes) -> tuple[NDArray[np.intp], Floats]:
    """The nodes on every facet of the reference cell, (f, k), and their functions at the rule's points, (f, p, k)."""
    nodes = np.array(element.entity_closure_dofs[-2])
    return nodes, np.take_along_axis(_rule_table(element, rule)[1][:, :, 0], nodes[:, None], axis=2)
