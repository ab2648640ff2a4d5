"""A layer whose parameters vary along the surface."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats
from ..base.checks import as_floats
from ..layer import Layer


class VaryingLayer(Layer):
    """A law with parameters that are functions of the coordinates, such as a coating of uneven thickness.

    A scene evaluates them once, at the points of the contact on the first surface. Elsewhere the law has no place to
    be evaluated at; `layer.at(x)` has one, its values belong to the points x (dim, n) in their order.

    Args:
        law: The law, `cd.PowerLayer` for example, or a function that makes one of its parameters; they are given to it
            as arrays (n,), so it has to be one whose formula works point by point: not `TableLayer`, `CustomLayer`.
        parameters: By name, each a number or a function of the coordinates x (dim, n) that gives (n,).

    Raises:
        TypeError: `law` is no function. `at` raises ValueError where a parameter is not n numbers that the law accepts.

    Example:
        >>> from contactdd.layers.logarithmic import LogarithmicLayer
        >>> layer = VaryingLayer(LogarithmicLayer, modulus=1e3, thickness=lambda x: 1e-3 * (1 + x[0]))
        >>> layer.at(np.array([[0.0, 1.0], [0.0, 0.0]])).contact_stress([-5e-4, -1e-3]).round(3)
        array([-693.147, -693.147])
    """

    def __init__(self, law: Callable[..., Layer], **parameters: float | Callable[[Floats], Floats]) -> None:
        if not callable(law):
            raise TypeError(f"law = {law!r}: expected a layer's class, such as cd.PowerLayer, or a function making one")
        self.law, self.parameters = law, parameters

    def __repr__(self) -> str:
        shown = {name: "f(x)" if callable(value) else repr(value) for name, value in self.parameters.items()}
        values = "".join(f", {name}={value}" for name, value in shown.items())
        return f"VaryingLayer({getattr(self.law, '__name__', type(self.law).__name__)}{values})"

    def at(self, x: Floats) -> Layer:
        x = np.asarray(x, dtype=float)
        values = {name: _values(name, value, x) for name, value in self.parameters.items()}
        bound = LayerAtPoints(self, values, x.shape[1])
        bound.check(x)
        return bound

    def _nowhere(self) -> NoReturn:
        raise TypeError(f"{self!r} varies from place to place: expected layer.at(x), the law at points x (dim, n)")

    def _pressure(self, c: Floats) -> Floats:
        self._nowhere()

    def _slope(self, c: Floats) -> Floats:
        self._nowhere()

    def _secant(self, deep: Floats, shallow: Floats) -> Floats:
        self._nowhere()

    def _energy(self, c: Floats) -> Floats:
        self._nowhere()

    def _depth(self, p: Floats) -> Floats:
        self._nowhere()

    @property
    def clearance(self) -> float | Floats:
        self._nowhere()

    @property
    def compression_limit(self) -> float | Floats:
        self._nowhere()


class LayerAtPoints(Layer):
    """A law with its own parameters at each of n points."""

    def __init__(self, origin: VaryingLayer, values: dict[str, float | Floats], count: int) -> None:
        self.origin, self.values, self.count = origin, values, count
        self.law = origin.law(**values)
        if self.law.remembers:
            raise ValueError(f"{origin!r}: its law remembers its closure; expected a law without memory")
        if self.law.bonded:
            raise ValueError(f"{origin!r}: its law carries tension; expected BondedLayer(VaryingLayer(...))")

    def __repr__(self) -> str:
        return repr(self.origin)

    def at(self, x: Floats) -> Layer:
        return self.origin.at(x)

    @property
    def clearance(self) -> float | Floats:
        return self.law.clearance

    @property
    def compression_limit(self) -> float | Floats:
        return self.law.compression_limit

    def _among(self, chosen: NDArray[np.bool_]) -> Layer:
        return self.origin.law(**{name: _pick(value, chosen) for name, value in self.values.items()})

    def _pressure(self, c: Floats) -> Floats:
        return self.law._pressure(c)

    def _slope(self, c: Floats) -> Floats:
        return self.law._slope(c)

    def _secant(self, deep: Floats, shallow: Floats) -> Floats:
        return self.law._secant(deep, shallow)

    def _energy(self, c: Floats) -> Floats:
        return self.law._energy(c)

    def _depth(self, p: Floats) -> Floats:
        return self.law._depth(p)

    def check(self, x: Floats) -> None:
        """Refuse a law that doesn't work point by point: at the first and last point it is made on its own."""
        depths = self.law._depth(np.full(self.count, 1.0))
        for point in (0, -1) if self.count else ():
            alone = self.origin.law(**{name: float(_pick(v, point)) for name, v in self.values.items()})
            expected = float(alone._depth(np.array(1.0)))
            if depths.shape != (self.count,) or not np.isclose(depths[point], expected, rtol=1e-9, atol=0.0):
                raise ValueError(
                    f"{self!r}: its law doesn't work point by point at x = {x[:, point]}; expected one like PowerLayer"
                )


def _values(name: str, value: float | Callable[[Floats], Floats], x: Floats) -> float | Floats:
    """A parameter at the points x, (n,), or the number that it is everywhere."""
    if not callable(value):
        return value
    values = as_floats(name, value(x), f"a number at each of {x.shape[1]} points")
    if values.shape not in ((), (x.shape[1],)):
        raise ValueError(f"{name}: shape {values.shape} at {x.shape[1]} points; expected ({x.shape[1]},)")
    if not np.all(np.isfinite(values)):
        worst = int(np.argmin(np.isfinite(np.broadcast_to(values, x.shape[1]))))
        raise ValueError(f"{name}: not finite at x = {x[:, worst]}")
    return np.array(np.broadcast_to(values, x.shape[1]))


def _pick(value: float | Floats, chosen: Any) -> float | Floats:
    return value[chosen] if isinstance(value, np.ndarray) and value.ndim else value
