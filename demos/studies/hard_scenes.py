"""Hard scenes by name, solvable and not: what `hard_cases.py` and the tests give to every method.

Lengths in cm, stresses in MPa. Where nothing else is said a scene is the paper's groove between two steel blocks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

import contactdd as cd

E, NU, LOAD, B, A = 2.1e5, 0.3, 10.0, 4e-6, 1.1
STEEL = cd.Isotropic(E, NU)
LAYER = cd.PowerLayer(B, A)
SIDES = cd.Symmetry("left", "right")


@dataclass(frozen=True)
class Case:
    """A named scene.

    build: makes it; status: how every run has to end that does not run out of iterations; start: u_n or a function of x
    to start from; before: makes the scene whose solution is the start; pressure: the uniform contact pressure where it
    is known in closed form; local_solver: of all bodies; error: how far from the coupled solution one that converged
    may be, if not as far as usual.
    """

    name: str
    build: Callable[[], cd.Scene]
    status: str = "converged"
    start: Any = None
    before: Callable[[], cd.Scene] | None = None
    pressure: float | None = None
    local_solver: str = "auto"
    error: float | None = None

    @property
    def solvable(self) -> bool:
        """Whether it has an equilibrium."""
        return self.status == "converged"


def groove(x: np.ndarray) -> np.ndarray:
    """The paper's d(x)."""
    return 5e-4 * np.maximum(1 - x[0] ** 2, 0) ** 1.5


def two_blocks(
    *,
    moduli: tuple[float, float] = (E, E),
    nu: float = NU,
    layer: cd.Layer | cd.HardContact = LAYER,
    load: float = LOAD,
    heights: tuple[float, float] = (1.0, 1.0),
    cells: tuple[tuple[int, int], tuple[int, int]] = ((32, 16), (32, 16)),
    gap: Any = groove,
    quadrature: str | None = None,
    grading: float = 1.0,
    degree: int = 1,
    diagonal: str = "right",
) -> cd.Scene:
    """Two floating blocks with sliding sides, pressed together from outside.

    Their meshes do not mirror each other, so that the modes are there that a decomposed iteration hardly damps.
    """
    low = cd.rectangle((0, 0), (4, heights[0]), cells[0], diagonal=diagonal)
    high = cd.rectangle((0, heights[0]), (4, sum(heights)), cells[1], diagonal=diagonal)
    for mesh in (low, high):
        x = mesh.domain.geometry.x
        x[:, 0] = 4 * (x[:, 0] / 4) ** grading
    lower = cd.Body("lower", low, cd.Isotropic(moduli[0], nu), supports=[SIDES], loads=[cd.Pressure("bottom", load)],
                    degree=degree)  # fmt: skip
    upper = cd.Body("upper", high, cd.Isotropic(moduli[1], nu), supports=[SIDES], loads=[cd.Pressure("top", load)],
                    degree=degree)  # fmt: skip
    return cd.Scene(
        [lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), layer, gap=gap, quadrature=quadrature)]
    )


def stack(count: int, cells: tuple[int, int] = (16, 8), layer: cd.Layer | cd.HardContact = LAYER) -> cd.Scene:
    """Floating blocks of unlike stiffness and height on each other, a groove in each contact."""
    bodies, floor = [], 0.0
    for i in range(count):
        height = 1.0 + 0.3 * (i % 2)
        loads = [cd.Pressure("bottom", LOAD)] if i == 0 else [cd.Pressure("top", LOAD)] if i == count - 1 else []
        mesh = cd.rectangle((0, floor), (4, floor + height), cells)
        bodies.append(cd.Body(f"block {i + 1}", mesh, cd.Isotropic(E * (1 + i % 3), NU), supports=[SIDES], loads=loads))
        floor += height
    return chain(bodies, layer=layer)


def chain(
    bodies: Sequence[cd.Body], gaps: Sequence[Any] | None = None, layer: cd.Layer | cd.HardContact = LAYER
) -> cd.Scene:
    """Each body's top on the next one's bottom."""
    pairs = zip(bodies[:-1], bodies[1:], gaps or [groove] * (len(bodies) - 1), strict=True)
    return cd.Scene(bodies, [cd.Contact((low, "top"), (high, "bottom"), layer, gap=gap) for low, high, gap in pairs])


