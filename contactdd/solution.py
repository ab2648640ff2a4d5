"""The solution of a scene: displacements, stresses, contact pressures and gaps, energies, and how the run went."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import replace
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, cast

import basix.ufl
import numpy as np
from dolfinx import fem
from numpy.typing import ArrayLike

from . import sample, small_strains
from .base import compat
from .base.arrays import Floats
from .body import Body
from .body_result import BodyResult
from .contact import Contact
from .contact_result import ContactResult, NodalPressure, solution_html
from .field import inner_element
from .history import History
from .interface.discretise import Interface, discretise
from .interface.surface import PointSurface
from .local.remote import eigenstrain_load
from .small_strains import StrainSize
from .surface_result import SurfaceResult, Surfaces
from .system.ensemble import STRAINING
from .system.joint_motions import settled

if TYPE_CHECKING:
    from .layers.gasket import GasketAtPoints
    from .local.problem import Fields
    from .saved import SavedSolution
    from .scene import Scene
    from .system.ensemble import Ensemble
    from .system.state import State
    from .view.export import Fields as ExportedFields


T = TypeVar("T")


#: k h/E above which the pressure of points is replaced by the projected one on meshes that do not match.
STIFF = 10.0


#: The forces on a body that this rank does not hold.
NOTHING: Floats = np.zeros(0)


class Solution:
    """The result of `solve`: displacements, stresses, contact pressures, energies and the history of the iterations.

    Lengths, stresses and forces are in the user's own units; forces and energies are per unit thickness in the plane
    and those of the full ring for bodies of revolution.

    Args:
        scene: The scene that was solved.
        ensemble: Its discrete problem.
        state: The last iterate.
        history: The records of the iterations.
        status: "converged", "iteration limit", "stalled", "diverged", "no equilibrium" or "stopped".
        reason: The reason of that, in words.
        method: The scheme's name.
        local_solver: The local solver that was asked for.
        cpu_seconds: The CPU time of the solve and of what it made of the scene for the first time (s).

    Example:
        >>> import contactdd as cd
        >>> steel, mesh = cd.Isotropic(E=2e5, nu=0.0), cd.rectangle((0, 0), (2, 1), (2, 1))
        >>> lower = cd.Body("lower", mesh, steel, supports=[cd.Fixed("bottom")])
        >>> rollers = [cd.Symmetry("left"), cd.Symmetry("right")]
        >>> upper = cd.Body("upper", mesh.moved((0, 1)), steel, supports=rollers, loads=[cd.Pressure("top", 3.0)])
        >>> scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.LinearLayer(1e4))])
        >>> solution = cd.solve(scene)
        >>> round(solution.contact("lower-upper").force, 6), solution.forces("upper")["loads"].round(6).tolist()
        (6.0, [0.0, -6.0])
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
        local_solver: str = "auto",
        cpu_seconds: float = float("nan"),
    ) -> None:
        self.scene, self.history, self.status, self.reason, self.method = scene, history, status, reason, method
        self.local_solver, self.cpu_seconds = local_solver, cpu_seconds
        self.parameter_values = scene.parameter_values()
        self._ensemble, self._state = ensemble, state
        self._displacements: dict[str, fem.Function] = {}
        if not scene.ranks.alone:  # while all ranks are here: later some may ask and others not
            _ = self._fields, self.energy, self._resultants, self.imbalance, self.residual, self.strain_sizes

    @property
    def converged(self) -> bool:
        """Whether the stopping rule was met."""
        return self.status == "converged"

    @property
    def iterations(self) -> int:
        """The number of iterations."""
        return len(self.history)

    @property
    def interfaces(self) -> Sequence[Interface]:
        """The discretised contacts as they were solved; a parameter may have changed the scene's since."""
        return self._ensemble.interfaces[: len(self.scene.contacts)]

    def displacement(self, body: str | Body) -> fem.Function:
        """The displacement of a body (length), a dolfinx function; of a body without a mesh its unknowns, (dofs,).

        Args:
            body: Its name or the `Body`.

        Raises:
            ValueError: The scene has no such body, or it is deferred and other ranks hold it.
        """
        body_index = self._place(body)
        if self.scene.bodies[body_index].mesh is None:
            return self._fields[body_index].displacement
        if body_index in self.scene.known_dofs and not self.scene.ranks.owns(body_index):
            raise ValueError(
                f"body = {self.scene.bodies[body_index].name!r}: it is deferred, and rank "
                f"{self.scene.ranks.teams[body_index][0]} holds its field; expected that rank, or solution.body(...)"
            )
        return self._displacement(body_index)

    def _displacement(self, body_index: int) -> fem.Function:
        """The displacement of a meshed body as this rank knows it."""
        body = self.scene.bodies[body_index]
        if body.name not in self._displacements:
            function = fem.Function(body.space, name="displacement")
            function.x.array[:] = self._fields[body_index].displacement
            self._displacements[body.name] = function
        return self._displacements[body.name]

    def _by_owner(self, body: Body, make: Callable[[], T]) -> T:
        """The result of a body; that of a deferred one is made by its owner, for all ranks. Collective then."""
        index = self._place(body)
        return self.scene.ranks.by_owner(index, make) if index in self.scene.known_dofs else make()

    def displacement_on(self, body: Body) -> Floats:
        """The displacement (dofs,) of the body of the same name in the elements of another, to go on from (length).

        Args:
            body: A body on the same mesh, or on one refined from it, in elements of any degree, or numbered alike.

        Raises:
            ValueError: The scene has no body of that name.
        """
        own = self.scene.bodies[self._place(body.name)]
        u = self.displacement(own)
        if body.mesh is None or own.mesh is None:
            return u if own.mesh is None else u.x.array
        same = own.mesh is body.mesh and own.degree == body.degree
        carried = None if same else body.elements.interpolated(u, own.elements)
        return u.x.array if carried is None else carried

    def contact(self, contact: str | int | Contact = 0, *, degree: int | None = None) -> ContactResult:
        """The pressure, gap and compression of a contact at its points.

        Args:
            contact: Its name (as typed, "lower-upper", too), its index in the scene or the `Contact`.
            degree: The degree of exactness of Gauss points at which they are evaluated instead of the contact's own.

        Raises:
            ValueError: The scene has no such contact, or `degree` is asked of bodies that have no mesh.
        """
        index = self._contact_index(contact)
        interface, gaps = self.interfaces[index], self._gaps[index]
        pressure, gathered = self._pressure(index), interface.gathered
        stiffness_ratio = partial(_stiffness_ratio, interface, gaps, pressure)
        wavers = interface.unlike and stiffness_ratio() > STIFF
        if degree is not None:
            if not any(body.mesh for body, _ in interface.contact.sides):
                raise ValueError(f"degree = {degree!r}: neither body of the contact has facets; expected None")
            interface = _resampled(interface, degree)
            gaps = interface.gap - self._closed(interface)
            if gathered is None:
                pressure = _law_pressure(interface, gaps)
            else:  # a linear field, which the gaps between its nodes tell nothing of
                pressure = interface.functions.interpolated(gathered @ pressure)
        result = _contact_result(interface, gaps, pressure, stiffness_ratio, wavers)
        return result if interface.contact.sliding is None else self._with_slip(result, index, degree, interface)

    def _with_slip(self, result: ContactResult, index: int, degree: int | None, interface: Interface) -> ContactResult:
        """The result of a contact with its slip and the shear tractions."""
        from .interface.sliding import sliding_interfaces, slip

        if degree is None:
            state = zip(self._ensemble.interfaces, self._state.gaps, strict=True)
            known = [(i, gaps) for i, gaps in state if i.slides == index]
        else:
            known = [(i, -self._closed(i)) for i in sliding_interfaces(interface, index)]
        slips, tractions = slip(known)
        return replace(result, slip=slips, shear=tractions)

    def contact_at(self, other: Interface) -> tuple[Floats, Floats]:
        """The gap (length) and the contact pressure (stress), (points,) each, at the points of the same contact as it
        was discretised for another solution, on the same meshes in elements of another degree.

        Args:
            other: That solution's interface.
        """
        index = self.scene.contact_index(other.contact.name)
        interface = self.interfaces[index]
        places = other.sides[0].body, other.sides[1].body
        seen = discretise(interface.contact, places, other.facets, other.gathered is not None, other.rule)
        if seen.x.shape != other.x.shape or np.abs(seen.x - other.x).max() > 1e-9 * np.abs(other.x).max():
            raise RuntimeError(f"contact {other.contact.name!r}: its points are others in elements of another degree")
        if interface.hard:  # the pressures of nodes, which are the same
            return self._gaps[index], self._pressure(index)
        gaps = seen.gap - self._closed(seen)
        return gaps, _law_pressure(seen, gaps)

    @property
    def scene_after(self) -> Scene:
        """The scene with its layers as this solution leaves them, to go on from; itself if none remembers.

        Raises:
            ValueError: A layer remembers and this solution did not converge.
        """
        scene = self.scene
        for contact, interface, gaps in zip(self.scene.contacts, self.interfaces, self._gaps, strict=True):
            if interface.layer.remembers:
                if not self.converged:
                    raise ValueError(f"status = {self.status!r}: expected a converged solution, whose closures count")
                scene = scene.with_layer(interface.layer_after(gaps), contact.name)
        return scene

    @property
    def dissipated_energy(self) -> float:
        """The energy that layers which remember have taken in all loading so far and will not give back."""
        total = 0.0
        for interface, gaps in zip(self.interfaces, self._gaps, strict=True):
            if interface.layer.remembers:
                part = 0.5 if interface.mirrored else 1.0  # energies are those of one half
                total += part * float(interface.weights @ _memory(interface, gaps).dissipation)
        return total

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks on the result: contacts where a layer is compressed further than its law is known."""
        found = (_passed(i, z) for i, z in zip(self.interfaces, self._gaps, strict=True))
        return tuple(note for note in found if note)

    def contact_surface(self, contact: str | int | Contact = 0, *, second: bool = False) -> SurfaceResult:
        """The pressure, gap and status of a contact facet by facet.

        Args:
            contact: Its name (as typed, "lower-upper", too), its index in the scene or the `Contact`.
            second: Whether on the second body's surface instead of the first's.

        Raises:
            ValueError: The scene has no such contact, or that body has no mesh.
        """
        index = self._contact_index(contact)
        interface, gaps, pressure = self.interfaces[index], self._gaps[index], self._pressure(index)
        body = self._meshed(interface.contact.sides[int(second)][0])
        return sample.surface_result(interface, int(second), gaps, pressure, self._displacement(self._place(body)))

    def body(self, body: str | Body) -> BodyResult:
        """The displacement and stress of a body at its nodes, as plain arrays.

        Of a deferred body on several ranks collective, here and at points: all have to ask, its owner tells the others.

        Args:
            body: Its name or the `Body`.

        Raises:
            ValueError: The scene has no such body, or it has no mesh.
        """
        owner = self._meshed(body)
        return self._by_owner(owner, lambda: self._body_result(owner))

    def _body_result(self, body: Body) -> BodyResult:
        """The result of a body that this rank holds."""
        contacts = list(zip(self.interfaces, self._gaps, strict=True))
        return sample.body_result(body, self.displacement(body), self.stress(body), contacts)

    def displacement_at(self, body: str | Body, points: ArrayLike) -> Floats:
        """The displacements of a body at points, (n, dim) (length).

        Args:
            body: Its name or the `Body`.
            points: (n, dim) Points of its undeformed shape (length).

        Raises:
            ValueError: Points lie outside of the body, or it has no mesh.
        """
        owner = self._meshed(body)
        return self._by_owner(owner, lambda: sample.values_at(owner, self.displacement(owner), points))

    def stress_at(self, body: str | Body, points: ArrayLike) -> Floats:
        """The six stresses of a body at points, (n, 6), in the order of `stress`.

        On the border of cells the stress is that of one of them.

        Args:
            body: Its name or the `Body`.
            points: (n, dim) Points of its undeformed shape (length).

        Raises:
            ValueError: Points lie outside of the body, or it has no mesh.
        """
        owner = self._meshed(body)
        return self._by_owner(owner, lambda: sample.values_at(owner, self.stress(owner), points))

    def elastic_energy(self, body: str | Body | None = None) -> float:
        """The elastic energy ½ a(u, u) of a body or of all, that of springs included (force · length).

        Where there are eigenstrains, such as those of heat, it is that of the strains less these.

        Args:
            body: Its name or the `Body`; by default all.
        """
        if body is None:
            return sum(self.elastic_energy(each) for each in self.scene.bodies)
        return self._fields[self._place(body)].elastic_energy

    @property
    def layer_energy(self) -> float:
        """J, the energy of all layers; a hard contact has none."""
        return self._ensemble.layer_energy(self._state) - self._penalty_energy

    @cached_property
    def energy(self) -> float:
        """F₁ = ½ A(u, u) − L(u) + J(u), eq. (13); L holds eigenstrains, too."""
        return self._ensemble.energy(self._state) - self._penalty_energy

    @property
    def _penalty_energy(self) -> float:
        """The energy of hard contacts in the augmented Lagrangian."""
        contacts = zip(self._ensemble.interfaces, self._state.gaps, strict=True)
        return sum(float(i.weights @ i.layer.energy(z)) for i, z in contacts if i.hard)

    @property
    def multipliers(self) -> list[Floats]:
        """The pressures (points,) of every interface if a contact is hard, to go on from; else an empty list."""
        return [self._pressure(index) for index in range(len(self._state.gaps))] if self._state.shifts else []

    @property
    def _gaps(self) -> list[Floats]:
        """The deformed gaps z at the points of every interface, of hard contacts too."""
        gaps, shifts = self._state.gaps[: len(self.scene.contacts)], self._state.shifts
        return [z + s for z, s in zip(gaps, shifts, strict=False)] if shifts else gaps

    def _pressure(self, index: int) -> Floats:
        """The contact pressure at the points of an interface."""
        return _law_pressure(self._ensemble.interfaces[index], self._state.gaps[index])

    def stress(self, body: str | Body) -> fem.Function:
        """The six stresses of a body, a dolfinx function, in the order xx, yy, zz, yz, xz, xy.

        It is discontinuous between cells. In a body of revolution x is the radius, y the axis and z the hoop direction.

        Args:
            body: Its name or the `Body`.

        Raises:
            ValueError: The scene has no such body.
        """
        owner = self.scene.bodies[self._place(body)]
        degree = max(owner.degree - 1, 0)
        element = inner_element(owner.mesh.domain, degree)
        space = fem.functionspace(owner.mesh.domain, basix.ufl.blocked_element(element, shape=(6,)))
        matrix = owner.material_coefficient(owner.kinematics.full_stress, element)
        stress = matrix * owner.kinematics.strain(self.displacement(owner))
        function = fem.Function(space, name="stress")
        with self.scene.at(self.parameter_values) if owner.has_eigenstrain else nullcontext():
            if owner.has_eigenstrain:
                stress -= owner.material_coefficient(owner.kinematics.full_eigenstress, element) * owner.eigenstrain()
            function.interpolate(fem.Expression(stress, compat.expression_points(space.element)))
        return function

    def forces(self, body: str | Body) -> dict[str, Floats]:
        """The resultants on a body, each (dim,): "loads", "contact" and "supports" (reactions and springs).

        They sum to zero. In a body of revolution they are those of the full ring, on which radial forces sum to zero.

        Args:
            body: Its name or the `Body`.

        Raises:
            ValueError: The scene has no such body.
        """
        return dict(self._resultants[self._place(body)])

    @cached_property
    def _resultants(self) -> list[dict[str, Floats]]:
        """The resultants on every body."""

        def of(body_index: int) -> dict[str, Floats]:
            resultant = self._ensemble.problems[body_index].dofs.resultant
            return {name: resultant(forces) for name, forces in self._nodal_forces(body_index).items()}

        return self.scene.ranks.each(of)

    def _nodal_forces(self, body_index: int) -> dict[str, Floats]:
        """The forces on a body at all its degrees of freedom, (dofs,) each."""
        problem = self._ensemble.problems[body_index]
        loads, contact, fields = problem.dofs.load, self._contact_load(body_index), self._held[body_index]
        supports = fields.elastic_forces - loads - contact
        # A free displacement has no reaction; what is left there is the iteration's residual, not a force.
        supports = problem.dofs.reactions(supports) - fields.spring_forces
        return {"loads": loads, "contact": contact, "supports": supports}

    @cached_property
    def imbalance(self) -> float:
        """The largest resultant on a body that nothing balances, relative to the largest force at work on one.

        A force at work is the sum of the magnitudes of its nodal forces: where it balances itself, as in a press fit,
        its resultant is rounding. Of the loads that eigenstrains are only a thousandth counts.
        """
        sums, sizes = np.transpose(self.scene.ranks.each(self._balance))
        largest = float(np.max(sizes))  # not a number where one of them is
        return float(np.max(sums)) / largest if largest != 0.0 else 0.0

    def _balance(self, body_index: int) -> tuple[float, float]:
        """The size of all forces' resultant on a body, and that of the largest of these forces."""
        forces, dofs = self._nodal_forces(body_index), self._ensemble.problems[body_index].dofs
        mesh, resultant, strains = self.scene.bodies[body_index].mesh, dofs.resultant, eigenstrain_load(dofs)
        left = float(np.linalg.norm(resultant(np.sum(list(forces.values()), axis=0))))
        if strains is not None:
            forces |= {"loads": forces["loads"] - strains, "eigenstrains": STRAINING * strains}
        vectors = [force.reshape(-1, mesh.dim) if mesh else resultant(force)[None] for force in forces.values()]
        return left, float(np.max([np.linalg.norm(each, axis=1).sum() for each in vectors]))

    @cached_property
    def residual(self) -> float:
        """The residual ‖F₁'(u)‖ over all free displacements relative to the forces at work, from the recovered fields.

        The forces at work are those that `solve` compares with, √(‖loads‖² + ‖contact forces‖²); where there are none,
        the residual is ‖F₁'(u)‖ itself.
        """

        def squares(body_index: int) -> tuple[float, float]:
            """Of the forces that are left on a body, and of those of its contacts."""
            dofs, contact = self._ensemble.problems[body_index].dofs, self._contact_load(body_index)
            left = dofs.free_forces(dofs.load + contact - self._held[body_index].elastic_forces)
            return float(np.sum(left**2)), float(np.sum(dofs.free_forces(contact) ** 2))

        total, contacts = np.sum(self.scene.ranks.each(squares), axis=0).tolist()
        scale = self._ensemble.at_work(float(np.sqrt(contacts)))
        return float(np.sqrt(total)) / scale if scale != 0.0 else float(np.sqrt(total))

    def normal_stiffness(self, contact: str | int | Contact = 0) -> float:
        """The normal stiffness dF/dδ of a contact and its bodies, from the tangent (17) (force / length).

        F is the contact force and δ the approach of the bodies' supports, which is a uniform reduction of the gap d;
        all loads stay. The stiffness is that of the layer and of the bodies in series; zero where loads alone fix the
        force. With a `MirrorPlane` δ is the approach of one half to the plane, half of the joint's. Collective: on
        several ranks all have to call it.

        Args:
            contact: Its name (as typed, "lower-upper", too), its index in the scene or the `Contact`.

        Raises:
            ValueError: The scene has no such contact.
            LooseBodyError: The closed contacts leave a body free.
        """
        from .iteration.closing_stiffness import closing_stiffness

        return closing_stiffness(self._ensemble, self.scene.ranks, self._state.gaps, self._contact_index(contact))

    def influence(self, factors: Sequence[Floats]) -> list[Floats]:
        """The influence of forces on weighted contact pressures: displacements z, (dofs,) of every body.

        Small forces F at all degrees of freedom change Σ ∫ f p over the contacts by F·z: what a cell's or a load's
        error does to the pressures, from the adjoint of the tangent (17). Collective: on several ranks all have to call
        it.

        Args:
            factors: f at the points of every contact, (points,) each, in the scene's order.

        Raises:
            ValueError: There are not as many factors as points.
            LooseBodyError: The closed contacts leave a body free.
        """
        from .iteration.influence import influence

        wanted = [(len(interface.weights),) for interface in self.interfaces]
        if [np.shape(each) for each in factors] != wanted:
            raise ValueError(f"factors of shapes {[np.shape(f) for f in factors]}: expected {wanted}, as the points")
        sliding = [np.zeros(len(other.weights)) for other in self._ensemble.interfaces[len(wanted) :]]
        return influence(self._ensemble, self.scene.ranks, self._state.gaps, [*factors, *sliding])

    @cached_property
    def strain_sizes(self) -> list[StrainSize]:
        """The largest strain and rotation of each body that has a mesh, in the order of the scene's bodies."""

        def of(body_index: int) -> StrainSize | None:
            body = self.scene.bodies[body_index]
            return small_strains.strain_size(body, self._held[body_index].displacement) if body.mesh else None

        return [size for size in self.scene.ranks.each(of) if size is not None]

    @property
    def largest_strain(self) -> float:
        """The largest principal strain, in absolute value, at the middles of all cells."""
        return max((size.strain for size in self.strain_sizes), default=0.0)

    @property
    def largest_rotation(self) -> float:
        """The largest rotation (rad) at the middles of all cells."""
        return max((size.rotation for size in self.strain_sizes), default=0.0)

    def warn_of_large_strains(self) -> None:
        """Warn (`LargeStrainWarning`) where linear theory is doubtful; look closer only where contacts hint at it."""
        if small_strains.suspicious(self._ensemble.interfaces, self._state.gaps) and self.scene.ranks.comm.rank == 0:
            small_strains.warn(self.strain_sizes)

    def plot_contact(self, contact: str | int | Contact = 0, **options: Any) -> Any:
        """A matplotlib figure of pressure and gap along a contact, in space of a map of it.

        Args:
            contact: Its name (as typed, "lower-upper", too), its index in the scene or the `Contact`.
            options: `along`, `about`, `show`, `whole`, `path`, `stress_unit`, `length_unit`, see
                `view.contact_plot.plot_contact`.
        """
        from .view.contact_plot import plot_contact

        result = self.contact(contact)
        surfaces = self._surfaces(contact) if result.x.shape[1] == 3 else (None, None)
        return plot_contact(result, surfaces, **options)

    def plot_bodies(self, bodies: Sequence[str | Body] | None = None, **options: Any) -> Any:
        """A picture of the deformed bodies, or of some, coloured by a stress.

        Args:
            bodies: Names of bodies or the bodies themselves; by default all that have a mesh.
            options: `component`, `scale`, `limits`, `camera`, `zoom`, `focus`, `edges`, `undeformed`, `sweep`, `unit`,
                `path`, `size`, `title`, see `view.body_plot.plot_bodies` and `drawing`.
        """
        from .view.body_plot import plot_bodies

        drawn = bodies or self._with_mesh()
        if not drawn:
            raise ValueError(f"bodies = {bodies!r}: no body of the scene has a mesh; expected one that can be drawn")
        return plot_bodies([self.body(body) for body in drawn], **options)

    def plot(self) -> list[Any]:
        """The pictures of the deformed bodies and of every contact; in a notebook they are shown."""
        from .view.picture import show

        bodies = [self.plot_bodies()] if self._with_mesh() else []
        pictures = [*bodies, *(self.plot_contact(contact) for contact in self.scene.contacts)]
        show(pictures)
        return pictures

    def export(self, folder: str | os.PathLike[str]) -> list[Path]:
        """The files written for ParaView into a folder, which is made if missing.

        One .vtu file of each body in its own degree: displacement, stress as a symmetric tensor and von Mises stress at
        the nodes, where neighbouring cells' stresses are averaged, and each cell's mean. Of each contact one of its
        points, with the pressures and gaps of `contact`, and one of each surface's facets, with those of
        `contact_surface`; these also as text in contacts.xdmf. Collective: on several ranks all have to call it; each
        writes the bodies that it holds, the first the contacts.

        Args:
            folder: The path of the folder; files of the same names in it are replaced.
        """
        from .view.export import export

        return self.scene.ranks.written(lambda: export(self._exported(), Path(folder)))

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """The folder that the solution was saved in as plain data, to be read by `load_solution` without the scene.

        Collective: on several ranks all have to call it; the first writes.

        Args:
            folder: The path of the folder, which is made if missing; an earlier solution in it is replaced.
        """
        from .saved import save

        bodies = self._gathered_bodies()
        return self.scene.ranks.once(lambda: save(self._plain(bodies), Path(folder)))

    def _gathered_bodies(self) -> list[BodyResult]:
        """The results of all meshed bodies, on the first rank: elsewhere none is kept."""
        first, found = self.scene.ranks.comm.rank == 0, []
        for body in self._with_mesh():
            result = self.body(body) if first or self._place(body) in self.scene.known_dofs else None
            if first and result is not None:
                found.append(result)
        return found

    def _exported(self) -> ExportedFields:
        """The bodies' and contacts' results that are written for ParaView."""
        from .view.export import Fields

        ranks, bodies = self.scene.ranks, self._with_mesh()
        ours = {body.name for body in bodies if ranks.speaks(self._place(body))}
        first = self.scene.contacts if ranks.comm.rank == 0 else []
        contacts = [(c.name, self.contact(c), self._surfaces(c)) for c in first]
        results = {body.name: self._body_result(body) if body.name in ours else None for body in bodies}
        return Fields(results, contacts)

    def _plain(self, bodies: list[BodyResult]) -> SavedSolution:
        """The solution as plain data."""
        from .saved import SavedSolution

        names = ("energy", "layer_energy", "residual", "imbalance", "largest_strain", "largest_rotation")
        return SavedSolution(
            self.status,
            self.reason,
            self.method,
            {name: float(getattr(self, name)) for name in names},
            self.history,
            bodies,
            {c.name: self.contact(c) for c in self.scene.contacts},
            {c.name: self._surfaces(c) for c in self.scene.contacts},
            {body.name: self.forces(body) for body in self.scene.bodies},
        )

    def _surfaces(self, contact: str | int | Contact) -> Surfaces:
        """The results of both surfaces of a contact, None for that of a body without a mesh."""
        first, second = self.scene.contacts[self._contact_index(contact)].sides
        return (
            self.contact_surface(contact) if first[0].mesh else None,
            self.contact_surface(contact, second=True) if second[0].mesh else None,
        )

    def _with_mesh(self) -> list[Body]:
        """The bodies that have a mesh, which can be drawn and written."""
        return [body for body in self.scene.bodies if body.mesh]

    def _meshed(self, body: str | Body) -> Body:
        """A body of the scene, refused if it has no mesh."""
        owner = self.scene.bodies[self._place(body)]
        if owner.mesh is None:
            raise ValueError(f"body = {owner.name!r}: it has no mesh; expected a body with one")
        return owner

    def __repr__(self) -> str:
        lines = [f"Solution by {self.method!r}: {self.status} ({self.reason})"]
        for contact in self.scene.contacts:
            lines.append(f"  {contact.name}: {self.contact(contact)!r}")
        lines += [f"  {note}" for note in self.notes]
        lines.append(
            f"  energy F₁ {self.energy:.8g}, weak residual {self.residual:.1e}, imbalance {self.imbalance:.1e}"
        )
        doubtful = [size for size in self.strain_sizes if size.doubtful]
        if doubtful:
            largest = max(doubtful, key=lambda size: max(size.strain, size.rotation))
            lines.append(f"  linear theory is doubtful here: {largest}")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        contacts = {c.name: self.contact(c) for c in self.scene.contacts}
        return solution_html(self.status, self.reason, self.method, contacts)

    @cached_property
    def _fields(self) -> list[Fields]:
        """The bodies' solutions; of a deferred one that others hold the displacement at its surfaces, and no forces."""
        known, ranks = self.scene.known_dofs, self.scene.ranks

        def told(body_index: int) -> Fields:
            whole = self._held[body_index]
            if body_index not in known:
                return whole
            there = whole.displacement[known[body_index]]
            return replace(whole, displacement=there, elastic_forces=NOTHING, spring_forces=NOTHING)

        found = ranks.each(told)
        for index, dofs in known.items():
            surface = found[index].displacement
            found[index] = self._held.get(index) or replace(found[index], displacement=surface[dofs])
        return found

    @cached_property
    def _held(self) -> dict[int, Fields]:
        """The solutions of the bodies that this rank holds, recovered from the condensed unknowns when first asked for.

        Without the common rigid motion that neither loads nor contacts determine: of all equivalent solutions that with
        the smallest displacements; the iterate's own motion is rounding.
        """
        ensemble, state, ranks = self._ensemble, self._state, self.scene.ranks
        fields = {
            index: problem.fields(state.unknowns[part], state.deformation[part])
            for index, (problem, part) in enumerate(zip(ensemble.problems, ensemble.parts, strict=True))
            if ranks.owns(index)
        }
        displacements = {index: each.displacement for index, each in fields.items()}
        moved = settled(ensemble.problems, ensemble.rigid, displacements, ranks)
        return {index: replace(each, displacement=moved[index]) for index, each in fields.items()}

    def _closed(self, interface: Interface) -> Floats:
        """u_αn + u_βn at the points of an interface, (points,), from the condensed unknowns where they suffice."""
        problems, unknowns = self._ensemble.problems, self._ensemble.split(self._state.unknowns)
        seen = [problems[side.body].seen(unknowns[side.body], side.trace) for side in interface.sides]
        told = [values for values in seen if values is not None]
        if len(told) < len(seen):
            # The fields are settled, the unknowns are not: one side from each would differ by the motion taken out.
            told = [side.trace @ self._fields[side.body].displacement for side in interface.sides]
        return told[0] + told[1]

    def _contact_load(self, body_index: int) -> Floats:
        """∫ g⁻(z) v_n over all contacts of a body, for every degree of freedom."""
        problem = self._ensemble.problems[body_index]
        tractions = self._ensemble.by_interface(self._ensemble.tractions(self._state))
        total = np.zeros_like(problem.dofs.load)
        for port in problem.traces:
            total += port.side.trace.T @ tractions[port.interface]
        return total

    def _place(self, body: str | Body) -> int:
        return self.scene.body_index(body)

    def _contact_index(self, contact: str | int | Contact) -> int:
        return self.scene.contact_index(contact)


