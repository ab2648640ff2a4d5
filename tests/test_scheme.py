"""The schemes' coefficients, the forms of γ, start values, endings."""

from __future__ import annotations

import numpy as np
import pytest
import scenes
import test_uniform
from scenes import LAYER

import contactdd as cd
from contactdd import scheme

Z, BEFORE = np.array([-3e-5, 2e-5, -1e-5, 4e-5]), np.array([-2e-5, -1e-5, 3e-5, 5e-5])


@pytest.fixture(scope="module")
def paper_scene():
    return scenes.paper("vertex")


def g(z):
    return LAYER.contact_stress(z)


def test_chord_is_the_divided_difference():
    found = scheme.chord(LAYER, Z, BEFORE, Z)
    np.testing.assert_allclose(found, (g(BEFORE) - g(Z)) / (BEFORE - Z), rtol=1e-12)  # distant points: no cancellation


def test_kurchatov_is_the_divided_difference():
    found = scheme.kurchatov(LAYER, Z, BEFORE, Z)
    np.testing.assert_allclose(found, (g(BEFORE) - g(2 * Z - BEFORE)) / (2 * (BEFORE - Z)), rtol=1e-12)


def test_two_point_coefficients_tend_to_the_derivative():
    z = np.array([-3e-5, -1e-6, 2e-5])
    for coefficient in (scheme.chord, scheme.kurchatov):
        for distance in (0.0, 1e-25, 1e-15):
            found = coefficient(LAYER, z, z + distance, z)
            # The distance changes φ by (1 − 1/a) distance / |z| at most.
            np.testing.assert_allclose(found, scheme.semismooth(LAYER, z, z, z), rtol=1e-8)


def test_robin_everywhere_is_finite():
    assert np.all(np.isfinite(scheme.everywhere(LAYER, np.array([-1e-5, 0.0, 1e-5]), Z, Z)))


def test_subsets_of_the_robin_condition(paper_scene):
    """ψ = χ given by hand is the one-point scheme; ψ ≡ 1 converges too; ψ ≡ 0 leaves floating bodies loose."""
    options = {"gamma": 0.5, "start": 1e-4, "tolerance": 1e-8}
    own = cd.solve(paper_scene, cd.one_point(lambda z, x: z < 0), **options)
    named = cd.solve(paper_scene, "one-point", **options)
    assert own.iterations == named.iterations
    everywhere = cd.solve(paper_scene, "robin", **options)
    # Both have residuals of 1e-8 of the forces.
    np.testing.assert_allclose(everywhere.contact().pressure, named.contact().pressure, atol=1e-5)
    neumann = cd.solve(paper_scene, "neumann", on_failure="return", gamma=0.5, start=1e-4)
    assert neumann.status == "diverged"
    assert "held by nothing" in neumann.reason
    assert "translation along y" in neumann.reason


def test_neumann_scheme_on_held_bodies():
    """The parallel Neumann scheme converges for a soft layer between bodies that are held."""
    steel = cd.Isotropic(E=1e5, nu=0.3)
    lower = cd.Body("lower", cd.rectangle((0, 0), (1, 1), (4, 4)), steel, supports=[cd.Fixed("bottom")])
    upper = cd.Body("upper", cd.rectangle((0, 1), (1, 2), (4, 4)), steel,
                    supports=[cd.Displacement("top", (0.0, -1e-3))])  # fmt: skip
    scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.LinearLayer(1e3))])
    neumann = cd.solve(scene, "neumann", gamma=0.9, tolerance=1e-10)
    newton = cd.solve(scene, "newton", gamma=1.0, tolerance=1e-10)
    np.testing.assert_allclose(neumann.contact().pressure, newton.contact().pressure, rtol=1e-8)  # as the residuals


@pytest.mark.parametrize("gamma", [0.6, [0.6] * 60, lambda k: 0.6])
def test_forms_of_gamma(paper_scene, gamma):
    solution = cd.solve(paper_scene, "chord", gamma=gamma, tolerance=1e-6)
    assert set(solution.history.gamma) == {0.6}


def test_gamma_may_vary_and_end(paper_scene):
    varied = cd.solve(paper_scene, "chord", gamma=lambda k: 0.5 + 0.1 * (k % 2), tolerance=1e-6)
    assert varied.history.gamma[:3].tolist() == [0.5, 0.6, 0.5]
    short = cd.solve(paper_scene, "chord", gamma=[0.6, 0.6], on_failure="return")
    assert (short.status, short.iterations) == ("iteration limit", 2)


def test_searched_gamma_never_raises_the_energy():
    # Meshes that do not mirror each other, so that slow modes are there.
    lower, upper = scenes.paper().bodies[0], scenes.paper(refine=1).bodies[1]
    scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), LAYER, gap=scenes.groove)])
    for method in ("one-point", "chord", "kurchatov", "newton", "newton-chord"):
        energy = cd.solve(scene, method, gamma="search", tolerance=1e-9).history.energy
        assert np.all(np.diff(energy) <= 1e-13 * np.abs(energy).max())  # rounding of the energy's parts


