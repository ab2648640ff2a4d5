"""Scenes in TOML files: meshes, materials, layers, bodies and contacts by name, for those who do not write Python."""

from __future__ import annotations

import ast
import inspect
import operator
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from .base.arrays import Floats
from .base.checks import listed
from .body import Body
from .contact import Contact
from .eigenstrain import Eigenstrain, ThermalStrain
from .files import read_mesh
from .hard_contact import HardContact
from .layer import LinearLayer, PowerLayer
from .layers.bonded import BondedLayer
from .layers.exponential import ExponentialLayer, OverclosureLayer
from .layers.gasket import GasketLayer
from .layers.hyperbolic import HyperbolicLayer
from .layers.logarithmic import LogarithmicLayer
from .layers.rough import GreenwoodWilliamsonLayer
from .layers.series import SeriesLayer
from .layers.table import TableLayer
from .load import BodyForce, Pressure, Resultant, Traction
from .material import Anisotropic, Isotropic, Orthotropic
from .mesh import box, rectangle
from .parameter import Parameter
from .partners.mirror_plane import MirrorPlane
from .partners.rigid_body import RigidBody
from .point_force import PointForce
from .programme import LoadPath, programme
from .scene import Scene
from .shapes import Cone, Cylinder, FlatPunch, Plane, Sphere
from .solution import Solution
from .solve import solve
from .support import Displacement, Fixed, PointDisplacement, Spring, Symmetry

#: What `type = "..."` may name, by the section or key that it stands in.
TYPES: dict[str, dict[str, Callable[..., Any]]] = {
    "materials": {kind.__name__: kind for kind in (Isotropic, Orthotropic, Anisotropic)},
    "layers": {
        **{kind.__name__: kind for kind in (PowerLayer, LinearLayer, HyperbolicLayer, LogarithmicLayer, TableLayer)},
        **{kind.__name__: kind for kind in (ExponentialLayer, OverclosureLayer, GreenwoodWilliamsonLayer)},
        **{kind.__name__: kind for kind in (SeriesLayer, BondedLayer, GasketLayer)},
        "HardContact": HardContact,
        "PowerLayer.machined_joint": PowerLayer.machined_joint,
        "LinearLayer.elastic_foundation": LinearLayer.elastic_foundation,
        "TableLayer.from_csv": TableLayer.from_csv,
        "TableLayer.from_measurement": TableLayer.from_measurement,
    },
    "meshes": {"rectangle": rectangle, "box": box, "file": read_mesh},
    "supports": {kind.__name__: kind for kind in (Fixed, Symmetry, Displacement, PointDisplacement, Spring)},
    "loads": {
        **{kind.__name__: kind for kind in (Pressure, Traction, Resultant, BodyForce, PointForce)},
        **{kind.__name__: kind for kind in (ThermalStrain, Eigenstrain)},
    },
    "shape": {kind.__name__: kind for kind in (Plane, Cylinder, Sphere, Cone, FlatPunch)},
    "bodies": {"elastic": Body, "rigid": RigidBody, "mirror": MirrorPlane},
}
SECTIONS = ("title", "meshes", "materials", "layers", "bodies", "contacts", "programme", "solve")
#: What formulas may say beside numbers, coordinates and the programme's parameter.
FUNCTIONS: dict[str, Any] = {
    **{name: getattr(np, name) for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "abs", "maximum", "minimum")},
    "pi": np.pi,
}
OPERATORS: dict[type, Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}


class SceneFileError(ValueError):
    """A scene file says something that makes no scene.

    The message names the file, the line and the key.
    """


@dataclass(frozen=True)
class SceneFile:
    """A scene in a TOML file, which `read_scene_file` has read: the scene, its load programme, and how it is solved.

    Attributes:
        path: The path of the file.
        scene: The scene.
        parameter: The parameter of the load programme, or None where there is none.
        values: Its values, one a step.
        options: The arguments of `solve` beside the scene.
    """

    path: Path
    scene: Scene
    parameter: Parameter | None = None
    values: Sequence[float] = ()
    options: Mapping[str, Any] = field(default_factory=dict)

    def solve(self) -> Solution | LoadPath:
        """The solution of the scene, or the path of its load programme.

        Raises:
            TypeError, ValueError: The section [solve] has an argument that `solve` does not take.
            ContactError: There is no solution, or none was found; see `solve` and `programme`.
        """
        if self.parameter is None:
            return solve(self.scene, **self.options)
        return programme(self.scene, self.parameter, self.values, **self.options)


