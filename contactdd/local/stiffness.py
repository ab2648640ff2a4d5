"""A body's stiffness, in the form that is asked for: its cells' matrices, or the one that its forms give in UFL."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy

from ..base.arrays import Floats
from ..body import Body
from ..support import Spring
from .affine import AffineCells, affine_cells
from .forms import spring_matrix, stiffness_matrix
from .space import AdmissibleSpace


class Stiffness:
    """A body's stiffness: cell by cell where that pays, and as its forms give it, made when first asked for."""

    def __init__(self, body: Body, space: AdmissibleSpace) -> None:
        self._body, self._space = body, space
        self.has_springs = any(isinstance(support, Spring) for support in body.supports)

    @cached_property
    def cells(self) -> AffineCells | None:
        """The cells, or None where the matrix as a whole is the better way."""
        return affine_cells(self._body)

    @cached_property
    def springs(self) -> scipy.sparse.csr_matrix:
        """The matrix of the springs, for all degrees of freedom."""
        return spring_matrix(self._body)

    @cached_property
    def full(self) -> scipy.sparse.csr_matrix:
        """The matrix of a(u, v) with the springs, for all degrees of freedom."""
        elastic = stiffness_matrix(self._body)
        return (elastic + self.springs).tocsr() if self.has_springs else elastic

    def forget(self) -> None:
        """Drop the matrix, which is assembled again when it is asked for: of many bodies it is too much to keep."""
        vars(self).pop("full", None)

    @cached_property
    def reduced(self) -> scipy.sparse.csr_matrix:
        """The same in the unknowns."""
        return self._space.within(self.full)

    def forces(self, u: Floats) -> Floats:
        """a(u, ·) with the springs, of all degrees of freedom."""
        if self.cells is None or "full" in vars(self):
            return self.full @ u
        return self.cells.forces(u) + self.spring_forces(u)

    def spring_forces(self, u: Floats) -> Floats:
        """The forces of springs under displacements (dofs,) or (dofs, n)."""
        return self.springs @ u if self.has_springs else np.zeros_like(u)
