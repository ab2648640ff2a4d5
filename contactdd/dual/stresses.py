"""Stresses in equilibrium with a body's loads: symmetric, polynomials in every triangle, with continuous tractions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import basix.ufl
import numpy as np
import scipy
import ufl
from dolfinx import fem
from dolfinx import mesh as dmesh

from ..base import compat
from ..base.arrays import TINY, Floats, Indices
from ..base.facets import surface_points
from ..body import Body
from ..load import BodyForce
from ..local.factor import Factor
from ..support import Displacement, Fixed, Symmetry

#: Of equilibrium, symmetry and given tractions: what violates them is weighed by this factor more than stresses of its
#: size, and taken out in some rounds, until it is below `ROUNDING` of the forces.
PENALTY, ROUNDS, ROUNDING = 1e6, 20, 1e-10


class EquilibratedStresses:
    """Symmetric stresses, polynomials in every triangle with continuous tractions, in equilibrium with loads.

    Their rows are Brezzi, Douglas and Marini's elements; equilibrium, symmetry and the tractions on the body's surfaces
    are linear conditions, some of which say the same.
    """

    def __init__(self, body: Body, degree: int) -> None:
        self.body, self._domain = body, body.mesh.domain
        self._row = basix.ufl.element("BDM", "triangle", degree)
        lower, same = (basix.ufl.element("DG", "triangle", each) for each in (degree - 1, degree))
        # One space for both rows and for the functions that conditions are tested with: all matrices are square, as
        # dolfinx to 0.11.0 assembles rectangular ones of such elements wrongly (its issue 4294).
        self.space = fem.functionspace(
            self._domain, basix.ufl.mixed_element([self._row, self._row, lower, lower, same])
        )
        self._stresses, self._tested = (self._dofs(parts) for parts in ((0, 1), (2, 3, 4)))
        stiffness = body.kinematics.reduce(body.material.stiffness())
        self.compliance = fem.Constant(self._domain, np.linalg.inv(stiffness))
        self._trial, self._test = ufl.TrialFunction(self.space), ufl.TestFunction(self.space)

    def _dofs(self, parts: Sequence[int]) -> Indices:
        """The degrees of freedom of some parts of the space, sorted."""
        return np.unique(np.concatenate([self.space.sub(part).dofmap.list.ravel() for part in parts]))

    def nearest(self, strain: Any, contact_loads: Sequence[tuple[str, fem.Function]]) -> fem.Function:
        """The stress nearest to C ε in the energy norm, a function of both rows.

        strain: ε in UFL; contact_loads: the pressures on contact surfaces.
        """
        trial, test = rows(self._trial), rows(self._test)
        energy = ufl.inner(self.compliance * voigt(trial), voigt(test))
        skew = _skew(trial) * _skew(test) * self.compliance[0, 0]
        matrix = _matrix((energy + skew) * ufl.dx)[self._stresses][:, self._stresses]
        towards = _vector(ufl.inner(strain, voigt(test)) * ufl.dx)[self._stresses]
        sigma = fem.Function(self.space)
        sigma.x.array[self._stresses] = self._least(matrix, towards, *self._conditions(contact_loads))
        return sigma

    def _least(
        self, matrix: scipy.sparse.csr_matrix, towards: Floats, conditions: scipy.sparse.csr_matrix, values: Floats
    ) -> Floats:
        """The minimum of ½ σᵀ M σ − gᵀ σ with K σ = h, by augmented Lagrangians: K may have rows that say the same."""
        scale = PENALTY * float(matrix.diagonal().max())
        factor = Factor((matrix + scale * (conditions.T @ conditions)).tocsr())
        multipliers: Floats = np.zeros(len(values))
        sigma: Floats = np.zeros(len(towards))
        size = max(float(np.abs(values).max(initial=0.0)), TINY)
        for _ in range(ROUNDS):
            rest = towards - matrix @ sigma - conditions.T @ (multipliers + scale * (conditions @ sigma - values))
            sigma = sigma + factor.solve(rest)
            violated = conditions @ sigma - values
            multipliers = multipliers + scale * violated
            if np.abs(violated).max(initial=0.0) <= ROUNDING * max(size, float(np.abs(sigma).max(initial=0.0))):
                return sigma
        raise ValueError(
            f"body {self.body.name!r}: no symmetric stress that is continuous balances its loads and the contact "
            "pressures; expected tractions that agree where free surfaces meet at a corner"
        )

    def _conditions(self, contact_loads: Sequence[tuple[str, fem.Function]]) -> tuple[scipy.sparse.csr_matrix, Floats]:
        """The rows K (conditions, stresses), each of the length 1, and the values h of K σ = h."""
        blocks = [self._inside(), self._tractions(contact_loads)]
        matrix = scipy.sparse.vstack([block for block, _ in blocks]).tocsr()
        values = np.concatenate([each for _, each in blocks])
        length = np.sqrt(np.asarray(matrix.multiply(matrix).sum(axis=1)).ravel())
        return (scipy.sparse.diags(1 / length) @ matrix).tocsr(), values / length

    def _inside(self) -> tuple[scipy.sparse.csr_matrix, Floats]:
        """∫ (div σ + f)·v = 0 and ∫ (σ_xy − σ_yx) q = 0 for all v and q that div σ and σ can be: both vanish."""
        v, q = ufl.as_vector([self._test[4], self._test[5]]), self._test[6]
        trial = rows(self._trial)
        matrix = _matrix((ufl.inner(ufl.div(trial), v) + _skew(trial) * q) * ufl.dx)[self._tested][:, self._stresses]
        values = np.zeros(matrix.shape[0])
        for load in self.body.loads:
            if isinstance(load, BodyForce):
                values -= _vector(load.form(self.body.elements, v))[self._tested]
        return matrix, values

    def _tractions(self, contact_loads: Sequence[tuple[str, fem.Function]]) -> tuple[scipy.sparse.csr_matrix, Floats]:
        """∫ (σ n − t)·e ψ = 0 along the directions e that no support holds, for all functions ψ of a facet."""
        n, elements = ufl.FacetNormal(self._domain), self.body.elements
        traction = rows(self._test) * n
        mass = _matrix(ufl.dot(rows(self._trial) * n, traction) * ufl.ds)[self._stresses][:, self._stresses]
        forms = [load.form(elements, traction) for load in self.body.loads if not isinstance(load, BodyForce)]
        forms += [elements.over_surface(-p * ufl.dot(n, traction), surface) for surface, p in contact_loads]
        values = np.zeros(mass.shape[0])
        for form in forms:
            values += _vector(form)[self._stresses]
        along = self._free_directions()
        return (along @ mass).tocsr(), along @ values

    def _free_directions(self) -> scipy.sparse.csr_matrix:
        """From the functions of both rows on boundary facets to those along the directions that no support holds."""
        lists = [np.asarray(self.space.sub(i).dofmap.list) for i in (0, 1)]
        of_facet = self._row.entity_dofs[1]
        rows = []
        for cell, facet, free in _boundary(self.body):
            pairs = np.stack([own[cell][of_facet[facet]] for own in lists])  # (2, degree + 1)
            rows += [(pairs[:, j], e) for e in free for j in range(pairs.shape[1])]
        columns = np.array([pair for pair, _ in rows], dtype=np.int64).reshape(-1, 2)
        data = np.array([e for _, e in rows]).reshape(-1, 2)
        places = np.repeat(np.arange(len(rows)), 2), np.searchsorted(self._stresses, columns.ravel())
        return scipy.sparse.csr_matrix((data.ravel(), places), shape=(len(rows), len(self._stresses)))


def _boundary(body: Body) -> Iterator[tuple[int, int, Floats]]:
    """The boundary's facets as (cell, local facet, the orthonormal directions (n, 2) that no support holds)."""
    topology = body.mesh.domain.topology
    topology.create_connectivity(1, 2)
    topology.create_connectivity(2, 1)
    held: dict[int, list[Floats]] = {}
    for surface, axes in _held(body):
        for facet, own in zip(body.mesh.facets(surface), axes, strict=True):
            held.setdefault(int(facet), []).append(own)
    of_cell, of_facet = topology.connectivity(2, 1), topology.connectivity(1, 2)
    for facet in dmesh.exterior_facet_indices(topology):
        cell = int(of_facet.links(facet)[0])
        local = int(np.flatnonzero(of_cell.links(cell) == facet)[0])
        directions = np.concatenate([np.zeros((0, 2)), *held.get(int(facet), [])])
        yield cell, local, scipy.linalg.null_space(directions, rcond=1e-8).T if len(directions) else np.eye(2)


