#!/usr/bin/env bash
# gmsh 4.15.2: a physical group that gmsh saves in a MED file (.med) has another name when gmsh opens the file.
#
# Input:    a square with the physical group "block", meshed, saved by gmsh as .med and opened by gmsh again.
# Expected: a physical group "block", which getEntitiesForPhysicalName finds under that name.
# Seen:     the name has grown to 80 characters, "block" and 75 blanks, and nothing is found as "block". A file in
#           which the name is filled up with zero bytes instead of blanks would be read right.
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

import gmsh


def names():
    return [gmsh.model.getPhysicalName(*group) for group in gmsh.model.getPhysicalGroups()]


def found(name):
    try:
        return len(gmsh.model.getEntitiesForPhysicalName(name))
    except Exception as error:
        return f"exception: {error}"


gmsh.initialize(readConfigFiles=False)
gmsh.option.setNumber("General.Terminal", 0)
print("gmsh", gmsh.option.getString("General.Version"))
gmsh.model.add("square")
gmsh.model.occ.addRectangle(0, 0, 0, 1, 1, tag=1)
gmsh.model.occ.synchronize()
gmsh.model.addPhysicalGroup(2, [1], name="block")
gmsh.model.mesh.generate(2)
seen = {}
for path in ("square.msh", "square.med"):
    gmsh.write(path)
for path in ("square.msh", "square.med"):
    gmsh.clear()
    gmsh.open(path)
    seen[path] = (names(), found("block"))
    print(f"{path}: expected ['block'] and 1 entity of that name, seen {seen[path][0]} and {seen[path][1]}")
gmsh.finalize()
same = seen["square.msh"] == (["block"], 1)
same = same and seen["square.med"][0] == ["block".ljust(80)] and seen["square.med"][1] != 1
print("as described" if same else "CHANGED")
sys.exit(not same)
PYTHON
