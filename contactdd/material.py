"""Linear elastic materials: the stiffness of Hooke's law (2) in Voigt's notation, checked for (4).

Every constant of a material is a number, a function of the coordinates x (3, points), or a UFL expression such as a
dolfinx Function, one value per cell or per node. Voigt's notation stays inside this file and `kinematics`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import ArrayLike, NDArray

from .base.arrays import Floats
from .base.checks import as_floats, finite
from .field import evaluate
from .parameter import refuse_parameter

#: A material constant: a number, a function of the coordinates x (3, points), or a UFL expression.
Number = float | Callable[[Floats], Any]


#: The degree of the polynomials that stand in every cell for a UFL expression that is no dolfinx Function.
EXPRESSION_DEGREE = 3


#: Points (3, 4) at which a material that does not vary has one stiffness.
ANYWHERE = np.array([[0.0, 1.0, -2.3, 17.0], [0.0, -1.7, 0.4, 31.0], [0.0, 0.6, 5.0, -23.0]])


#: Voigt's order of the tensor components; shear strains count twice (engineering strains).
VOIGT = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))


#: The position of the component (i, j) in that order.
PLACE = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])


class Material(ABC):
    """A linear elastic material, its stiffness a symmetric positive definite tensor C_ijkl(x), eqs. (2), (4).

    A subclass gives `_stiffness(x)`, C at points x (3, points) in Voigt's notation, (points, 6, 6), and keeps its
    constants as attributes: numbers, functions of the coordinates x, or UFL expressions, which are functions of x by
    the time that `_stiffness` sees them. One that varies in another way says so by its property `varies`.

    Attributes:
        checked: Whether `_stiffness` itself refuses what is not symmetric positive definite.

    Example:
        >>> class Foam(Material):
        ...     def __init__(self, density):
        ...         self.density = density
        ...     def _stiffness(self, x):
        ...         E = 100.0 * self.density**2
        ...         return np.tile(Isotropic(E, 0.1).stiffness(), (x.shape[1], 1, 1))
        >>> Foam(0.5).stiffness().shape
        (6, 6)
    """

    checked: ClassVar[bool] = False

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            refuse_parameter(name, value)
        if not self.varies:
            self.stiffness()

    @property
    def varies(self) -> bool:
        """Whether the material is given by functions of the place."""
        return any(callable(value) for value in vars(self).values())

    def stiffness(self, x: Floats | None = None) -> Floats:
        """The stiffness C in Voigt's notation (stress): stresses = C @ engineering strains, in the order of `VOIGT`.

        Args:
            x: Points (3, points), which a material that varies needs.

        Returns:
            Shape (6, 6), or (points, 6, 6) at points.

        Raises:
            ValueError: The constants are none that an elastic material has (4), or values of a mesh (see `within`).
        """
        if x is None:
            if self.varies:
                raise ValueError(f"x = None: {self!r} varies in space; expected points (3, n)")
            return self.stiffness(np.zeros((3, 1)))[0] if self.checked else self._uniform()
        for name, value in self._expressions.items():
            raise ValueError(f"{name} = {value!r}: its values depend on the cell; expected material.within(cells)")
        return self._stiffness(x) if self.checked else _definite(self._stiffness(x), x)

    def _uniform(self) -> Floats:
        """C of a subclass that says it does not vary, refused where it does."""
        values = self.stiffness(ANYWHERE)
        if np.ptp(values, axis=0).max() > 0.0:
            raise ValueError(
                f"{self!r}: its stiffness varies in space, and it has no attribute that is a function; expected a "
                "property `varies` that says so"
            )
        return np.asarray(values[0])

    def within(self, cells: NDArray[np.int32]) -> Material:
        """The same material at points of which the mesh's cells are known, its UFL expressions functions of x.

        Args:
            cells: The index of the cell that each point lies in, (points,).
        """
        found: dict[str, Any] = {name: sampled(value, cells) for name, value in self._expressions.items()}
        found |= {name: value.within(cells) for name, value in vars(self).items() if isinstance(value, Material)}
        if not found:
            return self
        other = copy(self)
        vars(other).update(found)
        return other

    def given(self) -> list[Any]:
        """The values that the material was given, those of a material inside it too."""
        inner = [each for value in vars(self).values() if isinstance(value, Material) for each in value.given()]
        return [*vars(self).values(), *inner]

    @property
    def _expressions(self) -> dict[str, Any]:
        """The constants that are UFL expressions, by name."""
        return {name: value for name, value in vars(self).items() if isinstance(value, ufl.core.expr.Expr)}

    def tensor(self, x: Floats | None = None) -> Floats:
        """The stiffness tensor C_ijkl (stress), shape (3, 3, 3, 3), or (points, 3, 3, 3, 3) at points.

        Args:
            x: Points (3, points), which a material that varies needs.
        """
        return self.stiffness(x)[..., PLACE[:, :, None, None], PLACE[None, None]]

    def rotated(self, rotation: ArrayLike | Callable[[Floats], Any]) -> Rotated:
        """The same material with its axes turned.

        Args:
            rotation: An angle about z (radians, counter-clockwise in the plane) or an orthogonal (3, 3) matrix whose
                columns are the new directions of the material axes; or a function of x (3, points) that gives
                (points,) angles or (3, 3, points) matrices.
        """
        return Rotated(self, rotation)

    @abstractmethod
    def _stiffness(self, x: Floats) -> Floats:
        """C at points x (3, points), shape (points, 6, 6)."""


def sampled(expression: Any, cells: NDArray[np.int32]) -> Callable[[Floats], Floats]:
    """The function of points x (3, points) in given cells (points,) that a UFL expression is."""

    def values(x: Floats) -> Floats:
        shape = expression.ufl_shape
        if not ufl.domain.extract_domains(expression):  # made of numbers alone, or what UFL found to be one
            numbers = [float(expression((), component=place)) for place in np.ndindex(*shape)]
            return np.broadcast_to(np.reshape(numbers, (*shape, 1)), (*shape, x.shape[1]))
        function = expression if isinstance(expression, fem.Function) else _interpolated(expression)
        found = function.eval(x.T, cells)
        return np.moveaxis(found.reshape(x.shape[1], *shape), 0, -1)

    return values


def _interpolated(expression: Any) -> fem.Function:
    """The function of the cells' polynomials that is closest to a UFL expression."""
    from .base import compat

    (domain,) = map(compat.mesh_of, ufl.domain.extract_domains(expression))
    element = ("Discontinuous Lagrange", EXPRESSION_DEGREE, expression.ufl_shape)
    space = fem.functionspace(domain, element)
    function = fem.Function(space)
    function.interpolate(fem.Expression(expression, compat.expression_points(space.element)))
    return function