def _held(body: Body) -> Iterator[tuple[str, Sequence[Floats]]]:
    """The surfaces that supports hold, each with the directions (n, 2) at every facet."""
    for support in body.supports:
        if isinstance(support, Displacement):
            axes = np.eye(2)[[value is not None for value in support.values]]
            yield support.surface, [axes] * len(body.mesh.facets(support.surface))
        for surface in support.surfaces if isinstance(support, Fixed | Symmetry) else ():
            entities = body.mesh.entities(surface)
            normals = surface_points(body.mesh.domain, entities, np.array([[0.5]])).normal
            yield surface, [np.eye(2) if isinstance(support, Fixed) else normal[None] for normal in normals]


def rows(sigma: Any) -> Any:
    """The tensor of both rows, in UFL."""
    return ufl.as_matrix([[sigma[0], sigma[1]], [sigma[2], sigma[3]]])


def voigt(tensor: Any) -> Any:
    """Its symmetric part as a vector xx, yy, xy."""
    return ufl.as_vector([tensor[0, 0], tensor[1, 1], (tensor[0, 1] + tensor[1, 0]) / 2])


def _skew(tensor: Any) -> Any:
    return tensor[0, 1] - tensor[1, 0]


def _matrix(form: Any) -> scipy.sparse.csr_matrix:
    return fem.assemble_matrix(compat.form(form)).to_scipy().tocsr()


def _vector(form: Any) -> Floats:
    values: Floats = fem.assemble_vector(compat.form(form)).array
    return values
