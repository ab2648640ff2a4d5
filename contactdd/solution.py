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
from .interface.nodal import LinearFunctions

if TYPE_CHECKING:
    from .local.problem import Fields
    from .scene import Scene
    from .system.ensemble import Ensemble
    from .system.state import State


#: k h/E above which the pressure of points is replaced by the projected one on meshes that do not match.
STIFF = 10.0


@dataclass(frozen=True)
class ContactResult:
    """A contact at n points.

    x: (n, dim) where; weights: (n,) areas; gap: (n,) the deformed gap z = d − u_αn − u_βn (length); compression: (n,)
    the layer's w = min(z, 0); pressure: (n,) −σ_n >= 0 (stress); normal: (n, dim) outward of the first body;
    unmatched: the area of either surface that lies opposite nothing and is therefore outside the contact.

    Under a layer much stiffer than the elements, on meshes that do not match, the law's pressure wavers from point to
    point around the right mean. Above `STIFF` times their stiffness (stiffness_ratio, k h/E) `pressure` is therefore
    the projected one, and the repr says so; pointwise_pressure: (n,) is −g(w) in any case. projection: the linear
    functions of the nodes of one surface, None where the points are nodes already.
    """

    x: Floats
    normal: Floats
    weights: Floats
    gap: Floats
    compression: Floats
    pressure: Floats
    unmatched: tuple[float, float] = (0.0, 0.0)
    pointwise_pressure: Floats | None = None
    projection: LinearFunctions | None = None
    stiffness_ratio: float = 0.0
    wavers: bool = False
    hard: bool = False

    @property
    def node_x(self) -> Floats:
        """The nodes (m, dim) of one surface, the softer or coarser one, that `nodal_pressure` belongs to."""
        return self.x if self.projection is None else self.projection.x

    @cached_property
    def nodal_pressure(self) -> Floats:
        """The pressure (m,) at the nodes `node_x` of one surface, a linear field in between (stress).

        It is the L² projection of the law's pressure onto the surface's linear functions, so that force and moment
        are the same and every nodal force; near the edge of a contact it may be a little below zero. With the
        quadrature "mortar" it is the pressure itself.
        """
        if self.projection is None:
            return self.pressure
        return self.projection.projected(self.pointwise_pressure, self.weights)

    @cached_property
    def projected_pressure(self) -> Floats:
        """The same field at the contact's points, (n,): what a stiff layer's pressure wavers around (stress)."""
        return self.pressure if self.projection is None else self.projection.at_values @ self.nodal_pressure

    @property
    def closed(self) -> NDArray[np.bool_]:
        """Where the layer is compressed, or a hard contact carries pressure, (n,)."""
        return self.pressure > 0.0 if self.hard else self.gap < 0.0

    @property
    def penetration(self) -> float:
        """The largest overlap of the surfaces (length): of a hard contact what is left of it, else of the layer."""
        return max(0.0, -float(self.gap.min()))

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
        return (
            f"ContactResult({len(self.x)} points, peak pressure {peak:.6g}, force {self.force:.6g}{alone}{self._note})"
        )

    @property
    def _note(self) -> str:
        """What there is to be told of how well it is known."""
        if self.hard:
            return f", penetration {self.penetration:.3g}"
        if not self.wavers:
            return ""
        return (
            f"; the layer is {self.stiffness_ratio:.3g} times as stiff as the elements on meshes that do not match: "
            "the pressure is the projected one, as pointwise_pressure wavers; quadrature='mortar' does not"
        )


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
        if self.scene.bodies[place].mesh is None:
            return self._fields[place].displacement
        if name not in self._displacements:
            function = fem.Function(self.scene.bodies[place].space, name="displacement")
            function.x.array[:] = self._fields[place].displacement
            self._displacements[name] = function
        return self._displacements[name]

    def contact(self, contact: str | int | Contact = 0, *, degree: int | None = None) -> ContactResult:
        """Pressure, gap and compression of a contact, at its own points or at Gauss points of another degree."""
        index = self._contact_index(contact)
        interface, gaps = self.interfaces[index], self._state.gaps[index]
        pressure, gathered = 0.0 - interface.contact.layer.contact_stress(gaps), interface.gathered
        hard = interface.hard
        ratio = 0.0 if hard else _stiffness_ratio(interface, gaps, pressure)
        if hard:
            gaps = gaps + self._state.shifts[index]
        if degree is not None:
            interface = _resampled(interface, degree)
            gaps = interface.gap - self._closed(interface)
            if gathered is None:
                pressure = 0.0 - interface.contact.layer.contact_stress(gaps)
            else:  # a linear field, which the gaps between its nodes tell nothing of
                pressure = interface.functions.interpolated(gathered @ pressure)
        result = ContactResult(
            interface.x,
            interface.normal,
            interface.weights,
            gaps,
            np.minimum(gaps, 0.0),
            pressure,
            interface.unmatched,
            pressure,
            None if interface.gathered is not None else interface.functions,
            ratio,
            bool(ratio > STIFF and interface.unlike and gathered is None),
            hard,
        )
        return replace(result, pressure=result.projected_pressure) if result.wavers else result

    def elastic_energy(self, body: str | Body | None = None) -> float:
        """½ a(u, u) of a body, or of all of them; the energy of its springs is part of it."""
        if body is None:
            return sum(self.elastic_energy(each) for each in self.scene.bodies)
        return self._fields[self._place(body)].elastic_energy

    @property
    def layer_energy(self) -> float:
        """J, the energy of all layers; a hard contact has none."""
        return self._ensemble.layer_energy(self._state) - self._penalty_energy

    @property
    def energy(self) -> float:
        """F₁ = ½ A(u, u) − L(u) + J(u), eq. (13)."""
        return self._ensemble.energy(self._state) - self._penalty_energy

    @property
    def _penalty_energy(self) -> float:
        """What the augmented Lagrangian counts as the energy of hard contacts."""
        contacts = zip(self.interfaces, self._state.gaps, strict=True)
        return sum(float(i.weights @ i.contact.layer.energy(z)) for i, z in contacts if i.hard)

    @property
    def multipliers(self) -> list[Floats]:
        """The pressures (points,) of every contact if one of them is hard, to go on from; else an empty list."""
        if not self._state.shifts:
            return []
        contacts = zip(self.interfaces, self._state.gaps, strict=True)
        return [0.0 - interface.contact.layer.contact_stress(gaps) for interface, gaps in contacts]

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


def _resampled(interface: Interface, degree: int) -> Interface:
    """The same contact at Gauss points of another degree."""
    first, second = interface.sides
    contact, split = interface.contact.resampled(degree), interface.gathered is not None
    return discretise(contact, (first.body, second.body), interface.facets, split)


def _stiffness_ratio(interface: Interface, gaps: Floats, pressure: Floats) -> float:
    """k h/E: the layer's stiffness where it presses, beside that of the softer body's facets."""
    pressing = pressure > 0.0
    shares = interface.weights[pressing] * pressure[pressing]
    stiffness = interface.contact.layer.contact_derivative(gaps[pressing])
    return float(shares @ stiffness / shares.sum()) / interface.facet_stiffness if np.any(pressing) else 0.0
