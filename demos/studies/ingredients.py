"""What each ingredient of a scene costs: imports, compiled forms, memory and CPU time, each in a process of its own.

    python3 demos/studies/ingredients.py [--quick] [--out DIR]

The first table is the paper's groove told in ever cheaper ways, and with other layers; the block is the same. Imports
are the modules of contactdd beyond those of the first row; forms those that an empty cache has to compile; memory is
the growth of the process from the imports to the end; CPU seconds those of a scene from its meshes to its solution,
the least of ten. The second table is a rigid cylinder on the ground, which is the half-plane or a block of elements
twenty contacts wide and deep: the CPU seconds for the same error of the pressure.
"""

from __future__ import annotations

import json
import resource
import sys
import tempfile
import time
from collections.abc import Callable

import numpy as np
from own_process import in_own_process
from results import Report

import contactdd as cd

MATERIAL, OTHER, LOAD = cd.Isotropic(E=2.1e5, nu=0.3), cd.Isotropic(E=2.0e5, nu=0.3), 10.0


def gap(x: np.ndarray) -> np.ndarray:
    return 5e-4 * np.maximum(1 - x[0] ** 2, 0) ** 1.5


def block(name: str, floor: float, loaded: str, material: cd.Isotropic = MATERIAL, diagonal: str = "right") -> cd.Body:
    mesh = cd.rectangle((0, floor), (4, floor + 1), (32, 16), diagonal=diagonal)
    return cd.Body(name, mesh, material, supports=[cd.Symmetry("left", "right")], loads=[cd.Pressure(loaded, LOAD)])


def pair(layer: cd.Layer | cd.HardContact, material: cd.Isotropic = OTHER) -> cd.Scene:
    low, high = block("low", 0, "bottom"), block("high", 1, "top", material, "left")
    return cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), layer, gap=gap)])


def against(partner: cd.MeshlessBody) -> cd.Scene:
    high = block("high", 0, "top", diagonal="left")
    return cd.Scene([partner, high], [cd.Contact((high, "bottom"), partner, cd.PowerLayer(4e-6, 1.1), gap=gap)])


def table() -> cd.Layer:
    return cd.TableLayer([2e-5, 5e-5, 1e-4], [4.0, 12.0, 40.0])


#: The groove in ever cheaper ways, then with other layers.
SCENES: dict[str, Callable[[], cd.Scene]] = {
    "two bodies": lambda: pair(cd.PowerLayer(4e-6, 1.1)),
    "mirror images": lambda: pair(cd.PowerLayer(4e-6, 1.1), MATERIAL),
    "half model, mirror plane": lambda: against(cd.MirrorPlane("mirror", (0, 0), (0, 1))),
    "on a rigid plane": lambda: against(cd.RigidBody("floor", cd.Plane((0, 0), (0, 1)))),
    "on the half-plane": lambda: against(cd.HalfPlane("ground", OTHER, np.linspace(0, 4, 33), 100.0)),
    "two bodies, hard contact": lambda: pair(cd.HardContact()),
    "two bodies, table": lambda: pair(table()),
    "two bodies, gasket": lambda: pair(cd.GasketLayer(table(), 1e6)),
    "two bodies, bonded": lambda: pair(cd.BondedLayer(cd.PowerLayer(4e-6, 1.1))),
    "two bodies, bonded with shear": lambda: pair(cd.BondedLayer(cd.PowerLayer(4e-6, 1.1), shear_stiffness=1e5)),
}


def measure(name: str) -> None:
    """Print what one scene costs as JSON: run in a process of its own."""
    import ffcx.codegeneration.jit as jit

    compiled, compile_forms = [], jit.compile_forms

    def counting(forms, *arguments, **options):
        compiled.extend(forms)
        return compile_forms(forms, *arguments, **options)

    jit.compile_forms = counting
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    solution = cd.solve(SCENES[name](), progress=False)
    memory, seconds = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before, []
    for _ in range(10):
        began = time.process_time()
        cd.solve(SCENES[name](), progress=False)
        seconds.append(time.process_time() - began)
    modules = sorted(module for module in sys.modules if module.startswith("contactdd."))
    numbers = {"modules": modules, "forms": len(compiled), "memory_mb": memory / 1024, "cpu_ms": 1e3 * min(seconds)}
    print(json.dumps(numbers | {"unknowns": solution._ensemble.size, "peak": solution.contact().peak_pressure}))


def costs(names: list[str]) -> dict[str, dict]:
    """The numbers of each scene, with an empty cache of compiled forms; printed as a table."""
    rows: dict[str, dict] = {}
    print(f"{'':30} imports  forms  memory (MB)  CPU (ms)  unknowns  peak pressure")
    for name in names:
        with tempfile.TemporaryDirectory() as cache:
            row = in_own_process(__file__, name, environment={"XDG_CACHE_HOME": cache})
        base = set(rows[names[0]]["modules"]) if rows else set(row["modules"])
        row["own"] = sorted(set(row["modules"]) - base)
        rows[name] = row
        print(
            f"{name:30} {len(row['own']):7} {row['forms']:6} {row['memory_mb']:12.1f} {row['cpu_ms']:9.2f} "
            f"{row['unknowns']:9} {row['peak']:14.4f}"
        )
    return rows


