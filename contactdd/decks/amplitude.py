"""Amplitudes of a deck: factors of loads over time, and how long the steps take."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..base.arrays import Floats
from ..files.deck import Card, fields, number_of


@dataclass(frozen=True)
class Amplitude:
    """Factors at times, straight in between and constant beyond; total: whether time goes on from step to step."""

    times: Floats
    factors: Floats
    total: bool

    def at_end(self, periods: Sequence[float], step: int) -> float:
        """The factor, at the end of the last step, of a load that is given in a step (from 0) and not replaced.

        What runs over the time of its step keeps its value afterwards, what runs over the total time goes on.
        """
        return float(np.interp(sum(periods) if self.total else periods[step], self.times, self.factors))


def periods_of(cards: Sequence[Card]) -> list[float]:
    """The period of each step, 1 where nothing is said; that of a single one where a deck has none."""
    found: list[float] = []
    for card in cards:
        if card.keyword == "STEP":
            found.append(1.0)
        elif card.keyword == "STATIC" and found and card.lines:
            _, *rest = fields(card.lines[0])
            found[-1] = number_of(rest[0]) if rest and rest[0] else 1.0
    return found or [1.0]
