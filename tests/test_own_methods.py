"""Methods of the user's own: φ that sees both bodies, γ from the history, bodies in an order."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import STEEL, block, groove, stack
from test_demos import is_picture, run

import contactdd as cd

SOFT = cd.Isotropic(2.1e4, 0.3)
K = 1e5


def secant(layer, z, z_previous, x):
    return layer.divided_difference(z_previous, z)


def two_sided(layer, z, z_previous, x, sides):
    first, second = sides.moduli
    return np.array([[1 + first / second], [1 + second / first]]) * layer.contact_derivative(z)


def scheme(coefficient, **options) -> cd.Scheme:
    return cd.Scheme("own", coefficient, "decomposed", "own", **options)


def columns(held: bool = False, layer: cd.Layer | None = None, gap: object = 0.0) -> cd.Scene:
    """Two unlike blocks that fill a box, pressed from both ends or held at them: all is uniform without a gap."""
    ends = [[cd.Fixed("bottom")], [cd.Displacement("top", (0.0, -1e-3))]] if held else [[], []]
    loads = [[], []] if held else [[cd.Pressure("bottom", 10)], [cd.Pressure("top", 10)]]
    low = block("low", 0, (8, 4), supports=ends[0], loads=loads[0])
    high = block("high", 1, (8, 4), SOFT, diagonal="left", supports=ends[1], loads=loads[1])
    return stack([low, high], layer or cd.LinearLayer(K), gap)


def oedometer(material: cd.Isotropic) -> float:
    """The stiffness of a column of height one between walls."""
    return material.stiffness()[0, 0]


def rate(solution: cd.Solution) -> float:
    """The factor by which an iteration reduces the residual at the end of a run, of two eigenvalues ± each."""
    residuals = [record.residual for record in solution.history][-7:]
    return (residuals[-1] / residuals[0]) ** (1 / (len(residuals) - 1))


def test_two_sided_coefficient_is_newtons_step():
    """Uniform fields under a linear layer: φ_α = k (1 + s_α/s_β) solves them at once."""
    scene = columns(held=True)
    solution = cd.solve(scene, scheme(two_sided), gamma=1.0)
    assert solution.iterations <= 3  # the start is open, where φ is 0; the first step closes it too far
    newton = cd.solve(scene)
    np.testing.assert_allclose(solution.contact().pressure, newton.contact().pressure, rtol=1e-9)


def test_rates_of_jacobi_and_gauss_seidel():
    """Two springs s₁, s₂ and a layer k between: the radius is k/√((s₁+k)(s₂+k)) at once, its square in an order."""
    scene = columns(held=True, layer=cd.LinearLayer(2e5))
    radius = 2e5 / np.sqrt((oedometer(STEEL) + 2e5) * (oedometer(SOFT) + 2e5))
    options = {"gamma": 1.0, "start": 1e-3, "tolerance": 1e-9}
    at_once = cd.solve(scene, scheme(secant), **options)
    in_order = cd.solve(scene, scheme(secant, order=["low", "high"]), **options)
    # Uniform fields are all that there is, so that the rates are exact but for the last digits of small residuals.
    assert rate(at_once) == pytest.approx(radius, rel=1e-3)
    assert rate(in_order) == pytest.approx(radius**2, rel=1e-3)
    together = cd.solve(scene, scheme(secant, order=[["low", "high"]]), **options)
    assert [r.residual for r in together.history] == pytest.approx([r.residual for r in at_once.history], rel=1e-6)


def test_aitken_solves_one_mode_at_once():
    """Where one mode is left Aitken's γ is that mode's: the third iteration ends it."""

    def aitken(k, now):
        assert now.iteration == k == len(now.history)
        if now.previous is None:
            return 0.5
        change = now.correction - now.previous
        return abs(now.history[-1].gamma * (now.previous @ change) / (change @ change))

    scene = columns(held=True)
    with_two_sided = cd.solve(scene, scheme(two_sided), gamma=aitken)
    assert with_two_sided.iterations <= 4
    grooved = columns(layer=cd.PowerLayer(4e-6, 1.1), gap=groove)
    plain = cd.solve(grooved, "chord", gamma=0.6, tolerance=1e-6)
    chosen = cd.solve(grooved, "chord", gamma=aitken, tolerance=1e-6)
    assert 3 * chosen.iterations < plain.iterations
    # Residuals of 1e-6, of which the soft common motion makes the pressures a little more.
    np.testing.assert_allclose(chosen.contact().pressure, plain.contact().pressure, atol=1e-2)


@pytest.mark.parametrize("local_solver", ["assembled", "multigrid"])
def test_local_solvers(local_solver):
    """A row of φ for each body, and an order, with every way to solve a body."""
    scene = columns(held=True, layer=cd.PowerLayer(4e-6, 1.1), gap=groove)
    expected = cd.solve(scene).contact().pressure
    for method in (scheme(two_sided), scheme(secant, order=["high", "low"])):
        options = {"gamma": 0.9, "tolerance": 1e-6, "local_solver": local_solver}
        found = cd.solve(scene, method, **options).contact().pressure
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-4 * expected.max())  # residuals of 1e-6


def test_three_bodies_in_colours():
    """A chain of three: the outer ones at once, then the middle one, is the order one after another."""
    low = block("low", 0, (4, 2), supports=[cd.Fixed("bottom")])
    middle = block("middle", 1, (4, 2), SOFT)
    high = block("high", 2, (4, 2), loads=[cd.Pressure("top", 10)])
    scene = stack([low, middle, high], cd.LinearLayer(K), 0.0)
    options = {"gamma": 1.0, "tolerance": 1e-6}
    colours = cd.solve(scene, scheme(secant, order=[["low", "high"], "middle"]), **options)
    one_by_one = cd.solve(scene, scheme(secant, order=["high", "low", "middle"]), **options)
    assert [r.residual for r in colours.history] == pytest.approx([r.residual for r in one_by_one.history], rel=1e-6)
    assert colours.contact(0).force == pytest.approx(40.0, rel=1e-4)


def test_what_a_coefficient_sees():
    seen = []

    def looking(layer, z, z_previous, x, sides):
        seen.append((sides.bodies, sides.moduli, sides.interface.weights.sum(), sides.problems[1].length))
        return layer.contact_derivative(z)

    scene = columns(held=True)
    cd.solve(scene, cd.Scheme("own", looking, "direct", "own"))
    assert seen[0] == (("low", "high"), pytest.approx((2.1e5, 2.1e4)), pytest.approx(4.0), 4.0)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: cd.Scheme("own", secant, "decomposd", ""), "step = 'decomposd'"),
        (lambda: cd.Scheme("own", lambda layer, z: z, "decomposed", ""), "takes 2 arguments"),
        (lambda: scheme(secant, order="low"), "order = 'low'"),
        (lambda: cd.Scheme("own", secant, "direct", "", order=["low", "high"]), "order"),
        (lambda: solved(scheme(secant, order=["low"])), "expected each of 'high', 'low' once"),
        (lambda: solved(scheme(secant, order=["low", "hihg"])), "hihg"),
        (lambda: solved(scheme(lambda layer, z, old, x: z[:-1])), "shape"),
        (lambda: solved(scheme(lambda layer, z, old, x: np.full_like(z, np.nan))), "φ = nan"),
        (lambda: solved(scheme(lambda layer, z, old, x, sides: -np.ones((2, len(z))))), "φ = -1"),
        (lambda: solved(cd.Scheme("own", two_sided, "direct", "")), r"shape \(2, "),
        (lambda: solved(scheme(two_sided, order=["low", "high"])), r"shape \(2, "),
        (lambda: solved("chord", gamma=lambda: 1.0), "takes 0 arguments"),
        (lambda: solved("chord", gamma=lambda k, now: -1.0), "gamma = -1.0"),
        (lambda: solved("chord", gamma=lambda k, now: np.nan), "gamma = nan"),
        (lambda: solved("newton-krilov"), "newton-krilov"),
    ],
)
def test_refusals(make, words):
    with pytest.raises((TypeError, ValueError), match=words):
        make()


def solved(method, **options) -> cd.Solution:
    return cd.solve(columns(held=True), method, **{"start": 1e-3, "gamma": 0.6, **options})


def test_demo(tmp_path):
    rows = {(row["method"], row["scene"]): row for row in run("own_method", tmp_path)}
    assert len(rows) == 21
    # The two-sided coefficient and Aitken's rule together need a twentieth of what the chord method does.
    best, plain = rows["two-sided φ, Aitken's γ", "both float"], rows["chord, γ = 0.6", "both float"]
    assert 20 * best["iterations"] < plain["iterations"]
    assert rows["one-point, γ = 0.6", "both float"]["status"] == "diverged"
    assert is_picture(tmp_path / "iterations.png")