def block(name: str, floor: float, ceiling: float, *supports: Any, loads: Sequence[Any] = (), width=(0.0, 4.0)):
    """A steel block on a mesh of eighths."""
    cells = (round(8 * (width[1] - width[0])), round(8 * (ceiling - floor)))
    mesh = cd.rectangle((width[0], floor), (width[1], ceiling), cells)
    return cd.Body(name, mesh, STEEL, supports=supports, loads=loads)


def floor_and(*loads: Any, supports: Sequence[Any] = ()) -> cd.Scene:
    """A block on a fixed one."""
    return chain([block("floor", 0, 1, cd.Fixed("bottom")), block("block", 1, 2, *supports, loads=loads)], [0.0])


def held_apart(distance: float) -> cd.Scene:
    """Two blocks held at their far sides, each bulged by a load of its own, too far apart to touch."""
    lower = block("lower", 0, 1, cd.Fixed("bottom"), loads=[cd.Pressure("left", LOAD)])
    return chain([lower, block("upper", 1, 2, cd.Fixed("top"), loads=[cd.Pressure("right", LOAD)])], [distance])


def single_facet() -> cd.Scene:
    """Only one facet of each block can touch."""
    meshes = [cd.rectangle((0, y), (4, y + 1), (32, 8)).with_surfaces(spot=_spot) for y in (0, 1)]
    lower = cd.Body("lower", meshes[0], STEEL, supports=[SIDES], loads=[cd.Pressure("bottom", LOAD)])
    upper = cd.Body("upper", meshes[1], STEEL, supports=[SIDES], loads=[cd.Pressure("top", LOAD)])
    return cd.Scene([lower, upper], [cd.Contact((lower, "spot"), (upper, "spot"), LAYER)])


def _spot(x: np.ndarray) -> np.ndarray:
    return np.isclose(x[1], 1.0) & (x[0] > 1.99) & (x[0] < 2.13)


def between_two() -> cd.Scene:
    """A short block that only its two neighbours hold; frictionless, it may slide."""
    middle = block("middle", 1, 1.5, width=(1.0, 3.0))
    bodies = [block("lower", 0, 1, cd.Fixed("bottom")), middle,
              block("upper", 1.5, 2.5, SIDES, loads=[cd.Pressure("top", LOAD)])]  # fmt: skip
    return chain(bodies, [0.0, lambda x: 2e-4 * x[0]])


def loses_contact() -> cd.Scene:
    """A cantilever between two blocks touches the lower one at first and is bent up to touch the upper one only."""
    walls = [block("lower", 0, 1, cd.Fixed("bottom")), block("upper", 1.52, 2.5, cd.Fixed("top"))]
    mesh = cd.rectangle((0, 1), (4, 1.5), (32, 4))
    beam = cd.Body("beam", mesh, STEEL, supports=[cd.Fixed("left")], loads=[cd.Pressure("bottom", LOAD)])
    return chain([walls[0], beam, walls[1]], [-1e-4, 0.0])


def lifted_cantilever() -> cd.Scene:
    """A cantilever that first presses on the block below it, and that its load lifts off everywhere."""
    beam = block("beam", 1, 2, cd.Fixed("left"), loads=[cd.Pressure("top", -LOAD)])
    # There is no interference near the clamped end: no load could lift it there.
    return chain([block("lower", 0, 1, cd.Fixed("bottom")), beam], [lambda x: 1e-5 * (1 - x[0])])


def beam_over_gap() -> cd.Scene:
    """A beam of 100 : 1 held at both ends bends down over a gap until it lies on the block below."""
    mesh = cd.rectangle((0, 1), (4, 1.04), (128, 2))
    beam = cd.Body("beam", mesh, STEEL, supports=[cd.Fixed("left", "right")], loads=[cd.Pressure("top", LOAD)])
    mesh = cd.rectangle((0, 0), (4, 1), (128, 16))
    return chain([cd.Body("lower", mesh, STEEL, supports=[cd.Fixed("bottom")]), beam], [0.02])


def wedge() -> cd.Scene:
    """A wedge that stands on its corner on a flat."""
    mesh = cd.rectangle((1, 1), (3, 2), (20, 10))
    x = mesh.domain.geometry.x
    x[:, 1] += 0.1 * np.abs(x[:, 0] - 2) * (2 - x[:, 1])
    upper = cd.Body("wedge", mesh, STEEL, loads=[cd.Pressure("top", LOAD)])
    return chain([block("flat", 0, 1, cd.Fixed("bottom")), upper], [0.0])


