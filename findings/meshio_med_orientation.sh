#!/usr/bin/env bash
# meshio 5.3.5: volume cells of a MED file (.med) are inside out, when it is read and when it is written.
#
# Input:    a tetrahedron that gmsh saves as .msh and as .med; and the mesh that meshio has read from the .msh, saved by
#           meshio as .med. medcoupling 9.15.0, of the format's own authors, measures both .med files.
# Expected: the volume 1/6 each time. meshio's cells have VTK's order of nodes, in which the first three nodes of a
#           tetrahedron turn anticlockwise seen from the fourth. In a MED file they turn clockwise: SALOME's
#           documentation draws its elements so and takes the convention from MED; medcoupling's signed volumes are
#           positive for them, and gmsh exchanges nodes accordingly.
# Seen:     1/6 from the .msh file and by medcoupling in gmsh's .med file, but -1/6 by meshio in gmsh's .med file and by
#           medcoupling in meshio's: meshio copies the nodes as they are. Nothing is said; an old report (issue 144)
#           is closed.
# Exit:     0 if that is still so, 1 if the behaviour has changed.
#
# gmsh needs the system's libGLU, libXft, libXcursor and libXinerama.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"${PYTHON:-python3}" -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check \
  meshio==5.3.5 numpy==2.2.6 rich==14.0.0 h5py==3.16.0 gmsh==4.15.2 medcoupling==9.15.0
cd "$work"
"$work/venv/bin/python" - <<'PYTHON'
import contextlib
import io
import sys

import gmsh
import medcoupling
import meshio
import numpy as np


def write_by_gmsh(*paths):
    gmsh.initialize(readConfigFiles=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("tetrahedron")
    gmsh.model.addDiscreteEntity(3, 1)
    gmsh.model.mesh.addNodes(3, 1, [1, 2, 3, 4], [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1])
    gmsh.model.mesh.addElementsByType(1, 4, [1], [1, 2, 3, 4])
    gmsh.model.addPhysicalGroup(3, [1], name="body")
    for path in paths:
        gmsh.write(path)
    gmsh.finalize()


def by_meshio(mesh):
    (nodes,) = mesh.cells_dict["tetra"]
    origin, *ends = mesh.points[nodes]
    return round(float(np.linalg.det(np.array(ends) - origin)) / 6, 12)


def by_medcoupling(path):
    mesh = medcoupling.MEDFileUMesh(path).getMeshAtLevel(0)
    signed = False  # its argument: whether to take absolute values
    return round(mesh.getMeasureField(signed).getArray().getValues()[0], 12)


write_by_gmsh("gmsh.msh", "gmsh.med")
said = io.StringIO()
with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
    mesh = meshio.read("gmsh.msh")
    meshio.Mesh(mesh.points, {"tetra": mesh.cells_dict["tetra"]}).write("meshio.med")
    seen = {
        "gmsh's .msh by meshio": by_meshio(mesh),
        "gmsh's .med by medcoupling": by_medcoupling("gmsh.med"),
        "gmsh's .med by meshio": by_meshio(meshio.read("gmsh.med")),
        "meshio's .med by medcoupling": by_medcoupling("meshio.med"),
    }
sixth = round(1 / 6, 12)
print("meshio", meshio.__version__)
for name, volume in seen.items():
    print(f"{name}: expected {sixth}, seen {volume}")
told = said.getvalue().strip()
print("said by meshio:", repr(told))
same = list(seen.values()) == [sixth, sixth, -sixth, -sixth] and "arning" not in told
print("as described" if same else "CHANGED")
sys.exit(not same)
PYTHON
