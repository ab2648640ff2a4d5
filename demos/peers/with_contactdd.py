"""The groove with contactdd, asked as the other packages are."""

from __future__ import annotations

import numpy as np

import contactdd as cd

from .problem import EXPONENT, HEIGHT, LENGTH, LOAD, POISSON, SOFTNESS, TOLERANCE, YOUNG, Answer, Floats, Grid, gap

STEEL = cd.Isotropic(E=YOUNG, nu=POISSON)
LAYER = cd.PowerLayer(B=SOFTNESS, a=EXPONENT)


def solve(grid: Grid, shape: str, degree: int, way: str) -> Answer:
    """The groove on triangles or quadrilaterals of that degree.

    way: "coupled" (Newton's method) or "decomposed" (the chord method), and the local solver: "coupled, condensed".
    """
    method, local_solver = way.split(", ")
    of = scene(grid, shape, degree)
    solution = cd.solve(
        of, {"coupled": "auto", "decomposed": "chord"}[method], tolerance=TOLERANCE, local_solver=local_solver
    )
    result = solution.contact(degree=16)  # nine Gauss points per facet, those of `Grid.points`
    unknowns = sum(problem.size for problem in of.subproblems("assembled"))
    return Answer(result.pressure[np.argsort(result.x[:, 0])], unknowns, solution.iterations)


def scene(grid: Grid, shape: str, degree: int) -> cd.Scene:
    """Both bodies, the mesh of the upper one mirrored."""
    sides = [cd.Symmetry("left", "right")]
    lines: tuple[Floats, Floats] = (HEIGHT - grid.y[::-1], HEIGHT + grid.y)
    lower_mesh = cd.rectangle((0, 0), (LENGTH, HEIGHT), (grid.x, lines[0]), shape=shape)
    upper_mesh = cd.rectangle((0, HEIGHT), (LENGTH, 2 * HEIGHT), (grid.x, lines[1]), shape=shape, diagonal="left")
    lower = cd.Body("lower", lower_mesh, STEEL, supports=sides, loads=[cd.Pressure("bottom", LOAD)], degree=degree)
    upper = cd.Body("upper", upper_mesh, STEEL, supports=sides, loads=[cd.Pressure("top", LOAD)], degree=degree)
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), LAYER, gap=lambda x: gap(x[0]))])