def _passed(interface: Interface, gaps: Floats) -> str:
    """The note on a contact whose layer is compressed or stretched beyond its law's limit; empty if there is none."""
    law = interface.layer
    pressed = _beyond(interface, -gaps, law.compression_limit, "compressed")
    return pressed or _beyond(interface, gaps, getattr(law, "extension_limit", math.inf), "stretched")


def _beyond(interface: Interface, extent: Floats, limit: float | Floats, what: str) -> str:
    """The note on a contact whose layer is compressed or stretched by more than a limit."""
    if limit is math.inf:
        return ""
    limit = np.broadcast_to(limit, extent.shape)
    beyond = extent > limit * (1 + 1e-9)  # at the last point itself rounding tells nothing
    if not np.any(beyond):
        return ""
    worst = int(np.argmax(np.where(beyond, extent / limit, 0.0)))
    share = float(interface.weights @ beyond) / float(interface.weights.sum())
    return (
        f"contact {interface.contact.name!r}: on {share:.2g} of its area the layer is {what} further than its law is "
        f"known, to {extent[worst]:.6g} where it is known to {limit[worst]:.6g}; beyond, it is taken to go on straight"
    )


def _law_pressure(interface: Interface, gaps: Floats) -> Floats:
    """The contact pressure −g⁻(z) of gaps z at the points of an interface."""
    return 0.0 - interface.layer.contact_stress(gaps)


