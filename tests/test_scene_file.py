"""Scenes in files: the same answer as from Python, and errors that name the line and the key."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scenes import LAYER, STEEL, groove

import contactdd as cd
from contactdd.__main__ import main

GROOVE = Path(__file__).parents[1] / "demos" / "groove.toml"
TEXT = GROOVE.read_text()
ONCE = TEXT[: TEXT.index("[programme]")].replace('"q"', "10")


def written(folder: Path, text: str) -> Path:
    path = folder / "scene.toml"
    path.write_text(text)
    return path


def test_the_groove_is_that_of_python(tmp_path):
    """Pressures equal to rounding: the same meshes, the same numbers, the same solve."""
    ours = cd.read_scene_file(written(tmp_path, ONCE)).solve()
    sides = [cd.Symmetry("left", "right")]
    low, up = (cd.rectangle((0, y), (4, y + 1), (32, 16)) for y in (0, 1))
    lower = cd.Body("lower", low, STEEL, supports=sides, loads=[cd.Pressure("bottom", 10)])
    upper = cd.Body("upper", up, STEEL, supports=sides, loads=[cd.Pressure("top", 10)])
    theirs = cd.solve(cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), LAYER, gap=groove)]))
    assert np.abs(ours.contact("joint").pressure - theirs.contact().pressure).max() < 1e-12 * 24


def test_a_programme():
    """The force is q l, 4 cm long, in every step: equilibrium, to the residual of 1e-10."""
    path = cd.read_scene_file(GROOVE).solve()
    assert list(path.values) == [2, 5, 10]
    assert [solution.contact().force for solution in path.solutions] == pytest.approx([8, 20, 40], rel=1e-8)


RIGID = """
[meshes.plate]
type = "rectangle"
lower_left = [0, -4]
upper_right = [4, 0]
cells = [[0, 0.1, 0.2, 0.3, 0.4, 1, 2, 4], 8]

[materials.soft]
type = "Isotropic"
E = "1000 * (1 + 0 * y)"
nu = 0.3

[layers]
coating = { type = "LinearLayer", stiffness = 1e5 }
rough = { type = "PowerLayer.machined_joint", c = 0.5, m = 0.5 }
both = { type = "SeriesLayer", layers = ["coating", "rough"] }

[bodies.plate]
mesh = "plate"
material = "soft"
kinematics = "axisymmetric"
supports = [{ type = "Symmetry", surfaces = "left" }, { type = "Fixed", surfaces = ["bottom"] }]
loads = [{ type = "Traction", surface = "right", value = ["0.01 * y", 0] }]

[bodies.ball]
type = "rigid"
shape = { type = "Sphere", centre = [0, 5], radius = 5 }
displacement = [0, "free"]
force = [0, "push"]
kinematics = "axisymmetric"

[contacts.tip]
first = "plate.top"
second = "ball"
layer = "both"

[programme]
parameter = "push"
values = [-1, -3]
"""


def test_a_ball_on_a_plate(tmp_path):
    """Rigid bodies, layers in series, fields, a force by the parameter: it carries what pushes it."""
    path = cd.read_scene_file(written(tmp_path, RIGID)).solve()
    assert [solution.contact("tip").force for solution in path.solutions] == pytest.approx([1, 3], rel=1e-8)


@pytest.mark.parametrize(
    ("old", "new", "line", "says"),
    [
        ('material = "steel"', 'material = "stel"', 16, "bodies.lower.material: 'stel'"),
        ("nu = 0.3", "nu = 0.7", 4, "materials.steel: nu = 0.7"),
        ("nu = 0.3", "mu = 0.3", 7, "materials.steel.mu: not known"),
        ("nu = 0.3\n", "", 4, "nu is missing"),
        ('"PowerLayer"', '"PowrLayer"', 10, "layers.rough.type: 'PowrLayer'"),
        ('"lower.top"', '"lower.tip"', 26, "tip"),
        ('"lower.top"', '"lwer.top"', 27, "contacts.joint.first: 'lwer.top'"),
        ("maximum(1 - x**2, 0)", "maximum(1 - r**2, 0)", 30, "'r' is not known"),
        ("maximum(1 - x**2, 0)", "maximum(1 - x**2, 0, x)", 30, "functions of one or two values"),
        ("maximum(1 - x**2, 0)", "__import__('os')", 30, "'__import__' is not known"),
        ("maximum(1 - x**2, 0)", "x.real", 30, "expected numbers"),
        ("maximum(1 - x**2, 0)", "(1/0)", 30, "division by zero"),
        ("maximum(1 - x**2, 0)", "9**9**9", 30, "out of range"),
        ("[layers.rough]", "[layer.rough]", 9, "layer: not known"),
        ('surfaces = ["left", "right"]', 'surfaces = ["left", "rigth"]', 14, "rigth"),
        ("[materials.steel]", "[materials.steel", 4, "Expected"),
        ("value = 10", 'value = "ten"', 18, "'ten' is not known"),
    ],
)
def test_errors_name_the_line(tmp_path, old, new, line, says):
    path = written(tmp_path, ONCE.replace(old, new, 1))
    with pytest.raises(cd.SceneFileError) as caught:
        cd.read_scene_file(path)
    assert says in str(caught.value)
    assert f"line {line}" in str(caught.value)


def test_options_and_programmes_are_checked(tmp_path):
    for text, says in [
        (TEXT.replace("tolerance", "tolerence"), "solve.tolerence: not known"),
        (TEXT.replace("[2, 5, 10]", "[]"), "programme.values: []"),
        (TEXT.replace('"q"', '"x"'), "programme.parameter: 'x'"),
        ("title = 'nothing'", "bodies: missing"),
    ]:
        with pytest.raises(cd.SceneFileError, match=says.replace("[]", r"\[\]")):
            cd.read_scene_file(written(tmp_path, text))


def test_the_command(tmp_path, capsys):
    assert main(["solve", str(written(tmp_path, ONCE)), "--out", str(tmp_path / "out"), "--no-pictures"]) == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["joint"]["force"] == pytest.approx(40, rel=1e-8)
    rows = np.genfromtxt(tmp_path / "out" / "joint.csv", delimiter=",", names=True)
    assert rows["pressure"].max() == pytest.approx(summary["joint"]["peak pressure"], rel=1e-12)
    assert (tmp_path / "out" / "fields" / "lower.vtu").exists()
    assert "converged" in capsys.readouterr().out


def test_the_command_says_what_is_wrong(tmp_path, capsys):
    """Status 2 and one line where the file is wrong, 1 where there is no equilibrium."""
    assert main(["solve", str(tmp_path / "none.toml")]) == 2
    assert main(["solve", str(written(tmp_path, ONCE.replace('"steel"', '"stel"')))]) == 2
    apart = ONCE.replace('surface = "top", value = 10', 'surface = "top", value = -10')
    assert main(["solve", str(written(tmp_path, apart))]) == 1
    said = capsys.readouterr().err.splitlines()
    assert len([line for line in said if line.startswith("contactdd: ")]) == 3


def test_what_is_installed_is_told(capsys):
    assert main([]) == 0
    told = capsys.readouterr().out
    assert f"contactdd {cd.__version__}" in told
    assert all(word in told for word in ("dolfinx", "mumps", "hypre", "gmsh", "pyvista", "groove.toml"))
