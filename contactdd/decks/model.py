"""What a deck says beside its mesh, card by card, as plain data; and the list of what is not understood.

Later steps change the supports and loads of earlier ones, as programs do: what stands at the end counts, which for
elastic bodies without friction is all that matters; of amplitudes their values there. Loads on one node or face within
a step add up.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..base.arrays import Floats
from ..files.deck import Card, Deck, entry_of, fields, number_of, of_set
from ..hard_contact import HardContact
from ..layer import Layer, LinearLayer
from ..layers.exponential import ExponentialLayer, OverclosureLayer
from ..layers.table import TableLayer
from ..material import Anisotropic, Isotropic, Material, Orthotropic
from .amplitude import Amplitude, periods_of

#: Cards that change nothing of the solution: the mesh, which is read elsewhere, headings, output, increments.
SILENT = {
    *("HEADING", "NODE", "ELEMENT", "NSET", "ELSET", "SURFACE", "PREPRINT", "PART", "ENDPART", "ASSEMBLY"),
    *("ENDASSEMBLY", "INSTANCE", "ENDINSTANCE", "STATIC", "ENDSTEP", "CONTROLS", "RESTART", "OUTPUT", "NODEPRINT"),
    *("ELPRINT", "NODEFILE", "ELFILE", "NODEOUTPUT", "ELEMENTOUTPUT", "CONTACTFILE", "CONTACTPRINT", "CONTACTOUTPUT"),
    *("ENERGYOUTPUT", "SECTIONPRINT", "PRINT", "MONITOR", "TIMEPOINTS", "FILEOUTPUT", "USERELEMENT"),
}
#: Held directions by name, as (first, last).
NAMED_SUPPORTS = {"ENCASTRE": (1, 3), "PINNED": (1, 3), "XSYMM": (1, 1), "YSYMM": (2, 2), "ZSYMM": (3, 3)}


@dataclass
class Section:
    """The material's name of a set of elements, and its thickness."""

    elset: str
    material: str
    thickness: float = 1.0


@dataclass
class Pair:
    """A contact: the names of both surfaces and of the interaction, and the clearance that is given."""

    slave: str
    master: str
    interaction: str
    clearance: float | None = None


@dataclass
class Model:
    """A deck's materials, sections, contacts, supports and loads.

    boundaries, forces: {(node, direction from 1): value}; pressures: {(element, face): value}; gravity: {set of
    elements: acceleration}; initial, temperature: {node: value}; periods: of the steps; unknown: what is not
    understood.
    """

    deck: Deck
    program: str
    materials: dict[str, Material] = field(default_factory=dict)
    densities: dict[str, float] = field(default_factory=dict)
    expansions: dict[str, float | list[float]] = field(default_factory=dict)
    sections: list[Section] = field(default_factory=list)
    behaviours: dict[str, Layer | HardContact] = field(default_factory=dict)
    pairs: list[Pair] = field(default_factory=list)
    boundaries: dict[tuple[int, int], float] = field(default_factory=dict)
    forces: dict[tuple[int, int], float] = field(default_factory=dict)
    pressures: dict[tuple[int, str], float] = field(default_factory=dict)
    gravity: dict[str, Floats] = field(default_factory=dict)
    initial: dict[int, float] = field(default_factory=dict)
    temperature: dict[int, float] = field(default_factory=dict)
    amplitudes: dict[str, Amplitude] = field(default_factory=dict)
    periods: list[float] = field(default_factory=list)
    unknown: list[str] = field(default_factory=list)
    _material: str = ""
    _interaction: str = ""
    _steps: int = 0
    _given: set[Any] = field(default_factory=set)

    def take(self, card: Card) -> None:
        """Add what a card says."""
        if card.keyword in SILENT:
            return
        taker = TAKERS.get(card.keyword)
        if taker is None:
            self.unknown.append(card.keyword)
            return
        try:
            taker(self, card)
        except (ValueError, IndexError, TypeError, KeyError) as error:
            if str(error).startswith("path"):
                raise
            line = card.lines[0] if card.lines else ""
            raise ValueError(
                f"{self.deck.source} has a *{card.keyword} that cannot be read ({error}): {line!r}"
            ) from None

    def nodes(self, entry: str) -> list[int]:
        """The numbers of nodes that an entry stands for."""
        return [int(number) for number in of_set(self.deck, "NSET", entry_of(entry), ())]

    def elements(self, entry: str) -> list[int]:
        """The numbers of elements that an entry stands for."""
        return [int(number) for number in of_set(self.deck, "ELSET", entry_of(entry), ())]

    def load(self, values: dict[Any, Any], key: Any, value: Any) -> None:
        """Set a load, or add to what the same step has put there already.

        values: one of `forces`, `pressures` or `gravity`.
        """
        there = (id(values), key) in self._given
        values[key] = values[key] + value if there else value
        self._given.add((id(values), key))

    def expect(self, card: Card, *parameters: str) -> None:
        """Note the parameters of a card that are none of these, all of which are heeded or change nothing."""
        for name in card.parameters:
            if name not in parameters:
                self.not_understood(f"{card.keyword}, {name}")

    def not_understood(self, what: str) -> None:
        """Note something that is not understood, once."""
        if what not in self.unknown:
            self.unknown.append(what)


