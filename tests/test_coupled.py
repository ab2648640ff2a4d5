"""The coupled linear system: its ways of assembly agree, its free motions are its null space."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import contactdd as cd
from contactdd.base.sparse import product_map
from contactdd.errors import LooseBodyError
from contactdd.iteration import coupled
from contactdd.iteration.coupled import CoupledSystem
from contactdd.iteration.line_search import minimise_along
from contactdd.local.rigid import select_fixing_dofs
from contactdd.system import ensemble as ensembles
from contactdd.system.ensemble import Ensemble

STEEL = cd.Isotropic(2.1e5, 0.3)


def stack(lower: list, upper: list) -> cd.Scene:
    """Two blocks with the given supports, one on the other."""
    meshes = cd.rectangle((0, 0), (3, 1), (4, 2)), cd.rectangle((0, 1), (3, 2), (4, 2), diagonal="left")
    bodies = [
        cd.Body(name, mesh, STEEL, supports=supports)
        for name, mesh, supports in zip(("lower", "upper"), meshes, (lower, upper), strict=True)
    ]
    return cd.Scene(bodies, [cd.Contact((bodies[0], "top"), (bodies[1], "bottom"), cd.LinearLayer(1e5))])


def together(scene: cd.Scene, local_solver: str = "condensed") -> Ensemble:
    return Ensemble(scene.local_problems(local_solver), scene.interfaces)


def matrix(ensemble: Ensemble, phi: dict) -> np.ndarray:
    return ensemble.tangent(phi, np.eye(ensemble.size))


@pytest.mark.parametrize("way", ["full product", "sparse product", "sparse factor", "all unknowns"])
def test_ways_of_assembly(way, monkeypatch):
    """The correction solves the system that `tangent` multiplies with, however the contact's term is found."""
    if way == "sparse product":
        monkeypatch.setattr(ensembles, "LARGEST_PRODUCT", 0)
        monkeypatch.setattr(ensembles, "PRODUCTS_PER_ENTRY", 0)
    if way == "sparse factor":
        monkeypatch.setattr(ensembles, "LARGEST_DENSE", 0)
    scene = stack([cd.Fixed("bottom")], [cd.Symmetry("left")])
    ensemble = together(scene, "assembled" if way == "all unknowns" else "condensed")
    system = CoupledSystem(ensemble)
    assert isinstance(ensemble.normal_approach, np.ndarray) == (way == "full product")
    random = np.random.default_rng(1)
    phi = {0: 1e5 * random.random(len(scene.interfaces[0].weights))}
    residual = random.random(ensemble.size)
    for _ in range(2):  # nothing of the first φ is left in the second
        found = system.correct(phi, residual, 1.0)
        assert ensemble.tangent(phi, found) == pytest.approx(residual, abs=1e-9)
        phi = {0: phi[0][::-1]}


def solids(degree: int, cells: int) -> cd.Scene:
    """Two cubes with faces inclined to the axes, where a normal displacement has all components of all nodes."""
    turn = np.linalg.qr(np.array([[3.0, 1.0, 1.0], [-1.0, 3.0, 1.0], [-1.0, -1.0, 3.0]]))[0]
    meshes = [cd.box((0, 0, z), (1, 1, z + 1), (cells, cells, 1), shape="hexahedron") for z in (0, 1)]
    for mesh in meshes:
        mesh.domain.geometry.x[:] = mesh.domain.geometry.x @ turn
    lower = cd.Body("lower", meshes[0], STEEL, supports=[cd.Fixed("bottom")], degree=degree)
    upper = cd.Body("upper", meshes[1], STEEL, supports=[cd.Fixed("top")], degree=degree)
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.LinearLayer(1e5))])


def plates(count: int) -> cd.Scene:
    """Plane bodies one on the other: many unknowns, four of them at each point."""
    meshes = [cd.rectangle((0, place), (4, place + 1), (10, 2)) for place in range(count)]
    bodies = [cd.Body(f"plate {place}", mesh, STEEL, supports=[cd.Fixed("left")]) for place, mesh in enumerate(meshes)]
    pairs = pairwise(bodies)
    return cd.Scene(bodies, [cd.Contact((a, "top"), (b, "bottom"), cd.LinearLayer(1e5)) for a, b in pairs])


