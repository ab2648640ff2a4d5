"""Rigid bodies: a shape that is held, moved or free under a force and a moment."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..base.arrays import Floats
from ..base.checks import as_floats
from ..meshless import MeshlessBody
from ..parameter import Parameter, current
from ..shapes.shape import Shape, as_point

#: Numbers of a motion or a load: one each, None where a motion is free, or a parameter that holds all of them.
Components = float | Parameter | Sequence[float | Parameter | None] | None

#: A ray that meets nothing is told that there is something this many times as far as the contact's points reach.
FAR = 10.0


class RigidBody(MeshlessBody):
    """A rigid body of a given shape, without a mesh.

    Each component of its motion is prescribed (0 by default: it is held) or free under a load. Motions are small, as
    all displacements are: they change each gap by their part along the normal there, and a shape that slides along by
    more than the contact's points are apart needs another shape at another place.

    Its degrees of freedom, which `Solution.displacement` gives, are the translations (length) and the rotations
    (radians); of a body of revolution the translation along the axis.

    Args:
        name: Unique in a scene.
        shape: Where its surface is.
        displacement: Of the point `about` (length): one entry per coordinate, None where it is free; or 0 or None for
            all of them. An entry may be a `Parameter`, or one `Parameter` hold all.
        rotation: Likewise (radians): a number in the plane, counted from x to y, (3,) about the axes in space.
        force: On the point `about`, one entry per coordinate, or 0 (force; per unit of thickness in the plane, that of
            the full ring).
        moment: Likewise (force · length): a number in the plane, (3,) in space.
        about: (dim,) by default the shape's centre (length).
        kinematics: As of `Body`; by default "plane strain" or "solid". A body of revolution needs "axisymmetric".

    Raises:
        TypeError, ValueError: An argument is none of these.

    Example:
        >>> from contactdd.shapes import Sphere
        >>> RigidBody("ball", Sphere((0, 5), 5), displacement=(0, None), force=(0, -10), kinematics="axisymmetric")
        RigidBody('ball', Sphere([0.0, 5.0], 5), axisymmetric)
    """

    def __init__(
        self,
        name: str,
        shape: Shape,
        *,
        displacement: Components = 0.0,
        rotation: Components = 0.0,
        force: Components = 0.0,
        moment: Components = 0.0,
        about: Any = None,
        kinematics: str | None = None,
    ) -> None:
        if not isinstance(shape, Shape):
            raise TypeError(f"shape = {shape!r}: expected a shape, such as cd.Sphere(centre, radius)")
        super().__init__(name, kinematics or ("plane strain" if shape.dim == 2 else "solid"))
        if self.kinematics.dim != shape.dim:
            raise ValueError(f"kinematics = {kinematics!r}: the shape has {shape.dim} coordinates")
        self.shape = shape
        self.about = shape.centre if about is None else as_point("about", about)
        if self.about.shape != (shape.dim,):
            raise ValueError(f"about = {about!r}: expected {shape.dim} numbers")
        self._turns = 0 if self.kinematics.axisymmetric else 1 if shape.dim == 2 else 3
        self._displacement, self._force = displacement, force
        self._rotation, self._moment = rotation, moment
        self.prescribed(), self.load()  # refuse now what can be none

    def __repr__(self) -> str:
        return f"RigidBody({self.name!r}, {self.shape!r}, {self.kinematics.name})"

    def gap(self, x: Floats, direction: Floats) -> Floats:
        found = self.shape.distance(x, direction)
        finite = found[np.isfinite(found)]
        if len(finite) == 0:
            raise ValueError(
                f"body {self.name!r}: from none of the contact's {len(x)} points does a ray along the normal enter "
                f"{self.shape!r}; expected a shape that lies opposite them, its own normals towards them"
            )
        far = FAR * max(np.abs(finite).max(initial=0.0), float(np.linalg.norm(x - self.about, axis=1).max()))
        return np.where(np.isfinite(found), found, far)

    def normal_displacement(self, x: Floats, direction: Floats) -> Floats:
        if self.kinematics.axisymmetric:
            return -direction[:, 1:]
        arm = x - self.about
        if self.kinematics.dim == 3:
            return -np.column_stack([direction, np.cross(arm, direction)])
        return -np.column_stack([direction, arm[:, 0] * direction[:, 1] - arm[:, 1] * direction[:, 0]])

    def displacement_along(self, x: Floats, axis: Floats) -> Floats:
        return -self.normal_displacement(x, np.broadcast_to(axis, x.shape))

    def prescribed(self) -> Floats:
        moved = _numbers("displacement", self._displacement, self.kinematics.dim, free=True)
        return np.concatenate([self._along("displacement", moved), self._turned("rotation", self._rotation, free=True)])

    def load(self) -> Floats:
        force = _numbers("force", self._force, self.kinematics.dim)
        return np.concatenate([self._along("force", force), self._turned("moment", self._moment)])

    def _along(self, name: str, values: Floats) -> Floats:
        """The components that the kinematics allows; the others have to be zero."""
        if not self.kinematics.axisymmetric:
            return values
        if values[0] != 0.0 and not (np.isnan(values[0]) and np.isnan(values[1])):
            raise ValueError(f"{name} = {values.tolist()}: a ring moves along its axis only; expected (0, ...)")
        return values[1:]

    def _turned(self, name: str, value: Components, free: bool = False) -> Floats:
        if self._turns == 0:
            if isinstance(value, Parameter) or not (value is None or np.all(np.asarray(value) == 0.0)):
                raise ValueError(f"{name} = {value!r}: a body of revolution does not turn; expected 0")
            return np.zeros(0)
        return _numbers(name, value, self._turns, free)


def _numbers(name: str, value: Components, count: int, free: bool = False) -> Floats:
    """`value` as (count,) numbers for now; NaN for None, which only a motion that may be `free` can be."""
    expected = f"{count} finite numbers" if count > 1 else "a finite number"
    expected += " (None where free)" if free else ""
    given = current(value)
    entries = list(given) if isinstance(given, Sequence | np.ndarray) and not isinstance(given, str) else [given]
    if len(entries) == 1 and count > 1 and (entries[0] is None or np.all(entries[0] == 0.0)):
        entries = entries * count
    if len(entries) != count:
        raise ValueError(f"{name} = {value!r}: expected {expected}")
    numbers = [np.nan if entry is None and free else _number(name, value, entry, expected) for entry in entries]
    return np.array(numbers)


def _number(name: str, value: Any, entry: Any, expected: str) -> float:
    number = as_floats(name, np.nan if entry is None else current(entry), expected)
    if number.ndim or not np.isfinite(number):
        raise ValueError(f"{name} = {value!r}: expected {expected}")
    return float(number)
