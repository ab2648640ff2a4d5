"""Half of a layer: what one of two mirrored bodies sees of the layer between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats
from ..layer import Layer
from .bonded import BondedLayer


@dataclass(frozen=True)
class HalvedLayer(Layer):
    """The half of a layer up to its middle: two of them in series are the layer, c(p) = c_layer(p)/2.

    Args:
        layer: The whole layer.

    Example:
        >>> from contactdd.layer import LinearLayer
        >>> float(HalvedLayer(LinearLayer(2.0)).contact_stress(-1.0))
        -4.0
    """

    layer: Layer

    @property
    def clearance(self) -> float | Floats:
        return 0.5 * self.layer.clearance

    @property
    def compression_limit(self) -> float | Floats:
        return 0.5 * self.layer.compression_limit

    @property
    def remembers(self) -> bool:
        return self.layer.remembers

    @property
    def closures(self) -> Floats:
        """What the whole layer remembers."""
        return self.layer.closures  # type: ignore[attr-defined]

    def after(self, z: Floats) -> Layer:
        return HalvedLayer(self.layer.after(2 * z))

    def at(self, x: Floats) -> Layer:
        part = self.layer.at(x)
        return self if part is self.layer else HalvedLayer(part)

    def _among(self, chosen: NDArray[np.bool_]) -> Layer:
        part = self.layer._among(chosen)
        return self if part is self.layer else HalvedLayer(part)

    def _pressure(self, c: Floats) -> Floats:
        return self.layer._pressure(2 * c)

    def _slope(self, c: Floats) -> Floats:
        return 2 * self.layer._slope(2 * c)

    def _secant(self, deep: Floats, shallow: Floats) -> Floats:
        return 2 * self.layer._secant(2 * deep, 2 * shallow)

    def _energy(self, c: Floats) -> Floats:
        return 0.5 * self.layer._energy(2 * c)

    def _depth(self, p: Floats) -> Floats:
        return 0.5 * self.layer._depth(p)


def half(law: Layer) -> Layer:
    """The half of a law, of both branches of one that carries tension."""
    if isinstance(law, BondedLayer):
        return BondedLayer(HalvedLayer(law.layer), law.tension and HalvedLayer(law.tension))
    return HalvedLayer(law)
