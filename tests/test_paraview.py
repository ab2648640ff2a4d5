"""ParaView's own readers find in our files what the solution holds; skipped where there is no ParaView.

It runs in a process of its own, by `pvpython` or by this Python where that imports it, as its VTK is not pyvista's.
"""

from __future__ import annotations

import importlib.util
import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import test_numbers_out
from test_round_trips import between, close, solved

import contactdd as cd

#: Opens files as a user does, by what their names end in, and keeps all arrays of all times and blocks; displacements
#: also at points between the nodes, and what ParaView integrates.
READ = """
import json, sys
import numpy as np
from paraview import servermanager, simple
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersCore import vtkProbeFilter

def leaves(data):
    if not data.IsA("vtkCompositeDataSet"):
        return [data]
    walk, found = data.NewIterator(), []
    while not walk.IsDoneWithTraversal():
        found.append(walk.GetCurrentDataObject())
        walk.GoToNextItem()
    return found

def arrays(data):
    for fields in (data.GetPointData(), data.GetCellData(), data.GetFieldData()):
        for place in range(fields.GetNumberOfArrays()):
            array = fields.GetArray(place)
            yield array.GetName(), vtk_to_numpy(array)

def probed(data, x):
    points, at = vtkPoints(), vtkPolyData()
    points.SetData(numpy_to_vtk(np.pad(x, ((0, 0), (0, 3 - x.shape[1]))), deep=True))
    at.SetPoints(points)
    probe = vtkProbeFilter()
    probe.SetInputData(at)
    probe.SetSourceData(data)
    probe.Update()
    return vtk_to_numpy(probe.GetOutput().GetPointData().GetArray("displacement"))

jobs, out = json.loads(open(sys.argv[1]).read()), {}
for file, x in jobs.items():
    reader = simple.OpenDataFile(file)
    for time in list(getattr(reader, "TimestepValues", None) or [0.0]):
        reader.UpdatePipeline(time)
        for place, data in enumerate(leaves(servermanager.Fetch(reader))):
            key = f"{file}|{time:g}|{place}|"
            out[key + "points"] = vtk_to_numpy(data.GetPoints().GetData())
            out |= {key + name: array for name, array in arrays(data)}
            if x:
                out[key + "between"] = probed(data, np.array(x))
    if file.endswith(".vtu"):
        whole = servermanager.Fetch(simple.IntegrateVariables(Input=reader))
        out |= {f"{file}|integral|" + name: array for name, array in arrays(whole)}
np.savez(sys.argv[2], **out)
"""


def interpreter() -> str:
    """A Python that imports ParaView; the tests are skipped where there is none."""
    own = sys.executable if importlib.util.find_spec("paraview") else None
    found = shutil.which("pvpython") or own
    if found is None:
        pytest.skip("ParaView is not installed: neither pvpython nor the module paraview is there")
    return found


NAMES = ("plane", "rings", "hexahedra", "tetrahedra", "bond")
Told = dict[str, Any]


@pytest.fixture(scope="module")
def path() -> cd.LoadPath:
    load = cd.Parameter(0.0)
    return cd.programme(test_numbers_out.blocks(load=load), load, [5.0, 10.0, 5.0])


@pytest.fixture(scope="module")
def told(path, tmp_path_factory) -> Told:
    """What ParaView reads: {"scene/file|time|block|array" or "scene/file|integral|array": values}."""
    python, folder = interpreter(), tmp_path_factory.mktemp("paraview")
    jobs: dict[str, Any] = {str(path.export(folder / "programme")[0]): None}
    for name in NAMES:
        solution = solved(name)
        bodies = {body.name: between(solution.body(body).points).tolist() for body in solution.scene.bodies}
        jobs |= {str(file): bodies.get(file.stem) for file in solution.export(folder / name)}
    (folder / "read.py").write_text(READ)
    (folder / "jobs.json").write_text(json.dumps(jobs))
    command = [python, folder / "read.py", folder / "jobs.json", folder / "told.npz"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    with np.load(folder / "told.npz") as arrays:
        return {str(Path(key).relative_to(folder)): values for key, values in arrays.items()}


@pytest.mark.parametrize("name", NAMES)
def test_bodies(told, name):
    """Nodes and nodal values to the last bit, the shape functions between them, and the volume of all cells."""
    solution = solved(name)
    for body in solution.scene.bodies:
        own, dim = solution.body(body), body.mesh.dim
        read = f"{name}/{body.name}.vtu|0|0|"
        np.testing.assert_array_equal(told[read + "points"][:, :dim], own.points)
        np.testing.assert_array_equal(told[read + "displacement"][:, :dim], own.displacement)
        np.testing.assert_array_equal(told[read + "stress"], own.stress[:, [0, 1, 2, 5, 3, 4]])
        np.testing.assert_array_equal(told[read + "von Mises"], own.von_mises)
        u = solution.displacement_at(body, between(own.points))
        found = told[read + "between"][:, :dim]
        # Up to a thousandth of a cell beyond a face it may be the neighbour's function.
        np.testing.assert_allclose(found, u, rtol=0, atol=1e-3 * np.abs(u).max())
        size = told[f"{name}/{body.name}.vtu|integral|{'Area' if dim == 2 else 'Volume'}"]
        assert size == pytest.approx(np.prod(np.ptp(own.points, axis=0)), rel=1e-6)  # of flat pieces of the cells


@pytest.mark.parametrize("name", NAMES)
def test_contacts(told, name):
    """Points and facets to the last bit; the pressure on the facets integrates to the force."""
    solution = solved(name)
    result, sides = solution.contact(), solution.scene.contacts[0].sides
    contact = solution.scene.contacts[0].name.replace("–", "-")
    for array in ("pressure", "gap", "compression"):
        np.testing.assert_array_equal(told[f"{name}/{contact} points.vtu|0|0|{array}"], getattr(result, array))
    for second, (body, _) in enumerate(sides):
        surface, file = solution.contact_surface(second=bool(second)), f"{name}/{contact} on {body.name}.vtu"
        for array in ("pressure", "gap", "compression", "status"):
            own, text = getattr(surface, array), told[f"{name}/contacts.xdmf|0|{second}|{array}"]
            np.testing.assert_array_equal(told[f"{file}|0|0|{array}"], own)
            np.testing.assert_array_equal(text, own[surface.status > 0])
        if not result.ring:  # ParaView knows no rings
            close(told[f"{file}|integral|pressure"][0], result.force)


def test_a_load_programme(told, path):
    """The series has the steps as times, and in each the parameter and the step's fields."""
    for step, (solution, value) in enumerate(zip(path.solutions, path.values, strict=True), 1):
        read = f"programme/series.pvd|{step}|"
        assert told[read + "0|parameter"] == [float(value)]
        np.testing.assert_array_equal(told[read + "0|displacement"][:, :2], solution.body("lower").displacement)
        np.testing.assert_array_equal(told[read + "2|pressure"], solution.contact().pressure)
        np.testing.assert_array_equal(told[read + "3|pressure"], solution.contact_surface().pressure)
    assert f"programme/series.pvd|{len(path) + 1}|0|parameter" not in told
