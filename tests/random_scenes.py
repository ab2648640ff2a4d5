"""Random scenes of every kind, each checked without the code that solved it.

    ./run python3 tests/random_scenes.py --count 2000
    ./run python3 tests/random_scenes.py --seed 17

A seed names a scene, the method and the local solvers. What converges is checked by `monolithic`, and solved once more
in another way; what does not converge has to be of a method that may fail, or of a scene without equilibrium.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
import warnings
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, fields
from typing import Any

import numpy as np
import scipy
from monolithic import Findings, Law, Monolithic
from numpy.typing import NDArray
from weak_form import WeakForm, isotropic, orthotropic, rotated

import contactdd as cd

Floats = NDArray[np.float64]
Random = np.random.Generator

#: Methods that have to arrive wherever there is an equilibrium, and those that may not.
SURE = ("auto", "newton-krylov", "newton", "newton-chord", "newton-kurchatov")
UNSURE = ("anderson", "chord", "kurchatov", "one-point", "robin", "neumann")
#: The most iterations: of methods that are sure, and of others.
FEW, MANY = 60, 150
#: What is asked of a solve: F₁' relative to the forces at work.
TOLERANCE = 1e-10
#: The residual found anew: as asked, and ten times for motions that were taken out of the displacements, which round.
RESIDUAL = 10 * TOLERANCE
#: Displacements, gaps and areas evaluated in another way: sums of up to a hundred products.
SAME = 1e-11
#: Resultants: a residual adds up over nodes.
BALANCE = 1e-8
#: Two solutions: the compliance of a contact turns residuals into pressures; its condition is up to 1e4 here.
AGREEMENT = 1e-6


#: The laws and how often they are drawn.
LAWS = {
    "power": 0.28, "linear": 0.18, "cubic": 0.06, "table": 0.08, "coating": 0.06, "logarithmic": 0.06,
    "hyperbolic": 0.06, "exponential": 0.06, "series": 0.05, "varying": 0.05, "hard": 0.06,
}  # fmt: skip


#: Those that have a pole, or grow as one.
STEEPENING = ("coating", "logarithmic", "hyperbolic", "exponential")


@dataclass(frozen=True)
class Stuff:
    """A material and, written out, its tensor C_ijkl and what that is times at x (dim, n)."""

    material: cd.Material
    tensor: Floats
    factor: Callable[[Floats], Floats] | None = None


@dataclass
class Trial:
    """A scene to be solved.

    kind: in words; scene: to solve; forms: of every body with a mesh; laws: of every contact; curved: see `Monolithic`;
    solvable: whether it has an equilibrium; change: what is done before a second solve of the same scene; sizes: of the
    scene: a length, a stress.
    """

    kind: str
    scene: cd.Scene
    forms: dict[str, WeakForm]
    laws: list[Law]
    curved: bool = False
    solvable: bool = True
    change: Callable[[], None] | None = None


@dataclass
class Outcome:
    """What came of a trial; fault: what is wrong, in words, or nothing."""

    seed: int
    kind: str
    method: str
    local_solver: str
    status: str
    disagreement: float = 0.0
    findings: dict[str, float] = field(default_factory=dict)
    fault: str = ""
    seconds: float = 0.0


class Recipe:
    """Numbers drawn for one scene, of the size of its units, and the bodies and contacts made so far.

    length, modulus: the units of the scene; load: a pressure that strains the softest body by less than a thousandth.
    """

    def __init__(self, random: Random) -> None:
        self.random = random
        self.length, self.modulus = self.power(-3, 3), self.power(-3, 9)
        self.load = self.modulus * self.power(-7, -3)
        self.contrast = self.pick([0.0, 1.0, 4.0])
        self.bodies: list[Any] = []
        self.forms: dict[str, WeakForm] = {}
        self.contacts: list[cd.Contact] = []
        self.laws: list[Law] = []
        self.angle = 0.0
        self.parameters: list[cd.Parameter] = []

    def pick(self, values: Sequence[Any], p: Sequence[float] | None = None) -> Any:
        return values[self.random.choice(len(values), p=p)]

    def between(self, low: float, high: float) -> float:
        return float(self.random.uniform(low, high))

    def power(self, low: float, high: float) -> float:
        return 10.0 ** self.between(low, high)

    def chance(self, of: float) -> bool:
        return bool(self.random.random() < of)

    def count(self, low: int, high: int) -> int:
        return int(self.random.integers(low, high + 1))

    # Turned scenes: what is drawn along x and y lies along two other directions

    @property
    def axes(self) -> Floats:
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.array([[c, s], [-s, c]])

    def along(self, x: Floats) -> Floats:
        """The coordinates x (dim, n) of the turned scene as they were drawn."""
        return np.concatenate([self.axes @ x[:2], x[2:]]) if self.angle else x

    def turned(self, vector: Sequence[float]) -> Floats:
        given = np.asarray(vector, dtype=float)
        return np.concatenate([self.axes.T @ given[:2], given[2:]]) if self.angle else given

    def placed(self, mesh: cd.Mesh) -> cd.Mesh:
        """A mesh in the scene's unit of length, turned with the scene."""
        x = mesh.domain.geometry.x
        x *= self.length
        if self.angle:
            x[:, :2] = x[:, :2] @ self.axes
        return cd.Mesh(mesh.domain, mesh.surfaces)

    def displaced(self) -> None:
        """What is prescribed makes the pressures: let no body be so stiff that they are far beyond the load."""
        self.contrast = min(self.contrast, 1.0)

    # Materials and laws

    def stuff(self, plane: bool) -> Stuff:
        """A material no softer than the scene's modulus."""
        E = self.modulus * 10 ** self.between(0.0, self.contrast)
        nu = self.pick([0.0, 0.2, 0.3, 0.45, 0.49])
        kind = self.pick(["isotropic", "varying", "orthotropic", "rotated"], p=[0.6, 0.1, 0.15, 0.15])
        if kind == "isotropic":
            return Stuff(cd.Isotropic(E, nu), isotropic(E, nu))
        if kind == "varying":
            slope = self.turned([0.05, 0.03] if plane else [0.05, 0.03, 0.02])

            def factor(x: Floats) -> Floats:
                return 1.0 + np.abs(slope @ x[: len(slope)]) / self.length

            return Stuff(cd.Isotropic(lambda x: E * factor(x), nu), isotropic(E, nu), factor)
        E1, E2, E3 = (E * self.between(1.0, 4.0) for _ in range(3))
        given = cd.Orthotropic(E1, E2, E3, 0.2, 0.15, 0.1, E * 0.6, E * 0.5, E * 0.4)
        if kind == "orthotropic":
            return Stuff(given, orthotropic(given))
        angle = self.between(0.0, np.pi)
        return Stuff(given.rotated(angle), rotated(orthotropic(given), angle))

    def law(self) -> Law:
        """A layer that gives way between a thousandth and a thousand times as much as the bodies under the load."""
        p0, c0 = self.load, self.load / self.modulus * self.length * self.power(-3, 1.5)
        kind = self.pick(list(LAWS), p=list(LAWS.values()))
        if kind in STEEPENING:  # pressed beyond it a hundred times such a law says nothing but where its wall is
            p0, c0 = 10 * p0, 10 * max(c0, 0.1 * self.load / self.modulus * self.length)
        if kind == "power":
            a = self.pick([0.4, 0.7, 1.0, 1.1, 2.0, 3.0])
            return Law(cd.PowerLayer(c0 / p0**a, a), lambda p, x: c0 * (p / p0) ** a)
        if kind == "linear":
            return Law(cd.LinearLayer(p0 / c0), lambda p, x: p * c0 / p0)
        if kind == "cubic":
            cubic = cd.CustomLayer(
                lambda w: p0 * (w / c0 + (w / c0) ** 3),
                derivative=lambda w: p0 / c0 * (1 + 3 * (w / c0) ** 2),
                compression_range=10 * c0,
            )
            return Law(cubic, lambda p, x: c0 * _root_of_cubic(p / p0))
        if kind == "coating":  # pressed through at 2 c₀, where the law is not a number
            coating = cd.CustomLayer(_quiet(lambda w: p0 * np.log1p(0.5 * w / c0)), compression_range=1.8 * c0)
            return Law(coating, lambda p, x: -2 * c0 * np.expm1(-p / p0))
        if kind == "logarithmic":
            return Law(cd.LogarithmicLayer(p0, 2 * c0), lambda p, x: -2 * c0 * np.expm1(-p / p0))
        if kind == "hyperbolic":
            return Law(cd.HyperbolicLayer(p0 / c0, 2 * c0), lambda p, x: p / (p0 / c0 + p / (2 * c0)))
        if kind == "exponential":
            return Law(cd.ExponentialLayer(p0, c0), lambda p, x: c0 * np.log1p(p / p0))
        if kind == "series":
            parts = cd.LinearLayer(p0 / c0), cd.PowerLayer(c0 / p0**1.5, 1.5)
            return Law(cd.SeriesLayer(*parts), lambda p, x: c0 * (p / p0 + (p / p0) ** 1.5))
        if kind == "varying":

            def stiffness(x: Floats) -> Floats:
                return p0 / c0 * (1.5 + np.sin(np.sum(x, axis=0) / self.length))

            return Law(cd.VaryingLayer(cd.LinearLayer, stiffness=stiffness), lambda p, x: p / stiffness(x.T))
        if kind == "hard":  # a penetration of a millionth of what the pressure does to a facet
            slack = 3e-6 * self.length / self.modulus
            return Law(cd.HardContact(), lambda p, x: np.zeros_like(p), slack)
        c, p = c0 * np.array([0.5, 1.0, 1.5, 2.0]), p0 * np.array([0.2, 1.0, 3.0, 20.0])
        compression = _inverse_of_table(c, p)
        return Law(cd.TableLayer(c, p), lambda p, x: compression(p))

    # Bodies and contacts

    def body(self, name: str, mesh: cd.Mesh, supports: Sequence[Any], loads: Sequence[Any], kinematics: str) -> cd.Body:
        stuff, degree = self.stuff(mesh.dim == 2), self.pick([1, 2, 3] if mesh.dim == 2 else [1, 1, 1, 2])
        solver = self.pick(["condensed", "assembled", "multigrid", None], p=[0.1, 0.1, 0.05, 0.75])
        made = cd.Body(
            name, self.placed(mesh), stuff.material, supports=supports, loads=loads, degree=degree,
            kinematics=kinematics, local_solver=solver,
        )  # fmt: skip
        self.bodies.append(made)
        self.forms[name] = WeakForm(made, stuff.tensor, stuff.factor)
        return made

    def rectangle(
        self, low: Sequence[float], high: Sequence[float], cells: tuple[int, int], **surfaces: Any
    ) -> cd.Mesh:
        shape = self.pick(["triangle", "quadrilateral"], p=[0.7, 0.3])
        mesh = cd.rectangle(low, high, cells, shape=shape, diagonal=self.pick(["left", "right", "crossed"]))
        return mesh.with_surfaces(**surfaces) if surfaces else mesh

    def plane(self) -> str:
        return self.pick(["plane strain", "plane stress"])

    def touch(self, first: Any, second: Any, gap: Any, **options: Any) -> None:
        law = self.law()
        if self.chance(0.3):
            first, second = second, first
        name = f"contact {len(self.contacts) + 1}"
        if isinstance(law.layer, cd.HardContact):
            options = {}
        elif not options and self.chance(0.1) and all(isinstance(side, tuple) for side in (first, second)):
            options = {"quadrature": "mortar"}
        self.contacts.append(cd.Contact(first, second, law.layer, gap=gap, name=name, **options))
        self.laws.append(law)

    def gap(self) -> Any:
        """None, an interference, a clearance, waves along the contact, or a parameter."""
        size = self.load / self.modulus * self.length * self.power(-1, 0.7)
        kind = self.pick(["none", "interference", "clearance", "waves", "parameter"], p=[0.3, 0.1, 0.1, 0.4, 0.1])
        waves, shift = self.between(0.5, 4.0) / self.length, self.between(0.0, 6.0)
        if kind == "waves":
            return lambda x: size * (1.0 + np.sin(waves * np.sum(self.along(x)[::2], axis=0) + shift))
        if kind == "parameter":
            return self.parameter(0.2 * size)
        return {"none": 0.0, "interference": -0.3 * size, "clearance": size}[kind]

    def parameter(self, value: float) -> Any:
        self.parameters.append(cd.Parameter(value))
        return self.parameters[-1]

    def pressure(self, surface: str, value: float | None = None) -> cd.Pressure:
        value = self.load if value is None else value
        return cd.Pressure(surface, self.parameter(value) if self.chance(0.2) else value)

    def trial(self, kind: str, **options: Any) -> Trial:
        changed = self.parameters

        def change() -> None:
            for parameter in changed:
                parameter.value = 1.3 * parameter.value

        scene = cd.Scene(self.bodies, self.contacts)
        return Trial(kind, scene, self.forms, self.laws, change=change if changed else None, **options)


