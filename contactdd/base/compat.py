"""Every difference between the supported dolfinx versions (0.9, 0.10, 0.11) and nothing else.

The rest of the package calls these functions and never asks for a version.
"""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Sequence
from copy import copy
from functools import cache
from typing import Any

with contextlib.suppress(ImportError):
    # The wheel that PyPI offers keeps its libraries in this module; it has to come before dolfinx.
    import dolfinx_solver  # noqa: F401

import basix
import basix.ufl
import dolfinx
import numpy as np
import ufl
from dolfinx import cpp, fem
from dolfinx import mesh as dmesh
from mpi4py import MPI
from numpy.typing import NDArray

from . import compiler


def _let_warnings_be_seen() -> None:
    """Undo that FFCx hands all warnings of the process to a log that nobody reads."""
    log = logging.getLogger("py.warnings")
    if not any(not isinstance(each, logging.NullHandler) for each in (*log.handlers, *logging.getLogger().handlers)):
        logging.captureWarnings(False)


_let_warnings_be_seen()


VERSION = tuple(int(part) for part in dolfinx.__version__.split(".")[:2])


HAS_ENTITY_MAP = hasattr(dmesh, "EntityMap")  # 0.10 and later


#: Several ranks that compile one form wait for each other's lock file; the default of 10 s is too short for that.
TIMEOUT = 120


def facet_submesh(domain: dmesh.Mesh, facets: NDArray[np.int32]) -> tuple[dmesh.Mesh, NDArray[np.int32], Any]:
    """The mesh of the given facets, the parent facet of each of its cells, and the entity map for `form`."""
    dim = domain.topology.dim - 1
    submesh, entity_map, _, _ = dmesh.create_submesh(domain, dim, facets)
    if HAS_ENTITY_MAP:
        index_map = submesh.topology.index_map(dim)
        cells = np.arange(index_map.size_local + index_map.num_ghosts, dtype=np.int32)
        return submesh, np.asarray(entity_map.sub_topology_to_topology(cells, False), dtype=np.int32), entity_map
    parent = np.asarray(entity_map, dtype=np.int32)
    index_map = domain.topology.index_map(dim)
    inverse = np.full(index_map.size_local + index_map.num_ghosts, -1, dtype=np.int32)
    inverse[parent] = np.arange(len(parent), dtype=np.int32)
    return submesh, parent, (submesh, inverse)


def form(expression: Any, *entity_maps: Any) -> fem.Form:
    """Compile a UFL form; `entity_maps` are those of `facet_submesh`."""
    maps: Any = list(entity_maps) if HAS_ENTITY_MAP else dict(entity_maps)
    return fem.form(expression, jit_options=_jit_options(), entity_maps=maps)


def compiled(expression: Any) -> fem.CompiledForm:
    """Compile a UFL form on no mesh in particular, for `fem.create_form`."""
    return fem.compile_form(
        MPI.COMM_SELF, expression, form_compiler_options={"scalar_type": np.float64}, jit_options=_jit_options()
    )


def bound(shared: fem.CompiledForm, spaces: Sequence[fem.FunctionSpace], subdomains: Any, constant: Any) -> fem.Form:
    """A compiled form of one constant, as `fem.create_form` makes it, which searches the whole form for constants."""
    pointer = shared.module.ffi.cast("uintptr_t", shared.module.ffi.addressof(shared.ufcx_form))
    constants = {"c0": cpp.fem.Constant_float64(np.asarray(constant, dtype=float))}
    maps: Any = [] if HAS_ENTITY_MAP else {}
    domain, spaces = spaces[0].mesh._cpp_object, [space._cpp_object for space in spaces]
    made = cpp.fem.create_form_float64(pointer, spaces, {}, constants, subdomains, maps, domain)
    return fem.Form(made, shared.ufcx_form, shared.code)


def _jit_options() -> dict[str, Any]:
    return {"timeout": TIMEOUT, "cffi_extra_compile_args": compiler.flags()}


def expression_points(element: Any) -> NDArray[np.float64]:
    """The interpolation points of a finite element, as `fem.Expression` takes them."""
    points = element.interpolation_points
    return points() if callable(points) else points


def coordinate_map(domain: dmesh.Mesh) -> Any:
    """The coordinate element of the mesh, as a scalar basix element."""
    return domain.ufl_domain().ufl_coordinate_element().basix_element


def entity_vertices(domain: dmesh.Mesh) -> list[list[list[int]]]:
    """The vertices of the entities of each dimension of the reference cell."""
    return basix.topology(coordinate_map(domain).cell_type)


def geometry_dofmap(domain: dmesh.Mesh) -> NDArray[np.int32]:
    """The geometry nodes of every cell, shape (cells, nodes)."""
    geometry = domain.geometry
    return geometry.dofmaps[0] if VERSION >= (0, 11) else geometry.dofmap


