"""The demo of a block with turned fibres: its numbers and pictures."""

from __future__ import annotations

import pytest
from test_demos import run

# Two meshes that are mirror images to rounding, Newton to 1e-11 of the forces.
MIRROR = 1e-9


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("anisotropic")


@pytest.fixture(scope="module")
def summary(folder):
    return run("anisotropic", folder)


def test_fibres_alone_make_the_pressure_lean(summary):
    assert summary["asymmetry_angle_0"] < MIRROR
    assert summary["angles"][-1]["lean"] < MIRROR  # 90°
    assert summary["asymmetry"] > 0.1


def test_the_mirrored_angle_mirrors_the_pressure(summary):
    assert summary["mirror_difference"] < MIRROR


def test_forces_balance(summary):
    assert summary["force_balance"] < 1e-9  # the programme's tolerance is 1e-11; the steel is 1000 times the wood


def test_wood_is_stiffer_the_steeper_its_fibres(summary):
    forces = [row["force"] for row in summary["angles"]]
    assert forces == sorted(forces)
    # The moduli along and across stand as 12 to 1; between them are the layer and the edges.
    assert 4 < forces[-1] / forces[0] < 12


def test_pictures_are_drawn(folder, summary):
    for name in ("pressure.png", "paths.png", "bodies.png"):
        assert (folder / name).stat().st_size > 10_000
