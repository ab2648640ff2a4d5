"""Where a run starts: the iterate u⁰ and, for the two-point methods, the one before it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..base.arrays import Floats
from ..base.ranks import Ranks
from ..field import evaluate
from .state import State

if TYPE_CHECKING:
    from ..interface.discretise import Interface
    from ..local.problem import LocalProblem
    from .ensemble import Ensemble


#: How often the layers' secant stiffnesses are found anew: then a stack's contacts share a force to a few parts in ten.
SECANTS = 2


#: u_n at the contact points: a number or a function of the coordinates x (dim, n).
Given = float | Callable[[Floats], Floats]


def from_displacements(ensemble: Ensemble, displacements: Callable[[str], Floats]) -> State:
    """Go on from the displacements (dofs,) of the same bodies, by their names, such as a solution has them."""
    parts = []
    for problem in ensemble.problems:
        displacement = displacements(problem.name)
        if len(displacement) != len(problem.dofs.load):
            raise ValueError(
                f"start = a solution: its body {problem.name!r} has {len(displacement)} displacement components; "
                f"expected {len(problem.dofs.load)}"
            )
        parts.append(problem.restrict(displacement))
    return _state(ensemble, parts)


def with_multipliers(state: State, ensemble: Ensemble, multipliers: list[Floats]) -> State:
    """The same iterate with the multipliers of hard contacts, pressures, if they are of as many points."""
    if [len(pressure) for pressure in multipliers] != [len(gaps) for gaps in state.gaps]:
        return state
    contacts = zip(ensemble.interfaces, multipliers, strict=True)
    return replace(state, shifts=[p / i.contact.layer.stiffness if i.hard else 0.0 * p for i, p in contacts])


def from_contacts(ensemble: Ensemble, ranks: Ranks, u_n: Given, previous: Given | None) -> State:
    """u_n at all contact points (length) and, if given, that of the iterate before; the inside in equilibrium."""
    given = {index: _at_points("start", u_n, interface) for index, interface in enumerate(ensemble.interfaces)}
    state = _state(ensemble, ranks.each(lambda index: ensemble.problems[index].start(given)))
    if previous is not None:
        state.previous_gaps = [i.gap - 2.0 * _at_points("previous", previous, i) for i in ensemble.interfaces]
    return state


def undeformed(ensemble: Ensemble) -> State:
    """No displacement but the prescribed ones, and the rigid motions along which they carry their bodies."""
    return _state(ensemble, [np.zeros(ensemble.size)])


def together(ensemble: Ensemble) -> State:
    """No deformation, but bodies are carried along by what is prescribed, and those that float are moved until their
    contacts are about as closed as the loads want, or as evenly pressed as prescribed displacements leave them.

    Linear least-squares problems for the rigid motions; those that springs resist are left alone.
    """
    motions, compressions = ensemble.rigid, _compressions(ensemble)
    floating = ~np.any(motions.springs, axis=0)
    prescribed = any(problem.dofs.prescribed for problem in ensemble.problems)
    if not np.any(floating) or not (prescribed or np.any(compressions)):
        return undeformed(ensemble)
    contacts = list(zip(ensemble.interfaces, ensemble.gaps(np.zeros(ensemble.size)), compressions, strict=True))
    wanted = np.concatenate([np.sqrt(i.weights) * (z.min() - w) for i, z, w in contacts])
    closing = np.vstack([contact.rows for contact in motions.contacts])[:, floating]

    def moved(stiffnesses: Floats) -> State:
        roots = np.sqrt(np.repeat(stiffnesses, [len(z) for _, z, _ in contacts]))
        coefficients = np.linalg.lstsq(roots[:, None] * closing, roots * wanted, rcond=1e-10)[0]
        return _state(ensemble, [motions.modes[:, floating] @ coefficients])

    state = moved(np.ones(len(contacts)))
    for _ in range(SECANTS if prescribed else 0):
        state = moved(_secant_stiffnesses(ensemble, state))
    return state


def closed(ensemble: Ensemble, ranks: Ranks) -> State:
    """Every contact closed evenly, until where its gap is smallest it carries the largest mean load of a body.

    Bodies that float need such a start: with all contacts open nothing would hold them.
    """
    if any(problem.dofs.prescribed for problem in ensemble.problems):
        return _closed_where_carried(ensemble, ranks)
    given = {
        index: np.full(len(interface.weights), 0.5 * (interface.gap.min() - w))
        for index, (interface, w) in enumerate(zip(ensemble.interfaces, _compressions(ensemble), strict=True))
    }
    return _state(ensemble, ranks.each(lambda index: ensemble.problems[index].start(given)))


def _closed_where_carried(ensemble: Ensemble, ranks: Ranks) -> State:
    """The same from where prescribed displacements carry the bodies, or press them closer."""
    there, compressions = together(ensemble), _compressions(ensemble)
    approach = [max(0.5 * (float(z.min()) - w), 0.0) for z, w in zip(there.gaps, compressions, strict=True)]
    parts = ensemble.split(there.unknowns)

    def of(index: int) -> Floats:
        traces = ensemble.problems[index].traces
        return ensemble.problems[index].start(
            {t.interface: t.trace @ parts[index] + t.offset + approach[t.interface] for t in traces}
        )

    return _state(ensemble, ranks.each(of))


def _at_points(name: str, value: Given, interface: Interface) -> Floats:
    """A number or a function of the coordinates x (dim, n) at the points of an interface."""
    return evaluate(name, value, interface.x.T)


def _compressions(ensemble: Ensemble) -> list[float]:
    """w of every contact under the largest mean load of a body."""
    stress = max(_mean_contact_stress(ensemble, problem) for problem in ensemble.problems)
    return [float(np.mean(interface.contact.layer.compression(-stress))) for interface in ensemble.interfaces]


def _mean_contact_stress(ensemble: Ensemble, problem: LocalProblem) -> float:
    """The resultant of a body's loads over the area of its contacts."""
    area = sum(float(ensemble.interfaces[port.interface].weights.sum()) for port in problem.traces)
    return problem.dofs.load_size / area


def _secant_stiffnesses(ensemble: Ensemble, state: State) -> Floats:
    """p/w of every layer where it is compressed most, (interfaces,): springs like that in a row share a force."""
    depths = np.array([max(-float(z.min()), 0.0) for z in state.gaps])
    if not np.any(depths):
        return np.ones(len(depths))
    layers = [interface.contact.layer for interface in ensemble.interfaces]
    pressures = np.array([-float(np.mean(law.contact_stress(-w))) for law, w in zip(layers, depths, strict=True)])
    typical = np.full(len(depths), pressures.max() / depths.max())
    secants = np.divide(pressures, depths, out=typical, where=depths > 0.0)
    return np.maximum(secants, 1e-12 * secants.max())


def _state(ensemble: Ensemble, parts: list[Floats]) -> State:
    """The iterate with these unknowns, given by body or all together."""
    y = np.concatenate(parts)
    gaps = ensemble.gaps(y)
    return State(y, ensemble.deformation(y), gaps, gaps)