def _definite(values: Floats, x: Floats) -> Floats:
    """C at points x, refused unless it is symmetric and positive definite."""
    if np.shape(values) != (x.shape[1], 6, 6):
        raise ValueError(f"_stiffness: an array of shape {np.shape(values)}; expected {(x.shape[1], 6, 6)}")
    if not np.all(np.isfinite(values)):
        raise ValueError("_stiffness: expected finite numbers")
    transposed = np.swapaxes(values, 1, 2)
    _require_symmetry(values, transposed, "C = Cᵀ, that is C_ijkl = C_klij")
    values = 0.5 * (values + transposed)
    eigenvalues = np.linalg.eigvalsh(values)
    worst = int(np.argmin(eigenvalues[:, 0] / np.abs(eigenvalues).max(axis=1)))
    smallest, largest = eigenvalues[worst, 0], np.abs(eigenvalues[worst]).max()
    # A ratio within the rounding of the eigenvalues (6 × 6) is no proof of a positive one.
    if not smallest > 1e-14 * largest:
        where = f" at x = {x[:, worst]}" if x.shape[1] > 1 else ""
        raise ValueError(f"C{where}: its smallest eigenvalue is {smallest:.6g}; expected C positive definite")
    return values


@dataclass(frozen=True)
class Isotropic(Material):
    """An isotropic material.

    Args:
        E: Young's modulus > 0 (stress), a number, a function of the coordinates x (3, points), or a UFL expression on
            the body's mesh, such as a dolfinx Function with a value in every cell.
        nu: Poisson's ratio, −1 < nu < 0.5, likewise.

    Raises:
        TypeError, ValueError: A constant is out of range, with its place where it is a function.

    Example:
        >>> Isotropic(E=2.1e5, nu=0.3).stiffness().shape
        (6, 6)
    """

    checked = True

    E: Number
    nu: Number

    def _stiffness(self, x: Floats) -> Floats:
        E, nu = _positive("E", self.E, x), _constant("nu", self.nu, x)
        _require((nu > -1.0) & (nu < 0.5), "nu", self.nu, nu, "-1 < nu < 0.5", x)
        lam, mu = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
        matrix = mu[:, None, None] * np.diag([2.0, 2.0, 2.0, 1.0, 1.0, 1.0])
        matrix[:, :3, :3] += lam[:, None, None]
        return matrix


