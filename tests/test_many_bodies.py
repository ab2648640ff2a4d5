"""Many bodies: their rigid motions are sparse, and say what the dense ones of few bodies say."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import scipy

import contactdd as cd
from contactdd.base.null_space import null_space
from contactdd.errors import LooseBodyError
from contactdd.local.condensation import SmallCondensation, SparseCondensation
from contactdd.local.discrete import DiscreteBody
from contactdd.local.rigid import RigidMotions
from contactdd.system import joint_motions
from contactdd.system.ensemble import Ensemble
from contactdd.system.equilibrium import unbounded_motion
from contactdd.system.joint_motions import ManyMotions

STEEL = cd.Isotropic(2.1e5, 0.3)
LAYER = cd.PowerLayer(B=4e-6, a=1.1)
FLOOR = [cd.Fixed("bottom")]
ROLLERS = [cd.Symmetry("left", "right")]


def stack(supports: list[list[object]], loads: dict[int, object] | None = None, layer: object = LAYER) -> cd.Scene:
    """Blocks on each other, of which each is held as `supports` say."""
    loads = {len(supports) - 1: cd.Pressure("top", 10.0)} if loads is None else loads
    bodies = [
        cd.Body(
            f"block {place}",
            cd.rectangle((0, place), (2, place + 1), (2 + place % 2, 1)),
            cd.Isotropic(2.1e5 * (1 + place % 3), 0.3),
            supports=held,
            loads=[loads[place]] if place in loads else [],
        )
        for place, held in enumerate(supports)
    ]
    return cd.Scene(bodies, [cd.Contact((a, "top"), (b, "bottom"), layer) for a, b in pairwise(bodies)])


def both(scene: cd.Scene, monkeypatch: pytest.MonkeyPatch) -> tuple[Ensemble, RigidMotions, Ensemble, ManyMotions]:
    """The bodies with their motions in dense and in sparse algebra."""
    few, many = (Ensemble(scene.local_problems("condensed"), scene.interfaces) for _ in range(2))
    dense = few.rigid
    monkeypatch.setattr(joint_motions, "LARGEST_DENSE", 0)
    sparse = many.rigid
    assert isinstance(dense, RigidMotions)
    assert isinstance(sparse, ManyMotions)
    return few, dense, many, sparse


SUPPORTS = {
    "held": [FLOOR, ROLLERS, [cd.Fixed("top")]],
    "one floats": [FLOOR, ROLLERS, ROLLERS],
    "all float": [ROLLERS, ROLLERS, ROLLERS],
    "some may slide": [FLOOR, [], []],
    "nothing holds": [[], [], []],
    "a spring": [[*ROLLERS, cd.Spring("bottom", 10.0)], ROLLERS, []],
    "a soft spring": [[*ROLLERS, cd.Spring("bottom", 1e-4)], ROLLERS, []],
}


def same_span(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether the columns of two matrices span the same space, to 1e-7: the root of the rounding of a stiffness."""
    if one.shape != other.shape:
        return False
    first, second = np.linalg.qr(one)[0], np.linalg.qr(other)[0]
    return bool(np.abs(first - second @ (second.T @ first)).max(initial=0.0) < 1e-7)


@pytest.mark.parametrize("supports", SUPPORTS)
def test_free_motions_are_those_of_dense_algebra(supports, monkeypatch):
    few, dense, many, sparse = both(stack(SUPPORTS[supports]), monkeypatch)
    random = np.random.default_rng(3)
    assert sparse.count == dense.count
    assert same_span(dense.displacements(dense.unresisted), sparse.displacements(sparse.unresisted.toarray()))
    for closed in ((1, 1), (1, 0), (0, 1), (0, 0)):
        phi = {
            i: c * 1e5 * random.random(len(f.weights))
            for i, (c, f) in enumerate(zip(closed, few.interfaces, strict=True))
        }
        free = sparse.free_displacements(phi)
        assert same_span(dense.free_displacements(phi), free)
        fixed = sparse.fixing_dofs(phi, np.zeros(few.size), 1.0)
        assert len(fixed) == free.shape[1]
        system = many.tangent(phi, np.eye(few.size))
        system[fixed, fixed] += sparse.stiffness_scale
        assert np.linalg.eigvalsh(system)[0] > 0.0
        assert np.all(sparse.unsprung == dense.unsprung)
        if free.shape[1]:
            motion = free[:, 0]
            with pytest.raises(LooseBodyError) as told:
                sparse.fixing_dofs(phi, motion, 1.0)
            moved = [np.linalg.norm(part) for part in many.split(free @ (free.T @ motion))]
            assert told.value.body == f"block {int(np.argmax(moved))}"


