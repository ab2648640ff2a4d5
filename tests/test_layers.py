"""The layer laws beside the paper's own: all five functions in 50 digits, their limits, files, and columns pressed."""

from __future__ import annotations

import doctest
import importlib
import math

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

import contactdd as cd

mp = mpmath.mp
mp.dps = 50

E, H = 2.1e5, 1.0
STEEL = cd.Isotropic(E, 0.0)


def of(law, name):
    """The parameters of a law in 50 digits."""
    return [mpmath.mpf(getattr(law, each)) for each in name.split()]


def hyperbolic(law):
    K, V = of(law, "stiffness closure")
    return (
        lambda c: K * c / (1 - c / V),
        lambda c: K / (1 - c / V) ** 2,
        lambda c: K * V**2 * (-mp.log(1 - c / V) - c / V),
    )


def logarithmic(law):
    M, h = of(law, "modulus thickness")
    return (
        lambda c: -M * mp.log(1 - c / h),
        lambda c: M / (h - c),
        lambda c: M * h * ((1 - c / h) * mp.log(1 - c / h) + c / h),
    )


def exponential(law):
    p0, w0 = of(law, "p0 w0")
    return (
        lambda c: p0 * mp.expm1(c / w0),
        lambda c: p0 / w0 * mp.exp(c / w0),
        lambda c: p0 * w0 * (mp.expm1(c / w0) - c / w0),
    )


def overclosure(law):
    p0, c0 = of(law, "p0 c0")
    f = p0 / mp.expm1(1)
    return (
        lambda c: f * c / c0 * mp.expm1(c / c0),
        lambda c: f / c0 * (mp.expm1(c / c0) + c / c0 * mp.exp(c / c0)),
        lambda c: f * c0 * ((c / c0 - 1) * mp.exp(c / c0) + 1 - (c / c0) ** 2 / 2),
    )


def moment(n, t):
    """∫_t^∞ (s - t)^n φ(s) ds by the parabolic cylinder function."""
    return mp.gamma(n + 1) / mp.sqrt(2 * mp.pi) * mp.exp(-(t**2) / 4) * mp.pcfd(-n - 1, t)


def rough(law):
    E_, eta, R, sigma = of(law, "modulus density radius deviation")
    scale = mpmath.mpf(4) / 3 * E_ * eta * mp.sqrt(R) * sigma ** mpmath.mpf("1.5")
    half = mpmath.mpf(1) / 2
    return (
        lambda c: scale * (moment(3 * half, 8 - c / sigma) - moment(3 * half, mpmath.mpf(8))),
        lambda c: scale / sigma * 3 * half * moment(half, 8 - c / sigma),
        lambda c: (
            scale
            * sigma
            * (
                (moment(5 * half, 8 - c / sigma) - moment(5 * half, mpmath.mpf(8))) * 2 / 5
                - c / sigma * moment(3 * half, mpmath.mpf(8))
            )
        ),
    )


#: Law, its length, the greatest part of its limit that is tried, its exact functions, and how accurate it is.
LAWS = {
    "hyperbolic": (cd.HyperbolicLayer(3e4, 0.2), 0.2, hyperbolic, 1e-13),
    "logarithmic": (cd.LogarithmicLayer(1e3, 1e-3), 1e-3, logarithmic, 1e-13),
    # e^s of s = 100 loses two digits to the rounding of s.
    "exponential": (cd.ExponentialLayer(5.0, 1e-3), 0.1, exponential, 1e-13),
    "overclosure": (cd.OverclosureLayer(5.0, 1e-3), 0.1, overclosure, 1e-13),
    # exp(-t²/2) up to t = 8 loses 1.5 digits to the rounding of t.
    "rough": (cd.GreenwoodWilliamsonLayer(1e5, 300.0, 0.05, 1e-3), 12e-3, rough, 1e-13),
}
every_law = pytest.mark.parametrize("name", LAWS)


def relative_error(value, exact):
    return abs(float((mpmath.mpf(float(value)) - exact) / exact)) if exact else abs(float(value))


@st.composite
def pairs(draw):
    """Two compressions over a law's length, c = 1 - 10^-k or 10^-k, far, close or equal."""
    exponent = draw(st.floats(-9, -0.31))
    deep = 1 - 10.0**exponent if draw(st.booleans()) else 10.0**exponent
    kind = draw(st.sampled_from(["unrelated", "close", "equal"]))
    if kind == "unrelated":
        return deep, deep * draw(st.floats(1e-6, 1.0))
    return deep, deep if kind == "equal" else deep * (1 - 10.0 ** draw(st.floats(-16.5, -0.01)))


