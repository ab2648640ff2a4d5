"""The dimple with NGSolve: Newton's method on both blocks, cells condensed, one preconditioner for all steps.

One mesh, in which both blocks have displacements of their own that meet along the contact. The preconditioner holds
each block by a Robin term of its own; the ways to make it are those of `inverse_in_ngsolve`.
"""

from __future__ import annotations

from typing import Any

import ngsolve as ng
import numpy as np
from dimple import DEPTH, LAYER, LOAD, RADIUS, STEEL, TOLERANCE, Cells, gap
from netgen.meshing import Mesh
from ngsolve import ds, dx

from .inverse_in_ngsolve import inverted
from .newton_in_ngsolve import conjugate_gradients, law, newton, stored

ng.SetNumThreads(1)

E, NU = STEEL.E, STEEL.nu
LAME, SHEAR = E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))
B, A = float(LAYER.B), float(LAYER.a)
START = B * LOAD**A
#: dolfinx's six tetrahedra of a cube, by the corners x + 2 y + 4 z.
TETRAHEDRA = ((0, 1, 3, 7), (0, 1, 7, 5), (0, 5, 7, 4), (0, 3, 2, 7), (0, 6, 4, 7), (0, 2, 6, 7))


def solved(cells: Cells, way: str) -> tuple[np.ndarray, np.ndarray, np.ndarray, int, int]:
    """Points (n, 2) of the contact, their areas and pressures; the unknowns and Newton steps."""
    mesh = _mesh(cells)
    names = "lower", "upper"
    spaces = [
        ng.VectorH1(mesh, order=cells.degree, definedon=name, dirichletx=f"{name}_x", dirichlety=f"{name}_y")
        for name in names
    ]
    space = ng.Compress(spaces[0], spaces[0].FreeDofs()) * ng.Compress(spaces[1], spaces[1].FreeDofs())
    (u1, u2), (v1, v2) = space.TnT()
    closing, v_closing, contact = u1[2] - u2[2], v1[2] - v2[2], ds("contact", bonus_intorder=2)
    load = ng.LinearForm(LOAD * v1[2] * ds("bottom") - LOAD * v2[2] * ds("top")).Assemble()
    state = ng.GridFunction(space)
    state.components[1].Set(ng.CF((0, 0, -START)))
    pressure, slope = law(_gap() - state.components[0][2] + state.components[1][2], B, A)
    typical = START ** (1 / A - 1) / (A * B ** (1 / A))
    apart = u1[2] * v1[2] + u2[2] * v2[2]
    now_apart = state.components[0][2] * v1[2] + state.components[1][2] * v2[2]
    elastic = stored(u1, v1, LAME, SHEAR) * dx("lower") + stored(u2, v2, LAME, SHEAR) * dx("upper")
    fixed = ng.BilinearForm(elastic + typical * apart * contact, symmetric=True, condense=True).Assemble()
    free = ng.BitArray(space.FreeDofs(True))
    projector = ng.Projector(free, True)
    inverse = inverted(fixed.mat, free, way, lambda: _rigid(spaces))
    force = ng.LinearForm((pressure * v_closing - typical * now_apart) * contact)
    change_form = (slope * closing * v_closing - typical * apart) * contact
    change = ng.BilinearForm(change_form, symmetric=True, check_unused=False)
    given = load.vec.CreateVector()
    given.data = load.vec + fixed.harmonic_extension_trans * load.vec

    def residual() -> Any:
        force.Assemble()
        found = state.vec.CreateVector()
        found.data = given - force.vec - fixed.mat * state.vec
        projector.Project(found)
        return found

    def step(rhs: Any) -> Any:
        change.Assemble()
        return conjugate_gradients(fixed.mat + change.mat, inverse, projector, rhs)

    steps = newton(state.vec, step, residual, TOLERANCE * ng.Norm(load.vec))
    x, weights, closed = _at(mesh, cells, state)
    return x, weights, (np.maximum(closed - gap(x.T), 0) / B) ** (1 / A), int(sum(space.FreeDofs())), steps


