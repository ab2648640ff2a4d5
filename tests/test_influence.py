"""The influence of forces on contact pressures: what it foretells is what a solve with these forces finds."""

from __future__ import annotations

import numpy as np
import pytest
import scenes

import contactdd as cd


@pytest.mark.parametrize("local_solver", ["condensed", "assembled"])
def test_a_small_load(local_solver):
    """∫ f δp of a load's small part is F·z, to the square of that part."""
    load = cd.Parameter(10.0)
    low = scenes.block("low", 0, (12, 6), loads=[cd.Pressure("bottom", load)])
    high = scenes.block("high", 1, (10, 5), loads=[cd.Pressure("top", load)], degree=2)
    scene = scenes.stack([low, high])
    before = cd.solve(scene, local_solver=local_solver)
    result = before.contact()
    factor = 1.0 + result.x[:, 0] ** 2
    influence = before.influence([factor])
    change = 0.0
    forces = {name: before.forces(name)["loads"] for name in ("low", "high")}
    assert forces["low"][1] == pytest.approx(40.0)
    small = 1e-5
    for body, z in zip(scene.bodies, influence, strict=True):
        # An even pressure's forces are those of the mean displacement of its face.
        surface = "bottom" if body.name == "low" else "top"
        up = 1.0 if body.name == "low" else -1.0
        change += up * small * 10.0 * _integral(body, surface, z)
    load.value = 10.0 * (1 + small)
    after = cd.solve(scene, local_solver=local_solver).contact()
    told = result.weights @ (factor * (after.pressure - result.pressure))
    assert change == pytest.approx(told, rel=1e-4)  # the second order, and digits lost in a difference of 1e-5


def _integral(body: cd.Body, surface: str, z: np.ndarray) -> float:
    """∫ z_y along a face, by Simpson's rule or the trapezoidal one, which are exact for its elements."""
    from dolfinx import fem

    dofs = fem.locate_dofs_topological(body.space, 1, body.mesh.facets(surface))
    x = body.space.tabulate_dof_coordinates()[dofs, 0]
    order = np.argsort(x)
    values, h = z.reshape(-1, 2)[dofs[order], 1], np.diff(x[order])
    if body.degree == 1:
        return float(np.sum(h * (values[1:] + values[:-1])) / 2)
    return float(np.sum(h[::2] / 3 * (values[:-2:2] + 4 * values[1::2] + values[2::2])))


def test_two_contacts_and_what_is_far():
    """Factors in one contact of three blocks; forces inside a wall's own facets do nothing."""
    bodies = [
        scenes.block("a", 0, (8, 3), loads=[cd.Pressure("bottom", 10.0)]),
        scenes.block("b", 1, (8, 3)),
        scenes.block("c", 2, (8, 3), loads=[cd.Pressure("top", 10.0)]),
    ]
    solution = cd.solve(scenes.stack(bodies))
    ones = [np.ones(len(solution.contact(i).x)) for i in (0, 1)]
    z = solution.influence([ones[0], 0 * ones[1]])
    # The load alone fixes the force on the contact: only what moves the lowest block as a whole can change it.
    lowest, others = z[0].reshape(-1, 2)[:, 1], np.concatenate(z[1:]).reshape(-1, 2)[:, 1]
    assert np.ptp(lowest) < 1e-6
    assert np.ptp(others) < 1e-6
    assert lowest.mean() - others.mean() == pytest.approx(1.0, abs=1e-6)


def test_other_factors_are_refused():
    solution = cd.solve(scenes.pressed((8, 4)))
    with pytest.raises(ValueError, match="factors of shapes"):
        solution.influence([np.ones(3)])
