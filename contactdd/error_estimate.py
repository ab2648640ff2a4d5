"""The error of a solution, estimated by solving the same scene again in elements of a higher degree.

On the same meshes the better solution is nearer to the truth, so that what it differs by is the error, but for its own
error. It is an estimate and no bound. Measured on scenes of known pressure (demos/studies/error_known.py), degrees 1
to 4, uniform and adapted, it is between 0.56 and 1.5 times the true error of p, and 1.0 where p is smooth. The least
values are those at the corner of a punch, a singularity at which every degree gains little.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from .base import compat
from .base.arrays import Floats, Indices
from .base.checks import as_count
from .body import Body
from .contact import Contact
from .contact_result import ContactResult, closed_points
from .errors import ContactWarning
from .scene import Scene
from .solution import STIFF, Solution
from .solve import solve

#: The degree of elements from which on the error is that of one facet, where contact ends: one degree more and as many
#: points as are usual told between 0.12 and 4.8 times the error, two degrees more and four times as many points between
#: 0.6 and 1.5 times.
HIGH = 3

#: k h/E from which on more points than usual make the pressure waver.
LOCKING = 100.0


@dataclass(frozen=True)
class Estimated:
    """A number of a solution with its estimated error.

    Attributes:
        value: The number itself, in its own unit.
        error: Its difference from the better solution's, in the same unit.
        scale: The reference of the relative error, in the same unit.

    Example:
        >>> Estimated(100.0, 2.0, 99.0)
        100 ± 2
    """

    value: float
    error: float
    scale: float

    @property
    def relative(self) -> float:
        """The error relative to the scale; zero where there is none, infinite where only the scale is zero."""
        return _ratio(self.error, self.scale)

    def __repr__(self) -> str:
        return f"{self.value:.6g} ± {self.error:.2g}"


@dataclass(frozen=True)
class ContactErrorEstimate:
    """The estimated errors of one contact, at the n points of its `ContactResult`.

    Attributes:
        name: The name of the contact.
        result: The contact quantities of the solution, as of `Solution.contact`.
        better: Those of the better solution, at its own points.
        better_gap: (n,) The better solution's gap at the points of `result` (length).
        better_pressure: (n,) The better solution's contact pressure there (stress).
    """

    name: str
    result: ContactResult
    better: ContactResult
    better_gap: Floats
    better_pressure: Floats

    @property
    def pressure_error(self) -> Floats:
        """The error (n,) of the contact pressure, positive where the solution's is too large (stress)."""
        return self.result.pressure - self.better_pressure

    @property
    def pressure(self) -> Estimated:
        """The contact pressure as root mean squares over the real contact area; its relative error is that in L²."""
        return _mean_squares([self])

    @property
    def largest_error(self) -> float:
        """The largest error of the contact pressure at a point (stress)."""
        return float(np.abs(self.pressure_error).max())

    @property
    def force(self) -> Estimated:
        """The contact force ∫ p ds."""
        return _difference(self.result.force, self.better.force)

    @property
    def peak_pressure(self) -> Estimated:
        """The largest contact pressure at each solution's own points (stress)."""
        return _difference(self.result.peak_pressure, self.better.peak_pressure)

    @property
    def area(self) -> Estimated:
        """The real contact area; its error is the area that is closed in one solution and open in the other.

        Points are counted as a whole: a difference smaller than the area of a point is seen by `edge` only.
        """
        differs = self.result.closed != self._better_closed
        return Estimated(self.result.area, float(self.result.weights[differs].sum()), self.better.area)

    @property
    def _better_closed(self) -> NDArray[np.bool_]:
        return closed_points(self.better_gap, self.better_pressure, self.result.hard, self.result.bonded)

    @property
    def edge(self) -> Floats:
        """The distances (k,) from each edge of contact of the better solution to the solution's (length), in the plane.

        Infinite where the solution has no edge at all.

        Raises:
            ValueError: The bodies are solids, whose edge of contact is a line.
        """
        here, there = self.result.edge, self.better.edge
        away = np.linalg.norm(there[:, None] - here[None], axis=2)
        return away.min(axis=1, initial=np.inf)

    def __repr__(self) -> str:
        parts = {"force": self.force, "peak": self.peak_pressure, "area": self.area}
        numbers = ", ".join(f"{name} {each!r}" for name, each in parts.items())
        return f"{self.name}: pressure {self.pressure.relative:.2g} relative in L², {numbers}"