def _gap() -> Any:
    room = 1 - (ng.x**2 + ng.y**2) / RADIUS**2
    return DEPTH * ng.IfPos(room, room, 0) ** 1.5


def _rigid(spaces: list[Any]) -> np.ndarray:
    """The rigid motions in the unknowns of both blocks, (unknowns, 6)."""
    x, y, z = ng.x, ng.y, ng.z
    columns = []
    for motion in ((1, 0, 0), (0, 1, 0), (0, 0, 1), (0, -z, y), (z, 0, -x), (-y, x, 0)):
        parts = []
        for space in spaces:
            function = ng.GridFunction(space)
            function.Set(ng.CF(motion))
            parts.append(function.vec.FV().NumPy()[np.flatnonzero(np.array(list(space.FreeDofs())))])
        columns.append(np.concatenate(parts))
    return np.array(columns).T


def _at(mesh: Any, cells: Cells, state: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Gauss points of the contact (n, 2), their areas, and how much the faces approach each other there."""
    rule = ng.IntegrationRule(ng.QUAD if cells.kind == "Q" else ng.TRIG, 2 * cells.degree + 8)
    points = mesh.MapToAllElements(rule, mesh.Boundaries("contact"))
    x = np.column_stack([np.asarray(each(points)).ravel() for each in (ng.x, ng.y)])
    closed = np.asarray((state.components[0][2] - state.components[1][2])(points)).ravel()
    return x, np.tile(np.asarray(rule.weights), len(x) // len(rule)), closed


def _mesh(cells: Cells) -> Any:
    """Both blocks in one mesh, cut as dolfinx cuts a box."""
    x, heights = cells.ends
    z = np.r_[-heights[::-1], heights[1:]]
    nx, nz = len(x) - 1, len(z) - 1
    mesh = Mesh(dim=3)
    places = np.stack(np.meshgrid(z, x, x, indexing="ij")[::-1], -1).reshape(-1, 3)  # x runs fastest
    mesh.AddPoints(places)
    number = np.arange((nz + 1) * (nx + 1) ** 2).reshape(nz + 1, nx + 1, nx + 1)
    corners = np.stack(
        [number[k : nz + k, j : nx + j, i : nx + i] for k in (0, 1) for j in (0, 1) for i in (0, 1)], -1
    ).reshape(-1, 8)
    half = len(corners) // 2
    for name, part in (("lower", corners[:half]), ("upper", corners[half:])):
        if cells.kind == "Q":
            made = part[:, [0, 1, 3, 2, 4, 5, 7, 6]]
        else:
            made = _oriented(np.concatenate([part[:, list(four)] for four in TETRAHEDRA]), places)
        _add(mesh, 3, name, made)
    middle = nz // 2
    faces = {"bottom": [number[0]], "top": [number[-1]], "contact": [number[middle]]}
    for name, own in (("lower", number[: middle + 1]), ("upper", number[middle:])):
        faces[f"{name}_x"] = [own[:, :, 0], own[:, :, -1]]
        faces[f"{name}_y"] = [own[:, 0, :], own[:, -1, :]]
    for name, grids in faces.items():
        quads = np.concatenate(
            [np.stack([g[:-1, :-1], g[:-1, 1:], g[1:, :-1], g[1:, 1:]], -1).reshape(-1, 4) for g in grids]
        )
        triangles = np.concatenate([quads[:, [0, 1, 3]], quads[:, [0, 3, 2]]])
        _add(mesh, 2, name, quads[:, [0, 1, 3, 2]] if cells.kind == "Q" else triangles)
    return ng.Mesh(mesh)


def _oriented(tetrahedra: np.ndarray, places: np.ndarray) -> np.ndarray:
    """The same tetrahedra, all turned as Netgen wants them."""
    p = places[tetrahedra]
    wrong = np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0]) > 0
    tetrahedra[wrong] = tetrahedra[wrong][:, [0, 2, 1, 3]]
    return tetrahedra


def _add(mesh: Mesh, dim: int, name: str, elements: np.ndarray) -> None:
    data = np.ascontiguousarray(elements, dtype=np.int32)
    mesh.AddElements(dim=dim, index=mesh.AddRegion(name, dim=dim), data=data, base=0)