def _memory(interface: Interface, gaps: Floats) -> GasketAtPoints:
    """The layer of a contact that remembers, as these gaps leave it."""
    return cast("GasketAtPoints", interface.layer_after(gaps))


def _resampled(interface: Interface, degree: int) -> Interface:
    """The same contact at Gauss points of another degree."""
    first, second = interface.sides
    contact, split = interface.contact.resampled(degree), interface.gathered is not None
    return discretise(contact, (first.body, second.body), interface.facets, split)


def _corners(interface: Interface) -> Any:
    """What tells the corners of facets: those of the meshed surface, or between the points of a body without a mesh."""
    surfaces = [side.surface for side in interface.sides]
    meshed = next((surface for surface in surfaces if not isinstance(surface, PointSurface)), None)
    if meshed is not None:
        return lambda: meshed.corners
    return next((surface.corners for surface in surfaces if surface.corners is not None), None)


def _contact_result(
    interface: Interface, gaps: Floats, pressure: Floats, stiffness_ratio: Callable[[], float], wavers: bool
) -> ContactResult:
    """The result at an interface's points; wavers: whether its pressure does."""

    def nodal() -> NodalPressure:
        if interface.gathered is None:
            values = interface.functions.projected(pressure, interface.weights)
            at_points = interface.functions.at_values @ values
            return NodalPressure(interface.functions.x, values, at_points, stiffness_ratio())
        return NodalPressure(interface.x, pressure, pressure, stiffness_ratio())

    found: Any = nodal() if wavers else nodal
    return ContactResult(
        interface.x,
        interface.normal,
        interface.weights,
        gaps,
        interface.compressions(gaps),
        found.at_points if wavers else pressure,
        interface.unpaired_area,
        interface.gap,
        _corners(interface),
        interface.contact.sides[0][0].kinematics.axisymmetric,
        pressure,
        wavers,
        interface.hard,
        found,
        interface.layer.bonded,
        largest_closure=_memory(interface, gaps).closures if interface.layer.remembers else None,
        centres=interface.centres,
    )


def _stiffness_ratio(interface: Interface, gaps: Floats, pressure: Floats) -> float:
    """k h/E: the layer's stiffness where it works, beside that of the softer body's facets; 0 without a layer."""
    if interface.hard:
        return 0.0
    pressing = pressure != 0.0
    shares = interface.weights[pressing] * np.abs(pressure[pressing])
    stiffness = interface.layer.contact_derivative(gaps)[pressing]  # at all points: a law may vary
    return float(shares @ stiffness / shares.sum()) / interface.facet_stiffness if np.any(pressing) else 0.0
