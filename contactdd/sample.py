"""From finite element functions and discretised contacts to the plain arrays that results consist of."""

from __future__ import annotations

from collections.abc import Sequence

import basix
import numpy as np
from dolfinx import cpp, fem, geometry
from dolfinx.plot import vtk_mesh
from numpy.typing import ArrayLike, NDArray

from .base.arrays import TINY, Floats, Indices
from .base.basis import basis_values
from .base.checks import as_floats
from .base.facets import FacetPoints, facet_type, surface_points
from .body import Body
from .body_result import BodyResult, SurfaceFit
from .field import evaluate
from .interface.discretise import Interface, InterfaceSide
from .interface.nodal import hats
from .surface_result import SurfaceResult

#: VTK's numbers of the shapes of facets, of degree one and of any.
FACET_TYPES = {
    basix.CellType.interval: (3, 68),
    basix.CellType.triangle: (5, 69),
    basix.CellType.quadrilateral: (9, 70),
}


def body_result(
    body: Body, displacement: fem.Function, stress: fem.Function, contacts: Sequence[tuple[Interface, Floats]]
) -> BodyResult:
    """A body at the nodes of its displacement; contacts: the interfaces it may be the first body of, and their gaps."""
    topology, types, points = vtk_mesh(body.space)
    cells = topology.reshape(body.mesh.cells, -1)[:, 1:]
    dim = body.mesh.dim
    x = points[:, :dim]
    cell_stress, nodal = nodal_stress(body, stress)
    fits = tuple(_fit(interface, gap, x) for interface, gap in contacts if interface.contact.sides[0][0] is body)
    u = displacement.x.array.reshape(-1, dim).copy()
    return BodyResult(body.name, body.kinematics.name, x, cells, int(types[0]), u, nodal, cell_stress, fits)


def nodal_stress(body: Body, stress: fem.Function) -> tuple[Floats, Floats]:
    """The mean stress at each cell's nodes, (cells, 6), and that of the cells around each node, (nodes, 6)."""
    element = stress.function_space.element.basix_element
    table = basis_values(element, body.space.element.basix_element.points)
    cells = stress.x.array.reshape(-1, 6)[stress.function_space.dofmap.list]
    values = np.einsum("pn,cnk->cpk", table, cells)
    nodes = body.space.dofmap.list.ravel()
    count = np.bincount(nodes)
    sums = [np.bincount(nodes, column) for column in values.reshape(-1, 6).T]
    return values.mean(axis=1), np.stack(sums, axis=1) / count[:, None]


def _fit(interface: Interface, gap: Floats, x: Floats) -> SurfaceFit:
    """The shift of a body's nodes x (n, dim) in pictures so that its contact surface fits."""
    from scipy.spatial import cKDTree

    away, around = cKDTree(interface.x).query(x, k=range(1, 1 + min(x.shape[1], len(interface.x))))
    shares = 1.0 / (away + TINY)  # of the points on both sides of a node, or around it, so that surfaces stay smooth
    shares /= shares.sum(axis=1, keepdims=True)
    nearest = around[:, 0]
    normal = interface.normal[nearest]
    depth = np.sum((interface.x[nearest] - x) * normal, axis=1)
    fade = 1.0 - np.clip(depth / max(float(depth.max()), TINY), 0.0, 1.0)
    shape = np.zeros(len(x))
    if np.any(interface.prescribed_gap):
        above = x + depth[:, None] * normal  # on the contact, where the gap is given
        shape = evaluate("gap", interface.contact.gap, above.T)
    measured, deformed = (np.sum(shares * values[around], axis=1) for values in (interface.geometric_gap, gap))
    return SurfaceFit(fade, normal, shape, measured, deformed)


