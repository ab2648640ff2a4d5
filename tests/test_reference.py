"""The reference solutions: their defining equations, limits, balances of energy, and published numbers."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad, trapezoid

from contactdd import CustomLayer
from contactdd.layer import LinearLayer, PowerLayer
from contactdd.reference import (
    column_stack,
    groove,
    groove_half_planes,
    hertz_cylinder,
    hertz_sphere,
    rigid_parabola_on_layer,
    surface_compliance,
    uniform_compression,
)

# ------------------------------------------------------------------------------ uniform compression


def test_uniform_compression_adds_up():
    known = uniform_compression(q=10.0, h=1.0, E=2.1e5, nu=0.3, B=4e-6, a=1.1)
    # Single rounded formulas.
    assert known.compression == pytest.approx(-4e-6 * 10**1.1, rel=1e-14)
    assert known.shortening == pytest.approx(10 * 1.3 * 0.4 / (2.1e5 * 0.7), rel=1e-14)
    assert known.approach == pytest.approx(2 * known.shortening - known.compression, rel=1e-14)


# --------------------------------------------------------------------------------------- the groove


@pytest.mark.parametrize(
    ("quantity", "expected"),
    [
        ("peak_pressure", 23.45244),
        ("contact_edge", 0.510971),
        ("elastic_energy", 2.087910e-3),
        ("layer_energy", 1.403414e-3),
    ],
)
def test_groove_of_the_paper(quantity, expected):
    # From an independent computation that gives seven digits.
    assert getattr(groove(), quantity) == pytest.approx(expected, rel=1e-6)


def test_groove_of_the_paper_pointwise():
    solution = groove()
    assert solution.pressure(4.0) == pytest.approx(9.742620, rel=1e-6)
    # The peak is flat: the place where it lies is known to half as many digits as its height.
    assert solution.peak_x == pytest.approx(0.98513, abs=2e-5)


def test_groove_carries_the_load_and_touches_where_it_presses():
    solution = groove()
    x = np.linspace(0, 4, 40001)
    pressure, gap = solution.pressure(x), solution.gap(x)
    # Trapezoidal rule, step 1e-4, with a kink at the edge of contact: 1e-4 squared.
    assert trapezoid(pressure, x) / 4 == pytest.approx(10.0, rel=1e-7)
    assert np.array_equal(pressure > 0, gap < 0)
    assert np.array_equal(pressure > 0, x > solution.contact_edge)
    assert abs(solution.gap(solution.contact_edge)) < 1e-15
    assert pressure.max() <= solution.peak_pressure * (1 + 1e-12)


def test_groove_converges_at_the_rate_of_its_singularity():
    octaves = 2 ** np.arange(6, 13)
    exact = groove(points=2**16).layer_energy

    def worst_error(n):
        # How the contact edge falls between two points moves single errors by a factor of ten.
        return max(abs(groove(points=int(n * f)).layer_energy - exact) for f in (1, 1.1, 1.25, 1.4, 1.6, 1.8))

    errors = [worst_error(n) for n in octaves]
    rate = -np.polyfit(np.log(octaves), np.log(errors), 1)[0]
    # 1 + 1/a = 1.91 for a pressure that leaves the edge like a power 1/a; 1.80 is measured.
    assert rate > 1.6
    assert errors[-1] < 1e-6 * exact


def test_groove_stores_the_work_of_the_load():
    # d(elastic + layer energy) = q length d(approach). Central differences with the step 1 % are good to its
    # square; the collocation's error, 1e-8 over the step, is below that.
    low, high = groove(q=9.9), groove(q=10.1)
    stored = high.elastic_energy + high.layer_energy - low.elastic_energy - low.layer_energy
    assert stored == pytest.approx(10 * 4 * (high.approach - low.approach), rel=1e-4)


def test_shallow_groove_is_uniform_compression():
    shallow = groove(r0=1e-9, points=256)
    flat = uniform_compression(q=10.0, h=1.0, E=2.1e5, nu=0.3, B=4e-6, a=1.1)
    # The groove is 2e-5 of the layer's compression, and shifts the mean approach by its own mean depth.
    assert shallow.approach == pytest.approx(flat.approach, abs=1e-9)
    assert shallow.contact_edge == 0
    np.testing.assert_allclose(shallow.pressure(np.linspace(0, 4, 9)), 10.0, rtol=1e-3)


@pytest.mark.parametrize("q", [10.0, 60.0], ids=["open", "closed"])
def test_hard_layer_and_large_bodies_tend_to_half_planes(q):
    bodies, half_planes = groove(length=20.0, height=20.0, B=4e-9, a=1.0, q=q), groove_half_planes(q=q)
    # The layer takes B q / r0 = 1e-4 to 5e-4 of the closing, the neighbours at the distance 2 length add
    # (b/length)² = 2.5e-3. Points next to a* = 0.877 and b are left out: the pressure has corners there.
    x = np.array([0.1, 0.5, 0.7, 0.95, 1.1, 1.5, 3.0])
    np.testing.assert_allclose(bodies.pressure(x), half_planes.pressure(x), rtol=5e-3)
    np.testing.assert_allclose(np.maximum(bodies.gap(x), 0), half_planes.gap(x), atol=2e-3 * 5e-4)


@pytest.mark.parametrize(
    "data",
    [
        {"a": 0.3},
        {"a": 10.0},
        {"a": 3.0, "B": 1e-7},
        {"B": 4e-10},
        {"E": 1.0},
        {"E": 1e9},
        {"q": 1e-6},
        {"q": 1e6},
    ],
    ids=str,
)
def test_groove_is_found_far_from_the_papers_data(data):
    solution = groove(points=2**10, **data)
    q = data.get("q", 10.0)
    x = (np.arange(2**10) + 0.5) * 4 / 2**10
    # In the collocation points the pressures balance the load to the iteration's tolerance, 1e-7 at worst.
    assert solution.pressure(x).mean() == pytest.approx(q, rel=1e-6)


@pytest.mark.parametrize("kh", [0.05, 0.5, 2.0, 30.0, 400.0])
def test_surface_compliance_in_50_digits(kh):
    with mpmath.workdps(400):
        k, s, c = mpmath.mpf(kh), mpmath.sinh(kh), mpmath.cosh(kh)
        exact = float(2 * (1 - mpmath.mpf(0.3) ** 2) / (7 * k) * (s * c + k) / (s**2 - k**2))
    # The smallest kh loses kh³/3 = 4e-5 of sixteen digits.
    assert float(surface_compliance(kh, height=1.0, E=7.0, nu=0.3)) == pytest.approx(exact, rel=1e-11)


def test_surface_compliance_between_plate_and_half_plane():
    thick = surface_compliance(1e4, height=1.0, E=2.0, nu=0.25)
    thin = surface_compliance(0.1, height=0.1, E=2.0, nu=0.25)
    assert thick == pytest.approx(2 * (1 - 0.25**2) / (2 * 1e4), rel=1e-14)
    # Shear adds (κh)² = 1e-4 to the plate's bending.
    assert thin == pytest.approx(12 * (1 - 0.25**2) / (2 * 0.1**4 * 0.1**3), rel=2e-4)


# ----------------------------------------------------------------- the groove between half-planes


def test_half_planes_of_the_paper():
    known = groove_half_planes(q=10.0)
    assert known.closing_pressure == pytest.approx(43.27, abs=5e-3)  # the four digits of the model's page
    assert known.open_half_width == pytest.approx(math.sqrt(1 - 10 / known.closing_pressure), rel=1e-14)
    assert not known.closed
    assert known.gap(0.0) == pytest.approx(5e-4 * known.open_half_width**3, rel=1e-14)


def test_half_planes_close_at_the_closing_pressure():
    q_c = groove_half_planes().closing_pressure
    assert groove_half_planes(q=q_c).closed
    assert groove_half_planes(q=2 * q_c).gap(0.0) == 0
    # From below, the pressure tends to that of the closed groove as a*² = 1e-8 does; the gap as a*³.
    almost, closed = groove_half_planes(q=q_c * (1 - 1e-8)), groove_half_planes(q=q_c)
    x = np.array([0.01, 0.3, 0.99, 1.0, 1.01, 5.0])
    np.testing.assert_allclose(almost.pressure(x), closed.pressure(x), rtol=1e-4, atol=1e-6)
    assert almost.gap(0.0) < 1e-15


def test_closed_half_planes_press_as_in_the_model():
    known = groove_half_planes(q=60.0)
    x = np.linspace(-1, 1, 21)
    modulus = 2.1e5 / (2 * (1 - 0.3**2))
    np.testing.assert_allclose(known.pressure(x), 60 - 1.5 * modulus * 5e-4 * (0.5 - x**2), rtol=1e-13)


@pytest.mark.parametrize("q", [10.0, 60.0], ids=["open", "closed"])
def test_half_planes_bulge_into_the_groove(q):
    # Johnson, Contact Mechanics, ch. 2: the faces together have the slope -(2/πE*) PV∫ (p(s)-q)/(x-s) ds.
    # It is h' - d', h the gap.
    known, x, modulus = groove_half_planes(q=q), 0.95, 2.1e5 / (2 * (1 - 0.3**2))
    far, ends = 400.0, [-1.0, -known.open_half_width, known.open_half_width, 1.0]

    def deviation(s):
        return float(known.pressure(s)) - q

    near = quad(deviation, 0.9, 1.0, weight="cauchy", wvar=x, epsabs=1e-9)[0]
    pieces = np.unique([-far, -10.0, *ends, 0.9, 10.0, far])
    rest = sum(
        quad(lambda s: deviation(s) / (s - x), low, high, epsabs=1e-9, limit=200)[0]
        for low, high in pairwise(pieces)
        if not 0.9 <= low < 1
    )
    slope = 2 / (math.pi * modulus) * (near + rest)
    groove_slope = -3 * 5e-4 * x * math.sqrt(1 - x**2)
    # The quadrature's 1e-9 and what lies beyond `far`.
    assert slope == pytest.approx(-groove_slope, rel=1e-6)


# -------------------------------------------------------------------------------------------- Hertz


def test_nafems_cylinder_on_block():
    known = hertz_cylinder(35e3, R1=50.0, E1=210e3, nu1=0.3, E2=70e3, nu2=0.3)
    # NAFEMS gives three and four digits.
    assert known.half_width == pytest.approx(6.21, abs=5e-3)
    assert known.peak_pressure == pytest.approx(3585, abs=0.5)


def test_published_spheres():
    modulus = 20000 / (2 * (1 - 0.3**2))
    force = 4 / 3 * modulus * math.sqrt(25) * 4**1.5
    known = hertz_sphere(force, R1=50.0, E1=20000.0, nu1=0.3, R2=50.0, E2=20000.0, nu2=0.3)
    # Approach 4, radius 10 and peak 2798 are quoted with four digits.
    assert known.approach == pytest.approx(4.0, rel=1e-13)
    assert known.radius == pytest.approx(10.0, rel=1e-13)
    assert known.peak_pressure == pytest.approx(2798, abs=0.5)


def test_hertz_pressures_carry_the_load():
    cylinder = hertz_cylinder(7.0, R1=3.0, E1=100.0, nu1=0.3, R2=5.0, E2=40.0, nu2=0.1)
    sphere = hertz_sphere(7.0, R1=3.0, E1=100.0, nu1=0.3, R2=5.0, E2=40.0, nu2=0.1)
    # quad's default accuracy.
    width, radius = cylinder.half_width, sphere.radius
    assert quad(cylinder.pressure, -width, width)[0] == pytest.approx(7.0, rel=1e-7)
    assert quad(lambda r: 2 * math.pi * r * sphere.pressure(r), 0, radius)[0] == pytest.approx(7.0, rel=1e-7)
    assert np.array_equal(cylinder.pressure([-2 * width, 2 * width]), [0, 0])


def test_hertz_sphere_stores_the_work_of_the_force():
    # Force = k approach^(3/2): the work, force integrated over approach, is 2/5 of their product.
    forces = np.linspace(0, 7, 2001)[1:]
    spheres = [hertz_sphere(force, R1=3.0, E1=100.0, nu1=0.3) for force in forces]
    approaches = np.array([0, *(sphere.approach for sphere in spheres)])
    work = trapezoid(np.append(0, forces), approaches)
    # Trapezoidal rule with 2000 steps.
    assert work == pytest.approx(0.4 * 7 * approaches[-1], rel=1e-4)


@given(load=st.floats(1e-3, 1e3), R=st.floats(0.1, 100), E=st.floats(1, 1e6), nu=st.floats(0, 0.49))
def test_hertz_inverse_relations(load, R, E, nu):
    cylinder, sphere = hertz_cylinder(load, R, E, nu), hertz_sphere(load, R, E, nu)
    modulus = E / (1 - nu**2)
    # A dozen rounded operations.
    assert cylinder.half_width == pytest.approx(2 * cylinder.peak_pressure * R / modulus, rel=1e-13)
    assert sphere.radius == pytest.approx(math.pi * sphere.peak_pressure * R / (2 * modulus), rel=1e-13)
    assert load == pytest.approx(4 / 3 * modulus * math.sqrt(R) * sphere.approach**1.5, rel=1e-13)


def test_hertz_does_not_know_which_body_is_first():
    forward = hertz_sphere(7.0, R1=3.0, E1=100.0, nu1=0.3, R2=5.0, E2=40.0, nu2=0.1)
    backward = hertz_sphere(7.0, R1=5.0, E1=40.0, nu1=0.1, R2=3.0, E2=100.0, nu2=0.3)
    assert forward.radius == pytest.approx(backward.radius, rel=1e-14)


# ---------------------------------------------------------------------------------- scalar problems


@settings(deadline=None)
@given(
    closure=st.floats(-8, 1).map(lambda exponent: 10.0**exponent),
    B=st.floats(-9, -1).map(lambda exponent: 10.0**exponent),
    a=st.floats(0.3, 10),
)
def test_column_stack_closes(closure, B, a):
    layers = [PowerLayer(B, a), LinearLayer(1e4)]
    known = column_stack([1.0, 2.0, 0.5], [2e5, 1e5, 3e4], layers, [0.0, 0.25 * closure], closure)
    total = sum(known.shortenings) - sum(known.compressions) + 0.25 * closure
    # The root is polished to rounding; |w| = B p^a turns an ulp of p ≤ 1e6 into ten.
    assert total == pytest.approx(closure, rel=1e-14)
    assert known.pressure > 0


def test_column_stack_stays_open():
    known = column_stack([1.0, 1.0], [1.0, 1.0], [LinearLayer(1.0)], [0.5], closure=0.5)
    assert known.pressure == 0
    assert known.compressions == (0,)


def test_column_stack_takes_any_layer():
    linear = column_stack([1.0, 1.0], [2.0, 2.0], [LinearLayer(1.0)], [0.0], closure=0.5)
    custom = column_stack([1.0, 1.0], [2.0, 2.0], [CustomLayer(lambda w: w)], [0.0], closure=0.5)
    assert linear.pressure == pytest.approx(0.25, rel=1e-15)
    # Limited by the differences that stand in for the derivative, which only polishes.
    assert custom.pressure == pytest.approx(0.25, rel=1e-15)


@given(approach=st.floats(1e-3, 1e3), R=st.floats(0.1, 100), B=st.floats(1e-3, 1), a=st.floats(0.5, 5))
@settings(deadline=None, max_examples=50)
def test_parabola_carries_what_its_pressure_adds_up_to(approach, R, B, a):
    plane = rigid_parabola_on_layer(approach, R, B, a)
    round_one = rigid_parabola_on_layer(approach, R, B, a, axisymmetric=True)
    width = plane.half_width
    # With x = width sin t the integrand is smooth but for its power at the end; quad's accuracy.
    # Forces may be below 1e-8, quad's default absolute accuracy: only the relative one counts.
    ends = -math.pi / 2, math.pi / 2
    force = quad(lambda t: plane.pressure(width * math.sin(t)) * width * math.cos(t), *ends, epsabs=0)[0]
    assert plane.force == pytest.approx(force, rel=1e-7)
    force = quad(lambda r: 2 * math.pi * r * round_one.pressure(r), 0, width, epsabs=0)[0]
    assert round_one.force == pytest.approx(force, rel=1e-6)
    assert plane.peak_pressure == pytest.approx(float(plane.pressure(0.0)), rel=1e-14)  # powers differ by ulps


# ---------------------------------------------------------------------------------- wrong arguments

REFUSED = [
    (lambda: uniform_compression(-1.0, 1.0, 1.0, 0.3, 1.0, 1.0), ValueError, r"q = -1\.0: expected"),
    (lambda: groove(nu=0.5), ValueError, r"nu = 0\.5: expected a Poisson's ratio"),
    (lambda: groove(B=0.0), ValueError, r"B = 0\.0: expected"),
    (lambda: groove(points=1), ValueError, r"points = 1: expected"),
    (lambda: groove(height="tall"), TypeError, r"height = 'tall': expected"),
    (lambda: groove().gap(5.0), ValueError, r"expected points in \[0, 4\.0\]"),
    (lambda: surface_compliance(0.0, 1.0, 1.0, 0.3), ValueError, r"wavenumber = .*: expected"),
    (lambda: groove_half_planes(E=-1.0), ValueError, r"E = -1\.0: expected"),
    (lambda: hertz_cylinder(1.0, R1=0.0, E1=1.0, nu1=0.3), ValueError, r"R1 = 0\.0: expected"),
    (lambda: hertz_sphere(1.0, R1=1.0, E1=1.0, nu1=0.7), ValueError, r"nu1 = 0\.7: expected"),
    (lambda: hertz_sphere(1.0, 1.0, 1.0, 0.3, R2=-math.inf), ValueError, r"R2 = -inf: expected"),
    (lambda: column_stack([1.0], [1.0], [LinearLayer(1.0)], [], 1.0), ValueError, r"layers = .*: expected 0"),
    (lambda: column_stack([1.0, 1.0], [1.0, 1.0], [3], [0.0], 1.0), TypeError, r"layers\[0\] = 3: expected"),
    (
        lambda: column_stack([1.0, -1.0], [1.0, 1.0], [], [], 1.0),
        ValueError,
        r"heights\[1\] = -1\.0: expected",
    ),
    (lambda: rigid_parabola_on_layer(0.0, 1.0, 1.0, 1.0), ValueError, r"approach = 0\.0: expected"),
]


@pytest.mark.parametrize(("build", "error", "message"), REFUSED)
def test_wrong_arguments_are_refused_by_name(build, error, message):
    with pytest.raises(error, match=message):
        build()


def test_solutions_are_values():
    assert replace(groove_half_planes(), q=10.0) == groove_half_planes()
    assert groove() is groove()