def punch(layer: cd.Layer | cd.HardContact = LAYER) -> cd.Scene:
    """A short block on a long one: its two sharp corners press without bound as the mesh is refined."""
    mesh = cd.rectangle((1, 1), (3, 2), (22, 11))
    upper = cd.Body("punch", mesh, STEEL, loads=[cd.Pressure("top", LOAD)])
    return chain([block("flat", 0, 1, cd.Fixed("bottom")), upper], [0.0], layer)


def boxes() -> cd.Scene:
    """Three boxes in space, each turned loose on the one below, with meshes that do not match."""
    bodies = []
    for i, n in enumerate((4, 3, 5)):
        mesh = cd.box((0, 0, i), (2, 2, i + 1), (n, n, 2))
        loads = [cd.Pressure("top", LOAD)] if i == 2 else []
        bodies.append(
            cd.Body(f"box {i + 1}", mesh, STEEL, supports=[cd.Fixed("bottom")] if i == 0 else [], loads=loads)
        )
    return chain(bodies, [lambda x: 1e-4 * x[0], 0.0])


def tilted_over_edge() -> cd.Scene:
    """A block that overhangs: it rests on the first quarter of its bottom, its load's resultant acts beyond that."""
    meshes = [cd.rectangle((0, y), (4, y + 1), (32, 8)) for y in (0, 1)]
    meshes = [mesh.with_surfaces(rest=lambda x: np.isclose(x[1], 1) & (x[0] < 1.001)) for mesh in meshes]
    lower = cd.Body("lower", meshes[0], STEEL, supports=[cd.Fixed("bottom")])
    upper = cd.Body("upper", meshes[1], STEEL, loads=[cd.Pressure("top", LOAD)])
    return cd.Scene([lower, upper], [cd.Contact((lower, "rest"), (upper, "rest"), LAYER)])


def pushed_out_of_stack() -> cd.Scene:
    """Four blocks under pressure; one in the middle is pushed sideways and nothing stops it."""
    bodies = [block("1", 0, 1, cd.Fixed("bottom")), block("2", 1, 2, SIDES),
              block("3", 2, 3, loads=[cd.Traction("left", (0.1, 0.0))]),
              block("4", 3, 4, SIDES, loads=[cd.Pressure("top", LOAD)])]  # fmt: skip
    return chain(bodies, [0.0] * 3)


def unbalanced() -> cd.Scene:
    """Two floating blocks pressed together, a thousandth more from above."""
    return chain([block("lower", 0, 1, SIDES, loads=[cd.Pressure("bottom", LOAD)]),
                  block("upper", 1, 2, SIDES, loads=[cd.Pressure("top", 1.001 * LOAD)])])  # fmt: skip


def spun_box() -> cd.Scene:
    """A box pressed on another and spun about the normal of the contact."""

    def spin(x: np.ndarray) -> np.ndarray:
        return np.array([-(x[1] - 1), x[0] - 1, np.full_like(x[0], -LOAD)])

    lower = cd.Body("lower", cd.box((0, 0, 0), (2, 2, 1), (3, 3, 2)), STEEL, supports=[cd.Fixed("bottom")])
    upper = cd.Body("upper", cd.box((0, 0, 1), (2, 2, 2), (3, 3, 2)), STEEL, loads=[cd.Traction("top", spin)])
    return chain([lower, upper], [0.0])


# What is prescribed


def prescribed(*below: Any, above: Any = None, load: float | None = LOAD, layer=LAYER, gap: Any = groove) -> cd.Scene:
    """The groove, its lower body's bottom held by `below`, its upper one's top by `above` and pressed by a load."""
    loads = [] if load is None else [cd.Pressure("top", load)]
    upper = block("upper", 1, 2, *(() if above is None else (SIDES, above)), loads=loads)
    return chain([block("lower", 0, 1, *below), upper], [gap], layer)


def let_down(by: float, gap: Any = groove, layer: Any = LAYER) -> cd.Scene:
    """The top of the groove's upper body let down."""
    return prescribed(SIDES, cd.Symmetry("bottom"), above=cd.Displacement("top", [None, -by]), load=None, layer=layer,
                      gap=gap)  # fmt: skip


