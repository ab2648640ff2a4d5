#!/usr/bin/env bash
# meshio 5.3.5: a deck of Abaqus or CalculiX (.inp) that is read and written again has other elements.
#
# Input:    decks of one element each: a plane stress triangle (CPS3), a shell (S4), a brick (C3D8), a truss (T3D2).
# Expected: the same type in the written deck, or another one of the same kind of mechanics; or a word about it.
# Seen:     a rigid triangle (R3D3), an axisymmetric element with pore pressure (CAX4P), a brick with reduced
#           integration and hybrid pressure (C3D8RH), a beam (B31H); without a warning. A mesh from any other format
#           gets these types too when it is written as .inp; tetrahedra stay what they are (C3D4).
# Exit:     0 if that is still so, 1 if the behaviour has changed.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"${PYTHON:-python3}" -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check meshio==5.3.5 numpy==2.2.6 rich==14.0.0
cd "$work"
"$work/venv/bin/python" - 2>stderr <<'PYTHON' || { cat stderr >&2; exit 1; }
import contextlib
import io
import re
import sys
from pathlib import Path

import meshio

#: The type in the deck, its nodes, and the type in the deck that meshio writes.
SEEN = {
    "CPS3": ("1, 2, 3", "R3D3"),
    "S4": ("1, 2, 3, 4", "CAX4P"),
    "C3D8": ("1, 2, 3, 4, 5, 6, 7, 8", "C3D8RH"),
    "T3D2": ("1, 2", "B31H"),
    "C3D4": ("1, 2, 4, 5", "C3D4"),
}
NODES = """*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
"""


def written(kind, nodes):
    Path("before.inp").write_text(f"{NODES}*ELEMENT, TYPE={kind}\n1, {nodes}\n")
    meshio.read("before.inp").write("after.inp")
    return re.findall(r"TYPE=(\w+)", Path("after.inp").read_text())


print("meshio", meshio.__version__)
said = io.StringIO()
with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
    types = {kind: written(kind, nodes) for kind, (nodes, _) in SEEN.items()}
for kind, found in types.items():
    print(f"read {kind}: expected {[kind]}, seen {found}")
print("warnings:", repr(said.getvalue()))
same = all(types[kind] == [after] for kind, (_, after) in SEEN.items()) and not said.getvalue()
print("as described" if same else "CHANGED")
sys.exit(not same)
PYTHON
