"""The groove with contactdd, asked as the other packages are."""

from __future__ import annotations

import numpy as np

import contactdd as cd

from .problem import EXPONENT, HEIGHT, LENGTH, LOAD, POISSON, SOFTNESS, TOLERANCE, YOUNG, Answer, Grid, gap

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
    """Both bodies, the upper one on the mirror image of the lower one's mesh."""
    sides = [cd.Symmetry("left", "right")]
    mesh = cd.rectangle((0, 0), (LENGTH, HEIGHT), (grid.x, HEIGHT - grid.y[::-1]), shape=shape)
    lower, upper = (
        cd.Body(name, each, STEEL, supports=sides, loads=[cd.Pressure("bottom", LOAD)], degree=degree)
        for name, each in (("lower", mesh), ("upper", mesh.mirrored("y", HEIGHT)))
    )
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "top"), LAYER, gap=lambda x: gap(x[0]))])
