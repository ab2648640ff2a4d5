"""Hints at planes of symmetry: found where they are, not where they are not, and right."""

from __future__ import annotations

import pytest

import contactdd as cd

STEEL, LAYER = cd.Isotropic(2e5, 0.3), cd.PowerLayer(B=4e-6, a=1.1)


def pair(*, gap=lambda x: 5e-4 * (1 - x[0]), top=10.0, diagonal="right", walls=("left", "right"), other=STEEL):
    """Two blocks pressed together from both ends."""

    def body(name, floor, material, side, pressure, **options):
        mesh = cd.rectangle((0, floor), (2, floor + 1), (8, 4), **options)
        supports = [cd.Symmetry(*walls)] if walls else []
        return cd.Body(name, mesh, material, supports=supports, loads=[cd.Pressure(side, pressure)])

    low, high = body("low", 0, STEEL, "bottom", 10.0), body("high", 1, other, "top", top, diagonal=diagonal)
    return cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), LAYER, gap=gap)])


def test_mirror_images():
    """The hint names the plane, and half of the scene with it has the whole one's pressures."""
    scene = pair(diagonal="left")
    (hint,) = scene.hints()
    assert "cd.MirrorPlane('mirror', (1, 1), (0, -1))" in hint
    low = scene.bodies[0]
    mirror = cd.MirrorPlane("mirror", (1, 1), (0, -1))
    half = cd.Scene([low, mirror], [cd.Contact((low, "top"), mirror, LAYER, gap=scene.contacts[0].gap)])
    assert cd.solve(half).contact().pressure == pytest.approx(cd.solve(scene).contact().pressure, rel=1e-8)
    assert half.hints() == []


def test_diagonals_do_not_matter():
    """The scene is symmetric whichever way its cells are cut."""
    assert len(pair(diagonal="right").hints()) == 1


def test_cut():
    """A gap that is symmetric about the middle makes another plane."""
    found = pair(gap=lambda x: 5e-4 * (x[0] - 1) ** 2).hints()
    assert len(found) == 2
    assert found[1].startswith("the scene is symmetric about x = 1:")


@pytest.mark.parametrize("options", [
    {"top": 11.0}, {"other": cd.Isotropic(2e5, 0.29)}, {"top": lambda x: 10.0 + x[0]},
    {"other": cd.Orthotropic(2e5, 1e5, 1e5, 0.2, 0.2, 0.2, 4e4, 4e4, 4e4)},
], ids=["load", "material", "varying load", "wood"])  # fmt: skip
def test_nothing_is_said_of_what_differs(options):
    assert pair(**options).hints() == []


def test_supports_count():
    """Held differently, the blocks are no mirror images."""
    scene = pair()
    low = cd.Body("low", scene.bodies[0].mesh, STEEL, supports=[cd.Fixed("left")], loads=scene.bodies[0].loads)
    assert scene.with_bodies({"low": low}).hints() == []


def test_prescribed_and_tilted():
    """Displacements are reflected with the body: pressed together from both ends they are, pushed along they aren't."""

    def scene(low_end, high_end):
        bodies = [
            cd.Body("low", cd.rectangle((0, 0), (2, 1), (4, 2)), STEEL, supports=[cd.Displacement("bottom", low_end)]),
            cd.Body("high", cd.rectangle((0, 1), (2, 2), (4, 2)), STEEL, supports=[cd.Displacement("top", high_end)]),
        ]
        return cd.Scene(
            bodies, [cd.Contact((bodies[0], "top"), (bodies[1], "bottom"), LAYER, gap=lambda x: 1e-4 * x[0])]
        )

    assert len(scene((0.0, 1e-3), (0.0, -1e-3)).hints()) == 1
    assert len(scene((1e-4, 1e-3), (1e-4, -1e-3)).hints()) == 1
    assert scene((0.0, 1e-3), (0.0, 1e-3)).hints() == []
    assert scene((1e-4, 1e-3), (-1e-4, -1e-3)).hints() == []


def test_in_space():
    """All three kinds of planes of two cubes."""
    low = cd.Body("low", cd.box((0, 0, 0), (1, 1, 1), (2, 2, 2), shape="hexahedron"), STEEL,
                  loads=[cd.Pressure("bottom", 1.0)])  # fmt: skip
    high = cd.Body("high", low.mesh.moved((0, 0, 1)), STEEL, loads=[cd.Pressure("top", 1.0)])
    found = cd.Scene([low, high], [cd.Contact((low, "top"), (high, "bottom"), LAYER)]).hints()
    assert [hint.split(":")[0][-5:] for hint in found[1:]] == ["x = 0.5"[-5:], "y = 0.5"[-5:]]
    assert "(0.5, 0.5, 1), (0, 0, -1)" in found[0]


def test_varying_layer_is_looked_at():
    """A layer that gets stiffer from left to right is not symmetric about the middle."""
    scene = pair(gap=0.0)
    varying = cd.VaryingLayer(cd.LinearLayer, stiffness=lambda x: 1e4 * (1 + x[0]))
    assert len(scene.hints()) == 2
    assert len(scene.with_layer(varying).hints()) == 1