def read_scene_file(path: str | Path) -> SceneFile:
    """The scene in a TOML file, with meshes, materials, layers, bodies and contacts by their names.

    A number may be a formula in quotes, of the coordinates x, y, z, the parameter of the section [programme], pi, sqrt,
    exp, log, sin, cos, tan, abs, maximum and minimum, such as ``"5e-4 * maximum(1 - x**2, 0)**1.5"``; nothing else is
    evaluated. Paths in the file are relative to it.

    Args:
        path: The path of the file.

    Returns:
        The scene and how it is solved.

    Raises:
        FileNotFoundError: There is no such file.
        SceneFileError: The file makes no scene; the message names the line and the key.

    Example:
        >>> cd.read_scene_file("demos/groove.toml").solve()  # doctest: +SKIP
    """
    path = Path(path)
    return _Reader(path, path.read_text()).read()


@dataclass
class _Reader:
    """What is known while a file is read."""

    path: Path
    text: str

    def read(self) -> SceneFile:
        self._check_keys("", self.content, SECTIONS)
        self._check_keys("programme", self._table("programme"), ("parameter", "values"))
        self._check_options()
        if not self._table("bodies"):
            self.refuse("bodies", "missing: expected a section [bodies.NAME] for each body")
        bodies = [self._body(name) for name in self._table("bodies")]
        contacts = [self._contact(name, {body.name: body for body in bodies}) for name in self._table("contacts")]
        scene = self.made("contacts", lambda: Scene(bodies, contacts))
        return SceneFile(self.path, scene, self.parameter, self._values(), self._table("solve"))

    # --- text ---------------------------------------------------------------------------------------------------------

    @cached_property
    def content(self) -> dict[str, Any]:
        """The file's tables."""
        if sys.version_info >= (3, 11):
            import tomllib
        else:
            import tomli as tomllib
        try:
            return tomllib.loads(self.text)
        except tomllib.TOMLDecodeError as error:
            raise SceneFileError(f"{self.path}: {error}") from None

    def line(self, key: str) -> int:
        """The number of the line that a dotted key is on, or the nearest table around it."""
        parts, best, found = key.split("."), 0, 1
        for number, name in _keys_of_lines(self.text):
            depth = min(len(name), len(parts))
            if name[:depth] == parts[:depth] and depth > best:
                best, found = depth, number
        return found

    def refuse(self, key: str, why: str) -> NoReturn:
        raise SceneFileError(f"{self.path}, line {self.line(key)}, {key}: {why}") from None

    def made(self, key: str, make: Callable[[], Any]) -> Any:
        """What is made, or the error with the place in the file that it is about."""
        try:
            return make()
        except SceneFileError:
            raise
        except (TypeError, ValueError, OSError) as error:
            self.refuse(key, str(error))

    # --- tables -------------------------------------------------------------------------------------------------------

    def _table(self, key: str) -> dict[str, Any]:
        found = self.content.get(key, {})
        if not isinstance(found, dict):
            self.refuse(key, f"{found!r}: expected a section [{key}]")
        return found

    def _check_keys(self, key: str, table: Mapping[str, Any], known: Sequence[str]) -> None:
        for name in table:
            if name not in known:
                self.refuse(f"{key}.{name}".lstrip("."), f"not known here; expected one of {listed(known)}")

    def _named(self, key: str, section: str, name: Any) -> dict[str, Any]:
        """The table of a section that a name stands for."""
        there = self._table(section)
        if not isinstance(name, str) or name not in there:
            self.refuse(key, f"{name!r}: expected the name of one of [{section}]: {listed(there) or 'there are none'}")
        return self._as_table(f"{section}.{name}", there[name])

    def _as_table(self, key: str, found: Any) -> dict[str, Any]:
        if not isinstance(found, dict):
            self.refuse(key, f"{found!r}: expected a table of keys and values")
        return found

    def _of_type(self, key: str, section: str, table: Any, default: str | None = None, **given: Any) -> Any:
        """What a table with a `type` describes; `given` are arguments that it cannot have."""
        table = dict(self._as_table(key, table))
        kind, kinds = table.pop("type", default), TYPES[section]
        if not isinstance(kind, str) or kind not in kinds:
            self.refuse(f"{key}.type", f"{kind!r}: expected one of {listed(kinds)}")
        return self._call(key, kinds[kind], table, **given)

    def _call(self, key: str, make: Callable[..., Any], table: Mapping[str, Any], **given: Any) -> Any:
        """The result of a function of the package, its arguments from a table."""
        parameters = inspect.signature(make).parameters
        variable = [name for name, p in parameters.items() if p.kind is p.VAR_POSITIONAL]
        free = any(p.kind is p.VAR_KEYWORD for p in parameters.values())  # the numbers of a .geo script
        if not free:
            self._check_keys(key, table, [name for name in parameters if name not in given])
        needed = [n for n, p in parameters.items() if p.default is p.empty and p.kind is p.POSITIONAL_OR_KEYWORD]
        for name in needed:
            if name not in table and name not in given:
                self.refuse(key, f"{name} is missing; expected {listed(needed)}")
        values = {name: self._value(f"{key}.{name}", name, value) for name, value in table.items()} | given
        several = [each for name in variable for each in _as_list(values.pop(name, ()))]
        return self.made(key, lambda: make(*several, **values))

    # --- values -------------------------------------------------------------------------------------------------------

    def _value(self, key: str, name: str, value: Any) -> Any:
        """A value as the package wants it, by the name of its argument."""
        if name in ("supports", "loads"):
            return [self._of_type(key, name, item) for item in _as_list(value)]
        if name == "shape" and isinstance(value, dict):
            return self._of_type(key, "shape", value)
        if name == "layers":
            return [self.layer(key, item) for item in _as_list(value)]
        if name in ("layer", "tension", "loading"):
            return self.layer(key, value)
        if name == "material":
            return self._of_type(f"materials.{value}", "materials", self._named(key, "materials", value))
        if name == "mesh":
            table = value if isinstance(value, dict) else self._named(key, "meshes", value)
            return self._of_type(key if table is value else f"meshes.{value}", "meshes", table)
        if name == "path":
            return self.path.parent / str(value)
        if name in FORMULAS:
            return self._formula(key, value)
        return value

    def _formula(self, key: str, value: Any) -> Any:
        """A number, a field or a list of them; "free" is a component without a value."""
        if value == "free":
            return None
        if isinstance(value, list):
            if key.endswith("loads.value") and any(isinstance(each, str) for each in value):
                return self._vector(key, value)
            return [self._formula(key, each) for each in value]
        if not isinstance(value, str):
            return value
        if self.parameter is not None and value.strip() == self._table("programme").get("parameter"):
            return self.parameter
        return self._field(value, self.formula(key, value))

    def _field(self, text: str, function: Callable[[Floats, Any], Floats]) -> Any:
        """A function of the coordinates, which follows the parameter if its text names it."""
        if self.parameter is None or self._table("programme")["parameter"] not in re.findall(r"\w+", text):
            return lambda x: function(x, None)
        return self.parameter.field(lambda now, x: function(x, now))

    def formula(self, key: str, text: str) -> Callable[[Floats, Any], Floats]:
        """A formula as a function of the coordinates (dim, points) and the value of the parameter."""
        known = {*FUNCTIONS, "x", "y", "z"} | ({self._table("programme")["parameter"]} if self.parameter else set())
        try:
            tree = ast.parse(text.strip(), mode="eval").body
        except (SyntaxError, ValueError, RecursionError):
            self.refuse(key, f"{text!r}: expected a number, or a formula such as '2 * (1 - x**2)'")
        for node in ast.walk(tree):
            if isinstance(node, ast.Name) and node.id not in known:
                self.refuse(key, f"{text!r}: {node.id!r} is not known; expected {listed(sorted(known))}")
            if not _is_allowed(node):
                self.refuse(key, f"{text!r}: expected numbers, names, + - * / ** and functions of one or two values")

        def function(x: Floats, now: Any) -> Floats:
            names = {**FUNCTIONS, **dict(zip("xyz", x, strict=False))}
            if self.parameter is not None:
                names[self._table("programme")["parameter"]] = now
            return np.asarray(_evaluated(tree, names), dtype=float) + 0 * x[0]

        try:  # at some point, where a division by a number 0 or a wrong number of arguments shows
            function(np.full((3, 1), 0.5), 1.0)
        except (ArithmeticError, TypeError, ValueError, RecursionError) as error:
            self.refuse(key, f"{text!r}: {error}")
        return function

    @cached_property
    def parameter(self) -> Parameter | None:
        """The parameter of the load programme."""
        table = self._table("programme")
        if not table:
            return None
        name = table.get("parameter")
        if not isinstance(name, str) or not name.isidentifier() or name in {*FUNCTIONS, *"xyz"}:
            self.refuse("programme.parameter", f"{name!r}: expected a name that is not taken, such as 'load'")
        return Parameter(0.0)

    def _values(self) -> list[float]:
        """The values of the parameter."""
        if self.parameter is None:
            return []
        values = self._table("programme").get("values")
        if not isinstance(values, list) or not values or not all(map(_is_number, values)):
            self.refuse("programme.values", f"{values!r}: expected a list of numbers, one a step")
        return [float(value) for value in values]

    def _vector(self, key: str, value: list[Any]) -> Any:
        """A vector field of which some components are formulas."""
        texts = [each if isinstance(each, str) else repr(each) for each in value]
        parts = [self.formula(key, text) for text in texts]
        return self._field(" ".join(texts), lambda x, now: np.array([part(x, now) for part in parts]))

    def layer(self, key: str, value: Any) -> Any:
        """The layer of a name, or hard contact."""
        if value == "hard":
            return HardContact()
        return self._of_type(f"layers.{value}", "layers", self._named(key, "layers", value))

    # --- nouns --------------------------------------------------------------------------------------------------------

    def _body(self, name: str) -> Any:
        key = f"bodies.{name}"
        return self._of_type(key, "bodies", self._table("bodies")[name], "elastic", name=name)

    def _contact(self, name: str, bodies: Mapping[str, Any]) -> Contact:
        key = f"contacts.{name}"
        table = dict(self._as_table(key, self._table("contacts")[name]))
        given: dict[str, Any] = {"name": name}
        for side in ("first", "second"):
            given[side] = self._side(f"{key}.{side}", table.pop(side, None), bodies)
        given["layer"] = self.layer(f"{key}.layer", table.pop("layer", None))
        found: Contact = self._call(key, Contact, table, **given)
        return found

    def _side(self, key: str, value: Any, bodies: Mapping[str, Any]) -> Any:
        """A side of a contact: "body.surface", or a body without a mesh."""
        name, _, surface = str(value).rpartition(".")
        if value in bodies and bodies[value].mesh is None:
            return bodies[value]
        if name not in bodies:
            self.refuse(key, f"{value!r}: expected 'BODY.SURFACE' with one of the bodies {listed(bodies)}")
        return bodies[name], surface

    def _check_options(self) -> None:
        table = self._table("solve")
        known = [name for name in inspect.signature(solve).parameters if name not in ("scene", "callback", "start")]
        self._check_keys("solve", table, known)


