"""The agreement of the ranks on a scene, compared before a solve: else each would find another wrong answer.

Texts are compared as they are, numbers to rounding, which other processors may do otherwise.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import ufl
from dolfinx import fem

from ..base.facets import surface_points
from ..body import Body
from ..hard_contact import HardContact
from ..layer import Layer
from ..load import BodyLoad
from ..local.forms import one_load
from ..meshless import MeshlessBody
from ..parameter import current
from ..scene import Scene

#: Sums over arrays may differ by this part of the sum of magnitudes: rounding of their entries.
SAME = 1e-12


#: A label and its key: a text, or (Σ cᵢ xᵢ, Σ |xᵢ|) of numbers x; None agrees with everything.
Told = tuple[str, str | tuple[float, float] | None]


def refuse_differences(scene: Scene, settings: Mapping[str, Any]) -> None:
    """Refuse, on all ranks, a scene or settings of a solve that are others on some of them."""
    ranks = scene.ranks
    if ranks.alone:
        return
    here = list(_told(scene, settings))
    first = ranks.agree(here)
    for rank, difference in enumerate(ranks.gather(_difference(first, here))):
        if difference:
            raise ValueError(f"{difference} on rank {rank}; expected the same scene and solves on all ranks")


def _difference(first: list[Told], here: list[Told]) -> str:
    """The first difference, in words, or nothing."""
    for (label, one), (other_label, other) in zip(first, here, strict=False):
        if label != other_label:
            return f"{other_label} instead of {label} of the first rank"
        if not _agree(one, other):
            shown = f"{other} (first rank: {one})" if isinstance(one, str) else "differs from that of the first rank"
            return f"{label}: {shown}"
    return "" if len(first) == len(here) else f"{len(here)} items of the scene instead of {len(first)}"


def _agree(one: Any, other: Any) -> bool:
    if one is None or other is None or isinstance(one, str) or isinstance(other, str):
        return one is None or other is None or one == other
    return np.allclose(one, other, rtol=0.0, atol=SAME * max(one[1], other[1]), equal_nan=True)


def _told(scene: Scene, settings: Mapping[str, Any]) -> Iterator[Told]:
    for name, value in settings.items():
        yield name, _plain(value)
    for index, body in enumerate(scene.bodies):
        for label, told in () if index in scene.known_dofs else _of_body(body):
            yield f"body {body.name!r}, {label}", told
    for contact, interface in zip(scene.contacts, scene.interfaces, strict=True):
        yield f"contact {contact.name!r}, points", _measure(np.hstack([interface.x, interface.weights[:, None]]))
        yield f"contact {contact.name!r}, gap", _measure(interface.gap)
        yield f"contact {contact.name!r}, layer", _text(contact.layer)
        yield f"contact {contact.name!r}, law of the layer", _of_layer(interface.layer, contact.reach)


def _of_body(body: Body | MeshlessBody) -> Iterator[Told]:
    if isinstance(body, MeshlessBody):
        yield "kind", type(body).__name__
        for name, value in vars(body).items():
            yield name, _plain(current(value))
        return
    domain = body.mesh.domain
    yield "elements", f"{body.mesh.cells} {domain.topology.cell_name()}s, degree {body.degree}, {body.kinematics.name}"
    yield "coordinates", _measure(domain.geometry.x)
    for name, facets in body.mesh.surfaces.items():
        yield f"surface {name!r}", _measure(facets)
    varies, cells = body.material.varies, np.arange(body.mesh.cells, dtype=np.int32)
    yield "material", _measure(body.stiffness_at(body.mesh.middles.T, cells) if varies else body.material.stiffness())
    for number, item in enumerate((*body.supports, *body.loads)):
        kind = f"{type(item).__name__} {number}"
        if isinstance(item, BodyLoad):
            yield kind, _measure(one_load(body, item))
            continue
        for name, value in vars(item).items():
            for part, told in enumerate(_of_value(body, item, value)):
                yield f"{kind}, {name} {part}", told


def _of_value(body: Body, item: Any, value: Any) -> list[str | tuple[float, float] | None]:
    """The key of a value of a support or load, or of its entries where it is a list."""
    value = current(value)
    if isinstance(value, ufl.core.expr.Expr):
        return [_measure(array) for array in _arrays(value)] + [type(value).__name__]
    if callable(value):
        return [_measure(np.asarray(value(_points(body, item)), dtype=float))]
    if isinstance(value, list | tuple):
        return [told for part in value for told in _of_value(body, item, part)]
    return [_plain(value)]


def _points(body: Body, item: Any) -> Any:
    """The points (3, points) at which fields of a support or load are sampled: its facets' middles, or all nodes."""
    domain, surface = body.mesh.domain, getattr(item, "surface", None)
    if surface is None:
        return domain.geometry.x.T
    middle = np.full((1, body.mesh.dim - 1), 0.5 if body.mesh.dim == 2 else 1 / 3)
    x = surface_points(domain, body.mesh.entities(surface), middle).x
    return np.vstack([x.T, np.zeros((3 - x.shape[1], len(x)))])


def _arrays(expression: Any) -> list[Any]:
    """The values in a UFL expression that may change."""
    coefficients = ufl.algorithms.extract_coefficients(expression)
    constants = ufl.algorithms.analysis.extract_constants(expression)
    return [c.x.array for c in coefficients if isinstance(c, fem.Function)] + [c.value for c in constants]


def _of_layer(layer: Layer | HardContact, reach: float) -> tuple[float, float] | None:
    """The stresses of a law, to be compared where its text does not give it: within what it is made for."""
    if isinstance(layer, HardContact):
        return None
    if hasattr(layer, "compression_range"):
        return _measure(layer.contact_stress(-layer.compression_range * np.logspace(-6, 0, 7)))
    try:
        with np.errstate(all="ignore"):
            return _measure(layer.contact_stress(-reach * np.logspace(-9, -4, 6)[:, None]))
    except Exception:  # beyond what a law is defined for; it is not asked for its range
        return None


def _plain(value: Any) -> str | tuple[float, float]:
    if isinstance(value, bool | str) or value is None:
        return repr(value)
    try:
        return _measure(np.asarray(value, dtype=float))
    except (TypeError, ValueError):
        return _text(value)


def _text(value: Any) -> str:
    """A text without addresses in memory."""
    plain = type(value).__repr__ is object.__repr__ or callable(value)
    return type(value).__name__ if plain else repr(value)


def _measure(array: Any) -> tuple[float, float]:
    """Σ cᵢ xᵢ with unlike cᵢ in (−1, 1), and Σ |xᵢ|."""
    x = np.ravel(np.asarray(array, dtype=float))
    return float(np.cos(1.0 + np.arange(len(x))) @ x), float(np.abs(x).sum())
