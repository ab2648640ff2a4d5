#!/usr/bin/env bash
# gmsh 4.15.2: a second-order brick of a VTK file (.vtk) gets the middles of its edges in the wrong places.
#
# Input:    one cube as VTK's cell type 25 (20 nodes), written by the script in the order of VTK's documentation: the
#           corners, then the middles of the bottom's edges, of the top's and of the upright ones; for comparison as
#           type 12 (8 nodes), a tetrahedron of type 24 (10 nodes), and the cube of 20 nodes that gmsh writes itself.
# Expected: a cube and a tetrahedron with straight edges: each element's worst scaled Jacobian is 1.
# Seen:     1 but for the brick of 20 nodes: there it is -53, without a warning. gmsh numbers the edges of a brick
#           otherwise than VTK; when it writes .vtk it puts them into VTK's order, when it reads .vtk it does not put
#           them back, so that it cannot read its own file either.
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

CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
CUBE_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
TETRAHEDRON = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
TETRAHEDRON_EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]


def with_middles(corners, edges):
    return corners + [tuple((a + b) / 2 for a, b in zip(corners[i], corners[j], strict=True)) for i, j in edges]


def write(path, cell_type, points):
    lines = ["# vtk DataFile Version 2.0", path, "ASCII", "DATASET UNSTRUCTURED_GRID", f"POINTS {len(points)} double"]
    lines += [f"{x} {y} {z}" for x, y, z in points]
    lines += [f"CELLS 1 {len(points) + 1}", " ".join(map(str, [len(points), *range(len(points))]))]
    Path(path).write_text("\n".join([*lines, "CELL_TYPES 1", str(cell_type), ""]))


def write_by_gmsh(path, points):
    gmsh.clear()
    gmsh.model.add("cube")
    gmsh.model.addDiscreteEntity(3, 1)
    gmsh.model.mesh.addNodes(3, 1, range(1, 9), [x for point in points for x in point])
    gmsh.model.mesh.addElementsByType(1, 5, [1], range(1, 9))
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
    gmsh.model.mesh.setOrder(2)
    gmsh.write(path)


def cell_in(path):
    """The points of the only cell, in its order."""
    lines = Path(path).read_text().splitlines()
    number = {line.split()[0]: index for index, line in enumerate(lines) if line}
    rows = lines[number["POINTS"] + 1 :][: int(lines[number["POINTS"]].split()[1])]
    points = [tuple(round(float(x), 9) for x in row.split()) for row in rows]
    return [points[int(node)] for node in lines[number["CELLS"] + 1].split()[1:]]


def worst_jacobian(path):
    gmsh.clear()
    gmsh.open(path)
    (elements,) = gmsh.model.mesh.getElements(3)[1]
    (quality,) = gmsh.model.mesh.getElementQualities(elements, "minSJ")
    return round(float(quality), 6)


gmsh.initialize(readConfigFiles=False)
gmsh.option.setNumber("General.Terminal", 0)
print("gmsh", gmsh.option.getString("General.Version"))
brick = with_middles(CUBE, CUBE_EDGES)
write("brick20.vtk", 25, brick)
write("brick8.vtk", 12, CUBE)
write("tetrahedron10.vtk", 24, with_middles(TETRAHEDRON, TETRAHEDRON_EDGES))
write_by_gmsh("brick20_by_gmsh.vtk", CUBE)
right = cell_in("brick20_by_gmsh.vtk") == brick
print("nodes of the cube that gmsh writes in VTK's order: expected True, seen", right)
gmsh.logger.start()
seen = {}
for path in ("brick8.vtk", "tetrahedron10.vtk", "brick20.vtk", "brick20_by_gmsh.vtk"):
    seen[path] = worst_jacobian(path)
    print(f"{path}: expected 1.0, seen {seen[path]}")
told = [line for line in gmsh.logger.get() if line.startswith(("Warning", "Error"))]
print("warnings and errors in the log:", told)
gmsh.finalize()
same = right and list(seen.values()) == [1, 1, -53, -53] and not told
print("as described" if same else "CHANGED")
sys.exit(not same)
PYTHON
