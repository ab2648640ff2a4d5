"""Whether a result is one: K u = l + contact forces over all bodies at once, from the reported pressures alone.

The displacements are the solution's, the contact forces are integrals of the reported pressures over the reported
points, everything else is made anew (`weak_form`): stiffnesses, loads, where the points lie on both bodies, gaps.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray
from weak_form import WeakForm

import contactdd as cd

Floats = NDArray[np.float64]

#: What is left of a force K u as u is kept in double precision: 1e-16 of each of about a hundred terms.
ROUNDING = 5e-15


@dataclass(frozen=True)
class Law:
    """A layer and, written out, the compression c (length) under a pressure (n,) at x (n, dim).

    slack: of contact without a layer, the penetration over the largest pressure that is let be (length / stress).
    """

    layer: cd.Layer | cd.HardContact
    compression: Callable[[Floats, Floats], Floats]
    slack: float = 0.0

    def off(self, gap: Floats, pressure: Floats, x: Floats) -> float:
        """By how much gaps are not what the pressures ask for (length), beyond the slack."""
        compression = self.compression(pressure, x)
        off = np.where(pressure > 0.0, np.abs(gap + compression), np.maximum(-gap, 0.0))
        return float(off.max()) - self.slack * float(pressure.max())


@dataclass
class Findings:
    """What a check measured, each relative to what it is compared with.

    residual: K u − l − contact forces, to the forces at work; support: prescribed displacements; gap: reported gaps
    against displacements evaluated anew; law: the gap against the compression under the reported pressure; reaction:
    the contacts' forces on both bodies together; balance: the resultants on a body; area: of the contact.
    """

    residual: float = 0.0
    support: float = 0.0
    gap: float = 0.0
    law: float = 0.0
    reaction: float = 0.0
    balance: float = 0.0
    area: float = 0.0

    def note(self, name: str, value: float) -> None:
        """Keep the largest; what is not a number is the largest of all."""
        old = getattr(self, name)
        setattr(self, name, value if not value <= old else old)


class Monolithic:
    """All bodies of a scene as one system, see the module.

    Args:
        scene: The scene.
        forms: The weak form of each body that has a mesh, by its name.
        laws: Of each contact, in order.
        curved: Whether the surfaces are curved and do not match: then the points lie on neither body's facets, and
            only what does not need that is checked.
    """

    def __init__(self, scene: cd.Scene, forms: Mapping[str, WeakForm], laws: list[Law], curved: bool = False) -> None:
        self.scene, self.forms, self.laws, self.curved = scene, forms, laws, curved

    def check(self, solution: cd.Solution) -> Findings:
        """What is not as it should be."""
        found = Findings()
        displacements = {b.name: _array(solution.displacement(b)) for b in self.scene.bodies}
        contact_forces = {name: np.zeros_like(u) for name, u in displacements.items()}
        for index in range(len(self.laws)):
            self._check_area(solution.contact(index), index, found)
            if not self.curved:
                self._check_contact(solution, index, displacements, contact_forces, found)
        if not self.curved:
            self._check_equilibrium(displacements, contact_forces, found)
        self._check_resultants(solution, found)
        return found

    def _check_contact(
        self,
        solution: cd.Solution,
        index: int,
        displacements: Mapping[str, Floats],
        contact_forces: dict[str, Floats],
        found: Findings,
    ) -> None:
        contact, result = self.scene.contacts[index], solution.contact(index)
        law, mortar = self.laws[index], contact.quadrature == "mortar"
        # The mortar rule's pressures are at nodes, linear in between: their forces are integrals over Gauss points.
        points = (
            solution.contact(index, degree=2 * max(b.degree for b, _ in contact.sides if b.mesh)) if mortar else result
        )
        undeformed, operators = self._seen(contact, points)
        push = points.weights * points.pointwise_pressure
        approach, sizes = np.zeros(len(push)), [1e-300]
        for (body, _), operator in zip(contact.sides, operators, strict=True):
            u = displacements[body.name]
            contact_forces[body.name] -= operator.T @ push
            approach += operator @ u
            sizes.append(np.abs(u).max(initial=0.0))
        gap = undeformed - approach
        # A gap is a small difference of displacements and of distances found between coordinates.
        size = max(*sizes, np.abs(undeformed).max())
        if mortar:  # the weights of the nodes' linear functions add up to those of the points
            mean = abs(points.weights @ gap - result.weights @ result.gap) / result.weights.sum()
            found.note("gap", 0.0 if callable(contact.gap) else mean / size)  # other points see other waves
            gap = result.gap
        found.note("gap", np.abs(gap - result.gap).max() / size)
        pressure = result.pointwise_pressure
        found.note("law", law.off(gap, pressure, result.x) / size)
        if np.any(pressure < 0.0) or (not law.slack and np.any((pressure > 0.0) & (result.gap > 0.0))):
            found.note("law", np.inf)

    def _check_equilibrium(
        self, displacements: Mapping[str, Floats], contact_forces: Mapping[str, Floats], found: Findings
    ) -> None:
        rests, works, roundings = [], [0.0], [0.0]
        for body in self.scene.bodies:
            u, contact = displacements[body.name], contact_forces[body.name]
            if body.mesh is None:
                free = np.isnan(body.prescribed())
                rests.append((body.stiffness() @ u - body.load() - contact)[free])
                works += [np.linalg.norm(body.load()[free]), np.linalg.norm(contact[free])]
                continue
            form = self.forms[body.name]
            K, load = form.stiffness, form.load()
            rests.append(form.free(K @ u - load - contact))
            works += [np.linalg.norm(form.free(load)), np.linalg.norm(form.free(contact))]
            roundings.append(ROUNDING * np.linalg.norm(abs(K) @ np.abs(u)))
            largest = max(np.abs(u).max(), 1e-300)
            for node, direction, value in form.held():
                found.note("support", abs(u.reshape(-1, form.dim)[node] @ direction - value) / largest)
        rest, work = np.linalg.norm(np.concatenate(rests)), np.linalg.norm(works)
        # What rounding leaves is no fault; where nothing is at work it is all there may be.
        rounding = np.linalg.norm(roundings)
        if work == 0.0:  # nothing touches: beside what would move the bodies as far as anything moves
            furthest = max(np.abs(u).max() for u in displacements.values())
            work = furthest * max(np.linalg.norm(abs(f.stiffness).sum(axis=1)) for f in self.forms.values())
        found.note("residual", max(rest - rounding, 0.0) / max(work, 1e-300))

    def _check_resultants(self, solution: cd.Solution, found: Findings) -> None:
        """Action = reaction, and every body in balance."""
        forces = {b.name: solution.forces(b) for b in self.scene.bodies}
        sizes = [
            np.linalg.norm(solution.contact(i).weights * solution.contact(i).pressure) for i in range(len(self.laws))
        ]
        sizes += [np.abs(part).max() for parts in forces.values() for part in parts.values()]
        size = max(*sizes, 1e-300)
        total = {name: -parts["contact"] * (not self.curved) for name, parts in forces.items()}
        for index, contact in enumerate(self.scene.contacts):
            vector = solution.contact(index).force_vector
            for (body, _), sign in zip(contact.sides, (0.0, 0.0) if self.curved else (1.0, -1.0), strict=True):
                total[body.name] = total[body.name] + sign * vector
        found.note("reaction", max(np.abs(rest).max() for rest in total.values()) / size)
        found.note("reaction", np.abs(sum(parts["contact"] for parts in forces.values())).max() / size)
        pressed = any(np.any(solution.contact(i).pressure > 0.0) for i in range(len(self.laws)))
        if not self.curved and (pressed or any(np.any(form.load()) for form in self.forms.values())):
            found.note("balance", solution.imbalance)

    def _check_area(self, result: cd.ContactResult, index: int, found: Findings) -> None:
        """The points stand for all of each surface that is not said to lie opposite nothing."""
        for side, (body, name) in enumerate(self.scene.contacts[index].sides):
            if body.mesh is not None and not self.curved:
                area = self.forms[body.name].surface(name).weight.sum()
                found.note("area", abs(result.weights.sum() + result.unpaired_area[side] - area) / area)

    def _seen(self, contact: cd.Contact, result: cd.ContactResult) -> tuple[Floats, list[scipy.sparse.csr_matrix]]:
        """The gap before deformation at the points, (n,), and from each body's displacements to u_n there."""
        (first, name), (second, other) = contact.sides
        if first.mesh is None or second.mesh is None:
            return self._seen_from_one(contact, result)
        if contact.quadrature == "facet":
            return self._by_facets(contact, result)
        here, there = self.forms[first.name], self.forms[second.name]
        _, shapes = here.opposite(name, result.x, -result.normal)
        distance, opposite = there.opposite(other, result.x, result.normal)
        return _undeformed(contact, result.x, distance, result.normal), [
            here.normal_displacement(shapes, result.normal), there.normal_displacement(opposite, -result.normal)
        ]  # fmt: skip

    def _by_facets(self, contact: cd.Contact, result: cd.ContactResult) -> tuple[Floats, list[scipy.sparse.csr_matrix]]:
        """One value for every facet: the means over it, on flat surfaces that match."""
        (first, name), (second, other) = contact.sides
        here, there = self.forms[first.name], self.forms[second.name]
        points = here.surface(name, 2 * max(first.degree, second.degree))  # a gap's mean is by contactdd's points
        per_facet = len(points.weight) // len(first.mesh.facets(name))
        middles = points.x.reshape(-1, per_facet, here.dim).mean(axis=1)
        order = np.array([np.argmin(np.linalg.norm(middles - x, axis=1)) for x in result.x])
        chosen = (order[:, None] * per_facet + np.arange(per_facet)).ravel()
        rows = np.repeat(np.arange(len(order)), per_facet)
        mean = scipy.sparse.csr_matrix((points.weight[chosen] / result.weights[rows], (rows, np.arange(len(chosen)))))
        normal = points.normal[chosen]
        distance, opposite = there.opposite(other, points.x[chosen], normal)
        traces = here.normal_displacement(points.shapes[chosen], normal), there.normal_displacement(opposite, -normal)
        return mean @ _undeformed(contact, points.x[chosen], distance, normal), [mean @ trace for trace in traces]

    def _seen_from_one(
        self, contact: cd.Contact, result: cd.ContactResult
    ) -> tuple[Floats, list[scipy.sparse.csr_matrix]]:
        """Beside a body without a mesh, which says itself where it is."""
        operators, distance = [], np.zeros(len(result.x))
        for (body, name), sign in zip(contact.sides, (1.0, -1.0), strict=True):
            outward = sign * result.normal
            if body.mesh is None:
                distance = body.gap(result.x, -outward)
                operators.append(scipy.sparse.csr_matrix(body.normal_displacement(result.x, -outward)))
            else:
                form = self.forms[body.name]
                shapes = form.opposite(name, result.x, -outward)[1]
                operators.append(form.normal_displacement(shapes, outward))
        return _undeformed(contact, result.x, distance, result.normal), operators


def _array(displacement: object) -> Floats:
    return displacement if isinstance(displacement, np.ndarray) else displacement.x.array


def _undeformed(contact: cd.Contact, x: Floats, distance: Floats, normal: Floats) -> Floats:
    """d at the points, (n,): the surfaces' distance and what is given, midway between them."""
    distance = np.where(np.abs(distance) > 1e-13 * np.abs(x).max(), distance, 0.0)  # less is rounding of coordinates
    gap = contact.gap.value if isinstance(contact.gap, cd.Parameter) else contact.gap
    given = gap((x + 0.5 * distance[:, None] * normal).T) if callable(gap) else gap
    return np.where(contact.measure_gap, distance, 0.0) + given
