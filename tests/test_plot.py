"""Pictures are drawn without a display, and show what they should."""

from __future__ import annotations

import numpy as np
import pytest
import test_uniform

import contactdd as cd
from contactdd.body_result import von_mises


@pytest.fixture(scope="module")
def solution():
    return cd.solve(test_uniform.scene(degree=2), "newton", gamma="search")


def test_bodies(solution, tmp_path, monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    picture = solution.plot_bodies(component="von Mises", path=tmp_path / "bodies.png", size=(300, 200))
    assert picture.pixels.shape == (200, 300, 3)
    assert len(np.unique(picture.pixels.reshape(-1, 3), axis=0)) > 20  # not an empty window
    assert picture._repr_png_()[:4] == b"\x89PNG"
    with pytest.raises(ValueError, match="component = 'zy'"):
        solution.plot_bodies(component="zy")


def test_bodies_of_an_earlier_solution_keep_their_gap():
    """A parameter that has changed since does not change what is drawn."""
    depth = cd.Parameter(1e-4)
    lower, upper = (
        cd.Body(name, cd.rectangle((0, y), (2, y + 1), (2, 1)), cd.Isotropic(2.1e5, 0.3), supports=[cd.Fixed(side)])
        for name, y, side in (("lower", 0, "bottom"), ("upper", 1, "top"))
    )
    gap = depth.field(lambda value, x: np.full(x.shape[1], value))
    scene = cd.Scene([lower, upper], [cd.Contact((lower, "top"), (upper, "bottom"), cd.LinearLayer(1e4), gap=gap)])
    earlier = cd.solve(scene)
    depth.value = 5e-4
    cd.solve(scene)
    result = earlier.body(lower)
    drawn = result.drawn(1.0) - result.points
    assert drawn[:, 1].min() == pytest.approx(-1e-4, rel=1e-12)


def test_contact_curves(solution, tmp_path):
    figure = solution.plot_contact(path=tmp_path / "contact.png")
    pressure = figure.axes[0].lines[0].get_ydata()
    np.testing.assert_allclose(pressure, test_uniform.Q, rtol=1e-8)  # the default tolerance of solve
    assert (tmp_path / "contact.png").stat().st_size > 5000


def test_nodal_stresses(solution):
    body = solution.scene.bodies[0]
    stress = solution.body(body).stress
    np.testing.assert_allclose(stress[:, 1], -test_uniform.Q, rtol=1e-6)  # derivatives of a solution good to 1e-8
    nu = body.material.nu
    side = nu / (1 - nu) * test_uniform.Q  # both transverse stresses of laterally held compression
    np.testing.assert_allclose(von_mises(stress), test_uniform.Q - side, rtol=1e-6)


def test_text_and_html(solution):
    assert "converged" in repr(solution)
    assert "peak pressure" in solution._repr_html_()
    assert "2 bodies" in repr(solution.scene)
