"""Layer laws: against 50-digit arithmetic where rounding matters, against each other elsewhere."""

from __future__ import annotations

import doctest

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contactdd import CustomLayer, TableLayer
from contactdd import layer as layer_module
from contactdd.layer import LinearLayer, PowerLayer

mpmath.mp.dps = 50


def cubic(w):
    return w + w**3


def cubic_derivative(w):
    return 1 + 3 * w**2


LAYERS = {
    "paper": PowerLayer(B=4e-6, a=1.1),
    "stiffening": PowerLayer(B=0.1, a=0.4),
    "linear": LinearLayer(stiffness=3e5),
    "custom": CustomLayer(cubic),
    "custom, all given": CustomLayer(
        cubic,
        derivative=cubic_derivative,
        energy=lambda w: w**2 / 2 + w**4 / 4,
        inverse=lambda s: np.array([np.roots([1, 0, 1, -v])[-1].real for v in np.ravel(s)]).reshape(np.shape(s)),
    ),
    "table": TableLayer([0.2, 0.5, 1.5], [1.0, 4.0, 40.0]),
}
every_layer = pytest.mark.parametrize("layer", LAYERS.values(), ids=LAYERS.keys())


def decades(low, high):
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


@st.composite
def pairs(draw, low=-30, high=3):
    """y, z in many decades: unrelated, close down to the last bits, equal, across the kink, at 0."""
    y = -draw(decades(low, high))
    kind = draw(st.sampled_from(["unrelated", "close", "equal", "across", "zero"]))
    if kind == "close":
        return y, y * (1 - draw(decades(-16.5, -0.01)))
    return y, {
        "unrelated": -draw(decades(low, high)),
        "equal": y,
        "across": draw(decades(low, high)),
        "zero": 0.0,
    }[kind]


def exact_quotient(g, derivative, y, z):
    """[g⁻(y) - g⁻(z)] / (y - z) in 50 digits; `g`, `derivative` for arguments < 0."""
    y, z = mpmath.mpf(y), mpmath.mpf(z)
    if y == z:
        return derivative(y) if y < 0 else mpmath.mpf(0)
    return ((g(y) if y < 0 else 0) - (g(z) if z < 0 else 0)) / (y - z)


def relative_error(value, exact):
    return abs(float((mpmath.mpf(float(value)) - exact) / exact)) if exact else abs(float(value))


# 1/a rounds by half an ulp, which |w/B|^(1/a) multiplies by log|w/B| / a: with the extremes below,
# 1e-16 · 103 / 0.3 = 4e-14. The operations add a few ulps: 1e-13 in all.
POWER_TOLERANCE = 1e-13


@settings(max_examples=1000, deadline=None)
@given(pair=pairs(), B=decades(-12, 3), a=st.floats(0.3, 10))
def test_divided_difference_of_power_law_in_50_digits(pair, B, a):
    y, z = pair
    exponent = 1 / mpmath.mpf(a)
    exact = exact_quotient(
        lambda w: -((-w / mpmath.mpf(B)) ** exponent),
        lambda w: (-w / mpmath.mpf(B)) ** exponent * exponent / -w,
        y,
        z,
    )
    computed = PowerLayer(B, a).divided_difference(y, z)
    assert relative_error(computed, exact) < POWER_TOLERANCE


@settings(max_examples=300, deadline=None)
@given(pair=pairs(), stiffness=decades(-6, 12))
def test_divided_difference_of_linear_law_in_50_digits(pair, stiffness):
    exact = exact_quotient(lambda w: mpmath.mpf(stiffness) * w, lambda w: mpmath.mpf(stiffness), *pair)
    # Three rounded operations.
    assert relative_error(LinearLayer(stiffness).divided_difference(*pair), exact) < 1e-15


# Below a relative distance of 0.1 a Gauss mean of the derivative; above, the quotient loses a digit.
@settings(max_examples=500, deadline=None)
@given(pair=pairs(low=-9, high=2))
def test_divided_difference_of_custom_law_in_50_digits(pair):
    layer = LAYERS["custom, all given"]
    exact = exact_quotient(cubic, cubic_derivative, *pair)
    assert relative_error(layer.divided_difference(*pair), exact) < 1e-13