def moved(by: tuple[float, float], turn: float = 0.0) -> cd.Scene:
    """The groove whose bottom is moved and turned, its upper body loose on it: as if nothing had been."""
    motion = [lambda x: by[0] - turn * x[1], lambda x: by[1] + turn * x[0]]
    return prescribed(cd.Displacement("bottom", motion))


def foams() -> cd.Scene:
    """Three blocks with two foams of rubbery laws between them, pushed together by a millimetre."""
    one, two = (
        cd.TableLayer([0.01, 0.04, 0.06, 0.2], [5e-4, 1e-3, 0.01, 0.5]),
        cd.TableLayer([0.02, 0.05, 0.2], [5e-3, 5.5e-3, 0.25]),
    )
    bodies = [block("1", 0, 1, SIDES, cd.Fixed("bottom")), block("2", 1, 2, SIDES),
              block("3", 2, 3, SIDES, cd.Displacement("top", [None, -0.1]))]  # fmt: skip
    layers = zip((one, two), bodies[:-1], bodies[1:], strict=True)
    return cd.Scene(bodies, [cd.Contact((low, "top"), (high, "bottom"), layer) for layer, low, high in layers])


def out_of_reach() -> cd.Scene:
    """A block that lies loose between two others, which are not brought close enough to press it."""
    top = block("top", 2, 3, SIDES, cd.Displacement("top", [None, -1e-4]))
    return chain([block("bottom", 0, 1, cd.Fixed("bottom")), block("middle", 1, 2, SIDES), top], [0.0, 2e-4])


def faces_held() -> cd.Scene:
    """Two blocks whose contact faces are held on both sides, with an interference."""
    upper = block("upper", 1, 2, cd.Fixed("bottom"), loads=[cd.Pressure("top", LOAD)])
    return chain([block("lower", 0, 1, cd.Fixed("top", "bottom")), upper], [-1e-5])


# Laws with an end


def coating(load: float = 3000.0) -> cd.Scene:
    """The groove, a tenth of a coating's thickness deep, pressed until little of the coating is left."""
    return two_blocks(layer=cd.LogarithmicLayer(1e3, 1e-3), load=load, gap=lambda x: 0.2 * groove(x))


def own_coating(load: float) -> cd.Scene:
    """The same law given as a function, which is not a number beyond its pole."""
    layer = cd.CustomLayer(logarithmic, compression_range=9e-4)
    return two_blocks(layer=layer, load=load, gap=lambda x: 0.2 * groove(x))


def logarithmic(w: np.ndarray) -> np.ndarray:
    """g(w) = 10³ log(1 + 10³ w)."""
    with np.errstate(all="ignore"):
        return 1e3 * np.log1p(1e3 * w)


def ends(w: np.ndarray) -> np.ndarray:
    """A law measured down to w = −10⁻³, and not a number beyond."""
    return np.where(w < -1e-3, np.nan, 1e3 * w)


def without_a_law(by: float) -> cd.Scene:
    """Two held blocks with more interference than the law between them is known for."""
    bodies = [block("lower", 0, 1, cd.Fixed("bottom")), block("upper", 1, 2, cd.Fixed("top"))]
    return chain(bodies, [-by], cd.CustomLayer(ends, compression_range=1e-3))


# Loose bodies


def footing(stiffness: float, spring: float) -> cd.Scene:
    """A stiff block on a soft layer, held sideways by springs."""
    base = cd.Body("ground", cd.rectangle((-3, -1), (3, 0), (12, 2)), cd.Isotropic(stiffness, 0.0),
                   supports=[cd.Fixed("bottom")])  # fmt: skip
    foot = cd.Body("footing", cd.rectangle((-1, 0), (1, 1), (8, 4)), cd.Isotropic(stiffness, 0.0),
                   supports=[cd.Spring("top", spring * stiffness, direction=(1, 0))],
                   loads=[cd.Pressure("top", 50.0)])  # fmt: skip
    return cd.Scene([base, foot], [cd.Contact((foot, "bottom"), (base, "top"), cd.LinearLayer(1e3))])