def _quiet(function: Callable[[Floats], Floats]) -> Callable[[Floats], Floats]:
    """The same function without warnings of what is no number."""

    def quietly(w: Floats) -> Floats:
        with np.errstate(all="ignore"):
            return function(w)

    return quietly


def _root_of_cubic(y: Floats) -> Floats:
    """The c with c + c³ = y, by Newton's method from above."""
    c = np.minimum(y, np.cbrt(y))
    for _ in range(60):
        c = c - (c + c**3 - y) / (1 + 3 * c**2)
    return c


def _inverse_of_table(c: Floats, p: Floats) -> Callable[[Floats], Floats]:
    """The compressions of SciPy's monotone cubic through the origin and the points, straight beyond the last."""
    c, p = np.append(0.0, c), np.append(0.0, p)
    slopes = scipy.interpolate.PchipInterpolator(c, p).derivative()(c)
    if slopes[0] <= 1e-8 * p[1] / c[1]:  # where it would begin flat, with half the chord's slope
        slopes[0] = 0.5 * p[1] / c[1]
    curve, end = scipy.interpolate.CubicHermiteSpline(c, p, slopes), slopes[-1]

    def compression(pressure: Floats) -> Floats:
        low, high = np.zeros_like(pressure), np.full_like(pressure, c[-1])
        for _ in range(80):
            middle = 0.5 * (low + high)
            above = curve(middle) >= pressure
            low, high = np.where(above, low, middle), np.where(above, middle, high)
        return np.where(pressure > p[-1], c[-1] + (pressure - p[-1]) / end, high)

    return compression