@dataclass(frozen=True)
class Orthotropic(Material):
    """An orthotropic material with its axes 1, 2, 3 along x, y, z (turn it with `rotated`).

    An elastic material has nu_ij² < E_i / E_j and 1 − ν12ν21 − ν23ν32 − ν13ν31 − 2 ν21ν32ν13 > 0. Every constant is a
    number or a function of the coordinates x (3, points).

    Args:
        E1, E2, E3: Young's moduli (stress).
        nu12, nu13, nu23: Poisson's ratios: nu_ij is the contraction along j per unit of extension along i, so that
            nu_ij / E_i = nu_ji / E_j.
        G12, G13, G23: Shear moduli (stress).

    Raises:
        TypeError, ValueError: The constants are none of an elastic material.

    Example:
        >>> wood = Orthotropic(11e3, 900.0, 500.0, 0.4, 0.4, 0.5, 700.0, 700.0, 60.0)
        >>> bool(wood.rotated(np.pi / 2).stiffness()[1, 1] > 11e3)  # along the fibres
        True
    """

    checked = True

    E1: Number
    E2: Number
    E3: Number
    nu12: Number
    nu13: Number
    nu23: Number
    G12: Number
    G13: Number
    G23: Number

    def _stiffness(self, x: Floats) -> Floats:
        E = [_positive(name, getattr(self, name), x) for name in ("E1", "E2", "E3")]
        compliance = np.zeros((x.shape[1], 6, 6))
        for i in range(3):
            compliance[:, i, i] = 1.0 / E[i]
        for i, j in ((0, 1), (0, 2), (1, 2)):
            name = f"nu{i + 1}{j + 1}"
            nu = _constant(name, getattr(self, name), x)
            expected = f"{name}² < E{i + 1}/E{j + 1}"
            _require(nu**2 < E[i] / E[j], name, getattr(self, name), nu, expected, x)
            compliance[:, i, j] = compliance[:, j, i] = -nu / E[i]
        for i, name in ((3, "G23"), (4, "G13"), (5, "G12")):
            compliance[:, i, i] = 1.0 / _positive(name, getattr(self, name), x)
        determinant = np.linalg.det(compliance[:, :3, :3]) * E[0] * E[1] * E[2]
        if not np.all(determinant > 1e-14):  # it is a sum of numbers of the order one
            worst = int(np.argmin(determinant))
            where = f" at x = {x[:, worst]}" if self.varies else ""
            raise ValueError(
                f"nu12, nu13, nu23{where}: 1 − ν12ν21 − ν23ν32 − ν13ν31 − 2 ν21ν32ν13 = {determinant[worst]:.6g}; "
                "expected a number > 0"
            )
        stiffness = np.linalg.inv(compliance)
        return 0.5 * (stiffness + np.swapaxes(stiffness, 1, 2))


@dataclass(frozen=True, eq=False)
class Anisotropic(Material):
    """A material with any symmetric positive definite stiffness.

    Args:
        C: A 6 × 6 matrix (stress) between stresses and engineering strains in the order xx, yy, zz, yz, xz, xy, or the
            tensor C_ijkl, shape (3, 3, 3, 3); or a function of x (3, points) with such values, the points last.

    Raises:
        TypeError, ValueError: C is not symmetric or not positive definite.

    Example:
        >>> bool(np.all(Anisotropic(Isotropic(2e5, 0.3).tensor()).stiffness() == Isotropic(2e5, 0.3).stiffness()))
        True
    """

    checked = True

    C: ArrayLike | Callable[[Floats], Any]

    def _stiffness(self, x: Floats) -> Floats:
        shape = (6, 6) if np.ndim(value := self._given(x)) in (2, 3) else (3, 3, 3, 3)
        values = np.moveaxis(evaluate("C", value, x, shape), -1, 0)
        if values.ndim == 5:
            for axes in ((0, 2, 1, 3, 4), (0, 1, 2, 4, 3)):
                _require_symmetry(values, values.transpose(axes), "C_ijkl = C_jikl = C_ijlk")
            i, j = np.array(VOIGT).T
            values = values[:, i[:, None], j[:, None], i, j]
        return _definite(values, x)

    def _given(self, x: Floats) -> Floats:
        return as_floats("C", self.C(x) if callable(self.C) else self.C, "a matrix (6, 6)")