@settings(max_examples=500, deadline=None)
@given(pair=pairs(low=-6, high=-0.302))
def test_divided_difference_of_a_locking_law(pair):
    # g = w/(1 + w) has a pole at w = -1. Up to w = -1/2 the rounding of 1 + w costs one bit.
    locking = CustomLayer(lambda w: w / (1 + w), derivative=lambda w: 1 / (1 + w) ** 2, compression_range=0.5)
    exact = exact_quotient(lambda w: w / (1 + w), lambda w: 1 / (1 + w) ** 2, *pair)
    assert relative_error(locking.divided_difference(*pair), exact) < 1e-13


def test_custom_law_without_derivative_keeps_the_digits_of_its_differences():
    # Eighth-order differences of a function known to 1e-16 with the step 1/64: 1e-16 · 64 · a few.
    y = -np.logspace(-9, 1, 101)
    for distance in (0.0, 1e-15, 1e-9, 1e-4, 0.05, 0.5):
        z = y * (1 - distance)
        exact = 1 + y**2 + y * z + z**2
        np.testing.assert_allclose(LAYERS["custom"].divided_difference(y, z), exact, rtol=1e-12)


@settings(max_examples=500, deadline=None)
@given(pair=pairs(low=-9, high=1))
def test_divided_difference_of_table_is_the_mean_of_its_slope(pair):
    layer = LAYERS["table"]
    y, z = min(pair), max(pair)
    quotient = float(layer.divided_difference(y, z))
    if z >= 0 or z - y > 0.1 * -y:
        plain = float(layer.contact_stress(y) - layer.contact_stress(z)) / (y - z)
        # The plain quotient itself loses two digits at the distance 0.1 where the law is flat.
        assert quotient == pytest.approx(plain, rel=1e-13)
    elif y == z:
        assert quotient == pytest.approx(float(layer.contact_derivative(y)), rel=1e-13)
    else:
        # Close points, where the plain quotient is useless. Simpson's rule is exact for the quadratic slope.
        knots = [-c for c in layer.compressions if y < -c < z]
        ends = np.sort([y, *knots, z])
        low, high = ends[:-1], ends[1:]
        # One-sided slopes, and they agree: the law is C¹.
        slopes = layer.derivative([low, (low + high) / 2, high])
        mean = np.sum((high - low) * (np.array([1, 4, 1]) / 6 @ slopes)) / np.sum(high - low)
        assert quotient == pytest.approx(mean, rel=1e-13)


@every_layer
@settings(max_examples=100, deadline=None)
@given(pair=pairs(low=-9, high=1))
def test_divided_difference_is_symmetric_and_not_negative(layer, pair):
    forward, backward = layer.divided_difference(*pair), layer.divided_difference(*pair[::-1])
    assert forward == backward
    assert forward >= 0


@every_layer
def test_divided_difference_at_one_point_is_the_contact_derivative(layer):
    z = np.concatenate((-np.logspace(-9, 1, 41), [0.0, 1e-9, 1.0]))
    # The custom law averages eight equal slopes.
    np.testing.assert_allclose(layer.divided_difference(z, z), layer.contact_derivative(z), rtol=1e-13)


@every_layer
def test_contact_stress_is_the_law_in_compression_and_nothing_beyond(layer):
    z = np.array([-2.0, -1e-6, 0.0, 1e-6, 2.0])
    assert np.array_equal(layer.contact_stress(z)[:2], layer.stress(z)[:2])
    assert np.array_equal(layer.contact_stress(z)[2:], [0, 0, 0])
    assert np.array_equal(layer.contact_derivative(z)[2:], [0, 0, 0])
    assert np.array_equal(layer.energy(z)[2:], [0, 0, 0])


@every_layer
def test_law_is_odd_and_increases_through_zero(layer):
    w = np.logspace(-9, 1, 201)
    assert layer.stress(0.0) == 0
    assert np.array_equal(layer.stress(w), -layer.stress(-w))
    assert np.all(np.diff(layer.stress(-w)) < 0)
    assert np.all(layer.derivative(w) > 0)