@every_law
@settings(max_examples=40, deadline=None)
@given(pair=pairs())
def test_all_functions_in_50_digits(name, pair):
    law, length, exact_of, tolerance = LAWS[name]
    pressure, slope, energy = exact_of(law)
    deep, shallow = (float(np.minimum(x * length, law.compression_limit)) for x in pair)
    c, d = mpmath.mpf(deep), mpmath.mpf(shallow)
    assert relative_error(-law.contact_stress(-deep), pressure(c)) < tolerance
    assert relative_error(law.contact_derivative(-deep), slope(c)) < tolerance
    assert relative_error(law.energy(-deep), energy(c)) < tolerance
    secant = slope(c) if c == d else (pressure(c) - pressure(d)) / (c - d)
    assert relative_error(law.divided_difference(-deep, -shallow), secant) < tolerance


@every_law
@settings(max_examples=20, deadline=None)
@given(exponent=st.floats(-8, 0))
def test_inverse_in_50_digits(name, exponent):
    law, length, exact_of, _ = LAWS[name]
    p = float(-law.contact_stress(-(10.0**exponent) * min(length, law.compression_limit)))
    c = float(-law.compression(-p))
    pressure, slope, _ = exact_of(law)
    # By how much c is off, to first order: it needs no inverse in 50 digits. A double's c near a pole is as coarse as
    # its own rounding.
    off = (pressure(mpmath.mpf(c)) - mpmath.mpf(p)) / slope(mpmath.mpf(c))
    assert abs(float(off)) < 1e-13 * c


@every_law
def test_law_goes_on_straight_beyond_its_limit(name):
    law, *_ = LAWS[name]
    limit = law.compression_limit
    p, k = float(-law.contact_stress(-limit)), float(law.contact_derivative(-limit))
    beyond = limit * np.array([1.5, 2.0, 10.0])
    np.testing.assert_allclose(-law.contact_stress(-beyond), p + k * (beyond - limit), rtol=1e-12)
    np.testing.assert_allclose(law.contact_derivative(-beyond), k, rtol=1e-12)
    np.testing.assert_allclose(law.divided_difference(-beyond, -beyond[::-1]), k, rtol=1e-12)
    inside = limit / 2
    chord = (-law.contact_stress(-beyond) + law.contact_stress(-inside)) / (beyond - inside)
    np.testing.assert_allclose(law.divided_difference(-beyond, -inside), chord, rtol=1e-12)
    area = law.energy(-limit) + (p + k * (beyond - limit) / 2) * (beyond - limit)
    np.testing.assert_allclose(law.energy(-beyond), area, rtol=1e-12)
    np.testing.assert_allclose(law.compression(law.contact_stress(-beyond)), -beyond, rtol=1e-12)
    assert np.isnan(law.contact_stress(np.nan))
    assert np.isnan(law.divided_difference(np.nan, -limit))


@every_law
def test_functions_agree_on_arrays_with_nothing_below_zero(name):
    law, length, *_ = LAWS[name]
    z = -length * np.linspace(-0.5, 0.9, 29).reshape(1, 29)
    assert law.contact_stress(z).shape == law.energy(z).shape == law.divided_difference(z, 0.5 * z).shape == z.shape
    assert np.all(law.contact_stress(z)[z >= 0] == 0)
    assert np.all(np.diff(law.contact_stress(z)[z < 0]) < 0)
    assert law.compression(0.0) == 0


# --- laws by their constructors


def test_separation_law_is_the_bare_exponential():
    layer = cd.ExponentialLayer.of_separation(p0=5.0, decay=2e-3)
    u = 2e-3 * np.linspace(-3, 30, 34)
    # What is cut off at 40 decays is e^-10 of what is left at 30.
    np.testing.assert_allclose(-layer.contact_stress(u - layer.clearance), 5 * np.exp(-u / 2e-3), rtol=5e-5)
    near = u < 0
    np.testing.assert_allclose(
        -layer.contact_stress(u - layer.clearance)[near], 5 * np.exp(-u / 2e-3)[near], rtol=1e-13
    )


def test_calculix_law_leaves_a_hundredth_at_its_clearance():
    layer = cd.ExponentialLayer.calculix(p0=7.0, c0=1e-3)
    np.testing.assert_allclose(-layer.contact_stress(np.array([0, 1e-3]) - layer.clearance), [7.0, 0.07], rtol=1e-12)


def test_overclosure_law_has_its_pressure_where_surfaces_touch():
    layer = cd.OverclosureLayer(p0=7.0, c0=1e-3)
    np.testing.assert_allclose(-layer.contact_stress(np.array([0, 1e-3]) - layer.clearance), [7.0, 0.0], rtol=1e-13)