@pytest.mark.parametrize(
    ("scene", "most"), [(lambda: plates(16), 10_000), (lambda: solids(4, 2), 0), (lambda: solids(3, 3), 0)]
)
def test_the_contacts_term_takes_no_more_than_it_should(scene, most, monkeypatch):
    """Its entries are looked for one by one where they are few, never where finding each costs more than products."""
    made = []

    def counted(*arguments):
        made.append(product_map(*arguments))
        return made[-1]

    monkeypatch.setattr(coupled, "product_map", counted)
    scene = scene()
    ensemble = together(scene)
    assert ensemble.dense
    assert ensemble.size**2 * len(ensemble.weights) > ensembles.LARGEST_PRODUCT
    phi = {i: np.full(len(face.weights), 1e5) for i, face in enumerate(scene.interfaces)}
    residual = np.random.default_rng(1).random(ensemble.size)
    found = CoupledSystem(ensemble).correct(phi, residual, 1.0)
    assert ensemble.tangent(phi, found) == pytest.approx(residual, abs=1e-9)  # rounding times a condition of some 1e4
    assert len(made) == (most > 0)
    assert sum(entries.nnz for _, entries in made) <= most


SUPPORTS = {
    "held": ([cd.Fixed("bottom")], [cd.Fixed("top")], 0, 0),
    "one floats": ([cd.Fixed("bottom")], [cd.Symmetry("left", "right")], 1, 0),
    "both float": ([cd.Symmetry("left")], [cd.Symmetry("left")], 2, 1),
    "one may slide": ([cd.Fixed("bottom")], [], 3, 1),
    "nothing holds": ([], [], 6, 4),
    "a spring": ([cd.Symmetry("left"), cd.Spring("bottom", 10.0)], [cd.Symmetry("left")], 1, 0),
    "a soft spring": ([cd.Symmetry("left"), cd.Spring("bottom", 1e-4)], [cd.Symmetry("left")], 1, 0),
}


@pytest.mark.parametrize("supports", SUPPORTS)
def test_free_motions_are_the_null_space(supports):
    lower, upper, open_, closed = SUPPORTS[supports]
    scene = stack(lower, upper)
    ensemble = together(scene)
    rigid, ones = ensemble.rigid, np.ones(len(scene.interfaces[0].weights))
    for phi, count in ((0.0 * ones, open_), (1e5 * ones, closed), (1e9 * ones, closed)):
        free = rigid.free({0: phi})
        assert free.shape[1] == count
        assert free.T @ free == pytest.approx(np.eye(count), abs=1e-12)
        assert np.abs(matrix(ensemble, {0: phi}) @ rigid.modes @ free).max(initial=0.0) <= 1e-10 * rigid.stiffness_scale
        ground = select_fixing_dofs(rigid.modes @ free)
        held = matrix(ensemble, {0: phi})
        held[ground, ground] += rigid.stiffness_scale
        assert np.linalg.eigvalsh(held)[0] > 0.0


def test_a_body_that_turns_about_the_only_closed_point():
    """A pressure on one point holds a body there, and not against turning: found though most motions are held."""
    scene = stack([cd.Fixed("bottom")], [])
    ensemble = together(scene)
    phi = np.zeros(len(scene.interfaces[0].weights))
    phi[3] = 1e5
    free = ensemble.rigid.free({0: phi})
    assert free.shape[1] == 2
    assert np.abs(ensemble.normal_approach[3] @ ensemble.rigid.modes @ free).max() < 1e-12
    forces = ensemble.rigid.modes @ free[:, 0]
    with pytest.raises(LooseBodyError, match="upper"):
        ensemble.rigid.fixing_dofs({0: phi}, forces, 1.0)


@pytest.mark.parametrize("zero", [1e-3, 0.3, 1.0, 5.0, 700.0])
def test_line_search_finds_the_zero_and_asks_once(zero):
    asked = []

    def slope(t: float) -> float:
        asked.append(t)
        return (t - zero) ** 3 + 0.1 * (t - zero)

    assert minimise_along(slope) == pytest.approx(zero, rel=2e-3)
    assert len(set(asked)) == len(asked)


def test_line_search_that_never_turns():
    assert minimise_along(lambda t: -1.0, largest=64.0) == 64.0
    assert minimise_along(lambda t: t) == 1.0