def tower(count: int, apart: float, shift: float = 0.0) -> cd.Scene:
    """Loose blocks under their own weight, at first apart, each shifted against the one below."""
    bodies, floor = [cd.Body("ground", cd.rectangle((-2, -1), (4, 0), (12, 2)), cd.Isotropic(1e4, 0.2),
                             supports=[cd.Fixed("bottom")])], apart  # fmt: skip
    for i in range(count):
        mesh = cd.rectangle((shift * i, floor), (shift * i + 1, floor + 0.5), (4 + i % 3, 2))
        bodies.append(cd.Body(f"block {i}", mesh, cd.Isotropic(1e4, 0.2), loads=[cd.BodyForce([0.0, -1.0])]))
        floor += 0.5 + apart
    pairs = pairwise(bodies)
    return cd.Scene(bodies, [cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(1e3), search_distance=1.0)
                             for low, high in pairs])  # fmt: skip


def near_the_edge(part: float) -> cd.Scene:
    """A block of width 2 on a floor whose load acts at that part of the way from the middle to the edge."""
    lines = np.concatenate([np.linspace(-1, 0.75, 8), 1 - np.geomspace(0.25, 2e-4, 14)[1:], [1.0]])
    mesh = cd.rectangle((-1, 0), (1, 1), (lines, 4))
    load = cd.Traction("top", lambda x: np.array([0 * x[0], -5e-5 * (1 + 3 * part * x[0])]))
    foot = cd.Body("block", mesh, STEEL, loads=[load])
    floor = cd.Body("floor", cd.rectangle((-2, -1), (2, 0), (16, 4)), STEEL, supports=[cd.Fixed("bottom")])
    return cd.Scene([floor, foot], [cd.Contact((foot, "bottom"), (floor, "top"), cd.LinearLayer(1e6))])


class RigidCylinder(cd.MeshlessBody):
    """A rigid cylinder (x − 2)² / 2R above y = 1, moved up and down by a force."""

    def __init__(self, radius: float, force: float) -> None:
        super().__init__("cylinder")
        self.radius, self.force = radius, force

    def gap(self, x: np.ndarray, direction: np.ndarray) -> np.ndarray:
        return 1.0 - x[:, 1] + (x[:, 0] - 2.0) ** 2 / (2 * self.radius)

    def normal_displacement(self, x: np.ndarray, direction: np.ndarray) -> np.ndarray:
        arm = x - np.array([2.0, 1.0])
        return -np.column_stack([direction, arm[:, 0] * direction[:, 1] - arm[:, 1] * direction[:, 0]])

    def load(self) -> np.ndarray:
        return np.array([0.0, -self.force, 0.0])


def cylinder(force: float) -> cd.Scene:
    """A rigid cylinder without a mesh on a block."""
    floor, roller = block("floor", 0, 1, cd.Fixed("bottom")), RigidCylinder(1e3, force)
    return cd.Scene([floor, roller], [cd.Contact((floor, "top"), roller, LAYER)])


# Curved surfaces


def press_fit(cells: tuple[int, int]) -> cd.Scene:
    """A quarter of a shaft's ring in that of a hub, their facets unlike."""
    bodies = []
    for name, (inner, outer), count in zip(("shaft", "hub"), ((10.0, 20.0), (20.0, 30.0)), cells, strict=True):
        mesh = cd.rectangle((inner, 0), (outer, np.pi / 2), (5, count), shape="quadrilateral")
        x = mesh.domain.geometry.x
        x[:, 0], x[:, 1] = x[:, 0] * np.cos(x[:, 1]), x[:, 0] * np.sin(x[:, 1])
        bodies.append(cd.Body(name, mesh, STEEL, supports=[cd.Symmetry("bottom", "top")], kinematics="plane stress"))
    return cd.Scene(bodies, [cd.Contact((bodies[0], "right"), (bodies[1], "left"), cd.LinearLayer(1e6), gap=-0.0025)])


def pin_in_hole(order: int) -> cd.Scene:
    """A pin that lies in a larger hole under its own weight: nothing but the facets hold its rotation."""
    disc, ring = circles(order)
    pin = cd.Body("pin", disc, STEEL, loads=[cd.BodyForce([0.0, -100.0])], degree=order)
    hole = cd.Body("hole", ring, STEEL, supports=[cd.Fixed("outer")], degree=order)
    return cd.Scene([pin, hole], [cd.Contact((pin, "face"), (hole, "face"), cd.LinearLayer(1e5))])