def test_exponential_summits_are_the_integral_over_their_heights():
    modulus, density, radius, sigma = 1e5, 300.0, 0.05, 1e-3
    layer = cd.ExponentialLayer.greenwood_williamson(modulus, density, radius, sigma)
    u = 0.7 * sigma
    area = mp.quad(lambda z: (z - u) ** 1.5 * mp.exp(-z / sigma) / sigma, [u, 2 * u, 5 * u, mp.inf])
    exact = 4 / 3 * modulus * density * math.sqrt(radius) * float(area)
    assert float(-layer.contact_stress(u - layer.clearance)) == pytest.approx(exact, rel=1e-12)


def test_gaussian_summits_follow_the_published_table():
    # F_{3/2} of Greenwood and Williamson; the highest summits cut off at 8σ change none of these digits.
    layer = cd.GreenwoodWilliamsonLayer(0.75, 1.0, 1.0, 1.0)
    t = np.array([0.0, 1.0, 2.0, 3.0])
    exact = [float(moment(mpmath.mpf("1.5"), mpmath.mpf(x))) for x in t]
    np.testing.assert_allclose(-layer.contact_stress(t - layer.clearance), exact, rtol=1e-12)


@pytest.mark.parametrize("nu", [-0.3, 0.0, 0.3, 0.45])
def test_bonded_foundation_is_the_long_wave_limit_of_an_elastic_sheet(nu):
    """u/p of a bonded sheet in plane strain under cos κx tends to 1/k with (κh)²."""
    k, h, mu = cd.LinearLayer.elastic_foundation(10.0, nu, 0.5).stiffness, 0.5, 10 / (2 * (1 + nu))

    def compliance(x):  # x = κh
        sinh, cosh = mp.sinh(2 * x), mp.cosh(2 * x)
        below = (3 - 4 * nu) * cosh + 2 * x**2 + 5 - 12 * nu + 8 * nu**2
        return (1 - nu) * h / (mu * x) * ((3 - 4 * nu) * sinh - 2 * x) / below

    errors = [abs(float(compliance(mpmath.mpf(x))) * k - 1) for x in (0.02, 0.01)]
    assert errors[1] < 2e-3
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0 if nu else 4.0, abs=0.02)  # ν = 0: no bulging


def test_sliding_foundation_and_its_range():
    assert cd.LinearLayer.elastic_foundation(10.0, 0.5, 2.0, bonded=False).stiffness == pytest.approx(10 / 0.75 / 2)
    with pytest.warns(UserWarning, match=r"nu = 0\.49: a bonded sheet"):
        cd.LinearLayer.elastic_foundation(10.0, 0.49, 2.0)
    with pytest.raises(ValueError, match=r"nu = 0\.5: expected -1 < nu < 0\.5"):
        cd.LinearLayer.elastic_foundation(10.0, 0.5, 2.0)


def test_machined_joint_in_other_units():
    in_mm = cd.PowerLayer.machined_joint(c=0.6, m=0.5)
    in_m = cd.PowerLayer.machined_joint(c=0.6, m=0.5, micrometre=1e-6, newton_per_square_millimetre=1e6)
    assert float(in_mm.compression(-4.0)) == pytest.approx(-1.2e-3, rel=1e-13)
    assert float(in_m.compression(-4e6)) == pytest.approx(-1.2e-6, rel=1e-13)
    # Stiffness over load grows as p^(1 - m) / (c m).
    p = np.array([1.0, 4.0, 16.0])
    np.testing.assert_allclose(in_mm.contact_derivative(in_mm.compression(-p)), p**0.5 / (0.6e-3 * 0.5), rtol=1e-12)


# --- layers in series


SERIES = {
    "power laws": cd.SeriesLayer(cd.PowerLayer(1e-3, 2.0), cd.PowerLayer(4e-3, 0.5)),
    "a wall and a line": cd.SeriesLayer(cd.HyperbolicLayer(3e4, 0.2), cd.LinearLayer(1e4)),
    "table and three": cd.SeriesLayer(
        cd.TableLayer([0.1, 0.3], [2.0, 50.0]), cd.LinearLayer(1e3), cd.PowerLayer(1e-3, 1.1)
    ),
}