def surface_result(
    interface: Interface, side_index: int, gap: Floats, pressure: Floats, displacement: fem.Function
) -> SurfaceResult:
    """The side `side_index` (0 or 1) of a contact facet by facet, from the values at the interface's points."""
    side = interface.sides[side_index]
    surface, body = side.meshed, side.meshed.body
    points, cells, kind, u, at = _facet_nodes(body, surface.entities, displacement)
    carries = interface.functions.surface is surface
    projected = hats(surface, at) @ interface.nodal_field(pressure) if carries else None
    covered = _facet_means(side, np.ones(len(gap)))
    opposite = np.where(covered > 1e-6, covered, np.nan)

    def mean(values: Floats) -> Floats:
        return _facet_means(side, values) / opposite

    return SurfaceResult(
        interface.contact.name,
        body.name,
        points,
        cells,
        kind,
        u,
        surface.facet_areas,
        np.clip(covered, 0.0, 1.0),
        np.nan_to_num(mean(interface.closed(gap, pressure).astype(float))),
        _facet_means(side, pressure),
        mean(gap),
        mean(interface.compressions(gap)),
        projected,
    )


def _facet_means(side: InterfaceSide, values: Floats) -> Floats:
    """The means over a body's own facets of values at an interface's points, zero where nothing is opposite."""
    surface = side.meshed
    weighted = surface.weights * (side.transfer @ values)
    return weighted.reshape(len(surface.facets), -1).sum(axis=1) / surface.facet_areas


def _facet_nodes(
    body: Body, entities: NDArray[np.int32], displacement: fem.Function
) -> tuple[Floats, Indices, int, Floats, FacetPoints]:
    """The nodes of facets in the body's degree, each once: x (m, dim), the facets' nodes in VTK's order, VTK's number
    of their shape, the displacement (m, dim), and the nodes as points of facets."""
    facet, dim = facet_type(body.mesh.domain), body.mesh.dim
    element = basix.create_element(basix.ElementFamily.P, facet, body.degree, basix.LagrangeVariant.equispaced)
    reference = np.asarray(element.points)
    at = surface_points(body.mesh.domain, entities, reference)
    u = _tabulated(body, at.cells, at.reference, displacement.x.array.reshape(-1, dim))
    size = float(np.linalg.norm(np.ptp(at.x, axis=0))) / max(len(entities), 1)
    _, first, inverse = np.unique(np.round(at.x / (1e-6 * size)), axis=0, return_index=True, return_inverse=True)
    order = np.argsort(cpp.io.perm_vtk(_dolfinx_facet(body), len(reference)))
    cells = inverse.reshape(len(entities), -1)[:, order]
    return at.x[first], cells, FACET_TYPES[facet][body.degree > 1], u[first], at.kept(first)


def _dolfinx_facet(body: Body) -> cpp.mesh.CellType:
    """The shape of a body's facets, as dolfinx names it."""
    return cpp.mesh.cell_entity_type(body.mesh.domain.topology.cell_type, body.mesh.dim - 1, 0)


def _tabulated(body: Body, cells: NDArray[np.int32], reference: Floats, nodal: Floats) -> Floats:
    """A function of nodal values (nodes, k) at a point (n, dim) of the reference cell in each of n cells, (n, k)."""
    table = basis_values(body.space.element.basix_element, reference)
    return np.einsum("np,npk->nk", table, nodal[body.space.dofmap.list[cells]])


def values_at(body: Body, function: fem.Function, points: ArrayLike) -> Floats:
    """A function's values (n, k) at points (n, dim) of a body. Raises ValueError for points outside of it."""
    dim = body.mesh.dim
    x = as_floats("points", points, f"coordinates of shape (n, {dim})")
    if x.ndim != 2 or x.shape[1] != dim or not np.all(np.isfinite(x)):
        raise ValueError(f"points of shape {x.shape}: expected finite coordinates of shape (n, {dim})")
    x = np.pad(x, ((0, 0), (0, 3 - dim)))
    domain = body.mesh.domain
    boxes = geometry.compute_collisions_points(geometry.bb_tree(domain, dim, padding=1e-8 * body.mesh.size), x)
    hits = geometry.compute_colliding_cells(domain, boxes, x)
    counts = np.diff(hits.offsets)
    if np.any(counts == 0):
        worst = int(np.argmin(counts))
        raise ValueError(
            f"points: {int(np.sum(counts == 0))} of {len(x)} are outside of body {body.name!r}, the first of them "
            f"{x[worst, :dim]}; expected points of the undeformed body"
        )
    return function.eval(x, hits.array[hits.offsets[:-1]]).reshape(len(x), -1)
