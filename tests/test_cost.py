"""The local solver that is chosen by estimated cost, what a run says of it, and multigrid that copies share."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import contactdd as cd
from contactdd.local import cost
from contactdd.local.cost import cheapest_solver

sys.path.insert(0, str(Path(__file__).parents[1] / "demos" / "studies"))
import dimple

#: Cells and the way that was measured to be quicker, by a fifth at least (demos/studies/cost_of_solvers.py).
MEASURED = {"Q:1:24:12:1": "multigrid", "Q:3:8:3:2": "condensed", "Q:4:6:2:2": "condensed", "P:1:24:10:1": "multigrid"}


def chosen(scene: cd.Scene, copies: int = 1) -> cost.Choice:
    sides = [(0, scene.interfaces[0].sides[0])]
    return cheapest_solver(scene.bodies[0], sides, copies)


@pytest.mark.parametrize("cells", MEASURED)
def test_the_quicker_way_is_chosen(cells):
    assert chosen(dimple.scene(dimple.Cells.named(cells))).solver == MEASURED[cells]


def test_what_copies_share_counts_once():
    """Condensing is shared wholly, of multigrid only the set-up: the more copies, the better condensing is."""
    scene = dimple.scene(dimple.Cells.named("Q:1:24:12:1"))
    choices = [chosen(scene, copies).solver for copies in (1, 2, 4, 8)]
    assert choices[0] == "multigrid"
    assert choices[-1] == "condensed"
    assert choices == sorted(choices, reverse=True)


def test_what_does_not_fit_is_not_factored(monkeypatch):
    scene = dimple.scene(dimple.Cells.named("Q:3:8:3:2"))
    monkeypatch.setattr(cost, "available_bytes", lambda: 2.0**20)
    choice = chosen(scene)
    assert choice.solver == "multigrid"
    assert "GiB" in choice.note


def test_a_run_says_what_was_estimated(monkeypatch):
    monkeypatch.setattr(cost, "ALWAYS_CONDENSED", 100)
    scene = dimple.scene(dimple.Cells.named("Q:1:6:3:1"))
    solution = cd.solve(scene)
    assert "condensed for 'lower', estimated condensed" in solution.history[0].note
    asked = cd.solve(dimple.scene(dimple.Cells.named("Q:1:4:2:1")), local_solver="condensed")
    assert "estimated" not in asked.history[0].note


def mirrored(cells: dimple.Cells) -> cd.Scene:
    """The dimple's blocks as mirror images."""
    x, z = cells.ends
    mesh = cd.box((0, 0, -0.5), (1, 1, 0), (x, x, -z[::-1]), shape=cells.shape)
    sides, loads = [cd.Symmetry("left", "right", "front", "back")], [cd.Pressure("bottom", 10)]
    meshes = mesh, mesh.mirrored("z", 0.0)
    lower, upper = (
        cd.Body(name, each, dimple.STEEL, supports=sides, loads=loads, degree=cells.degree)
        for name, each in zip(("lower", "upper"), meshes, strict=True)
    )
    return cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "top"), dimple.LAYER, gap=dimple.gap)])


@pytest.mark.parametrize("method", ["auto", "chord"])
def test_copies_share_a_multigrid(method):
    """One set-up for both, and the answer of two."""
    scene = mirrored(dimple.Cells.named("Q:1:6:3:1"))
    options = {"gamma": 0.6, "tolerance": 1e-8} if method == "chord" else {}
    shared = cd.solve(scene, method, local_solver="multigrid", **options)
    made = [problem._robin._own for problem in scene.local_problems("multigrid")]
    assert [each is not None for each in made] == [True, False]
    apart = cd.solve(scene, local_solver="condensed")
    assert np.abs(shared.contact().pressure - apart.contact().pressure).max() < 1e-6 * apart.contact().peak_pressure
