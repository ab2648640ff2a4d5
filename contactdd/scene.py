"""A scene: all bodies and the contacts between them, checked, and what is kept of them from one solve to the next."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from copy import copy
from functools import cached_property
from typing import Any

import numpy as np
from mpi4py import MPI

from .base.arrays import Floats
from .base.checks import as_tuple_of, check_choice
from .base.ranks import Ranks
from .body import Body
from .contact import Contact
from .hard_contact import HardContact
from .interface.discretise import Interface, discretise
from .layer import Layer
from .local.assembled import AssembledProblem
from .local.condensed import CondensedProblem
from .local.copies import originals
from .local.memory import cheapest_solver, refuse_if_too_large
from .local.multigrid import MultigridProblem
from .local.remote import RemoteProblem
from .parameter import Parameter, parameters

LOCAL_SOLVERS = ("auto", "condensed", "assembled", "multigrid")


class Scene:
    """Bodies and contacts. What does not change between solves is made when first needed and kept.

    comm: the MPI ranks that share the bodies' work, by default this one alone. All of them have to make the same scene
    and the same solves; every rank then has the whole solution.
    """

    def __init__(self, bodies: Sequence[Body], contacts: Sequence[Contact], comm: MPI.Comm = MPI.COMM_SELF) -> None:
        self.bodies = as_tuple_of("bodies", bodies, Body)
        self.contacts = as_tuple_of("contacts", contacts, Contact)
        if not isinstance(comm, MPI.Comm):
            raise TypeError(f"comm = {comm!r}: expected an MPI communicator, such as MPI.COMM_WORLD")
        self._check()
        # One rank alone need not weigh them.
        self.ranks = Ranks(comm, [body.dofs if comm.size > 1 else 0.0 for body in self.bodies])
        self._subproblems: dict[tuple[str, int], AssembledProblem] = {}
        self._read = self._parameter_values()

    def __repr__(self) -> str:
        lines = [f"Scene of {len(self.bodies)} bodies and {len(self.contacts)} contacts"]
        return "\n  ".join(lines + [repr(item) for item in (*self.bodies, *self.contacts)])

    @cached_property
    def interfaces(self) -> list[Interface]:
        """The discretised contacts, in order."""
        places = {id(body): place for place, body in enumerate(self.bodies)}
        return [discretise(c, (places[id(c.sides[0][0])], places[id(c.sides[1][0])])) for c in self.contacts]

    def subproblems(self, local_solver: str) -> list[AssembledProblem]:
        """Every body's linear problem, in order.

        local_solver: "condensed", "assembled", "multigrid", or "auto": condensed unless a body is too large for it.
        """
        check_choice("local_solver", local_solver, LOCAL_SOLVERS)
        if self._parameter_values() != self._read:
            self.refresh()
        kinds = [local_solver if local_solver != "auto" else cheapest_solver(body) for body in self.bodies]
        kinds = self.ranks.agree(kinds)
        if not self.ranks.alone:
            self._exchange(kinds)
        return [self._subproblem(kind, place) for place, kind in enumerate(kinds)]

    def _exchange(self, kinds: Sequence[str]) -> None:
        """Make the condensed problems, each on the rank that owns its body, and tell the others what they need."""
        missing = [kind == "condensed" and (kind, place) not in self._subproblems for place, kind in enumerate(kinds)]
        if not any(self.ranks.comm.allgather(any(missing))):
            return
        made = self.ranks.each(
            lambda place: self._subproblem("condensed", place).shared() if kinds[place] == "condensed" else None
        )
        for place, shared in enumerate(made):
            if shared is not None and not self.ranks.owns(place):
                problem = RemoteProblem(self.bodies[place], place, self.interfaces, shared)
                self._subproblems["condensed", place] = problem

    def _subproblem(self, kind: str, place: int) -> AssembledProblem:
        """One body's linear problem, made when first asked for."""
        if (kind, place) not in self._subproblems:
            body = self.bodies[place]
            if kind == "condensed":
                made: AssembledProblem = self._condensed(place)
            elif kind == "assembled":
                refuse_if_too_large(body)
                made = AssembledProblem(body, place, self.interfaces, self._original(kind, place))
            else:
                made = MultigridProblem(body, place, self.interfaces)
            self._subproblems[kind, place] = made
        return self._subproblems[kind, place]

    def _condensed(self, place: int) -> CondensedProblem:
        """One body's condensed problem; identical bodies share the factorisation of the inside."""
        others = [p for p in self._subproblems.values() if type(p) is CondensedProblem]
        inner, original = self._subproblem("assembled", place), self._original("condensed", place)
        return CondensedProblem(inner, self.ranks.team(place), others, original)

    def _original(self, kind: str, place: int) -> tuple[Any, Floats] | None:
        """The problem of the body that this one is a copy of, if that has been made, and the signs between them."""
        original = self._originals[place]
        if original is None or not self.ranks.alone or (kind, original[0]) not in self._subproblems:
            return None
        problem = self._subproblems[kind, original[0]]
        return None if problem.space.free is None else (problem, original[1])

    @cached_property
    def _originals(self) -> list[tuple[int, Floats] | None]:
        """The place of the body that each is a copy of, with the signs between them."""
        return originals(self.bodies)

    def refresh(self) -> None:
        """Read loads, prescribed displacements and gaps anew; stiffnesses, factorisations and contacts are kept.

        A solve does it by itself when a `Parameter` of the scene has another value than before. Only a function that
        changed in another way has to be told of.
        """
        self._read = self._parameter_values()
        if "interfaces" in vars(self):
            self.interfaces = [i.refreshed(c) for i, c in zip(self.interfaces, self.contacts, strict=True)]
        old, self._subproblems = self._subproblems, {}
        for (kind, place), problem in sorted(old.items(), key=lambda item: item[0][0]):  # "assembled" comes first
            if isinstance(problem, RemoteProblem):
                continue  # its owner will tell
            if isinstance(problem, CondensedProblem):
                self._subproblems[kind, place] = problem.refreshed_for(self._subproblems["assembled", place])
            else:
                self._subproblems[kind, place] = problem.refreshed()

    def with_layer(self, layer: Layer | HardContact, contact: str | None = None) -> Scene:
        """The same scene with another layer in a contact, by its name, or in all of them.

        Everything that does not depend on the layer is shared: a sweep over layers costs the interfaces only.
        """
        names = [other.name for other in self.contacts]
        if contact is not None and contact not in names:
            raise ValueError(f"contact = {contact!r}: expected one of {', '.join(map(repr, names))}")
        other = copy(self)
        other.contacts = tuple(c.with_layer(layer) if contact in (None, c.name) else c for c in self.contacts)
        other.interfaces = [
            interface.with_layer(c.layer) for interface, c in zip(self.interfaces, other.contacts, strict=True)
        ]
        other._subproblems = dict(self._subproblems)
        return other

    def follows(self, parameter: Parameter) -> bool:
        """Whether any load, prescribed displacement or gap of the scene follows the parameter."""
        return any(parameter is other for other in self._parameters())

    def _parameters(self) -> list[Parameter]:
        items = [item for body in self.bodies for item in (*body.loads, *body.supports)] + list(self.contacts)
        return [parameter for item in items for parameter in parameters(vars(item).values())]

    def _parameter_values(self) -> list[bytes]:
        return [np.asarray(parameter.value).tobytes() for parameter in self._parameters()]

    def _check(self) -> None:
        if not self.contacts:
            raise ValueError("contacts = []: expected at least two bodies and a contact between them")
        for name, count in Counter(body.name for body in self.bodies).items():
            if count > 1:
                raise ValueError(f"bodies: the name {name!r} is used {count} times; expected names used once")
        for name, count in Counter(contact.name for contact in self.contacts).items():
            if count > 1:
                raise ValueError(f"contacts: the name {name!r} is used {count} times; give them names")
        used: dict[tuple[int, int], str] = {}
        for contact in self.contacts:
            self._check_contact(contact, used)
        touching = {id(body) for contact in self.contacts for body, _ in contact.sides}
        for body in self.bodies:
            if id(body) not in touching:
                raise ValueError(f"body {body.name!r} has no contact; expected bodies that touch others")

    def _check_contact(self, contact: Contact, used: dict[tuple[int, int], str]) -> None:
        """The bodies of a contact are the scene's, and no facet is in two contacts."""
        if contact.sides[0][0] is contact.sides[1][0]:
            raise ValueError(f"contact {contact.name!r}: expected two different bodies")
        for body, surface in contact.sides:
            if not any(body is other for other in self.bodies):
                raise ValueError(f"contact {contact.name!r}: body {body.name!r} is not in the scene")
            if body.kinematics.ring != contact.sides[0][0].kinematics.ring:
                raise ValueError(f"contact {contact.name!r}: one body is axisymmetric; expected both or none")
            for facet in body.mesh.facets(surface):
                key = (id(body), int(facet))
                if key in used:
                    raise ValueError(
                        f"contact {contact.name!r}: surface {surface!r} of body {body.name!r} has facets that contact "
                        f"{used[key]!r} uses already"
                    )
                used[key] = contact.name
