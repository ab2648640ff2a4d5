#!/usr/bin/env bash
# gmsh 4.15.2: a tetrahedron of third order in a VTK file (.vtk) that gmsh writes is another body in VTK and ParaView.
#
# Input:    a tetrahedron of the volume 1/6 with straight edges, raised to third order and saved by gmsh as .vtk; for
#           comparison a triangle of the area 1/2, treated alike.
# Expected: the nodes of VTK's cell type 71, which gmsh gives the cell, in VTK's order: the corners 0 to 3; two nodes on
#           each of the edges 01, 12, 20, 03, 13, 23, from the first corner to the second; one on each face. VTK 9.7.2
#           measures 1/6, as it does with the same nodes in that order (below: the nodes where VTK's own cell has them).
# Seen:     the triangle is right. The tetrahedron's nodes on the edges to corner 3 and on the faces are in gmsh's own
#           order, though its second-order tetrahedra are put into VTK's: VTK measures -0.012. gmsh reads what it has
#           written, so a mesh saved and opened by gmsh alone shows nothing.
# Exit:     0 if that is still so, 1 if the behaviour has changed.
#
# gmsh needs the system's libGLU, libXft, libXcursor and libXinerama.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"${PYTHON:-python3}" -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check gmsh==4.15.2 vtk==9.7.2 numpy==2.2.6
cd "$work"
"$work/venv/bin/python" - <<'PYTHON'
import sys

import gmsh
import numpy as np
from vtkmodules.vtkCommonCore import vtkPoints, vtkVersion
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
from vtkmodules.vtkIOLegacy import vtkUnstructuredGridReader

CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
ORDER = 3


def write(path, dimension, element_type):
    """A simplex, saved by gmsh; element_type: gmsh's number of it with straight edges."""
    gmsh.clear()
    gmsh.model.add(path)
    gmsh.model.addDiscreteEntity(dimension, 1)
    nodes = range(1, dimension + 2)
    gmsh.model.mesh.addNodes(dimension, 1, nodes, [x for corner in CORNERS[: dimension + 1] for x in corner])
    gmsh.model.mesh.addElementsByType(1, element_type, [1], nodes)
    gmsh.model.mesh.setOrder(ORDER)
    gmsh.write(path)


def grid_in(path):
    reader = vtkUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def size(grid, name):
    sizes = vtkCellSizeFilter()
    sizes.SetInputData(grid)
    sizes.Update()
    return round(sizes.GetOutput().GetCellData().GetArray(name).GetValue(0), 6)


def places(grid):
    """Where the cell's nodes are, and where VTK has them in the reference cell."""
    cell = grid.GetCell(0)
    count = cell.GetNumberOfPoints()
    there = np.array([cell.GetPoints().GetPoint(node) for node in range(count)])
    return there, np.reshape(cell.GetParametricCoords(), (-1, 3))[:count]


def move(grid, places):
    """The same cell with its nodes at other places: the reference cell is the tetrahedron itself."""
    nodes, points = grid.GetCell(0).GetPointIds(), vtkPoints()
    points.SetNumberOfPoints(len(places))
    for node, place in enumerate(places):
        points.SetPoint(nodes.GetId(node), *place)
    grid.SetPoints(points)
    return grid


def sorted_rows(points):
    return sorted(np.round(points, 6).tolist())


gmsh.initialize(readConfigFiles=False)
gmsh.option.setNumber("General.Terminal", 0)
gmsh.logger.start()
print("gmsh", gmsh.option.getString("General.Version"), "and VTK", vtkVersion.GetVTKVersion())
write("triangle.vtk", 2, 2)
write("tetrahedron.vtk", 3, 4)
told = [line for line in gmsh.logger.get() if line.startswith(("Warning", "Error"))]
gmsh.finalize()

area, grid = size(grid_in("triangle.vtk"), "Area"), grid_in("tetrahedron.vtk")
volume, (there, documented) = size(grid, "Volume"), places(grid)
moved = [node for node in range(len(there)) if not np.allclose(there[node], documented[node], atol=1e-6)]
complete = sorted_rows(there) == sorted_rows(documented)
right = size(move(grid, documented), "Volume")
print("area of the triangle: expected 0.5, seen", area)
print("volume of the tetrahedron in VTK's order: expected 0.166667, seen", right)
print("volume of the tetrahedron as gmsh wrote it: expected 0.166667, seen", volume)
print("nodes out of their places: expected [], seen", moved, "- all nodes are there:", complete)
print("warnings and errors in the log:", told)
same = area == 0.5 and right == 0.166667 and volume == -0.012346 and complete and not told
same = same and moved == [10, 11, 12, 13, 14, 15, 16, 17, 19]
print("as described" if same else "CHANGED")
sys.exit(not same)
PYTHON
