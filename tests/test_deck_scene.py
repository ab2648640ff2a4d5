"""Scenes from decks: CalculiX' cases of rings and blocks, written here, against its answers and closed forms."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import contactdd as cd

E, NU = 2.1e5, 0.3
ELASTIC = f"*ELASTIC\n{E}, {NU}\n"


class Deck:
    """A deck that is written piece by piece."""

    def __init__(self) -> None:
        self.nodes: list[tuple[int, np.ndarray]] = []
        self.text = ""

    def node(self, x) -> int:
        self.nodes.append((len(self.nodes) + 1, np.array([*x, 0.0][:3])))
        return self.nodes[-1][0]

    def on(self, where) -> str:
        """The numbers of the nodes that lie somewhere, as lines."""
        return "\n".join(f"{number}," for number, x in self.nodes if where(x)) + "\n"

    def add(self, text: str) -> Deck:
        self.text += text
        return self

    def write(self, folder: Path) -> Path:
        path = folder / "deck.inp"
        nodes = "".join(f"{number}, {x[0]:.15g}, {x[1]:.15g}, {x[2]:.15g}\n" for number, x in self.nodes)
        path.write_text("*NODE\n" + nodes + self.text)
        return path


def ring(deck: Deck, name: str, first: int, r0: float, r1: float, cells: int = 3, height: float = 0.1) -> None:
    """A ring of CAX8 in one row, its faces S4 inside and S2 outside."""
    n = 2 * cells + 1
    grid = {
        (i, j): deck.node((r0 + (r1 - r0) * i / (n - 1), height * j / 2))
        for j in range(3)
        for i in range(n)
        if not (i % 2 and j % 2)
    }
    corners = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    deck.add(f"*ELEMENT, TYPE=CAX8, ELSET={name}\n")
    for e in range(cells):
        deck.add(", ".join(str(k) for k in [first + e, *(grid[2 * e + i, j] for i, j in corners)]) + "\n")
    deck.add(f"*SURFACE, NAME={name}_IN\n{first}, S4\n*SURFACE, NAME={name}_OUT\n{first + cells - 1}, S2\n")


def rings(inner: tuple[float, float], outer: tuple[float, float], tail: str = "") -> Deck:
    deck = Deck()
    ring(deck, "INNER", 1, *inner)
    ring(deck, "OUTER", 101, *outer)
    deck.add(f"*NSET, NSET=FLOOR\n{deck.on(lambda x: x[1] == 0)}")
    deck.add(f"*MATERIAL, NAME=STEEL\n{ELASTIC}*EXPANSION\n12.E-6\n")
    deck.add("*SOLID SECTION, ELSET=INNER, MATERIAL=STEEL\n*SOLID SECTION, ELSET=OUTER, MATERIAL=STEEL\n")
    deck.add("*SURFACE INTERACTION, NAME=SI\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1.E7,\n")
    deck.add("*CONTACT PAIR, INTERACTION=SI, TYPE=SURFACE TO SURFACE\nINNER_OUT, OUTER_IN\n")
    return deck.add("*BOUNDARY\nFLOOR, 2, 2\n" + tail)


def radial(solution: cd.Solution, body: str, r: float) -> float:
    return float(solution.displacement_at(body, [[r, 0.05]])[0, 0])


def test_press_fitted_rings(tmp_path):
    """Case 4, ring2: CalculiX' own radial displacements at mid height, and Lamé's pressure with the layer."""
    deck = rings((0.9501, 1.0501), (1.05, 1.15), "*STEP\n*STATIC\n*NODE PRINT, NSET=FLOOR\nU\n*END STEP\n")
    scene = cd.read_scene(deck.write(tmp_path))
    assert [body.name for body in scene.bodies] == ["INNER", "OUTER"]
    assert {body.kinematics.name for body in scene.bodies} == {"axisymmetric"}
    solution = cd.solve(scene)
    # Another program and its penalty: they agree to 5e-4.
    assert radial(solution, "INNER", 1.0501 - 1e-9) == pytest.approx(-4.615912e-5, rel=5e-4)
    assert radial(solution, "INNER", 0.9501 + 1e-9) == pytest.approx(-4.734676e-5, rel=5e-4)
    assert radial(solution, "OUTER", 1.05 + 1e-9) == pytest.approx(5.373072e-5, rel=5e-4)
    assert radial(solution, "OUTER", 1.15 - 1e-9) == pytest.approx(5.209029e-5, rel=5e-4)
    np.testing.assert_allclose(solution.contact("INNER_OUT-OUTER_IN").pressure, 0.948757, rtol=5e-4)


def test_heated_ring(tmp_path):
    """Case 4, ring1: p = 86.9595 by Lamé; the deck's large rotations are refused until they are to be left out."""
    deck = rings((0.95, 1.05), (1.05, 1.15))
    deck.add(f"*NSET, NSET=HOT\n{deck.on(lambda x: x[0] <= 1.05)}")  # the outer ring's bore, too, which is set later
    outer = [n for n, x in deck.nodes][len(deck.nodes) // 2 :]
    deck.add(f"*NSET, NSET=ALL_OUTER, GENERATE\n{outer[0]}, {outer[-1]}, 1\n")
    deck.add("*INITIAL CONDITIONS, TYPE=TEMPERATURE\nHOT, 20.\nALL_OUTER, 20.\n")
    deck.add("*STEP, NLGEOM\n*STATIC\n*TEMPERATURE\nHOT, 747.\nALL_OUTER, 20.\n*END STEP\n")
    path = deck.write(tmp_path)
    with pytest.raises(ValueError, match=r"not understood here: \*STEP, NLGEOM"):
        cd.read_scene(path)
    solution = cd.solve(cd.read_scene(path, ignore=["STEP, NLGEOM"]))
    # Three elements of degree 2 across the ring.
    np.testing.assert_allclose(solution.contact().pressure, 86.9595, rtol=1e-4)


def cube(deck: Deck, name: str, number: int, low, high) -> None:
    """A C3D8, its faces S1 below and S2 above."""
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    nodes = [deck.node([(low, high)[bit][axis] for axis, bit in enumerate(c)]) for c in corners]
    deck.add(f"*ELEMENT, TYPE=C3D8, ELSET={name}\n{number}, {', '.join(map(str, nodes))}\n")
    deck.add(f"*NSET, NSET={name}_ALL\n{', '.join(map(str, nodes))}\n")
    for face, part in (("BELOW", nodes[:4]), ("ABOVE", nodes[4:])):
        deck.add(f"*NSET, NSET={name}_{face}\n{', '.join(map(str, part))}\n")


def cubes(behaviour: str, load: str, *, lid: tuple[float, float] = (1.0, 1.2)) -> Deck:
    """A block of 0.2 on a cube of 1, sideways held everywhere, both held at their far ends."""
    deck = Deck()
    cube(deck, "LOWER", 1, (0, 0, 0), (1, 1, 1))
    cube(deck, "UPPER", 2, (0.4, 0.4, lid[0]), (0.6, 0.6, lid[1]))
    deck.add("*SURFACE, NAME=MASTER\nLOWER, S2\n*SURFACE, NAME=SLAVE, TYPE=NODE\nUPPER_BELOW,\n")
    deck.add("*SURFACE, NAME=BELOW\nUPPER, S1\n")
    deck.add(f"*MATERIAL, NAME=STEEL\n{ELASTIC}*DENSITY\n2.\n")
    deck.add("*SOLID SECTION, ELSET=LOWER, MATERIAL=STEEL\n*SOLID SECTION, ELSET=UPPER, MATERIAL=STEEL\n")
    deck.add(f"*SURFACE INTERACTION, NAME=SI\n*SURFACE BEHAVIOR, {behaviour}\n")
    deck.add("*CONTACT PAIR, INTERACTION=SI, TYPE=NODE TO SURFACE\nSLAVE, MASTER\n")
    deck.add("*BOUNDARY\nLOWER_ALL, 1, 2\nUPPER_ALL, 1, 2\nLOWER_BELOW, 3\nUPPER_ABOVE, 3, 3, 0.\n")
    return deck.add(f"*STEP\n*STATIC\n{load}*END STEP\n")


#: M = E (1 − ν) / ((1 + ν)(1 − 2ν)); both blocks are springs, M · 1 and M · 0.04 / 0.2.
M = E * (1 - NU) / ((1 + NU) * (1 - 2 * NU))


#: A force of 1 down: as a pressure, at nodes, in two parts of one step, and in a second step in place of the first's.
LOADS = {
    "pressure": "*DLOAD\nUPPER, P1, -25.\n",
    "two pressures": "*DLOAD\nUPPER, P1, -20.\n*DSLOAD\nBELOW, P, -5.\n",
    "forces": "*CLOAD\nUPPER_BELOW, 3, -0.25\n",
    "twice in a step": "*CLOAD\nUPPER_BELOW, 3, -0.2\nUPPER_BELOW, 3, -0.05\n",
    "two steps": "*CLOAD\nUPPER_BELOW, 3, -0.7\n*END STEP\n*STEP\n*STATIC\n*CLOAD\nUPPER_BELOW, 3, -0.25\n",
    "new": "*DLOAD\nUPPER, P1, 7.\n*END STEP\n*STEP\n*STATIC\n*DLOAD, OP=NEW\nUPPER, P1, -25.\n",
}


@pytest.mark.parametrize("load", LOADS.values(), ids=LOADS)
def test_blocks_with_an_exponential_law(load, tmp_path):
    """Case 5, contact1: the force 0.8310962 and both displacements, by F = 1 − k₂ u₂ = k₁ u₁ = 0.2 exp(3e7 d)."""
    deck = cubes(f"PRESSURE-OVERCLOSURE=EXPONENTIAL\n{np.log(100) / 3e7:.15g}, 5.\n", load)
    solution = cd.solve(cd.read_scene(deck.write(tmp_path)))
    assert solution.contact().force == pytest.approx(0.8310962, rel=1e-5)
    lower, upper = (
        solution.displacement_at(*at)[0, 2] for at in (("LOWER", [[0.5, 0.5, 1]]), ("UPPER", [[0.5, 0.5, 1]]))
    )
    assert lower == pytest.approx(-2.9399321e-6, rel=1e-5)
    assert upper == pytest.approx(-2.9874144e-6, rel=1e-5)


@pytest.mark.parametrize(
    ("behaviour", "stiffness"),
    [
        ("PRESSURE-OVERCLOSURE=LINEAR\n1.E7,\n", 1e7),
        ("PRESSURE-OVERCLOSURE=TABULAR\n0., 0.\n1.E4, 1.E-3\n", 1e7),
        ("PRESSURE-OVERCLOSURE=HARD\n", np.inf),
    ],
)
def test_blocks_with_other_laws(behaviour, stiffness, tmp_path):
    """1 = F + k₂ u₂, F = k₁ u₁ = k (u₂ − u₁): linear laws, a table, none."""
    scene = cd.read_scene(cubes(behaviour, "*DLOAD\nUPPER, P1, -25.\n").write(tmp_path))
    series = 1 / (1 / M + 1 / (0.04 * stiffness))
    # Hard contact's multipliers settle to 1e-6.
    assert cd.solve(scene).contact().force == pytest.approx(series / (series + 0.2 * M), rel=1e-5)


def test_prescribed_displacement_gravity_and_clearance(tmp_path):
    """A lid pushed down by 1e-4 through a clearance of 4e-5; the lower cube's weight is carried by its support."""
    deck = cubes(
        "PRESSURE-OVERCLOSURE=LINEAR\n1.E7,\n",
        "*BOUNDARY\nUPPER_ABOVE, 3, 3, -1.E-4\n*DLOAD\nLOWER, GRAV, 3., 0, 0, -1\n",
    )
    deck.text = deck.text.replace(
        "*BOUNDARY\nLOWER", "*CLEARANCE, SLAVE=SLAVE, MASTER=MASTER, VALUE=4.E-5\n*BOUNDARY\nLOWER"
    )
    solution = cd.solve(cd.read_scene(deck.write(tmp_path)))
    sag = 0.5 * 6.0 / M  # of one trilinear cell, which lowers the lower surface
    force = (1e-4 - 4e-5 - sag) / (1 / M + 1 / (0.2 * M) + 1 / (0.04 * 1e7))
    assert solution.contact().force == pytest.approx(force, rel=1e-6)
    assert solution.forces("LOWER")["loads"][2] == pytest.approx(-6.0, rel=1e-12)


def test_abaqus_means_another_exponential(tmp_path):
    deck = cubes("PRESSURE-OVERCLOSURE=EXPONENTIAL\n1.E-3, 5.\n", "*DLOAD\nUPPER, P1, -25.\n").write(tmp_path)
    assert isinstance(cd.read_scene(deck).contacts[0].layer, cd.ExponentialLayer)
    assert isinstance(cd.read_scene(deck, program="abaqus").contacts[0].layer, cd.OverclosureLayer)


def test_all_that_is_not_understood_is_listed(tmp_path):
    deck = cubes("PRESSURE-OVERCLOSURE=LINEAR\n1.E7,\n*FRICTION\n0.3, 1.E5\n", "*CLOAD, USER\nUPPER_BELOW, 3, -0.25\n")
    deck.add("*ELEMENT, TYPE=SPRINGA, ELSET=S\n9, 1, 9\n")
    path = deck.write(tmp_path)
    with pytest.raises(ValueError, match=r"\*FRICTION; \*CLOAD, USER; \*ELEMENT, TYPE=SPRINGA") as refused:
        cd.read_scene(path)
    listed = eval(str(refused.value).split("ignore=")[1])  # as the message says
    series = 1 / (1 / M + 1 / 4e5)
    solution = cd.solve(cd.read_scene(path, ignore=listed))
    assert solution.contact().force == pytest.approx(series / (series + 0.2 * M), rel=1e-6)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("*SOLID SECTION, ELSET=LOWER, MATERIAL=STEEL\n", "", "no \\*SOLID SECTION"),
        ("MATERIAL, NAME=STEEL", "MATERIAL, NAME=IRON", "no elastic material 'STEEL'"),
        ("SLAVE, MASTER\n", "SLAVE, NOBODY\n", "'NOBODY' of a contact belongs to 0 bodies"),
        ("INTERACTION=SI, TYPE", "INTERACTION=SJ, TYPE", "'SJ' has no"),
        ("1.E7,", "-1.E7,", "stiffness"),
        ("UPPER, P1", "UPPER, P9", "expected S1 to S6"),
        ("LOWER_ALL, 1, 2", "LOWER_ALL, one, 2", "cannot be read"),
    ],
)
def test_refusals(old, new, words, tmp_path):
    deck = cubes("PRESSURE-OVERCLOSURE=LINEAR\n1.E7,\n", "*DLOAD\nUPPER, P1, -25.\n")
    assert old in deck.text
    deck.text = deck.text.replace(old, new)
    with pytest.raises(ValueError, match=words):
        cd.read_scene(deck.write(tmp_path))


