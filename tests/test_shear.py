"""Bonds that resist sliding: uniform shear across them, in the plane, in space and around a ring, by every solver."""

from __future__ import annotations

import numpy as np
import pytest
from test_ranks import launch

import contactdd as cd

E, NU = 2.0e5, 0.25
G, STEEL = E / (2 * (1 + NU)), cd.Isotropic(E, NU)
NORMAL, SHEAR, TAU = 1e5, 2e4, 10.0
GLUE = cd.BondedLayer(cd.LinearLayer(NORMAL), shear_stiffness=SHEAR)

UNLIKE = ((4, 2), (5, 3))


def sheared(cells=UNLIKE, *, layer=GLUE, swapped=False, sides=True, **options):
    """Two blocks under uniform shear τ, the lower one on a floor; without its sides loaded they bend as well."""

    def body(name, floor, cells, *more):
        ends = [cd.Traction("left", (0, -TAU)), cd.Traction("right", (0, TAU))] if sides else []
        mesh = cd.rectangle((0, floor), (2, floor + 1), cells)
        supports = [cd.Fixed("bottom")] if floor == 0 else []
        return cd.Body(name, mesh, STEEL, supports=supports, loads=[*ends, *more])

    low, high = body("low", 0, cells[0]), body("high", 1, cells[1], cd.Traction("top", (TAU, 0)))
    pair = [(low, "top"), (high, "bottom")]
    return cd.Scene([low, high], [cd.Contact(*(pair[::-1] if swapped else pair), layer, **options)])


def check(found, direction, tau=TAU, rel=1e-9):
    """Uniform slip s = τ/k_t of the first surface against the load, no pressure: exact to the residual, magnified."""
    result, direction = found.contact(), np.asarray(direction)
    assert np.allclose(result.slip, -tau / SHEAR * direction, rtol=0, atol=rel * tau / SHEAR)
    assert np.allclose(result.shear, tau * direction, rtol=0, atol=rel * tau)
    assert np.abs(result.pressure).max() < rel * tau
    assert found.imbalance < 1e-10


@pytest.mark.parametrize("local_solver", ["condensed", "assembled", "multigrid"])
@pytest.mark.parametrize("method", ["auto", "chord", "anderson", "newton", "newton-krylov"])
def test_patch(method, local_solver):
    """By every kind of step and local solver."""
    found = cd.solve(sheared(), method, local_solver=local_solver, tolerance=1e-12)
    check(found, (1, 0), rel=2e-8 if method in ("chord", "anderson") else 1e-9)
    top = found.displacement_at("high", [[1.0, 2.0]])[0]
    assert top == pytest.approx([2 * TAU / G + TAU / SHEAR, 0.0], rel=1e-7, abs=1e-11)


@pytest.mark.parametrize("options", [{"cells": ((4, 2), (4, 2))}, {"quadrature": "facet"}, {"quadrature": "mortar"},
                                     {"cells": ((4, 2), (4, 2)), "quadrature": "vertex"}], ids=str)  # fmt: skip
def test_patch_by_every_rule(options):
    check(cd.solve(sheared(**options), tolerance=1e-12), (1, 0))


@pytest.mark.parametrize("cells", [((3, 3, 2), (3, 3, 2)), ((3, 2, 1), (2, 3, 1))], ids=["match", "unlike"])
@pytest.mark.parametrize("local_solver", ["condensed", "assembled", "multigrid"])
def test_patch_in_space(cells, local_solver):
    """σ_xz = 8 and σ_yz = 6: a slip of τ = 10 in the direction (0.8, 0.6)."""
    along = np.array([0.8, 0.6, 0.0])

    def body(name, floor, cells, *more):
        mesh = cd.box((0, 0, floor), (1, 1, floor + 1), cells)
        faces = {"left": (0, 0, -8), "right": (0, 0, 8), "front": (0, 0, -6), "back": (0, 0, 6)}
        loads = [cd.Traction(face, value) for face, value in faces.items()]
        supports = [cd.Fixed("bottom")] if floor == 0 else []
        return cd.Body(name, mesh, STEEL, supports=supports, loads=[*loads, *more])

    low, high = body("low", 0, cells[0]), body("high", 1, cells[1], cd.Traction("top", tuple(TAU * along)))
    scene = cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), GLUE)])
    for method in ("auto", "anderson"):
        check(cd.solve(scene, method, local_solver=local_solver, tolerance=1e-12), along, rel=3e-8)


