"""Numbers that leave as files come back as they were: tables, saved solutions and fields, of one rank or several."""

from __future__ import annotations

import csv
import functools
import os
import textwrap
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import dolfinx
import numpy as np
import pytest
import scipy.spatial
import test_bonded
import test_gasket
import test_hard_contact
import test_numbers_out
from scenes import STEEL, groove
from test_ranks import launch

import contactdd as cd

TESTS = os.path.dirname(__file__)


def solids(shape: str = "hexahedron", comm: Any = None) -> cd.Scene:
    """Two blocks in space, whose meshes and degrees do not match, with a groove between."""
    held = cd.Symmetry("left", "right", "front", "back")
    low = cd.Body("low", cd.box((0, 0, 0), (2, 1, 1), (4, 2, 2), shape=shape), STEEL, degree=2)
    high = cd.Body("high", cd.box((0, 0, 1), (2, 1, 2), (5, 1, 1), shape=shape), STEEL)
    low.supports, high.supports, high.loads = (held, cd.Symmetry("bottom")), (held,), (cd.Pressure("top", 10.0),)
    contact = cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(1e6), gap=lambda x: groove(x, 2e-5))
    return cd.Scene([low, high], [contact], **({} if comm is None else {"comm": comm}))


def rings() -> cd.Scene:
    """A press fit of two rings, the outer one shorter."""
    inner, outer = (
        cd.Body(name, cd.rectangle((a, 0), (a + 10, height), (4, 3)), STEEL, degree=degree, kinematics="axisymmetric")
        for name, a, height, degree in (("inner", 10, 5, 2), ("outer", 20, 4, 1))
    )
    inner.supports = outer.supports = (cd.Symmetry("bottom"),)
    return cd.Scene([inner, outer], [cd.Contact((inner, "right"), (outer, "left"), cd.LinearLayer(1e6), gap=-0.01)])


GLUE = cd.BondedLayer(cd.LinearLayer(1e5), shear_stiffness=2e4)

#: Whatever has a field of its own: a groove on unlike meshes, rings, solids, a bond's slip and shear, a gasket's
#: memory, a hard contact's pressures at nodes.
SCENES: dict[str, Callable[[], cd.Scene]] = {
    "plane": lambda: test_numbers_out.blocks(lambda x: groove(x, middle=1.5)),
    "rings": rings,
    "hexahedra": solids,
    "tetrahedra": lambda: solids("tetrahedron"),
    "bond": lambda: test_bonded.blocks(GLUE, [1.0, 3.0], cells=((4, 2), (5, 2))),
    "gasket": lambda: test_gasket.pressed(test_gasket.MEASURED, 6.0),
    "hard": lambda: test_hard_contact.pressed_blocks((8, 11)),
}
every = pytest.mark.parametrize("name", SCENES)


@functools.cache
def solved(name: str) -> cd.Solution:
    return cd.solve(SCENES[name]())


def same(found: Any, expected: Any) -> None:
    """The same kind of thing, with the same numbers to the last bit, field by field."""
    expected, found = (value() if callable(value) else value for value in (expected, found))
    if is_dataclass(expected):
        assert type(found) is type(expected)
        for each in fields(expected):
            same(getattr(found, each.name), getattr(expected, each.name))
    elif isinstance(expected, tuple) and any(map(is_dataclass, expected)):
        assert len(found) == len(expected)
        for one, other in zip(found, expected, strict=True):
            same(one, other)
    else:
        np.testing.assert_array_equal(found, expected)


def read(path: Path) -> dict[str, list[float]]:
    """The columns of a CSV file."""
    with open(path, newline="") as file:
        names, *rows = csv.reader(file)
    return {name: [float(row[place]) for row in rows] for place, name in enumerate(names)}


def vector(name: str, values: Any) -> dict[str, Any]:
    return {f"{name}{axis}": values[:, place] for place, axis in enumerate("xyz"[: values.shape[1]])}


@every
def test_a_table_of_a_contact(name, tmp_path):
    """Every column, and no other, is the result's own to the last digit."""
    result = solved(name).contact()
    own = result.sorted()
    expected = vector("", own.x) | vector("normal_", own.normal)
    expected |= {"weight": own.weights, "initial_gap": own.initial_gap, "gap": own.gap}
    expected |= {"compression": own.compression, "pressure": own.pressure, "closed": own.closed}
    if own.x.shape[1] == 2:
        expected["arc_length"] = own.arc_length
    if name == "bond":
        expected |= vector("slip_", own.slip) | vector("shear_", own.shear)
    if name == "gasket":
        expected["largest_closure"] = own.largest_closure
    found = read(result.to_csv(tmp_path / "contact.csv"))
    assert set(found) == set(expected)
    for column, values in expected.items():
        np.testing.assert_array_equal(found[column], values, err_msg=column)
    # What is left out of a table is made of it: the force and where it acts do not need the file's program.
    assert np.dot(found["weight"], found["pressure"]) == pytest.approx(result.force, rel=1e-12)