#: The arguments whose strings are formulas.
FORMULAS = {
    "value",
    "values",
    "gap",
    "stiffness",
    "force",
    "moment",
    "displacement",
    "rotation",
    "temperature",
    "E",
    "nu",
}
#: The other parts of formulas.
ALLOWED = (ast.BinOp, ast.UnaryOp, ast.Name, ast.Load, *OPERATORS)


def _is_allowed(node: Any) -> bool:
    """Whether a part of a formula is one that formulas may have."""
    if isinstance(node, ast.Constant):
        return _is_number(node.value)
    if isinstance(node, ast.Call):  # a third argument of NumPy's functions would be written to
        several = isinstance(node.func, ast.Name) and node.func.id in ("maximum", "minimum")
        return isinstance(node.func, ast.Name) and len(node.args) == 1 + several
    return isinstance(node, ALLOWED)


def _evaluated(node: Any, names: Mapping[str, Any]) -> Any:
    """The value of a formula that has been checked."""
    if isinstance(node, ast.Constant):
        value: Any = node.value
        return float(value)
    if isinstance(node, ast.Name):
        return names[node.id]
    if isinstance(node, ast.UnaryOp):
        return OPERATORS[type(node.op)](_evaluated(node.operand, names))
    if isinstance(node, ast.BinOp):
        return OPERATORS[type(node.op)](_evaluated(node.left, names), _evaluated(node.right, names))
    return _evaluated(node.func, names)(*(_evaluated(each, names) for each in node.args))


def _keys_of_lines(text: str) -> Iterator[tuple[int, list[str]]]:
    """The number of each line that begins a table or a value, with its dotted key."""
    table: list[str] = []
    for number, line in enumerate(text.splitlines(), 1):
        header = re.match(r"\s*\[\[?\s*([^\]]+?)\s*\]", line)
        value = re.match(r"\s*([\w.\"' -]+?)\s*=", line)
        if header:
            table = _parts(header[1])
            yield number, table
        elif value:
            yield number, table + _parts(value[1])


def _parts(key: str) -> list[str]:
    return [part.strip().strip("\"'") for part in key.split(".")]


def _as_list(value: Any) -> list[Any]:
    return list(value) if isinstance(value, list | tuple) else [value]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