# Scenes


def stack(recipe: Recipe) -> Trial:
    """Blocks on each other: between walls, on springs or loose; on a floor or floating; pressed or let down."""
    count, kinematics = recipe.count(2, 4), recipe.plane()
    hold = recipe.pick(["walls", "springs", "loose"], p=[0.5, 0.25, 0.25])
    drive = recipe.pick(["pressure", "resultant", "settlement", "weight"], p=[0.4, 0.2, 0.2, 0.2])
    floating = hold == "walls" and drive == "pressure" and recipe.chance(0.4)
    if drive == "settlement":
        recipe.displaced()
    recipe.angle = recipe.pick([0.0, recipe.between(-np.pi, np.pi)], p=[0.7, 0.3])
    mixed, floor = recipe.chance(0.2), 0.0
    cells = recipe.count(2, 6)
    matching = recipe.chance(0.3)
    for i in range(count):
        height, last = recipe.between(0.4, 1.5), i == count - 1
        inset = 0.0 if hold != "loose" or i == 0 else recipe.between(0.0, 0.2)
        mesh = recipe.rectangle(
            (inset, floor), (2 - inset, floor + height), (cells if matching else recipe.count(2, 7), recipe.count(1, 3))
        )
        supports: list[Any] = [cd.Symmetry("left", "right")] if hold == "walls" else []
        if hold == "springs":
            stiffness = recipe.modulus / recipe.length * recipe.power(-4, 1)
            supports.append(
                cd.Spring("left", stiffness, recipe.pick([None, "normal", tuple(recipe.turned([1.0, 0.0]))]))
            )
        loads: list[Any] = []
        if i == 0:
            if floating:
                loads.append(cd.Pressure("bottom", recipe.load))
            else:
                supports.append(cd.Fixed("bottom") if recipe.chance(0.5) and hold != "walls" else cd.Symmetry("bottom"))
                if hold == "loose" and isinstance(supports[-1], cd.Symmetry):
                    supports.append(cd.Symmetry("left"))
        if last:
            supports, more = _driven(recipe, drive, supports, hold, floating)
            loads += more
        if drive == "weight":
            loads.append(cd.BodyForce(recipe.turned([0.0, -recipe.load / recipe.length])))
        name, own = f"block {i + 1}", recipe.plane() if mixed else kinematics
        recipe.body(name, mesh, supports, loads, own)
        floor += height
    for low, high in zip(recipe.bodies[:-1], recipe.bodies[1:], strict=True):
        recipe.touch(
            (low, "top"), (high, "bottom"), recipe.gap(), **_rule(recipe, (low, high), matching and hold != "loose")
        )
    return recipe.trial(f"stack, {hold}")


