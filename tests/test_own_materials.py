"""Materials from dolfinx' objects: Functions, named parts of a mesh, classes of one's own; motions from Functions."""

from __future__ import annotations

import numpy as np
import pytest
import ufl
from dolfinx import fem
from dolfinx import mesh as dmesh
from mpi4py import MPI
from scenes import STEEL

import contactdd as cd

SOFT, HARD = cd.Isotropic(1e3, 0.2), cd.Isotropic(1e5, 0.3)
K, P = 1e4, 5.0


def tagged(cells: tuple[int, int] = (4, 8), shape: str = "triangle") -> tuple[dmesh.Mesh, dmesh.MeshTags]:
    """A column 1 × 2 of which the cells above y = 1 have the tag 7, the others 3."""
    kind = dmesh.CellType[shape]
    domain = dmesh.create_rectangle(MPI.COMM_SELF, [(0.0, 0.0), (1.0, 2.0)], cells, kind)
    count = domain.topology.index_map(2).size_local
    middles = dmesh.compute_midpoints(domain, 2, np.arange(count, dtype=np.int32))
    values = np.where(middles[:, 1] > 1, 7, 3).astype(np.int32)
    return domain, dmesh.meshtags(domain, 2, np.arange(count, dtype=np.int32), values)


SIDES = {
    "left": lambda x: np.isclose(x[0], 0),
    "right": lambda x: np.isclose(x[0], 1),
    "bottom": lambda x: np.isclose(x[1], 0),
    "top": lambda x: np.isclose(x[1], 2),
}


def column(material: object, mesh: cd.Mesh, **options: object) -> cd.Scene:
    """A column between walls, pressed from above by a stiff block."""
    walls = [cd.Symmetry("left", "right")]
    body = cd.Body("column", mesh, material, supports=[*walls, cd.Fixed("bottom")], **options)
    lid = cd.Body(
        "lid", cd.rectangle((0, 2), (1, 3), (4, 4)), STEEL, supports=walls, loads=[cd.Pressure("top", P)],
    )  # fmt: skip
    return cd.Scene([body, lid], [cd.Contact((body, "top"), (lid, "bottom"), cd.LinearLayer(K))])


def oedometer(material: cd.Isotropic) -> float:
    """E (1 − ν) / ((1 + ν)(1 − 2ν)): the stiffness of a column between walls."""
    return material.stiffness()[0, 0]


def test_two_materials_by_cell_tags():
    """Two columns in series: exact, also through refinement, copies, pieces and a higher degree."""
    domain, tags = tagged()
    mesh = cd.from_dolfinx(domain, cell_tags=tags, subdomains={"soft": 3, "hard": 7}, **SIDES)
    shrinks = P / oedometer(SOFT) + P / oedometer(HARD)
    materials = {"soft": SOFT, "hard": HARD}
    for each in (mesh, mesh.refined(), mesh.refined([0, 5])):
        solution = cd.solve(column(materials, each), tolerance=1e-11)
        np.testing.assert_allclose(solution.displacement_at("column", [[0.3, 2.0]])[0], [0, -shrinks], atol=1e-10)
        stress = solution.stress_at("column", [[0.4, 0.3], [0.4, 1.7]])
        ratios = [m.nu / (1 - m.nu) for m in (SOFT, HARD)]
        np.testing.assert_allclose(stress[:, 1], -P, rtol=1e-8)
        np.testing.assert_allclose(stress[:, 0], -P * np.array(ratios), rtol=1e-8)
    estimate = cd.error_estimate(cd.solve(column(materials, mesh)))
    assert estimate.pressure.relative < 1e-6  # the solution is exact in elements of any degree
    assert len(mesh.moved((0, 3)).subdomains["hard"]) == len(mesh.subdomains["hard"])


