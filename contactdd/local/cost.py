"""What a body's local solvers will cost, estimated in advance, and the one that follows from it.

The constants were fitted to measurements by demos/studies/cost_of_solvers.py, in seconds of one core, a unit that does
not matter to the choice.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..interface.discretise import InterfaceSide
from .memory import available_bytes, factor_bytes

if TYPE_CHECKING:
    from ..body import Body

#: Unknowns of a body up to which nothing is estimated: condensing it is quicker.
ALWAYS_CONDENSED = 10_000


#: Condensing n unknowns: exp(c₀) n^c₁ seconds.
CONDENSING = (-14.60, 1.477)


#: Solving a dense system of c unknowns in some five steps: seconds over c³.
DENSE = 2e-10


#: Dense matrices of the touched unknowns that a condensed body takes: S, its factor, and one on the way.
DENSE_COPIES = 3


#: Solving n unknowns by multigrid: exp(c₀) n^c₁ w^c₂ seconds, w the cubes of the cells' unknowns per unknown. Cells
#: of high degree couple more unknowns and take more cycles.
MULTIGRID = (-14.78, 1.038, 0.526)


#: The part of that which goes into setting it up, which copies share.
SETTING_UP = 0.5


#: Multigrid is chosen where it is estimated to take less than this part of what condensing takes: estimates are good to
#: a fifth, and condensing is surer.
CLEARLY = 0.8


@dataclass(frozen=True)
class Choice:
    """The local solver of a body, and what it was estimated to cost beside the other; nothing for a small body."""

    solver: str
    note: str = ""


@dataclass(frozen=True)
class Size:
    """The size of a body: its unknowns, the cubes of its cells' unknowns for each of them, and those touched."""

    unknowns: int
    cubes: float
    touched: int

    @classmethod
    def of(cls, body: Body, sides: Sequence[tuple[int, InterfaceSide]]) -> Size:
        """The size of a body; sides: those at which contacts touch it."""
        touched = len(np.unique(np.concatenate([side.trace.indices for _, side in sides])))
        return cls(body.dofs, body.mesh.cells * body.elements.element.dim**3 / body.dofs, touched)


def condensing_seconds(size: Size) -> float:
    """The time of condensing a body, which its copies share."""
    return math.exp(CONDENSING[0]) * size.unknowns ** CONDENSING[1]


def dense_seconds(size: Size) -> float:
    """The time of the dense systems of a condensed body."""
    return DENSE * size.touched**3


def multigrid_seconds(size: Size) -> float:
    """The time of solving a body by multigrid."""
    return math.exp(MULTIGRID[0]) * size.unknowns ** MULTIGRID[1] * size.cubes ** MULTIGRID[2]


def cheapest_solver(body: Body, sides: Sequence[tuple[int, InterfaceSide]], copies: int) -> Choice:
    """The local solver for a body: the one of "condensed" and "multigrid" that fits and is estimated to cost less.

    sides: those at which contacts touch it; copies: how many bodies, itself included, share what it costs once.
    """
    if body.mesh.cells * body.elements.element.dim <= ALWAYS_CONDENSED or body.dofs <= ALWAYS_CONDENSED:
        return Choice("condensed")
    size = Size.of(body, sides)
    wanted, there = factor_bytes(body.mesh.dim, body.dofs) + DENSE_COPIES * 8 * size.touched**2, available_bytes()
    if wanted > 0.5 * there:
        return Choice("multigrid", f"auto: multigrid for {body.name!r}, factoring it takes {wanted / 2**30:.1f} GiB")
    if body.mesh.dim == 2:
        return Choice("condensed")
    once, each = condensing_seconds(size), dense_seconds(size)
    condensed, multigrid = once / copies + each, multigrid_seconds(size) * (1 - SETTING_UP + SETTING_UP / copies)
    chosen = "multigrid" if multigrid < CLEARLY * condensed else "condensed"
    estimates = f"condensed {condensed:.2g} s, multigrid {multigrid:.2g} s"
    return Choice(chosen, f"auto: {chosen} for {body.name!r}, estimated {estimates}")
