"""Laws that are known up to a compression only: measured, or with a pole. Beyond it they go on straight."""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property

import numpy as np

from ..base.arrays import Floats
from ..layer import Layer

#: So many times stiffer than at rest a law with a pole is a wall: further on c is the pole's to nearly all digits.
STEEP = 1e10


class LimitedLayer(Layer):
    """A law that goes on straight, with the slope it has there, beyond its `compression_limit`.

    So an iterate beyond a pole, where the law itself is no number, has a pressure and an energy that drive it back.
    A subclass gives the limit and the five functions up to it.
    """

    @property
    @abstractmethod
    def compression_limit(self) -> float | Floats: ...

    @abstractmethod
    def _known_pressure(self, c: Floats) -> Floats: ...

    @abstractmethod
    def _known_slope(self, c: Floats) -> Floats: ...

    @abstractmethod
    def _known_secant(self, deep: Floats, shallow: Floats) -> Floats: ...

    @abstractmethod
    def _known_energy(self, c: Floats) -> Floats: ...

    @abstractmethod
    def _known_depth(self, p: Floats) -> Floats: ...

    @cached_property
    def _end(self) -> tuple[Floats, Floats]:
        """Pressure and slope at the limit."""
        limit = np.asarray(self.compression_limit)
        return self._known_pressure(limit), self._known_slope(limit)

    def _pressure(self, c: Floats) -> Floats:
        known, beyond = self._split(c)
        return self._known_pressure(c) if beyond is None else self._known_pressure(known) + self._end[1] * beyond

    def _slope(self, c: Floats) -> Floats:
        return self._known_slope(self._split(c)[0])

    def _secant(self, deep: Floats, shallow: Floats) -> Floats:
        known, beyond = self._split(deep)
        if beyond is None:
            return self._known_secant(deep, shallow)
        outer = np.maximum(beyond - np.maximum(shallow - self.compression_limit, 0.0), 0.0)
        inner = self._known_secant(known, np.minimum(shallow, self.compression_limit))
        width = deep - shallow
        share = np.divide(outer, width, out=np.array(shallow >= self.compression_limit, dtype=float), where=width > 0)
        return np.where(beyond > 0, (1 - share) * inner + share * self._end[1], inner)

    def _energy(self, c: Floats) -> Floats:
        known, beyond = self._split(c)
        energy = self._known_energy(known)
        return energy if beyond is None else energy + (self._end[0] + 0.5 * self._end[1] * beyond) * beyond

    def _depth(self, p: Floats) -> Floats:
        if np.all(np.isinf(self.compression_limit)):
            return self._known_depth(p)
        end, slope = self._end
        return self._known_depth(np.minimum(p, end)) + np.maximum(p - end, 0.0) / slope

    def _split(self, c: Floats) -> tuple[Floats, Floats | None]:
        """The compressions up to the limit, and the parts beyond it, None where there are none."""
        if not np.any(c > self.compression_limit):
            return c, None
        return np.minimum(c, self.compression_limit), np.maximum(c - self.compression_limit, 0.0)