def _driven(recipe: Recipe, drive: str, supports: list[Any], hold: str, floating: bool) -> tuple[list[Any], list[Any]]:
    """How the last block of a stack is pressed."""
    if drive == "resultant":
        return supports, [cd.Resultant("top", recipe.turned([0.0, -2 * recipe.load * recipe.length]))]
    if drive == "settlement" and recipe.angle == 0.0:
        depth = recipe.load / recipe.modulus * recipe.length * recipe.power(-0.5, 1.0)
        value = recipe.parameter(-depth) if recipe.chance(0.3) else -depth
        sideways = None if hold == "walls" else recipe.pick([None, 0.0])
        return supports + [cd.Displacement("top", [sideways, value])], []
    if floating or recipe.chance(0.7):
        return supports, [cd.Pressure("top", recipe.load) if floating else recipe.pressure("top")]
    slope = recipe.between(-0.2, 0.2)
    return supports, [
        cd.Pressure("top", lambda x: recipe.load * (1.0 + slope * (recipe.along(x)[0] / recipe.length - 1.0)))
    ]


def _rule(recipe: Recipe, bodies: Sequence[cd.Body], matching: bool) -> dict[str, Any]:
    """A quadrature of the contact: others than Gauss' where meshes match, vertices under linear elements."""
    if not matching or recipe.chance(0.6) or any(body.kinematics.axisymmetric for body in bodies):
        return {"quadrature_degree": recipe.count(2, 6)} if recipe.chance(0.15) else {}
    linear = all(body.degree == 1 for body in bodies)
    return {"quadrature": recipe.pick(["facet", "vertex"] if linear else ["facet"])}


