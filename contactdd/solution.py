"""What a solve returns: displacements, contact pressures and gaps, energies, stresses, and how it went."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import basix.ufl
import numpy as np
from dolfinx import fem
from numpy.typing import NDArray

from .base import compat
from .base.arrays import Floats
from .body import Body
from .contact import Contact
from .field import inner_element
from .history import History
from .interface.discretise import Interface, discretise

if TYPE_CHECKING:
    from .local.problem import Fields
    from .scene import Scene
    from .system.ensemble import Ensemble
    from .system.state import State


@dataclass(frozen=True)
class ContactResult:
    """A contact at n points.

    x: (n, dim) where; weights: (n,) areas; gap: (n,) the deformed gap z = d − u_αn − u_βn (length); compression: (n,)
    the layer's w = min(z, 0); pressure: (n,) −σ_n >= 0 (stress); normal: (n, dim) outward of the first body;
    unmatched: the area of either surface that lies opposite nothing and is therefore outside the contact.
    """

    x: Floats
    normal: Floats
    weights: Floats
    gap: Floats
    compression: Floats
    pressure: Floats
    unmatched: tuple[float, float] = (0.0, 0.0)

    @property
    def closed(self) -> NDArray[np.bool_]:
        """Where the layer is compressed, (n,)."""
        return self.gap < 0.0

    @property
    def force(self) -> float:
        """∫ p ds: per unit thickness in the plane, of the full ring between bodies of revolution."""
        return float(self.weights @ self.pressure)

    @property
    def area(self) -> float:
        """The area in contact."""
        return float(self.weights[self.closed].sum())

    def __repr__(self) -> str:
        alone = "".join(
            f", {area:.6g} of the {which} surface without a partner"
            for which, area in zip(("first", "second"), self.unmatched, strict=True)
            if area > 0.0
        )
        peak = self.pressure.max()
        return f"ContactResult({len(self.x)} points, peak pressure {peak:.6g}, force {self.force:.6g}{alone})"


class Solution:
    """The result of `solve`.

    status: "converged", "iteration limit", "stalled", "diverged", "no equilibrium" or "stopped"; reason: in words;
    history: of the iterations; method: the scheme's name.
    """

    def __init__(
        self,
        scene: Scene,
        ensemble: Ensemble,
        state: State,
        history: History,
        status: str,
        reason: str,
        method: str,
    ) -> None:
        self.scene, self.history, self.status, self.reason, self.method = scene, history, status, reason, method
        self._ensemble, self._state = ensemble, state
        self._displacements: dict[str, fem.Function] = {}
        if not scene.ranks.alone:
            _ = self._fields  # while all ranks are here: later some may ask and others not

    @property
    def converged(self) -> bool:
        return self.status == "converged"

    @property
    def iterations(self) -> int:
        return len(self.history)

    @property
    def interfaces(self) -> Sequence[Interface]:
        """The discretised contacts as they were solved; a parameter may have changed the scene's since."""
        return self._ensemble.interfaces

    def displacement(self, body: str | Body) -> fem.Function:
        """The displacement of a body (length), a dolfinx function."""
        place = self._place(body)
        name = self.scene.bodies[place].name
        if name not in self._displacements:
            function = fem.Function(self.scene.bodies[place].space, name="displacement")
            function.x.array[:] = self._fields[place].displacement
            self._displacements[name] = function
        return self._displacements[name]

    def contact(self, contact: str | int | Contact = 0, *, degree: int | None = None) -> ContactResult:
        """Pressure, gap and compression of a contact, at its own points or at Gauss points of another degree."""
        index = self._contact_index(contact)
        interface, gaps = self.interfaces[index], self._state.gaps[index]
        if degree is not None:
            interface = _resampled(interface, degree)
            gaps = interface.gap - self._closed(interface)
        stress = interface.contact.layer.contact_stress(gaps)
        compression = np.minimum(gaps, 0.0)
        return ContactResult(
            interface.x, interface.normal, interface.weights, gaps, compression, -stress, interface.unmatched
        )

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader of the result has to know: where a layer is compressed further than its law is known."""
        found = (_passed(i, z) for i, z in zip(self.interfaces, self._state.gaps, strict=True))
        return tuple(note for note in found if note)

    def elastic_energy(self, body: str | Body | None = None) -> float:
        """½ a(u, u) of a body, or of all of them; the energy of its springs is part of it."""
        if body is None:
            return sum(self.elastic_energy(each) for each in self.scene.bodies)
        return self._fields[self._place(body)].elastic_energy

    @property
    def layer_energy(self) -> float:
        """J, the energy of all layers."""
        return self._ensemble.layer_energy(self._state)

    @property
    def energy(self) -> float:
        """F₁ = ½ A(u, u) − L(u) + J(u), eq. (13)."""
        return self._ensemble.energy(self._state)

    def stress(self, body: str | Body) -> fem.Function:
        """All six stresses of a body in the order xx, yy, zz, yz, xz, xy, discontinuous between cells.

        In a body of revolution x is the radius, y the axis and z the hoop direction.
        """
        owner = self.scene.bodies[self._place(body)]
        degree = max(owner.degree - 1, 0)
        element = inner_element(owner.mesh.domain, degree)
        space = fem.functionspace(owner.mesh.domain, basix.ufl.blocked_element(element, shape=(6,)))
        matrix = owner.material_coefficient(owner.kinematics.full_stress, element)
        strain = owner.kinematics.strain(self.displacement(owner))
        expression = fem.Expression(matrix * strain, compat.expression_points(space.element))
        function = fem.Function(space, name="stress")
        function.interpolate(expression)
        return function

    def forces(self, body: str | Body) -> dict[str, Floats]:
        """The resultants on a body, each (dim,): "loads", "contact" and "supports" (reactions and springs).

        They sum to zero. In a body of revolution they are those of the full ring, on which radial forces sum to zero.
        """
        place = self._place(body)
        problem = self._ensemble.problems[place]
        loads, contact, fields = problem.dofs.load, self._contact_load(place), self._fields[place]
        supports = fields.elastic_forces - loads - contact
        # A free displacement has no reaction; what is left there is the iteration's residual, not a force.
        supports = problem.dofs.reactions(supports) - fields.spring_forces
        parts = {"loads": loads, "contact": contact, "supports": supports}
        return {name: problem.dofs.resultant(forces) for name, forces in parts.items()}

    @cached_property
    def imbalance(self) -> float:
        """The largest force on a body that nothing balances, relative to the largest force at work."""
        sums, largest = [], 0.0
        for body in self.scene.bodies:
            forces = self.forces(body)
            sums.append(np.linalg.norm(sum(forces.values())))
            largest = max(largest, *(float(np.linalg.norm(force)) for force in forces.values()))
        return float(max(sums) / largest) if largest > 0.0 else 0.0

    @cached_property
    def residual(self) -> float:
        """‖F₁'(u)‖ over all free displacements relative to the loads and contact forces, found from the fields anew."""
        total = scale = 0.0
        for place, problem in enumerate(self._ensemble.problems):
            contact, elastic = self._contact_load(place), self._fields[place].elastic_forces
            total += float(np.sum(problem.dofs.free_forces(problem.dofs.load + contact - elastic) ** 2))
            scale += float(problem.dofs.load @ problem.dofs.load + contact @ contact)
        return float(np.sqrt(total / scale)) if scale > 0.0 else float(np.sqrt(total))

    def plot_contact(self, contact: str | int | Contact = 0, **options: Any) -> Any:
        """Pressure and gap along a contact: a matplotlib figure."""
        from .view.plot import plot_contact

        return plot_contact(self, contact, **options)

    def plot_bodies(self, **options: Any) -> Any:
        """The deformed bodies coloured by a stress: a picture, also saved to `path`; see `plot.plot_bodies`."""
        from .view.plot import plot_bodies

        return plot_bodies(self, **options)

    def plot(self) -> Any:
        """The deformed bodies and every contact's curves."""
        from .view.plot import plot

        return plot(self)

    def export(self, folder: str | Path) -> list[Path]:
        """Write displacement and stress of every body for ParaView; the files written."""
        from .view.export import export

        return export(self, folder)

    def __repr__(self) -> str:
        lines = [f"Solution by {self.method!r}: {self.status} ({self.reason})"]
        for contact in self.scene.contacts:
            lines.append(f"  {contact.name}: {self.contact(contact)!r}")
        lines += [f"  {note}" for note in self.notes]
        lines.append(
            f"  energy F₁ {self.energy:.8g}, weak residual {self.residual:.1e}, imbalance {self.imbalance:.1e}"
        )
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{c.name}</td><td>{r.pressure.max():.6g}</td><td>{r.force:.6g}</td><td>{r.area:.6g}</td></tr>"
            for c, r in ((c, self.contact(c)) for c in self.scene.contacts)
        )
        head = "<tr><th>contact</th><th>peak pressure</th><th>force</th><th>area in contact</th></tr>"
        return f"<p><b>{self.status}</b>: {self.reason} ({self.method})</p><table>{head}{rows}</table>"

    @cached_property
    def _fields(self) -> list[Fields]:
        """The bodies' solutions; the insides are recovered when first asked for."""
        ensemble, state = self._ensemble, self._state

        def of(place: int) -> Fields:
            part = ensemble.parts[place]
            return ensemble.problems[place].fields(state.unknowns[part], state.deformation[part])

        return self._settled(self.scene.ranks.each(of))

    def _settled(self, fields: list[Fields]) -> list[Fields]:
        """The same with the motions taken out on which nothing depends, such as that of a whole stack that floats.

        Which of them the iteration ends with is rounding; the displacements shown are the smallest.
        """
        motions = self._ensemble.rigid
        if motions.modes.shape[1] == 0 or motions.neutral.shape[1] == 0:
            return fields
        moves = []
        parts = motions.by_owner(motions.neutral)
        for problem, owner, part in zip(self._ensemble.problems, motions.owners, parts, strict=True):
            moves.append(problem.dofs.rigid_displacements(owner.coefficients @ part))
        drift = np.linalg.lstsq(np.vstack(moves), np.concatenate([f.displacement for f in fields]), rcond=None)[0]
        return [replace(f, displacement=f.displacement - move @ drift) for f, move in zip(fields, moves, strict=True)]

    def _closed(self, interface: Interface) -> Floats:
        """u_αn + u_βn at the points of an interface, (points,), from the unknowns alone where they tell it."""
        problems, unknowns = self._ensemble.problems, self._ensemble.split(self._state.unknowns)
        seen = [problems[side.body].seen(unknowns[side.body], side.trace) for side in interface.sides]
        if any(values is None for values in seen):
            # The fields are settled, the unknowns are not: one side from each would differ by the motion taken out.
            seen = [side.trace @ self._fields[side.body].displacement for side in interface.sides]
        return sum(seen)

    def _contact_load(self, place: int) -> Floats:
        """∫ g⁻(z) v_n over all contacts of a body, for every degree of freedom."""
        problem = self._ensemble.problems[place]
        tractions = self._ensemble.by_interface(self._ensemble.tractions(self._state))
        total = np.zeros_like(problem.dofs.load)
        for port in problem.traces:
            total += port.side.trace.T @ tractions[port.interface]
        return total

    def _place(self, body: str | Body) -> int:
        for place, other in enumerate(self.scene.bodies):
            if other is body or other.name == body:
                return place
        raise ValueError(f"body = {body!r}: expected one of {', '.join(repr(b.name) for b in self.scene.bodies)}")

    def _contact_index(self, contact: str | int | Contact) -> int:
        for index, other in enumerate(self.scene.contacts):
            if contact in (other, index, other.name):
                return index
        known = ", ".join(repr(other.name) for other in self.scene.contacts)
        raise ValueError(f"contact = {contact!r}: expected a place or one of {known}")


def _passed(interface: Interface, gaps: Floats) -> str:
    """Where the compression has passed the limit up to which the layer's law is known; empty if nowhere."""
    contact, limit = interface.contact, np.broadcast_to(interface.contact.layer.compression_limit, gaps.shape)
    beyond = -gaps > limit * (1 + 1e-9)  # at the last point itself rounding tells nothing
    if not np.any(beyond):
        return ""
    worst = int(np.argmax(np.where(beyond, -gaps / limit, 0.0)))
    share = float(interface.weights @ beyond) / float(interface.weights.sum())
    return (
        f"contact {contact.name!r}: on {share:.2g} of its area the layer is compressed further than its law is known, "
        f"to {-gaps[worst]:.6g} where it is known to {limit[worst]:.6g}; beyond, it is taken to go on straight"
    )


def _resampled(interface: Interface, degree: int) -> Interface:
    """The same contact at Gauss points of another degree."""
    first, second = interface.sides
    return discretise(interface.contact.resampled(degree), (first.body, second.body), interface.facets)