@pytest.mark.parametrize("layer", SERIES.values(), ids=SERIES)
def test_series_adds_compressions_at_equal_pressure(layer):
    p = np.logspace(-6, 2, 33)
    c = sum(-each.compression(-p) for each in layer.layers)
    # Both inverses and the Newton step to rounding: a table's bisection is as good as its cubic, 1e-13.
    np.testing.assert_allclose(-layer.compression(-p), c, rtol=1e-13)
    np.testing.assert_allclose(-layer.contact_stress(-c), p, rtol=1e-12)
    soft = sum(1 / each.contact_derivative(each.compression(-p)) for each in layer.layers)
    np.testing.assert_allclose(layer.contact_derivative(-c), 1 / soft, rtol=1e-11)
    np.testing.assert_allclose(layer.divided_difference(-c, -c), 1 / soft, rtol=1e-11)
    rise = np.diff(p) / np.diff(c)
    np.testing.assert_allclose(layer.divided_difference(-c[1:], -c[:-1]), rise, rtol=1e-11)
    energies = [each.energy(each.compression(-p)) for each in layer.layers]
    np.testing.assert_allclose(layer.energy(-c), sum(energies), rtol=1e-12)
    assert np.isnan(layer.contact_stress(np.nan))
    assert layer.contact_stress(0.0) == 0


def test_series_of_equal_power_laws_is_one_in_50_digits():
    """B |σ|^a twice is 2 B |σ|^a, whose functions are known to 1e-13."""
    one, two = cd.PowerLayer(2e-3, 1.3), cd.SeriesLayer(cd.PowerLayer(1e-3, 1.3), cd.PowerLayer(1e-3, 1.3))
    z = -np.logspace(-9, 0, 40)
    np.testing.assert_allclose(two.contact_stress(z), one.contact_stress(z), rtol=1e-13)
    np.testing.assert_allclose(two.energy(z), one.energy(z), rtol=1e-13)
    for distance in (0.0, 1e-15, 1e-9, 1e-3, 0.9):
        y = z * (1 - distance)
        np.testing.assert_allclose(two.divided_difference(z, y), one.divided_difference(z, y), rtol=1e-13)


def test_series_knows_the_limit_of_its_parts():
    wall, line = cd.HyperbolicLayer(3e4, 0.2), cd.LinearLayer(1e4)
    end = float(-wall.contact_stress(-wall.compression_limit))
    assert cd.SeriesLayer(wall, line).compression_limit == pytest.approx(wall.compression_limit + end / 1e4, rel=1e-12)
    assert cd.SeriesLayer(line, line).compression_limit == np.inf
    assert cd.SeriesLayer(cd.OverclosureLayer(1.0, 1e-3), cd.OverclosureLayer(1.0, 2e-3)).clearance == pytest.approx(
        3e-3
    )


# --- parameters that vary


def test_varying_law_is_at_every_point_the_law_with_its_parameters():
    x = np.vstack([np.linspace(0, 1, 7), np.zeros(7)])
    laws = {
        "power": cd.VaryingLayer(cd.PowerLayer, B=lambda x: 1e-3 * (1 + x[0]), a=lambda x: 0.8 + 0.4 * x[0]),
        "hyperbolic": cd.VaryingLayer(cd.HyperbolicLayer, stiffness=1e3, closure=lambda x: 0.1 * (1 + x[0])),
        "overclosure": cd.VaryingLayer(cd.OverclosureLayer, p0=lambda x: 2 + x[0], c0=lambda x: 1e-3 * (1 + x[0])),
        "rough": cd.VaryingLayer(
            cd.GreenwoodWilliamsonLayer, modulus=1e5, density=300.0, radius=0.05, deviation=lambda x: 1e-3 * (1 + x[0])
        ),
        "series": cd.VaryingLayer(
            lambda B, k: cd.SeriesLayer(cd.PowerLayer(B, 1.1), cd.LinearLayer(k)), B=lambda x: 1e-3 * (1 + x[0]), k=1e4
        ),
    }
    z = np.array([-1e-3, 0.0, -5e-3, 1e-3, -2e-3, -7e-3, -1e-4])
    for name, law in laws.items():
        bound = law.at(x)
        for i in range(7):
            values = {k: v(x[:, i]) if callable(v) else v for k, v in law.parameters.items()}
            alone = law.law(**values)
            for function in ("contact_stress", "contact_derivative", "energy"):
                ours, theirs = getattr(bound, function)(z)[i], getattr(alone, function)(z[i])
                assert ours == pytest.approx(float(theirs), rel=1e-12, abs=1e-300), (name, function)
            ours = bound.divided_difference(z, z[::-1])[i]
            assert ours == pytest.approx(float(alone.divided_difference(z[i], z[::-1][i])), rel=1e-12, abs=1e-300)
            assert bound.compression(-1.0)[i] == pytest.approx(float(alone.compression(-1.0)), rel=1e-12)


