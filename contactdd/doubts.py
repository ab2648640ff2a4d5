"""What a reader of a result has to be told: where its gap, its laws or linear theory are doubtful."""

from __future__ import annotations

import warnings

import numpy as np

from .errors import ContactWarning, LayerRangeWarning
from .interface.discretise import Interface
from .solution import Solution

#: The part of the layer's compression that facets may hide without a word.
DOUBTFUL = 0.1
#: From a warning here to the line that called `solve`: these two functions, `solve` and its decorator are between.
CALLER = 5


def warn_of_doubts(solution: Solution) -> None:
    """Warn of what makes a solution doubtful, on the first rank."""
    if solution.scene.ranks.comm.rank == 0:
        for interface in solution.interfaces:
            if interface.doubt is not None:
                _warn_of_facets(solution, interface, interface.doubt)
        if solution.converged:
            _warn_of_notes(solution)
    if solution.converged:
        solution.warn_of_large_strains()


def _warn_of_facets(solution: Solution, interface: Interface, doubts: np.ndarray) -> None:
    """Warn where the uncertainty of the gap behind facets is not small compared with the layer's compression."""
    result = solution.contact(interface.contact.name)
    near = np.flatnonzero((doubts > 0.0) & (result.gap < doubts))
    doubt = float(doubts[near].mean()) if len(near) else 0.0
    pressed = result.pressure / interface.facet_stiffness if interface.hard else np.abs(result.compression)
    compression = float(pressed[near].mean()) if len(near) else 0.0
    if doubt > DOUBTFUL * compression:
        warnings.warn(
            f"contact {interface.contact.name!r}: where the surfaces touch or nearly do, their facets do not tell what "
            f"curved surface is meant, if any is: the gap may be off by {doubt:.3g}, while the layer is compressed by "
            f"{compression:.3g}; a finer mesh, one of second order, facets that match, or measure_gap=False with the "
            "gap given would tell",
            ContactWarning,
            stacklevel=CALLER,
        )


def _warn_of_notes(solution: Solution) -> None:
    """Warn where a layer is compressed further than its law is known."""
    for note in solution.notes:
        warnings.warn(note, LayerRangeWarning, stacklevel=CALLER)
