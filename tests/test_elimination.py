"""The stiffness of affine cells against UFL's, and the elimination cell by cell against that of the whole matrix."""

from __future__ import annotations

import numpy as np
import pytest

import contactdd as cd
from contactdd.local.affine import AffineCells, are_affine
from contactdd.local.condensation import (
    DenseCondensation,
    ElementCondensation,
    MirroredCondensation,
    SparseCondensation,
)
from contactdd.local.copies import signs_between
from contactdd.local.discrete import DiscreteBody
from contactdd.local.forms import stiffness_matrix

#: Two ways to the same numbers differ by the rounding of sums over some hundred terms.
ROUNDING = 1e-12
WOOD = cd.Orthotropic(E1=11e3, E2=0.9e3, E3=0.5e3, nu12=0.4, nu13=0.45, nu23=0.5, G12=0.7e3, G13=0.6e3, G23=0.06e3)
SHEAR = np.array([[1.0, 0.3, 0.1], [-0.2, 1.1, 0.2], [0.0, 0.15, 0.9]])


def mesh(shape: str) -> cd.Mesh:
    if shape in ("triangle", "quadrilateral"):
        return cd.rectangle((0, 0), (2, 1), ([0.0, 0.3, 1.1, 2.0], [0.0, 0.4, 1.0]), shape=shape)
    return cd.box((0, 0, 0), (2, 1, 1), ([0.0, 0.7, 2.0], 1, [0.0, 0.4, 1.0]), shape=shape)


def sheared(shape: str) -> cd.Mesh:
    """Parallelograms and parallelepipeds; the surfaces are those of the straight mesh."""
    straight = mesh(shape)
    x = straight.domain.geometry.x
    x[:, : straight.dim] = x[:, : straight.dim] @ SHEAR[: straight.dim, : straight.dim].T
    return cd.Mesh(straight.domain, straight.surfaces)


@pytest.mark.parametrize(
    ("shape", "degree", "kinematics"),
    [
        ("triangle", 1, "plane strain"),
        ("triangle", 3, "plane stress"),
        ("triangle", 5, "plane strain"),
        ("quadrilateral", 2, "plane stress"),
        ("quadrilateral", 4, "plane strain"),
        ("tetrahedron", 2, "solid"),
        ("tetrahedron", 4, "solid"),
        ("hexahedron", 1, "solid"),
        ("hexahedron", 3, "solid"),
    ],
)
@pytest.mark.parametrize("make", [mesh, sheared])
def test_cell_matrices_are_those_of_the_form(shape, degree, kinematics, make):
    body = cd.Body("body", make(shape), WOOD.rotated(0.4), degree=degree, kinematics=kinematics)
    assert are_affine(body.mesh)
    cells = AffineCells(body)
    nodes = np.arange(cells.nodes.shape[1])
    expected = stiffness_matrix(body).toarray()
    found = np.zeros_like(expected)
    for matrix, dofs in zip(cells.block(cells.integrals.full), cells.dofs(nodes), strict=True):
        found[np.ix_(dofs, dofs)] += matrix
    assert np.abs(found - expected).max() < ROUNDING * np.abs(expected).max()
    u = np.random.default_rng(0).normal(size=len(expected))
    forces = expected @ u
    assert np.abs(cells.forces(u) - forces).max() < ROUNDING * np.abs(forces).max()


def test_which_cells_are_affine():
    bent = mesh("quadrilateral")
    x = bent.domain.geometry.x
    x[:, 0] += 0.1 * x[:, 0] * x[:, 1]
    assert not are_affine(bent)
    assert are_affine(cd.rectangle((1e3, 1e3), (1e3 + 1, 1e3 + 1), (7, 3), shape="quadrilateral"))


def problem(shape: str, degree: int, lower: tuple[float, ...], supports: list[object]) -> DiscreteBody:
    """A block under another, its contact on top, pressed from the side and from inside."""
    dim = len(lower)
    middle, upper = np.add(lower, 1.0), np.add(lower, 1.0)
    middle[-1], upper[-1] = lower[-1] + 1.0, lower[-1] + 2.0
    base = np.array([*lower[:-1], middle[-1]])
    make = cd.rectangle if dim == 2 else cd.box
    counts = (2, 2) if dim == 2 else (2, 1, 2)
    meshes = [make(lower, middle, counts, shape=shape), make(base, upper, counts, shape=shape)]
    loads = [cd.Pressure("right", 3.0), cd.BodyForce([0.5] * dim)]
    steel = cd.Isotropic(2e5, 0.3)
    bodies = [
        cd.Body(name, mesh, steel, degree=degree, loads=loads, supports=supports)
        for name, mesh in zip(("lower", "upper"), meshes, strict=True)
    ]
    scene = cd.Scene(bodies, [cd.Contact((bodies[0], "top"), (bodies[1], "bottom"), cd.LinearLayer(1e5))])
    return scene.local_problems("assembled")[0].dofs


def kept_unknowns(inner: DiscreteBody) -> np.ndarray:
    nodes = inner.body.elements.nodes("top")
    dim = inner.body.mesh.dim
    return inner.space.unknowns_at(nodes * dim + dim - 1)


CASES = [("triangle", 3, 2), ("triangle", 4, 2), ("quadrilateral", 3, 2), ("tetrahedron", 4, 3), ("hexahedron", 3, 3)]