def test_ring():
    """A sleeve on a shaft, pulled off: τ = F/(2πrL), here with the ends loaded so that it is so everywhere.

    u_z ~ log r is not in the elements: quadratic ones on four cells per unit of radius miss it by some 1e-4.
    """

    def body(name, inner, outer, *more, supports=()):
        mesh = cd.rectangle((inner, 0), (outer, 1), (4, 3))
        ends = [
            cd.Traction("top", lambda x: (TAU / x[0], 0 * x[0])),
            cd.Traction("bottom", lambda x: (-TAU / x[0], 0 * x[0])),
        ]
        options = {"degree": 2, "kinematics": "axisymmetric"}
        return cd.Body(name, mesh, STEEL, supports=supports, loads=[*ends, *more], **options)

    shaft = body("shaft", 0.5, 1, supports=[cd.Fixed("left")])
    sleeve = body("sleeve", 1, 2, cd.Traction("right", (0, TAU / 2)))
    found = cd.solve(cd.Scene([shaft, sleeve], [cd.Contact((shaft, "right"), (sleeve, "left"), GLUE)]))
    result = found.contact()
    assert result.shear[:, 1] == pytest.approx(np.full(len(result.x), TAU), rel=1e-3)
    assert result.force_vector == pytest.approx([0.0, 2 * np.pi * TAU], rel=1e-9)


def test_swapped_bodies_energy_and_units():
    """Action is reaction, half the loads' work is stored, and other units change numbers only."""
    one, other = (cd.solve(sheared(sides=False, swapped=s), tolerance=1e-12) for s in (False, True))
    assert one.energy == pytest.approx(other.energy, rel=1e-11)
    assert one.contact().force_vector == pytest.approx(-other.contact().force_vector, rel=1e-9, abs=1e-9)
    assert one.contact().force_vector == pytest.approx([2 * TAU, 0.0], rel=1e-9, abs=1e-8)
    assert one.elastic_energy() + one.layer_energy == pytest.approx(-one.energy, rel=1e-11)
    total = sum(one.forces("high").values())
    assert np.abs(total).max() < 1e-9


def test_elastic_bodies_and_all_schemes_agree():
    """Where stresses are not uniform the coupled and the decomposed methods still find the same."""
    scene = sheared(sides=False)
    found = [cd.solve(scene, method, tolerance=1e-11).contact() for method in ("newton", "one-point", "newton-krylov")]
    for other in found[1:]:
        assert np.abs(other.shear - found[0].shear).max() < 1e-7 * TAU
        assert np.abs(other.pressure - found[0].pressure).max() < 1e-7 * TAU


def test_rigid_partner():
    """A block glued to a rigid plane, which is pulled along under a force; held, it shears the block alike."""
    mesh = cd.rectangle((0, 0), (2, 1), (4, 2))
    ends = [cd.Traction("left", (0, -TAU)), cd.Traction("right", (0, TAU))]
    block = cd.Body("block", mesh, STEEL, supports=[cd.Fixed("bottom")], loads=ends)
    tool = cd.RigidBody("tool", cd.Plane((0, 1), (0, -1)), displacement=(None, None), force=(2 * TAU, 0.0))
    found = cd.solve(cd.Scene([block, tool], [cd.Contact((block, "top"), tool, GLUE)]), tolerance=1e-12)
    check(found, (1, 0))
    assert found.displacement("tool")[:2] == pytest.approx([TAU / G + TAU / SHEAR, 0.0], rel=1e-9, abs=1e-12)


