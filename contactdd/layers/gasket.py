"""Gaskets: a law of loading, and one of unloading from the largest closure that each place has seen.

A place that was closed up to c_m unloads from (c_m, p_m) along a curve of its own, p = p_m f(s) with
s = (c − c_r)/(c_m − c_r), and is open where it is closed less than its set c_r. It takes load again along the same
curve, and from c_m on along the curve of loading. With c_m held over a step the law is like any other, so the energy is
convex; c_m grows between steps. The closure c counts from the first touch, and the gap z of the law from the set.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import TINY, Floats
from ..base.checks import as_floats, positive
from ..layer import Layer

#: By how much of its largest pressure a curve of unloading may lie above the one of loading, as measured ones do.
ABOVE = 0.01

#: Closures at which that is looked at, between those of two curves, or up to the end of a table.
SAMPLES = 16


class Unloading(Protocol):
    """How a gasket unloads from a largest closure; knots: (k,) the places s from 0 to 1 where its curves bend."""

    @property
    def knots(self) -> Floats: ...

    def set_after(self, closure: Floats, pressure: Floats) -> Floats:
        """c_r (n,) after the largest closures c_m (n,) and their pressures."""
        ...

    def shares(self, closure: Floats) -> Floats:
        """f at the knots, (n, k), from 0 to 1."""
        ...


class StraightUnloading:
    """Unloading with one stiffness (stress / length), whatever the largest closure."""

    knots: Floats = np.array([0.0, 1.0])

    def __init__(self, stiffness: float) -> None:
        self.stiffness = positive("unloading", stiffness)

    def __repr__(self) -> str:
        return repr(self.stiffness)

    def set_after(self, closure: Floats, pressure: Floats) -> Floats:
        return closure - pressure / self.stiffness

    def shares(self, closure: Floats) -> Floats:
        return np.broadcast_to(self.knots, (len(closure), 2))


class MeasuredUnloading:
    """Measured curves; between two the shape and the set, relative to the largest closure, are interpolated.

    Below the first curve's largest closure and beyond the last's they are those of that curve.
    """

    def __init__(self, loading: Layer, curves: Sequence[tuple[ArrayLike, ArrayLike]]) -> None:
        given = [_curve(number, *pair) for number, pair in enumerate(curves, 1)]
        given.sort(key=lambda curve: float(curve[0][-1]))
        for number, (c, p) in enumerate(given, 1):
            _check_top(loading, number, c, p)
        self.tops = np.array([c[-1] for c, _ in given])
        if len(np.unique(self.tops)) < len(given):
            raise ValueError(f"unloading: curves from the closures {self.tops.tolist()}; expected one from each")
        self.sets = np.array([c[0] / c[-1] for c, _ in given])
        places = [(c - c[0]) / (c[-1] - c[0]) for c, _ in given]
        self.knots = np.unique(np.concatenate(places))
        parts = [np.interp(self.knots, place, p / p[-1]) for place, (_, p) in zip(places, given, strict=True)]
        self.curves = np.array(parts)

    def __repr__(self) -> str:
        return f"{len(self.tops)} curves"

    def set_after(self, closure: Floats, pressure: Floats) -> Floats:
        return closure * np.interp(closure, self.tops, self.sets)

    def shares(self, closure: Floats) -> Floats:
        return np.stack([np.interp(closure, self.tops, column) for column in self.curves.T], axis=-1)


class GasketLayer(Layer):
    """A gasket: it is loaded along one curve and unloads from the largest closure that each place has seen.

    `cd.programme` remembers that closure from step to step, once a step has converged; `solve` alone begins with what
    the scene's layers remember, at first nothing, and `Solution.scene_after` is the scene with what they do afterwards.
    The gap of a result counts from the set that stays: it is the opening of the joint.

    Args:
        loading: The law of the first loading, such as a `TableLayer`.
        unloading: The stiffness of unloading (stress / length), nowhere below that of loading; or measured curves, each
            the closures (length) and pressures (stress) from its set, p = 0, up to a point of the loading curve.

    Raises:
        TypeError, ValueError: `loading` is no layer that is loaded and unloaded along one curve; the curves of
            unloading do not increase, do not begin without pressure or end on the one of loading, or lie above it.

    Example:
        >>> from contactdd.layer import LinearLayer
        >>> gasket = GasketLayer(LinearLayer(100.0), unloading=400.0)
        >>> used = gasket.remembering(np.zeros((2, 1)), closures=[0.04])  # pressed by 4, a set of 0.03 stays
        >>> used.contact_stress([-0.005]), used.clearance, used.dissipation
        (array([-2.]), array([-0.03]), array([0.06]))
    """

    def __init__(self, loading: Layer, unloading: float | Sequence[tuple[ArrayLike, ArrayLike]]) -> None:
        if not isinstance(loading, Layer) or loading.bonded or loading.remembers:
            raise TypeError(f"loading = {loading!r}: expected a layer loaded and unloaded alike, such as cd.TableLayer")
        measured = isinstance(unloading, Sequence) and not isinstance(unloading, str)
        self.loading = loading
        self.unloading: Unloading = (
            MeasuredUnloading(loading, _pairs(unloading)) if measured else StraightUnloading(unloading)  # type: ignore[arg-type]
        )
        self._check_below()

    def __repr__(self) -> str:
        return f"GasketLayer({self.loading!r}, unloading={self.unloading!r})"

    @property
    def remembers(self) -> bool:
        return True

    @property
    def clearance(self) -> float | Floats:
        return self.loading.clearance

    @property
    def compression_limit(self) -> float | Floats:
        return self.loading.compression_limit

    def at(self, x: Floats) -> Layer:
        return self.remembering(x, np.zeros(np.shape(x)[1]))

    def remembering(self, x: ArrayLike, closures: ArrayLike) -> GasketAtPoints:
        """The law at points that have been closed before, as a layer to be given to a scene.

        Args:
            x: (dim, n) The coordinates of the contact's points (length), as of `ContactResult.x`, transposed.
            closures: (n,) The largest closures there (length, >= 0), as of `ContactResult.largest_closure`.

        Raises:
            ValueError: They are not n finite numbers >= 0, or the gasket would get thicker by unloading from one.
        """
        places, largest = as_floats("x", x, "coordinates (dim, n)"), as_floats("closures", closures, "n numbers")
        if places.ndim != 2 or largest.shape != places.shape[1:] or not np.all((largest >= 0) & np.isfinite(largest)):
            raise ValueError(f"closures of shape {largest.shape}: expected finite numbers >= 0, one for each point")
        return GasketAtPoints(self, places, largest)

    def _check_below(self) -> None:
        """Refuse unloading that gives back more than loading took."""
        tops, end = getattr(self.unloading, "tops", np.zeros(0)), np.max(self.loading.compression_limit)
        if not len(tops) and not np.isfinite(end):
            return  # an unbounded law has no range to look at; a set below zero is refused when it would come about
        ends = np.concatenate([[0.0], tops if len(tops) else [end]])
        closures = np.unique(np.concatenate([np.linspace(low, high, SAMPLES) for low, high in pairwise(ends)]))
        for top in closures[closures > 0]:
            law = self.remembering(np.zeros((1, 1)), [top])
            places = law.set[0] + (top - law.set[0]) * np.linspace(0, 1, SAMPLES)
            above = law._pressure(places - law.set[0]) - self.loading._pressure(places)
            if above.max() > ABOVE * law.pressures[0]:
                at = places[int(np.argmax(above))]
                raise ValueError(
                    f"unloading: from the closure {top:.6g} its curve is {above.max():.3g} above that of loading at "
                    f"{at:.6g}; expected one that is below, as a gasket gives back no more than it took"
                )

    def _pressure(self, c: Floats) -> Floats:
        return self.loading._pressure(c)

    def _slope(self, c: Floats) -> Floats:
        return self.loading._slope(c)

    def _secant(self, deep: Floats, shallow: Floats) -> Floats:
        return self.loading._secant(deep, shallow)

    def _energy(self, c: Floats) -> Floats:
        return self.loading._energy(c)

    def _depth(self, p: Floats) -> Floats:
        return self.loading._depth(p)


class GasketAtPoints(Layer):
    """A gasket that remembers the largest closure at each of n points; compressions count from the set there.

    Attributes:
        gasket: The `GasketLayer`.
        x: (dim, n) The points.
        closures: (n,) The largest closures c_m (length).
        pressures: (n,) The pressures p_m there (stress).
        set: (n,) What stays of the closure without pressure, c_r (length).
    """

    def __init__(self, gasket: GasketLayer, x: Floats, closures: Floats) -> None:
        self.gasket, self.x, self.closures = gasket, x, closures
        self.pressures = np.asarray(gasket.loading._pressure(closures))
        self.set = np.where(closures > 0, gasket.unloading.set_after(closures, self.pressures), 0.0)
        if np.any(self.set < 0.0):
            at = int(np.argmin(self.set))
            raise ValueError(
                f"unloading = {gasket.unloading!r}: from the closure {closures[at]:.6g} at {self.pressures[at]:.6g} "
                f"the gasket would get thicker than it was; expected more than {self.pressures[at] / closures[at]:.6g}"
            )
        self._height, self._knots = closures - self.set, gasket.unloading.knots
        self._table = self.pressures[:, None] * gasket.unloading.shares(closures)

    def __repr__(self) -> str:
        return f"{self.gasket!r}, closed before up to {self.closures.max(initial=0.0):.6g}"

    @property
    def remembers(self) -> bool:
        return True

    @property
    def clearance(self) -> float | Floats:
        return self.gasket.clearance - self.set

    @property
    def compression_limit(self) -> float | Floats:
        return self.gasket.compression_limit - self.set

    @property
    def dissipation(self) -> Floats:
        """The energy (n,) that loading up to the largest closures has taken and unloading does not give back
        (stress · length)."""
        return np.asarray(self.gasket.loading._energy(self.closures) - self._stored[:, -1])

    def at(self, x: Floats) -> Layer:
        if np.shape(x) != self.x.shape or not np.allclose(
            x, self.x, rtol=0.0, atol=1e-9 * np.abs(self.x).max(initial=0)
        ):
            raise ValueError(
                f"{self!r}: it remembers closures at its {self.x.shape[1]} points only; expected the same mesh, degree "
                "and points (no error estimate, adaptation or other points after a first load)"
            )
        return self

    def remembering(self, x: ArrayLike, closures: ArrayLike) -> GasketAtPoints:
        """The same gasket with other largest closures, see `GasketLayer.remembering`."""
        return self.gasket.remembering(x, closures)

    def after(self, z: Floats) -> Layer:
        closures = np.maximum(self.closures, self.set - z)
        return self if np.array_equal(closures, self.closures) else GasketAtPoints(self.gasket, self.x, closures)

    def _among(self, chosen: NDArray[np.bool_]) -> Layer:
        return self if chosen.all() else GasketAtPoints(self.gasket, self.x[:, chosen], self.closures[chosen])

    def _pressure(self, c: Floats) -> Floats:
        piece, start = self._piece(c)
        unloaded = self._of(self._table, piece) + self._of(self._slopes, piece) * (np.minimum(c, self._height) - start)
        return np.where(c > self._height, self.gasket.loading._pressure(self._total(c)), unloaded)

    def _slope(self, c: Floats) -> Floats:
        slope = self._of(self._slopes, self._piece(c)[0]) + 0.0 * c  # hands on what is not a number
        return np.where(c > self._height, self.gasket.loading._slope(self._total(c)), slope)

    def _secant(self, deep: Floats, shallow: Floats) -> Floats:
        # The part of the way that is loading, and the rise of the one that is unloading from knot to knot: all terms
        # are positive, so nothing cancels.
        known, before = np.minimum(deep, self._height), np.minimum(shallow, self._height)
        (first, _), (last, start) = self._piece(before), self._piece(known)
        same = first == last
        slopes, end = self._of(self._slopes, first), self._of(self._places, np.minimum(first + 1, last))
        rise = (
            slopes * (end - before) + self._of(self._table, last) - self._of(self._table, np.minimum(first + 1, last))
        )
        rise = np.where(same, slopes * (known - before), rise + self._of(self._slopes, last) * (known - start))
        beyond, origin = np.maximum(deep, self._height), np.maximum(shallow, self._height)
        loading = self.gasket.loading._secant(self._total(beyond), np.maximum(self._total(origin), TINY))  # not at zero
        width = deep - shallow
        mixed = np.divide(rise + loading * (beyond - origin), width, out=np.array(slopes), where=width > 0)
        return np.where(shallow >= self._height, loading, np.where(same & (deep <= self._height), slopes, mixed))

    def _energy(self, c: Floats) -> Floats:
        piece, start = self._piece(c)
        part = np.minimum(c, self._height) - start
        stored = self._of(self._stored, piece)
        stored = stored + (self._of(self._table, piece) + 0.5 * self._of(self._slopes, piece) * part) * part
        loading = self.gasket.loading._energy(self._total(c)) - self.gasket.loading._energy(self.closures)
        return np.where(c > self._height, stored + loading, stored)

    def _depth(self, p: Floats) -> Floats:
        p = np.broadcast_to(p, np.broadcast_shapes(np.shape(p), self.closures.shape))
        piece = np.sum(p[..., None] >= self._table[:, 1:-1], axis=-1)
        rise = p - self._of(self._table, piece)
        slopes = self._of(self._slopes, piece)
        unloaded = self._of(self._places, piece) + np.divide(rise, slopes, out=np.zeros(p.shape), where=slopes > 0)
        return np.where(p > self.pressures, self.gasket.loading._depth(p) - self.set, unloaded)

    @cached_property
    def _places(self) -> Floats:
        """The compressions, from the set, at the knots of each point's curve, (n, k)."""
        return self._height[:, None] * self._knots

    @cached_property
    def _slopes(self) -> Floats:
        """The slopes between the knots, (n, k − 1); zero where there is no curve yet."""
        widths = np.diff(self._places, axis=1)
        return np.divide(np.diff(self._table, axis=1), widths, out=np.zeros(widths.shape), where=widths > 0)

    @cached_property
    def _stored(self) -> Floats:
        """The energy at the knots, (n, k)."""
        areas = 0.5 * (self._table[:, 1:] + self._table[:, :-1]) * np.diff(self._places, axis=1)
        return np.concatenate([np.zeros((len(areas), 1)), np.cumsum(areas, axis=1)], axis=1)

    def _piece(self, c: Floats) -> tuple[NDArray[np.intp], Floats]:
        """The piece of each point's curve that c lies in, and the compression where it begins."""
        piece = np.sum(np.asarray(c)[..., None] >= self._places[:, 1:-1], axis=-1)
        return piece, self._of(self._places, piece)

    def _total(self, c: Floats) -> Floats:
        """The closures; at least the largest so far where c is beyond the height."""
        return np.asarray(np.maximum(c + self.set, 0.0))

    @staticmethod
    def _of(table: Floats, piece: Any) -> Floats:
        """The entries (…, n) of a table (n, k) at each point's piece (…, n)."""
        return table[np.arange(len(table)), piece]