def model_of(deck: Deck, cards: Sequence[Card], program: str) -> Model:
    """The model of a deck, from all of its cards."""
    model = Model(deck, program, periods=periods_of(cards))
    for card in cards:
        model.take(card)
    for other in sorted(deck.others):
        model.not_understood(f"ELEMENT, TYPE={other}")
    if len({dim for dim, _ in deck.elements}) > 1:
        model.not_understood("ELEMENT of the plane beside solid ones")
    return model


def _rows(card: Card) -> list[list[str]]:
    return [fields(line) for line in card.lines]


def _numbers(card: Card) -> list[float]:
    return [number_of(word) for row in _rows(card) for word in row if word]


# ------------------------------------------------------------------------------------------------------ materials


def _material(model: Model, card: Card) -> None:
    model._material = card.parameters["NAME"]


def _elastic(model: Model, card: Card) -> None:
    kind, rows = card.parameters.get("TYPE", "ISO"), [[number_of(w) for w in row if w] for row in _rows(card)]
    if kind in ("ISO", "ISOTROPIC"):
        if len(rows) > 1 and any(row[:2] != rows[0][:2] for row in rows):
            model.not_understood("ELASTIC that depends on temperature")
        model.materials[model._material] = Isotropic(rows[0][0], rows[0][1] if len(rows[0]) > 1 else 0.0)
        return
    values = [value for row in rows for value in row]
    if kind in ("ENGINEERINGCONSTANTS", "ENGINEERING CONSTANTS"):
        model.materials[model._material] = Orthotropic(*values[:9])
    elif kind in ("ORTHO", "ORTHOTROPIC"):
        model.materials[model._material] = Anisotropic(_orthotropic(values[:9]))
    else:
        model.not_understood(f"ELASTIC, TYPE={kind}")


def _orthotropic(values: Sequence[float]) -> Floats:
    """C in the order of Voigt, from D1111, D1122, D2222, D1133, D2233, D3333, D1212, D1313, D2323."""
    xx, xy, yy, xz, yz, zz, s12, s13, s23 = values
    matrix = np.diag([xx, yy, zz, s23, s13, s12])
    for i, j, value in ((0, 1, xy), (0, 2, xz), (1, 2, yz)):
        matrix[i, j] = matrix[j, i] = value
    return matrix


def _density(model: Model, card: Card) -> None:
    model.densities[model._material] = _numbers(card)[0]


def _expansion(model: Model, card: Card) -> None:
    rows = [[number_of(w) for w in row if w] for row in _rows(card)]
    kind = card.parameters.get("TYPE", "ISO")
    if kind not in ("ISO", "ORTHO"):
        model.not_understood(f"EXPANSION, TYPE={kind}")
        return
    width = 1 if kind == "ISO" else 3
    if any(row[:width] != rows[0][:width] for row in rows):
        model.not_understood("EXPANSION that depends on temperature")
    model.expansions[model._material] = rows[0][0] if width == 1 else rows[0][:3]


def _section(model: Model, card: Card) -> None:
    model.expect(card, "ELSET", "MATERIAL", "CONTROLS")
    values = _numbers(card)
    thickness = values[0] if values else 1.0
    model.sections.append(Section(card.parameters["ELSET"], card.parameters["MATERIAL"], thickness))


