"""The next mesh of an adaptation: which cells are halved, and how large all are wanted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from dolfinx import fem
from numpy.typing import NDArray

from .base import compat
from .base.arrays import Floats
from .base.triangles import areas
from .body import Body
from .error_estimate import ErrorEstimate, cell_energies
from .interface.surface import ContactSurface
from .scene import Scene
from .smoothing import outline_points, smoothed, smooths
from .solution import STIFF

#: Which cells of a body, (cells,).
Marks = NDArray[np.bool_]

#: What part of the error of the pressure the halved cells carry where meshes are not smoothed: of what the error of
#: displacements in cells does to it, and of its square on the contacts' own facets. Smaller parts save a few cells and
#: cost more rounds.
INFLUENCE_SHARE, PRESSURE_SHARE = 0.7, 0.3

#: The factor by which the error of smoothed meshes is to fall in a round, at most: farther the estimate does not see.
FASTEST = 3.8

#: The part of the wanted error that a smoothed mesh is made for.
AIM = 0.85

#: The least part of the largest influence that counts in the wanted sizes of cells.
LEAST = 1e-12

#: Errors that differ by less are alike: bodies that are copies of each other stay so, and are condensed once.
ALIKE = 1e-6


@dataclass(frozen=True)
class Plan:
    """What becomes of the meshes of bodies, by name, of those whose cells are refined.

    halved: which cells (cells,) are halved; sizes: the wanted sizes of all cells (cells,), relative to each other, of
    no body where meshes are not smoothed; edges: (e, 2) where contacts end and nodes are wanted (length).
    """

    halved: Mapping[str, Marks]
    sizes: Mapping[str, Floats]
    edges: Floats


def planned(estimate: ErrorEstimate, accuracy: float) -> Plan:
    """The plan for the next mesh of a solution whose error is too large."""
    bodies, influences = estimate.solution.scene.bodies, _cell_influences(estimate)
    meshed = [body for body in bodies if body.mesh is not None]
    smooth, degree = _can_be_smoothed(estimate), min(body.degree for body in meshed)
    growth = _growth(estimate, degree, accuracy)
    marks = _interspersed(influences, degree, growth) if smooth else _worst(estimate, influences)
    halved = {body.name: own for body, own in zip(bodies, marks, strict=True) if own.any()}
    of = {body.name: own for body, own in zip(bodies, influences, strict=True)}
    sizes = {body.name: _wanted_sizes(body, of[body.name]) for body in meshed if smooth and body.name in halved}
    # Linear elements gain nothing from nodes at edges.
    edges = [each.better.edge for each in estimate.contacts] if smooth and degree > 1 else []
    return Plan(halved, sizes, np.concatenate([np.zeros((0, 2)), *edges]))


def _can_be_smoothed(estimate: ErrorEstimate) -> bool:
    """Whether all meshes are of straight plane triangles, and no layer is so stiff that it wants nodes beside nodes."""
    stiff = any(each.result.hard or each.result.stiffness_ratio > STIFF for each in estimate.contacts)
    bodies = estimate.solution.scene.bodies
    return not stiff and all(body.mesh is None or smooths(body.mesh) for body in bodies)


def _wanted_sizes(body: Body, influences: Floats) -> Floats:
    """The relative sizes (cells,) with which all plane cells of as many would have the same influence."""
    x, cells = body.mesh.domain.geometry.x[:, :2], compat.geometry_dofmap(body.mesh.domain)
    order = body.degree + 1  # ‖e‖ and ‖z − I z‖ fall like h^degree each, by area
    by_size = np.maximum(influences, LEAST * influences.max()) / np.abs(areas(x, cells)) ** order
    return np.asarray(by_size ** (-0.5 / order))


def remade(scene: Scene, plan: Plan, first: Scene) -> Scene:
    """The scene on the next meshes; first: as before all rounds.

    Nodes of the first outline stay where meshes are smoothed, as loads, gaps and supports may change there; but not
    those of contacts.
    """
    finer = scene.refined(plan.halved)
    smooth = {}
    for name, sizes in plan.sizes.items():
        index = scene.body_index(name)
        body = finer.bodies[index]
        touched = [surface for each in scene.contacts for own, surface in each.sides if own is scene.bodies[index]]
        held = outline_points(first.bodies[index].mesh, touched)
        parents = body.mesh.refined_from[1].parents
        smooth[name] = body.on(smoothed(body.mesh, sizes[parents], held, plan.edges))
    return finer.with_bodies(smooth)


def _growth(estimate: ErrorEstimate, degree: int, accuracy: float) -> float:
    """How many times as many plane cells the next mesh has: rounds that are left make alike steps."""
    missing = max(estimate.pressure.relative / (AIM * accuracy), 1.0)
    factor = missing ** (1 / np.ceil(np.log(missing) / np.log(FASTEST)))
    return float(factor ** (2 / (degree + 1)))


def _worst(estimate: ErrorEstimate, influences: Sequence[Floats]) -> list[Marks]:
    """Which cells of every body make up most of the error."""
    chosen = _each(_largest(np.concatenate(influences), INFLUENCE_SHARE), influences)
    facets = _facet_errors(estimate)
    for (place, cell), keep in zip(facets, _largest(list(facets.values()), PRESSURE_SHARE), strict=True):
        chosen[place][cell] |= keep
    return chosen


def _interspersed(influences: Sequence[Floats], degree: int, growth: float) -> list[Marks]:
    """Plane cells to be halved for so many times as many, evenly among those that should all become a little smaller.

    Where all cells have the influence λ, an influence η stands for (η/λ)^(1/(degree + 1)) of them. Halving makes four
    of one; with what neighbours are cut for it, a part f of all makes 9 f / (1 + 2 f) more of each, as measured.
    """
    together = np.concatenate(influences)
    logarithms = np.log(np.maximum(together, LEAST * together.max()))

    def parts(level: float) -> Floats:
        return np.clip(np.expm1((logarithms - level) / (degree + 1)) / 3, 0.0, 1.0)

    low, high, wanted = logarithms.min() - 2 * (degree + 1), logarithms.max(), (growth - 1) / (9 - 2 * (growth - 1))
    for _ in range(50):
        level = 0.5 * (low + high)
        low, high = (level, high) if parts(level).mean() > wanted else (low, level)
    found, largest = [], together >= (1 - ALIKE) * together.max()
    for own, worst in zip(_each(parts(high), influences), _each(largest, influences), strict=True):
        counted = np.floor(np.cumsum(own * (1 + ALIKE)) + 0.5)
        found.append((np.diff(counted, prepend=0.0) > 0) | worst)
    return found


def _each(values: Any, influences: Sequence[Floats]) -> list[Any]:
    """The values of the cells of every body."""
    return np.split(values, np.cumsum([len(each) for each in influences])[:-1])


def _largest(values: Sequence[float] | Floats, share: float) -> Any:
    """Which values (n,) are the fewest that make up a share of their sum, and others like the least of them."""
    array = np.asarray(values, dtype=float)
    order = np.argsort(-array, kind="stable")
    before = np.concatenate([[0.0], np.cumsum(array[order])[:-1]])
    kept = np.zeros(len(array), dtype=bool)
    kept[order] = (before < share * array.sum()) & (array[order] > 0.0)
    return kept | (array >= (1 - ALIKE) * array[kept].min(initial=np.inf))


def _facet_errors(estimate: ErrorEstimate) -> dict[tuple[int, int], float]:
    """∫ (p − p_better)² over the facets of both sides of all contacts, by body and cell."""
    found: dict[tuple[int, int], float] = {}
    for interface, contact in zip(estimate.solution.interfaces, estimate.contacts, strict=True):
        for side in interface.sides:
            surface = side.surface
            if not isinstance(surface, ContactSurface):
                continue
            squares = surface.weights * (side.transfer @ contact.pressure_error**2)
            for cell, error in zip(surface.entities[:, 0], squares.reshape(len(surface.facets), -1), strict=True):
                key = side.body, int(cell)
                found[key] = found.get(key, 0.0) + float(error.sum())
    return found


def _cell_influences(estimate: ErrorEstimate) -> list[Floats]:
    """‖e‖ ‖z − I z‖ in the energy norm over every cell of every body, (cells,) each, empty for one without a mesh.

    e is the displacement's estimated error, z its influence on ∫ (p − p_better)² and I z that in the solution's own
    elements: those that they can show cause no error.
    """
    better, bodies = estimate.better, estimate.solution.scene.bodies
    influences = better.influence(_errors_at_better_points(estimate))
    found: list[Floats] = []
    for own, body, z in zip(bodies, better.scene.bodies, influences, strict=True):
        if body.mesh is None:
            found.append(np.zeros(0))
            continue
        error = estimate.displacement_error(body.name).x.array
        energies = cell_energies(body, [error, z - _shown(z, body, own)])
        found.append(np.sqrt(energies[0] * energies[1]))
    return found


def _shown(z: Floats, body: Body, own: Body) -> Floats:
    """A displacement (dofs,) of a body as the elements of a lower degree show it."""
    whole, shown, again = (fem.Function(each.space) for each in (body, own, body))
    whole.x.array[:] = z
    shown.interpolate(whole)
    again.interpolate(shown)
    return again.x.array


def _errors_at_better_points(estimate: ErrorEstimate) -> list[Floats]:
    """p − p_better at the points of the better solution's contacts."""
    contacts = zip(estimate.better.interfaces, estimate.contacts, strict=True)
    return [estimate.solution.contact_at(interface)[1] - contact.better.pressure for interface, contact in contacts]
