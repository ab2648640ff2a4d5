"""Layers one on the other: they carry the same pressure, and their compressions add up."""

from __future__ import annotations

import functools
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats
from ..layer import Layer
from .calculus import solve_by_newton


class SeriesLayer(Layer):
    """Two or more layers in series, c(p) = c₁(p) + c₂(p) and so on.

    A coating on a rough surface, both surfaces' own layers, a gasket with its sheet. The pressure at a given
    compression is found by Newton's method between bounds, to rounding. Where each layer begins at a clearance of its
    own, that of all together is their sum.

    Args:
        layers: The layers, two or more.

    Raises:
        TypeError: One of them is no layer, carries tension or remembers, or there are fewer than two.

    Example:
        >>> from contactdd.layer import LinearLayer
        >>> round(float(SeriesLayer(LinearLayer(2.0), LinearLayer(3.0)).contact_stress(-5.0)), 12)
        -6.0
    """

    def __init__(self, *layers: Layer) -> None:
        if len(layers) < 2:
            raise TypeError(f"layers = {layers!r}: expected two layers or more")
        for index, layer in enumerate(layers):
            if not isinstance(layer, Layer):
                raise TypeError(f"layers[{index}] = {layer!r}: expected a layer, such as cd.PowerLayer(B, a)")
            if layer.remembers:
                raise TypeError(f"layers[{index}] = {layer!r}: it remembers its closure; expected a law without memory")
            if layer.bonded:
                raise TypeError(f"layers[{index}] = {layer!r}: expected the bond around, BondedLayer(SeriesLayer(...))")
        self.layers = layers

    def __repr__(self) -> str:
        return f"SeriesLayer({', '.join(map(repr, self.layers))})"

    def at(self, x: Floats) -> Layer:
        parts = [layer.at(x) for layer in self.layers]
        same = all(part is layer for part, layer in zip(parts, self.layers, strict=True))
        return self if same else SeriesLayer(*parts)

    def _among(self, chosen: NDArray[np.bool_]) -> Layer:
        parts = [layer._among(chosen) for layer in self.layers]
        same = all(part is layer for part, layer in zip(parts, self.layers, strict=True))
        return self if same else SeriesLayer(*parts)

    @property
    def clearance(self) -> float | Floats:
        return sum(layer.clearance for layer in self.layers)

    @functools.cached_property
    def compression_limit(self) -> float | Floats:
        """The compression at which the first of the layers reaches its own limit (length)."""
        limits = [layer.compression_limit for layer in self.layers]
        if np.all(np.isinf(limits[0])) and all(np.all(np.isinf(limit)) for limit in limits):
            return np.inf
        ends = []
        for layer, limit in zip(self.layers, limits, strict=True):
            finite = np.isfinite(limit)
            ends.append(np.where(finite, layer._pressure(np.where(finite, limit, 0.0)), np.inf))
        found = self._depth(np.asarray(functools.reduce(np.minimum, ends)))
        return float(found) if found.ndim == 0 else found

    def _pressure(self, c: Floats) -> Floats:
        return self._shares(np.asarray(c, dtype=float))[0]

    def _slope(self, c: Floats) -> Floats:
        return _in_series([layer._slope(part) for layer, part in self._parts(c)])

    def _secant(self, deep: Floats, shallow: Floats) -> Floats:
        pairs = zip(self._parts(deep), self._parts(shallow), strict=True)
        secants = []
        for (layer, d), (_, s) in pairs:
            s = np.minimum(d, s)  # by rounding alone it could be above
            secants.append(np.where(s > 0, layer._secant(d, np.where(s > 0, s, d)), layer._pressure(d) / d))
        return _in_series(secants)

    def _energy(self, c: Floats) -> Floats:
        return _total(layer._energy(part) for layer, part in self._parts(c))

    def _depth(self, p: Floats) -> Floats:
        return _total(layer._depth(p) for layer in self.layers)

    def _parts(self, c: Floats) -> list[tuple[Layer, Floats]]:
        """Each layer with its part of the compressions."""
        return list(zip(self.layers, self._shares(np.asarray(c, dtype=float))[1], strict=True))

    def _shares(self, c: Floats) -> tuple[Floats, list[Floats]]:
        """The pressure at the compressions c, and each layer's share of them.

        One of n layers is compressed by c/n at least and by c at most: that bounds the pressure.
        """
        pressed = np.where(c > 0, c, np.max(c, initial=0.0, where=c > 0) or 1.0)
        lower = functools.reduce(np.minimum, (layer._pressure(pressed / len(self.layers)) for layer in self.layers))
        upper = functools.reduce(np.minimum, (layer._pressure(pressed) for layer in self.layers))
        p = solve_by_newton(self._depth_and_softness, pressed, lower, np.sqrt(lower) * np.sqrt(upper), upper)
        parts = [layer._depth(p) for layer in self.layers]
        return np.where(c > 0, p, c), [np.where(c > 0, part, c) for part in parts]

    def _depth_and_softness(self, p: Floats) -> tuple[Floats, Floats]:
        """The compression at the pressures p, and its derivative."""
        parts = [layer._depth(p) for layer in self.layers]
        return _total(parts), _total(1 / layer._slope(part) for layer, part in zip(self.layers, parts, strict=True))


def _in_series(stiffnesses: list[Floats]) -> Floats:
    """1 / Σ 1/k."""
    with np.errstate(divide="ignore"):
        return 1 / _total(1 / stiffness for stiffness in stiffnesses)


def _total(parts: Iterable[Floats]) -> Floats:
    return functools.reduce(np.add, parts)