def test_influence_functions_cannot():
    """A half-plane knows its normal displacements only: refused before anything is solved."""
    block = cd.Body("block", cd.rectangle((0, 0), (2, 1), (4, 2)), STEEL, loads=[cd.Pressure("top", 1.0)])
    ground = cd.HalfPlane("ground", STEEL, np.linspace(-1, 3, 33), reference=10.0)
    scene = cd.Scene([ground, block], [cd.Contact((block, "bottom"), ground, GLUE)])
    with pytest.raises(ValueError, match="moves along its surface is not known"):
        cd.solve(scene)


def test_mirror_image_slides_along():
    """A body and its mirror image never slide past each other: a bond's shear stiffness changes nothing."""
    body = cd.Body("low", cd.rectangle((0, 0), (2, 1), (4, 2)), STEEL, supports=[cd.Symmetry("left")],
                   loads=[cd.Traction("bottom", lambda x: (0 * x[0], -5.0 * x[0]))])  # fmt: skip
    mirror = cd.MirrorPlane("mirror", (0, 1), (0, -1))
    with_, without = (
        cd.solve(cd.Scene([body, mirror], [cd.Contact((body, "top"), mirror, layer)])).contact()
        for layer in (GLUE, cd.BondedLayer(cd.LinearLayer(NORMAL)))
    )
    assert with_.pressure == pytest.approx(without.pressure, rel=1e-12)


def test_layer_is_exchanged():
    """`with_layer` brings sliding in and takes it out again; without it, nothing holds the block along the floor."""
    scene = sheared()
    first = cd.solve(scene)
    softer = cd.solve(scene.with_layer(cd.BondedLayer(cd.LinearLayer(NORMAL), shear_stiffness=SHEAR / 2)))
    assert softer.contact().slip == pytest.approx(2 * first.contact().slip, rel=1e-8, abs=1e-12)
    free = scene.with_layer(cd.BondedLayer(cd.LinearLayer(NORMAL)))
    with pytest.raises(cd.NoEquilibriumError):
        cd.solve(free)
    check(cd.solve(free.with_layer(GLUE)), (1, 0), rel=1e-8)


def test_varying_stiffness():
    """Stiff blocks: the shear follows k_t(x) at one slip, 2τL = ∫ k_t s."""
    layer = cd.BondedLayer(cd.LinearLayer(1e2), shear_stiffness=lambda x: 10.0 + 10.0 * x[0])
    result = cd.solve(sheared(layer=layer)).contact()
    slip = -2 * TAU / 40.0  # ∫ k_t = 40
    assert result.slip[:, 0] == pytest.approx(np.full(len(result.x), slip), rel=2e-3)  # k_t L/G = 4e-4 and bending
    assert result.shear[:, 0] == pytest.approx(-slip * (10 + 10 * result.x[:, 0]), rel=2e-3)


def test_results(tmp_path):
    """Columns, a saved solution and other points tell the slip too; the moment of the shear balances the load's."""
    found = cd.solve(sheared())
    assert {"slip_x", "shear_y"} <= set(found.contact().columns())
    found.save(tmp_path / "bond")
    kept = cd.load_solution(tmp_path / "bond").contact()
    assert np.array_equal(kept.shear, found.contact().shear)
    fine = found.contact(degree=7)
    assert fine.slip == pytest.approx(np.tile([-TAU / SHEAR, 0.0], (len(fine.x), 1)), rel=1e-8, abs=1e-12)
    assert found.contact().moment((0.0, 0.0)) == pytest.approx(-2 * TAU, rel=1e-8)  # arm 1 below the force 2τ
    assert cd.error_estimate(found).contact().force.error < 1e-7