@pytest.mark.parametrize("shape", ["triangle", "quadrilateral"])
def test_constants_as_functions(shape):
    """E and ν as Functions with a value in each cell, and as expressions, are the named parts' constants."""
    domain, tags = tagged(shape=shape)
    mesh = cd.from_dolfinx(domain, cell_tags=tags, subdomains={"soft": 3, "hard": 7}, **SIDES)
    expected = cd.solve(column({"soft": SOFT, "hard": HARD}, mesh)).displacement("column").x.array
    space = fem.functionspace(domain, ("DG", 0))
    E, nu = fem.Function(space), fem.Function(space)
    for function, soft, hard in ((E, SOFT.E, HARD.E), (nu, SOFT.nu, HARD.nu)):
        function.x.array[:] = np.where(tags.values == 7, hard, soft)
    hard = ufl.conditional(ufl.gt(E, 5e4), HARD.E, SOFT.E)
    for material in (cd.Isotropic(E, nu), cd.Isotropic(hard, nu), cd.Isotropic(2 * E / 2, nu).rotated(0.3)):
        found = cd.solve(column(material, mesh)).displacement("column").x.array
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
    tensors = fem.Function(fem.functionspace(domain, ("DG", 0, (6, 6))))
    tensors.x.array.reshape(-1, 36)[:] = np.where(
        (tags.values == 7)[:, None], HARD.stiffness().ravel(), SOFT.stiffness().ravel()
    )
    found = cd.solve(column(cd.Anisotropic(tensors), mesh)).displacement("column").x.array
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_heat_in_two_materials():
    """α as a Function beside two materials: a held column has one pressure through both."""
    domain, tags = tagged()
    mesh = cd.from_dolfinx(domain, cell_tags=tags, subdomains={"soft": 3, "hard": 7}, **SIDES)
    alpha = fem.Function(fem.functionspace(domain, ("DG", 0)))
    alpha.x.array[:] = np.where(tags.values == 7, 1e-5, 1e-4)
    heat = cd.ThermalStrain(alpha, 10.0)
    solution = cd.solve(column({"soft": SOFT, "hard": HARD}, mesh, loads=[heat]), tolerance=1e-11)
    # Each part grows by (1 + ν)/(1 − ν) α ΔT along the column less what the lid's pressure takes away.
    grown = sum((1 + m.nu) / (1 - m.nu) * a * 10 - P / oedometer(m) for m, a in ((SOFT, 1e-4), (HARD, 1e-5)))
    assert solution.displacement_at("column", [[0.5, 2.0]])[0, 1] == pytest.approx(grown, rel=1e-9)


def test_changed_material_is_refused():
    """A stiffness is made once: a Function that changes later is refused, for an old scene and for a new one."""
    domain, _ = tagged()
    mesh = cd.from_dolfinx(domain, **SIDES)
    E = fem.Constant(domain, 1e3)
    f = fem.Function(fem.functionspace(domain, ("DG", 0)))
    f.x.array[:] = 1.0
    scene = column(cd.Isotropic(E * f, 0.2), mesh)
    before = cd.solve(scene).displacement_at("column", [[0.5, 2.0]])[0, 1]
    E.value = 2e3
    with pytest.raises(ValueError, match="its material has changed"):
        cd.solve(scene)
    after = cd.solve(column(cd.Isotropic(E * f, 0.2), mesh)).displacement_at("column", [[0.5, 2.0]])[0, 1]
    assert after == pytest.approx(before / 2, rel=1e-8)


class Graded(cd.Material):
    """E grows with the depth: a class of the user's."""

    def __init__(self, E: object) -> None:
        self.E = E

    def _stiffness(self, x: np.ndarray) -> np.ndarray:
        values = np.broadcast_to(self.E(x) if callable(self.E) else self.E, x.shape[1])
        return values[:, None, None] * cd.Isotropic(1.0, 0.2).stiffness()


def test_material_of_ones_own():
    """A subclass with a number, a function or a dolfinx Function; what is not positive definite is refused."""
    domain, _ = tagged()
    mesh = cd.from_dolfinx(domain, **SIDES)
    f = fem.Function(fem.functionspace(domain, ("Lagrange", 1)))
    f.interpolate(lambda x: 1e3 * (1 + x[1]))
    by_function = cd.solve(column(Graded(lambda x: 1e3 * (1 + x[1])), mesh)).displacement("column").x.array
    by_field = cd.solve(column(Graded(f), mesh)).displacement("column").x.array
    np.testing.assert_allclose(by_field, by_function, rtol=0, atol=1e-10)
    uniform = cd.solve(column(Graded(1e3), mesh)).displacement("column").x.array
    exact = cd.solve(column(SOFT, mesh)).displacement("column").x.array
    np.testing.assert_allclose(uniform, exact, rtol=0, atol=1e-12)
    with pytest.raises(ValueError, match="positive definite"):
        cd.solve(column(Graded(-1.0), mesh))


class Hidden(Graded):
    """A stiffness that varies, and nothing that tells so."""

    def _stiffness(self, x: np.ndarray) -> np.ndarray:
        return (1e3 * (1 + x[1] ** 2))[:, None, None] * cd.Isotropic(1.0, 0.2).stiffness()


class Told(Hidden):
    varies = True


def test_material_that_varies_without_a_word():
    """Its value at one point would pass for that of all: refused, unless the class says that it varies."""
    domain, _ = tagged()
    mesh = cd.from_dolfinx(domain, **SIDES)
    with pytest.raises(ValueError, match="varies in space"):
        cd.solve(column(Hidden(None), mesh))
    expected = cd.solve(column(Graded(lambda x: 1e3 * (1 + x[1] ** 2)), mesh)).displacement("column").x.array
    found = cd.solve(column(Told(None), mesh)).displacement("column").x.array
    np.testing.assert_array_equal(found, expected)


