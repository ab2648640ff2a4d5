"""Amplitudes of decks: what counts is the load at the end of the last step."""

from __future__ import annotations

import shutil
import subprocess

import numpy as np
import pytest
from test_deck_scene import Deck, M, cubes, rings

import contactdd as cd

LINEAR = "PRESSURE-OVERCLOSURE=LINEAR\n1.E7,\n"


def with_amplitude(deck: Deck, amplitude: str, static: str = "", last: str = "") -> Deck:
    """A deck with *AMPLITUDE, NAME=A before its first step, the step's times, and another step."""
    deck.text = deck.text.replace("*STEP\n*STATIC\n", f"*AMPLITUDE, NAME=A{amplitude}\n*STEP\n*STATIC\n{static}")
    return deck.add(last)


NEXT = "*STEP\n*STATIC\n0.5, 3.\n*END STEP\n"

#: Amplitudes, times of the step, and a second step, in which the first step's load is a quarter of what is given.
QUARTERS = {
    "its end": ("\n0., 0., 1., 0.25\n", "", ""),
    "between": ("\n0., 0., 2., 0.5\n", "0.1, 1.\n", ""),
    "beyond": ("\n0., 1.\n0.5, 0.25", "", ""),
    "four pairs in a line": ("\n0., 1., 0.1, 2., 0.2, 3., 0.3, 4.\n2., 0.25", "1., 2.\n", ""),
    "up and down": ("\n0., 0., 2., 1., 4., 0.25\n", "0.1, 4.\n", ""),
    "shifted": (", SHIFTX=1., SHIFTY=-0.75\n0., 0., 1., 1.\n", ", 2.\n", ""),
    "kept by a later step": ("\n0., 0., 1., 0.25, 3., 7.\n", "", NEXT),
    "total time": (", TIME=TOTAL TIME\n0., 0., 4., 0.25\n", ", 4.\n", ""),
    "total time of two steps": (", TIME=TOTAL TIME\n0., 9., 3., 9., 4., 0.25\n", "", NEXT),
}


@pytest.mark.parametrize(("amplitude", "static", "last"), QUARTERS.values(), ids=QUARTERS)
@pytest.mark.parametrize(
    "load", ["*DLOAD, AMPLITUDE=A\nUPPER, P1, -100.\n", "*CLOAD, AMPLITUDE=A\nUPPER_BELOW, 3, -1.\n"]
)
def test_a_quarter_of_the_load(tmp_path, load, amplitude, static, last):
    """1 = F + k₂ u₂, F = k₁ u₁ = k (u₂ − u₁), as without an amplitude."""
    deck = with_amplitude(cubes(LINEAR, load), amplitude, static, last)
    series = 1 / (1 / M + 1 / 4e5)
    solution = cd.solve(cd.read_scene(deck.write(tmp_path)))
    assert solution.contact().force == pytest.approx(series / (series + 0.2 * M), rel=1e-6)


def test_displacements_and_weights(tmp_path):
    """A lid pushed down by half of 1e-4; a third of the gravity that is given."""
    loads = "*BOUNDARY, AMPLITUDE=A\nUPPER_ABOVE, 3, 3, -1.E-4\n*DLOAD, AMPLITUDE=B\nLOWER, GRAV, 9., 0, 0, -1\n"
    tables = "\n0., 0., 2., 1.\n*AMPLITUDE, NAME=B\n0., 0., 3., 1.\n"
    solution = cd.solve(cd.read_scene(with_amplitude(cubes(LINEAR, loads), tables).write(tmp_path)))
    sag = 0.5 * 6.0 / M  # of one trilinear cell, which lowers the lower surface
    assert solution.forces("LOWER")["loads"][2] == pytest.approx(-6.0, rel=1e-12)
    force = (5e-5 - sag) / (1 / M + 1 / (0.2 * M) + 1 / 4e5)
    assert solution.contact().force == pytest.approx(force, rel=1e-6)


def test_temperatures(tmp_path):
    """Case 4's rings, whose inner one is heated by 727 K above 20: half of what is given."""
    deck = rings((0.95, 1.05), (1.05, 1.15))
    deck.add("*NSET, NSET=HOT, GENERATE\n1, 18, 1\n*NSET, NSET=COLD, GENERATE\n19, 36, 1\n")
    deck.add("*INITIAL CONDITIONS, TYPE=TEMPERATURE\nHOT, 20.\nCOLD, 20.\n*AMPLITUDE, NAME=A\n0., 0., 1., 0.5\n")
    deck.add("*STEP\n*STATIC\n*TEMPERATURE, AMPLITUDE=A\nHOT, 1494.\nCOLD, 40.\n*END STEP\n")
    np.testing.assert_allclose(cd.solve(cd.read_scene(deck.write(tmp_path))).contact().pressure, 86.9595, rtol=1e-4)


@pytest.mark.parametrize(
    ("amplitude", "words"),
    [
        (", DEFINITION=PERIODIC\n1, 2., 0., 0.\n0., 1.\n", r"\*AMPLITUDE, DEFINITION or VALUE"),
        (", VALUE=ABSOLUTE\n0., 0., 1., 1.\n", r"\*AMPLITUDE, DEFINITION or VALUE"),
        ("B\n0., 0., 1., 1.\n", "there is no \\*AMPLITUDE 'A' before it"),
        ("\n0., 0., 1.\n", r"\*AMPLITUDE that cannot be read"),
    ],
)
def test_what_is_not_understood(tmp_path, amplitude, words):
    deck = with_amplitude(cubes(LINEAR, "*DLOAD, AMPLITUDE=A\nUPPER, P1, -25.\n"), amplitude)
    with pytest.raises(ValueError, match=words):
        cd.read_scene(deck.write(tmp_path))


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
@pytest.mark.parametrize("time", ["", ", TIME=TOTAL TIME"])
def test_calculix_means_the_same(tmp_path, time):
    """The force at the end of a second step of twice the length, by the reactions of the floor."""
    told = "*NODE PRINT, NSET=LOWER_BELOW, TOTALS=ONLY\nRF\n"
    deck = cubes(LINEAR, f"*CLOAD, AMPLITUDE=A\nUPPER_BELOW, 3, -0.25\n{told}")
    deck.text = deck.text.replace("1.E7,\n", "1.E7, 3.\n").replace(
        "NODE TO SURFACE\nSLAVE", "SURFACE TO SURFACE\nBELOW"
    )
    last = f"*STEP\n*STATIC\n2., 2.\n{told}*END STEP\n"
    path = with_amplitude(deck, f"{time}\n0., 0., 2., 1., 3., 0.2\n", "1., 1.\n", last).write(tmp_path)
    subprocess.run(["ccx", path.stem], cwd=tmp_path, check=True, capture_output=True, timeout=60)
    totals = (tmp_path / "deck.dat").read_text().split("total force")[-1].split("\n\n")[1]
    # The file has seven digits.
    assert cd.solve(cd.read_scene(path)).contact().force == pytest.approx(float(totals.split()[2]), rel=1e-6)
