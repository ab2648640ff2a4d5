"""The colours of pictures are told apart by readers of any colour sight, as simulated.

The simulation is that of Machado, Oliveira and Fernandes (2009) for those who lack one kind of cones; colours are
compared in CIELAB, where a difference of 2.3 can just be seen.
"""

from __future__ import annotations

from itertools import combinations

import matplotlib
import numpy as np
import pytest
from matplotlib.colors import to_rgb

from contactdd.view.contact_map import STATUS_COLOURS
from contactdd.view.convergence_plot import STYLES
from contactdd.view.picture import MAP

SIGHT = {
    "all cones": np.eye(3),
    "no red": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "no green": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "no blue": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def seen(colours, sight: str) -> np.ndarray:
    """The colours (n, 3) in CIELAB as a reader sees them."""
    c = np.array([to_rgb(colour) for colour in colours])
    linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    xyz = np.clip(linear @ np.asarray(SIGHT[sight]).T, 0, 1) @ TO_XYZ.T / [0.9505, 1.0, 1.089]
    x, y, z = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116).T
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=1)


@pytest.mark.parametrize("sight", SIGHT)
@pytest.mark.parametrize("colours", [[colour for colour, _ in STYLES], STATUS_COLOURS], ids=["lines", "status"])
def test_colours_differ(colours, sight):
    """By four times what can just be seen, at least."""
    assert min(np.linalg.norm(a - b) for a, b in combinations(seen(colours, sight), 2)) > 4 * 2.3


@pytest.mark.parametrize("sight", SIGHT)
def test_the_bar_gets_lighter(sight):
    """From its lower end to its upper, every twentieth by what can be seen, also in print without colours."""
    lightness = seen(matplotlib.colormaps[MAP](np.linspace(0, 1, 21))[:, :3], sight)[:, 0]
    assert np.all(np.diff(lightness) > 1.0)