def pile(recipe: Recipe) -> Trial:
    """A base, two columns beside each other on it, and a lintel on both."""
    kinematics = recipe.plane()
    heights, parts = (recipe.between(0.5, 1.0), recipe.between(0.5, 1.5)), ((0.0, 0.9), (1.1, 2.0))

    def halves(y: float) -> dict[str, Any]:
        return {
            "one": lambda x: np.isclose(x[1], y) & (x[0] < 1.0 + 1e-9),
            "two": lambda x: np.isclose(x[1], y) & (x[0] > 1.0 - 1e-9),
        }

    top = sum(heights)
    mesh = recipe.rectangle((0, 0), (2, heights[0]), (2 * recipe.count(1, 4), 2), **halves(heights[0]))
    base = recipe.body("base", mesh, [cd.Fixed("bottom")], [], kinematics)
    columns = []
    for i, (left, right) in enumerate(parts):
        mesh = recipe.rectangle((left, heights[0]), (right, top), (recipe.count(2, 4), recipe.count(1, 3)))
        supports = [cd.Symmetry("left" if i == 0 else "right")] if recipe.chance(0.3) else []
        columns.append(recipe.body(f"column {i + 1}", mesh, supports, [], kinematics))
    mesh = recipe.rectangle((0, top), (2, top + 0.5), (2 * recipe.count(1, 4), 2), **halves(top))
    lintel = recipe.body("lintel", mesh, [], [recipe.pressure("top")], kinematics)
    size = recipe.load / recipe.modulus * recipe.length
    for column, half in zip(columns, ("one", "two"), strict=True):
        for other, ends in ((base, ("bottom", half)), (lintel, ("top", half))):
            recipe.touch((column, ends[0]), (other, ends[1]), recipe.pick([0.0, -0.1 * size, 0.1 * size]))
    return recipe.trial("pile")


def beside(recipe: Recipe) -> Trial:
    """Two blocks held at their far ends and pressed together sideways by an interference, or by a moved end."""
    kinematics, size = recipe.plane(), recipe.load / recipe.modulus * recipe.length
    recipe.angle = recipe.pick([0.0, recipe.between(-np.pi, np.pi)])
    recipe.displaced()
    low = recipe.rectangle((0, 0), (1, 1), (recipe.count(1, 3), recipe.count(2, 6)))
    high = recipe.rectangle((1, 0), (2.5, 1), (recipe.count(1, 3), recipe.count(2, 6)))
    both = recipe.chance(0.5)  # the contact faces are held at their ends
    held = [cd.Symmetry("bottom")] if both else [cd.Fixed("left")]
    one = recipe.body("one", low, [*held, cd.Symmetry("left")] if both else held, [], kinematics)
    moved = recipe.angle == 0.0 and recipe.chance(0.5)
    end = cd.Displacement("right", [-size * recipe.power(-1, 0.5), 0.0]) if moved else cd.Fixed("right")
    two = recipe.body(
        "two", high, [end], [cd.BodyForce(recipe.turned([0.0, 0.1 * recipe.load / recipe.length]))], kinematics
    )
    gap = recipe.gap() if moved else -size * recipe.power(-1, 0.5)
    recipe.touch((one, "right"), (two, "left"), gap)
    return recipe.trial("beside each other")


def discs(recipe: Recipe) -> Trial:
    """Discs or rings on each other, bodies of revolution."""
    inner, floor, count = recipe.pick([0.0, recipe.between(0.2, 3.0)]), 0.0, recipe.count(2, 3)
    for i in range(count):
        height = recipe.between(0.4, 1.2)
        mesh = recipe.rectangle((inner, floor), (inner + 1, floor + height), (recipe.count(2, 6), recipe.count(1, 3)))
        supports: list[Any] = [cd.Symmetry("left")] if inner == 0.0 else []
        loads: list[Any] = []
        if i == 0:
            supports.append(cd.Symmetry("bottom"))
        if i == count - 1:
            loads.append(recipe.pressure("top"))
        if inner > 0.0 and recipe.chance(0.3):
            loads.append(cd.Pressure("left", 0.3 * recipe.load))
        recipe.body(f"disc {i + 1}", mesh, supports, loads, "axisymmetric")
        floor += height
    for low, high in zip(recipe.bodies[:-1], recipe.bodies[1:], strict=True):
        recipe.touch((low, "top"), (high, "bottom"), recipe.gap(), **_rule(recipe, (low, high), False))
    return recipe.trial("discs")


