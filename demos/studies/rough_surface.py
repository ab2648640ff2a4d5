"""A rough surface on the elastic half-space, with a soft layer and without: area, mean gap and time against the force.

    python3 demos/studies/rough_surface.py [--quick] [--out DIR]

The surface is self-affine (Hurst exponent 0.8, wave numbers from 2 to an eighth of the grid's, random phases); a rigid
plate presses it onto `cd.PeriodicHalfSpace`. CPU seconds are those of one solve from nothing.
"""

from __future__ import annotations

import time

import matplotlib.pyplot as plt
import numpy as np
from results import Report

import contactdd as cd

MODULUS, HURST, ROUGHNESS = 1000.0, 0.8, 0.01
LAYERS = {"stiff layer": cd.LinearLayer(1e2 * MODULUS), "power layer, a = 1.1": cd.PowerLayer(1e-4, 1.1)}


def heights(count: int, cutoff: int, seed: int = 0) -> np.ndarray:
    """Heights (count, count) of root mean square ROUGHNESS, the same surface on every grid that holds its waves."""
    waves = np.zeros((count, count // 2 + 1), dtype=complex)
    rng = np.random.default_rng(seed)
    for i in range(-cutoff, cutoff + 1):
        for j in range(cutoff + 1):
            phase, k = np.exp(2j * np.pi * rng.random()), np.hypot(i, j)
            if 2 <= k <= cutoff and (j > 0 or i > 0):
                waves[i, j] = phase * k ** (-1 - HURST)
    surface = np.fft.irfft2(waves, s=(count, count))
    return ROUGHNESS * surface / surface.std()


def pressed(surface: np.ndarray, layer: cd.Layer | cd.HardContact, force: float) -> tuple[cd.Solution, float]:
    """The solution under a force, and the CPU seconds that it took."""
    count, gap = len(surface), cd.SurfaceHeights(surface, (1.0, 1.0), periodic=True)
    ground = cd.PeriodicHalfSpace("ground", cd.Isotropic(MODULUS, 0.0), (1.0, 1.0), (count, count))
    plate = cd.RigidBody("plate", cd.Plane((0, 0, 0), (0, 0, -1)), displacement=(0, 0, None), force=(0, 0, -force))
    began = time.process_time()
    solution = cd.solve(cd.Scene([ground, plate], [cd.Contact(ground, plate, layer, gap=gap)]), progress=False)
    return solution, time.process_time() - began


def main() -> None:
    report = Report(__file__, __doc__, quick="64 × 64 points at most")
    counts, cutoff = ((32, 64), 8) if report.quick else ((128, 256, 512), 32)
    rows, last = [], {}
    for name, layer in LAYERS.items():
        for count in counts:
            for force in (0.5, 1.5, 5.0, 15.0):
                solution, seconds = pressed(heights(count, cutoff), layer, force)
                result = last[name, force] = solution.contact()
                gap = float(result.weights @ np.maximum(result.gap, 0.0))
                row = {"layer": name, "points": count, "force": force, "area": result.area, "mean_gap": gap}
                rows.append(row | {"iterations": solution.iterations, "cpu_seconds": seconds, "sum": result.force})
                print(f"{name:22} {count}²  F {force:5.1f}  area {result.area:.4f}  gap {gap:.5f}  {seconds:.2f} s")
    figure, axes = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
    for panel, name in zip(axes, LAYERS, strict=True):
        pressure = last[name, 5.0].pressure.reshape(counts[-1], -1)
        shown = panel.imshow(pressure.T, origin="lower", extent=(0, 1, 0, 1), cmap="magma", vmax=0.5 * pressure.max())
        panel.set(title=f"{name}, F = 5", xlabel="x", ylabel="y")
        figure.colorbar(shown, ax=panel, label="pressure", shrink=0.8)
    figure.savefig(report.path("pressure.png"), dpi=150)
    report.summary(rows)
    for row in rows:
        assert abs(row["sum"] / row["force"] - 1) < 1e-8
    # The same surface on a finer grid: the layer and the grid leave a few percent of the area.
    fine, coarse = ([row["area"] for row in rows if row["points"] == count] for count in counts[-1:-3:-1])
    assert np.allclose(fine, coarse, rtol=0.15 if report.quick else 0.02)
    assert all(np.diff([row["area"] for row in rows][:4]) > 0)


if __name__ == "__main__":
    main()
