"""A bound of the error of a solution's energy, by stresses in equilibrium: the gap between primal and dual energies.

For any stresses σ in equilibrium with the loads, free of shear on the contacts and with one pressure p ≥ 0 on both
sides of each, and for any admissible displacements u_h, Fenchel's inequality gives F₁(u_h) − F₁(u) ≤ gap,

    gap = Σ ½ ∫ (σ − C ε(u_h)) : C⁻¹ (σ − C ε(u_h)) dx + Σ ∫ [G(c_h) + G*(p) − p c_h] ds,

with the compression c_h = −z(u_h), the layer's energy G(c) = ∫₀ᶜ p, zero for c ≤ 0, and its conjugate
G*(p) = ∫₀ᵖ c. Both integrands are nowhere negative, and vanish where σ and p belong to u_h.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem

from ..base import compat
from ..base.arrays import Floats
from ..body import Body
from ..error_estimate import ErrorEstimate, error_estimate
from ..interface.discretise import Interface
from ..layer import Layer
from ..load import BodyForce, Pressure, Resultant, Traction
from ..parameter import current
from ..solution import Solution
from ..support import Displacement, Fixed, Symmetry
from .pressure import SurfacePressure, balance
from .seen import SeenSolution, refined, unmatched
from .stresses import EquilibratedStresses, rows, voigt

#: Elements of the stresses are of so many degrees more than those of the displacements, and of degree 3 at least, from
#: which on symmetric stresses of one degree can balance whatever forces are a degree lower.
MORE, LEAST = 2, 3

#: The degree of exactness of integrals over contacts: gaps and laws have kinks, where the error of n points of a facet
#: falls like n⁻² or a little faster.
MANY = 80

#: Facets where contact ends are cut until what polynomials cannot follow of the pressure adds less than this part of
#: the estimated error to the bound, at most so often; each time those that add most of it.
LOST_PART, CUTS, CUT_SHARE = 0.02, 12, 0.9

#: What the stresses can be in equilibrium with.
SUPPORTS, LOADS = (Fixed, Symmetry, Displacement), (Pressure, Traction, Resultant, BodyForce)

#: Relative to the energy: of this size bounds are what rounding leaves.
NOTHING = 1e-13


@dataclass(frozen=True)
class EnergyBound:
    """A bound of the error of a solution's energy.

    Attributes:
        solution: The solution.
        energy: F₁(u_h), its contacts integrated by many points (force · length).
        bodies: The bodies in the scene's order, on the meshes of the stresses: cut where contact ends.
        cells: (cells,) of each of these meshes, every cell's part of the bound (force · length).
        contacts: Every contact's part of the bound, in the scene's order (force · length).
    """

    solution: Solution
    energy: float
    bodies: tuple[Body, ...]
    cells: tuple[Floats, ...]
    contacts: tuple[float, ...]

    @property
    def error(self) -> float:
        """The bound of F₁(u_h) − F₁(u) (force · length)."""
        return float(sum(cells.sum() for cells in self.cells) + sum(self.contacts))

    @property
    def least_energy(self) -> float:
        """The bound from below of the exact solution's energy F₁(u), which is the least one (force · length)."""
        return self.energy - self.error

    @property
    def displacement(self) -> float:
        """The bound of √a(u − u_h, u − u_h), the error of all displacements in the energy norm (√(force · length))."""
        return float(np.sqrt(2 * self.error))

    @property
    def relative(self) -> float:
        """The same relative to the displacements of the solution, √a(u_h, u_h); infinite where those vanish."""
        size = 2 * self.solution.elastic_energy()
        return self.displacement / float(np.sqrt(size)) if size > 0.0 else np.inf

    def __repr__(self) -> str:
        return (
            f"EnergyBound: F₁ = {self.energy:.8g}, at most {self.error:.3g} above the least one; "
            f"displacements within {self.relative:.2g} in the energy norm"
        )