@dataclass(frozen=True)
class ErrorEstimate:
    """The estimated error of a solution, and the better solution that it was found from.

    Attributes:
        solution: The solution whose errors are estimated.
        better: The solution of the same scene, elements of a higher degree on the same meshes.
        contacts: The errors of every contact, in the scene's order.
        cpu_seconds: The CPU time of the estimate (s).
    """

    solution: Solution
    better: Solution
    contacts: tuple[ContactErrorEstimate, ...]
    cpu_seconds: float

    @property
    def cost(self) -> float:
        """The CPU time of the estimate as a multiple of the solve's."""
        return _ratio(self.cpu_seconds, self.solution.cpu_seconds)

    @property
    def pressure(self) -> Estimated:
        """The contact pressure of all contacts as root mean squares over their real areas; relative errors in L²."""
        return _mean_squares(self.contacts)

    @property
    def energy(self) -> Estimated:
        """The energy F₁ of (13); its relative error refers to the energy of all bodies and layers.

        The energy of the exact solution is the least one: half of ‖u − u_h‖² in the energy norm, or more, is the error.
        """
        stored = self.better.elastic_energy() + self.better.layer_energy
        return Estimated(self.solution.energy, abs(self.solution.energy - self.better.energy), abs(stored))

    def contact(self, contact: str | int | Contact = 0) -> ContactErrorEstimate:
        """The errors of one contact.

        Args:
            contact: Its name (as typed, "lower-upper", too), its index in the scene or the `Contact`.
        """
        return self.contacts[self.solution.scene.contact_index(contact)]

    def displacement(self, body: str | Body) -> Estimated:
        """The largest displacement of a body at a node, and the largest error there (length).

        Args:
            body: Its name or the `Body`.
        """
        index = self.solution.scene.body_index(body)
        own = self.solution.scene.bodies[index]
        dim = own.kinematics.dim if own.mesh is None else own.mesh.dim
        if own.mesh is None:  # its unknowns are no displacements of nodes
            dim = 1
        u = self.solution.displacement_on(self.better.scene.bodies[index])
        norms = [_largest(each, dim) for each in (u, self._differences[index], u - self._differences[index])]
        return Estimated(*norms)

    def displacement_error(self, body: str | Body) -> fem.Function:
        """The error field u − u_better of a body in the better solution's elements, a dolfinx function (length).

        Args:
            body: Its name or the `Body`.

        Raises:
            ValueError: The body has no mesh.
        """
        index = self.solution.scene.body_index(body)
        owner = self.better.scene.bodies[index]
        if owner.mesh is None:
            raise ValueError(f"body = {owner.name!r}: it has no mesh; expected a body with one")
        function = fem.Function(owner.space, name="displacement_error")
        function.x.array[:] = self._differences[index]
        return function

    def cell_errors(self, body: str | Body) -> Floats:
        """The energy of the displacement's error in every cell of a body, ½ ∫ σ(e) : ε(e), (cells,) (force · length).

        Args:
            body: Its name or the `Body`.

        Raises:
            ValueError: The body has no mesh.
        """
        error = self.displacement_error(body)
        owner = self.better.scene.bodies[self.solution.scene.body_index(body)]
        return 0.5 * cell_energies(owner, [error.x.array])[0]

    def plot(self, **options: Any) -> Any:
        """A matplotlib figure of every contact's pressure with its error, and of the bodies' errors cell by cell.

        The bodies are drawn in the plane only, coloured by the energy of the error per volume.

        Args:
            options: `path`, `stress_unit`, `length_unit`, see `view.error_plot.plot_error`.
        """
        from .view.error_plot import CellErrors, ContactError, plot_error

        drawn = [ContactError(each.name, each.result, each.pressure_error) for each in self.contacts]
        plane = [body for body in self.solution.scene.bodies if body.mesh is not None and body.mesh.dim == 2]
        cells = [CellErrors(outlines(body.mesh.domain), self._density(body)) for body in plane]
        return plot_error(drawn, cells, **options)

    def _density(self, body: Body) -> Floats:
        """The energy of the error in every cell, by its volume."""
        volumes: Floats = fem.assemble_vector(compat.form(body.elements.by_cell(1.0))).array
        return self.cell_errors(body) / volumes

    @cached_property
    def _differences(self) -> list[Floats]:
        """u − u_better of every body in the better solution's unknowns."""
        bodies = self.better.scene.bodies
        better = [self.better.displacement(body) for body in bodies]
        values = [u if body.mesh is None else u.x.array for body, u in zip(bodies, better, strict=True)]
        return [self.solution.displacement_on(body) - u for body, u in zip(bodies, values, strict=True)]

    def __repr__(self) -> str:
        head = f"ErrorEstimate: pressure {self.pressure.relative:.2g} relative in L², energy {self.energy.relative:.2g}"
        lines = [f"{head}, for {self.cost:.2g} times the CPU of the solve", *map(repr, self.contacts)]
        return "\n  ".join(lines)