@dataclass(frozen=True, eq=False)
class Rotated(Material):
    """A material whose axes are turned; made by `Material.rotated`."""

    checked = True

    material: Material
    rotation: ArrayLike | Callable[[Floats], Any]

    @property
    def varies(self) -> bool:
        return self.material.varies or callable(self.rotation)

    def _stiffness(self, x: Floats) -> Floats:
        bond = _bond(_rotation(self.rotation, x))
        return bond @ self.material.stiffness(x) @ np.swapaxes(bond, 1, 2)


def _rotation(rotation: ArrayLike | Callable[[Floats], Any], x: Floats) -> Floats:
    """The matrices of the material axes at points, (points, 3, 3)."""
    given = rotation(x) if callable(rotation) else rotation
    value = as_floats("rotation", given, "an angle or an orthogonal matrix (3, 3)")
    if value.ndim < 2:
        angle = evaluate("rotation", value, x)
        matrix: Floats = np.zeros((len(angle), 3, 3))
        matrix[:, 0, 0] = matrix[:, 1, 1] = np.cos(angle)
        matrix[:, 1, 0], matrix[:, 0, 1] = np.sin(angle), -np.sin(angle)
        matrix[:, 2, 2] = 1.0
        return matrix
    matrix = np.moveaxis(evaluate("rotation", value, x, (3, 3)), -1, 0)
    if np.abs(matrix @ np.swapaxes(matrix, 1, 2) - np.eye(3)).max() > 1e-10:  # user's own arithmetic, not typed digits
        raise ValueError(f"rotation = {rotation!r}: expected an angle or an orthogonal matrix (3, 3)")
    return matrix


def _bond(rotation: Floats) -> Floats:
    """Bond's matrices M of rotations R (points, 3, 3): stresses turn as M σ, so that C turns as M C Mᵀ."""
    matrix = np.empty((len(rotation), 6, 6))
    for row, (i, j) in enumerate(VOIGT):
        for column, (a, b) in enumerate(VOIGT):
            matrix[:, row, column] = rotation[:, i, a] * rotation[:, j, b]
            if a != b:
                matrix[:, row, column] += rotation[:, i, b] * rotation[:, j, a]
    return matrix


def _constant(name: str, value: Number, x: Floats) -> Floats:
    """A material constant at the points x (3, points)."""
    return evaluate(name, value, x) if callable(value) else np.full(x.shape[1], finite(name, value))


def _positive(name: str, value: Number, x: Floats) -> Floats:
    values = _constant(name, value, x)
    _require(values > 0.0, name, value, values, "a number > 0", x)
    return values


def _require(ok: NDArray[np.bool_], name: str, given: Any, values: Floats, expected: str, x: Floats) -> None:
    """Refuse the first value that is not `ok`; say where it is if it was given as a function."""
    if not np.all(ok):
        worst = int(np.argmin(ok))
        where = f" at x = {x[:, worst]}" if callable(given) else ""
        raise ValueError(f"{name} = {values[worst]:g}{where}: expected {expected}")


def _require_symmetry(values: Floats, transposed: Floats, expected: str) -> None:
    difference = np.abs(values - transposed)
    # Tables give a few digits, and the same ones on both sides; more than this is another material.
    if difference.max() > 1e-8 * np.abs(values).max():
        place = np.unravel_index(np.argmax(difference), difference.shape)
        name = "C_" + "".join(str(index + 1) for index in place[1:])
        raise ValueError(f"{name} = {values[place]:g}, its partner {transposed[place]:g}: expected {expected}")
