"""Where on a contact facet the layer's law is evaluated, and with what weights.

"facet":  one value per facet (DG0), the law at the facet's mean gap;
"vertex": the facet's vertices with equal weights, as in the paper's computations;
"gauss":  Gauss points, accurate for elements of higher degree (the default).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import basix
import basix.ufl
import numpy as np
from numpy.typing import NDArray

from .base.checks import as_count, check_choice

RULES = ("facet", "vertex", "gauss")


@dataclass(frozen=True)
class Rule:
    """A contact quadrature: its name and the polynomial degree that its integrals are exact for."""

    name: str
    degree: int

    def points(self, facet: basix.CellType) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Integration points (n, dim - 1) and weights (n,) on the reference facet."""
        if self.name == "vertex":
            vertices = np.asarray(basix.geometry(facet))
            return vertices, np.full(len(vertices), basix.cell.volume(facet) / len(vertices))
        return _gauss(facet, self.degree)

    def element(self, cell_name: str) -> Any:
        """The element on the facet submesh in which the Robin coefficient φ lives."""
        if self.name == "gauss":
            return basix.ufl.quadrature_element(cell_name, degree=self.degree)
        return basix.ufl.element("Discontinuous Lagrange", cell_name, 0 if self.name == "facet" else 1)

    @property
    def metadata(self) -> dict[str, Any]:
        """What the UFL measure of the Robin term needs to use the same points."""
        if self.name == "vertex":
            return {"quadrature_rule": "vertex", "quadrature_degree": 1}
        return {"quadrature_rule": "default", "quadrature_degree": self.degree}


@cache
def _gauss(facet: basix.CellType, degree: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    points, weights = basix.make_quadrature(facet, degree)
    points.setflags(write=False)  # they are everybody's
    weights.setflags(write=False)
    return points, weights


def rule(name: str, element_degree: int, degree: int | None = None) -> Rule:
    """The rule of that name for elements of `element_degree`; `degree` overrides the degree of exactness.

    The default integrates the product of two displacements exactly, as ∫ φ u_n v_n needs.
    """
    check_choice("quadrature", name, RULES)
    if name == "vertex" and element_degree > 1:
        raise ValueError(
            f"quadrature = 'vertex' with elements of degree {element_degree}: the vertices alone would spoil their "
            "accuracy; expected 'gauss' or 'facet'"
        )
    return Rule(name, 2 * element_degree if degree is None else as_count("quadrature_degree", degree))