def sleeves(recipe: Recipe) -> Trial:
    """Rings pressed onto each other, bodies of revolution; perhaps on a shaft."""
    inner, count = recipe.pick([0.0, 1.0]), recipe.count(2, 3)
    recipe.displaced()
    size, height = recipe.load / recipe.modulus * recipe.length, recipe.between(0.5, 2.0)
    for i in range(count):
        outer = inner + recipe.between(0.3, 1.0)
        mesh = recipe.rectangle((inner, 0), (outer, height), (recipe.count(1, 3), recipe.count(2, 6)))
        supports: list[Any] = [cd.Symmetry("bottom")]
        if inner == 0.0:
            supports.append(cd.Symmetry("left"))
        loads = [recipe.pressure("right")] if i == count - 1 and recipe.chance(0.5) else []
        recipe.body(f"sleeve {i + 1}", mesh, supports, loads, "axisymmetric")
        inner = outer
    for one, two in zip(recipe.bodies[:-1], recipe.bodies[1:], strict=True):
        recipe.touch((one, "right"), (two, "left"), recipe.pick([-1.0, -0.1]) * size)
    return recipe.trial("sleeves")


def boxes(recipe: Recipe) -> Trial:
    """Boxes on each other in space, loose or between walls."""
    count, floor, walls = recipe.count(2, 3), 0.0, recipe.chance(0.5)
    let_down = walls and recipe.chance(0.3)
    if let_down:
        recipe.displaced()
    for i in range(count):
        height, inset = recipe.between(0.5, 1.0), 0.0 if walls or i == 0 else recipe.between(0.0, 0.2)
        counts = (recipe.count(1, 3), recipe.count(1, 3), recipe.count(1, 2))
        shape = recipe.pick(["tetrahedron", "hexahedron"])
        mesh = cd.box((inset, inset, floor), (2 - inset, 2 - inset, floor + height), counts, shape=shape)
        supports: list[Any] = [cd.Symmetry("left", "right", "front", "back")] if walls else []
        loads: list[Any] = []
        if i == 0:
            supports.append(cd.Fixed("bottom"))
        if i == count - 1:
            if let_down:
                depth = recipe.load / recipe.modulus * recipe.length * recipe.power(-0.5, 1.0)
                supports.append(cd.Displacement("top", [None, None, -depth]))
            else:
                loads.append(recipe.pressure("top"))
        recipe.body(f"box {i + 1}", mesh, supports, loads, "solid")
        floor += height
    for low, high in zip(recipe.bodies[:-1], recipe.bodies[1:], strict=True):
        recipe.touch((low, "top"), (high, "bottom"), recipe.gap())
    return recipe.trial("boxes")


def arcs(recipe: Recipe) -> Trial:
    """A quarter of a ring pressed onto another one, in the plane, with facets that match or not."""
    kinematics, match = recipe.plane(), recipe.chance(0.5)
    recipe.displaced()
    size, count = recipe.load / recipe.modulus * recipe.length, recipe.count(4, 10)
    radii = (1.0, 1.5, recipe.between(1.8, 3.0))
    for i in range(2):
        cells = (recipe.count(1, 2), count if match else recipe.count(4, 12))
        mesh = cd.rectangle((radii[i], 0), (radii[i + 1], np.pi / 2), cells, diagonal=recipe.pick(["left", "right"]))
        x = mesh.domain.geometry.x
        r, angle = x[:, 0].copy(), x[:, 1].copy()
        x[:, 0], x[:, 1] = r * np.cos(angle), r * np.sin(angle)
        loads = [recipe.pressure("left" if i == 0 else "right")] if recipe.chance(0.5) else []
        recipe.body(f"arc {i + 1}", mesh, [cd.Symmetry("bottom", "top")], loads, kinematics)
    one, two = recipe.bodies
    recipe.touch((one, "right"), (two, "left"), -size * recipe.power(-1, 0.5))
    # The mortar rule takes the smooth surface behind facets also where they match.
    curved = not match or recipe.contacts[0].quadrature == "mortar"
    return recipe.trial("arcs" if match else "arcs that do not match", curved=curved)