# ------------------------------------------------------------------------------------------------------ contacts


def _interaction(model: Model, card: Card) -> None:
    model._interaction = card.parameters["NAME"]


def _behaviour(model: Model, card: Card) -> None:
    model.expect(card, "PRESSURE-OVERCLOSURE", "AUGMENTEDLAGRANGE", "PENALTY", "DIRECT")
    kind = card.parameters.get("PRESSURE-OVERCLOSURE", "HARD")
    rows = [[number_of(w) for w in row if w] for row in _rows(card)]
    if kind == "LINEAR":
        model.behaviours[model._interaction] = LinearLayer(rows[0][0])
    elif kind == "EXPONENTIAL":
        c0, p0 = rows[0][:2]
        made = ExponentialLayer.calculix(p0, c0) if model.program == "calculix" else OverclosureLayer(p0, c0)
        model.behaviours[model._interaction] = made
    elif kind == "TABULAR":
        model.behaviours[model._interaction] = _table(rows)
    elif kind == "HARD":
        model.behaviours[model._interaction] = HardContact()
    else:
        model.not_understood(f"SURFACEBEHAVIOR, PRESSURE-OVERCLOSURE={kind}")


def _table(rows: Sequence[Sequence[float]]) -> TableLayer:
    """The law through rows of pressure and overclosure, straight in between; it begins at the first of them."""
    pressures, depths = np.array([row[:2] for row in rows]).T
    if pressures[0] != 0.0:
        raise ValueError(f"the table begins with the pressure {pressures[0]:g}; expected 0")
    return TableLayer(list(depths - depths[0]), list(pressures), smooth=False, clearance=-float(depths[0]) + 0.0)


def _pair(model: Model, card: Card) -> None:
    if "ADJUST" in card.parameters and card.parameters["ADJUST"] not in ("0", "0.", "0.0"):
        model.not_understood("CONTACTPAIR, ADJUST")
    model.expect(card, "ADJUST", "INTERACTION", "TYPE", "SMALLSLIDING", "NOTHICKNESS", "TRACKING", "EXTENSIONZONE")
    for slave, master, *_ in _rows(card):
        model.pairs.append(Pair(slave.upper(), master.upper(), card.parameters["INTERACTION"]))


def _clearance(model: Model, card: Card) -> None:
    names = card.parameters["SLAVE"], card.parameters["MASTER"]
    meant = [pair for pair in model.pairs if (pair.slave, pair.master) == names]
    if not meant:
        raise ValueError(f"there is no *CONTACT PAIR of {names[0]} and {names[1]} before it")
    for pair in meant:
        pair.clearance = number_of(card.parameters["VALUE"])


# ----------------------------------------------------------------------------------------------- supports and loads


def _amplitude(model: Model, card: Card) -> None:
    model.expect(card, "NAME", "TIME", "DEFINITION", "VALUE", "SHIFTX", "SHIFTY")
    if (
        card.parameters.get("DEFINITION", "TABULAR") != "TABULAR"
        or card.parameters.get("VALUE", "RELATIVE") != "RELATIVE"
    ):
        model.not_understood("AMPLITUDE, DEFINITION or VALUE")
    shifts = [number_of(card.parameters.get(name, "0")) for name in ("SHIFTX", "SHIFTY")]
    table = np.array(_numbers(card)).reshape(-1, 2) + shifts
    total = card.parameters.get("TIME", "").replace(" ", "") == "TOTALTIME"
    model.amplitudes[card.parameters["NAME"]] = Amplitude(table[:, 0], table[:, 1], total)


def _factor(model: Model, card: Card) -> float:
    """What a card's values are multiplied by at the end of the last step."""
    for name in ("SUBMODEL", "USER", "TYPE", "FIXED", "TIMEDELAY"):
        if name in card.parameters and card.parameters[name] not in ("DISPLACEMENT",):
            model.not_understood(f"{card.keyword}, {name}")
    if "AMPLITUDE" not in card.parameters:
        return 1.0
    if card.parameters["AMPLITUDE"] not in model.amplitudes:
        raise ValueError(f"there is no *AMPLITUDE {card.parameters['AMPLITUDE']!r} before it")
    return model.amplitudes[card.parameters["AMPLITUDE"]].at_end(model.periods, max(model._steps, 1) - 1)