def energy_bound(solution: Solution | ErrorEstimate) -> EnergyBound:
    """A bound of the error of a solution's energy F₁, by stresses in equilibrium.

    One linear problem per body: the stresses nearest to the solution's of all that are symmetric, polynomials in every
    triangle and in equilibrium with the loads and a pressure p ≥ 0 of the contacts, which is that of a better solution,
    see `error_estimate`; facets where contact ends are cut until polynomials can follow it. No saturation is assumed
    and no constant is unknown; whatever was left of the iteration is counted. It is an upper bound in exact arithmetic,
    of the problem with prescribed displacements as the elements take them and loads that are polynomials on every facet
    of the cut meshes, but for the integrals over the contacts: those of laws and gaps are no polynomials and are taken
    by many points. All else, for which it would be no bound, is refused.

    The error of the pressure is not bounded by it.

    Args:
        solution: A result of `solve`, or its `ErrorEstimate`, whose better solution is taken then.

    Returns:
        The bound, with each cell's and contact's part.

    Raises:
        TypeError: It is neither.
        ValueError: The scene is none of bodies in plane strain or plane stress of straight triangles and a constant
            material, with no other supports than fixed or prescribed displacements and planes of symmetry and no other
            loads than tractions and constant body forces, none of them a UFL expression, whose contacts have a layer
            that only presses and facets that match; or its loads and pressures admit no symmetric stress that is
            continuous, as shear that ends at a free corner does not.

    Example:
        >>> import contactdd as cd
        >>> meshes = [cd.rectangle((0, y), (2, y + 1), (4, 2)) for y in (0, 1)]
        >>> steel = cd.Isotropic(E=2.1e5, nu=0.3)
        >>> low = cd.Body("low", meshes[0], steel, supports=[cd.Fixed("bottom")])
        >>> high = cd.Body("high", meshes[1], steel, loads=[cd.Pressure("top", lambda x: 10 + x[0])])
        >>> contact = cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(1e6))
        >>> bound = cd.energy_bound(cd.solve(cd.Scene([low, high], [contact])))
        >>> 0 < bound.relative < 0.2
        True
    """
    if not isinstance(solution, Solution | ErrorEstimate):
        raise TypeError(f"solution = {solution!r}: expected a Solution, such as cd.solve(...) returns, or its estimate")
    given = solution if isinstance(solution, Solution) else solution.solution
    _check_scene(given)
    better = error_estimate(given, degrees=2).better if isinstance(solution, Solution) else solution.better
    with given.scene.at(given.parameter_values):
        return _bound(given, better)


def _bound(solution: Solution, better: Solution) -> EnergyBound:
    scene = solution.scene
    degree = max(max(body.degree for body in scene.bodies) + MORE, LEAST)
    own, pressures, parts = _resolved(SeenSolution.of(solution), SeenSolution.of(better), degree)
    pairs = zip(own.bodies, own.displacements, strict=True)
    cells = tuple(_body_parts(body, u, pressures, degree) for body, u in pairs)
    energy = _sum_of(own) + sum(part.layer for part in parts)
    return EnergyBound(solution, energy, own.bodies, cells, tuple(part.gap for part in parts))


@dataclass(frozen=True)
class _ContactPart:
    """Of a contact: ∫ G(c_h) and ∫ [G(c_h) + G*(p) − p c_h], and for the better solution ∫ G(c) and that over facets.

    The last is what polynomials cannot follow, and smaller facets can.
    """

    layer: float
    gap: float
    better: float
    lost: Floats


def _resolved(
    own: SeenSolution, better: SeenSolution, degree: int
) -> tuple[SeenSolution, list[SurfacePressure], list[_ContactPart]]:
    """The solution on meshes whose facets can follow the better one's pressures, these, and the contacts' parts."""
    energy = sum(abs(_energy(*each)) for each in zip(own.bodies, own.displacements, strict=True))
    for cut in range(CUTS + 1):
        pressures, gaps = [], []
        for index in range(len(own.contacts)):
            interface, there = better.contact(index, MANY)
            if interface.facets is None:
                raise ValueError(f"contact {interface.contact.name!r}: its facets match no longer where they were cut")
            gaps.append((own.contact(index, MANY)[1], there))
            p = 0.0 - interface.layer.contact_stress(there)
            pressures.append(SurfacePressure(index, interface, p, degree))
        balance(own.bodies, pressures)
        parts = [_contact_part(pressure, *z) for pressure, z in zip(pressures, gaps, strict=True)]
        lost = sum(part.lost.sum() for part in parts)
        if cut == CUTS or lost <= max(LOST_PART * _fallen(own, better, parts), NOTHING * energy):
            break
        own, better = _cut(own, better, parts)
    return own, pressures, parts


def _fallen(own: SeenSolution, better: SeenSolution, parts: Sequence[_ContactPart]) -> float:
    """F₁(u_h) less that of the better solution."""
    return _sum_of(own) - _sum_of(better) + sum(part.layer - part.better for part in parts)


def _sum_of(seen: SeenSolution) -> float:
    """½ A(u, u) − L(u) of all bodies."""
    return sum(_energy(*each) for each in zip(seen.bodies, seen.displacements, strict=True))


def _energy(body: Body, u: fem.Function) -> float:
    """½ a(u, u) − l(u) of a body."""
    forms = [0.5 * body.elastic_form(u, u), *(-load.form(body.elements, u) for load in body.loads)]
    return float(sum(fem.assemble_scalar(compat.form(form)) for form in forms))


def _cut(own: SeenSolution, better: SeenSolution, parts: Sequence[_ContactPart]) -> tuple[SeenSolution, SeenSolution]:
    """Both on meshes that are finer at the facets that carry most of the contacts' parts, and match again."""
    largest = np.sort(np.concatenate([part.lost for part in parts]))[::-1]
    least = largest[int(np.searchsorted(np.cumsum(largest), CUT_SHARE * largest.sum()))]
    cells: dict[str, list[int]] = {}
    for index, part in enumerate(parts):
        chosen, opposite = np.flatnonzero(part.lost >= least), own.contact(index, 1)[0].facets
        _add(cells, own.cells_at(index, (chosen, chosen if opposite is None else opposite[chosen])))
    while any(cells.values()):
        meshes = refined({body.name: body.mesh for body in own.bodies}, cells)
        own, better, cells = own.on(meshes), better.on(meshes), {}
        for index in range(len(parts)):
            interface = own.contact(index, 1)[0]
            if interface.facets is None:
                _add(cells, own.cells_at(index, unmatched(interface)))
    return own, better


