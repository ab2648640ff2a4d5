"""Gaskets: laws that remember the largest closure, their loops over load programmes, and the energy they keep."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contactdd as cd

#: A stiffening gasket (mm, MPa), two measured curves of unloading and the same with one stiffness.
TABLE = cd.TableLayer([0.02, 0.05, 0.08, 0.1], [2.0, 8.0, 22.0, 40.0], smooth=False)
CURVES = [([0.03, 0.035, 0.05], [0.0, 2.0, 8.0]), ([0.1, 0.09, 0.075, 0.06], [40.0, 22.0, 5.0, 0.0])]
MEASURED = cd.GasketLayer(TABLE, CURVES)
STRAIGHT = cd.GasketLayer(TABLE, 2000.0)
STEEL, PLACES = cd.Isotropic(2e5, 0.0), np.zeros((2, 4))

both = pytest.mark.parametrize("gasket", [MEASURED, STRAIGHT], ids=["measured", "straight"])


def used(gasket, closures):
    return gasket.remembering(np.zeros((2, len(closures))), closures)


def pressed(gasket, load, *, cells=((4, 2), (5, 3)), **options):
    """Two blocks without Poisson's effect between walls, a gasket between, under an even load."""

    def body(name, floor, cells, supports, loads):
        mesh = cd.rectangle((0, floor), (2, floor + 1), cells)
        return cd.Body(name, mesh, STEEL, supports=[cd.Symmetry("left", "right"), *supports], loads=loads)

    low = body("low", 0, cells[0], [cd.Fixed("bottom")], [])
    high = body("high", 1, cells[1], [], [cd.Pressure("top", load)])
    return cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), gasket, **options)])


@both
@settings(max_examples=25, deadline=None)
@given(top=st.floats(1e-4, 0.12), deep=st.floats(1e-6, 0.13), part=st.floats(0.01, 1.0))
def test_the_functions_are_each_others(gasket, top, deep, part):
    """Energy, slope, divided difference and inverse of the law after any closure belong together."""
    law = used(gasket, [top])
    shallow = deep * part
    p = float(law._pressure(np.array([deep]))[0])
    assert float(law._depth(np.array([p]))[0]) == pytest.approx(deep, rel=1e-10, abs=1e-12)
    bends = [*(law._places[0]), *(np.array(TABLE.compressions) - law.set[0])]
    inside = sorted(bend for bend in bends if shallow < bend < deep)
    ends = np.array([shallow, *inside, deep])  # between its bends the law is straight: the trapezoidal rule is exact
    work = np.trapezoid([float(law._pressure(np.array([c]))[0]) for c in ends], ends)
    stored = float((law._energy(np.array([deep])) - law._energy(np.array([shallow])))[0])
    assert stored == pytest.approx(work, rel=1e-8, abs=1e-9)
    if part < 0.99:
        rise = (p - float(law._pressure(np.array([shallow]))[0])) / (deep - shallow)
        assert float(law._secant(np.array([deep]), np.array([shallow]))[0]) == pytest.approx(rise, rel=1e-9)
    near = deep * (1 - 1e-9)
    secant, slopes = float(law._secant(np.array([deep]), np.array([near]))[0]), law._slope(np.array([near, deep]))
    assert slopes.min() * (1 - 1e-6) <= secant <= slopes.max() * (1 + 1e-6)


@both
def test_law(gasket):
    """From each closure: unloading ends at its set without pressure, and goes on along the loading curve beyond."""
    closures = np.array([0.0, 0.05, 0.08, 0.1])
    law = used(gasket, closures)
    assert law.contact_stress(-(closures - law.set)) == pytest.approx(-np.array([0.0, 8.0, 22.0, 40.0]), rel=1e-12)
    assert np.all(law.contact_stress(np.zeros(4)) == 0.0)
    assert law.contact_stress(-(0.11 - law.set)) == pytest.approx(np.full(4, -49.0), rel=1e-12)
    assert np.all((law.set >= 0) & (law.set < closures) | (closures == 0.0))
    assert np.all(law.dissipation >= 0.0)
    assert law.after(np.ones(4)) is law
    assert law.after(-(0.09 - law.set)).closures == pytest.approx([0.09, 0.09, 0.09, 0.1], rel=1e-14)
    assert np.isnan(law.contact_stress(np.full(4, np.nan))).all()
    assert np.isnan(law.contact_derivative(np.full(4, np.nan))).all()


def test_measured_curves_are_met():
    """Closed up to where a curve was measured, the gasket unloads through its points; in between, in between."""
    for closures, pressures in CURVES:
        law = used(MEASURED, [max(closures)])
        for c, p in zip(closures, pressures, strict=True):
            assert float(law.contact_stress(law.set - c)[0]) == pytest.approx(-p, rel=1e-12, abs=1e-12)
    assert used(MEASURED, [0.075]).set == pytest.approx(0.075 * 0.6)  # both curves' sets are 0.6 of their tops