@every_layer
def test_derivative_by_central_differences(layer):
    w = -np.logspace(-4, 0.5, 46)
    h = 1e-5 * -w
    quotient = (layer.stress(w + h) - layer.stress(w - h)) / (2 * h)
    # Truncation (1e-5)², rounding 1e-11; at a knot of the table the second derivative's jump times 1e-5.
    np.testing.assert_allclose(layer.derivative(w), quotient, rtol=2e-5 if layer is LAYERS["table"] else 1e-8)


@every_layer
def test_energy_is_the_integral_of_the_contact_stress(layer):
    z = np.concatenate((-np.logspace(-4, 0.5, 46), [0.3, 2.0]))
    h = 1e-5 * np.abs(z)
    slope = (layer.energy(z + h) - layer.energy(z - h)) / (2 * h)
    assert np.all(layer.energy(z[:-2]) > 0)
    # Truncation (1e-5)² relative; rounding 1e-16 / 1e-5 times the ratio of energy to its change.
    np.testing.assert_allclose(slope, layer.contact_stress(z), rtol=1e-8)
    assert layer.energy(-1e-150) == pytest.approx(0, abs=1e-140)


@every_layer
def test_compression_inverts_the_law(layer):
    w = -np.logspace(-8, 1, 91)
    # Two powers or a bisection to the last bits; numpy.roots of the cubic is as good.
    np.testing.assert_allclose(layer.compression(layer.stress(w)), w, rtol=1e-12)
    assert layer.compression(0.0) == 0


@every_layer
def test_shapes_scalars_and_nan(layer):
    for method in (
        layer.stress,
        layer.derivative,
        layer.contact_stress,
        layer.contact_derivative,
        layer.energy,
    ):
        assert isinstance(method(-0.5), np.ndarray)
        assert method(-0.5).shape == ()
        assert method([[-1, 0, 1]]).shape == (1, 3)
        assert method(np.empty((0, 2))).shape == (0, 2)
        assert np.isnan(method(np.nan))
    assert layer.compression([[-1.0, -2.0]]).shape == (1, 2)
    assert layer.divided_difference([[-1.0], [2.0]], [-1.0, 0.0, 3.0]).shape == (2, 3)
    assert np.isnan(layer.divided_difference([np.nan, -1.0, 1.0], [-1.0, np.nan, np.nan])).all()


def test_slope_of_power_law_at_zero():
    assert PowerLayer(2.0, 1.5).derivative(0.0) == np.inf
    assert PowerLayer(2.0, 1.0).derivative(0.0) == 0.5
    assert PowerLayer(2.0, 0.5).derivative(0.0) == 0.0
    # χ(0) = 0 keeps the infinite slope out of every scheme.
    assert PowerLayer(2.0, 1.5).contact_derivative(0.0) == 0.0


def test_power_law_goes_through_the_extremes_of_double_precision():
    layer = PowerLayer(1e-3, 1.1)
    z = -np.array([1e300, 1.0, 1e-300, 5e-324])
    with np.errstate(all="raise", under="ignore"):
        assert np.all(np.isfinite(layer.contact_stress(z)))
        assert np.all(np.isfinite(layer.divided_difference(z[:, None], z[:3])))


def test_custom_law_agrees_with_the_power_law_it_copies():
    exact = PowerLayer(1e-3, 1.1)
    custom = CustomLayer(lambda w: -((-w / 1e-3) ** (1 / 1.1)))
    z = -np.logspace(-10, 1, 111)
    # Tanh-sinh integrates the singular slope at 0 to rounding; differences carry 1e-16 · 64 · a few.
    # Ten times the stress lies beyond the range that was announced.
    beyond = 10 * exact.stress(z)
    np.testing.assert_allclose(custom.energy(z), exact.energy(z), rtol=1e-13)
    np.testing.assert_allclose(custom.derivative(z), exact.derivative(z), rtol=1e-12)
    np.testing.assert_allclose(custom.compression(beyond), exact.compression(beyond), rtol=1e-13)


def test_derivative_is_found_close_to_a_pole():
    locking = CustomLayer(lambda w: w / (1 + w), compression_range=0.9999)
    w = -np.linspace(0.5, 0.9999, 50)
    # 1 + w has lost four digits next to the pole.
    np.testing.assert_allclose(locking.derivative(w), 1 / (1 + w) ** 2, rtol=1e-10)


