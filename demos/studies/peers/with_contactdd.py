"""The groove with contactdd, asked as the other packages are."""

from __future__ import annotations

import numpy as np

import contactdd as cd

from .problem import EXPONENT, HEIGHT, LENGTH, LOAD, POISSON, SOFTNESS, TOLERANCE, YOUNG, Answer, Grid, gap

STEEL = cd.Isotropic(E=YOUNG, nu=POISSON)
OTHER_STEEL = cd.Isotropic(E=YOUNG * (1 + 1e-13), nu=POISSON)  # not the same: a copy is found by its geometry
LAYER = cd.PowerLayer(B=SOFTNESS, a=EXPONENT)


def solve(grid: Grid, shape: str, degree: int, way: str) -> Answer:
    """The groove on triangles or quadrilaterals of that degree.

    way: "coupled" (Newton's method) or "decomposed" (the chord method), the local solver, and "nothing shared" if the
    upper body is to be another one: "coupled, condensed", "coupled, condensed, nothing shared".
    """
    method, local_solver, *apart = way.split(", ")
    of = scene(grid, shape, degree, copies=not apart)
    solution = cd.solve(
        of, {"coupled": "auto", "decomposed": "chord"}[method], tolerance=TOLERANCE, local_solver=local_solver
    )
    result = solution.contact(degree=16)  # nine Gauss points per facet, those of `Grid.points`
    unknowns = sum(problem.size for problem in of.local_problems("assembled"))
    return Answer(result.pressure[np.argsort(result.x[:, 0])], unknowns, solution.iterations)


def scene(grid: Grid, shape: str, degree: int, copies: bool = True) -> cd.Scene:
    """Both bodies, the upper one on the mirror image of the lower one's mesh, or one that only looks alike."""
    sides = [cd.Symmetry("left", "right")]
    mesh = cd.rectangle((0, 0), (LENGTH, HEIGHT), (grid.x, HEIGHT - grid.y[::-1]), shape=shape)
    if copies:
        other, bottom, top, material = mesh.mirrored("y", HEIGHT), "top", "bottom", STEEL
    else:
        corners = (0, HEIGHT), (LENGTH, 2 * HEIGHT)
        other = cd.rectangle(*corners, (grid.x, HEIGHT + grid.y), shape=shape, diagonal="left")
        bottom, top, material = "bottom", "top", OTHER_STEEL
    lower = cd.Body("lower", mesh, STEEL, supports=sides, loads=[cd.Pressure("bottom", LOAD)], degree=degree)
    upper = cd.Body("upper", other, material, supports=sides, loads=[cd.Pressure(top, LOAD)], degree=degree)
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, bottom), LAYER, gap=lambda x: gap(x[0]))])