def _boundary(model: Model, card: Card) -> None:
    factor = _factor(model, card)
    if card.parameters.get("OP") == "NEW":
        model.boundaries.clear()
    for row in _rows(card):
        first, last = NAMED_SUPPORTS.get(row[1].upper(), (0, 0)) if len(row) > 1 else (0, 0)
        if not first:
            first, last = int(row[1]), int(row[2]) if len(row) > 2 and row[2] else int(row[1])
        value = factor * number_of(row[3]) if len(row) > 3 and row[3] else 0.0
        for node in model.nodes(row[0]):
            model.boundaries |= {(node, direction): value for direction in range(first, last + 1)}


def _cload(model: Model, card: Card) -> None:
    factor = _factor(model, card)
    if card.parameters.get("OP") == "NEW":
        model.forces.clear()
    for row in _rows(card):
        for node in model.nodes(row[0]):
            model.load(model.forces, (node, int(row[1])), factor * number_of(row[2]))


def _dload(model: Model, card: Card) -> None:
    factor = _factor(model, card)
    if card.parameters.get("OP") == "NEW":
        model.pressures.clear()
        model.gravity.clear()
    for row in _rows(card):
        label = row[1].upper()
        if label == "GRAV":
            direction = np.array([number_of(word) for word in row[3:6]])
            model.load(model.gravity, row[0].upper(), factor * number_of(row[2]) * direction)
        elif re.fullmatch(r"P\d", label):
            for element in model.elements(row[0]):
                model.load(model.pressures, (element, "S" + label[1:]), factor * number_of(row[2]))
        else:
            model.not_understood(f"DLOAD {label}")


def _dsload(model: Model, card: Card) -> None:
    factor = _factor(model, card)
    if card.parameters.get("OP") == "NEW":  # of these alone, or of all pressures: programs differ
        model.not_understood("DSLOAD, OP")
    for name, label, value, *_ in _rows(card):
        if label.upper() != "P" or name.upper() not in model.deck.surfaces:
            model.not_understood(f"DSLOAD {name}, {label}")
            continue
        for entry, face in model.deck.surfaces[name.upper()]:
            for element in model.elements(entry):
                model.load(model.pressures, (element, face), factor * number_of(value))


def _initial(model: Model, card: Card) -> None:
    if card.parameters.get("TYPE") != "TEMPERATURE":
        model.not_understood(f"INITIALCONDITIONS, TYPE={card.parameters.get('TYPE', '')}")
        return
    for row in _rows(card):
        model.initial |= dict.fromkeys(model.nodes(row[0]), number_of(row[1]))


def _temperature(model: Model, card: Card) -> None:
    if "FILE" in card.parameters:
        model.not_understood("TEMPERATURE, FILE")
    factor = _factor(model, card)
    if card.parameters.get("OP") == "NEW":
        model.temperature.clear()
    for row in _rows(card):
        model.temperature |= dict.fromkeys(model.nodes(row[0]), factor * number_of(row[1]))


def _step(model: Model, card: Card) -> None:
    model._given.clear()
    model._steps += 1
    if "NLGEOM" in card.parameters and card.parameters["NLGEOM"] != "NO":
        model.not_understood("STEP, NLGEOM")
    if "PERTURBATION" in card.parameters:
        model.not_understood("STEP, PERTURBATION")


TAKERS: dict[str, Callable[[Model, Card], None]] = {
    "MATERIAL": _material,
    "ELASTIC": _elastic,
    "DENSITY": _density,
    "EXPANSION": _expansion,
    "SOLIDSECTION": _section,
    "SURFACEINTERACTION": _interaction,
    "SURFACEBEHAVIOR": _behaviour,
    "CONTACTPAIR": _pair,
    "CLEARANCE": _clearance,
    "AMPLITUDE": _amplitude,
    "BOUNDARY": _boundary,
    "CLOAD": _cload,
    "DLOAD": _dload,
    "DSLOAD": _dsload,
    "INITIALCONDITIONS": _initial,
    "TEMPERATURE": _temperature,
    "STEP": _step,
}
