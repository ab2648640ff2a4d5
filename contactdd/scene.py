"""A scene: all bodies and the contacts between them, checked, with all that later solves reuse."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from copy import copy
from functools import cached_property
from typing import Any

import numpy as np
from mpi4py import MPI

from .base.arrays import Floats
from .base.checks import as_tuple_of, check_choice, listed
from .base.ranks import Ranks
from .body import Body
from .coefficient_value import CoefficientValue, coefficient_values
from .contact import Contact
from .hard_contact import HardContact
from .interface.alike import discretise_all
from .interface.discretise import Interface
from .layer import Layer
from .load import BodyLoad
from .local.choose import LOCAL_SOLVERS, LocalSolvers
from .local.problem import LocalProblem
from .local.space import admissible_space
from .meshless import MeshlessBody
from .parameter import Parameter, parameters
from .support import Displacement, Spring, Support


class Scene:
    """Bodies and contacts, checked to fit each other.

    Factorisations and discretised contacts are computed on first use and reused by later solves.

    Args:
        bodies: At least two, their names unique.
        contacts: Between them; every body is in one at least.
        comm: The MPI ranks that share the bodies' work, by default this one alone. Collective: every rank must
            construct the same scene and call the same solves; each receives the whole solution.

    Raises:
        TypeError, ValueError: Bodies and contacts make no scene.

    Example:
        >>> import contactdd as cd
        >>> steel, mesh = cd.Isotropic(E=2e5, nu=0.3), cd.rectangle((0, 0), (2, 1), (2, 1))
        >>> lower = cd.Body("lower", mesh, steel, supports=[cd.Fixed("bottom")])
        >>> upper = cd.Body("upper", mesh.moved((0, 1)), steel, loads=[cd.Pressure("top", 3.0)])
        >>> scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.LinearLayer(1e4))])
        >>> stiffer = scene.with_layer(cd.LinearLayer(1e5))  # shares bodies and factorisations
    """

    def __init__(
        self, bodies: Sequence[Body | MeshlessBody], contacts: Sequence[Contact], comm: MPI.Comm = MPI.COMM_SELF
    ) -> None:
        self.bodies = as_tuple_of("bodies", bodies, Body | MeshlessBody)
        self.contacts = as_tuple_of("contacts", contacts, Contact)
        if not isinstance(comm, MPI.Comm):
            raise TypeError(f"comm = {comm!r}: expected an MPI communicator, such as MPI.COMM_WORLD")
        self._check()
        # On a single rank the weights for load balancing are not needed.
        self.ranks = Ranks(comm, [0.0 if comm.size == 1 or body.mesh is None else body.dofs for body in self.bodies])
        self._interfaces: list[Interface] | None = None
        self._sliding: list[Interface] | None = None
        self._solvers: LocalSolvers | None = None
        self._read = self._parameter_values()

    def __repr__(self) -> str:
        contacts = "1 contact" if len(self.contacts) == 1 else f"{len(self.contacts)} contacts"
        lines = [f"Scene of {len(self.bodies)} bodies and {contacts}"]
        return "\n  ".join(lines + [repr(item) for item in (*self.bodies, *self.contacts)])

    @property
    def interfaces(self) -> list[Interface]:
        """The discretised contacts, in order."""
        if self._interfaces is None:
            index = {id(body): i for i, body in enumerate(self.bodies)}
            places = [(index[id(c.sides[0][0])], index[id(c.sides[1][0])]) for c in self.contacts]
            self._interfaces = discretise_all(self.contacts, places)
        return self._interfaces

    @property
    def sliding(self) -> list[Interface]:
        """The interfaces of what resists sliding in the contacts, in their order; mostly none."""
        if self._sliding is None:
            self._sliding = []
            for index, contact in enumerate(self.contacts):
                if contact.sliding is not None:
                    from .interface.sliding import sliding_interfaces

                    self._sliding += sliding_interfaces(self.interfaces[index], index)
        return self._sliding

    def local_problems(self, local_solver: str = "auto") -> list[LocalProblem]:
        """Every body's local problem, in order.

        Args:
            local_solver: "condensed", "assembled", "multigrid", a registered name, or "auto": for each body the
                one of "condensed" and "multigrid" that is estimated to cost less.

        Raises:
            ValueError: There is no local solver of that name.
        """
        check_choice("local_solver", local_solver, ("auto", *LOCAL_SOLVERS))
        for body in self.bodies:
            if body.mesh is not None:
                body.refuse_changed_material()
        if self._parameter_values() != self._read:
            self.refresh()
        if self._solvers is None:
            self._solvers = LocalSolvers(self.bodies, [*self.interfaces, *self.sliding], self.ranks)
        return self._solvers.problems(local_solver)

    @property
    def estimates(self) -> list[str]:
        """What local solvers were estimated to cost where "auto" chose between them, in words."""
        return [] if self._solvers is None else self._solvers.notes

    def subproblems(self, local_solver: str = "auto") -> list[LocalProblem]:
        """The old name of `local_problems`.

        Args:
            local_solver: See there.
        """
        warnings.warn("Scene.subproblems is now called local_problems", DeprecationWarning, stacklevel=2)
        return self.local_problems(local_solver)

    def refresh(self) -> None:
        """Read loads, prescribed displacements and gaps anew; stiffnesses, factorisations and contacts are kept.

        A solve does it by itself when a `Parameter` of the scene, or a Constant or Function of dolfinx in a UFL
        expression, has another value than before. Only a function that changed in another way has to be told of. If a
        value cannot be read the scene stays as it was, and the next solve reads again.
        """
        read, interfaces, solvers = self._parameter_values(), self._interfaces, self._solvers
        if interfaces is not None:
            interfaces = [i.refreshed(c) for i, c in zip(interfaces, self.contacts, strict=True)]
        if solvers is not None:
            solvers = solvers.refreshed()
        self._read, self._interfaces, self._solvers = read, interfaces, solvers

    def with_layer(self, layer: Layer | HardContact, contact: str | None = None) -> Scene:
        """The same scene with another layer in a contact, or in all of them.

        Everything that does not depend on the layer is shared: a sweep over layers costs the interfaces only.

        Args:
            layer: The new law.
            contact: The name of the contact, by default all.

        Raises:
            ValueError: There is no contact of that name.
        """
        names = [other.name for other in self.contacts]
        if contact is not None and contact not in names:
            raise ValueError(f"contact = {contact!r}: expected one of {', '.join(map(repr, names))}")
        other = copy(self)
        other.contacts = tuple(c.with_layer(layer) if contact in (None, c.name) else c for c in self.contacts)
        other._interfaces = [
            interface.with_layer(c.layer) for interface, c in zip(self.interfaces, other.contacts, strict=True)
        ]
        other._sliding = None
        alike = [one.slides for one in self.sliding] == [one.slides for one in other.sliding]
        other._solvers = self._solvers.shared() if alike and self._solvers is not None else None
        return other

    def with_bodies(self, bodies: Mapping[str, Body]) -> Scene:
        """The same scene with other bodies, such as some of another degree; the others and all contacts stay.

        Args:
            bodies: The new bodies, by the names of those that they replace.

        Raises:
            TypeError, ValueError: There is no body of such a name, or the bodies do not fit the contacts.
        """
        known = {body.name for body in self.bodies}
        for name, body in bodies.items():
            if name not in known:
                raise ValueError(f"bodies: there is no body {name!r}; expected some of {listed(known)}")
            if not isinstance(body, Body | MeshlessBody):
                raise TypeError(f"bodies: {name!r} is {body!r}; expected a body")
        replaced = [bodies.get(body.name, body) for body in self.bodies]
        return Scene(replaced, [contact.with_bodies(bodies) for contact in self.contacts], self.ranks.comm)

    def refined(self, cells: Mapping[str, Any] | None = None) -> Scene:
        """The same scene with finer meshes: the supports, loads and contacts are those of the surfaces' names.

        Args:
            cells: {body: cells} of the bodies to be refined, as for `Mesh.refined`, None for all cells of a body; by
                default all cells of all bodies that have a mesh.

        Raises:
            ValueError: There is no such body, it has no mesh of triangles or tetrahedra, or see `Body.on`.
        """
        if cells is None:
            cells = {body.name: None for body in self.bodies if body.mesh is not None}
        finer = {}
        for name, wanted in cells.items():
            body = self.bodies[self.body_index(name)]
            if body.mesh is None:
                raise ValueError(f"body = {name!r}: it has no mesh; expected a body with one")
            finer[name] = body.on(body.mesh.refined(wanted))
        return self.with_bodies(finer)

    def hints(self) -> list[str]:
        """What would make the scene smaller, in words: planes of symmetry that it has and does not use.

        Two bodies that are mirror images of each other, or a whole scene that is symmetric about a plane across an
        axis. Nothing is said of scenes with bodies without a mesh, springs or materials that are not isotropic. A look
        at all nodes: no solve does it by itself.

        Returns:
            One text for each plane; empty if there is none.

        Example:
            >>> import contactdd as cd
            >>> steel, mesh = cd.Isotropic(E=2e5, nu=0.3), cd.rectangle((0, 0), (2, 1), (2, 1))
            >>> low = cd.Body("low", mesh, steel, loads=[cd.Pressure("bottom", 3.0)])
            >>> high = cd.Body("high", mesh.moved((0, 1)), steel, loads=[cd.Pressure("top", 3.0)])
            >>> scene = cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(1e4))])
            >>> for hint in scene.hints():
            ...     print(hint.partition(":")[0])
            bodies 'low' and 'high' are mirror images
            the scene is symmetric about x = 1
        """
        from .hints import hints

        loads = [problem.dofs.load for problem in self.local_problems()]
        return hints(self.bodies, loads, self.interfaces, self.sliding)

    def body_index(self, body: str | Body) -> int:
        """The index of a body in the scene.

        Args:
            body: Its name or the `Body`.

        Raises:
            ValueError: There is no such body.
        """
        for index, other in enumerate(self.bodies):
            if other is body or other.name == body:
                return index
        raise ValueError(f"body = {body!r}: expected one of {', '.join(repr(b.name) for b in self.bodies)}")

    def contact_index(self, contact: str | int | Contact) -> int:
        """The index of a contact in the scene.

        Args:
            contact: Its name (as typed, "lower-upper", too), its index or the `Contact`.

        Raises:
            ValueError: There is no such contact.
        """
        for index, other in enumerate(self.contacts):
            if contact in (other, index, other.name, _typed(other.name)):
                return index
        known = ", ".join(repr(_typed(other.name)) for other in self.contacts)
        raise ValueError(f"contact = {contact!r}: expected an index or one of {known}")

    def parameter_values(self) -> list[float | Floats]:
        """The present values of all parameters that loads, prescribed displacements and gaps follow.

        So do those of dolfinx' Constants and Functions in UFL expressions.
        """
        return [parameter.value for parameter in self._parameters]

    @contextmanager
    def at(self, values: Sequence[float | Floats]) -> Iterator[None]:
        """A context in which the parameters have values that they had earlier; they are set back after it.

        Args:
            values: The values, as `parameter_values` gave them.
        """
        present = self.parameter_values()
        parameters = self._parameters
        try:
            for parameter, value in zip(parameters, values, strict=True):
                parameter.value = value
            yield
        finally:
            for parameter, value in zip(parameters, present, strict=True):
                parameter.value = value

    def follows(self, parameter: Parameter) -> bool:
        """Whether any load, prescribed displacement or gap of the scene follows a parameter.

        Args:
            parameter: The parameter in question.
        """
        return any(parameter is other for other in self._parameters)

    @cached_property
    def _parameters(self) -> list[Parameter | CoefficientValue]:
        """The parameters that any load, prescribed displacement or gap follows, and dolfinx' coefficients in them."""
        found: list[Parameter | CoefficientValue] = []
        for values in self._given():
            found += parameters(values)
            found += coefficient_values(values)
        return found

    def _given(self) -> Iterator[list[Any]]:
        """The values of what is read anew for another solve: gaps, loads, supports, bodies without a mesh."""
        yield from (list(vars(contact).values()) for contact in self.contacts)
        for body in self.bodies:
            items: Sequence[Any] = (body,) if body.mesh is None else (*body.loads, *body.supports)
            for item in items:
                yield list(item.followed(body) if isinstance(item, BodyLoad) else vars(item).values())

    def _parameter_values(self) -> list[bytes]:
        """The present values, to be compared with later ones."""
        return [np.asarray(parameter.value).tobytes() for parameter in self._parameters]

    def _check(self) -> None:
        if not self.contacts:
            raise ValueError("contacts = []: expected at least two bodies and a contact between them")
        for name, count in Counter(body.name for body in self.bodies).items():
            if count > 1:
                raise ValueError(f"bodies: the name {name!r} is used {count} times; expected names used once")
        for body in self.bodies:
            if isinstance(body.local_solver, str):
                check_choice("local_solver", body.local_solver, ("auto", *LOCAL_SOLVERS))
        for name, count in Counter(contact.name for contact in self.contacts).items():
            if count > 1:
                raise ValueError(f"contacts: the name {name!r} is used {count} times; give them names")
        used: dict[tuple[int, int], str] = {}
        there = {id(body) for body in self.bodies}
        for contact in self.contacts:
            _check_contact(contact, there, used)
        touching = {id(body) for contact in self.contacts for body, _ in contact.sides}
        for body in self.bodies:
            if id(body) not in touching:
                raise ValueError(f"body {body.name!r} has no contact; expected bodies that touch others")
        for body in self.bodies:
            if body.mesh is not None and _may_contradict(body.supports):
                admissible_space(body)  # refuses supports that prescribe different displacements


