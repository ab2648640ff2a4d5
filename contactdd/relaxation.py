"""The relaxation γ^k: numbers one after another, a line search, or a function of what the run has seen."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from .base.arrays import Floats
from .base.checks import check_choice, positional, positive
from .history import History


@dataclass(frozen=True)
class Correction:
    """An iteration before its relaxation γ is chosen, for a function that chooses it.

    Attributes:
        iteration: The number k of iterations done.
        history: Their records; `history[-1].gamma` is the last relaxation.
        correction: (unknowns,) ũ − u^k of all bodies, which γ multiplies: components of displacement (length).
        previous: (unknowns,) That of the iteration before; None in the first one of a run.

    Example:
        >>> def aitken(k, now):  # Irons and Tuck's form of Aitken's Δ² for vectors
        ...     if now.previous is None:
        ...         return 0.5
        ...     change = now.correction - now.previous
        ...     return abs(now.history[-1].gamma * (now.previous @ change) / (change @ change))
        >>> import contactdd as cd
        >>> nothing = cd.History()
        >>> aitken(0, Correction(0, nothing, np.ones(3), None))
        0.5
    """

    iteration: int
    history: History
    correction: Floats
    previous: Floats | None


#: γ chosen when the correction is known.
Choice = Callable[[Correction], float]
#: γ of one iteration; None where it is to be searched.
Relaxation = float | Choice | None
#: γ as a user gives it.
Gamma = float | Iterable[float] | Callable[..., float] | str


def relaxations(gamma: Gamma) -> Iterator[Relaxation]:
    """The relaxations γ^0, γ^1, …, checked.

    gamma: a number, a sequence, "search", or a function of the iteration, or of it and the `Correction`.
    """
    if isinstance(gamma, str):
        check_choice("gamma", gamma, ("search",))
        return itertools.repeat(None)
    if callable(gamma):
        return _chosen(gamma)
    if isinstance(gamma, Iterable) and np.asarray(gamma).ndim > 0:
        values = [positive("gamma", value) for value in gamma]
        if not values:
            raise ValueError(f"gamma = {gamma!r}: expected at least one number")
        return iter(values)
    return itertools.repeat(positive("gamma", gamma))


def _chosen(gamma: Callable[..., float]) -> Iterator[Relaxation]:
    taken = positional(gamma)
    if taken not in (1, 2, None):
        raise TypeError(
            f"gamma = {gamma!r}: it takes {taken} arguments; expected a function (k) or (k, correction) -> γ"
        )
    if taken == 2:
        return itertools.repeat(lambda now: _positive(gamma(now.iteration, now)))
    return (positive("gamma", gamma(k)) for k in itertools.count())


def _positive(value: Any) -> float:
    return positive("gamma", value.item() if isinstance(value, np.ndarray) and value.ndim == 0 else value)
