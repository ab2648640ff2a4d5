"""A rough surface pressed on the periodic half-space by Tamaas: run by a Python that has it, which need not be ours.

    python3 with_tamaas.py HEIGHTS.npy PRESSURES.npy FORCE COMPLIANCE

COMPLIANCE is that of a linear layer, 0 for none; prints the CPU seconds, the pressures' error as Tamaas tells it, and
how often it asked for the layer.
"""

from __future__ import annotations

import json
import sys
import time

import numpy as np
import tamaas as tm


class LinearLayer(tm.Functional):
    """The complementary energy ½ ∫ c p² of a layer that is compressed by c p."""

    def __init__(self, compliance: float) -> None:
        super().__init__()
        self.compliance, self.calls = compliance, 0

    def computeF(self, pressure, *rest):
        return float(0.5 * self.compliance * np.sum(pressure**2)) / pressure.size

    def computeGradF(self, pressure, gradient):
        self.calls += 1
        gradient += self.compliance * pressure


def main(heights: str, pressures: str, force: str, compliance: str) -> None:
    tm.set_log_level(tm.LogLevel.error)
    tm.initialize(1)
    surface, layer = np.load(heights), LinearLayer(float(compliance))
    began = time.process_time()
    model = tm.ModelFactory.createModel(tm.model_type.basic_2d, [1.0, 1.0], list(surface.shape))
    model.E, model.nu = 1000.0, 0.0
    solver = tm.PolonskyKeerRey(model, surface, 1e-10)
    solver.max_iter = 5000
    if layer.compliance:
        solver.addFunctionalTerm(layer)
    error = solver.solve(float(force))
    seconds = time.process_time() - began
    np.save(pressures, np.asarray(model.traction))
    print(json.dumps({"cpu_seconds": seconds, "error": float(error), "calls": layer.calls}))


if __name__ == "__main__":
    main(*sys.argv[1:])