def test_motions_from_functions():
    """A prescribed displacement as a Function, its component, or an expression with a Constant; changes are seen."""
    domain, _ = tagged()
    mesh = cd.from_dolfinx(domain, **SIDES)
    u = fem.Function(fem.functionspace(domain, ("Lagrange", 1, (2,))))
    u.interpolate(lambda x: np.stack([0 * x[0], 1e-3 * (1 + x[0])]))
    t = fem.Constant(domain, 1.0)
    floor = lambda x: 1e-3 * (1 + x[0])  # noqa: E731

    def solved(values: object) -> cd.Scene:
        body = cd.Body("column", mesh, SOFT, supports=[cd.Displacement("bottom", values)])
        lid = cd.Body("lid", cd.rectangle((0, 2), (1, 3), (4, 4)), STEEL, supports=[cd.Fixed("top")])
        return cd.Scene([body, lid], [cd.Contact((body, "top"), (lid, "bottom"), cd.LinearLayer(K))])

    expected = cd.solve(solved((0.0, floor))).contact().pressure
    assert expected.min() > 0
    scenes = [solved(u), solved((0.0, u[1])), solved((0.0, t * u[1]))]
    for scene in scenes:
        np.testing.assert_allclose(cd.solve(scene).contact().pressure, expected, rtol=1e-9)
    u.x.array[:] *= 2
    for scene in scenes:  # a linear layer that is closed everywhere: all is proportional
        np.testing.assert_allclose(cd.solve(scene).contact().pressure, 2 * expected, rtol=1e-7)
    t.value = 0.5
    np.testing.assert_allclose(cd.solve(scenes[2]).contact().pressure, expected, rtol=1e-7)


def test_refusals():
    domain, tags = tagged()
    mesh = cd.from_dolfinx(domain, cell_tags=tags, **SIDES)
    assert set(mesh.subdomains) == {"3", "7"}
    with pytest.raises(ValueError, match="no subdomain 'steel'"):
        column({"steel": STEEL}, mesh)
    with pytest.raises(ValueError, match="in none of the subdomains '3'"):
        column({"3": STEEL}, mesh)
    overlapping = mesh.with_subdomains(all=lambda x: x[0] > -1)
    with pytest.raises(ValueError, match="in another subdomain"):
        column({"3": SOFT, "all": STEEL}, overlapping)
    with pytest.raises(TypeError, match="'3' is 5"):
        column({"3": 5, "7": STEEL}, mesh)
    with pytest.raises(ValueError, match="which no cell has"):
        cd.from_dolfinx(domain, cell_tags=tags, subdomains={"a": 4})
    with pytest.raises(ValueError, match="expected cell_tags"):
        cd.from_dolfinx(domain, subdomains={"a": 4})
    other = fem.Function(fem.functionspace(tagged()[0], ("DG", 0)))
    with pytest.raises(ValueError, match="another mesh"):
        column(cd.Isotropic(other, 0.3), mesh)
    negative = fem.Function(fem.functionspace(domain, ("DG", 0)))
    with pytest.raises(ValueError, match="E = 0 at x"):
        cd.solve(column(cd.Isotropic(negative, 0.3), mesh))
    with pytest.raises(TypeError, match="stiffness: a UFL expression"):
        cd.Spring("bottom", negative)
    with pytest.raises(ValueError, match=r"shape \(\)"):
        cd.Displacement("bottom", negative)


def test_subdomains_of_a_file(tmp_path):
    """A deck's element sets are the parts of the mesh that is read as one, whatever order dolfinx puts the cells in."""
    nodes = "".join(f"{3 * j + i + 1}, {i / 2}, {j / 2}\n" for j in range(5) for i in range(3))
    cells = [(2 * j + i + 1, *(3 * j + i + k for k in (1, 2, 5, 4))) for j in range(4) for i in range(2)]
    rows = {name: [cell for cell in cells if (cell[0] > 4) == high] for name, high in (("SOFT", False), ("HARD", True))}
    text = "*NODE\n" + nodes
    for name, each in rows.items():
        text += f"*ELEMENT, TYPE=CPE4, ELSET={name}\n" + "".join(", ".join(map(str, cell)) + "\n" for cell in each)
    path = tmp_path / "column.inp"
    path.write_text(text)
    mesh = cd.read_mesh(path)
    for name, below in (("SOFT", True), ("HARD", False)):
        assert np.all((mesh.middles[mesh.subdomains[name], 1] < 1) == below)
    solution = cd.solve(column({"SOFT": SOFT, "HARD": HARD}, mesh.with_surfaces(**SIDES)), tolerance=1e-11)
    shrinks = P / oedometer(SOFT) + P / oedometer(HARD)
    np.testing.assert_allclose(solution.displacement_at("column", [[0.3, 2.0]])[0], [0, -shrinks], atol=1e-10)