@pytest.mark.parametrize("supports", SUPPORTS)
def test_rows_springs_and_least_squares_are_those_of_dense_algebra(supports, monkeypatch):
    few, dense, _, sparse = both(stack(SUPPORTS[supports]), monkeypatch)
    assert sparse.rows.toarray() == pytest.approx(dense.rows, abs=1e-14)
    assert same_span(dense.unbounded, sparse.unbounded.toarray())
    random = np.random.default_rng(5)
    stiffness, wanted = random.random(len(few.weights)), random.random(len(few.weights))
    # What the rows leave open may differ; what they see is the same up to the regular part, 1e-12, refined.
    approach = dense.rows @ dense.closest(stiffness, wanted)
    assert sparse.rows @ sparse.closest(stiffness, wanted) == pytest.approx(approach, abs=1e-9)


def test_null_space_of_groups():
    """A random matrix in groups with a null space put into it: found, and nothing else."""
    random = np.random.default_rng(1)
    sizes = [3, 0, 1, 6, 2, 3, 3]
    ends = np.cumsum([0, *sizes])
    wanted = np.linalg.qr(random.standard_normal((ends[-1], 4)))[0]
    rows = []
    for one, other in ((0, 3), (3, 2), (2, 4), (4, 5), (5, 6), (6, 0), (3, 5), (1, 2)):
        columns = np.r_[ends[one] : ends[one + 1], ends[other] : ends[other + 1]]
        block = random.standard_normal((9, len(columns)))
        seen = np.linalg.qr(wanted[columns])[0]
        block -= block @ seen @ seen.T
        rows.append({one: block[:, : sizes[one]], other: block[:, sizes[one] :]})
    matrix = np.zeros((9 * len(rows), ends[-1]))
    for at, block in enumerate(rows):
        for group, part in block.items():
            matrix[9 * at : 9 * at + 9, ends[group] : ends[group + 1]] = part
    found = null_space(rows, sizes, 1e-10)
    dense = scipy.linalg.null_space(matrix, rcond=1e-10)
    assert dense.shape[1] >= 4
    assert same_span(dense, found.vectors.toarray())
    # Each vector moves something along the directions to be fixed, and together they leave nothing.
    held = [part.T @ found.vectors.toarray()[ends[group] : ends[group + 1]] for group, part in found.directions.items()]
    assert np.linalg.svd(np.vstack(held), compute_uv=False)[-1] > 1e-6


def test_a_tall_stack_is_as_short_as_its_parts_make_it():
    """104 blocks between rollers: one pressure everywhere, the height lost known in closed form."""
    count, q, nu = 104, 10.0, 0.3
    solution = cd.solve(stack([[*FLOOR, *ROLLERS], *[ROLLERS] * (count - 1)]))
    assert isinstance(solution._ensemble.rigid, ManyMotions)
    assert solution.iterations <= 3
    moduli = 2.1e5 * (1 + np.arange(count) % 3) * (1 - nu) / ((1 + nu) * (1 - 2 * nu))  # of strain without others
    lost = q * np.sum(1 / moduli) + (count - 1) * 4e-6 * q**1.1
    (_, top), *_ = solution.displacement_at(f"block {count - 1}", [[1.0, count]])
    assert top == pytest.approx(-lost, rel=1e-9)  # 1e-10 of the forces
    for contact in range(count - 1):
        assert solution.contact(contact).pressure == pytest.approx(q, rel=1e-8)


def test_blocks_that_may_slide_are_solved_where_they_are():
    """Nothing holds forty blocks sideways: each lies where the smallest displacements leave it."""
    solution = cd.solve(stack([FLOOR, *[[]] * 40]))
    motions = solution._ensemble.rigid
    assert isinstance(motions, ManyMotions)
    assert motions.unresisted.shape[1] == 40
    assert motions.unresisted.nnz <= 3 * 40  # a block slides alone
    for place in range(1, 41):
        sideways = solution.displacement(f"block {place}").x.array[::2]
        assert abs(sideways.mean()) < 1e-9 * np.abs(sideways).max()  # symmetric about its middle line