def circles(order: int, size: float = 0.2) -> list[cd.Mesh]:
    """Gmsh's meshes of a disc of radius 1, and of a ring around it of radii 1.05 and 2."""
    import gmsh

    meshes = []
    gmsh.initialize(["x", "-v", "1"], interruptible=False)
    for inner, radius in ((0.0, 1.0), (1.05, 2.0)):
        gmsh.clear()
        gmsh.option.setNumber("Mesh.MeshSizeMax", size * (0.8 if inner else 1.0))
        occ = gmsh.model.occ
        face = occ.addDisk(0, 0, 0, radius, radius)
        if inner:
            face = occ.cut([(2, face)], [(2, occ.addDisk(0, 0, 0, inner, inner))])[0][0][1]
        occ.rotate([(2, face)], 0, 0, 0, 0, 0, 1, 0.1 if inner else 0.0)
        occ.synchronize()
        gmsh.model.addPhysicalGroup(2, [face], name="volume")
        for edge in gmsh.model.getBoundary([(2, face)], oriented=False):
            outer = max(map(abs, gmsh.model.getBoundingBox(*edge))) > 1.5
            gmsh.model.addPhysicalGroup(1, [edge[1]], name="outer" if outer else "face")
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(order)
        meshes.append(cd.from_gmsh(gmsh.model))
    gmsh.finalize()
    return meshes


# Elements


def rings(degree: int) -> cd.Scene:
    """Two rings on each other, bodies of revolution."""
    bodies = []
    for name, floor, height in (("lower", 0.0, 0.5), ("upper", 0.5, 0.8)):
        mesh = cd.rectangle((0.5, floor), (4.4, floor + height), (10, 6 if floor else 5))
        supports, loads = ([], [cd.Pressure("top", LOAD)]) if floor else ([cd.Symmetry("bottom")], [])
        bodies.append(cd.Body(name, mesh, STEEL, supports=supports, loads=loads, degree=degree,
                              kinematics="axisymmetric"))  # fmt: skip
    return chain(bodies, [lambda x: 1e-5 * x[0]])


def rubber_boxes() -> cd.Scene:
    """Two boxes of a material that hardly changes its volume."""
    bodies = []
    for i, n in enumerate((4, 3)):
        supports, loads = ([], [cd.Pressure("top", LOAD)]) if i else ([cd.Fixed("bottom")], [])
        bodies.append(cd.Body(f"box {i + 1}", cd.box((0, 0, i), (2, 2, i + 1), (n, n, 2)), cd.Isotropic(E, 0.4999),
                              supports=supports, loads=loads))  # fmt: skip
    return chain(bodies, [lambda x: 1e-5 * x[0]])


def noise(size: float) -> Callable[[np.ndarray], np.ndarray]:
    """u_n that jumps from point to point, the same in every run."""
    return lambda x: size * np.random.default_rng(1).standard_normal(x.shape[1])