def _add(cells: dict[str, list[int]], more: dict[str, list[int]]) -> None:
    for name, some in more.items():
        cells.setdefault(name, []).extend(some)


def _check_scene(solution: Solution) -> None:
    """Refuse a scene of which the bound would be none."""
    for body in solution.scene.bodies:
        if body.mesh is None:
            raise ValueError(f"body {body.name!r}: it has no mesh; expected bodies of triangles")
        _check_body(body)
    for interface in solution.interfaces:
        _check_contact(interface)


def _check_body(body: Body) -> None:
    straight = compat.coordinate_map(body.mesh.domain).degree == 1
    if body.mesh.domain.topology.cell_name() != "triangle" or not straight:
        raise ValueError(f"body {body.name!r}: expected straight triangles")
    if body.kinematics.axisymmetric:
        raise ValueError(f"body {body.name!r}: expected plane strain or plane stress, not a body of revolution")
    if body.material.varies:
        raise ValueError(f"body {body.name!r}: expected a constant material")
    for item, known in ((each, kinds) for of, kinds in ((body.supports, SUPPORTS), (body.loads, LOADS)) for each in of):
        if not isinstance(item, known):
            names = ", ".join(kind.__name__ for kind in known)
            raise ValueError(f"body {body.name!r}: it has a {type(item).__name__}; expected one of {names}")
    body.refuse_expressions()
    for load in body.loads:
        if isinstance(load, BodyForce) and callable(current(load.value)):
            raise ValueError(f"body {body.name!r}: its body force varies; expected a constant one")


def _check_contact(interface: Interface) -> None:
    name = interface.contact.name
    if interface.hard:
        raise ValueError(f"contact {name!r}: it is hard, any penetration costs infinite energy; expected a layer")
    layer = interface.contact.layer
    if interface.layer.bonded or interface.layer.remembers or interface.contact.sliding is not None:
        raise ValueError(
            f"contact {name!r}: layer = {layer!r} carries tension or shear, or remembers; expected another"
        )
    if interface.facets is None:
        raise ValueError(f"contact {name!r}: expected facets that match")
    first, second = (side.meshed for side in interface.sides)
    parallel = first.middles.normal + second.middles.normal[interface.facets]
    if np.abs(parallel).max() > 1e-8:
        raise ValueError(f"contact {name!r}: expected facets that are parallel to those opposite")


def _contact_part(pressure: SurfacePressure, gap: Floats, better: Floats) -> _ContactPart:
    layer, weights = pressure.interface.layer, pressure.weights
    p = pressure.values @ pressure.coefficients
    conjugate, energies = _conjugate(layer, p), [layer.energy(z) for z in (gap, better)]
    own, lost = (
        weights * np.maximum(energy + conjugate + p * z, 0.0) for energy, z in zip(energies, (gap, better), strict=True)
    )
    of_layers = [float(weights @ energy) for energy in energies]
    return _ContactPart(of_layers[0], float(own.sum()), of_layers[1], np.bincount(pressure.facets, lost).astype(float))


def _conjugate(layer: Layer, p: Floats) -> Floats:
    """G*(p) = p c − G(c) at the compression c of the pressure p: Legendre's transform of the layer's energy."""
    w = layer.compression(-p)
    found: Floats = -p * w - layer.energy(w)
    return found


def _body_parts(body: Body, u: fem.Function, pressures: Sequence[SurfacePressure], degree: int) -> Floats:
    """½ ∫ (σ − C ε(u)) : C⁻¹ (σ − C ε(u)) over every cell, σ the nearest stress in equilibrium."""
    stresses, strain = EquilibratedStresses(body, degree), body.kinematics.strain(u)
    sigma = stresses.nearest(strain, _contact_loads(body, pressures, degree))
    difference = voigt(rows(sigma)) - body.stiffness * strain
    density = 0.5 * ufl.inner(stresses.compliance * difference, difference)
    found: Floats = fem.assemble_vector(compat.form(body.elements.by_cell(density))).array
    return np.maximum(found, 0.0)


def _contact_loads(body: Body, pressures: Sequence[SurfacePressure], degree: int) -> list[tuple[str, fem.Function]]:
    """The pressure on every contact surface of a body, as a function of Lagrange elements."""
    found = []
    for pressure in pressures:
        for side, surface in pressure.contact.sides:
            if side.name == body.name:
                space = fem.functionspace(body.mesh.domain, ("Lagrange", degree))
                nodes = fem.locate_dofs_topological(space, 1, body.mesh.facets(surface))
                function = fem.Function(space)
                function.x.array[nodes] = pressure.at(space.tabulate_dof_coordinates()[nodes, :2])
                found.append((surface, function))
    return found