# ---- the half-plane beside a meshed foundation

RADIUS, FORCE, STIFF = 100.0, 10.0, cd.LinearLayer(2e5)
GROUND = cd.Isotropic(E=1000.0, nu=0.3)
#: Hertz' half-width, for sizes only.
HALF_WIDTH = float(np.sqrt(4 * FORCE * RADIUS * (1 - 0.3**2) / (np.pi * 1000.0)))


def tool() -> cd.RigidBody:
    shape = cd.Cylinder((0, RADIUS), RADIUS)
    return cd.RigidBody("tool", shape, displacement=(0, None), force=(0, -FORCE))


def on_half_plane(nodes: int) -> cd.Scene:
    ground = cd.HalfPlane("ground", GROUND, np.linspace(-1.5, 1.5, nodes) * HALF_WIDTH, 100 * HALF_WIDTH)
    cylinder = tool()
    return cd.Scene([ground, cylinder], [cd.Contact(ground, cylinder, STIFF)])


def on_elements(cells: int) -> cd.Scene:
    """A symmetric half would be cheaper by two in both cases: neither takes it."""
    inner = np.linspace(0, 1.5, cells)
    outer = np.geomspace(1.5, 20, 2 + int(np.log(20 / 1.5) / np.log(1 + 4 / cells)))
    side = np.concatenate([inner[:-1], outer]) * HALF_WIDTH
    across = np.concatenate([-side[:0:-1], side])
    mesh = cd.rectangle((-side[-1], -side[-1]), (side[-1], 0), (across, -side[::-1]), shape="quadrilateral")
    ground, cylinder = cd.Body("ground", mesh, GROUND, supports=[cd.Fixed("bottom")], degree=2), tool()
    return cd.Scene([ground, cylinder], [cd.Contact((ground, "top"), cylinder, STIFF)])


def compared(accuracy: float) -> dict[str, dict[str, float]]:
    """The CPU seconds of both grounds at the first of ever finer ones whose pressure is accurate enough.

    The truth is the half-plane with 801 nodes; the error is that of p in L² over the contact, relative.
    """
    exact = cd.solve(on_half_plane(801), progress=False).contact()
    places = np.linspace(-0.95, 0.95, 191) * HALF_WIDTH
    truth, found = np.interp(places, exact.x[:, 0], exact.pressure), {}
    for name, make, sizes in (
        ("half-plane", on_half_plane, (11, 15, 21, 31, 37, 41, 61, 81)),
        ("elements", on_elements, (4, 6, 8, 11, 13, 15, 17, 19, 21, 31)),
    ):
        for size in sizes:
            seconds = []
            for _ in range(4):
                began = time.process_time()
                solution = cd.solve(make(size), progress=False)
                seconds.append(time.process_time() - began)
            result = solution.contact().sorted()
            p = np.interp(places, result.x[:, 0], result.pressure)
            error = float(np.sqrt(np.sum((p - truth) ** 2) / np.sum(truth**2)))
            if error <= accuracy:
                break
        found[name] = {"size": size, "error": error, "cpu_ms": 1e3 * min(seconds), "unknowns": solution._ensemble.size}
        print(f"{name:12} size {size:4}  error of p {error:.4f}  CPU {found[name]['cpu_ms']:.2f} ms")
    return found


def main() -> None:
    if sys.argv[1:2] == ["--case"]:
        measure(sys.argv[2])
        return
    report = Report(__file__, __doc__, quick="three of the scenes, and less accuracy")
    names = [name for i, name in enumerate(SCENES) if not report.quick or i in (0, 4, 9)]
    rows = costs(names)
    accuracy = 0.05 if report.quick else 0.01
    print(f"\na rigid cylinder on the ground, the pressure to {accuracy:.0%}")
    ground = compared(accuracy)
    ratio = ground["elements"]["cpu_ms"] / ground["half-plane"]["cpu_ms"]
    print(f"the half-plane is {ratio:.1f} times cheaper")
    report.summary({"scenes": rows, "ground": ground, "ratio": ratio})
    first = rows[names[0]]
    # What a scene does not use is not there: no layer beside the paper's, no partner, no shape.
    foreign = ("contactdd.layers", "contactdd.partners", "contactdd.shapes", "contactdd.interface.sliding")
    assert not [module for module in first["modules"] if module.startswith(foreign)]
    # Each ingredient brings modules of its own kind only, and no form beyond those of a body's load and stiffness.
    for row in rows.values():
        allowed = (*foreign, "contactdd.iteration.augmented", "contactdd.base.", "contactdd.local.")
        assert all(module.startswith(allowed) for module in row["own"]), row["own"]
        assert row["forms"] <= first["forms"]
    if not report.quick:
        peaks = [rows[name]["peak"] for name in ("mirror images", "half model, mirror plane")]
        assert abs(peaks[0] / peaks[1] - 1) < 1e-8
    assert all(ground[name]["error"] <= accuracy for name in ground)


if __name__ == "__main__":
    main()
