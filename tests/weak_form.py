"""The weak form (22) of one body anew, in NumPy: what a result of contactdd is checked against.

It shares with contactdd the mesh, the numbering of the displacements and the description of the scene, and nothing of
what makes equations of them: no UFL form, no compiled kernel, no trace, no Voigt's notation. Cells have straight edges
and are simplices or parallelograms.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import basix
import numpy as np
import scipy
from dolfinx import fem
from numpy.typing import NDArray

import contactdd as cd
from contactdd.base.compat import geometry_dofmap

Floats = NDArray[np.float64]


def isotropic(E: float, nu: float) -> Floats:
    """C_ijkl = λ δ_ij δ_kl + μ (δ_ik δ_jl + δ_il δ_jk)."""
    one, lam, mu = np.eye(3), E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    pairs = np.einsum("ik,jl->ijkl", one, one)
    return lam * np.einsum("ij,kl->ijkl", one, one) + mu * (pairs + pairs.transpose(0, 1, 3, 2))


def orthotropic(given: cd.Orthotropic) -> Floats:
    """C_ijkl of an orthotropic material: the normal components from their compliances, the shear moduli themselves."""
    E = np.array([given.E1, given.E2, given.E3])
    compliance = np.diag(1 / E)
    for i, j, nu in ((0, 1, given.nu12), (0, 2, given.nu13), (1, 2, given.nu23)):
        compliance[i, j] = compliance[j, i] = -nu / E[i]
    normal, C = np.linalg.inv(compliance), np.zeros((3, 3, 3, 3))
    for i in range(3):
        for j in range(3):
            C[i, i, j, j] = normal[i, j]
    for i, j, G in ((0, 1, given.G12), (0, 2, given.G13), (1, 2, given.G23)):
        C[i, j, i, j] = C[i, j, j, i] = C[j, i, i, j] = C[j, i, j, i] = G
    return C


def rotated(C: Floats, angle: float) -> Floats:
    """The same material turned about z."""
    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return np.einsum("ia,jb,kc,ld,abcd->ijkl", R, R, R, R, C)


def free_of_stress_across(C: Floats) -> Floats:
    """Plane stress: ε_33 such that σ_33 = 0; the plane has to be one of the material's symmetry."""
    return C - np.einsum("ij,kl->ijkl", C[:, :, 2, 2], C[2, 2]) / C[2, 2, 2, 2]


@dataclass(frozen=True)
class SurfacePoints:
    """n points of a surface.

    x: (n, dim); normal: (n, dim) outward; weight: (n,) areas, of the full ring in a body of revolution; shapes: (n,
    nodes) the shape functions.
    """

    x: Floats
    normal: Floats
    weight: Floats
    shapes: scipy.sparse.csr_matrix