@pytest.mark.parametrize("method", ["newton", "newton-chord"])
def test_searched_gamma_is_the_same_by_differences_and_by_divided_differences(paper_scene, method, monkeypatch):
    """Differences of the layers' work, where they do not cancel, and divided differences give one slope."""
    histories = []
    for cancelled in (0.0, np.inf):
        monkeypatch.setattr("contactdd.iteration.run.CANCELLED", cancelled)
        histories.append(cd.solve(paper_scene, method, tolerance=1e-6).history)
    assert histories[0].gamma == pytest.approx(histories[1].gamma, rel=1e-6)
    assert histories[0].energy == pytest.approx(histories[1].energy, rel=1e-12)


def test_warm_start_needs_no_iteration(paper_scene):
    first = cd.solve(paper_scene, "newton", gamma="search", tolerance=1e-10)
    again = cd.solve(paper_scene, "chord", gamma=0.6, tolerance=1e-9, start=first)
    assert again.iterations == 0
    assert again.converged


def test_callback_stops(paper_scene):
    seen = []
    solution = cd.solve(paper_scene, "chord", callback=lambda record: seen.append(record) or record.iteration == 3)
    assert solution.status == "stopped"
    assert [record.iteration for record in seen] == [1, 2, 3]


def test_failure_raises_with_the_last_state(paper_scene):
    with pytest.raises(cd.NotConvergedError, match="iteration limit") as caught:
        cd.solve(paper_scene, "chord", max_iterations=2)
    assert caught.value.solution.iterations == 2
    assert caught.value.status == "iteration limit"


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ({"gamma": 0.0}, "gamma = 0"),
        ({"gamma": -0.5}, "gamma = -0.5"),
        ({"gamma": "often"}, "gamma = 'often'"),
        ({"tolerance": 0.0}, "tolerance"),
        ({"method": "magic"}, "method = 'magic'"),
        ({"criterion": "hope"}, "criterion = 'hope'"),
        ({"local_solver": "oracle"}, "local_solver = 'oracle'"),
        ({"on_failure": "cry"}, "on_failure"),
        ({"max_iterations": 0}, "max_iterations"),
    ],
)
def test_bad_options_are_refused(paper_scene, option, message):
    with pytest.raises(ValueError, match=message):
        cd.solve(paper_scene, **option)


def test_units_do_not_matter():
    """cm–MPa, m–Pa and µm–kPa: the same iterations and the same relative numbers."""
    counts, peaks = [], []
    for length, stress in ((1.0, 1.0), (1e-2, 1e6), (1e4, 1e3)):
        steel = cd.Isotropic(E=2.1e5 * stress, nu=0.3)
        layer = cd.PowerLayer(B=4e-6 * length / stress**1.1, a=1.1)
        bodies = [
            scenes.block(
                name,
                y * length,
                (16, 8),
                steel,
                length=4 * length,
                height=length,
                loads=[cd.Pressure(loaded, 10.0 * stress)],
                diagonal=diagonal,
            )
            for name, y, loaded, diagonal in (("lower", 0, "bottom", "right"), ("upper", 1, "top", "left"))
        ]
        scene = scenes.stack(bodies, layer, gap=lambda x, s=length: s * scenes.groove(x / s))
        solution = cd.solve(scene, "chord", gamma=0.6, tolerance=1e-9)
        counts.append(solution.iterations)
        peaks.append(solution.contact().pressure.max() / stress)
    assert len(set(counts)) == 1
    np.testing.assert_allclose(peaks, peaks[0], rtol=1e-9)  # rounding, times the condition of the bodies


def test_swapped_bodies(paper_scene):
    """The contact written the other way round gives the same pressures on matching meshes."""
    lower, upper = scenes.paper().bodies
    one, other = (
        cd.solve(cd.Scene(bodies, [cd.Contact(*sides, LAYER, gap=scenes.groove)]), "newton", gamma="search")
        for bodies, sides in (
            ([lower, upper], ((lower, "top"), (upper, "bottom"))),
            ([upper, lower], ((upper, "bottom"), (lower, "top"))),
        )
    )
    curves = []
    for solution in (one, other):
        result = solution.contact()
        curves.append(result.pressure[np.argsort(result.x[:, 0])])
    np.testing.assert_allclose(curves[0], curves[1], atol=1e-9 * curves[0].max())  # two orders of elimination


def test_history():
    history = cd.solve(test_uniform.scene(), "chord", gamma=0.5).history
    assert len(history.change) == len(history)
    assert np.all(np.diff(history.seconds) >= 0)
    assert history.table().count("\n") == len(history)
    assert "<table>" in history._repr_html_()
    with pytest.raises(AttributeError, match="wishes"):
        _ = history.wishes
