"""Nested dissection: the order in which a solid's inside is eliminated, and its condensation along that order."""

from __future__ import annotations

import numpy as np
import pytest

import contactdd as cd
from contactdd.local import condensed
from contactdd.local.affine import AffineCells, cell_nodes
from contactdd.local.condensation import ElementCondensation, SparseCondensation
from contactdd.local.condensed import condense
from contactdd.local.discrete import DiscreteBody
from contactdd.local.dissection import Dissection
from contactdd.local.multifrontal import MultifrontalCondensation, stiffness_of_rows
from contactdd.local.stiffness import SelectedStiffness

#: Rounding: sums of some thousand terms, with the condition of a body of a few hundred unknowns.
ROUNDING = 1e-12


def block(shape: str = "hexahedron", degree: int = 1, cells: int = 6, turned: bool = False) -> DiscreteBody:
    """A block that cannot move; turned: by an eighth of a turn about the z axis."""
    mesh = cd.box((0, 0, 0), (1, 1, 0.5), (cells, cells, cells // 2), shape=shape)
    if turned:
        x = mesh.domain.geometry.x
        x[:, :2] = x[:, :2] @ (np.array([[1, 1], [-1, 1]]) / np.sqrt(2))
    held = [cd.Symmetry("left", "front"), cd.Fixed("bottom")]
    return DiscreteBody(cd.Body("block", mesh, cd.Isotropic(E=2e5, nu=0.3), supports=held, degree=degree))


def on_top(dofs: DiscreteBody) -> np.ndarray:
    """The unknowns on the top."""
    high = dofs.body.space.tabulate_dof_coordinates()[dofs.space.nodes(3), 2]
    return np.flatnonzero(high > 0.5 - 1e-9)


def along_dissection(dofs: DiscreteBody, kept: np.ndarray) -> tuple[Dissection, MultifrontalCondensation]:
    middles = cell_nodes(dofs.body.mesh).mean(axis=1)
    dissection = Dissection.of(dofs.body.space.dofmap.list, middles, dofs.space.nodes(3), kept)
    own = stiffness_of_rows(dofs.stiffness.reduced, np.arange(dofs.space.size), dissection)
    return dissection, MultifrontalCondensation(dissection, len(kept), own)


def assert_same(found: object, expected: object, size: int) -> None:
    """The same Schur complement, condensed loads and displacements."""
    forces, given = np.random.default_rng(1).standard_normal(size), np.ones(len(expected.schur_complement))
    for one, other in (
        (found.schur_complement, expected.schur_complement),
        (found.condense_load(forces)[0], expected.condense_load(forces)[0]),
        (found.condense_load(forces)[1], expected.condense_load(forces)[1]),
        (found.recover(given, forces), expected.recover(given, forces)),
    ):
        assert np.abs(one - other).max() <= ROUNDING * np.abs(other).max()


@pytest.mark.parametrize(("shape", "degree"), [("hexahedron", 1), ("tetrahedron", 1), ("tetrahedron", 2)])
def test_condensation_is_that_of_mumps(shape, degree):
    dofs = block(shape, degree)
    kept = on_top(dofs)
    assert_same(along_dissection(dofs, kept)[1], SparseCondensation(dofs.stiffness.reduced, kept), dofs.space.size)


def test_every_unknown_is_eliminated_once_after_what_it_depends_on():
    dofs = block()
    kept = on_top(dofs)
    dissection, _ = along_dissection(dofs, kept)
    assert np.array_equal(np.sort(dissection.order), np.arange(dofs.space.size))
    assert np.array_equal(dissection.order[-len(kept) :], kept)
    ends = [part.first for part in dissection.parts] + [dissection.parts[-1].last]
    assert (ends[0], ends[-1]) == (0, dofs.space.size - len(kept))
    for part, end in zip(dissection.parts, ends[1:], strict=True):
        assert part.last == end
        assert np.all(part.boundary >= part.last)


def operations(cells: int) -> tuple[int, float]:
    """The unknowns of a cube, and the multiplications in which all but one of them are eliminated."""
    body = cd.Body("cube", cd.box((0, 0, 0), (1, 1, 1), (cells,) * 3, shape="hexahedron"), cd.Isotropic(E=1, nu=0.3))
    nodes = np.arange(body.dofs) // 3
    parts = Dissection.of(body.space.dofmap.list, cell_nodes(body.mesh).mean(axis=1), nodes, np.array([0])).parts
    inner = np.array([part.last - part.first for part in parts], dtype=float)
    outer = np.array([len(part.boundary) for part in parts], dtype=float)
    return body.dofs, float(np.sum(inner**3 / 3 + inner**2 * outer + inner * outer**2))


def test_the_operations_grow_with_the_square_of_the_unknowns():
    """As George's nested dissection of a cube; a band matrix would take the power 7/3. 2.1: the ends of the cubes."""
    (n, few), (m, many) = operations(8), operations(16)
    assert np.log(many / few) / np.log(m / n) < 2.1


def test_tilted_supports():
    """Supports that mix degrees of freedom, and nothing touched but one node's unknowns."""
    dofs = block(turned=True)
    assert dofs.space.free is None
    kept = on_top(dofs)[:2]
    assert_same(along_dissection(dofs, kept)[1], SparseCondensation(dofs.stiffness.reduced, kept), dofs.space.size)


def test_cells_of_high_degree_are_dissected_after_their_insides(monkeypatch):
    dofs = block(degree=3, cells=4)
    kept = on_top(dofs)
    monkeypatch.setattr(ElementCondensation, "DISSECTED", 0)
    monkeypatch.setattr(ElementCondensation, "SMALL", 0)
    cellwise = ElementCondensation(AffineCells(dofs.body), dofs.space, kept)
    assert isinstance(cellwise._rest, MultifrontalCondensation)
    assert_same(cellwise, SparseCondensation(dofs.stiffness.reduced, kept), dofs.space.size)


def test_large_solids_are_dissected_and_a_matrix_that_is_not_definite_is_noticed(monkeypatch):
    dofs = block()
    kept = on_top(dofs)
    monkeypatch.setattr(condensed, "DISSECTED", 100)
    assert isinstance(condense(dofs, kept), MultifrontalCondensation)
    dofs.stiffness.full.data *= -1
    with pytest.raises(np.linalg.LinAlgError, match="not positive definite"):
        condense(dofs, kept)


@pytest.mark.parametrize("turned", [False, True])
def test_multigrid_applies_the_same_stiffness(turned):
    """In the blocks of all degrees of freedom, where supports only select; one vector and several."""
    dofs = block(turned=turned)
    y = np.random.default_rng(2).standard_normal((dofs.space.size, 3))
    operator, matrix = dofs.stiffness.operator, block(turned=turned).stiffness.reduced
    for given in (y, y[:, 0]):
        assert np.abs(operator @ given - matrix @ given).max() <= 1e-13 * np.abs(matrix @ given).max()
    whole = operator.matrix if isinstance(operator, SelectedStiffness) else operator
    assert np.abs(whole - matrix).max() == 0
    assert dofs.stiffness.largest == matrix.diagonal().max()
