"""The pressure of a contact as continuous polynomials, nowhere negative and in equilibrium with the loads."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from ..base.arrays import Floats, Indices
from ..body import Body
from ..interface.discretise import Interface
from ..local.forms import load_vectors


class SurfacePressure:
    """A pressure on a contact: continuous, a polynomial on every facet, nowhere negative.

    It is p = Σ b_i β_i with Bernstein's polynomials β, which are nowhere negative, and b_i ≥ 0: a given pressure at the
    points of an interface with facets that match, projected. coefficients: b (functions,); points: (n, 2), weights,
    facets: (n,), values: (n, functions) β there.
    """

    def __init__(self, index: int, interface: Interface, pressure: Floats, degree: int) -> None:
        self.index, self.interface, self.degree, self.contact = index, interface, degree, interface.contact
        self.ends = interface.sides[0].meshed.corners  # (facets, 2, 2)
        self.points, self.weights, self.normal = interface.x, interface.weights, interface.normal
        self._functions = _numbered(self.ends, degree)
        self.facets = np.repeat(np.arange(len(self.ends)), len(self.points) // len(self.ends))
        self.values = self.at_facets(self.facets, self.points)
        mass = (self.values.T @ scipy.sparse.diags(self.weights) @ self.values).tocsc()
        projected = scipy.sparse.linalg.spsolve(mass, self.values.T @ (self.weights * pressure))
        self.coefficients: Floats = np.maximum(projected, 0.0)

    def at_facets(self, facets: Indices, x: Floats) -> scipy.sparse.csr_matrix:
        """β (n, functions) at points x (n, 2), each on (or opposite) a facet of the first surface."""
        start, along = self.ends[facets, 0], self.ends[facets, 1] - self.ends[facets, 0]
        s = np.clip(np.sum((x - start) * along, axis=1) / np.sum(along**2, axis=1), 0.0, 1.0)
        k = np.arange(self.degree + 1)
        bernstein = scipy.special.binom(self.degree, k) * s[:, None] ** k * (1 - s[:, None]) ** (self.degree - k)
        rows = np.repeat(np.arange(len(x)), self.degree + 1)
        entries = (bernstein.ravel(), (rows, self._functions[facets].ravel()))
        return scipy.sparse.csr_matrix(entries, shape=(len(x), int(self._functions.max()) + 1))

    def at(self, x: Floats) -> Floats:
        """p at points x (n, 2) of either surface."""
        middle, along = self.ends.mean(axis=1), self.ends[:, 1] - self.ends[:, 0]
        away = np.abs(np.einsum("nfd,fd->nf", x[:, None] - middle[None], along)) / np.sum(along**2, axis=1)
        apart = np.linalg.norm(x[:, None] - middle[None], axis=2)
        nearest = np.argmin(np.where(away <= 0.5 + 1e-8, apart, np.inf), axis=1)
        found: Floats = self.at_facets(nearest, x) @ self.coefficients
        return found

    def work(self, second: bool, motions: Floats) -> Floats:
        """−∫ β_i v·n, (functions, motions), of motions v at the points, (n, 2, motions), n out of either body."""
        normal = -self.normal if second else self.normal
        v_n = np.einsum("ndm,nd->nm", motions, normal)
        done: Floats = -(self.values.T @ (self.weights[:, None] * v_n))
        return done


def _numbered(ends: Floats, degree: int) -> Indices:
    """The functions (facets, degree + 1) of every facet, numbered so that facets share those of their common ends."""
    size = np.abs(ends[:, 1] - ends[:, 0]).max()
    _, corner = np.unique(np.round(ends.reshape(-1, 2) / (1e-7 * size)), axis=0, return_inverse=True)
    corner = corner.reshape(-1, 2)
    inner = corner.max() + 1 + np.arange(len(ends) * (degree - 1)).reshape(len(ends), -1)
    return np.column_stack([corner[:, 0], inner, corner[:, 1]])


def balance(bodies: Sequence[Body], pressures: Sequence[SurfacePressure]) -> None:
    """Change pressures by the least part of themselves so that no body is moved rigidly.

    b_i becomes b_i (1 + Σ R_ij λ_j), with the work R of β_i on the motions j of all bodies: it stays positive.
    """
    rows: list[list[Floats]] = [[] for _ in pressures]
    missing: list[Floats] = []
    for body in bodies:
        free = _free_motions(body)
        lacking = _rigid_work(body) @ free
        for place, pressure in enumerate(pressures):
            sides = [side for side, _ in pressure.contact.sides]
            work: Floats = np.zeros((len(pressure.coefficients), free.shape[1]))
            for second, side in enumerate(sides):
                if side.name == body.name:
                    work = work + pressure.work(bool(second), _motions(body, pressure.points) @ free)
            rows[place].append(work)
            lacking = lacking + pressure.coefficients @ work
        missing.append(lacking)
    of = np.concatenate([np.concatenate(each, axis=1) for each in rows])
    b = np.concatenate([pressure.coefficients for pressure in pressures])
    wanted = -np.concatenate(missing)
    multipliers = np.linalg.lstsq(of.T @ (b[:, None] * of), wanted, rcond=1e-12)[0]
    changed = b * (1 + of @ multipliers)
    left, size = changed @ of - b @ of - wanted, np.abs(b @ np.abs(of)).max(initial=0.0)
    if np.abs(left).max(initial=0.0) > 1e-9 * size or changed.min(initial=0.0) < 0.0:
        raise ValueError(
            "solution: its contact pressures are too far from equilibrium with the loads; expected one that converged"
        )
    ends = np.cumsum([len(pressure.coefficients) for pressure in pressures])[:-1]
    for pressure, part in zip(pressures, np.split(changed, ends), strict=True):
        pressure.coefficients = part


def _motions(body: Body, x: Floats) -> Floats:
    """The rigid motions of the plane at points x (n, 2), (n, 2, 3), about the middle of the body."""
    centre = body.mesh.domain.geometry.x[:, :2].mean(axis=0)
    arms = (x - centre) / body.mesh.size
    modes = np.zeros((len(x), 2, 3))
    modes[:, 0, 0] = modes[:, 1, 1] = 1.0
    modes[:, 0, 2], modes[:, 1, 2] = -arms[:, 1], arms[:, 0]
    return modes


def _free_motions(body: Body) -> Floats:
    """The rigid motions that the supports leave, (3, free)."""
    held: list[Floats] = [np.zeros((0, 3))]
    x = body.space.tabulate_dof_coordinates()[:, :2]
    for support in body.supports:
        held += [np.einsum("ndm,d->nm", _motions(body, x[n]), axis) for n, axis, _ in support.conditions(body.elements)]
    return scipy.linalg.null_space(np.concatenate(held), rcond=1e-8)


def _rigid_work(body: Body) -> Floats:
    """The work (3,) of the loads on the rigid motions."""
    load, x = load_vectors(body)[0].reshape(-1, 2), body.space.tabulate_dof_coordinates()[:, :2]
    return np.einsum("nd,ndm->m", load, _motions(body, x))