def structured(
    corners: Sequence[NDArray[np.float64]], counts: Sequence[int], cell: dmesh.CellType, diagonal: dmesh.DiagonalType
) -> dmesh.Mesh:
    """A mesh of equal cells between two corners, `diagonal` the way in which triangles are cut."""
    if len(counts) == 2:
        mesh = cpp.mesh.create_rectangle_float64(MPI.COMM_SELF, corners, counts, cell, None, diagonal)
    else:
        mesh = cpp.mesh.create_box_float64(MPI.COMM_SELF, corners, counts, cell, None)
    return dmesh.Mesh(mesh, ufl.Mesh(_straight_element(cell)))


def function_space(domain: dmesh.Mesh, element: Any) -> fem.FunctionSpace:
    """The space of a basix element, as of `fem.functionspace`, without its searches for what all meshes share."""
    own = _finite_element(domain.topology.cell_type, element)
    dofmap = cpp.fem.create_dofmap(domain.comm, domain.topology._cpp_object, own)
    shape = (element.reference_value_shape,) if VERSION < (0, 10) else ()
    return fem.FunctionSpace(domain, element, cpp.fem.FunctionSpace_float64(domain._cpp_object, own, dofmap, *shape))


def with_cell(element: Any) -> Any:
    """The same basix element with its `cell` stored: basix builds it anew at every access."""

    class WithCell(type(element)):  # type: ignore[misc]
        cell = element.cell

    same = copy(element)
    same.__class__ = WithCell
    return same


@cache
def _straight_element(cell: dmesh.CellType) -> Any:
    """The coordinate element that dolfinx gives to structured meshes."""
    return with_cell(_sample(cell).ufl_domain().ufl_coordinate_element())


@cache
def _finite_element(cell: dmesh.CellType, element: Any) -> Any:
    """dolfinx's own object of a basix element."""
    return fem.functionspace(_sample(cell), element)._cpp_object.element


def _sample(cell: dmesh.CellType) -> dmesh.Mesh:
    """A smallest mesh, whose objects for a cell type are shared by all meshes; the mesh itself is not kept."""
    if dmesh.cell_dim(cell) == 2:
        return dmesh.create_unit_square(MPI.COMM_SELF, 1, 1, cell)
    return dmesh.create_unit_cube(MPI.COMM_SELF, 1, 1, 1, cell)


def mesh_of(domain: ufl.Mesh) -> dmesh.Mesh:
    """The mesh that a UFL domain stands for."""
    return dmesh.Mesh(domain.ufl_cargo(), domain)


def with_coordinates(domain: dmesh.Mesh, x: NDArray[np.float64], nodes: NDArray[np.int32] | None = None) -> dmesh.Mesh:
    """A mesh of the same topology, which is shared, with its nodes at x (nodes, dim).

    nodes: (cells, nodes) those of the cells, by default as they are.
    """
    old = domain.geometry._cpp_object
    element, dofmap = (old.cmaps[0], old.dofmaps[0]) if VERSION >= (0, 11) else (old.cmap, old.dofmap)
    of_cells = dofmap if nodes is None else nodes
    new = cpp.mesh.Geometry_float64(old.index_map(), of_cells, element, x, old.input_global_indices)
    mesh = cpp.mesh.Mesh_float64(domain.comm, domain.topology._cpp_object, new)
    return dmesh.Mesh(mesh, ufl.Mesh(domain.ufl_domain().ufl_coordinate_element()))


def from_arrays(cells: NDArray[np.integer[Any]], x: NDArray[np.float64], element: Any) -> dmesh.Mesh:
    """The mesh of cells (cells, nodes) with nodes at x (nodes, dim); dolfinx does not check them.

    The nodes of a cell are in the order of the coordinate element, as in `geometry_dofmap`.
    """
    return dmesh.create_mesh(MPI.COMM_SELF, cells=cells, x=x, e=element)


@cache
def coordinate_element(shape: str, degree: int) -> Any:
    """The coordinate element of cells whose nodes are evenly spaced."""
    dim = dmesh.cell_dim(dmesh.CellType[shape])
    if degree == 1:  # as that of structured meshes, so that forms are compiled once for both
        return _straight_element(dmesh.CellType[shape])
    return basix.ufl.element("Lagrange", shape, degree, basix.LagrangeVariant.equispaced, shape=(dim,))


def from_gmsh_order(shape: str, nodes: int) -> NDArray[np.int64]:
    """The order of gmsh's nodes of a cell that is dolfinx's: `dolfinx = gmsh[order]`."""
    return np.array(cpp.io.perm_gmsh(dmesh.CellType[shape], nodes), dtype=np.int64)
