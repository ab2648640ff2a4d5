"""How the surface of an elastic half-space answers to pressures: influence functions in closed form.

u_n is counted into the body, positive under a pressure p; E* is the modulus of the surface, E/(1 − ν²), or E in plane
stress. All functions here are for E* = 1: u_n of a body is theirs over E*.
"""

from __future__ import annotations

import numpy as np
import scipy

from ..base.arrays import TINY, Floats


def line_load_hats(x: Floats, nodes: Floats, reference: float) -> Floats:
    """u_n at x (n,) of pressures that are linear between nodes (N,), 1 at one of them and 0 at all others, (n, N).

    Flamant's line load, (2/π) ln(reference / |x − s|) (Johnson, Contact Mechanics, §2.2): u_n is counted from the
    surface at the distance `reference` from a load.
    """
    t = x[:, None] - nodes
    first, second = _log_integral(t), _log_integral_twice(t)
    slopes = np.diff(second, axis=1) / np.diff(nodes)
    bent = np.diff(slopes, axis=1, prepend=0.0, append=0.0)
    bent[:, 0] = slopes[:, 0] + first[:, 0]
    bent[:, -1] = -slopes[:, -1] - first[:, -1]
    return (2 / np.pi) * (hat_areas(nodes) * np.log(reference) - bent)


def _log_integral(t: Floats) -> Floats:
    """∫₀ᵗ ln|s| ds."""
    return t * _log(t) - t


def _log_integral_twice(t: Floats) -> Floats:
    """∫₀ᵗ ∫₀ˢ ln|r| dr ds."""
    return 0.5 * t**2 * _log(t) - 0.75 * t**2


def _log(t: Floats) -> Floats:
    """ln|t|, 0 at 0, where it is only used times t."""
    return np.log(np.abs(np.where(t == 0.0, 1.0, t)))


def hat_areas(nodes: Floats) -> Floats:
    """∫ ψ_j ds of the functions that are linear between nodes (N,), (N,)."""
    steps = np.diff(nodes)
    return 0.5 * (np.append(steps, 0.0) + np.append(0.0, steps))


def hat_ring_areas(nodes: Floats) -> Floats:
    """∫ ψ_j 2πr dr of the functions that are linear between radii (N,), (N,)."""
    inner, outer = nodes[:-1], nodes[1:]
    step = np.pi * (outer - inner) / 3
    return np.append(step * (2 * inner + outer), 0.0) + np.append(0.0, step * (inner + 2 * outer))


def disc(r: Floats, radius: Floats) -> Floats:
    """u_n at r of the pressure 1 on a disc, r and radius of shapes that broadcast.

    (4/π) a E(r²/a²) inside, (4/π) r [E(a²/r²) − (1 − a²/r²) K(a²/r²)] outside (Johnson, §3.4(a)); E, K: complete
    elliptic integrals of these parameters.
    """
    large = np.maximum(r, radius)
    m = (np.minimum(r, radius) / large) ** 2
    rest = np.maximum(1.0 - m, TINY)
    first = scipy.special.ellipe(m)
    return (4 / np.pi) * large * np.where(r <= radius, first, first - rest * scipy.special.ellipkm1(rest))


def ring_hats(r: Floats, nodes: Floats) -> Floats:
    """u_n at r (n,) of pressures that are linear between radii (N,), 1 at one of them and 0 at all others, (n, N).

    A hat is the mean of discs that end in the interval outside of its node less that of those that end inside.
    """
    points, weights = np.polynomial.legendre.leggauss(DISCS)
    middles, halves = 0.5 * (nodes[1:] + nodes[:-1]), 0.5 * np.diff(nodes)
    means = sum(0.5 * w * disc(r[:, None], middles + p * halves) for p, w in zip(points, weights, strict=True))
    last = disc(r[:, None], nodes[-1:])
    return np.column_stack([means, last]) - np.column_stack([np.zeros((len(r), 1)), means])


#: Gauss points of the mean over discs that end in one interval.
DISCS = 6


def rectangle(x: Floats, y: Floats, dx: float, dy: float) -> Floats:
    """u_n at the distances x, y from the middle of a rectangle dx × dy with the pressure 1 on it.

    Love's formula (Johnson, §3.2(c)), here as the second difference of ξ arsinh(η/|ξ|) + η arsinh(ξ/|η|) over π.
    """
    a, b = 0.5 * dx, 0.5 * dy
    corners = _corner(x + a, y + b) - _corner(x - a, y + b) - _corner(x + a, y - b) + _corner(x - a, y - b)
    return np.asarray(corners / np.pi, dtype=float)


def _corner(x: Floats, y: Floats) -> Floats:
    return _arsinh_part(x, y) + _arsinh_part(y, x)


def _arsinh_part(x: Floats, y: Floats) -> Floats:
    """x arsinh(y/|x|), 0 at x = 0."""
    away = np.where(x == 0.0, 1.0, np.abs(x))
    return x * np.arcsinh(y / away)


def half_plane_wave(k: Floats) -> Floats:
    """u_n of a pressure cos kx on the half-plane: 2/k, k > 0."""
    return 2 / k


def sliding_strip_wave(k: Floats, thickness: float) -> Floats:
    """u_n of a pressure cos kx on a strip that slides on a rigid base without friction (its thickness at k = 0).

    (2/k) (cosh 2ξ − 1)/(sinh 2ξ + 2ξ), ξ = k · thickness.
    """
    xi = _within(k * thickness)
    sliding = 2 * np.sinh(xi) ** 2 / (np.sinh(2 * xi) + 2 * xi)
    return (2 * thickness / xi) * sliding * _beyond(k * thickness)


def bonded_strip_wave(k: Floats, thickness: float, kappa: float) -> Floats:
    """u_n of a pressure cos kx on a strip that is bonded to a rigid base; κ = 3 − 4ν, (3 − ν)/(1 + ν) in plane stress.

    (2/k) (κ sinh 2ξ − 2ξ)/(κ cosh 2ξ + 2ξ² + (1 + κ²)/2), ξ = k · thickness.
    """
    xi = _within(k * thickness)
    below = kappa * np.cosh(2 * xi) + 2 * xi**2 + 0.5 * (1 + kappa**2)
    return (2 * thickness / xi) * (kappa * np.sinh(2 * xi) - 2 * xi) / below * _beyond(k * thickness)


#: Below the first ξ a strip is as stiff as at k = 0, above the second as the half-plane, both to rounding.
THIN, THICK = 1e-5, 100.0


def _within(xi: Floats) -> Floats:
    """ξ where the hyperbolic functions can be evaluated."""
    return np.clip(xi, THIN, THICK)


def _beyond(xi: Floats) -> Floats:
    """What u_n of a strip as thick as THICK is times for a larger ξ."""
    return THICK / np.maximum(xi, THICK)