def test_floating_pair():
    """Nothing but the bond holds two blocks that are pulled apart; pulled along at one end, they move for ever."""

    def scene(along):
        ends = [cd.Traction("bottom", (0, -5.0)), cd.Traction("left", (-3.0, 0)), cd.Traction("right", (3.0, 0))]
        low = cd.Body("low", cd.rectangle((0, 0), (2, 1), UNLIKE[0]), STEEL, loads=ends)
        high = cd.Body("high", cd.rectangle((0, 1), (2, 2), UNLIKE[1]), STEEL, loads=[cd.Traction("top", (along, 5.0))])
        return cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), GLUE)])

    first, *others = (cd.solve(scene(0.0), m).contact() for m in ("auto", "anderson", "newton-krylov", "one-point"))
    assert first.force == pytest.approx(-10.0, rel=1e-9)
    for other in others:
        assert np.abs(other.shear - first.shear).max() < 1e-8 * 5  # of the pull, to the runs' 1e-10
    with pytest.raises(cd.NoEquilibriumError):
        cd.solve(scene(1.0))


def test_beside_a_hard_contact():
    """A block glued to one that lies on a floor without a layer; the multipliers settle to 1e-6."""
    floor = cd.RigidBody("floor", cd.Plane((0, 0), (0, 1)))
    low = cd.Body("low", cd.rectangle((0, 0), (2, 1), (4, 2)), STEEL, loads=[cd.Traction("right", (-TAU, 0))])
    high = cd.Body("high", cd.rectangle((0, 1), (2, 2), (5, 3)), STEEL,
                   loads=[cd.Traction("left", (TAU, 0)), cd.Pressure("top", 30.0)])  # fmt: skip
    contacts = [cd.Contact((low, "bottom"), floor, cd.HardContact()), cd.Contact((low, "top"), (high, "bottom"), GLUE)]
    scene = cd.Scene([low, high, floor], contacts)
    found = cd.solve(scene)
    bond, ground = found.contact(1), found.contact(0)
    assert bond.force_vector == pytest.approx([TAU, -60.0], rel=1e-7)
    assert ground.force == pytest.approx(60.0, rel=1e-6)
    assert found.residual < 1e-9
    assert found.imbalance < 1e-9
    again = cd.solve(scene, start=found)
    assert again.contact(1).shear == pytest.approx(bond.shear, rel=1e-6, abs=1e-6)


def test_text_has_no_addresses():
    """Ranks compare layers by their texts, which a function's address would make unlike."""
    assert repr(cd.BondedLayer(cd.LinearLayer(1.0), shear_stiffness=lambda x: x[0])).endswith("shear_stiffness=f(x))")


def test_two_ranks(tmp_path):
    """Bodies on two ranks, solved apart and together: the numbers of one rank, to the runs' tolerance."""
    code = """
import sys
import numpy as np
from mpi4py import MPI
import contactdd as cd
from test_shear import sheared
scene = sheared(sides=False)
scene = cd.Scene(scene.bodies, scene.contacts, comm=MPI.COMM_WORLD)
found = [cd.solve(scene, method, tolerance=1e-12).contact().shear for method in ("auto", "newton-krylov", "anderson")]
if MPI.COMM_WORLD.rank == 0:
    np.save(sys.argv[1], found)
"""
    ended = launch(2, code, str(tmp_path / "shear.npy"))
    assert ended.returncode == 0, ended.stderr
    alone = cd.solve(sheared(sides=False), tolerance=1e-12).contact().shear
    for shear in np.load(tmp_path / "shear.npy"):
        assert np.abs(shear - alone).max() < 1e-8 * TAU


@pytest.mark.parametrize("value", [-1.0, np.nan, "stiff"])
def test_refused(value):
    with pytest.raises((TypeError, ValueError), match="shear_stiffness"):
        cd.BondedLayer(cd.LinearLayer(1.0), shear_stiffness=value)


def test_starts_and_checkpoints(tmp_path):
    """A start and a checkpoint hold the sliding too: the next run has nothing left to do."""
    scene = sheared(sides=False)
    first = cd.solve(scene, checkpoint=tmp_path / "run.npz")
    assert cd.solve(scene, start=first, tolerance=1e-9).iterations == 0
    again = cd.solve(scene, checkpoint=tmp_path / "run.npz", resume=True)
    assert again.iterations == first.iterations
    assert np.array_equal(again.contact().shear, first.contact().shear)
