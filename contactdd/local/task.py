"""A body with its contacts, from which a local solver makes the body's local problem."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy
from mpi4py import MPI

from ..base.arrays import Floats, Operator
from ..interface.discretise import InterfaceSide


def _alone(matrix: scipy.sparse.csr_matrix) -> Operator:
    """The operator of a single rank: the matrix itself."""
    return matrix


@dataclass(frozen=True)
class LocalTask:
    """A body to be solved, with its contacts.

    Attributes:
        body: The `Body`, or `MeshlessBody`.
        sides: Its sides of the scene's interfaces, each with the interface's index.
        discrete: Its finite element problem without contacts, a `DiscreteBody`; None of a body without a mesh.
        comm: The ranks that make the problem together, each of which is given the same task.
        original: The local problem, of the same kind, of the body that this one copies; None if it is no copy.
        signs: (dim,) the ±1 between the components of the original's displacements and this body's.
        collective: From the stiffness matrix that this rank holds to the operator that all ranks apply together.
        crowded: Whether there are so many bodies that nothing is kept which is mostly zeros or seldom asked for.
    """

    body: Any
    sides: Sequence[tuple[int, InterfaceSide]]
    discrete: Any
    comm: MPI.Comm = field(default_factory=lambda: MPI.COMM_SELF)
    original: Any = None
    signs: Floats = field(default_factory=lambda: np.ones(0))
    collective: Callable[[scipy.sparse.csr_matrix], Operator] = field(default_factory=lambda: _alone)
    crowded: bool = False