def test_tables_of_runs(tmp_path):
    """Every number of a history, and of a load programme by an array."""
    history = solved("plane").history
    with open(history.to_csv(tmp_path / "history.csv"), newline="") as file:
        rows = list(csv.DictReader(file))
    for row, record in zip(rows, history, strict=True):
        assert {key: type(getattr(record, key))(value) for key, value in row.items()} == vars(record)
    pull = cd.Parameter([0.0, 0.0])
    record = {"force": lambda solution: solution.contact().force_vector}
    path = cd.programme(test_bonded.blocks(GLUE, pull), pull, [[0.1, 3.0], [1 / 3, 5.0]], record=record)
    table = read(path.to_csv(tmp_path / "path.csv"))
    np.testing.assert_array_equal(np.transpose([table["parameter_0"], table["parameter_1"]]), path.values)
    np.testing.assert_array_equal(np.transpose([table["force_0"], table["force_1"]]), path.records["force"])
    np.testing.assert_allclose(
        path.records["force"], 2.0 * np.array(path.values), rtol=1e-8
    )  # 2 wide; solve's tolerance


@every
def test_a_saved_solution(name, tmp_path):
    """Every field of every result, the forces, the numbers and the history."""
    solution = solved(name)
    again = cd.load_solution(solution.save(tmp_path))
    for body in solution.scene.bodies:
        same(again.body(body.name), solution.body(body))
        forces = solution.forces(body)
        assert again.forces(body.name).keys() == forces.keys()
        for part, force in forces.items():
            np.testing.assert_array_equal(again.forces(body.name)[part], force)
    result = again.contact()
    same(result, solution.contact())
    for told in ("force", "force_vector", "area", "peak_pressure", "centre_of_pressure", "mean_approach", "edge"):
        if told != "edge" or result.x.shape[1] == 2:
            np.testing.assert_array_equal(getattr(result, told), getattr(solution.contact(), told))
    for second in (False, True):
        same(again.contact_surface(second=second), solution.contact_surface(second=second))
    assert {key: getattr(solution, key) for key in again.numbers} == again.numbers
    assert list(again.history) == list(solution.history)
    assert (again.status, again.reason, again.method) == (solution.status, solution.reason, solution.method)


def exported(solution: cd.Solution, folder: Path) -> dict[str, Any]:
    """The grids in the files, by their files' names."""
    pyvista = pytest.importorskip("pyvista")
    return {file.stem: pyvista.read(file) for file in solution.export(folder) if file.suffix == ".vtu"}


def close(found: Any, expected: Any) -> None:
    """To rounding: sums over the cells around a node, or over the points of a facet."""
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.nanmax(np.abs(expected), initial=1e-300))


@every
def test_the_fields_of_bodies(name, tmp_path):
    """Displacements and stresses are those of the solution's functions, interpolated by dolfinx."""
    pyvista, solution = pytest.importorskip("pyvista"), solved(name)
    grids = exported(solution, tmp_path)
    for body in solution.scene.bodies:
        grid, dim = grids[body.name], body.mesh.dim
        assert set(grid.array_names) == {"displacement", "stress", "von Mises", "stress of cell"}
        stress = dolfinx.fem.Function(dolfinx.fem.functionspace(body.mesh.domain, ("DG", body.degree, (6,))))
        stress.interpolate(solution.stress(body))
        values = stress.x.array.reshape(-1, 6)[:, [0, 1, 2, 5, 3, 4]]  # VTK: xx, yy, zz, xy, yz, xz
        x, cells = stress.function_space.tabulate_dof_coordinates(), stress.function_space.dofmap.list
        nodes = grid.cells.reshape(grid.n_cells, -1)[:, 1:]
        close(grid.points[nodes].mean(axis=1), x[cells].mean(axis=1))
        close(grid.cell_data["stress of cell"], values[cells].mean(axis=1))
        away, node = scipy.spatial.KDTree(grid.points).query(x)
        assert away.max() < 1e-9
        means = [np.bincount(node, column) / np.bincount(node) for column in values.T]
        close(grid.point_data["stress"], np.transpose(means))
        xx, yy, zz, xy, yz, xz = means
        mises = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (xy**2 + yz**2 + xz**2)
        close(grid.point_data["von Mises"], np.sqrt(mises))
        close(grid.point_data["displacement"][:, :dim], solution.displacement_at(body, grid.points[:, :dim]))
        # Between nodes, by VTK's shape functions: a thousandth of a cell beyond a face they may be the neighbour's.
        inside = between(grid.points[:, :dim])
        u, in_space = solution.displacement_at(body, inside), np.pad(inside, ((0, 0), (0, 3 - dim)))
        found = pyvista.PolyData(in_space).sample(grid)["displacement"][:, :dim]
        np.testing.assert_allclose(found, u, rtol=0, atol=1e-3 * np.abs(u).max())


def between(x: Any) -> Any:
    """Points (20, dim) in the middle half of what the points x (n, dim) span."""
    part = np.random.default_rng(4).uniform(0.25, 0.75, (20, x.shape[1]))
    return x.min(axis=0) + part * np.ptp(x, axis=0)