def test_varying_law_has_no_value_without_a_place():
    layer = cd.VaryingLayer(cd.LinearLayer, stiffness=lambda x: 1 + x[0])
    with pytest.raises(TypeError, match=r"expected layer\.at\(x\)"):
        layer.contact_stress(-1.0)
    with pytest.raises(ValueError, match="numbers > 0"):
        cd.VaryingLayer(cd.LinearLayer, stiffness=lambda x: x[0] - 1).at(np.zeros((2, 3)))
    with pytest.raises(ValueError, match=r"stiffness: shape \(2,\) at 3 points"):
        cd.VaryingLayer(cd.LinearLayer, stiffness=lambda x: np.ones(2)).at(np.zeros((2, 3)))
    with pytest.raises((TypeError, ValueError)):  # a table's points are not one number for each place
        cd.VaryingLayer(cd.TableLayer, compressions=lambda x: 1 + x[0], pressures=lambda x: 1 + x[0]).at(
            np.vstack([np.arange(3.0), np.zeros(3)])
        )


# --- tables


def test_table_end_slope_does_not_depend_on_units():
    c, p = np.array([0.7427711978032324, 1.8521219786097465]), np.array([0.33326470042215794, 0.4617730096587466])
    rng = np.random.default_rng(0)
    for _ in range(50):
        length, stress = 10 ** rng.uniform(-9, 3), 10 ** rng.uniform(-3, 9)
        layer = cd.TableLayer(c * length, p * stress)
        half = (p[1] - p[0]) / (c[1] - c[0]) / 2 * stress / length
        assert float(layer.derivative(-3 * c[1] * length)) == pytest.approx(half, rel=1e-12)


def test_table_with_a_tiny_point_is_a_number():
    layer = cd.TableLayer([1e-300, 1e-5], [1e-300, 10.0])
    z = -np.array([1e-310, 1e-300, 1e-20, 1e-6, 1e-5, 1e-3])
    for function in (layer.contact_stress, layer.energy, layer.contact_derivative):
        assert np.all(np.isfinite(function(z)))
    assert np.all(np.isfinite(layer.divided_difference(z, z / 3)))
    assert float(layer.contact_stress(-1e-5)) == pytest.approx(-10.0, rel=1e-14)


def test_table_of_straight_lines_is_interpolated():
    c, p = [0.1, 0.3, 0.35], [1.0, 2.0, 30.0]
    layer = cd.TableLayer(c, p, smooth=False)
    x = np.linspace(0.001, 0.35, 101)
    np.testing.assert_allclose(-layer.contact_stress(-x), np.interp(x, [0, *c], [0, *p]), rtol=1e-13)
    np.testing.assert_allclose(layer.compression(-np.array(p)), -np.array(c), rtol=1e-13)
    assert float(layer.energy(-0.35)) == pytest.approx(0.05 + 0.3 + 0.8, rel=1e-13)
    assert float(layer.divided_difference(-0.35, -0.2)) == pytest.approx(28.5 / 0.15, rel=1e-13)


def test_measured_table_is_put_in_order():
    rng = np.random.default_rng(1)
    c = np.linspace(-0.2, 1.0, 61)
    p = np.where(c > 0.1, 40 * np.maximum(c - 0.1, 0) ** 2, 0.0)
    noisy = p + rng.uniform(-0.15, 0.15, 61)
    order = rng.permutation(61)
    layer = cd.TableLayer.from_measurement(c[order], noisy[order], noise=0.2)
    assert -0.2 < layer.clearance < -0.1  # it begins after 0.1, later by the noise: √(0.2/40) = 0.07
    rising = c > 0.4
    found = -layer.contact_stress(-c[rising] - layer.clearance)
    assert np.abs(found - p[rising]).max() < 0.4  # twice the noise
    with pytest.raises(ValueError, match=r"row 3 is 0\.5 off any increasing curve"):
        cd.TableLayer.from_measurement([0, 0.1, 0.2, 0.3, 0.4], [0, 1.0, 5.0, 4.0, 9.0], noise=0.2)


def test_table_from_a_file(tmp_path):
    path = tmp_path / "gasket.csv"
    path.write_text("# rig 3\npressure [MPa];closing [µm]\n0;50\n1,2;100\n\n5,0;200\n18;350\n")
    layer = cd.TableLayer.from_csv(
        path, "closing [µm]", "pressure [MPa]", length_unit=1e-3, stress_unit=1e6, delimiter=";"
    )
    assert layer.clearance == pytest.approx(-0.05)
    np.testing.assert_allclose(layer.compression([-1.2e6, -5e6, -18e6]), [-0.05, -0.15, -0.3], rtol=1e-12)
    with pytest.raises(ValueError, match=r"column 'p': expected one of 'pressure \[MPa\]', 'closing"):
        cd.TableLayer.from_csv(path, "closing [µm]", "p", delimiter=";")
    path.write_text("c,p\n0,0\n0.1,high\n")
    with pytest.raises(ValueError, match=r"line 3: 'high': expected a number"):
        cd.TableLayer.from_csv(path, "c", "p")