class Plate(cd.MeshlessBody):
    """A rigid plate above y = height or a rigid cylinder that touches it there, pressed or let down."""

    def __init__(self, height: float, radius: float, size: float, force: float | None, depth: float | None) -> None:
        super().__init__("plate")
        self.height, self.radius, self.force, self.depth, self.length = height, radius, force, depth, size

    def gap(self, x: Floats, direction: Floats) -> Floats:
        offset = np.array([self.length, self.height]) - x
        if np.isinf(self.radius):
            return offset[:, 1]
        return offset[:, 1] + offset[:, 0] ** 2 / (2 * self.radius)  # a parabola

    def normal_displacement(self, x: Floats, direction: Floats) -> Floats:
        arm = x - np.array([self.length, self.height])
        return -np.column_stack([direction, arm[:, 0] * direction[:, 1] - arm[:, 1] * direction[:, 0]])

    def load(self) -> Floats:
        return np.array([0.0, -(self.force or 0.0), 0.0])

    def prescribed(self) -> Floats:
        return np.array([0.0, np.nan if self.depth is None else -self.depth, 0.0])


def indenter(recipe: Recipe) -> Trial:
    """A rigid plate or cylinder without a mesh on one or two blocks."""
    kinematics, floor, count = recipe.plane(), 0.0, recipe.count(1, 2)
    recipe.displaced()
    for i in range(count):
        mesh = recipe.rectangle((0, floor), (2, floor + 1), (recipe.count(2, 8), recipe.count(1, 3)))
        supports = [cd.Fixed("bottom")] if i == 0 else [cd.Symmetry("left", "right")]
        recipe.body(f"block {i + 1}", mesh, supports, [], kinematics)
        floor += 1
    size, length = recipe.load / recipe.modulus * recipe.length, recipe.length
    radius = recipe.pick([np.inf, length * recipe.power(2, 4)])
    pressed = recipe.chance(0.5)
    force, depth = (2 * recipe.load * length, None) if pressed else (None, size * recipe.power(-0.5, 0.7))
    plate = Plate(floor * length, radius, length, force, depth)
    recipe.bodies.append(plate)
    for low, high in zip(recipe.bodies[:-2], recipe.bodies[1:-1], strict=True):
        recipe.touch((low, "top"), (high, "bottom"), recipe.gap())
    recipe.touch((recipe.bodies[-2], "top"), plate, 0.0)
    return recipe.trial("indenter")


def pulled(recipe: Recipe) -> Trial:
    """A stack whose last block is pulled up: no equilibrium."""
    kinematics = recipe.plane()
    for i in range(recipe.count(2, 3)):
        mesh = recipe.rectangle((0, i), (2, i + 1), (recipe.count(2, 6), 2))
        held = [cd.Symmetry("left", "right")] + ([cd.Symmetry("bottom")] if i == 0 else [])
        recipe.body(f"block {i + 1}", mesh, held, [], kinematics)
    last = recipe.bodies.pop()
    loads = [cd.Pressure("top", -recipe.load)]
    recipe.bodies.append(
        cd.Body(last.name, last.mesh, last.material, supports=last.supports, loads=loads, degree=last.degree,
                kinematics=last.kinematics.name)
    )  # fmt: skip
    for low, high in zip(recipe.bodies[:-1], recipe.bodies[1:], strict=True):
        recipe.touch((low, "top"), (high, "bottom"), recipe.gap())
    return recipe.trial("pulled apart", solvable=False)


#: The kinds of scene and how often they are drawn.
KINDS: dict[Callable[[Recipe], Trial], float] = {
    stack: 0.32,
    pile: 0.08,
    beside: 0.1,
    discs: 0.1,
    sleeves: 0.1,
    boxes: 0.1,
    arcs: 0.08,
    indenter: 0.08,
    pulled: 0.04,
}


def trial(seed: int) -> tuple[Trial, str, str]:
    """The scene of a seed, a method and a local solver."""
    recipe = Recipe(np.random.default_rng(seed))
    make = recipe.pick(list(KINDS), p=list(KINDS.values()))
    method = recipe.pick(["auto", *SURE[1:], *UNSURE], p=[0.35] + [0.1] * 4 + [0.1] + [0.03] * 5)
    local_solver = recipe.pick(["auto", "condensed", "assembled", "multigrid"], p=[0.4, 0.25, 0.25, 0.1])
    return make(recipe), method, local_solver


def run(seed: int) -> Outcome:
    """One trial, solved and checked."""
    began = time.process_time()
    made, method, local_solver = trial(seed)
    outcome = Outcome(seed, made.kind, method, local_solver, "")
    monolithic = Monolithic(made.scene, made.forms, made.laws, made.curved)
    try:
        for change in (lambda: None, made.change):
            if change is not None and not outcome.fault:
                change()
                _solve(made, monolithic, method, local_solver, outcome)
    except Exception as error:  # a fault of its own, whatever it is
        outcome.status, outcome.fault = type(error).__name__, f"{type(error).__name__}: {error}"
    outcome.seconds = round(time.process_time() - began, 3)
    return outcome