def solvable() -> list[Case]:
    """All scenes with an equilibrium."""
    two = partial(partial, two_blocks)
    cases = [Case(f"E ratio {r:.0e}", two(moduli=(E, E * r))) for r in (1e-6, 1e-4, 1e-2, 1e2, 1e4, 1e6)]
    cases += [Case(f"layer {f:.0e} times as stiff", two(layer=cd.PowerLayer(B / f, A))) for f in (1e-6, 1e-3, 1e3, 1e6)]
    cases += [Case("no layer: penalty 1e12", two(layer=cd.LinearLayer(1e12)))]
    # B so that the layer gives way as much as the paper's under the load.
    cases += [Case(f"a = {a:g}", two(layer=cd.PowerLayer(B * LOAD ** (A - a), a))) for a in (0.3, 0.5, 1, 2, 3, 5, 10)]
    cases += [Case(f"nu = {nu}", two(nu=nu)) for nu in (0.49, 0.499, 0.4999)]
    cases += [Case("nu = 0.4999, quadratic", two(nu=0.4999, degree=2, cells=((16, 8), (16, 8))))]
    cases += [Case(f"load {f:.0e} times", two(load=LOAD * f)) for f in (1e-6, 1e-3, 1e3, 1e6)]
    cases += [
        Case("start from zero", two(), start=0.0),
        Case("start with all open", two(), start=-1e-3),
        Case("start 1 cm deep", two(), start=1.0),
        Case("start 1 cm apart", two(), start=-1.0),
        Case("random start", two(), start=noise(1e-3)),
        Case("slender bodies 100:1", two(heights=(0.04, 0.04), cells=((128, 2), (128, 2)))),
        Case("slender beam over a gap", beam_over_gap),
        Case("heights 1:50", two(heights=(0.05, 2.5), cells=((32, 2), (32, 40)))),
        Case("facets 1:1e6 (sliver cells)", two(grading=4.0)),
        Case("a single contact facet", single_facet),
        Case("a body between two others", between_two),
        Case("meshes 1:17", two(cells=((4, 2), (68, 4)))),
        Case("wedge: a corner on a flat", wedge),
        Case("punch: sharp corners on a flat", punch),
        Case("three loose boxes in space", boxes),
    ]
    cases += [Case(f"stack of {n}", partial(stack, n)) for n in (2, 4, 8, 16, 32, 64)]
    cases += [
        Case("first step opens everything", two(layer=cd.PowerLayer(B * LOAD ** (A - 3), 3)), start=1e-2),
        Case("contact changes to the other side", loses_contact),
        Case("all contact lost at the end", lifted_cantilever),
        Case("interference everywhere", two(gap=-1e-3), pressure=LOAD),
        Case("too far apart to touch, held", partial(held_apart, 1.0), pressure=0.0),
        Case("far apart, floating", two(gap=lambda x: 1.0 + groove(x))),
        Case("zero load", two(load=0.0), pressure=0.0),
        Case("zero load, start 1 cm deep", two(load=0.0), start=1.0, pressure=0.0),
        Case("load times 1e4, warm start", two(load=LOAD * 1e4), before=two()),
        Case("load divided by 1e4, warm start", two(), before=two(load=LOAD * 1e4)),
    ]  # fmt: skip
    return cases + prescribing() + ending() + loose() + curved() + elements() + hard()


def prescribing() -> list[Case]:
    """Settlements, rigid motions of the whole scene, faces held."""
    return [
        Case("settlement of 1e-3", partial(let_down, 1e-3)),
        Case("settlement of 1e-6", partial(let_down, 1e-6)),
        Case("settlement of soft blocks by foams", foams),
        Case("settlement that reaches nothing", out_of_reach, pressure=0.0),
        Case("whole scene moved by 10 cm", partial(moved, (10.0, 10.0))),
        Case("whole scene turned by 0.1", partial(moved, (0.0, 0.0), 0.1)),
        Case("contact faces held on both sides", faces_held),
    ]


def ending() -> list[Case]:
    """Laws with poles, with an end, with a clearance, and one that varies along the contact."""
    joint = cd.HyperbolicLayer(LOAD / 0.2, 0.2 / 19)  # closed to 95 % of it
    flat = cd.TableLayer([7.4e-6, 1.85e-5], [6.7, 9.2])

    def softening(x: np.ndarray) -> np.ndarray:
        return B * 10 ** (1.5 * x[0] - 3)

    return [
        Case("coating with 5 % left", coating),
        Case("coating as a function, 40 % gone", partial(own_coating, 500.0)),
        Case("coating pushed by 3 h on a wedge",
             partial(let_down, 3e-3, lambda x: 7e-4 * x[0], cd.LogarithmicLayer(1e3, 1e-3))),
        Case("rock joint closed to 95 %", partial(two_blocks, layer=joint, gap=0.0), pressure=LOAD),
        Case("table that ends flat, passed", partial(two_blocks, layer=flat, load=12.0)),
        Case("rough surfaces, exponential", partial(two_blocks, layer=cd.ExponentialLayer.of_separation(5.0, 1e-3))),
        Case("layer varies 1:1e6", partial(two_blocks, layer=cd.VaryingLayer(cd.PowerLayer, B=softening, a=A))),
    ]  # fmt: skip


def loose() -> list[Case]:
    """Bodies that only contacts and springs hold."""
    return [
        Case("soft springs sideways, E/k = 1e6", partial(footing, 1e9, 1e-6)),
        Case("stiff springs sideways, E/k = 1e6", partial(footing, 1e9, 1.0)),
        Case("tower of 12 loose blocks", partial(tower, 12, 0.3)),
        Case("tower that leans", partial(tower, 3, 0.0, 0.3)),
        Case("load at 0.99 of the edge", partial(near_the_edge, 0.99)),
        Case("load at 0.999 of the edge", partial(near_the_edge, 0.999)),
        Case("rigid cylinder without a mesh", partial(cylinder, LOAD)),
    ]