def error_estimate(solution: Solution, *, degrees: int | None = None, tolerance: float = 1e-10) -> ErrorEstimate:
    """The estimated error of a solution: its difference from one in elements of a higher degree.

    The meshes, materials, supports, loads and contacts are the same; the better solve starts from the solution. It may
    compile forms of that degree when they are first met. A solution that did not converge is compared too: its error
    is then that of the iteration as well. Contacts of the better scene evaluate the law at Gauss points, whatever the
    solution's own do; pressures are compared at the points of `Solution.contact`. Collective: on several
    ranks all have to call it.

    Args:
        solution: A result of `solve`. Its scene's parameters may have other values by now: the solution's own count.
        degrees: The number of degrees by which the elements of the better solution are higher; by default one for
            elements of degree 1 and 2, two for others, where contact that ends within a cell lets one degree gain
            little.
        tolerance: The bound of the better solve's residual (no unit), as of `solve`; a thousandth of the error that is
            looked for does.

    Raises:
        TypeError, ValueError: It is no solution, elements of a degree so high do not exist, or elements of degree 2
            and more meet a contact whose pressure is linear between nodes of the mesh however they are: a hard one, or
            one of a layer far stiffer than they are, on meshes that do not match.
        ContactWarning: As a warning, the same with elements of degree 1: the error may be several times the estimate
            where pressures rise steeply.
        NotConvergedError: The better solve does not end.

    Example:
        >>> import contactdd as cd
        >>> meshes = [cd.rectangle((0, y), (2, y + 1), (8, 4)) for y in (0, 1)]
        >>> steel = cd.Isotropic(E=2.1e5, nu=0.3)
        >>> low = cd.Body("low", meshes[0], steel, supports=[cd.Fixed("bottom")])
        >>> high = cd.Body("high", meshes[1], steel, loads=[cd.Pressure("top", lambda x: 1 + x[0])])
        >>> contact = cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(1e6))
        >>> estimate = cd.error_estimate(cd.solve(cd.Scene([low, high], [contact])))
        >>> estimate.pressure.relative < 0.1
        True
    """
    if not isinstance(solution, Solution):
        raise TypeError(f"solution = {solution!r}: expected a Solution, such as cd.solve(...) returns")
    higher = None if degrees is None else as_count("degrees", degrees)
    began = time.process_time()
    for index in range(len(solution.scene.contacts)):
        _doubt_nodal_pressure(solution, index)
    with solution.scene.at(solution.parameter_values):
        scene = _raised(solution, higher)
        better = solve(scene, start=solution, local_solver=solution.local_solver, tolerance=tolerance, progress=False)
        contacts = tuple(_compared(solution, better, index) for index in range(len(scene.contacts)))
    return ErrorEstimate(solution, better, contacts, time.process_time() - began)


def _doubt_nodal_pressure(solution: Solution, index: int) -> None:
    """Warn of a pressure that is linear between nodes of the mesh whatever the elements' degree, or refuse it.

    Elements of degree 1 do hardly better themselves, but where pressures rise steeply. Under a soft layer the pressures
    of nodes are off by as much as the elements' displacements are.
    """
    interface, result = solution.interfaces[index], solution.contact(index)
    if all(body.mesh is None for body, _ in interface.contact.sides):
        raise ValueError(
            f"contact {interface.contact.name!r}: neither body has elements, whose degree could be raised; compare "
            "with more points of their own"
        )
    if not (result.hard or result.wavers or (interface.gathered is not None and result.stiffness_ratio > STIFF)):
        return
    layer = "no layer" if result.hard else f"a layer {result.stiffness_ratio:.3g} times as stiff as the elements"
    told = f"contact {interface.contact.name!r}: with {layer} its pressure is linear between nodes of the mesh"
    if max(body.degree for body, _ in interface.contact.sides if body.mesh is not None) > 1:
        raise ValueError(
            f"{told}, of which elements of a higher degree tell nothing; expected elements of degree 1, or meshes that "
            "match and a layer"
        )
    if solution.scene.ranks.comm.rank == 0:
        warnings.warn(
            f"{told}: its error may be several times the estimated one where pressures rise steeply",
            ContactWarning,
            stacklevel=3,
        )