class WeakForm:
    """The stiffness, the loads and the surfaces of a body.

    Args:
        body: The body.
        tensor: Its C_ijkl, (3, 3, 3, 3).
        factor: What the tensor is times at x (dim, n), in a material that varies.
    """

    def __init__(self, body: cd.Body, tensor: Floats, factor: Callable[[Floats], Floats] | None = None) -> None:
        self.body, self.factor = body, factor
        self.ring = body.kinematics.name == "axisymmetric"
        self.tensor = free_of_stress_across(tensor) if body.kinematics.name == "plane stress" else tensor
        domain = body.mesh.domain
        self.dim, self.cell = body.mesh.dim, basix.CellType[domain.topology.cell_name()]
        self.simplex = self.cell in (basix.CellType.triangle, basix.CellType.tetrahedron)
        self.element = basix.create_element(
            basix.ElementFamily.P, self.cell, body.degree, basix.LagrangeVariant.gll_warped
        )
        self.straight = basix.create_element(basix.ElementFamily.P, self.cell, 1)
        self.nodes = np.asarray(body.space.dofmap.list)  # (cells, n)
        self.corners = domain.geometry.x[geometry_dofmap(domain), : self.dim]  # (cells, corners, dim)
        self.size = 1 + int(self.nodes.max())

    @cached_property
    def stiffness(self) -> scipy.sparse.csr_matrix:
        """a(u, v) = ∫ ε(u) : C : ε(v) dx and the springs' ∫ k u·v ds, on all degrees of freedom."""
        X, weights = basix.make_quadrature(self.cell, self._degree)
        shapes, slopes = self.element.tabulate(1, X)[0, :, :, 0], self.element.tabulate(1, X)[1:, :, :, 0]
        matrix = 0.0
        for q, weight in enumerate(weights):
            x, jacobian = self._mapped(X[q])
            gradients = np.einsum("kn,ckj->cnj", slopes[:, q], np.linalg.inv(jacobian))
            # ∇u of every shape function of every component, in three dimensions
            H = np.zeros((*gradients.shape[:2], self.dim, 3, 3))
            for i in range(self.dim):
                H[:, :, i, i, : self.dim] = gradients
            if self.ring:
                H[:, :, 0, 2, 2] = shapes[q] / x[:, :1]  # u_r/r
            volume = weight * np.abs(np.linalg.det(jacobian)) * self._around(x) * self._factor(x)
            strains = H.reshape(len(x), -1, 9)
            matrix = matrix + (strains * volume[:, None, None]) @ self.tensor.reshape(9, 9) @ strains.transpose(0, 2, 1)
        dofs = (self.nodes[:, :, None] * self.dim + np.arange(self.dim)).reshape(len(self.nodes), -1)
        rows, columns = np.broadcast_arrays(dofs[:, :, None], dofs[:, None])
        entries = (matrix.ravel(), (rows.ravel(), columns.ravel()))
        shape = (self.size * self.dim, self.size * self.dim)
        return (scipy.sparse.coo_matrix(entries, shape=shape).tocsr() + self._springs()).tocsr()

    def load(self) -> Floats:
        """l(v) = ∫ f·v dx + ∫ p·v ds for the present values of the parameters, (dofs,)."""
        total = np.zeros((self.size, self.dim))
        for load in self.body.loads:
            if isinstance(load, cd.BodyForce):
                total += self._body_force(load.value)
                continue
            at = self.surface(load.surface)
            if isinstance(load, cd.Pressure):
                traction = -_values(load.value, at.x, ())[:, None] * at.normal
            elif isinstance(load, cd.Resultant):
                traction = np.broadcast_to(_values(load.force, at.x[:1], (self.dim,)) / at.weight.sum(), at.x.shape)
            else:
                traction = _values(load.value, at.x, (self.dim,))
            total += at.shapes.T @ (at.weight[:, None] * traction)
        return total.ravel()

    def surface(self, name: str, degree: int | None = None) -> SurfacePoints:
        """Points of a surface, by default such that integrate all that stands here on it."""
        facet = basix.cell.subentity_types(self.cell)[self.dim - 1][0]
        points, weights = basix.make_quadrature(facet, 3 * self.body.degree + 2 if degree is None else degree)
        cells, first, sides = self._facets(name)
        x = first[:, None] + np.einsum("qk,fkj->fqj", points, sides)
        area = _area(sides)[:, None] * weights * self._around(x.reshape(-1, self.dim)).reshape(len(x), -1)
        normals = np.repeat(self._normals(name), len(points), axis=0)
        owners = np.repeat(cells, len(points))
        return SurfacePoints(
            x.reshape(-1, self.dim), normals, area.ravel(), self._shapes(x.reshape(-1, self.dim), owners)
        )

    def opposite(self, name: str, x: Floats, direction: Floats) -> tuple[Floats, scipy.sparse.csr_matrix]:
        """How far lines from points (n, dim) along directions go to a surface, (n,), and the shape functions there."""
        cells, first, sides = self._facets(name)
        normals = self._normals(name)
        square = np.einsum("fki,fji->fkj", sides, sides)
        distance, owner = np.empty(len(x)), np.empty(len(x), dtype=int)
        for i, (point, along) in enumerate(zip(x, direction, strict=True)):
            with np.errstate(divide="ignore", invalid="ignore"):
                t = np.sum((first - point) * normals, axis=1) / (normals @ along)
            offset = point + np.nan_to_num(t, posinf=1e300, neginf=1e300)[:, None] * along - first
            local = np.linalg.solve(square, np.einsum("fki,fi->fk", sides, offset)[..., None])[..., 0]
            outside = np.max(
                [-local.min(axis=1), (local.sum(axis=1) if self._triangular else local.max(axis=1)) - 1], 0
            )
            outside[normals @ along > -0.1] = np.inf  # it faces away
            hit = np.flatnonzero(outside <= max(1e-7, outside.min()))
            best = hit[np.argmin(np.abs(t[hit]))]
            distance[i], owner[i] = t[best], best
        return distance, self._shapes(x + distance[:, None] * direction, cells[owner])

    def normal_displacement(self, shapes: scipy.sparse.csr_matrix, normal: Floats) -> scipy.sparse.csr_matrix:
        """From all degrees of freedom to u·n at points, (n, dofs)."""
        coo = shapes.tocoo()
        data, columns = coo.data[:, None] * normal[coo.row], coo.col[:, None] * self.dim + np.arange(self.dim)
        entries = (data.ravel(), (np.repeat(coo.row, self.dim), columns.ravel()))
        return scipy.sparse.csr_matrix(entries, shape=(shapes.shape[0], self.size * self.dim))

    def held(self) -> list[tuple[int, Floats, float]]:
        """What supports prescribe: a node, a direction and u·direction."""
        found = []
        x = self.body.space.tabulate_dof_coordinates()[:, : self.dim]
        for support in self.body.supports:
            if isinstance(support, cd.Spring):
                continue
            for name in getattr(support, "surfaces", None) or (support.surface,):
                facets = self.body.mesh.facets(name)
                for node in fem.locate_dofs_topological(self.body.space, self.dim - 1, facets):
                    if isinstance(support, cd.Symmetry):
                        found.append((node, self._normals(name)[0], 0.0))
                    elif isinstance(support, cd.Fixed):
                        found += [(node, axis, 0.0) for axis in np.eye(self.dim)]
                    else:
                        values = zip(np.eye(self.dim), support.values, strict=True)
                        found += [(node, a, float(_values(v, x[[node]], ())[0])) for a, v in values if v is not None]
        return found

    def free(self, forces: Floats) -> Floats:
        """The part of forces (dofs,) that supports do not take."""
        rest, directions = forces.reshape(-1, self.dim).copy(), {}
        for node, direction, _ in self.held():
            directions.setdefault(node, []).append(direction)
        for node, rows in directions.items():
            _, singular, right = np.linalg.svd(np.array(rows))
            for axis in right[: int(np.sum(singular > 1e-6))]:
                rest[node] -= axis * (axis @ rest[node])
        return rest.ravel()

    @property
    def _degree(self) -> int:
        """The quadrature of the stiffness: exact but for u_r/r and materials that vary, where it is contactdd's."""
        p = self.body.degree
        if self.body.material.varies:
            return 2 * p + 1
        if self.ring:  # UFL's estimate: u_r/r counts as of the sum of both degrees, a quadrilateral's ∂x/∂X as of 2
            return 2 * p + (3 if self.simplex else 5)
        return 2 * p

    @property
    def _triangular(self) -> bool:
        return self.dim == 2 or self.simplex

    def _mapped(self, X: Floats) -> tuple[Floats, Floats]:
        """Where a reference point lies in every cell (cells, dim), and ∂x/∂X (cells, dim, dim)."""
        table = self.straight.tabulate(1, X[None])[:, 0, :, 0]
        return np.einsum("n,cni->ci", table[0], self.corners), np.einsum("kn,cni->cik", table[1:], self.corners)

    def _around(self, x: Floats) -> Floats:
        return 2 * np.pi * x[:, 0] if self.ring else np.ones(len(x))

    def _factor(self, x: Floats) -> Floats:
        return np.ones(len(x)) if self.factor is None else self.factor(x.T)

    def _springs(self) -> Any:
        total = scipy.sparse.csr_matrix((self.size * self.dim, self.size * self.dim))
        for spring in self.body.supports:
            if isinstance(spring, cd.Spring):
                at = self.surface(spring.surface)
                if spring.direction is None:
                    directions = [np.broadcast_to(axis, at.x.shape) for axis in np.eye(self.dim)]
                elif isinstance(spring.direction, str):
                    directions = [at.normal]
                else:
                    unit = np.asarray(spring.direction, dtype=float)
                    directions = [np.broadcast_to(unit / np.linalg.norm(unit), at.x.shape)]
                k = at.weight * _values(spring.stiffness, at.x, ())
                for direction in directions:
                    trace = self.normal_displacement(at.shapes, direction)
                    total = total + trace.T @ scipy.sparse.diags(k) @ trace
        return total

    def _body_force(self, value: Any) -> Floats:
        X, weights = basix.make_quadrature(self.cell, 2 * self.body.degree + 2)
        shapes = self.element.tabulate(0, X)[0, :, :, 0]
        total = np.zeros((self.size, self.dim))
        for q, weight in enumerate(weights):
            x, jacobian = self._mapped(X[q])
            volume = weight * np.abs(np.linalg.det(jacobian)) * self._around(x)
            forces = volume[:, None, None] * shapes[q][:, None] * _values(value, x, (self.dim,))[:, None]
            np.add.at(total, self.nodes, forces)
        return total

    def _facets(self, name: str) -> tuple[NDArray[np.int32], Floats, Floats]:
        """Of each facet: its cell, its first corner (dim,) and from there to the next ones (dim − 1, dim)."""
        topology = self.body.mesh.domain.topology
        topology.create_connectivity(self.dim - 1, self.dim)
        topology.create_connectivity(self.dim, self.dim - 1)
        to_cell, to_facets = (
            topology.connectivity(*pair) for pair in ((self.dim - 1, self.dim), (self.dim, self.dim - 1))
        )
        facets = self.body.mesh.facets(name)
        cells = np.array([to_cell.links(facet)[0] for facet in facets])
        places = [list(to_facets.links(cell)).index(facet) for cell, facet in zip(cells, facets, strict=True)]
        corners = np.array(basix.topology(self.cell)[self.dim - 1])[places][:, : self.dim]
        x = self.corners[cells[:, None], corners]
        return cells, x[:, 0], x[:, 1:] - x[:, :1]

    def _normals(self, name: str) -> Floats:
        """The unit normal of each facet, out of the body."""
        cells, first, sides = self._facets(name)
        if self.dim == 2:
            normals = np.column_stack([sides[:, 0, 1], -sides[:, 0, 0]])
        else:
            normals = np.cross(sides[:, 0], sides[:, 1])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        outward = np.sum(normals * (first - self.corners[cells].mean(axis=1)), axis=1)
        return normals * np.sign(outward)[:, None]

    def _shapes(self, x: Floats, cells: NDArray[np.int32]) -> scipy.sparse.csr_matrix:
        """The shape functions at points (n, dim) of cells, (n, nodes)."""
        origin, jacobian = self._mapped(np.zeros(self.dim))
        X = np.linalg.solve(jacobian[cells], (x - origin[cells])[..., None])[..., 0]
        values = self.element.tabulate(0, X)[0, :, :, 0]
        nodes = self.nodes[cells]
        entries = (values.ravel(), (np.repeat(np.arange(len(x)), nodes.shape[1]), nodes.ravel()))
        return scipy.sparse.csr_matrix(entries, shape=(len(x), self.size))


def _area(sides: Floats) -> Floats:
    """The length or, of its sides, the area of the parallelogram of each facet."""
    return np.sqrt(np.linalg.det(np.einsum("fki,fji->fkj", sides, sides)))


def _values(value: Any, x: Floats, shape: tuple[int, ...]) -> Floats:
    """A number, a function of x (dim, n) or a parameter at points (n, dim): (n, *shape)."""
    value = value.value if isinstance(value, cd.Parameter) else value
    given = np.asarray(value(x.T) if callable(value) else value, dtype=float)
    return np.moveaxis(given, -1, 0) if given.ndim > len(shape) else np.broadcast_to(given, (len(x), *shape))