def test_loads_in_balance_are_seen_from_contact_forces():
    """At a solution, forces like those of the contacts balance the loads; with none of them a programme finds out."""
    scene = stack([FLOOR, *[[]] * 40])
    solution = cd.solve(scene)
    ensemble = solution._ensemble
    tractions = ensemble.tractions(solution._state)
    assert unbounded_motion(ensemble, tractions) is None
    assert unbounded_motion(ensemble) is None
    half = ensemble.weights * np.where(np.arange(len(tractions)) % 2, 2.0, 0.5) * tractions.min()
    assert unbounded_motion(ensemble, half) is None


@pytest.mark.parametrize(
    ("load", "body", "motion"),
    [(cd.Traction("right", (1.0, 0.0)), "block 17", "x"), (cd.Traction("top", (0.0, 1.0)), "block 40", "y")],
)
def test_what_nothing_holds_is_named(load, body, motion):
    with pytest.raises(cd.NoEquilibriumError, match=f"{body}.*") as told:
        cd.solve(stack([FLOOR, *[[]] * 40], {int(body.split()[1]): load}))
    assert told.value.body == body
    assert motion in told.value.motion


def test_contacts_of_unlike_layers_keep_their_own():
    """Layers that alternate, softer and stiffer: each is compressed by its own law under the same pressure."""
    scene = stack([[*FLOOR, *ROLLERS], *[ROLLERS] * 5])
    soft, stiff = cd.LinearLayer(1e4), cd.PowerLayer(B=1e-6, a=0.8)
    for place in range(5):
        scene = scene.with_layer((soft, stiff)[place // 2 % 2], f"block {place}–block {place + 1}")
    solution = cd.solve(scene)
    assert len(solution._ensemble.laws) == 3
    for place in range(5):
        wanted = (10.0 / 1e4, 1e-6 * 10.0**0.8)[place // 2 % 2]
        assert -solution.contact(place).gap == pytest.approx(wanted, rel=1e-8)


@pytest.mark.parametrize("cells", [(3, 2), (3, 2, 2)])
def test_a_small_body_is_condensed_alike_by_lapack_and_by_mumps(cells):
    make = cd.rectangle if len(cells) == 2 else cd.box
    mesh = make((0,) * len(cells), (1,) * len(cells), cells)
    discrete = DiscreteBody(cd.Body("body", mesh, STEEL, supports=[cd.Fixed("left")]))
    matrix, kept = discrete.stiffness.reduced, np.array([7, 3, 12, 4])
    forces, moved = np.random.default_rng(7).random((2, matrix.shape[0]))
    small, large = SmallCondensation(matrix, kept), SparseCondensation(matrix.copy(), kept)
    scale = matrix.diagonal().max()  # rounding of it, times a condition of some hundred
    assert small.schur_complement == pytest.approx(large.schur_complement, abs=1e-13 * scale)
    for one, other in zip(small.condense_load(forces), large.condense_load(forces), strict=True):
        assert one == pytest.approx(other, rel=1e-10)
    assert small.recover(moved[:4], forces) == pytest.approx(large.recover(moved[:4], forces), rel=1e-10)


def test_a_chain_of_bonded_blocks_hangs_and_does_not_where_one_is_loose(monkeypatch):
    """Bonds resist pulling: a load that lifts blocks is held by glue all the way down, and by no contact."""
    monkeypatch.setattr(joint_motions, "LARGEST_DENSE", 0)
    glue = cd.BondedLayer(cd.LinearLayer(1e5))
    pull = {5: cd.Traction("top", (0.0, 10.0))}
    scene = stack([[*FLOOR, *ROLLERS], *[ROLLERS] * 5], pull, glue)
    solution = cd.solve(scene)
    assert isinstance(solution._ensemble.rigid, ManyMotions)
    assert unbounded_motion(solution._ensemble, solution._ensemble.tractions(solution._state)) is None
    assert unbounded_motion(solution._ensemble) is None
    for contact in range(5):
        assert solution.contact(contact).pressure == pytest.approx(-10.0, rel=1e-8)
    with pytest.raises(cd.NoEquilibriumError) as told:
        cd.solve(stack([[*FLOOR, *ROLLERS], *[ROLLERS] * 5], pull, glue).with_layer(LAYER, "block 2–block 3"))
    assert told.value.body in ("block 3", "block 4", "block 5")
