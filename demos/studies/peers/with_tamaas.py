"""A rough surface pressed on the periodic half-space by Tamaas: run by a Python that has it, which need not be ours.

    python3 with_tamaas.py HEIGHTS.npy PRESSURES.npy FORCE B A

A layer under the pressure p is compressed by B pᴬ, none if B = 0; prints the CPU seconds, the pressures' error as
Tamaas tells it, and how often it asked for the layer.
"""

from __future__ import annotations

import json
import sys
import time

import numpy as np
import tamaas as tm


class PowerLayer(tm.Functional):
    """The complementary energy ∫ B p^(a + 1) / (a + 1) of a layer that is compressed by B p^a."""

    def __init__(self, B: float, a: float) -> None:
        super().__init__()
        self.B, self.a, self.calls = B, a, 0

    def computeF(self, pressure, *rest):
        return float(self.B / (self.a + 1) * np.sum(np.maximum(pressure, 0.0) ** (self.a + 1))) / pressure.size

    def computeGradF(self, pressure, gradient):
        self.calls += 1
        gradient += self.B * np.maximum(pressure, 0.0) ** self.a  # its steps go below 0 before they are cut


def main(heights: str, pressures: str, force: str, B: str, a: str) -> None:
    tm.set_log_level(tm.LogLevel.error)
    tm.initialize(1)
    surface, layer = np.load(heights), PowerLayer(float(B), float(a))
    began = time.process_time()
    model = tm.ModelFactory.createModel(tm.model_type.basic_2d, [1.0, 1.0], list(surface.shape))
    model.E, model.nu = 1000.0, 0.0
    solver = tm.PolonskyKeerRey(model, surface, 1e-8)
    solver.max_iter = 5000
    if layer.B:
        solver.addFunctionalTerm(layer)
    error = solver.solve(float(force))
    seconds = time.process_time() - began
    np.save(pressures, np.asarray(model.traction))
    print(json.dumps({"cpu_seconds": seconds, "error": float(error), "calls": layer.calls}))


if __name__ == "__main__":
    main(*sys.argv[1:])