@pytest.mark.parametrize(("make", "match"), [
    (lambda: cd.GasketLayer(TABLE, 500.0), "above that of loading"),
    (lambda: cd.GasketLayer(TABLE, [([0.03, 0.05], [0.0, 9.0])]), "ends at the closure 0.05 with 9; expected"),
    (lambda: cd.GasketLayer(TABLE, [([0.03, 0.05], [1.0, 8.0])]), "begins at the closure 0.03 with 1"),
    (lambda: cd.GasketLayer(TABLE, [([0.02, 0.03, 0.05], [0.0, 7.0, 8.0])]), "above that of loading"),
    (lambda: cd.GasketLayer(TABLE, [([0.02, 0.03, 0.04, 0.05], [0.0, 2.0, 1.0, 8.0])]), "do not increase"),
    (lambda: cd.GasketLayer(TABLE, []), "expected a stiffness, or curves"),
    (lambda: cd.GasketLayer(TABLE, -1.0), "unloading"),
    (lambda: cd.GasketLayer(MEASURED, 1.0), "loaded and unloaded alike"),
    (lambda: cd.SeriesLayer(MEASURED, TABLE), "remembers"),
    (lambda: cd.BondedLayer(MEASURED), "only presses"),
    (lambda: MEASURED.remembering(PLACES, [1.0]), "one for each point"),
    (lambda: used(MEASURED, [0.1]).at(np.ones((2, 3))), "remembers closures at its 1 points"),
    (lambda: used(cd.GasketLayer(cd.LinearLayer(100.0), 50.0), [0.1]), "get thicker"),
])  # fmt: skip
def test_refused(make, match):
    with pytest.raises((TypeError, ValueError), match=match):
        make()


@both
@pytest.mark.parametrize("method", ["auto", "anderson"])
def test_column_follows_the_curves(gasket, method):
    """An even load up, down and up again, on meshes that do not match: each point is on the curve of its history."""
    load = cd.Parameter(0.0)
    path = cd.programme(pressed(gasket, load), load, [8, 30, 12, 20, 35, 1], method=method, tolerance=1e-12)
    top = 0.0
    for q, solution in zip(path.values, path.solutions, strict=True):
        result = solution.contact()
        law = used(gasket, [top])
        expected = float(law.set[0] - law.compression(np.array([-q]))[0])
        top = max(top, expected)
        closure = -result.compression - solution.interfaces[0].layer.clearance
        assert closure == pytest.approx(np.full(len(result.x), expected), rel=1e-7)  # tolerance times conditioning
        assert result.largest_closure == pytest.approx(np.full(len(result.x), top), rel=1e-7)
        assert solution.dissipated_energy == pytest.approx(2 * float(used(gasket, [top]).dissipation[0]), rel=1e-6)


@both
def test_the_loop_is_what_is_dissipated(gasket):
    """∮ F dδ over a cycle of displacements is the dissipated energy, though no point is pressed like another.

    The trapezoidal rule over steps errs by their square: 48 steps leave about 2e-3, half as many four times that.
    """
    errors = []
    for steps in (24, 48):
        lift = cd.Parameter(0.0)
        body = cd.rectangle((0, 0), (2, 1), (8, 4))
        block = cd.Body("block", body, STEEL, supports=[cd.Displacement("top", (0.0, lift))])
        floor = cd.RigidBody("floor", cd.Plane((0, 0), (0, 1)))
        contact = cd.Contact((block, "bottom"), floor, gasket, gap=lambda x: 0.01 * x[0])
        down = np.linspace(0, -0.09, steps // 2 + 1)
        record = {"force": lambda s: s.contact().force, "dissipated": lambda s: s.dissipated_energy}
        path = cd.programme(cd.Scene([block, floor], [contact]), lift, [*down, *down[-2::-1]], record=record)
        force, delta = path.records["force"], -np.array(path.values)
        loop = float(np.trapezoid(force, delta))
        kept = path.records["dissipated"]
        assert np.all(np.diff(kept) >= -1e-12 * kept[-1])
        assert force[-1] == pytest.approx(0.0, abs=1e-9)
        errors.append(abs(loop / kept[-1] - 1))
    assert errors[1] < 5e-3
    assert errors[1] < 0.4 * errors[0]


def test_open_where_it_has_set():
    """Lifted a little, the gasket keeps its set and has lost contact where it was pressed least, as z > 0 tells."""
    lift = cd.Parameter(0.0)
    supports = [cd.Displacement("top", (0.0, lift))]
    block = cd.Body("block", cd.rectangle((0, 0), (2, 1), (8, 4)), STEEL, supports=supports)
    floor = cd.RigidBody("floor", cd.Plane((0, 0), (0, 1)))
    scene = cd.Scene([block, floor], [cd.Contact((block, "bottom"), floor, MEASURED, gap=lambda x: 0.02 * x[0])])
    full, part = (s.contact() for s in cd.programme(scene, lift, [-0.08, -0.055]).solutions)
    assert full.area == pytest.approx(2.0)
    assert 0.0 < part.area < 1.5
    assert np.array_equal(part.closed, part.pressure > 0)
    first = cd.solve(
        scene
    ).contact()  # at the second lift, never pressed more: it is soft, and closed nearly everywhere
    assert first.area > part.area


def test_mirror_image():
    """Half of a pair with the gasket between, over a programme: the same pressures, closures and half the energy."""
    load = cd.Parameter(0.0)

    def body(name, floor, side, diagonal):
        mesh = cd.rectangle((0, floor), (2, floor + 1), (4, 2), diagonal=diagonal)
        pressure = cd.Pressure(side, load.field(lambda q, x: q * (1 + x[0])))
        return cd.Body(name, mesh, STEEL, supports=[cd.Symmetry("left", "right")], loads=[pressure])

    low, high = body("low", 0, "bottom", "right"), body("high", 1, "top", "left")
    mirror = cd.MirrorPlane("mirror", (0, 1), (0, -1))
    pair = cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), MEASURED)])
    half = cd.Scene([low, mirror], [cd.Contact((low, "top"), mirror, MEASURED)])
    whole, part = (cd.programme(scene, load, [10.0, 2.0]).solutions[-1] for scene in (pair, half))
    assert part.contact().pressure == pytest.approx(whole.contact().pressure, rel=1e-7)
    assert part.contact().largest_closure == pytest.approx(whole.contact().largest_closure, rel=1e-7)
    assert part.dissipated_energy == pytest.approx(0.5 * whole.dissipated_energy, rel=1e-7)


