"""A body: its mesh, material, supports and loads, and the forms (22) that they give in UFL."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any

import basix
import basix.ufl
import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from .base import compat
from .base.arrays import Floats
from .base.checks import as_count, as_tuple_of
from .coefficient_value import coefficient_values, ufl_in
from .elements import Elements
from .field import refuse_other_mesh
from .kinematics import kinematics as find_kinematics
from .load import BodyLoad, Load, is_eigenstrain
from .material import Material
from .mesh import Mesh
from .support import PointDisplacement, Spring, Support

#: Degrees of elements from which on their stiffness' rounding is felt: at 14 a residual of 3e-12 is left on triangles,
#: at 20 4e-10, at 30 4e-6.
LARGEST_DEGREE = 15


class Body:
    """One elastic body Ω_α, eqs. (1)–(6).

    Lengths, stresses and loads are in the user's own consistent set of units.

    Args:
        name: The name, unique in a scene.
        mesh: The mesh with its named surfaces.
        material: Hooke's law (2); or {subdomain: material} for each of the mesh's named parts (`mesh.subdomains`).
        supports: The supports.
        loads: The loads.
        degree: The degree of the Lagrange elements.
        kinematics: "plane strain" (default in the plane), "plane stress", "axisymmetric" (x[0] is the radius r >= 0,
            x[1] the axis; no torsion; energies and forces are those of the full ring) or "solid".
        local_solver: The local solver of this body: its name, or a function of a `LocalTask` that makes a
            `LocalProblem`; by default that of `solve`.

    Raises:
        TypeError, ValueError: An argument can be none of these, or names a surface that the mesh does not have.

    Example:
        >>> import contactdd as cd
        >>> mesh = cd.rectangle((0, 0), (2, 1), (4, 2))
        >>> cd.Body("block", mesh, cd.Isotropic(E=2.1e5, nu=0.3), supports=[cd.Fixed("bottom")]).dofs
        30
    """

    def __init__(
        self,
        name: str,
        mesh: Mesh,
        material: Material | Mapping[str, Material],
        *,
        supports: Sequence[Support] = (),
        loads: Sequence[Load] = (),
        degree: int = 1,
        kinematics: str | None = None,
        local_solver: str | Callable[..., Any] | None = None,
    ) -> None:
        if not isinstance(name, str) or not name:
            raise TypeError(f"name = {name!r}: expected a text")
        if not isinstance(mesh, Mesh):
            raise TypeError(f"mesh = {mesh!r}: expected a contactdd mesh, such as cd.rectangle(...) makes")
        self._given_material = material
        if isinstance(material, Mapping):
            from .piecewise_material import PiecewiseMaterial

            material = PiecewiseMaterial(material, mesh)
        if not isinstance(material, Material):
            raise TypeError(f"material = {material!r}: expected a material, such as cd.Isotropic(E, nu)")
        self.name = name
        self.mesh = mesh
        self.material = material
        self.supports = as_tuple_of("supports", supports, Support)
        self.loads = as_tuple_of("loads", loads, Load)
        self.degree = as_count("degree", degree)
        if self.degree > LARGEST_DEGREE:
            raise ValueError(
                f"degree = {degree!r}: expected at most {LARGEST_DEGREE}; beyond it rounding eats the digits"
            )
        self.kinematics = find_kinematics(kinematics, mesh.dim)
        self.local_solver = local_solver
        self.elements = Elements(name, mesh, self.degree, self.kinematics)
        self._material_read = self._material_values()
        self._check_surfaces()
        self._check_radii()
        self._check_pieces()

    def __repr__(self) -> str:
        elements = f"{self.mesh.cells} cells, degree {self.degree}"
        return f"Body({self.name!r}, {elements}, {self.material}, {self.kinematics.name})"

    def with_degree(self, degree: int) -> Body:
        """The same body in elements of another degree: its mesh, material, supports, loads and local solver are shared.

        Args:
            degree: The degree of the Lagrange elements.

        Raises:
            TypeError, ValueError: There are no elements of that degree.

        Example:
            >>> import contactdd as cd
            >>> mesh = cd.rectangle((0, 0), (2, 1), (4, 2))
            >>> cd.Body("block", mesh, cd.Isotropic(E=2.1e5, nu=0.3)).with_degree(2).dofs
            90
        """
        return self._made_anew(self.mesh, degree)

    def on(self, mesh: Mesh) -> Body:
        """The same body on another mesh, such as a finer one, which has surfaces of the same names.

        Args:
            mesh: The mesh.

        Raises:
            ValueError: A surface that supports or loads need is missing, or one of these is a UFL expression, which
                belongs to the present mesh.
        """
        if mesh is not self.mesh:
            self.refuse_expressions()
        return self._made_anew(mesh, self.degree)

    def refuse_expressions(self) -> None:
        """Refuse supports, loads and materials that belong to the present mesh.

        Raises:
            ValueError: One of them is a UFL expression.
        """
        if any(isinstance(support, PointDisplacement) for support in self.supports):
            raise ValueError(
                f"body {self.name!r}: its PointDisplacement holds nodes of its mesh, and not those between them; "
                "expected a Displacement of a surface"
            )
        given = [(type(item).__name__, vars(item).values()) for item in (*self.supports, *self.loads)]
        for kind, values in [*given, ("material", self.material.given())]:
            if ufl_in(values):
                raise ValueError(
                    f"body {self.name!r}: its {kind} is a UFL expression, which belongs to its mesh; "
                    "expected a number or a function of the coordinates"
                )

    def _made_anew(self, mesh: Mesh, degree: int) -> Body:
        """The same body on another mesh or of another degree, checked as a new one is."""
        return Body(
            self.name,
            mesh,
            self._given_material,
            supports=self.supports,
            loads=self.loads,
            degree=degree,
            kinematics=self.kinematics.name,
            local_solver=self.local_solver,
        )

    @property
    def space(self) -> fem.FunctionSpace:
        """The finite element space of the body's displacements."""
        return self.elements.space

    @property
    def dofs(self) -> int:
        """The number of degrees of freedom of the displacements."""
        return self.elements.dofs

    def area(self, surface: str) -> float:
        """The area of a named surface, its length in the plane, that of the full ring in a body of revolution.

        Args:
            surface: The name of the surface.
        """
        return self.elements.area(surface)

    def rigid_modes(self) -> Floats:
        """The rigid motions of the body in all degrees of freedom, (dofs, motions), see `Kinematics.rigid_modes`."""
        return self.kinematics.rigid_modes(self.space.tabulate_dof_coordinates()).reshape(self.dofs, -1)

    @cached_property
    def stiffness(self) -> Any:
        """The stiffness between the strains that take part, a UFL matrix."""
        return self.material_coefficient(self.kinematics.reduce, self._material_element)

    @property
    def _material_element(self) -> Any:
        """The element of the points at which a material that varies is integrated; None of one that does not."""
        if not self.material.varies:
            return None
        cell = compat.coordinate_map(self.mesh.domain).cell_type
        return basix.ufl.quadrature_element(cell, degree=self._material_degree)

    @property
    def _eigen_metadata(self) -> dict[str, Any] | None:
        """The quadrature of eigenstrains; None leaves it to UFL."""
        return {"quadrature_degree": self._material_degree} if self.material.varies else None

    def material_coefficient(self, reduce: Callable[[Floats], Floats], element: Any) -> Any:
        """The matrices `reduce(C)`, C the material's stiffness (..., 6, 6), as a UFL coefficient.

        A constant material gives a constant, so that other numbers compile nothing anew; one that varies is evaluated
        at the points of an element.

        Args:
            reduce: From the stiffness (..., 6, 6) to the matrices that are wanted.
            element: A scalar element, for a material that varies.
        """
        domain = self.mesh.domain
        if not self.material.varies:
            return fem.Constant(domain, reduce(self.material.stiffness()))
        shape = reduce(np.eye(6)).shape
        matrices = fem.Function(fem.functionspace(domain, basix.ufl.blocked_element(element, shape=shape)))
        cells = np.arange(self.mesh.cells, dtype=np.int32)

        def values(x: Floats) -> Floats:
            """The matrices at points that dolfinx gives cell by cell."""
            here = self.stiffness_at(x, np.repeat(cells, x.shape[1] // len(cells)))
            return reduce(here).reshape(x.shape[1], -1).T

        matrices.interpolate(values)
        return matrices

    def stiffness_at(self, x: Floats, cells: NDArray[np.int32]) -> Floats:
        """The stiffness C in Voigt's notation at points, (points, 6, 6) (stress).

        Args:
            x: Points (3, points) (length).
            cells: The cell that each lies in, (points,).
        """
        return self.material.within(cells).stiffness(x)

    def refuse_changed_material(self) -> None:
        """Refuse a material whose dolfinx Constants or Functions have changed since the body was made.

        Raises:
            ValueError: One has.
        """
        if self._material_read and self._material_values() != self._material_read:
            raise ValueError(
                f"body {self.name!r}: a Constant or Function in its material has changed, but its stiffness is made "
                "once; expected a new Body and Scene for another material"
            )

    def _material_values(self) -> list[bytes]:
        """The present values of dolfinx' Constants and Functions in the material."""
        return [each.value.tobytes() for each in coefficient_values(self.material.given())]

    @property
    def _material_degree(self) -> int:
        """The degree of exactness at which a material that varies is integrated.

        Two more than the strains of a constant material on straight cells need, one more for the radius.
        """
        return 2 * self.degree + 1

    def stress(self, u: Any) -> Any:
        """The stresses of the free Voigt components, a UFL vector: Hooke's law (2), eigenstrains not taken away.

        Args:
            u: A displacement in UFL.
        """
        return self.stiffness * self.kinematics.strain(u)

    @property
    def has_eigenstrain(self) -> bool:
        """Whether one of the loads is an eigenstrain, such as that of heat."""
        return any(map(is_eigenstrain, self.loads))

    def eigenstrain(self) -> Any:
        """The sum ε₀ of all eigenstrains, a UFL vector of six components in the order of Voigt."""
        return sum((load.eigenstrain(self.elements) for load in filter(is_eigenstrain, self.loads)), ufl.zero(6))

    def eigenstrain_form(self, strain: Any, v: Any) -> ufl.Form:
        """The UFL form ∫ (C : ε₀) : ε(v) dx, the load that an eigenstrain is.

        Args:
            strain: ε₀, a UFL vector of six components in the order of Voigt.
            v: A test function.
        """
        matrix = self.material_coefficient(self.kinematics.eigenstress, self._material_element)
        return self.elements.over_volume(ufl.inner(matrix * strain, self.kinematics.strain(v)), self._eigen_metadata)

    def eigenstrain_energy_form(self) -> ufl.Form:
        """The UFL form ½ ∫ ε₀ : C : ε₀ dx of all eigenstrains."""
        strain = self.eigenstrain()
        matrix = self.material_coefficient(self.kinematics.full_eigenstress, self._material_element)
        return self.elements.over_volume(0.5 * ufl.inner(matrix * strain, strain), self._eigen_metadata)

    def elastic_form(self, u: Any, v: Any) -> ufl.Form:
        """The UFL form ∫ σ(u) : ε(v) dx, which with the springs is a(u, v).

        Args:
            u: A displacement.
            v: A test function.
        """
        return self.elements.over_volume(ufl.inner(self.stress(u), self.kinematics.strain(v)), self.elastic_metadata)

    @property
    def elastic_metadata(self) -> dict[str, Any] | None:
        """The quadrature of a(u, v); None leaves it to UFL, whose choice is exact on simplices.

        On quadrilaterals and hexahedra p + 1 points along each axis are exact where these are parallelograms, and keep
        the elements' accuracy elsewhere; UFL would take many more.
        """
        if self.material.varies:
            return {"quadrature_degree": self._material_degree}
        tensor = self.mesh.domain.topology.cell_name() in ("quadrilateral", "hexahedron")
        straight = compat.coordinate_map(self.mesh.domain).degree == 1
        few = tensor and straight and not self.kinematics.axisymmetric
        return {"quadrature_degree": 2 * self.degree} if few else None

    def spring_forms(self, u: Any, v: Any) -> list[ufl.Form]:
        """The UFL forms ∫ k u·v ds of every spring, kept apart so that no combination of them is compiled anew.

        Args:
            u: A displacement.
            v: A test function.
        """
        return [support.form(self.elements, u, v) for support in self.supports if isinstance(support, Spring)]

    def robin_form(self, u: Any, v: Any, phi: Any, surface: str, metadata: dict[str, Any]) -> ufl.Form:
        """The UFL form ∫ φ u_n v_n ds over a contact surface: the Robin term of (22), (32), (36).

        Args:
            u: A displacement.
            v: A test function.
            phi: The Robin coefficient φ (stress / length).
            surface: The name of the surface.
            metadata: The quadrature of the measure.
        """
        n = ufl.FacetNormal(self.mesh.domain)
        return self.elements.over_surface(phi * ufl.dot(u, n) * ufl.dot(v, n), surface, metadata)

    def sliding_form(self, u: Any, v: Any, phi: Any, surface: str, metadata: dict[str, Any]) -> ufl.Form:
        """The UFL form ∫ φ u_t·v_t ds over a contact surface, divided by the number of tangents.

        Args:
            u: A displacement.
            v: A test function.
            phi: The Robin coefficient φ (stress / length).
            surface: The name of the surface.
            metadata: The quadrature of the measure.
        """
        n = ufl.FacetNormal(self.mesh.domain)
        sliding = ufl.dot(u, v) - ufl.dot(u, n) * ufl.dot(v, n)
        return self.elements.over_surface(phi * sliding / (self.mesh.dim - 1), surface, metadata)

    def _check_radii(self) -> None:
        """Refuse a mesh of rings that crosses the axis."""
        if self.kinematics.axisymmetric:
            r = self.mesh.domain.geometry.x[:, 0]
            if r.min() < -1e-10 * np.abs(r).max():  # file formats round coordinates
                raise ValueError(f"mesh of body {self.name!r}: the radius x[0] = {r.min():g}; expected x[0] >= 0")

    def _check_pieces(self) -> None:
        """Refuse a mesh in pieces that nothing joins, unless supports hold each by itself.

        The rigid motions of a body are those of one piece: contact alone cannot hold one of several.
        """
        piece_of_cell = self.mesh.piece_of_cell
        count = int(piece_of_cell.max()) + 1
        if count == 1:
            return
        cells = [np.flatnonzero(piece_of_cell == piece) for piece in range(count)]
        loose = [piece for piece in range(count) if not self._holds(cells[piece])]
        if loose:
            x = self.mesh.domain.geometry.x[compat.geometry_dofmap(self.mesh.domain), : self.mesh.dim]
            parts = ", ".join(f"{len(each)} cells around {x[each].mean(axis=(0, 1))}" for each in cells[:4])
            more = ", ..." if count > 4 else ""
            raise ValueError(
                f"mesh of body {self.name!r}: {count} pieces that share no node ({parts}{more}), of which the supports "
                f"do not hold {len(loose)}; make a body of each: mesh.pieces()"
            )

    def _holds(self, cells: NDArray[np.intp]) -> bool:
        """Whether the supports leave no rigid motion of a piece of the mesh."""
        ours = np.unique(self.space.dofmap.list[cells])
        modes = self.kinematics.rigid_modes(self.space.tabulate_dof_coordinates()[ours])

        def of(nodes: NDArray[np.int32]) -> Floats:
            """The motions at those of some nodes that are the piece's, (n, dim, motions)."""
            return modes[np.isin(ours, nodes)]

        held = [modes[:0, 0]]
        for support in self.supports:
            if isinstance(support, Spring):
                held.append(of(self.elements.nodes(support.surface)).reshape(-1, modes.shape[2]))
            held += [of(nodes).swapaxes(1, 2) @ axis for nodes, axis, _ in support.conditions(self.elements)]
        # The motions are of the order one, those that nodes leave free zero to the rounding of their coordinates.
        return bool(np.linalg.matrix_rank(np.concatenate(held), tol=1e-8) == modes.shape[2])

    def _check_surfaces(self) -> None:
        """Refuse an unknown surface name or vectors of a wrong length now, not when the forms are made."""
        for value in ufl_in(self.material.given()):
            refuse_other_mesh(f"material of body {self.name!r}", value, self.mesh.domain)
        for item in (*self.supports, *self.loads):
            if hasattr(item, "check"):
                item.check(self.mesh.dim)
            for value in ufl_in(vars(item).values()):
                refuse_other_mesh(f"{type(item).__name__} of body {self.name!r}", value, self.mesh.domain)
            if isinstance(item, BodyLoad):
                item.check_on(self)
            for surface in getattr(item, "surfaces", (item.surface,) if hasattr(item, "surface") else ()):
                self.mesh.facets(surface)