# --- the user's own law with a pole


def test_custom_law_with_a_pole_is_known_up_to_it():
    h, k = 1e-3, 1e3
    own = cd.CustomLayer(lambda w: k * np.log(1 + w / h), compression_range=0.5 * h)
    exact = cd.LogarithmicLayer(k, h)
    assert 0.999 * h < own.compression_limit < h
    p = np.array([100.0, 3 * k, 8 * k])
    # 1 + w/h near the pole is as good as 1e-16 over the rest, e^-8.
    np.testing.assert_allclose(own.compression(-p), exact.compression(-p), rtol=1e-12)
    np.testing.assert_allclose(own.contact_derivative(exact.compression(-p)), k / h * np.exp(p / k), rtol=1e-7)
    assert np.all(np.diff(own.contact_stress(-h * np.linspace(0.9, 5, 400))) < 0)


def test_custom_law_that_rounding_makes_zero_has_a_slope_of_zero_there():
    own = cd.CustomLayer(lambda w: np.log(1 + w), compression_range=0.5)  # 1 - 1e-20 = 1
    assert own.divided_difference(-1e-20, -1e-20) == 0.0
    assert own.divided_difference(-1e-20, -1e-21) == 0.0


@pytest.mark.parametrize(
    ("law", "steepens"), [(np.tanh, False), (lambda w: np.sin(w / 1.6), False), (lambda w: w / (1 + w / 3), True)]
)
def test_only_a_law_that_steepens_has_a_pole(law, steepens):
    assert np.isfinite(cd.CustomLayer(law).compression_limit) == steepens


def test_refusal_of_a_law_with_a_pole_names_the_range():
    with pytest.raises(ValueError, match="compression_range"), np.errstate(all="ignore"):
        cd.CustomLayer(lambda w: 3.0 * w / (1 + w / 0.2))


REFUSED = [
    (lambda: cd.HyperbolicLayer(-1.0, 1.0), ValueError, r"stiffness = -1\.0: expected"),
    (lambda: cd.HyperbolicLayer(1.0, "a"), TypeError, r"closure = 'a': expected"),
    (lambda: cd.LogarithmicLayer(1.0, 0.0), ValueError, r"thickness = 0\.0: expected"),
    (lambda: cd.ExponentialLayer(1.0, np.nan), ValueError, r"w0 = nan: expected"),
    (lambda: cd.ExponentialLayer(1.0, 1.0, np.inf), ValueError, r"clearance = inf: expected"),
    (lambda: cd.OverclosureLayer(0, 1.0), ValueError, r"p0 = 0: expected"),
    (lambda: cd.GreenwoodWilliamsonLayer(1.0, 1.0, 1.0, -1.0), ValueError, r"deviation = -1\.0: expected"),
    (lambda: cd.SeriesLayer(cd.LinearLayer(1.0)), TypeError, "expected two layers or more"),
    (lambda: cd.SeriesLayer(cd.LinearLayer(1.0), 3.0), TypeError, r"layers\[1\] = 3\.0: expected a layer"),
    (lambda: cd.VaryingLayer(3.0), TypeError, r"law = 3\.0: expected a layer's class"),
    (lambda: cd.TableLayer([1.0], [1.0], smooth=1), TypeError, r"smooth = 1: expected True or False"),
    (
        lambda: cd.TableLayer([0.1, 0.2, 0.2], [1, 2, 3]),
        ValueError,
        r"0\.2 comes after 0\.2; cd\.TableLayer\.from",
    ),
    (lambda: cd.TableLayer.from_measurement([0, 1], [0, 0]), ValueError, "none is above the noise"),
    (lambda: cd.TableLayer.from_measurement([0, 1], [0.5, 1]), ValueError, "row 1; expected a first row without"),
]


@pytest.mark.parametrize(("build", "error", "message"), REFUSED)
def test_wrong_arguments_are_refused_by_name(build, error, message):
    with pytest.raises(error, match=message):
        build()


# --- columns pressed


def column(layer, closure, gap=0.0):
    """Two columns (ν = 0), the ends brought together by `closure`."""
    sides = cd.Symmetry("left", "right")
    lower = cd.Body("lower", cd.rectangle((0, 0), (2, H), (4, 2)), STEEL, supports=[sides, cd.Fixed("bottom")])
    upper = cd.Body(
        "upper",
        cd.rectangle((0, H), (2, 2 * H), (4, 2)),
        STEEL,
        supports=[sides, cd.Displacement("top", [0, -closure])],
    )
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), layer, gap=gap)])