def _raised(solution: Solution, degrees: int | None) -> Scene:
    """The same scene in elements of a higher degree."""
    scene = solution.scene
    bodies: Mapping[str, Body] = {
        body.name: body.with_degree(body.degree + _more(body, degrees))
        for body in scene.bodies
        if body.mesh is not None
    }
    contacts = []
    for index, contact in enumerate(scene.contacts):
        more = max(_more(body, degrees) for body, _ in contact.sides if body.mesh is not None)
        contacts.append(contact.raised(more, finely=_needs_points(solution, index)).with_bodies(bodies))
    return Scene([bodies.get(body.name, body) for body in scene.bodies], contacts, scene.ranks.comm)


def _more(body: Body, degrees: int | None) -> int:
    """The number of degrees by which a body's elements are raised."""
    if degrees is not None:
        return degrees
    return 1 if body.degree < HIGH else 2


def _needs_points(solution: Solution, index: int) -> bool:
    """Whether the error of a contact is less that of its elements than of its points where contact ends.

    Not under a layer so stiff that more points than the elements can follow make the pressures waver.
    """
    interface = solution.interfaces[index]
    degree = max((body.degree for body, _ in interface.contact.sides if body.mesh is not None), default=0)
    if degree < HIGH or interface.hard or interface.gathered is not None:
        return False
    return solution.contact(index).stiffness_ratio < LOCKING


def _compared(solution: Solution, better: Solution, index: int) -> ContactErrorEstimate:
    """Both solutions of a contact at the points of the first."""
    interface, result, best = solution.interfaces[index], solution.contact(index), better.contact(index)
    gap, pressure = better.contact_at(interface)
    if not result.hard and result.stiffness_ratio > STIFF:
        # The law's own pressure wavers between points that are not its own. That of nodes is as sure as the solution's.
        if interface.gathered is not None:
            pressure = best.nodal_pressure[_nearest(result.x, best.node_x)]
        elif result.wavers or interface.rule.name == "facet":
            pressure = interface.functions.at_values @ best.nodal_pressure
    return ContactErrorEstimate(interface.contact.name, result, best, gap, pressure)


def _nearest(points: Floats, nodes: Floats) -> Indices:
    """The node (k, dim) that lies at each point (n, dim)."""
    from scipy.spatial import cKDTree

    return cKDTree(nodes).query(points)[1]


def _difference(value: float, better: float) -> Estimated:
    return Estimated(value, abs(value - better), abs(better))


def _mean_squares(contacts: Sequence[ContactErrorEstimate]) -> Estimated:
    """The pressure of contacts, its error and the better one, as root mean squares over their real contact areas."""
    area, squares = 0.0, np.zeros(3)
    for contact in contacts:
        area += contact.better.area or contact.result.nominal_area
        for i, p in enumerate((contact.result.pressure, contact.pressure_error, contact.better_pressure)):
            squares[i] += contact.result.weights @ p**2
    return Estimated(*np.sqrt(squares / area).tolist())


def _largest(u: Floats, dim: int) -> float:
    """The largest length of vectors (nodes, dim), given one after another."""
    return float(np.linalg.norm(u.reshape(-1, dim), axis=1).max(initial=0.0))


def _ratio(part: float, whole: float) -> float:
    """part / whole; 0 of nothing, infinite where only the whole is zero."""
    return part / whole if whole != 0.0 else (0.0 if part == 0.0 else np.inf)


def cell_energies(body: Body, displacements: Sequence[Floats]) -> list[Floats]:
    """∫ σ(u) : ε(u) over every cell of a body, (cells,) for each u (dofs,)."""
    u = fem.Function(body.space)
    density = ufl.inner(body.stress(u), body.kinematics.strain(u))
    form = compat.form(body.elements.by_cell(density, body.elastic_metadata))
    found = []
    for values in displacements:
        u.x.array[:] = values
        found.append(np.maximum(fem.assemble_vector(form).array, 0.0))  # nothing may round below it
    return found


def outlines(domain: Any) -> Floats:
    """The corners (cells, corners, 2) of plane cells, in order around each."""
    corners = compat.geometry_dofmap(domain)
    around = [0, 1, 3, 2] if domain.topology.cell_name() == "quadrilateral" else [0, 1, 2]
    return domain.geometry.x[corners[:, around], :2]