def _pairs(unloading: Any) -> list[tuple[ArrayLike, ArrayLike]]:
    """Curves of unloading as pairs; ValueError if they are none."""
    curves = list(unloading)
    if not curves or not all(isinstance(pair, Sequence | np.ndarray) and len(pair) == 2 for pair in curves):
        raise ValueError(f"unloading = {unloading!r}: expected a stiffness, or curves (closures, pressures)")
    return [(pair[0], pair[1]) for pair in curves]


def _curve(number: int, closures: ArrayLike, pressures: ArrayLike) -> tuple[Floats, Floats]:
    """A curve of unloading, upwards from its set; ValueError if it is none."""
    c, p = (as_floats(f"unloading curve {number}", v, "finite numbers") for v in (closures, pressures))
    if c.ndim != 1 or c.shape != p.shape or len(c) < 2 or not np.all(np.isfinite(c + p)):
        raise ValueError(f"unloading curve {number}: expected two or more closures and as many pressures")
    if c[0] > c[-1]:  # as it was measured, downwards
        c, p = c[::-1], p[::-1]
    if c[0] < 0.0 or p[0] != 0.0:
        raise ValueError(
            f"unloading curve {number} begins at the closure {c[0]:g} with {p[0]:g}; expected its set, >= 0, where the "
            "pressure is 0"
        )
    for name, values in (("closures", c), ("pressures", p)):
        if not np.all(np.diff(values) > 0):
            row = int(np.argmin(np.diff(values) > 0)) + 1
            raise ValueError(
                f"unloading curve {number}: its {name} do not increase, {values[row]:g} comes after {values[row - 1]:g}"
            )
    return c, p


def _check_top(loading: Layer, number: int, c: Floats, p: Floats) -> None:
    """Refuse a curve that does not end on the one of loading."""
    expected = float(loading._pressure(c[-1:])[0])
    if abs(p[-1] - expected) > ABOVE * expected:
        raise ValueError(
            f"unloading curve {number} ends at the closure {c[-1]:g} with {p[-1]:g}; expected the pressure of loading "
            f"there, {expected:g}"
        )
