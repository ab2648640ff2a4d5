#!/usr/bin/env bash
# gmsh 4.15.2: after one open that has failed, open and mesh.generate do nothing any more, and raise nothing.
#
# Input:    a mesh of one triangle, opened before and after an open of a path at which there is no file. The caller
#           catches the exception of the failed open and goes on, as a loop over many files would.
# Expected: the second open of the mesh gives its three nodes like the first; a rectangle is meshed; or an exception.
# Seen:     open returns as if all were well, but loads nothing; generate returns and there are no nodes. clear()
#           does not help. Only the log knows, and as an information, not as an error. It ends with finalize().
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

NODES = "$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n"
ELEMENTS = "$Elements\n1\n1 2 2 1 1 1 2 3\n$EndElements\n"
Path("triangle.msh").write_text("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + NODES + ELEMENTS)


def begin():
    gmsh.initialize(readConfigFiles=False)
    gmsh.option.setNumber("General.Terminal", 0)


def nodes():
    return len(gmsh.model.mesh.getNodes()[0])


def opened():
    gmsh.open("triangle.msh")
    return nodes()


def meshed():
    gmsh.clear()
    gmsh.model.add("rectangle")
    gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
    gmsh.model.occ.synchronize()
    gmsh.model.mesh.generate(2)
    return nodes() > 0


begin()
print("gmsh", gmsh.option.getString("General.Version"))
before = (opened(), meshed())
try:
    gmsh.open("not_there.msh")
    failure = None
except Exception as error:
    failure = str(error)
gmsh.logger.start()
after = (opened(), meshed())
log = gmsh.logger.get()
gmsh.finalize()
begin()
again = (opened(), meshed())
gmsh.finalize()

print("nodes of the mesh and whether the rectangle was meshed, before the failure:", before)
print("the failed open raised:", failure)
print("expected after it:", before)
print("seen after it:    ", after)
print("log:", [line for line in log if "busy" in line])
print("after finalize and initialize:", again)
same = before == again == (3, True) and failure is not None and after == (0, False)
print("as described" if same else "CHANGED")
sys.exit(not same)
PYTHON