def brick(deck: Deck, name: str, first: int, low, high, cells, bulge: float = 0.0) -> None:
    """A block of C3D20, its lower face raised by bulge (x − 1)²; surfaces NAME_S1 below and NAME_S2 above."""
    n = [2 * count + 1 for count in cells]

    def place(index):
        t = np.array(index) / (np.array(n) - 1)
        x = low + t * (np.array(high) - low)
        x[2] += bulge * (x[0] - 1) ** 2 * (1 - t[2])
        return x

    grid = {
        index: deck.node(place(index)) for index in np.ndindex(*n) if sum(each % 2 for each in index) <= 1
    }  # no nodes in the middle of faces and cells
    ring8 = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    around = [(*c, 0) for c in ring8[:4]] + [(*c, 2) for c in ring8[:4]]
    around += [(*c, 0) for c in ring8[4:]] + [(*c, 2) for c in ring8[4:]] + [(*c, 1) for c in ring8[:4]]
    deck.add(f"*ELEMENT, TYPE=C3D20, ELSET={name}\n")
    faces = {"S1": [], "S2": []}
    for e, at in enumerate(np.ndindex(*cells)):
        nodes = [str(grid[tuple(2 * a + o for a, o in zip(at, offset, strict=True))]) for offset in around]
        deck.add(f"{first + e}, " + ", ".join(nodes[:15]) + ",\n" + ", ".join(nodes[15:]) + "\n")
        faces["S1"] += [first + e] if at[2] == 0 else []
        faces["S2"] += [first + e] if at[2] == cells[2] - 1 else []
    for face, elements in faces.items():
        deck.add(f"*SURFACE, NAME={name}_{face}\n" + "".join(f"{each}, {face}\n" for each in elements))


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
def test_the_same_deck_in_calculix(tmp_path):
    """A bulged block pressed on another one through a table, solved by both programs: forces within 2 %."""
    deck = Deck()
    brick(deck, "LOWER", 1, (0, 0, 0), (2, 0.5, 1), (10, 2, 3))
    brick(deck, "UPPER", 1001, (0, 0, 1), (2, 0.5, 2), (8, 2, 3), bulge=2e-3)
    for name, where in (("FLOOR", lambda x: x[2] == 0), ("LID", lambda x: x[2] == 2), ("FRONT", lambda x: x[1] == 0)):
        deck.add(f"*NSET, NSET={name}\n{deck.on(where)}")
    deck.add(f"*MATERIAL, NAME=STEEL\n{ELASTIC}*SOLID SECTION, ELSET=LOWER, MATERIAL=STEEL\n")
    deck.add("*SOLID SECTION, ELSET=UPPER, MATERIAL=STEEL\n*SURFACE INTERACTION, NAME=SI\n")
    deck.add("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR\n0., 0.\n20., 4.E-4\n120., 1.E-3\n320., 2.E-3\n")
    deck.add("*CONTACT PAIR, INTERACTION=SI, TYPE=NODE TO SURFACE\nUPPER_S1, LOWER_S2\n")
    deck.add("*BOUNDARY\nFLOOR, 1, 3\nLID, 1, 2\nFRONT, 2, 2\n*STEP\n*STATIC\n0.25, 1.\n")
    deck.add("*BOUNDARY\nLID, 3, 3, -2.E-3\n*NODE PRINT, NSET=LID, TOTALS=ONLY\nRF\n*END STEP\n")
    path = deck.write(tmp_path)
    result = cd.solve(cd.read_scene(path)).contact()
    assert 0.3 < result.area < 0.95  # the edge of contact is inside, so that the whole table counts
    subprocess.run(["ccx", path.stem], cwd=tmp_path, check=True, capture_output=True, timeout=60)
    told = (tmp_path / "deck.dat").read_text().split("total force")[-1].split("\n\n")[1]
    # CalculiX integrates at nodes: with 8, 16 and 10 × 2 cells it gives 71.6, 72.1 and 72.8, where 73.4 comes here.
    assert result.force == pytest.approx(abs(float(told.split()[2])), rel=0.02)
