"""A body's stiffness, in the form that is asked for: its cells' matrices, or the one that its forms give in UFL."""

from __future__ import annotations

from functools import cached_property
from typing import Any

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
    def blocks(self) -> scipy.sparse.bsr_matrix:
        """The matrix of a(u, v) with the springs, for all degrees of freedom, in blocks of the nodes."""
        matrix = self.full if self.has_springs else stiffness_matrix(self._body)
        return matrix.tobsr((self._body.mesh.dim,) * 2)

    @cached_property
    def full(self) -> scipy.sparse.csr_matrix:
        """The same without blocks."""
        if self.has_springs:
            return (stiffness_matrix(self._body) + self.springs).tocsr()
        return self.blocks.tocsr() if "blocks" in vars(self) else stiffness_matrix(self._body).tocsr()

    @property
    def _whole(self) -> scipy.sparse.spmatrix:
        """The matrix for all degrees of freedom, in the form that there is."""
        return self.full if "full" in vars(self) else self.blocks

    def forget(self) -> None:
        """Drop the matrix, which is assembled again when it is asked for: of many bodies it is too much to keep."""
        for form in ("full", "blocks"):
            vars(self).pop(form, None)

    @cached_property
    def reduced(self) -> scipy.sparse.csr_matrix:
        """The matrix in the unknowns."""
        return self._space.within(self.full)

    @property
    def operator(self) -> Any:
        """The same as it is quickly made and applied: in blocks, where the unknowns are some degrees of freedom."""
        return self.reduced if self._space.free is None else SelectedStiffness(self, self._space)

    @property
    def largest(self) -> float:
        """The largest stiffness of an unknown."""
        if self._space.free is None:
            return float(self.reduced.diagonal().max(initial=0.0))
        return float(self._space.restricted(self._whole.diagonal()).max(initial=0.0))

    def forces(self, u: Floats) -> Floats:
        """a(u, ·) with the springs, of all degrees of freedom."""
        if self.cells is None or not {"full", "blocks"}.isdisjoint(vars(self)):
            return self._whole @ u
        return self.cells.forces(u) + self.spring_forces(u)

    def spring_forces(self, u: Floats) -> Floats:
        """The forces of springs under displacements (dofs,) or (dofs, n)."""
        return self.springs @ u if self.has_springs else np.zeros_like(u)


class SelectedStiffness:
    """A body's stiffness in its unknowns, which are some of all degrees of freedom, applied in all of these."""

    def __init__(self, stiffness: Stiffness, space: AdmissibleSpace) -> None:
        self._stiffness, self._space = stiffness, space
        self.shape = (space.size, space.size)

    def __matmul__(self, y: Floats) -> Floats:
        return self._space.restricted(self._stiffness.blocks @ self._space.extended(y))

    @property
    def matrix(self) -> scipy.sparse.csr_matrix:
        """The matrix itself."""
        return self._stiffness.reduced
