"""The stiffness of cells that are affine images of the reference cell, from integrals made once on that.

On such cells, with one material,

    ∫ ε(v) : C : ε(u) dx = Σ T_abkl ∫ ∂_k φ_i ∂_l φ_j dX,    T_abkl = |det J| Σ_mn J⁻¹_km C_ambn J⁻¹_ln,

for u = φ_j e_b and v = φ_i e_a. The integrals over the reference cell are the same for all of them, so that the cells'
matrices are one product of matrices. At high degrees this is many times faster than quadrature in every cell.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any

import basix
import numpy as np
from numpy.typing import NDArray

from ..base import compat
from ..base.arrays import Floats, Indices
from ..base.basis import quadrature_rule

if TYPE_CHECKING:
    from ..body import Body
    from ..mesh import Mesh


#: Fraction of interior nodes from which cell-wise condensation pays.
WORTHWHILE = 0.11


@dataclass(frozen=True)
class ReferenceIntegrals:
    """∫ ∂_k φ_i ∂_l φ_j over the reference cell, (dim, dim, nodes, nodes): of all nodes, of those inside of the cell,
    of these with those on its boundary, and of the latter."""

    full: Floats
    inner: Floats
    coupling: Floats
    outer: Floats


class AffineCells:
    """A body of affine cells and one material, its stiffness cell by cell.

    mesh: the body's; jacobians: (cells, dim, dim) J; material: (dim, dim, dim, dim) C_ambn; nodes: (cells,
    nodes) of the body's space; inner, outer: those of the reference cell that lie inside of it, and on its boundary;
    integrals: over the reference cell.
    """

    #: How many entries of the cells' matrices are made at a time.
    ENTRIES = 2**20  # 8 MB: what stays in a processor's cache

    def __init__(self, body: Body) -> None:
        element = body.space.ufl_element()
        self.mesh, self.dim = body.mesh, body.mesh.dim
        self.jacobians, self.material = _jacobians(body.mesh), body.kinematics.tensor(body.material.stiffness())
        self.nodes = body.space.dofmap.list
        self.inner, self.outer = _inner_and_outer(element)
        self.integrals = _reference_integrals(element)

    @cached_property
    def tensors(self) -> Floats:
        """T_abkl of every cell, (cells, dim, dim, dim, dim)."""
        inverse = np.linalg.inv(self.jacobians)[:, None, None]
        determinants = np.abs(np.linalg.det(self.jacobians))[:, None, None, None, None]
        return determinants * (inverse @ self.material.transpose(0, 2, 1, 3) @ np.swapaxes(inverse, 3, 4))

    def block(self, integrals: Floats, part: slice = slice(None)) -> Floats:
        """The matrices of some of the cells between some of their nodes, from the reference cell's integrals of these.

        integrals: (dim, dim, n, m). Shape (cells, dim · n, dim · m): all nodes' first components, then the second ones.
        """
        dim, tensors = self.dim, self.tensors[part]
        rows, columns = integrals.shape[2:]
        products = tensors.reshape(-1, dim**2) @ integrals.reshape(dim**2, -1)
        blocks = products.reshape(len(tensors), dim, dim, rows, columns).swapaxes(2, 3)
        return blocks.reshape(len(tensors), dim * rows, dim * columns)

    def forces(self, u: Floats) -> Floats:
        """The elastic forces a(u, ·) of all degrees of freedom."""
        dim, nodes = self.dim, self.nodes.shape[1]
        dofs, total = self.dofs(np.arange(nodes)), np.zeros(len(u))
        for part in self.parts():
            # Σ_j u_jb ∫ ∂_k φ_i ∂_l φ_j of every cell, to be summed over b, k and l
            moments = u[dofs[part]].reshape(-1, nodes) @ self.integrals.full.reshape(-1, nodes).T
            tensors = self.tensors[part]
            local = tensors.reshape(len(tensors), dim, -1) @ moments.reshape(len(tensors), -1, nodes)
            total += np.bincount(dofs[part].ravel(), local.ravel(), len(u))
        return total

    def parts(self) -> Iterator[slice]:
        """The cells, so many at a time that their matrices are not too large together."""
        count, nodes = self.nodes.shape
        step = max(1, self.ENTRIES // (self.dim * nodes) ** 2)
        return (slice(first, first + step) for first in range(0, count, step))

    def dofs(self, nodes: Indices) -> NDArray[np.int32]:
        """The body's degrees of freedom at some nodes of every cell, (cells, dim · nodes), in the order of `block`."""
        at = self.dim * self.nodes[:, None, nodes] + np.arange(self.dim, dtype=np.int32)[:, None]
        return at.reshape(len(at), -1)


def affine_cells(body: Body) -> AffineCells | None:
    """The cells of a body where that pays: they are affine, of one material, and have much inside of themselves."""
    inner, outer = _inner_and_outer(body.space.ufl_element())
    if len(inner) < WORTHWHILE * (len(inner) + len(outer)) or body.material.varies or body.kinematics.axisymmetric:
        return None
    return AffineCells(body) if are_affine(body.mesh) else None


def are_affine(mesh: Mesh) -> bool:
    """Whether every cell is an affine image of the reference cell: a simplex, a parallelogram, a parallelepiped."""
    element = compat.coordinate_map(mesh.domain)
    if element.degree > 1:
        return False
    vertices, ends = _vertices(element.cell_type)
    if len(vertices) == mesh.dim + 1:
        return True
    x = cell_nodes(mesh)
    straight = x[:, :1] + vertices @ (x[:, ends] - x[:, :1])
    return bool(np.abs(straight - x).max() <= 1e-14 * np.abs(x).max())  # what rounding leaves of a parallelogram


def _jacobians(mesh: Mesh) -> Floats:
    """J of every cell's map, (cells, dim, dim)."""
    x = cell_nodes(mesh)
    _, ends = _vertices(compat.coordinate_map(mesh.domain).cell_type)
    return np.swapaxes(x[:, ends] - x[:, :1], 1, 2)


def cell_nodes(mesh: Mesh) -> Floats:
    """The coordinates of every cell's nodes, (cells, nodes, dim)."""
    return mesh.domain.geometry.x[compat.geometry_dofmap(mesh.domain), : mesh.dim]


@cache
def _vertices(cell: basix.CellType) -> tuple[Floats, Indices]:
    """The vertices of the reference cell, and which of them are one along an axis from the first."""
    vertices = np.asarray(basix.geometry(cell))
    return vertices, np.array(
        [np.flatnonzero(np.all(vertices == axis, axis=1))[0] for axis in np.eye(len(vertices[0]))]
    )


@cache
def _reference_integrals(element: Any) -> ReferenceIntegrals:
    scalar, (inner, outer) = element.basix_element, _inner_and_outer(element)
    points, weights = quadrature_rule(scalar.cell_type, 2 * scalar.degree)
    table = scalar.tabulate(1, points)[1:, :, :, 0]
    full = np.einsum("q,kqi,lqj->klij", weights, table, table, optimize=True)
    rows = full[:, :, inner]
    return ReferenceIntegrals(full, rows[..., inner], rows[..., outer], full[:, :, outer[:, None], outer])


@cache
def _inner_and_outer(element: Any) -> tuple[Indices, Indices]:
    """The nodes inside the reference cell, and those on its boundary."""
    scalar = element.basix_element
    inner = np.array(scalar.entity_dofs[-1][0], dtype=np.intp)
    return inner, np.setdiff1d(np.arange(scalar.dim), inner)
