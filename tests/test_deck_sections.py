"""Several *SOLID SECTIONs of one material in a body, of sets that overlap, are that material once."""

from __future__ import annotations

import pytest
from test_deck_scene import E, M, cubes

import contactdd as cd

LINEAR = "PRESSURE-OVERCLOSURE=LINEAR\n1.E7,\n"
SECTION = "*SOLID SECTION, ELSET=LOWER, MATERIAL=STEEL\n"
WEIGHT = "*DLOAD\nUPPER, P1, -25.\nLOWER, GRAV, 3., 0, 0, -1\n"


def test_one_material_twice(tmp_path):
    """Weight, which needs one density, and the force, as with one section."""
    deck = cubes(LINEAR, WEIGHT)
    once = cd.solve(cd.read_scene(deck.write(tmp_path)))
    deck.text = deck.text.replace(SECTION, f"*ELSET, ELSET=AGAIN\n1\n{SECTION}{SECTION.replace('LOWER', 'AGAIN')}")
    twice = cd.solve(cd.read_scene(deck.write(tmp_path)))
    assert twice.contact().force == pytest.approx(once.contact().force, rel=1e-12)
    assert twice.forces("LOWER")["loads"][2] == pytest.approx(-6.0, rel=1e-12)
    assert twice.scene.bodies[0].material == cd.Isotropic(E, 0.3)
    sag = 0.5 * 6.0 / M  # of one trilinear cell, which lowers the lower surface
    force = (1 - 0.2 * M * sag) / (1 + 0.2 * M * (1 / M + 1 / 4e5))  # F = k₁ u₁ = k (u₂ − u₁ − sag), 1 = F + k₂ u₂
    assert once.contact().force == pytest.approx(force, rel=1e-6)


def test_two_materials_on_the_same_cells_are_refused(tmp_path):
    deck = cubes(LINEAR, "*DLOAD\nUPPER, P1, -25.\n")
    soft = "*MATERIAL, NAME=SOFT\n*ELASTIC\n1000., 0.3\n*SOLID SECTION, ELSET=AGAIN, MATERIAL=SOFT\n"
    deck.text = deck.text.replace(SECTION, f"{SECTION}*ELSET, ELSET=AGAIN\n1\n{soft}")
    with pytest.raises(ValueError, match="in another subdomain, too"):
        cd.read_scene(deck.write(tmp_path))