@pytest.mark.parametrize("floating", [False, True])
@pytest.mark.parametrize(("shape", "degree", "dim"), CASES)
def test_cellwise_is_the_same_as_whole(shape, degree, dim, floating, monkeypatch):
    walls = cd.Symmetry("left") if dim == 2 else cd.Symmetry("left", "front")
    supports = [walls] if floating else [cd.Fixed("bottom")]
    inner = problem(shape, degree, (0.0,) * dim, supports)
    kept = kept_unknowns(inner)
    monkeypatch.setattr(
        AffineCells, "ENTRIES", 2 * inner.body.space.element.space_dimension**2
    )  # a few cells at a time
    whole = SparseCondensation(inner.stiffness.reduced, kept)
    cellwise = ElementCondensation(AffineCells(inner.body), inner.space, kept)
    scale = np.abs(whole.schur_complement).max()
    assert np.abs(cellwise.schur_complement - whole.schur_complement).max() < 1e-11 * scale
    (on_kept, work), (expected, expected_work) = (
        cellwise.condense_load(inner.free_load),
        whole.condense_load(inner.free_load),
    )
    assert on_kept == pytest.approx(expected, abs=1e-11 * np.abs(inner.free_load).sum())
    assert work == pytest.approx(expected_work, rel=1e-10)
    values = np.random.default_rng(1).normal(size=len(kept))
    y = whole.recover(values, 1e3 * inner.free_load)
    assert cellwise.recover(values, 1e3 * inner.free_load) == pytest.approx(y, abs=1e-10 * np.abs(y).max())
    # The others are in equilibrium: what is left of the forces there is the rounding of the stiffness.
    others = np.setdiff1d(np.arange(inner.space.size), kept)
    left = (1e3 * inner.free_load - inner.stiffness.reduced @ y)[others]
    assert np.abs(left).max() < 1e-12 * np.abs(inner.stiffness.reduced).max() * np.abs(y).max() * inner.space.size


@pytest.mark.parametrize("kept", [0, 2, 5])
def test_a_dense_elimination_of_some_all_or_none(kept):
    root = np.random.default_rng(2).normal(size=(5, 5))
    matrix, forces = root @ root.T + np.eye(5), np.arange(5.0)
    inner, values = 5 - kept, np.ones(kept)
    dense = DenseCondensation(matrix, kept)
    response = np.linalg.solve(matrix[:inner, :inner], np.column_stack([matrix[:inner, inner:], forces[:inner]]))
    assert dense.schur_complement == pytest.approx(matrix[inner:, inner:] - matrix[inner:, :inner] @ response[:, :-1])
    on_kept, work = dense.condense_load(forces)
    assert on_kept == pytest.approx(forces[inner:] - matrix[inner:, :inner] @ response[:, -1])
    assert work == pytest.approx(forces[:inner] @ response[:, -1])
    expected = np.concatenate([response[:, -1] - response[:, :-1] @ values, values])
    assert dense.recover(values, forces) == pytest.approx(expected)


@pytest.mark.parametrize(("shape", "degree", "dim"), CASES)
def test_a_moved_copy_is_an_image(shape, degree, dim):
    walls = cd.Symmetry("left") if dim == 2 else cd.Symmetry("left", "front")
    inner, moved = (problem(shape, degree, (x,) * dim, [walls]) for x in (0.0, 7.3))
    kept, space = kept_unknowns(inner), inner.space
    signs = signs_between(inner.body, moved.body)
    original = ElementCondensation(AffineCells(inner.body), space, kept)
    image = MirroredCondensation(original, inner.mirrored(signs), kept)
    own = ElementCondensation(AffineCells(moved.body), space, kept)
    assert np.abs(image.schur_complement - own.schur_complement).max() < 1e-10 * np.abs(own.schur_complement).max()


def test_another_body_is_no_image():
    inner = problem("quadrilateral", 3, (0.0, 0.0), [cd.Symmetry("left")])
    wider = cd.rectangle((0, 0), (1 + 1e-9, 1), (2, 2), shape="quadrilateral")
    supports = inner.body.supports
    for body in (
        cd.Body("softer", inner.body.mesh, cd.Isotropic(1e5, 0.3), degree=3, supports=supports),
        cd.Body("wider", wider, inner.body.material, degree=3, supports=supports),
    ):
        assert signs_between(inner.body, body) is None
    same = cd.Body("same", inner.body.mesh, inner.body.material, degree=3, supports=supports)
    assert signs_between(inner.body, same).tolist() == [1.0, 1.0]


@pytest.mark.parametrize("method", ["auto", "chord"])
def test_condensed_cellwise_is_assembled(method):
    """The same contact pressure whether the inside is eliminated cell by cell or the Robin term assembled from UFL."""
    inner = problem("quadrilateral", 4, (0.0, 0.0), [cd.Symmetry("left"), cd.Fixed("bottom")])
    lower = inner.body
    upper = cd.Body(
        "upper",
        cd.rectangle((0, 1), (1, 2), (2, 2), shape="quadrilateral"),
        lower.material,
        degree=4,
        supports=[cd.Symmetry("left")],
        loads=[cd.Pressure("top", 5.0)],
    )
    layer = cd.PowerLayer(B=1e-5, a=1.5)
    scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), layer)])
    runs = [cd.solve(scene, method, local_solver=solver, tolerance=1e-10) for solver in ("condensed", "assembled")]
    pressures = [run.contact().pressure for run in runs]
    assert runs[0].iterations == runs[1].iterations
    assert pressures[0] == pytest.approx(pressures[1], abs=1e-8 * pressures[1].max())
    assert runs[0].residual < 1e-9
