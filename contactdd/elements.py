"""The finite elements of a body's displacements, and integrals over its volume and its named surfaces.

What loads and supports need to know of a body: they are given its elements, not the body.
"""

from __future__ import annotations

from functools import cache, cached_property
from typing import Any
from weakref import WeakKeyDictionary

import basix
import basix.ufl
import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from .base import compat
from .base.arrays import Floats
from .base.basis import quadrature_rule
from .base.facets import facet_type, surface_points
from .base.isometry import Isometry
from .base.refinement import values_within
from .kinematics import Kinematics
from .mesh import Mesh


class Elements:
    """Lagrange elements of one degree on a mesh, with the kinematics that the integrals' weight follows from.

    Attributes:
        name: Of the body, for messages.
        mesh: The body's mesh.
        degree: Of the polynomials.
        kinematics: Plane, of revolution or solid.
    """

    def __init__(self, name: str, mesh: Mesh, degree: int, kinematics: Kinematics) -> None:
        self.name, self.mesh, self.degree, self.kinematics = name, mesh, degree, kinematics
        self._isometries: WeakKeyDictionary[Elements, Isometry | None] = WeakKeyDictionary()

    @property
    def domain(self) -> Any:
        """The dolfinx mesh."""
        return self.mesh.domain

    @property
    def dim(self) -> int:
        """The number of displacement components, 2 or 3."""
        return self.mesh.dim

    @property
    def element(self) -> Any:
        """The Lagrange element of the displacements."""
        return _lagrange(self.domain.topology.cell_name(), self.degree, self.dim)

    @cached_property
    def space(self) -> fem.FunctionSpace:
        """The finite element space of the displacements."""
        return compat.function_space(self.domain, self.element)

    @property
    def dofs(self) -> int:
        """The number of degrees of freedom of the displacements."""
        return self.space.dofmap.index_map.size_local * self.space.dofmap.bs

    @property
    def field_degree(self) -> int:
        """The degree of the polynomials that stand for a load or stiffness given as a function."""
        return self.degree + 2

    def isometry_from(self, other: Elements) -> Isometry | None:
        """The motion or mirror image that takes other elements, numbered alike, to these; None if there is none.

        Their meshes have to have the same named surfaces.
        """
        return self.nodes_isometry_from(other) if self.mesh.same_surfaces(other.mesh) else None

    def nodes_isometry_from(self, other: Elements) -> Isometry | None:
        """The same, whatever surfaces are named."""
        if other not in self._isometries:
            self._isometries[other] = self._found_isometry(other)
        return self._isometries[other]

    def _found_isometry(self, other: Elements) -> Isometry | None:
        if self.degree != other.degree or self.kinematics is not other.kinematics:
            return None
        isometry = self.mesh.nodes_isometry_from(other.mesh)
        return isometry if isometry is not None and self._numbered_as(other) else None

    def _numbered_as(self, other: Elements) -> bool:
        """Whether the degrees of freedom of elements of the same degree are numbered alike."""
        if self.domain.topology._cpp_object is other.domain.topology._cpp_object:  # it is what dolfinx numbers from
            return True
        return np.array_equal(self.space.dofmap.list, other.space.dofmap.list)

    def nodes(self, surface: str) -> NDArray[np.int32]:
        """The nodes (blocks of degrees of freedom) on a named surface."""
        return fem.locate_dofs_topological(self.space, self.dim - 1, self.mesh.facets(surface))

    def nodes_at(self, points: Floats) -> NDArray[np.int32]:
        """The node (n,) at each of some points (n, dim); refuses points where there is none."""
        from scipy.spatial import cKDTree

        near = 1e-8 * self.mesh.size  # files round coordinates to about eight digits
        away, nodes = cKDTree(self.space.tabulate_dof_coordinates()[:, : self.dim]).query(points)
        if np.any(away > near):
            raise ValueError(
                f"points of body {self.name!r}: there is no node at {points[int(np.argmax(away))]}, the next is "
                f"{away.max():.3g} away; expected nodes of the mesh"
            )
        return nodes.astype(np.int32)

    def nodes_between(self, nodes: NDArray[np.int32]) -> NDArray[np.int32]:
        """Some nodes with those inside the edges, faces and cells whose corners are all among them.

        On cells of second order the middle of an edge counts by itself.
        """
        layout, dofs = self.space.dofmap.dof_layout, self.space.dofmap.list
        held = np.zeros(self.dofs // self.dim, dtype=bool)
        held[nodes] = True
        topology = compat.entity_vertices(self.domain)
        corners = np.array([layout.entity_dofs(0, vertex)[0] for vertex in range(len(topology[0]))])
        of_corners = held[dofs[:, corners]]
        curved = compat.coordinate_map(self.domain).degree > 1 and self.degree == 2
        for dim in range(2 if curved else 1, self.dim + 1):
            for number, vertices in enumerate(topology[dim]):
                inside = layout.entity_dofs(dim, number)
                whole = of_corners[:, vertices].all(axis=1)
                held[dofs[whole][:, inside]] = True
        return np.flatnonzero(held).astype(np.int32)

    def coordinates(self, nodes: NDArray[np.int32]) -> Floats:
        """The coordinates x (3, n) of nodes."""
        return self.space.tabulate_dof_coordinates()[nodes].T

    def interpolated(self, u: fem.Function, coarse: Elements) -> Floats | None:
        """The degrees of freedom (dofs,) of a displacement in other elements, node by node.

        u: in the elements `coarse` on the same mesh or on the one that this was refined from; None for another mesh.
        """
        if coarse.mesh is self.mesh:
            function = fem.Function(self.space)
            function.interpolate(u)
            return function.x.array
        if self.mesh.refined_from is None or self.mesh.refined_from[0] is not coarse.mesh:
            return None
        made = self.mesh.refined_from[1]
        nodal = u.x.array.reshape(-1, self.dim)[coarse.space.dofmap.list[made.parents]]
        points = self.space.element.basix_element.points
        values = np.zeros((self.dofs // self.dim, self.dim))
        values[self.space.dofmap.list] = values_within(coarse.space.element.basix_element, made.corners, points, nodal)
        return values.ravel()

    def over_volume(self, integrand: Any, metadata: dict[str, Any] | None = None) -> ufl.Form:
        """∫ integrand dx over the body, the full ring in a body of revolution."""
        weight = self.kinematics.weight(ufl.SpatialCoordinate(self.domain))
        return weight * integrand * ufl.Measure("dx", domain=self.domain, metadata=metadata)

    def by_cell(self, integrand: Any, metadata: dict[str, Any] | None = None) -> ufl.Form:
        """∫ integrand dx over every cell, a form whose vector has one entry a cell."""
        cellwise = basix.ufl.element("DG", self.domain.topology.cell_name(), 0)
        return self.over_volume(integrand * ufl.TestFunction(fem.functionspace(self.domain, cellwise)), metadata)

    def over_surface(self, integrand: Any, surface: str, metadata: dict[str, Any] | None = None) -> ufl.Form:
        """∫ integrand ds over a named surface, the full ring in a body of revolution."""
        # The same number for every surface, so that forms on different ones are compiled once.
        facets = [(1, self.mesh.entities(surface).ravel())]
        ds = ufl.Measure("ds", domain=self.domain, subdomain_data=facets, subdomain_id=1, metadata=metadata)
        return self.kinematics.weight(ufl.SpatialCoordinate(self.domain)) * integrand * ds

    def area(self, surface: str) -> float:
        """∫ 1 ds over a named surface, by the rule of `area_metadata`."""
        entities = self.mesh.entities(surface)
        if len(entities) == 0:
            raise ValueError(f"surface = {surface!r} of body {self.name!r}: it has no facets")
        degree = self.area_metadata["quadrature_degree"]
        points, weights = quadrature_rule(facet_type(self.domain), degree)
        at = surface_points(self.domain, entities, points)
        return float(np.sum(np.tile(weights, len(entities)) * at.area * self.kinematics.weight(at.x.T)))

    @property
    def area_metadata(self) -> dict[str, Any]:
        """The quadrature that makes an even traction force / area carry the force to rounding, on curved facets too."""
        geometry = self.domain.ufl_domain().ufl_coordinate_element().embedded_superdegree
        return {"quadrature_degree": self.degree + 2 * geometry}


@cache
def _lagrange(cell: str, degree: int, components: int) -> Any:
    """The Lagrange element of vectors."""
    return compat.with_cell(basix.ufl.element("Lagrange", cell, degree, shape=(components,)))
