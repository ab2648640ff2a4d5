"""The null space of a matrix whose columns come in small groups, each row in few of them: eliminated group by group.

Orthogonal transformations make each group's columns triangular in turn, so that nothing is squared; directions of a
group that no row is left to resist are null directions. Groups with few neighbours come first (minimum degree).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from .arrays import Floats, Indices, slices

#: Some rows of the matrix: by the groups that they touch, the part (rows, columns of the group).
Rows = Mapping[int, Floats]

#: Smaller entries of null vectors, whose own entries in the group they belong to are of length one, are rounding.
ROUNDING = 1e-13


@dataclass(frozen=True)
class NullSpace:
    """A null space.

    vectors: (columns, n) a basis, each of length one; directions: by group, directions (columns of the group, n of the
    group) such that nothing is left of the null space once they are fixed.
    """

    vectors: scipy.sparse.csc_matrix
    directions: Mapping[int, Floats]

    @property
    def size(self) -> int:
        """The number of null vectors."""
        return int(self.vectors.shape[1])


@dataclass(frozen=True)
class _Step:
    """A group eliminated: its columns' coefficients are −gain @ those of the others, plus any along `null`."""

    group: int
    others: list[int]
    gain: Floats
    null: Floats


def null_space(rows: Iterable[Rows], sizes: Sequence[int], limit: float) -> NullSpace:
    """The null space of rows.

    sizes: the number of columns of each group; limit: directions that are resisted by no more than this are null.
    """
    blocks = [kept for block in rows if (kept := {group: part for group, part in block.items() if sizes[group]})]
    attached: list[list[Rows]] = [[] for _ in sizes]
    for block in blocks:
        for group in block:
            attached[group].append(block)
    steps = []
    for group in _ordered(blocks, sizes):
        step, rest = _eliminated(group, attached[group], sizes, limit)
        steps.append(step)
        for other in step.others:
            attached[other] = [block for block in attached[other] if group not in block] + [rest]
    return NullSpace(_back_substituted(steps, sizes), {step.group: step.null for step in steps if step.null.size})


def _ordered(blocks: Sequence[Rows], sizes: Sequence[int]) -> list[int]:
    """The groups that have columns, those with few neighbours first."""
    pairs = np.array([(a, b) for block in blocks for a in block for b in block], dtype=np.intp).reshape(-1, 2)
    near = scipy.sparse.coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(sizes), len(sizes))).tocsc()
    near = (near.sign() + scipy.sparse.diags(near.getnnz(axis=0) + 1.0)).tocsc()
    order = {"diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
    place = scipy.sparse.linalg.splu(near, permc_spec="MMD_AT_PLUS_A", **order).perm_c
    return [int(group) for group in np.argsort(place) if sizes[group]]


def _eliminated(group: int, mine: Sequence[Rows], sizes: Sequence[int], limit: float) -> tuple[_Step, Rows]:
    """A group eliminated from its rows, and the rows that are left of these."""
    others = sorted({other for block in mine for other in block} - {group})
    parts = slices([sizes[other] for other in others])
    width = parts[-1].stop if parts else 0
    own = np.vstack([block[group] for block in mine] + [np.zeros((sizes[group], sizes[group]))])
    coupled, first = np.zeros((len(own), width)), 0
    for block in mine:
        for other, part in zip(others, parts, strict=True):
            if other in block:
                coupled[first : first + len(block[other]), part] = block[other]
        first += len(block[group])
    left, singular, right = np.linalg.svd(own, full_matrices=False)
    held = singular > limit
    left = left[:, held]
    answer = left.T @ coupled
    rest = coupled - left @ answer
    rest = compressed(rest)
    gain = right[held].T @ (answer / singular[held, None])
    step = _Step(group, others, gain, right[~held].T)
    return step, {other: rest[:, part] for other, part in zip(others, parts, strict=True)}


def compressed(rows: Floats) -> Floats:
    """As few rows with the same inner products of the columns."""
    return np.asarray(np.linalg.qr(rows, mode="r")) if len(rows) > rows.shape[1] else rows


def _back_substituted(steps: Sequence[_Step], sizes: Sequence[int]) -> scipy.sparse.csc_matrix:
    """The null vectors, from the group eliminated last to the first."""
    found: dict[int, tuple[Indices, Floats]] = {}  # by group: the null vectors that it takes part in, its part of them
    count = 0
    for step in reversed(steps):
        vectors = _union([found[other][0] for other in step.others])
        around = np.vstack([_spread(*found[other], vectors) for other in step.others] or [np.zeros((0, 0))])
        moved = -step.gain @ around
        there = np.abs(moved).max(axis=0, initial=0.0) > ROUNDING
        new = count + np.arange(step.null.shape[1])
        found[step.group] = np.append(vectors[there], new), np.hstack([moved[:, there], step.null])
        count += len(new)
    starts = np.cumsum([0, *sizes])
    rows = [np.repeat(starts[g] + np.arange(sizes[g]), len(vectors)) for g, (vectors, _) in found.items()]
    columns = [np.tile(vectors, sizes[group]) for group, (vectors, _) in found.items()]
    entries = np.concatenate([part.ravel() for _, part in found.values()] or [np.zeros(0)])
    at = _joined(rows), _joined(columns)
    basis = scipy.sparse.csc_matrix((entries, at), shape=(starts[-1], count))
    lengths = np.sqrt(np.asarray(basis.multiply(basis).sum(axis=0)).ravel())
    return (basis @ scipy.sparse.diags(1.0 / lengths)).tocsc()


def _spread(vectors: Indices, part: Floats, among: Indices) -> Floats:
    """The part (columns, vectors) of a group in some null vectors, with zeros for the others of `among`."""
    spread = np.zeros((len(part), len(among)))
    spread[:, np.searchsorted(among, vectors)] = part
    return spread


def _union(several: Sequence[Indices]) -> Indices:
    return np.unique(_joined(several))


def _joined(several: Sequence[NDArray[np.intp]]) -> Indices:
    return np.concatenate([np.zeros(0, dtype=np.intp), *several])
