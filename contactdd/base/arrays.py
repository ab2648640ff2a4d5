"""The arrays of the package, named once."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]
#: Whole numbers of any width.
Integers = NDArray[np.integer[Any]]
#: An operator that is kept dense where it is small. SciPy's part is named by a string: it is imported by its first use.
Operator = Union["scipy.sparse.csr_matrix", NDArray[np.float64]]  # type: ignore[name-defined]  # noqa: F821


#: The smallest positive number of full precision, below what may be 0 and is divided by.
TINY = float(np.finfo(float).tiny)


def norm(vector: Floats) -> float:
    """The Euclidean norm."""
    return math.sqrt(vector @ vector)


def components(nodes: Integers, dim: int) -> Indices:
    """The degrees of freedom of nodes, of whatever shape, one after another."""
    return np.asarray(nodes[..., None] * dim + np.arange(dim), dtype=np.intp).ravel()


def slices(sizes: Iterable[int]) -> list[slice]:
    """The slices of parts of the given sizes, one after another."""
    ends = list(itertools.accumulate(sizes, initial=0))
    return [slice(*pair) for pair in itertools.pairwise(ends)]
