"""A body that is made where it is held: by the rank of a scene that owns it, and by no other."""

from __future__ import annotations

from collections.abc import Callable

from .base.checks import positive
from .body import Body


class DeferredBody:
    """A body that only the ranks of a scene that hold it make; the others are told of its contact surfaces.

    Its mesh, matrices, factors and fields are on those ranks alone, so that a scene may be as large as the memory of
    all machines together. On one rank it is as if the body itself were given.

    Args:
        name: The body's name, unique in a scene.
        make: A function without arguments that makes the `Body` of that name, such as one that reads its mesh from a
            file. It is called once by each rank that holds the body.
        work: The work that the body is, in the unit of unknowns (no unit): bodies are dealt out to the ranks by it.

    Raises:
        TypeError: The name is no text, or `make` no function.
        ValueError: `work` is no positive number.

    Example:
        >>> import contactdd as cd
        >>> steel, mesh = cd.Isotropic(E=2e5, nu=0.3), cd.rectangle((0, 0), (2, 1), (2, 1))
        >>> def lower():
        ...     return cd.Body("lower", mesh, steel, supports=[cd.Fixed("bottom")])
        >>> def upper():
        ...     return cd.Body("upper", mesh.moved((0, 1)), steel, loads=[cd.Pressure("top", 3.0)])
        >>> bodies = [cd.DeferredBody("lower", lower), cd.DeferredBody("upper", upper)]
        >>> contact = cd.Contact((bodies[0], "top"), (bodies[1], "bottom"), cd.LinearLayer(1e4))
        >>> scene = cd.Scene(bodies, [contact])  # with comm=MPI.COMM_WORLD each rank makes its own
        >>> scene.bodies[1].dofs
        12
    """

    def __init__(self, name: str, make: Callable[[], Body], *, work: float = 1.0) -> None:
        if not isinstance(name, str) or not name:
            raise TypeError(f"name = {name!r}: expected a text")
        if not callable(make):
            raise TypeError(f"make = {make!r}: expected a function that makes the body {name!r}")
        self.name, self.make, self.work = name, make, positive("work", work)

    def made(self) -> Body:
        """The body, made now.

        Raises:
            TypeError: The function gives something else.
            ValueError: The body has another name.
        """
        body = self.make()
        if not isinstance(body, Body):
            raise TypeError(f"make of body {self.name!r} gives {body!r}: expected a cd.Body")
        if body.name != self.name:
            raise ValueError(f"make of body {self.name!r} gives a body of the name {body.name!r}; expected the same")
        return body

    def __repr__(self) -> str:
        return f"DeferredBody({self.name!r})"
