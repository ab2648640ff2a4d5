#!/usr/bin/env bash
# meshio 5.3.5: a set that a deck of Abaqus or CalculiX (.inp) builds from another set is read wrong.
#
# Input:    a brick (element 9) in the set CORE, and a set ALL whose only entry is the name CORE, as decks may have it;
#           the same for sets of nodes, ONE with node 3 and TWO with the name ONE.
# Expected: CORE and ALL hold the brick, ONE and TWO the node.
# Seen:     TWO is empty, without a warning. ALL is nested one level deeper than CORE, so that cell_sets_dict raises
#           TypeError and a deck written from the mesh has "[1]" for an element's number.
# Exit:     0 if that is still so, 1 if the behaviour has changed.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"${PYTHON:-python3}" -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check meshio==5.3.5 numpy==2.2.6 rich==14.0.0
cd "$work"
"$work/venv/bin/python" - <<'PYTHON'
import sys
from pathlib import Path

import meshio
import numpy as np

DECK = """*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
*ELEMENT, TYPE=C3D8
9, 1, 2, 3, 4, 5, 6, 7, 8
*ELSET, ELSET=CORE
9
*ELSET, ELSET=ALL
CORE
*NSET, NSET=ONE
3
*NSET, NSET=TWO
ONE
"""


def levels(cells):
    """How deep the lists and arrays of a set are nested."""
    return 1 + levels(cells[0]) if np.ndim(cells) or isinstance(cells, list) else 0


def attempt(call):
    try:
        return call()
    except Exception as error:
        return f"{type(error).__name__}: {error}"


Path("before.inp").write_text(DECK)
mesh = meshio.read("before.inp")
depth = {name: levels(cells) for name, cells in mesh.cell_sets.items()}
as_dict = attempt(lambda: mesh.cell_sets_dict)
mesh.write("after.inp")
lines = Path("after.inp").read_text().splitlines()
written = {name: lines[lines.index(f"*ELSET, ELSET={name}") + 1] for name in ("CORE", "ALL")}
nodes = {name: np.asarray(found).tolist() for name, found in mesh.point_sets.items()}

print("meshio", meshio.__version__)
print("levels of lists: expected the same for both, seen", depth)
print("cell_sets_dict: expected a dictionary, seen", as_dict)
print("the sets in the written deck: expected {'CORE': '1', 'ALL': '1'}, seen", written)
print("sets of nodes: expected {'ONE': [2], 'TWO': [2]}, seen", nodes)
same = (
    depth == {"CORE": 2, "ALL": 3}
    and str(as_dict).startswith("TypeError")
    and written == {"CORE": "1", "ALL": "[1]"}
    and nodes == {"ONE": [2], "TWO": []}
)
print("as described" if same else "CHANGED")
sys.exit(not same)
PYTHON
