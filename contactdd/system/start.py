"""The start of a run: the iterate u⁰ and, for the two-point methods, the one before it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..base.arrays import Floats
from ..base.ranks import Ranks
from ..field import evaluate
from ..hard_contact import AugmentedLayer
from ..layer import Layer
from .state import State

if TYPE_CHECKING:
    from ..interface.discretise import Interface
    from ..local.problem import LocalProblem
    from .ensemble import Ensemble


#: Updates of the layers' secant stiffnesses: then a stack's contacts share a force to a few parts in ten.
SECANTS = 2


#: u_n at the contact points: a number or a function of the coordinates x (dim, n).
Given = float | Callable[[Floats], Floats]


def from_displacements(ensemble: Ensemble, ranks: Ranks, displacements: Callable[[str], Floats]) -> State:
    """The iterate with the displacements (dofs,) of the same bodies, by their names, such as those of a solution."""

    def of(index: int) -> Floats:
        problem = ensemble.problems[index]
        displacement = displacements(problem.name)
        if len(displacement) != len(problem.dofs.load):
            raise ValueError(
                f"start = a solution: its body {problem.name!r} has {len(displacement)} displacement components; "
                f"expected {len(problem.dofs.load)}"
            )
        return problem.restrict(displacement)

    return _state(ensemble, ranks.each(of))


def with_multipliers(state: State, ensemble: Ensemble, multipliers: list[Floats]) -> State:
    """The same iterate with the multipliers (pressures) of hard contacts, if they are of as many points."""
    if [len(pressure) for pressure in multipliers] != [len(gaps) for gaps in state.gaps]:
        return state
    laws = [interface.layer for interface in ensemble.interfaces]
    return replace(state, shifts=[_shift(law, pressure) for law, pressure in zip(laws, multipliers, strict=True)])


def _shift(law: Layer, multiplier: Floats) -> Floats:
    """λ/k of a hard contact, zeros of any other."""
    return np.asarray(multiplier / law.stiffness) if isinstance(law, AugmentedLayer) else 0.0 * multiplier


def from_contacts(ensemble: Ensemble, ranks: Ranks, u_n: Given, previous: Given | None) -> State:
    """The iterate with u_n at all contact points (length) and the inside in equilibrium; previous: u_n one before."""
    given = {index: _at_points("start", u_n, interface) for index, interface in enumerate(ensemble.interfaces)}
    state = _state(ensemble, ranks.each(lambda index: ensemble.problems[index].start(given)))
    if previous is not None:
        state.previous_gaps = [i.gap - 2.0 * _at_points("previous", previous, i) for i in ensemble.interfaces]
    return state


def undeformed(ensemble: Ensemble) -> State:
    """Undeformed bodies, moved only by the rigid part of prescribed displacements."""
    return _state(ensemble, [np.zeros(ensemble.size)])


def rigidly_closed(ensemble: Ensemble) -> State:
    """Undeformed bodies; floating ones are translated and rotated until their contacts carry about the mean load.

    Where displacements are prescribed, until the contacts are as evenly compressed as these allow. Linear least-squares
    problems for the rigid motions; those that springs resist are left out.
    """
    motions, compressions = ensemble.rigid, _compressions(ensemble)
    prescribed = any(problem.dofs.prescribed for problem in ensemble.problems)
    if not np.any(motions.unsprung) or not (prescribed or np.any(compressions)):
        return undeformed(ensemble)
    contacts = list(zip(ensemble.interfaces, ensemble.gaps(np.zeros(ensemble.size)), compressions, strict=True))
    wanted = np.concatenate([np.sqrt(i.weights) * (_least(i, z) - w) for i, z, w in contacts])
    points = [len(z) for _, z, _ in contacts]

    def moved(stiffnesses: Floats) -> State:
        return _state(ensemble, [motions.displacements(motions.closest(np.repeat(stiffnesses, points), wanted))])

    state = moved(np.ones(len(contacts)))
    for _ in range(SECANTS if prescribed else 0):
        state = moved(_secant_stiffnesses(ensemble, state))
    return state


def uniformly_closed(ensemble: Ensemble, ranks: Ranks) -> State:
    """All contacts closed by a uniform amount: the smallest gap carries the largest mean contact stress of a body.

    Floating bodies need such a start: with all contacts open nothing would hold them.
    """
    if any(problem.dofs.prescribed for problem in ensemble.problems):
        return _closed_from_prescribed(ensemble, ranks)
    given = {
        index: np.full(len(interface.weights), 0.5 * (interface.gap.min() - w))
        for index, (interface, w) in enumerate(zip(ensemble.interfaces, _compressions(ensemble), strict=True))
    }
    return _state(ensemble, ranks.each(lambda index: ensemble.problems[index].start(given)))


def _closed_from_prescribed(ensemble: Ensemble, ranks: Ranks) -> State:
    """The same from the rigid motions of prescribed displacements, which may close contacts further."""
    moved, compressions = rigidly_closed(ensemble), _compressions(ensemble)
    contacts = zip(ensemble.interfaces, moved.gaps, compressions, strict=True)
    approach = [0.0 if i.slides is not None else max(0.5 * (float(z.min()) - w), 0.0) for i, z, w in contacts]
    parts = ensemble.split(moved.unknowns)

    def of(index: int) -> Floats:
        traces = ensemble.problems[index].traces
        return ensemble.problems[index].start(
            {t.interface: t.trace @ parts[index] + t.offset + approach[t.interface] for t in traces}
        )

    return _state(ensemble, ranks.each(of))


def _at_points(name: str, value: Given, interface: Interface) -> Floats:
    """The values of a number or a function of the coordinates x (dim, n) at the points of an interface; no slip."""
    return evaluate(name, value if interface.slides is None else 0.0, interface.x.T)


def _compressions(ensemble: Ensemble) -> list[float]:
    """The compressions w of all contacts under the largest mean contact stress of a body; no slip of a bond."""
    stress = max(_mean_contact_stress(ensemble, problem) for problem in ensemble.problems)
    return [0.0 if i.slides is not None else float(np.mean(i.layer.compression(-stress))) for i in ensemble.interfaces]


def _least(interface: Interface, gaps: Floats) -> float | Floats:
    """The approach that closes a contact; of a bond's sliding that which takes back the slip at every point."""
    return gaps if interface.slides is not None else float(gaps.min())


def _mean_contact_stress(ensemble: Ensemble, problem: LocalProblem) -> float:
    """The resultant of a body's loads over the area of its contacts."""
    area = sum(float(ensemble.interfaces[port.interface].weights.sum()) for port in problem.traces)
    return problem.dofs.load_size / area


def _secant_stiffnesses(ensemble: Ensemble, state: State) -> Floats:
    """The secant stiffness p/w of each layer where it is compressed most, (interfaces,)."""
    depths = np.array([max(-float(z.min()), 0.0) for z in state.gaps])
    if not np.any(depths):
        return np.ones(len(depths))
    layers = [interface.layer for interface in ensemble.interfaces]
    pressures = np.array([-float(np.mean(law.contact_stress(-w))) for law, w in zip(layers, depths, strict=True)])
    typical = np.full(len(depths), pressures.max() / depths.max())
    secants = np.divide(pressures, depths, out=typical, where=depths > 0.0)
    return np.maximum(secants, 1e-12 * secants.max())


def _state(ensemble: Ensemble, parts: list[Floats]) -> State:
    """The iterate with given unknowns, by body or of all."""
    y = np.concatenate(parts)
    gaps = ensemble.gaps(y)
    return State(y, ensemble.deformation(y), gaps, gaps)
