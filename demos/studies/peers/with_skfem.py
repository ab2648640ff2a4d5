"""The groove with scikit-fem: every body on a mesh of its own, meeting at the same points along the contact.

"pcg" factors each body once, with the contact closed, as the preconditioner of conjugate gradients for Newton's method;
"newton" factors both together in every step.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import scipy.sparse as sp
import skfem
from scipy.sparse.linalg import LinearOperator, cg, splu
from skfem.helpers import ddot, sym_grad, trace

from .problem import (
    HEIGHT,
    LAME,
    LENGTH,
    LOAD,
    SHEAR,
    START,
    TOLERANCE,
    Answer,
    Floats,
    Grid,
    advance,
    gap,
    pressure,
    stiffness,
)

MOST = 40
ELEMENTS = {
    "triangle": {1: skfem.ElementTriP1, 2: skfem.ElementTriP2, 3: skfem.ElementTriP3, 4: skfem.ElementTriP4},
    "quadrilateral": {1: skfem.ElementQuad1, 2: skfem.ElementQuad2},
}


@skfem.BilinearForm
def elasticity(u, v, _):
    e, f = sym_grad(u), sym_grad(v)
    return 2 * SHEAR * ddot(e, f) + LAME * trace(e) * trace(f)


@skfem.LinearForm
def vertical(v, _):
    return v[1]


class Half:
    """One body: its free stiffness matrix, its load and its normal displacement at points of the contact."""

    def __init__(self, grid: Grid, shape: str, degree: int, up: bool) -> None:
        kind = skfem.MeshQuad if shape == "quadrilateral" else skfem.MeshTri
        mesh = kind.init_tensor(grid.x, HEIGHT + grid.y if up else HEIGHT - grid.y[::-1])
        element = ELEMENTS[shape].get(degree) or partial(skfem.ElementQuadP, degree)
        self.basis = skfem.Basis(mesh, skfem.ElementVector(element()), intorder=2 * degree)
        self.sign = -1.0 if up else 1.0
        held = self.basis.get_dofs(mesh.facets_satisfying(lambda x: np.isin(x[0], (0.0, LENGTH)))).all("u^1")
        if not up:  # one vertical displacement: nothing else holds both bodies together
            held = np.append(held, self.basis.nodal_dofs[1, 0])
        self.free = np.setdiff1d(np.arange(self.basis.N), held)
        outer = mesh.facets_satisfying(lambda x: x[1] == (2 * HEIGHT if up else 0.0))
        self.touching = mesh.facets_satisfying(lambda x: x[1] == HEIGHT)
        self.matrix = elasticity.assemble(self.basis)[self.free][:, self.free]
        load = vertical.assemble(self.basis.boundary(outer, intorder=degree))
        self.load = self.sign * LOAD * load[self.free]

    def trace(self, points: int) -> tuple[Floats, Floats, sp.csr_matrix]:
        """x of so many Gauss points per facet, in order, their weights, and the operator to u_n there."""
        reference, weights = np.polynomial.legendre.leggauss(points)
        face = self.basis.boundary(self.touching, quadrature=(0.5 * (1 + reference)[None], 0.5 * weights))
        x = face.global_coordinates()[0].ravel()
        rows = np.arange(len(x)).reshape(face.dx.shape)
        entries = [
            (self.sign * values[0].value[1].ravel(), rows.ravel(), np.repeat(dofs, points))
            for values, dofs in zip(face.basis, face.element_dofs, strict=True)
        ]
        data, row, column = (np.concatenate(part) for part in zip(*entries, strict=True))
        order = np.argsort(x)
        matrix = sp.csr_matrix((data, (row, column)), shape=(len(x), self.basis.N))
        return x[order], face.dx.ravel()[order], matrix[order][:, self.free]


def solve(grid: Grid, shape: str, degree: int, way: str) -> Answer:
    """The groove on triangles or quadrilaterals of that degree by "newton" or "pcg"."""
    halves = [Half(grid, shape, degree, up) for up in (False, True)]
    x, weights, traces = zip(*(half.trace(degree + 2) for half in halves), strict=True)
    # The upper body starts that much lower; a rigid motion, so that it need not be in u.
    d, weights, closing = gap(x[0]) - START, weights[0], sp.hstack(traces, format="csr")
    matrix = sp.block_diag([half.matrix for half in halves], format="csr")
    load = np.concatenate([half.load for half in halves])
    u = np.zeros_like(load)
    correct = _newton(matrix, closing) if way == "newton" else _pcg(halves, matrix, traces, weights, closing)

    def residual(u: Floats) -> Floats:
        return load - matrix @ u - closing.T @ (weights * pressure(d - closing @ u))

    now, scale, steps = residual(u), np.linalg.norm(load), 0
    while np.linalg.norm(now) > TOLERANCE * scale:
        steps += 1
        if steps > MOST:
            raise RuntimeError(f"no convergence in {MOST} steps")
        correction = correct(weights * stiffness(d - closing @ u), now)
        u, now = advance(u, correction, now, residual)
    finer = [half.trace(9)[2] for half in halves]
    values = gap(grid.points[0]) - START - sp.hstack(finer, format="csr") @ u
    return Answer(pressure(values), len(u), steps)


def _newton(matrix, closing):
    def correct(tangent: Floats, residual: Floats) -> Floats:
        return _factor(matrix + closing.T @ sp.diags(tangent) @ closing).solve(residual)

    return correct


def _pcg(halves, matrix, traces, weights, closing):
    typical = float(stiffness(np.array(-START)))
    factors = [
        _factor(half.matrix + typical * trace.T @ sp.diags(weights) @ trace)
        for half, trace in zip(halves, traces, strict=True)
    ]
    ends = [halves[0].matrix.shape[0]]

    def precondition(vector: Floats) -> Floats:
        return np.concatenate([f.solve(part) for f, part in zip(factors, np.split(vector, ends), strict=True)])

    inverse = LinearOperator(matrix.shape, precondition)

    def correct(tangent: Floats, residual: Floats) -> Floats:
        operator = LinearOperator(matrix.shape, lambda v: matrix @ v + closing.T @ (tangent * (closing @ v)))
        return cg(operator, residual, rtol=1e-4, maxiter=200, M=inverse)[0]

    return correct


def _factor(matrix):
    return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
