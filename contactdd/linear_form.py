"""A load of the user's own: any linear form in UFL."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import ufl

from .field import refuse_other_mesh
from .load import FormLoad, LoadedBody
from .parameter import Followed


@dataclass(frozen=True, eq=False)
class LinearForm(FormLoad):
    """A load of your own, the part l(v) of the virtual work that it does.

    A UFL form may have its test function from any space of vectors on the body's mesh: the body's own takes its place.
    dolfinx' Constants and Functions in it are read anew at every solve. In a body of revolution the form is taken as it
    is: weight it by 2πr yourself, or use the integrals of `body.elements`, which do.

    Args:
        form: A UFL form of one test function on the body's mesh, or a function (body, v) -> form of the `Body` and a
            test function of its elements, which is asked again on finer meshes.
        follows: The parameters that such a function reads, so that a solve asks it again when one has changed.

    Raises:
        TypeError, ValueError: It is no linear form of vectors.

    Example:
        >>> import contactdd as cd
        >>> mesh, steel = cd.rectangle((0, 0), (2, 1), (4, 2)), cd.Isotropic(E=2e5, nu=0.3)
        >>> weight = cd.LinearForm(lambda body, v: body.elements.over_volume(-7.7e-5 * v[1]))
        >>> cd.Body("block", mesh, steel, loads=[weight]).dofs
        30
    """

    form: Any
    follows: Sequence[Followed] = ()

    def __post_init__(self) -> None:
        if isinstance(self.form, ufl.Form):
            _argument(self.form)
        elif not callable(self.form):
            raise TypeError(f"form = {self.form!r}: expected a UFL form or a function (body, v) -> form")
        if not all(isinstance(each, Followed) for each in self.follows):
            raise TypeError(f"follows = {self.follows!r}: expected parameters")

    def check_on(self, body: LoadedBody) -> None:
        """Refuse a form that belongs to another mesh, or has vectors of another dimension.

        Args:
            body: The body.
        """
        self.form_on(body, ufl.TestFunction(body.space))

    def form_on(self, body: LoadedBody, v: Any) -> Any:
        """The UFL form with the body's own test function.

        Args:
            body: The body.
            v: A test function of its elements.
        """
        form = self.form if isinstance(self.form, ufl.Form) else self.form(body, v)
        if not isinstance(form, ufl.Form):
            raise TypeError(f"form of body {body.name!r}: the function returned {form!r}; expected a UFL form")
        argument = _argument(form)
        if argument.ufl_shape != (body.elements.mesh.dim,):
            raise ValueError(
                f"form of body {body.name!r}: its test function has the shape {argument.ufl_shape}; expected "
                f"{(body.elements.mesh.dim,)}"
            )
        _refuse_unknown_parts(body.name, form)
        refuse_other_mesh(f"form of body {body.name!r}", form, body.elements.mesh.domain)
        return form if argument == v else ufl.replace(form, {argument: v})

    def followed(self, body: LoadedBody) -> Iterable[Any]:
        """The form, of which dolfinx' Constants and Functions may change, and the parameters.

        Args:
            body: The body.
        """
        return [self.form_on(body, ufl.TestFunction(body.space)), *self.follows]


def _refuse_unknown_parts(name: str, form: Any) -> None:
    """Refuse integrals over a numbered part of a mesh that nothing numbers: dolfinx takes them for zero."""
    for integral in form.integrals():
        if integral.subdomain_id() != "everywhere" and integral.subdomain_data() is None:
            raise ValueError(
                f"form of body {name!r}: an integral over the part {integral.subdomain_id()} of a mesh without parts; "
                "expected a measure with subdomain_data, such as ufl.Measure('ds', domain, subdomain_data=facet_tags)"
            )


def _argument(form: Any) -> Any:
    """The test function of a linear form."""
    arguments = form.arguments()
    if len(arguments) != 1 or arguments[0].number() != 0:
        raise ValueError(f"form: it has {len(arguments)} arguments; expected one, a test function")
    return arguments[0]
