"""The groove with NGSolve: Newton's method on both bodies together.

One mesh, in which both bodies have displacements of their own that meet along the contact. Two ways to solve a step:
"newton" assembles and factors everything every time, "pcg" does it once, with the contact closed, as the preconditioner
of conjugate gradients; "pcg, cholmod" lets SuiteSparse factor. The unknowns inside the cells are condensed in all.
"""

from __future__ import annotations

from functools import partial

import ngsolve as ng
import numpy as np
from netgen.meshing import Mesh
from ngsolve import ds, dx

from .inverse_in_ngsolve import inverted
from .newton_in_ngsolve import conjugate_gradients, law, newton, stored
from .problem import (
    DEPTH,
    EXPONENT,
    GROOVE,
    HEIGHT,
    LAME,
    LOAD,
    SHEAR,
    SOFTNESS,
    START,
    TOLERANCE,
    Answer,
    Grid,
    gap,
    pressure,
    stiffness,
)

ng.SetNumThreads(1)

#: What inverts the preconditioner's matrix.
INVERSES = {"pcg": "sparsecholesky", "pcg, cholmod": "cholmod"}


def solve(grid: Grid, shape: str, degree: int, way: str) -> Answer:
    """The groove on triangles or quadrilaterals of that degree by "newton", "pcg" or "pcg, cholmod"."""
    mesh = _mesh(grid, shape)
    spaces = [ng.VectorH1(mesh, order=degree, definedon=body, dirichletx=f"{body}_side") for body in ("lower", "upper")]
    active = [each.FreeDofs() for each in spaces]
    active[0].Clear(spaces[0].ndof // 2)  # one vertical displacement: nothing else holds both bodies together
    bodies = [ng.Compress(each, dofs) for each, dofs in zip(spaces, active, strict=True)]
    space = bodies[0] * bodies[1]
    (u1, u2), (v1, v2) = space.TnT()
    closing, v_closing = u1[1] - u2[1], v1[1] - v2[1]
    contact = ds("contact", bonus_intorder=2)

    load = ng.LinearForm(LOAD * v1[1] * ds("bottom") - LOAD * v2[1] * ds("top")).Assemble()
    state = ng.GridFunction(space)
    state.components[1].Set(ng.CF((0, -START)))
    z = _gap() - state.components[0][1] + state.components[1][1]
    elastic = stored(u1, v1, LAME, SHEAR) * dx("lower") + stored(u2, v2, LAME, SHEAR) * dx("upper")
    prepare = _by_newton if way == "newton" else partial(_by_pcg, INVERSES[way])
    solve_step, residual = prepare(space, elastic, closing, v_closing, z, contact, load, state)
    steps = newton(state.vec, solve_step, residual, TOLERANCE * ng.Norm(load.vec))
    lower, upper = _contact_points(mesh, grid, shape)
    values = gap(grid.points[0]) - state.components[0][1](lower).ravel() + state.components[1][1](upper).ravel()
    return Answer(pressure(values), int(sum(space.FreeDofs())), steps)


def _gap():
    """d(x)."""
    room = 1 - (ng.x / GROOVE) ** 2
    return DEPTH * ng.IfPos(room, room, 0) ** 1.5


def _by_newton(space, elastic, closing, v_closing, z, contact, load, state):
    """Everything anew in each step."""
    p, slope = law(z, SOFTNESS, EXPONENT)
    free = space.FreeDofs(True)
    project = ng.Projector(free, True)
    now = state.components[0][1] - state.components[1][1]
    force = ng.LinearForm((p - slope * now) * v_closing * contact)
    tangent = ng.BilinearForm(elastic + slope * closing * v_closing * contact, symmetric=True, condense=True)

    def residual():
        tangent.Assemble()
        force.Assemble()
        right = state.vec.CreateVector()
        right.data = load.vec - force.vec
        right.data += tangent.harmonic_extension_trans * right
        right.data -= tangent.mat * state.vec
        project.Project(right)
        return right

    def solve_step(right):
        correction = state.vec.CreateVector()
        correction.data = tangent.mat.Inverse(free, "sparsecholesky") * right
        return correction

    return solve_step, residual


def _by_pcg(way, space, elastic, closing, v_closing, z, contact, load, state):
    """All but the contact once."""
    p, slope = law(z, SOFTNESS, EXPONENT)
    typical = float(stiffness(np.array(-START)))
    fixed = ng.BilinearForm(elastic + typical * closing * v_closing * contact, symmetric=True, condense=True).Assemble()
    free = space.FreeDofs(True)
    project = ng.Projector(free, True)
    inverse = inverted(fixed.mat, free, way)
    now = state.components[0][1] - state.components[1][1]
    force = ng.LinearForm((p - typical * now) * v_closing * contact)
    change = ng.BilinearForm((slope - typical) * closing * v_closing * contact, symmetric=True, check_unused=False)
    constant = load.vec.CreateVector()
    constant.data = load.vec + fixed.harmonic_extension_trans * load.vec

    def residual():
        force.Assemble()
        right = state.vec.CreateVector()
        right.data = constant - force.vec - fixed.mat * state.vec
        project.Project(right)
        return right

    def solve_step(right):
        change.Assemble()
        return conjugate_gradients(fixed.mat + change.mat, inverse, project, right)

    return solve_step, residual


def _mesh(grid: Grid, shape: str) -> ng.Mesh:
    """Both bodies, with the contact's edges between them."""
    y = np.concatenate([HEIGHT - grid.y[::-1], HEIGHT + grid.y[1:]])
    nx, ny = len(grid.x) - 1, len(y) - 1
    xy = np.stack(np.meshgrid(grid.x, y), axis=-1).reshape(-1, 2)
    corner = (np.arange(ny)[:, None] * (nx + 1) + np.arange(nx)).ravel()
    quads = corner[:, None] + [0, 1, nx + 2, nx + 1]
    mesh = Mesh(dim=2)
    mesh.AddPoints(np.column_stack([xy, np.zeros(len(xy))]))
    for half, name in enumerate(("lower", "upper")):
        cells = quads[half * len(quads) // 2 : (half + 1) * len(quads) // 2]
        if shape == "triangle":
            split = ([0, 1, 2], [0, 2, 3]) if half == 0 else ([0, 1, 3], [1, 2, 3])
            cells = np.concatenate([cells[:, part] for part in split])
        mesh.AddElements(
            dim=2, index=mesh.AddRegion(name, dim=2), data=np.ascontiguousarray(cells, dtype=np.int32), base=0
        )
    node = np.arange(len(xy), dtype=np.int32).reshape(ny + 1, nx + 1)
    middle = ny // 2
    lines = {
        "bottom": [node[0]],
        "top": [node[-1]],
        "contact": [node[middle]],
        "lower_side": [node[: middle + 1, 0], node[: middle + 1, -1]],
        "upper_side": [node[middle:, 0], node[middle:, -1]],
    }
    for name, chains in lines.items():
        index = mesh.AddRegion(name, dim=1)
        for chain in chains:
            mesh.AddElements(
                dim=1, index=index, data=np.ascontiguousarray(np.column_stack([chain[:-1], chain[1:]])), base=0
            )
    return ng.Mesh(mesh)


def _contact_points(mesh: ng.Mesh, grid: Grid, shape: str) -> list[np.ndarray]:
    """`Grid.points` as points of the cells below and above: a search would find either body's."""
    nx, half = len(grid.x) - 1, mesh.ne // 2
    per_facet = len(grid.points[0]) // nx
    t = ((grid.points[0].reshape(nx, -1) - grid.x[:-1, None]) / np.diff(grid.x)[:, None]).ravel()
    zero, one = np.zeros_like(t), np.ones_like(t)
    if shape == "quadrilateral":
        places = ((half - nx, t, one), (half, t, zero))
    else:
        # The last cells of the lower body are [0, 2, 3] of their squares, the first of the upper one [0, 1, 3].
        places = ((half - nx, zero, t), (half, 1 - t, t))
    found = []
    for first, x, y in places:
        points = mesh(grid.points[0], np.full(len(t), 0.5 * HEIGHT))
        points["nr"] = first + np.repeat(np.arange(nx), per_facet)
        points["x"], points["y"] = x, y
        found.append(points)
    return found