def test_table_goes_through_its_points_and_on_straight():
    table = TableLayer([1.0, 2.0, 4.0], [1.0, 5.0, 6.0])
    np.testing.assert_allclose(table.stress([-1.0, -2.0, -4.0]), [-1.0, -5.0, -6.0], rtol=1e-15)
    end_slope = table.derivative(-4.0)
    assert end_slope > 0
    np.testing.assert_allclose(table.stress([-5.0, -9.0]), [-6 - end_slope, -6 - 5 * end_slope], rtol=1e-15)
    assert table == TableLayer([0.0, 1.0, 2.0, 4.0], [0.0, 1.0, 5.0, 6.0])


def test_table_of_one_point_is_linear():
    w = np.linspace(-3, 3, 13)
    np.testing.assert_allclose(TableLayer([0.5], [2.0]).stress(w), LinearLayer(4.0).stress(w), rtol=1e-15)


def test_table_that_saturates_still_increases():
    # PCHIP alone would end with slope 0 here.
    table = TableLayer([1.0, 2.0, 3.0], [10.0, 19.0, 19.1])
    assert np.all(np.diff(table.stress(np.linspace(-10, 0, 1001))) > 0)


REFUSED = [
    (lambda: PowerLayer(-1.0, 1.1), ValueError, r"B = -1\.0: expected"),
    (lambda: PowerLayer(1.0, 0.0), ValueError, r"a = 0\.0: expected"),
    (lambda: PowerLayer("soft", 1.0), TypeError, r"B = 'soft': expected"),
    (lambda: LinearLayer(np.inf), ValueError, r"stiffness = inf: expected"),
    (lambda: LinearLayer(1.0).compression([-1.0, 2.0]), ValueError, r"stress = 2: expected stress <= 0"),
    (lambda: CustomLayer(3.0), TypeError, r"g = 3\.0: expected a function"),
    (lambda: CustomLayer(cubic, inverse=1), TypeError, r"inverse = 1: expected a function"),
    (lambda: CustomLayer(cubic, compression_range=0), ValueError, r"compression_range = 0: expected"),
    (
        lambda: CustomLayer(np.sin, compression_range=9.0),
        ValueError,
        r"expected finite and strictly increasing",
    ),
    (lambda: CustomLayer(np.cos), ValueError, r"g\(0\) = 1, expected g\(0\) = 0"),
    (lambda: CustomLayer(lambda w: 1.0), ValueError, r"maps shape \(302,\) to \(\)"),
    (
        lambda: CustomLayer(cubic, derivative=lambda w: -cubic_derivative(w)),
        ValueError,
        r"derivative: -4 .*expected 4",
    ),
    (lambda: CustomLayer(cubic, energy=lambda w: -(w**2)), ValueError, r"energy: -1 .*expected 0\.75"),
    (lambda: CustomLayer(cubic, inverse=lambda s: -s), ValueError, r"inverse: 2 .*expected -1"),
    (lambda: CustomLayer(np.tanh).compression(-2.0), ValueError, r"stress = -2: expected a stress that"),
    (
        lambda: TableLayer([1.0, 2.0], [2.0, 1.0]),
        ValueError,
        r"pressures = \[0\.0, 2\.0, 1\.0\]: expected strictly",
    ),
    (lambda: TableLayer([-1.0, 2.0], [1.0, 2.0]), ValueError, r"compressions = .*: expected strictly"),
    (lambda: TableLayer([1.0, 2.0], [1.0]), ValueError, r"pressures: 1 values, expected 2"),
    (lambda: TableLayer([0.0], [0.0]), ValueError, r"expected a point beside \(0, 0\)"),
    (lambda: TableLayer(["x"], [1.0]), ValueError, r"compressions = \['x'\]: expected a non-empty sequence"),
]


@pytest.mark.parametrize(("build", "error", "message"), REFUSED)
def test_wrong_arguments_are_refused_by_name(build, error, message):
    with pytest.raises(error, match=message):
        build()


def test_docstring_examples():
    assert doctest.testmod(layer_module).failed == 0
