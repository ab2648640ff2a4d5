"""Data that may vary in space: a number, an array, a function of the coordinates or anything UFL understands."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeAlias

import basix
import basix.ufl
import numpy as np
import ufl
from dolfinx import fem
from dolfinx import mesh as dmesh

from .base.checks import as_floats, check_vector
from .parameter import Followed, ParameterField, current

#: The value of a load or a prescribed displacement, as a user may give it.
Field: TypeAlias = (
    float
    | list[float]
    | tuple[float, ...]
    | np.ndarray
    | Callable[[np.ndarray], Any]
    | Any  # UFL's expressions, which have no types
    | Followed
    | ParameterField
)

#: How far into a cell a function is looked at for a jump, in sizes of the cell, and what is one, in largest values.
NUDGE, JUMP = 1e-10, 1e-3


def check_field(name: str, value: Any, vector: bool = False) -> None:
    """Raise unless `value` is a number, a callable or a UFL expression (a vector of them if `vector`)."""
    given = current(value)
    if callable(given) or isinstance(given, ufl.core.expr.Expr):
        return
    expected = ("2 or 3 finite numbers" if vector else "a finite number") + ", or a function of the coordinates"
    array = as_floats(name, given, expected)
    if array.shape not in (((2,), (3,)) if vector else ((),)) or not np.all(np.isfinite(array)):
        raise ValueError(f"{name} = {value!r}: expected {expected}")


def check_dimension(name: str, value: Any, dim: int) -> None:
    """Raise if a vector has another number of components than `dim`; functions are checked when they are evaluated."""
    value = current(value)
    if isinstance(value, ufl.core.expr.Expr):
        if value.ufl_shape != (dim,):
            raise ValueError(f"{name}: expected a UFL expression of shape {(dim,)}, got {value.ufl_shape}")
    elif not callable(value):
        check_vector(name, value, dim)


def coefficient(name: str, value: Field, domain: dmesh.Mesh, shape: tuple[int, ...], degree: int) -> Any:
    """`value` as a UFL coefficient of the given shape on `domain`.

    Numbers become `fem.Constant`s, so that another value never compiles another form. Functions take coordinates
    x (3, points) as dolfinx's do and are interpolated by polynomials of `degree` in each cell; where cells meet they
    may jump. Of a parameter, its present value.
    """
    return _coefficient(name, value, domain, shape, ("Discontinuous Lagrange", degree, shape))


def volume_coefficient(name: str, value: Field, domain: dmesh.Mesh, shape: tuple[int, ...], degree: int) -> Any:
    """The same of what acts in the inside of cells: a function may jump where they meet, as materials do there."""
    element = inner_element(domain, degree)
    return _coefficient(
        name, value, domain, shape, basix.ufl.blocked_element(element, shape=shape) if shape else element
    )


def _coefficient(name: str, value: Field, domain: dmesh.Mesh, shape: tuple[int, ...], element: Any) -> Any:
    value = current(value)
    if isinstance(value, ufl.core.expr.Expr):
        if value.ufl_shape != shape:
            raise ValueError(f"{name}: expected a UFL expression of shape {shape}, got {value.ufl_shape}")
        refuse_other_mesh(name, value, domain)
        return value
    if callable(value):
        function = fem.Function(fem.functionspace(domain, element))
        size = math.prod(shape)  # dolfinx takes tensors row by row
        cells = cell_count(domain)
        function.interpolate(lambda x: one_sided(name, value, x, shape, cells).reshape(size, -1))
        return function
    array = as_floats(name, value, f"finite values of shape {shape}")
    if array.shape != shape or not np.all(np.isfinite(array)):
        raise ValueError(f"{name} = {value!r}: expected finite values of shape {shape}")
    return fem.Constant(domain, array if shape else float(array))


def cell_count(domain: dmesh.Mesh) -> int:
    """The number of cells on this rank, ghosts too."""
    cells = domain.topology.index_map(domain.topology.dim)
    return cells.size_local + cells.num_ghosts


def one_sided(name: str, value: Field, x: np.ndarray, shape: tuple[int, ...], cells: int) -> np.ndarray:
    """`value` at points x (3, n) that stand cell by cell: where it jumps, the values that it has inside each cell."""
    nodes = x.reshape(3, cells, -1)
    inside = nodes + NUDGE * (nodes.mean(axis=2, keepdims=True) - nodes)
    there, near = (evaluate(name, value, each.reshape(3, -1), shape) for each in (nodes, inside))
    return np.where(np.abs(near - there) > JUMP * np.abs(there).max(initial=0.0), near, there)


def refuse_other_mesh(name: str, value: Any, domain: dmesh.Mesh) -> None:
    """Raise if a UFL expression or form belongs to another mesh than `domain`."""
    domains = value.ufl_domains() if isinstance(value, ufl.Form) else ufl.domain.extract_domains(value)
    if any(each != domain.ufl_domain() for each in domains):
        raise ValueError(f"{name}: its UFL expression belongs to another mesh; expected one on the body's, mesh.domain")


def inner_element(domain: dmesh.Mesh, degree: int) -> Any:
    """A scalar element with its nodes inside the cells, where fields have one value and a radius is not zero."""
    cell = domain.topology.cell_name()
    if degree == 0:
        return basix.ufl.element("P", cell, 0, discontinuous=True)
    return basix.ufl.element(
        "P", cell, degree, lagrange_variant=basix.LagrangeVariant.chebyshev_isaac, discontinuous=True
    )


def evaluate(name: str, value: Field, x: np.ndarray, shape: tuple[int, ...] = ()) -> np.ndarray:
    """`value` at the points x (dim, n): an array of `shape` + (n,), checked to be finite."""
    value = current(value)
    array = as_floats(name, value(x) if callable(value) else value, "numbers")
    if array.shape == shape:
        array = np.broadcast_to(array.reshape((*shape, 1)), (*shape, x.shape[1]))
    if array.shape != (*shape, x.shape[1]):
        raise ValueError(f"{name}: expected values of shape {(*shape, x.shape[1])}, got {array.shape}")
    if not np.all(np.isfinite(array)):
        worst = int(np.argmin(np.isfinite(array).reshape(-1, x.shape[1]).all(axis=0)))
        raise ValueError(f"{name}: not finite at x = {x[:, worst]}")
    return np.array(array)
