"""Pictures are drawn without a display, and show what they should."""

from __future__ import annotations

import numpy as np
import pytest
import test_uniform

import contactdd as cd
from contactdd.plot import body_grid, von_mises


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


def test_contact_curves(solution, tmp_path):
    figure = solution.plot_contact(path=tmp_path / "contact.png")
    pressure = figure.axes[0].lines[0].get_ydata()
    np.testing.assert_allclose(pressure, test_uniform.Q, rtol=1e-8)  # the default tolerance of solve
    assert (tmp_path / "contact.png").stat().st_size > 5000


def test_nodal_stresses(solution):
    body = solution.scene.bodies[0]
    stress = body_grid(solution, body).point_data["stress"]
    np.testing.assert_allclose(stress[:, 1], -test_uniform.Q, rtol=1e-6)  # derivatives of a solution good to 1e-8
    nu = body.material.nu
    side = nu / (1 - nu) * test_uniform.Q  # both transverse stresses of laterally held compression
    np.testing.assert_allclose(von_mises(stress), test_uniform.Q - side, rtol=1e-6)


def test_export(solution, tmp_path):
    files = solution.export(tmp_path / "fields")
    assert [path.name for path in files] == ["lower.xdmf", "upper.xdmf"]
    text = files[0].read_text()
    assert 'Name="displacement"' in text
    assert 'Name="stress"' in text


def test_text_and_html(solution):
    assert "converged" in repr(solution)
    assert "peak pressure" in solution._repr_html_()
    assert "2 bodies" in repr(solution.scene)