def _solve(made: Trial, monolithic: Monolithic, method: str, local_solver: str, outcome: Outcome) -> None:
    """Solve a scene in two ways and note what is wrong."""
    first = _solution(made.scene, method, local_solver)
    second = _solution(made.scene, *_another_way(method, local_solver))
    outcome.status = first.status
    for name, solution in ((method, first), (second.method, second)):
        wrong = _verdict(made, monolithic, name, solution, outcome)
        if wrong:
            outcome.fault = f"{name}: {wrong}"
            return
    if first.converged and second.converged:
        outcome.disagreement = max(outcome.disagreement, disagreement(first, second))
        if not outcome.disagreement <= AGREEMENT:
            outcome.fault = f"{method} and {second.method} differ by {outcome.disagreement:.1e}"


def _another_way(method: str, local_solver: str) -> tuple[str, str]:
    return ("newton-chord" if method == "auto" else "auto", "condensed" if local_solver == "assembled" else "assembled")


def _solution(scene: cd.Scene, method: str, local_solver: str) -> cd.Solution:
    most = FEW if method in SURE else MANY
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", cd.LargeStrainWarning)
        warnings.simplefilter("ignore", cd.ContactWarning)  # coarse arcs are told of
        return cd.solve(
            scene, method, local_solver=local_solver, tolerance=TOLERANCE, max_iterations=most, on_failure="return"
        )


def _verdict(made: Trial, monolithic: Monolithic, method: str, solution: cd.Solution, outcome: Outcome) -> str:
    """What is wrong with a solution, in words."""
    if not made.solvable:
        return "" if solution.status == "no equilibrium" else f"{solution.status}, but there is no equilibrium"
    if not solution.converged:
        allowed = method in UNSURE and solution.status != "no equilibrium"
        return "" if allowed else f"{solution.status}: {solution.reason}"
    found = monolithic.check(solution)
    for name, value in asdict(found).items():
        outcome.findings[name] = max(outcome.findings.get(name, 0.0), value)
    wrong = faults(found)
    return f"converged, but {wrong}" if wrong else ""


def faults(found: Findings) -> str:
    """Which findings are larger than they may be."""
    limits = {"residual": RESIDUAL, "reaction": BALANCE, "balance": BALANCE}
    large = [f"{f.name} {getattr(found, f.name):.1e}" for f in fields(found)
             if not getattr(found, f.name) <= limits.get(f.name, SAME)]  # fmt: skip
    return ", ".join(large)


def disagreement(first: cd.Solution, second: cd.Solution) -> float:
    """The relative L2 difference of all pressures."""
    square = size = 0.0
    for index in range(len(first.scene.contacts)):
        one, two = first.contact(index), second.contact(index)
        square += one.weights @ (one.pressure - two.pressure) ** 2
        size += one.weights @ one.pressure**2
    return float(np.sqrt(square / size)) if size > 0.0 else float(np.sqrt(square))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run many trials and tell what came of them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--start", type=int, default=0, help="the first seed")
    parser.add_argument("--seed", type=int, help="only this one")
    parser.add_argument("--out", help="a file to which every outcome is appended, one line of JSON each")
    options = parser.parse_args(arguments)
    seeds = [options.seed] if options.seed is not None else range(options.start, options.start + options.count)
    outcomes = []
    for seed in seeds:
        outcomes.append(run(seed))
        if outcomes[-1].fault:
            print(f"seed {seed}, {outcomes[-1].kind}, {outcomes[-1].local_solver}: {outcomes[-1].fault}", flush=True)
        if options.out:
            with open(options.out, "a") as file:
                file.write(json.dumps(asdict(outcomes[-1])) + "\n")
    report(outcomes)
    return int(any(outcome.fault for outcome in outcomes))


def report(outcomes: Sequence[Outcome]) -> None:
    """How many were solved, refused and why, and the largest findings."""
    print(f"{len(outcomes)} scenes, {sum(o.seconds for o in outcomes):.0f} s CPU")
    for title, key in (("kind", lambda o: o.kind), ("method", lambda o: o.method)):
        for name in sorted({key(o) for o in outcomes}):
            counts = Counter(o.status for o in outcomes if key(o) == name)
            print(f"  {title} {name}: " + ", ".join(f"{n} {status}" for status, n in counts.most_common()))
    for name in ["residual", *[f.name for f in fields(Findings) if f.name != "residual"]]:
        print(f"  largest {name}: {max((o.findings.get(name, 0.0) for o in outcomes), default=0.0):.1e}")
    print(f"  largest disagreement of two methods: {max((o.disagreement for o in outcomes), default=0.0):.1e}")
    print(f"  faults: {sum(bool(o.fault) for o in outcomes)}")


if __name__ == "__main__":
    sys.exit(main())