def curved() -> list[Case]:
    """Curved surfaces whose facets do not match."""
    return [
        Case("press fit, facets 12:17", partial(press_fit, (12, 17))),
        Case("press fit, facets 24:34", partial(press_fit, (24, 34))),
        Case("pin in a hole, straight facets", partial(pin_in_hole, 1)),
        Case("pin in a hole, curved facets", partial(pin_in_hole, 2)),
    ]


def elements() -> list[Case]:
    """Elements that multigrid finds hard."""
    return [
        Case("rings of degree 2, multigrid", partial(rings, 2), local_solver="multigrid"),
        Case("rings of degree 3, multigrid", partial(rings, 3), local_solver="multigrid"),
        Case("plane of degree 3, multigrid", partial(two_blocks, degree=3, cells=((8, 4), (8, 4))),
             local_solver="multigrid"),
        Case("nu = 0.4999 in space, multigrid", rubber_boxes, local_solver="multigrid"),
    ]  # fmt: skip


def hard() -> list[Case]:
    """Contact without a layer; its pressures are found to a millionth."""
    layer, near = cd.HardContact(), 1e-5
    return [
        Case("hard contact", partial(two_blocks, layer=layer), error=near),
        Case("hard contact, meshes 32:45", partial(two_blocks, layer=layer, cells=((32, 16), (45, 20))), error=near),
        Case("hard contact, E ratio 1e4", partial(two_blocks, layer=layer, moduli=(E, 1e4 * E)), error=near),
        Case("hard contact, settlement", partial(let_down, 1e-3, layer=layer), error=near),
        Case("hard punch", partial(punch, layer), error=near),
        Case("hard contacts in a stack of 4", partial(stack, 4, layer=layer), error=near),
        Case("mortar, penalty 1e9, meshes 32:45", partial(two_blocks, layer=cd.LinearLayer(1e9), quadrature="mortar",
                                                         cells=((32, 16), (45, 20)))),
    ]  # fmt: skip


def unsolvable() -> list[Case]:
    """Scenes without equilibrium."""
    down = cd.Pressure("top", LOAD)
    pull = [block("lower", 0, 1, SIDES, loads=[cd.Pressure("bottom", -LOAD)]),
            block("upper", 1, 2, SIDES, loads=[cd.Pressure("top", -LOAD)])]  # fmt: skip
    couple = [cd.Traction("left", (0.0, -LOAD)), cd.Traction("right", (0.0, LOAD))]
    scenes: dict[str, Callable[[], cd.Scene]] = {
        "pulled apart": lambda: chain(pull),
        "lifted off": lambda: floor_and(cd.Pressure("top", -LOAD), supports=[SIDES]),
        "lifted by its weight": lambda: floor_and(cd.BodyForce((0.0, 1.0)), supports=[SIDES]),
        "pushed through an open side": lambda: floor_and(down, cd.Traction("left", (1.0, 0.0))),
        "pushed out of a stack": pushed_out_of_stack,
        "tilted over an edge": tilted_over_edge,
        "tilted by a couple": lambda: floor_and(cd.Pressure("top", 0.1 * LOAD), *couple),
        "torque on a floating body": lambda: floor_and(*couple),
        "out of balance by a thousandth": unbalanced,
        "box spun on a box": spun_box,
        "load at 1.001 of the edge": partial(near_the_edge, 1.001),
        "tower that topples": partial(tower, 3, 0.0, 0.4),
        "rigid cylinder lifted": partial(cylinder, -LOAD),
        "hard contact pulled apart": lambda: chain(pull, layer=cd.HardContact()),
    }
    return [Case(name, build, "no equilibrium") for name, build in scenes.items()]


def lawless() -> list[Case]:
    """Scenes whose answer is beyond where a law of the user's is a number."""
    return [Case("pressed beyond what a law knows", partial(without_a_law, 3e-3), "diverged"),
            Case("pressed far beyond what a law knows", partial(without_a_law, 0.1), "diverged")]  # fmt: skip


def all_cases() -> list[Case]:
    return solvable() + unsolvable() + lawless()