COLUMNS = {name: (law, 0.3 * length) for name, (law, length, *_) in LAWS.items()}
COLUMNS["exponential"] = (LAWS["exponential"][0], 5e-3)
COLUMNS["overclosure"] = (LAWS["overclosure"][0], 5e-3)
COLUMNS["rough"] = (LAWS["rough"][0], 8e-3)
COLUMNS["series"] = (SERIES["a wall and a line"], 1e-3)
COLUMNS["table"] = (cd.TableLayer([1e-4, 3e-4], [10.0, 100.0], clearance=2e-4), 5e-4)


@pytest.mark.parametrize("method", ["auto", "newton-krylov", "chord"])
@pytest.mark.parametrize("name", COLUMNS)
def test_column_in_closed_form(name, method):
    """2 p H/E + w(p) = Δ + clearance, whatever the method."""
    layer, closure = COLUMNS[name]
    total = closure + layer.clearance
    limit = float(-layer.contact_stress(-total))

    def excess(p):
        return 2 * p * H / E - float(layer.compression(-p)) - total

    p = brentq(excess, 0.0, limit, xtol=1e-13 * limit, rtol=1e-14)
    solution = cd.solve(column(layer, closure), method, tolerance=1e-11, max_iterations=2000)
    # The residual is relative to the forces; the chord method with 0.6 stops where the last change is below it.
    np.testing.assert_allclose(solution.contact().pressure, p, rtol=1e-8)
    assert not solution.notes


def test_solution_says_that_a_table_has_ended():
    layer = cd.TableLayer([1e-4, 3e-4], [10.0, 100.0])
    with pytest.warns(cd.LayerRangeWarning, match=r"on 1 of its area .* where it is known to 0\.0003"):
        solution = cd.solve(column(layer, 3e-3))
    assert len(solution.notes) == 1
    assert "go on straight" in repr(solution)


@pytest.mark.parametrize("method", ["auto", "newton-krylov", "chord"])
def test_layer_that_varies_along_the_surface(method):
    """On bodies a million times stiffer every point is a column of its own: w = -Δ, p = k(x) Δ."""
    layer = cd.VaryingLayer(cd.PowerLayer, B=lambda x: 1e-2 * (1 + x[0]), a=1.2)
    solution = cd.solve(column(layer, 1e-4, gap=0.0), method, tolerance=1e-11)
    result = solution.contact()
    exact = (-result.compression / (1e-2 * (1 + result.x[:, 0]))) ** (1 / 1.2)
    np.testing.assert_allclose(result.pressure, exact, rtol=1e-12)
    assert np.ptp(result.compression) < 1e-3 * 1e-4
    # The same at other points, and after the layer was changed for another.
    finer = solution.contact(degree=9)
    exact = (-finer.compression / (1e-2 * (1 + finer.x[:, 0]))) ** (1 / 1.2)
    np.testing.assert_allclose(finer.pressure, exact, rtol=1e-12)
    other = cd.solve(solution.scene.with_layer(cd.VaryingLayer(cd.LinearLayer, stiffness=lambda x: 1 + x[0])), method)
    np.testing.assert_allclose(
        other.contact().pressure, -other.contact().compression * (1 + other.contact().x[:, 0]), rtol=1e-12
    )


def test_varying_layer_follows_a_gap_that_changes():
    gap = cd.Parameter(0.0)
    layer = cd.VaryingLayer(cd.LinearLayer, stiffness=lambda x: 10 * (1 + x[0]))
    scene = column(layer, 1e-3, gap=gap)
    first = cd.solve(scene).contact().force
    gap.value = 5e-4
    assert cd.solve(scene).contact().force == pytest.approx(first / 2, rel=1e-6)


WALLS = {
    "logarithmic": cd.LogarithmicLayer(1e3, 1e-3),
    "its own": cd.CustomLayer(lambda w: 1e3 * np.log(1 + w / 1e-3), compression_range=9e-4),
    "hyperbolic": cd.HyperbolicLayer(1e6, 1e-3),
}


