"""Where a run starts: the iterate u⁰ and, for the two-point methods, the one before it."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .errors import finite
from .field import evaluate
from .rigid import RigidMotions
from .subproblem import Subproblem

if TYPE_CHECKING:
    from .interface import Interface
    from .scene import Scene
    from .solution import Solution

Floats = NDArray[np.float64]
#: u_n at the contact points: a number or a function of the coordinates x (dim, n).
Given = float | Callable[[Floats], Floats]


@dataclass
class State:
    """An iterate.

    unknowns: of every body; deformations: the unknowns without the rigid motion of floating bodies, which may be so
    much larger that its rounding alone would look like a force; gaps, previous_gaps: z^k, z^{k−1} of every interface.
    """

    unknowns: list[Floats]
    deformations: list[Floats]
    gaps: list[Floats]
    previous_gaps: list[Floats]


def from_solution(scene: Scene, problems: Sequence[Subproblem], solution: Solution) -> State:
    """Go on from the displacements of a solution of the same bodies."""
    unknowns = [p.restrict(solution.displacement(p.body.name).x.array) for p in problems]
    return _state(scene, problems, unknowns)


def from_contacts(scene: Scene, problems: Sequence[Subproblem], u_n: Given, previous: Given | None) -> State:
    """u_n at all contact points (length) and, if given, that of the iterate before; the inside in equilibrium."""
    given = {index: _at_points("start", u_n, interface) for index, interface in enumerate(scene.interfaces)}
    state = _state(scene, problems, [problem.start(given) for problem in problems])
    if previous is not None:
        state.previous_gaps = [i.gap - 2.0 * _at_points("previous", previous, i) for i in scene.interfaces]
    return state


def undeformed(scene: Scene, problems: Sequence[Subproblem]) -> State:
    """No displacement but the prescribed ones."""
    return _state(scene, problems, [np.zeros(problem.size) for problem in problems])


def together(scene: Scene, problems: Sequence[Subproblem], motions: RigidMotions) -> State:
    """No deformation, but bodies that float are moved until their contacts are about as closed as the loads want.

    A linear least-squares problem for the rigid motions; those that springs resist are left alone, and all are where it
    is not the loads that press: contacts that only just touch would close one after the other.

    motions: the free rigid motions of all bodies together.
    """
    floating = ~np.any(motions.springs, axis=0)
    compressions = _compressions(scene, problems)
    if not np.any(floating) or not np.any(compressions) or any(np.any(problem.space.offset) for problem in problems):
        return undeformed(scene, problems)
    contacts = zip(scene.interfaces, compressions, strict=True)
    wanted = np.concatenate([np.sqrt(i.weights) * (i.gap.min() - w) for i, w in contacts])
    closing = np.vstack([contact.rows for contact in motions.contacts])[:, floating]
    unknowns = motions.modes[:, floating] @ np.linalg.lstsq(closing, wanted, rcond=1e-10)[0]
    ends = itertools.accumulate(problem.size for problem in problems)
    return _state(
        scene, problems, [unknowns[end - problem.size : end] for problem, end in zip(problems, ends, strict=True)]
    )


def closed(scene: Scene, problems: Sequence[Subproblem]) -> State:
    """Every contact closed evenly, until where its gap is smallest it carries the largest mean load of a body.

    Bodies that float need such a start: with all contacts open nothing would hold them.
    """
    given = {
        index: np.full(len(interface.weights), 0.5 * (interface.gap.min() - w))
        for index, (interface, w) in enumerate(zip(scene.interfaces, _compressions(scene, problems), strict=True))
    }
    return _state(scene, problems, [problem.start(given) for problem in problems])


def _at_points(name: str, value: Given, interface: Interface) -> Floats:
    """A number or a function of the coordinates x (dim, n) at the points of an interface."""
    return evaluate(name, value if callable(value) else finite(name, value), interface.x.T)


def _compressions(scene: Scene, problems: Sequence[Subproblem]) -> list[float]:
    """w of every contact under the largest mean load of a body."""
    stress = max(_mean_contact_stress(scene, problem) for problem in problems)
    return [float(interface.contact.layer.compression(-stress)) for interface in scene.interfaces]


def _mean_contact_stress(scene: Scene, problem: Subproblem) -> float:
    """The resultant of a body's loads over the area of its contacts."""
    area = sum(float(scene.interfaces[port.interface].weights.sum()) for port in problem.ports)
    resultant = problem.full_load.reshape(-1, problem.body.mesh.dim).sum(axis=0)
    return float(np.linalg.norm(resultant)) / area


def _state(scene: Scene, problems: Sequence[Subproblem], unknowns: list[Floats]) -> State:
    gaps = scene.gaps(problems, unknowns)
    return State(unknowns, [p.deformation(y) for p, y in zip(problems, unknowns, strict=True)], gaps, gaps)
