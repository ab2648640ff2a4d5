"""The groove with GetFEM: its own Newton method on a model of both bodies, the contact a nonlinear boundary term."""

from __future__ import annotations

import getfem as gf
import numpy as np

from .problem import (
    DEPTH,
    EXPONENT,
    GROOVE,
    HEIGHT,
    LAME,
    LENGTH,
    LOAD,
    SHEAR,
    SOFTNESS,
    START,
    TOLERANCE,
    Answer,
    Grid,
    gap,
    pressure,
)

gf.util_trace_level(0)
SIDES, OUTER, CONTACT = 1, 2, 3
MOST = 15


def solve(grid: Grid, shape: str, degree: int, way: str = "newton") -> Answer:
    """The groove on triangles or quadrilaterals of that degree."""
    model = gf.Model("real")
    model.add_initialized_data("lame", LAME)
    model.add_initialized_data("shear", SHEAR)
    integrals, spaces = [], []
    for name, up in (("u1", False), ("u2", True)):
        mesh = _mesh(grid, shape, up)
        space, integral = _space(mesh, shape, degree, not up), _integral(mesh, shape, degree)
        model.add_fem_variable(name, space)
        model.add_isotropic_linearized_elasticity_brick(integral, name, "lame", "shear")
        model.add_source_term_brick(integral, name, f"[0;{-LOAD if up else LOAD}]", OUTER)
        integrals.append(integral)
        spaces.append((mesh, space))
    model.add_interpolate_transformation_from_expression("across", spaces[0][0], spaces[1][0], "X")
    room = f"pos_part(1-sqr(X(1)/{GROOVE}))"
    # The upper body starts that much lower; a rigid motion, so that it need not be in u2.
    z = f"({DEPTH}*{room}*sqrt({room}) - {START!r} - u1(2) + Interpolate(u2,across)(2))"
    # 1e-20 keeps the derivative finite where the gap is open.
    p = f"pow((pos_part(-{z})+1e-20)*{1 / SOFTNESS!r},{1 / EXPONENT!r})"
    work = f"{p}*(Test_u1(2)-Interpolate(Test_u2,across)(2))"
    model.add_nonlinear_term(integrals[0], work, CONTACT)
    steps, _ = model.solve("max_res", TOLERANCE, "max_iter", MOST, "lsolver", "mumps", "lsearch", "basic")
    x, _ = grid.points
    points = np.vstack([x, np.full(len(x), HEIGHT)])
    normal = [
        gf.compute_interpolate_on(space, model.variable(name), points)[1]
        for (_, space), name in zip(spaces, ("u1", "u2"), strict=True)
    ]
    return Answer(pressure(gap(x) - START - normal[0] + normal[1]), sum(s.nbdof() for _, s in spaces), steps)


def _mesh(grid: Grid, shape: str, up: bool) -> gf.Mesh:
    y = HEIGHT + grid.y if up else HEIGHT - grid.y[::-1]
    mesh = gf.Mesh("cartesian" if shape == "quadrilateral" else "triangles grid", grid.x, y)
    outer = 2 * HEIGHT if up else 0.0
    for region, axis, values in ((SIDES, 0, (0.0, LENGTH)), (OUTER, 1, (outer,)), (CONTACT, 1, (HEIGHT,))):
        faces = [
            mesh.faces_from_pid(mesh.pid_from_coords(np.array([p for p in mesh.pts().T if p[axis] == value]).T))
            for value in values
        ]
        mesh.set_region(region, np.hstack(faces))
    return mesh


def _space(mesh: gf.Mesh, shape: str, degree: int, pinned: bool) -> gf.MeshFem:
    space = gf.MeshFem(mesh, 2)
    space.set_fem(gf.Fem(f"FEM_QK(2,{degree})" if shape == "quadrilateral" else f"FEM_PK(2,{degree})"))
    on_sides = space.basic_dof_on_region(SIDES)
    held = on_sides[on_sides % 2 == 0]
    if pinned:  # one vertical displacement: nothing else holds both bodies together
        held = np.append(held, on_sides[on_sides % 2 == 1][0])
    return gf.MeshFem("partial", space, np.setdiff1d(np.arange(space.nbdof()), held))


def _integral(mesh: gf.Mesh, shape: str, degree: int) -> gf.MeshIm:
    order = 2 * degree + 2 if shape == "quadrilateral" else min(2 * degree + 2, 13)
    rule = f"IM_GAUSS_PARALLELEPIPED(2,{order})" if shape == "quadrilateral" else f"IM_TRIANGLE({order})"
    return gf.MeshIm(mesh, gf.Integ(rule))