@every
def test_the_fields_of_contacts(name, tmp_path):
    """Every array, and no other, of the points and of both surfaces is the solution's own."""
    solution = solved(name)
    grids, result = exported(solution, tmp_path), solution.contact()
    contact = solution.scene.contacts[0].name.replace("–", "-")
    expected = {each: getattr(result, each) for each in ("pressure", "gap", "compression", "normal")}
    expected |= {"status": np.where(result.closed, 3, 1), "weight": result.weights, "initial gap": result.initial_gap}
    expected |= {"slip": result.slip, "shear": result.shear} if name == "bond" else {}
    expected |= {"largest closure": result.largest_closure} if name == "gasket" else {}
    compared(grids[f"{contact} points"], expected, result.x)
    carriers = 0
    for second, (body, _) in enumerate(solution.scene.contacts[0].sides):
        surface = solution.contact_surface(second=bool(second))
        own = ("pressure", "gap", "compression", "status", "closed", "covered", "displacement")
        expected = {each: getattr(surface, each) for each in own} | {"area": surface.areas}
        if surface.projected_pressure is not None:
            expected["projected pressure"] = surface.projected_pressure
            node = scipy.spatial.KDTree(result.node_x).query(surface.points)
            vertices = node[0] < 1e-9  # the linear field's own nodes; those in between are interpolated
            close(surface.projected_pressure[vertices], result.nodal_pressure[node[1][vertices]])
            carriers += 1
        grid = grids[f"{contact} on {body.name}"]
        compared(grid, expected, surface.points)
        close(surface.displacement, solution.displacement_at(body, surface.points))
        assert surface.areas @ surface.pressure == pytest.approx(result.force, rel=1e-10)
    assert carriers == 1


def compared(grid: Any, expected: dict[str, Any], x: Any) -> None:
    """The grid's points and arrays are the same 64 bits."""
    np.testing.assert_array_equal(grid.points[:, : x.shape[1]], x)
    assert set(grid.array_names) == set(expected)
    for each, values in expected.items():
        found = np.asarray(grid[each])
        np.testing.assert_array_equal(found[:, : x.shape[1]] if found.ndim == 2 else found, values, err_msg=each)


RANKS = """
    import sys
    from mpi4py import MPI
    sys.path.insert(0, {tests!r})
    import contactdd as cd, test_numbers_out, test_round_trips
    load = cd.Parameter(0.0)
    plane = test_numbers_out.blocks(load=load)
    plane = cd.Scene(plane.bodies, plane.contacts, comm=MPI.COMM_WORLD)
    solution = cd.solve(test_round_trips.solids(comm=MPI.COMM_WORLD))
    path = cd.programme(plane, load, [5.0, 10.0], record={{"force": lambda s: s.contact().force}})
    files = solution.export({folder!r}) + path.export({folder!r} + "/series")
    assert all(file.is_file() for file in files), files
    solution.save({folder!r} + "/saved")
    if MPI.COMM_WORLD.rank == 0:
        path.to_csv({folder!r} + "/path.csv")
    result = solution.contact()
    if MPI.COMM_WORLD.rank == 0:
        result.to_csv({folder!r} + "/contact.csv")
"""


def numbers(file: Path) -> dict[str, Any]:
    """All arrays in a file, of any kind that is written."""
    if file.suffix == ".vtu":
        grid = pytest.importorskip("pyvista").read(file)
        return {"points": grid.points, "cells": grid.cells} | {name: grid[name] for name in grid.array_names}
    if file.suffix == ".csv":
        return {name: np.array(column) for name, column in read(file).items()}
    if file.suffix == ".npz":
        with np.load(file) as arrays:
            return dict(arrays)
    return {}


def test_the_files_of_several_ranks(tmp_path):
    """Of a contact in space and of a load programme: the same files, with the same numbers."""
    for ranks in (1, 2):
        done = launch(ranks, textwrap.dedent(RANKS.format(tests=TESTS, folder=str(tmp_path / str(ranks)))))
        assert done.returncode == 0, done.stderr
    one, two = tmp_path / "1", tmp_path / "2"
    names = sorted(file.relative_to(one) for file in one.rglob("*.*"))
    assert names == sorted(file.relative_to(two) for file in two.rglob("*.*"))
    assert {name.suffix for name in names} == {".vtu", ".pvd", ".xdmf", ".csv", ".npz", ".json"}
    assert (one / "series" / "series.pvd").read_bytes() == (two / "series" / "series.pvd").read_bytes()
    for name in names:
        mine, other = numbers(one / name), numbers(two / name)
        assert mine.keys() == other.keys()
        for key, values in mine.items():
            # Ranks add in another order, and stop at residuals of 1e-10; here the layers amplify that tenfold.
            size = np.nanmax(np.abs(values), initial=0.0)
            np.testing.assert_allclose(other[key], values, rtol=0, atol=1e-8 * size, err_msg=f"{name}: {key}")
