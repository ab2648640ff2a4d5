"""Hard scenes by name, solvable and not: what `hard_cases.py` and the tests give to every method.

Lengths in cm, stresses in MPa. Where nothing else is said a scene is the paper's groove between two steel blocks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
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

    build: makes it; solvable: whether it has an equilibrium; start: u_n or a function of x to start from; before: makes
    the scene whose solution is the start; pressure: the uniform contact pressure where it is known in closed form.
    """

    name: str
    build: Callable[[], cd.Scene]
    solvable: bool = True
    start: Any = None
    before: Callable[[], cd.Scene] | None = None
    pressure: float | None = None


def groove(x: np.ndarray) -> np.ndarray:
    """The paper's d(x)."""
    return 5e-4 * np.maximum(1 - x[0] ** 2, 0) ** 1.5


def two_blocks(
    *,
    moduli: tuple[float, float] = (E, E),
    nu: float = NU,
    layer: cd.Layer = LAYER,
    load: float = LOAD,
    heights: tuple[float, float] = (1.0, 1.0),
    cells: tuple[tuple[int, int], tuple[int, int]] = ((32, 16), (32, 16)),
    gap: Any = groove,
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
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), layer, gap=gap)])


def stack(count: int, cells: tuple[int, int] = (16, 8)) -> cd.Scene:
    """Floating blocks of unlike stiffness and height on each other, a groove in each contact."""
    bodies, floor = [], 0.0
    for i in range(count):
        height = 1.0 + 0.3 * (i % 2)
        loads = [cd.Pressure("bottom", LOAD)] if i == 0 else [cd.Pressure("top", LOAD)] if i == count - 1 else []
        mesh = cd.rectangle((0, floor), (4, floor + height), cells)
        bodies.append(cd.Body(f"block {i + 1}", mesh, cd.Isotropic(E * (1 + i % 3), NU), supports=[SIDES], loads=loads))
        floor += height
    return chain(bodies)


def chain(bodies: Sequence[cd.Body], gaps: Sequence[Any] | None = None) -> cd.Scene:
    """Each body's top on the next one's bottom."""
    pairs = zip(bodies[:-1], bodies[1:], gaps or [groove] * (len(bodies) - 1), strict=True)
    return cd.Scene(bodies, [cd.Contact((low, "top"), (high, "bottom"), LAYER, gap=gap) for low, high, gap in pairs])


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


def punch() -> cd.Scene:
    """A short block on a long one: its two sharp corners press without bound as the mesh is refined."""
    mesh = cd.rectangle((1, 1), (3, 2), (22, 11))
    upper = cd.Body("punch", mesh, STEEL, loads=[cd.Pressure("top", LOAD)])
    return chain([block("flat", 0, 1, cd.Fixed("bottom")), upper], [0.0])


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
    return cases


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
    }
    return [Case(name, build, solvable=False) for name, build in scenes.items()]


def all_cases() -> list[Case]:
    return solvable() + unsolvable()