def test_solve_alone_remembers_nothing():
    """Each solve of a scene begins anew; the scene after a solution goes on, and one that failed leaves nothing."""
    load = cd.Parameter(30.0)
    scene = pressed(MEASURED, load)
    first = cd.solve(scene)
    load.value = 10.0
    virgin, after = cd.solve(scene).contact(), cd.solve(first.scene_after, start=first).contact()
    assert virgin.largest_closure.max() < 0.06
    assert after.largest_closure == pytest.approx(first.contact().largest_closure, rel=1e-12)
    assert after.pressure == pytest.approx(virgin.pressure, rel=1e-8)  # the load's, whatever the history
    failed = cd.solve(scene, "anderson", max_iterations=2, on_failure="return")
    with pytest.raises(ValueError, match="expected a converged solution"):
        _ = failed.scene_after
    plain = cd.solve(pressed(TABLE, 5.0))
    assert plain.scene_after is plain.scene
    assert plain.dissipated_energy == 0.0


def test_a_start_is_no_history():
    """To start from a solution is not to go on from its gaskets: said when it is done, and not when it is meant."""
    load = cd.Parameter(30.0)
    scene = pressed(MEASURED, load)
    first = cd.solve(scene)
    load.value = 10.0
    with pytest.warns(cd.ContactWarning, match="start.scene_after is the scene that goes on"):
        cd.solve(scene, start=first)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        second = cd.solve(first.scene_after, start=first)
        cd.programme(second.scene_after, load, [5.0, 40.0], start=second)


def test_saved_with_checkpoints_and_solutions(tmp_path):
    """What a gasket remembers is in a saved solution and in a checkpoint, from which a scene without it goes on."""
    load = cd.Parameter(30.0)
    scene = pressed(MEASURED, load)
    first = cd.solve(scene)
    first.save(tmp_path / "first")
    kept = cd.load_solution(tmp_path / "first").contact()
    assert np.array_equal(kept.largest_closure, first.contact().largest_closure)
    load.value = 10.0
    again = scene.with_layer(MEASURED.remembering(kept.x.T, kept.largest_closure))
    known = cd.solve(again).contact()
    file = tmp_path / "run.npz"
    stopped = cd.solve(again, "anderson", checkpoint=file, callback=lambda record: record.iteration == 2)
    assert stopped.status == "stopped"
    resumed = cd.solve(pressed(MEASURED, load), "anderson", checkpoint=file, resume=True)
    assert resumed.contact().largest_closure == pytest.approx(kept.largest_closure, rel=1e-12)
    assert resumed.contact().gap == pytest.approx(known.gap, rel=1e-7, abs=1e-12)


def test_no_equilibrium_is_still_found():
    """A gasket that remembers holds no block that is pulled off."""
    load = cd.Parameter(20.0)
    first = cd.solve(pressed(STRAIGHT, load))
    load.value = -1.0
    with pytest.raises(cd.NoEquilibriumError):
        cd.solve(first.scene_after, start=first)
