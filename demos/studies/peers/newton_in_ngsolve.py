"""Newton's method with NGSolve, as the groove and the dimple have it: law, elastic energy, steps of both kinds."""

from __future__ import annotations

import ngsolve as ng

#: Steps of Newton's method, and of conjugate gradients: a preconditioner that holds the bodies takes about seven.
MOST, MOST_INNER = 40, 300


def stored(u, v, lame, shear):
    """σ(u) : ε(v) of an isotropic material."""
    e, f = ng.Sym(ng.Grad(u)), ng.Sym(ng.Grad(v))
    return 2 * shear * ng.InnerProduct(e, f) + lame * ng.Trace(e) * ng.Trace(f)


def law(z, softness, exponent):
    """The pressure of a power layer at the gap z, and its tangent."""
    c = ng.IfPos(-z, -z, 1)
    p = (c / softness) ** (1 / exponent)
    return ng.IfPos(-z, p, 0), ng.IfPos(-z, p / (exponent * c), 0)


def newton(vector, solve_step, residual, goal):
    """The number of steps to a residual below the goal."""
    steps, now = 0, residual()
    while ng.Norm(now) > goal:
        steps += 1
        if steps > MOST:
            raise RuntimeError(f"no convergence in {MOST} steps")
        now = _advance(vector, solve_step(now), now, residual)
    return steps


def _advance(vector, correction, before, residual):
    """A full step or, where the energy would rise, one to where its slope vanishes; the residual there."""
    downhill = ng.InnerProduct(before, correction)
    t, low, high = 1.0, 0.0, 1.0
    vector.data += correction
    for _ in range(10):
        now = residual()
        slope = ng.InnerProduct(now, correction)
        if abs(slope) <= 0.5 * downhill:
            break
        low, high = (t, high) if slope > 0 else (low, t)
        if low == high:
            break
        new = 0.5 * (low + high)
        vector.data += (new - t) * correction
        t = new
    return now


def conjugate_gradients(matrix, inverse, project, right):
    """The solution to a thousandth."""
    solution, residual = right.CreateVector(), right.CreateVector()
    solution[:] = 0.0
    residual.data = right
    direction, preconditioned, image = (right.CreateVector() for _ in range(3))
    preconditioned.data = inverse * residual
    project.Project(preconditioned)
    direction.data = preconditioned
    square = first = ng.InnerProduct(residual, preconditioned)
    for _ in range(MOST_INNER):
        image.data = matrix * direction
        length = square / ng.InnerProduct(direction, image)
        solution.data += length * direction
        residual.data -= length * image
        project.Project(residual)
        preconditioned.data = inverse * residual
        project.Project(preconditioned)
        square, before = ng.InnerProduct(residual, preconditioned), square
        if square <= 1e-6 * first:
            break
        direction.data = preconditioned + (square / before) * direction
    return solution
