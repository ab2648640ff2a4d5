"""Pictures of estimated errors: of plane and solid scenes, with the errors that the estimate tells."""

from __future__ import annotations

import numpy as np
import pytest
import scenes
from test_demos import is_picture

import contactdd as cd


def test_plane(tmp_path):
    estimate = cd.error_estimate(cd.solve(scenes.pressed((16, 8))))
    figure = estimate.plot(path=tmp_path / "error.png", stress_unit="MPa", length_unit="cm")
    assert is_picture(tmp_path / "error.png")
    drawn = [line.get_ydata() for axes in figure.axes for line in axes.get_lines()]
    largest = estimate.contact().largest_error
    assert any(np.nanmax(values) == pytest.approx(largest) for values in drawn)
    # Cell by cell the energies sum up to that of the error, of which F₁ has fallen by half of ‖e‖² and the contacts'.
    energies = [estimate.cell_errors(name) for name in ("lower", "upper")]
    assert all(len(each) == 2 * 16 * 8 and np.all(each >= 0) for each in energies)
    assert 0.5 < sum(each.sum() for each in energies) / estimate.energy.error < 1.0


def test_several_contacts_of_quadrilaterals(tmp_path):
    bodies = [
        scenes.block("a", 0, (8, 3), loads=[cd.Pressure("bottom", 10.0)], shape="quadrilateral"),
        scenes.block("b", 1, (8, 3), shape="quadrilateral"),
        scenes.block("c", 2, (8, 3), loads=[cd.Pressure("top", 10.0)]),
    ]
    cd.error_estimate(cd.solve(scenes.stack(bodies))).plot(path=tmp_path / "error.pdf")
    assert (tmp_path / "error.pdf").stat().st_size > 1000


def test_in_space(tmp_path):
    meshes = [cd.box((0, 0, z), (2, 1, z + 1), (4, 2, 2)) for z in (0, 1)]
    low = cd.Body("low", meshes[0], scenes.STEEL, supports=[cd.Fixed("bottom")])
    high = cd.Body("high", meshes[1], scenes.STEEL, loads=[cd.Pressure("top", 10.0)])
    contact = cd.Contact((low, "top"), (high, "bottom"), cd.LinearLayer(1e6), gap=lambda x: 2e-5 * x[0] ** 2)
    cd.error_estimate(cd.solve(cd.Scene([low, high], [contact]))).plot(path=tmp_path / "error.png")
    assert is_picture(tmp_path / "error.png")
