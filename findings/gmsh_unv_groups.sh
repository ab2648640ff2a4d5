#!/usr/bin/env bash
# gmsh 4.15.2: groups of a universal file (.unv) are read from dataset 2477 and passed over in dataset 2467.
#
# Input:    two triangles, one of them in the group "steel"; the same file twice, with the group in dataset 2477 and in
#           2467. Both datasets hold permanent groups with the same records; mesh generators write both.
# Expected: a physical group "steel" from each file, or a word about what was left out.
# Seen:     the group from 2477; from 2467 none, without an exception, and without a warning or an error in the log.
# Exit:     0 if that is still so, 1 if the behaviour has changed.
#
# gmsh needs the system's libGLU, libXft, libXcursor and libXinerama.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"${PYTHON:-python3}" -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check gmsh==4.15.2
cd "$work"
"$work/venv/bin/python" - <<'PYTHON'
import sys
from pathlib import Path

import gmsh


def integers(*values):
    return "".join(f"{value:10d}" for value in values) + "\n"


def dataset(number, text):
    return f"    -1\n{number:6d}\n{text}    -1\n"


def node(number, *x):
    return integers(number, 1, 1, 11) + "".join(f"{value:25.16E}" for value in x).replace("E", "D") + "\n"


def triangle(number, *nodes):
    return integers(number, 91, 1, 1, 7, 3) + integers(*nodes)  # 91: thin shell of three nodes


def groups(path):
    gmsh.open(path)
    assert len(gmsh.model.mesh.getElements(2)[1][0]) == 2, "both triangles are there"
    names = [gmsh.model.getPhysicalName(*group) for group in gmsh.model.getPhysicalGroups()]
    return [name for name in names if name]  # one without a name comes from the elements' material number


nodes = node(1, 0, 0, 0) + node(2, 1, 0, 0) + node(3, 1, 1, 0) + node(4, 0, 1, 0)
elements = triangle(1, 1, 2, 3) + triangle(2, 1, 3, 4)
# Number, six sets that are not there, how many entities; the name; then each entity: 8 for an element, its number.
group = integers(1, 0, 0, 0, 0, 0, 0, 1) + "steel\n" + integers(8, 2, 0, 0)

gmsh.initialize(readConfigFiles=False)
gmsh.option.setNumber("General.Terminal", 0)
print("gmsh", gmsh.option.getString("General.Version"))
gmsh.logger.start()
seen = {}
for number in (2477, 2467):
    path = f"groups_{number}.unv"
    Path(path).write_text(dataset(2411, nodes) + dataset(2412, elements) + dataset(number, group))
    seen[number] = groups(path)
    print(f"dataset {number}: expected ['steel'], seen {seen[number]}")
told = [line for line in gmsh.logger.get() if line.startswith(("Warning", "Error"))]
print("warnings and errors in the log:", told)
gmsh.finalize()
same = seen == {2477: ["steel"], 2467: []} and not told
print("as described" if same else "CHANGED")
sys.exit(not same)
PYTHON