@pytest.mark.parametrize("method", ["auto", "newton-chord", "anderson", "newton-krylov"])
@pytest.mark.parametrize("name", WALLS)
def test_column_pressed_from_beyond_a_pole(name, method):
    """The columns overlap by three times the closure that nothing exceeds: the law has no pressure where they start.

    Methods whose steps the energy watches over arrive from anywhere; a relaxation that is given may not.
    """
    layer, closure = WALLS[name], 3e-3
    limit = float(-layer.contact_stress(-layer.compression_limit))
    p = brentq(lambda p: 2 * p * H / E - float(layer.compression(-p)) - closure, 0.0, limit, rtol=1e-14)
    solution = cd.solve(column(layer, 0.0, gap=-closure), method, tolerance=1e-10)
    np.testing.assert_allclose(solution.contact().pressure, p, rtol=1e-7)
    assert np.all(-solution.contact().gap < 1e-3)


def test_barton_bandis_joint_in_a_column_under_a_load():
    """V p / (K V + p) = 0.192990 of V = 0.2 under p = 100: the last 4 % of the way to the wall."""
    layer = cd.HyperbolicLayer(stiffness=18.16, closure=0.2)
    sides = cd.Symmetry("left", "right")
    lower = cd.Body("lower", cd.rectangle((0, 0), (2, 1), (4, 2)), STEEL, supports=[sides, cd.Symmetry("bottom")])
    upper = cd.Body(
        "upper", cd.rectangle((0, 1), (2, 2), (4, 2)), STEEL, supports=[sides], loads=[cd.Pressure("top", 100.0)]
    )
    scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), layer)])
    for method in ("auto", "newton-krylov", "newton-chord"):
        compression = cd.solve(scene, method).contact().compression
        np.testing.assert_allclose(-compression, 0.192990, atol=1e-6)


def test_calculix_contact1():
    """Its two blocks in series, as stiff as M A/h: force 0.8310962, displacements -2.9399321e-6 and -2.9874144e-6.

    The load, 1, acts on the contact face of the upper block, whose other end is held; F = 0.2 exp(β d) on 0.2 × 0.2,
    β = log(100)/1.5351e-7.
    """
    material, sides = cd.Isotropic(2.1e5, 0.3), cd.Symmetry("left", "right")
    lower = cd.Body(
        "lower", cd.rectangle((0, -0.04), (0.2, 0), (4, 2)), material, supports=[sides, cd.Symmetry("bottom")]
    )
    upper = cd.Body(
        "upper",
        cd.rectangle((0, 0), (0.2, 0.2), (4, 4)),
        material,
        supports=[sides, cd.Symmetry("top")],
        loads=[cd.Traction("bottom", [0.0, -25.0])],
    )
    layer = cd.ExponentialLayer.calculix(p0=5.0, c0=1.5351e-7)
    scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), layer)])
    solution = cd.solve(scene, tolerance=1e-12)
    # As many digits as are given.
    assert 0.2 * solution.contact().force == pytest.approx(0.8310962, abs=5e-8)
    for body, exact in (("lower", -2.9399321e-6), ("upper", -2.9874144e-6)):
        vertical = solution.displacement(body).x.array.reshape(-1, 2)[:, 1]
        assert vertical.min() == pytest.approx(exact, abs=1e-13)


def test_rigid_sphere_on_an_elastic_foundation():
    """F = k π h² (3R - h) / 3, a rigid sphere's, exactly spherical gap; the error is that of the edge: second order."""
    R, h, k, errors = 10.0, 0.1, 3e3, []
    exact = k * math.pi * h**2 * (3 * R - h) / 3
    stiff = cd.Isotropic(1e15, 0.3)  # the bodies yield 1e-9 of the layer
    for cells in (20, 40, 80):
        lower = cd.Body(
            "foundation",
            cd.rectangle((0, -1), (2, 0), (cells, 2)),
            stiff,
            supports=[cd.Fixed("bottom"), cd.Symmetry("left")],
            kinematics="axisymmetric",
        )
        sphere = cd.Body(
            "sphere",
            cd.rectangle((0, 0), (2, 1), (cells, 2)),
            stiff,
            supports=[cd.Displacement("top", [0, -h]), cd.Symmetry("left")],
            kinematics="axisymmetric",
        )
        gap = lambda x: R - np.sqrt(R**2 - x[0] ** 2)  # noqa: E731
        layer = cd.LinearLayer(k)
        scene = cd.Scene([lower, sphere], [cd.Contact((lower, "top"), (sphere, "bottom"), layer, gap=gap)])
        errors.append(abs(cd.solve(scene).contact().force / exact - 1))
    assert max(errors) < 2e-3
    assert errors[-1] < 1e-4


@pytest.mark.parametrize(
    "module", ["custom", "exponential", "hyperbolic", "logarithmic", "rough", "series", "table", "varying"]
)
def test_docstring_examples(module):
    found = doctest.testmod(importlib.import_module(f"contactdd.layers.{module}"))
    assert found.attempted > 0
    assert found.failed == 0
