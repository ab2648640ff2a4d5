"""Anderson acceleration of the decomposed iterations."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np

from ..base.arrays import Floats


class Anderson:
    """Mixes the last `depth` iterates so that their corrections cancel as far as they can.

    The step from y is γ f − Σ θ_j (Δy_j + γ Δf_j), f the correction ũ − y and θ the least-squares solution of
    Σ θ_j Δf_j ≈ f over the differences of successive iterates.
    """

    def __init__(self, depth: int = 10) -> None:
        self._differences: deque[tuple[Floats, Floats]] = deque(maxlen=depth)
        self._last: tuple[Floats, Floats] | None = None

    def restart(self) -> None:
        """Forget the past: it no longer says where the iteration is going."""
        self._differences.clear()
        self._last = None

    @property
    def memory(self) -> list[Floats]:
        """The memory as plain arrays: the last iterate and correction, then pairs of differences."""
        last = [] if self._last is None else list(self._last)
        return last + [part for pair in self._differences for part in pair]

    @memory.setter
    def memory(self, arrays: Sequence[Floats]) -> None:
        self.restart()
        if len(arrays) >= 2:
            self._last = (arrays[0], arrays[1])
            self._differences.extend(zip(arrays[2::2], arrays[3::2], strict=True))

    def step(self, y: Floats, correction: Floats, gamma: float) -> Floats:
        """The accelerated step from y."""
        if self._last is not None:
            self._differences.append((y - self._last[0], correction - self._last[1]))
        self._last = (y.copy(), correction.copy())
        if not self._differences:
            return gamma * correction
        moves, changes = (np.column_stack(columns) for columns in zip(*self._differences, strict=True))
        # Nearly parallel differences say nothing new; they are left out rather than divided by.
        theta = np.linalg.lstsq(changes, correction, rcond=1e-10)[0]
        return gamma * correction - (moves + gamma * changes) @ theta
