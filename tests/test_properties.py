"""What has to hold in every scene, tried on random ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contactdd as cd

LENGTH, STEEL = 4.0, 2.1e5
#: Of ‖F₁'‖ relative to the forces: three digits above where double precision ends for these meshes.
TOLERANCE = 1e-11
#: Pressures of two solutions with such residuals. The compliance of the contact, whose condition is up to 1e3 here
#: (soft bodies beside stiff ones), turns residuals into pressures; tenfold for the layers' curvature.
SAME = 1e-7
GLOBALISED = ["auto", "newton-krylov", "newton-chord", "anderson"]
few = settings(max_examples=12, derandomize=True, deadline=None)


@dataclass(frozen=True)
class Recipe:
    """Numbers that make a stack of blocks: moduli and heights by body, laws and gaps by contact."""

    moduli: tuple[float, ...]
    heights: tuple[float, ...]
    laws: tuple[tuple[float, float], ...]
    gaps: tuple[tuple[float, float], ...]
    load: float
    grounded: bool
    cells: int

    def bodies(self) -> list[cd.Body]:
        floors = np.concatenate([[0.0], np.cumsum(self.heights)])
        bodies = []
        for i, modulus in enumerate(self.moduli):
            mesh = cd.rectangle(
                (0, floors[i]), (LENGTH, floors[i + 1]), (self.cells, 3), diagonal=("left", "right")[i % 2]
            )
            surfaces = ["left", "right"] + (["bottom"] if i == 0 and self.grounded else [])
            loads = [cd.Pressure("top", self.load)] if i == len(self.moduli) - 1 else []
            loads += [cd.Pressure("bottom", self.load)] if i == 0 and not self.grounded else []
            bodies.append(
                cd.Body(f"{i}", mesh, cd.Isotropic(modulus, 0.3), supports=[cd.Symmetry(*surfaces)], loads=loads)
            )
        return bodies

    def contacts(self, bodies: list[cd.Body]) -> list[cd.Contact]:
        """In order from below; their gaps are waves over an offset."""
        return [
            cd.Contact((low, "top"), (high, "bottom"), cd.PowerLayer(4e-6 * stiffness * 10 ** (1.1 - a), a),
                       gap=lambda x, d=depth, w=waves: d * (1 + np.cos(w * x[0])), name=f"{i}")
            for i, (low, high, (stiffness, a), (depth, waves))
            in enumerate(zip(bodies[:-1], bodies[1:], self.laws, self.gaps, strict=True))
        ]  # fmt: skip

    def scene(self) -> cd.Scene:
        bodies = self.bodies()
        return cd.Scene(bodies, self.contacts(bodies))


def powers(low: float, high: float):
    """Numbers whose logarithm is uniform."""
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


@st.composite
def recipes(draw) -> Recipe:
    count = draw(st.integers(2, 4))

    def several(n: int, strategy):
        return tuple(draw(st.lists(strategy, min_size=n, max_size=n)))

    return Recipe(
        moduli=several(count, powers(-1, 1).map(lambda factor: STEEL * factor)),
        heights=several(count, st.floats(0.5, 2.0)),
        laws=several(count - 1, st.tuples(powers(-1, 1), st.floats(0.5, 2.0))),
        gaps=several(count - 1, st.tuples(st.floats(-2e-4, 5e-4), st.floats(0.3, 4.0))),
        load=draw(powers(-1, 3)),
        grounded=draw(st.booleans()),
        cells=draw(st.integers(4, 10)),
    )


def pressures(solution: cd.Solution) -> list[np.ndarray]:
    """By contact, in the order of x."""
    results = {c.name: solution.contact(c) for c in solution.scene.contacts}
    return [results[name].pressure[np.argsort(results[name].x[:, 0], kind="stable")] for name in sorted(results)]


def assert_same(one: cd.Solution, other: cd.Solution, within: float = SAME) -> None:
    for p, q in zip(pressures(one), pressures(other), strict=True):
        assert np.abs(p - q).max() <= within * max(np.abs(q).max(), 1e-300)


@pytest.mark.parametrize("method", GLOBALISED)
@few
@given(recipe=recipes(), start=st.sampled_from([None, 0.0, 1e-2, -1e-2]))
def test_energy_never_rises(method, recipe, start):
    run = cd.solve(recipe.scene(), method, start=start, tolerance=1e-9, max_iterations=60, on_failure="return")
    energy = run.history.energy
    # F₁ is a difference of parts (elastic, loads, layers), each with the rounding of its sums.
    assert np.all(np.diff(energy) <= 1e-12 * np.abs(energy).max(initial=0.0))


@few
@given(recipe=recipes())
def test_solution_is_in_equilibrium_and_admissible(recipe):
    """Action = reaction, p ≥ 0, complementarity, the balance of forces, and every outward force arrives below."""
    solution = cd.solve(recipe.scene(), tolerance=TOLERANCE)
    assert solution.imbalance < 1e-10  # ten times the residual, for sums over nodes
    for contact in solution.scene.contacts:
        result = solution.contact(contact)
        assert np.all(result.pressure >= 0)
        assert np.all(result.pressure[result.gap >= 0] == 0)
        # The law itself, eqs. (10), (11): w + u_αn + u_βn ≤ d with equality where there is pressure.
        assert np.all(result.compression <= result.gap)
        assert np.array_equal(result.pressure > 0, result.compression < 0)
        np.testing.assert_array_equal(-contact.layer.contact_stress(result.compression), result.pressure)
        # No other force has a vertical part, so each contact hands on the whole load; the residual is all that is lost.
        assert result.force == pytest.approx(recipe.load * LENGTH, rel=1e-9)
    forces = [solution.forces(body)["contact"] for body in solution.scene.bodies]
    # Inner bodies have two contacts, which cancel; the first and the last are pressed with the load.
    assert np.abs(sum(forces)).max() <= 1e-10 * np.abs(forces[0]).max()


@few
@given(recipe=recipes(), seed=st.integers(0, 2**31))
def test_order_does_not_matter(recipe, seed):
    """Bodies, contacts and the two sides of a contact in another order: the same elimination in another order."""
    rng = np.random.default_rng(seed)
    bodies = recipe.bodies()
    contacts = recipe.contacts(bodies)
    straight = cd.solve(cd.Scene(bodies, contacts), tolerance=TOLERANCE)
    turned = [
        cd.Contact(c.sides[1], c.sides[0], c.layer, gap=c.gap, name=c.name) if rng.random() < 0.5 else c
        for c in contacts
    ]
    shuffled = cd.Scene([bodies[i] for i in rng.permutation(len(bodies))],
                        [turned[i] for i in rng.permutation(len(turned))])  # fmt: skip
    solution = cd.solve(shuffled, tolerance=TOLERANCE)
    assert_same(solution, straight)


@few
@given(recipe=recipes(), size=st.sampled_from([1e-6, 1e-4, 1e-2]), seed=st.integers(0, 2**31))
def test_any_start_leads_to_the_same_solution(recipe, size, seed):
    """The energy is convex: start anywhere, by a random u_n at every point of the contacts."""
    scene = recipe.scene()
    expected = cd.solve(scene, tolerance=TOLERANCE)

    def somewhere(x: np.ndarray) -> np.ndarray:
        return size * np.random.default_rng(seed).standard_normal(x.shape[1])

    # Floating bodies stay where they were thrown: a displacement of 1e-2 is rounded to 2e-18, which the layer's
    # stiffness of up to 1e8 times the load turns into 2e-10 of the forces. The pressures' tolerance grows with it.
    assert_same(cd.solve(scene, start=somewhere, tolerance=1e-9, max_iterations=40), expected, within=100 * SAME)


@pytest.mark.parametrize("method", ["newton-krylov", "newton-kurchatov", "anderson", "chord"])
@few
@given(recipe=recipes())
def test_methods_agree_or_say_that_they_did_not_arrive(method, recipe):
    scene = recipe.scene()
    other = cd.solve(scene, method, tolerance=TOLERANCE, max_iterations=200, on_failure="return")
    if other.converged:
        assert_same(other, cd.solve(scene, tolerance=TOLERANCE))
    else:
        assert method in ("anderson", "chord")
        assert other.status in ("diverged", "iteration limit", "stalled")


@few
@given(recipe=recipes())
def test_a_pull_has_no_equilibrium(recipe):
    """The topmost block pulled up with any force at all, on top of everything else."""
    bodies = recipe.bodies()
    last = bodies[-1]
    bodies[-1] = cd.Body(last.name, last.mesh, last.material, supports=last.supports,
                         loads=[cd.Pressure("top", -recipe.load)])  # fmt: skip
    for method in ("auto", "anderson", "chord"):
        with pytest.raises(cd.NoEquilibriumError) as caught:
            cd.solve(cd.Scene(bodies, recipe.contacts(bodies)), method)
        assert "translation along y" in caught.value.motion