def _check_contact(contact: Contact, there: set[int], used: dict[tuple[int, int], str]) -> None:
    """The bodies of a contact are the scene's (there: their ids), and no facet is in two contacts."""
    if contact.sides[0][0] is contact.sides[1][0]:
        raise ValueError(f"contact {contact.name!r}: expected two different bodies")
    for body, surface in contact.sides:
        if id(body) not in there:
            raise ValueError(f"contact {contact.name!r}: body {body.name!r} is not in the scene")
        if body.kinematics.axisymmetric != contact.sides[0][0].kinematics.axisymmetric:
            raise ValueError(f"contact {contact.name!r}: one body is axisymmetric; expected both or none")
        for facet in () if body.mesh is None else body.mesh.facets(surface).tolist():
            key = (id(body), facet)
            if key in used:
                raise ValueError(
                    f"contact {contact.name!r}: surface {surface!r} of body {body.name!r} has facets that contact "
                    f"{used[key]!r} uses already"
                )
            used[key] = contact.name


def _typed(name: str) -> str:
    """A contact's name as a keyboard has it: the dash between two bodies' names as a hyphen."""
    return name.replace("–", "-")


def _may_contradict(supports: Sequence[Support]) -> bool:
    """Whether supports, as they will always be, might prescribe different displacements of one point."""
    holding = [support for support in supports if not isinstance(support, Spring)]
    prescribing = [support for support in holding if isinstance(support, Displacement)]
    return bool(prescribing) and len(holding) > 1 and not parameters(s.values for s in prescribing)
