"""A scene from a deck of CalculiX or Abaqus."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..base.checks import check_choice
from ..body import Body
from ..contact import Contact
from ..files import deck as files
from ..scene import Scene
from .bodies import body_of, parts_of, types_of
from .model import Model, Pair, model_of

PROGRAMS = ("calculix", "abaqus")


def read_scene(path: str | Path, *, program: str = "calculix", ignore: Sequence[str] = ()) -> Scene:
    r"""The scene that a deck of CalculiX or Abaqus describes: bodies, materials, contacts, supports and loads.

    Read are meshes as by `read_mesh`; ``*ELASTIC`` (isotropic and orthotropic), ``*EXPANSION``, ``*DENSITY``, ``*SOLID
    SECTION``; ``*SURFACE BEHAVIOR`` (linear, exponential, tabular, hard), ``*CONTACT PAIR``, ``*CLEARANCE``;
    ``*BOUNDARY``; ``*CLOAD``, ``*DLOAD`` (faces and gravity), ``*DSLOAD``, ``*TEMPERATURE``; ``*AMPLITUDE``. The loads
    and supports at the end of the last step count. Cells that share no node are bodies of their own, with the name of
    the element set that they are; a contact has the names of its surfaces, "SLAVE–MASTER". Plane bodies have the deck's
    forces divided by its thickness.

    Args:
        path: The path of the deck.
        program: "calculix" or "abaqus": they mean different things by an exponential pressure-overclosure.
        ignore: The names of what is not understood and may be left out, as the message of refusal lists them.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: Something in the deck that changes the solution is not understood (all of it is listed); the deck
            does not describe a scene.

    Example:
        >>> cd.read_scene("ring.inp", ignore=["STEP, NLGEOM"])  # doctest: +SKIP
    """
    path = Path(path)
    check_choice("program", program, PROGRAMS)
    if not path.is_file():
        raise FileNotFoundError(f"path = {str(path)!r}: no such file")
    deck, cards = files.parsed(path)
    contents = files.contents(deck, files.max_dim(deck))
    model, types = model_of(deck, cards, program), types_of(cards)
    _refuse_unknown(model, ignore)
    bodies = [body_of(model, contents, part, types) for part in parts_of(model, contents)]
    contacts = [_contact(model, pair, bodies) for pair in model.pairs]
    _refuse_unknown(model, ignore)
    return Scene(bodies, contacts)


def _contact(model: Model, pair: Pair, bodies: Sequence[Body]) -> Contact:
    """A contact pair, between the bodies that have its surfaces."""
    if pair.interaction not in model.behaviours:
        raise ValueError(f"{model.deck.source}: the *SURFACE INTERACTION {pair.interaction!r} has no *SURFACE BEHAVIOR")
    first, second = (_side(model, name, bodies) for name in (pair.slave, pair.master))
    name, layer, gap = f"{pair.slave}–{pair.master}", model.behaviours[pair.interaction], pair.clearance
    return Contact(first, second, layer, gap=gap or 0.0, measure_gap=gap is None, name=name)


def _side(model: Model, name: str, bodies: Sequence[Body]) -> tuple[Body, str]:
    found = [body for body in bodies if name in body.mesh.surfaces]
    if len(found) != 1:
        reasons = {body.mesh.left_out[name] for body in bodies if name in body.mesh.left_out} if not found else set()
        raise ValueError(
            f"{model.deck.source}: the surface {name!r} of a contact belongs to {len(found)} bodies; expected one"
            + "".join(f" ({reason})" for reason in sorted(reasons))
        )
    return found[0], name


def _refuse_unknown(model: Model, ignore: Sequence[str]) -> None:
    """Refuse a deck of which something that changes the solution is not understood and not to be ignored."""
    allowed = {each.upper().replace(" ", "") for each in ignore}
    strange = [each for each in dict.fromkeys(model.unknown) if each.upper().replace(" ", "") not in allowed]
    if strange:
        listed = "; ".join(f"*{each}" for each in strange)
        raise ValueError(
            f"{model.deck.source} has what is not understood here: {listed}. What may be left out can be listed: "
            f"ignore={strange!r}"
        )
