"""The estimated error against the true one, where that is known, and in every kind of scene that can be solved."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pytest
import scenes
from manufactured import Manufactured
from test_own_bodies import RigidCylinder
from test_ranks import launch

import contactdd as cd


def effectivity(problem, solution):
    """Estimate / true error of p in L², at the same points."""
    estimate = cd.error_estimate(solution)
    return estimate.pressure.relative / problem.error(solution)


@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("unlike", [True, False])
def test_effectivity_of_a_known_pressure(degree, unlike):
    """The better solution's error is of an order more: what is left of it between these meshes is a few per cent."""
    problem = Manufactured()
    assert effectivity(problem, cd.solve(problem.scene(8, degree, unlike=unlike))) == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize(("degree", "shape"), [(1, "tetrahedron"), (1, "hexahedron"), (2, "hexahedron")])
def test_effectivity_in_space(degree, shape):
    problem = Manufactured(dim=3, half_width=1.0, exponent=4)
    solution = cd.solve(problem.scene(2, degree, shape=shape))
    assert effectivity(problem, solution) == pytest.approx(1.0, abs=0.25)  # two cells across the height


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_effectivity_at_the_groove(degree):
    """Contact is lost at the edges of the groove, where p grows like a power 1.1 of the overlap."""
    exact = cd.reference.groove()
    solution = cd.solve(scenes.paper(degree=degree))
    estimate = cd.error_estimate(solution)
    contact = estimate.contact()
    p = exact.pressure(contact.result.x[:, 0])
    w = contact.result.weights
    true = np.sqrt(w @ (contact.result.pressure - p) ** 2 / (w @ p**2))
    assert 0.5 < estimate.pressure.relative / true < 2.5
    # The field tells where: the errors are alike point by point, not only in their norm.
    assert np.corrcoef(contact.pressure_error, contact.result.pressure - p)[0, 1] > 0.7


def test_what_is_exact_has_no_error():
    """An even compression is linear: the solution is exact, and all that is left is the solves' tolerance of 1e-10."""
    solution = cd.solve(scenes.pressed((8, 4), gap=0.0))
    estimate = cd.error_estimate(solution)
    assert estimate.pressure.relative < 1e-8
    assert estimate.energy.relative < 1e-8
    contact = estimate.contact("lower-upper")
    assert contact.force.relative < 1e-8
    assert contact.peak_pressure.relative < 1e-8
    assert contact.area.error == 0.0
    assert contact.edge.shape == (0,)
    assert estimate.displacement("lower").relative < 1e-7


def test_numbers_against_the_exact_groove():
    """Every number's true error is within three times the estimated one, where it is not smaller than what points
    resolve."""
    exact, scene = cd.reference.groove(), scenes.paper(refine=1)
    solution = cd.solve(scene)
    estimate = cd.error_estimate(solution)
    contact = estimate.contact(scene.contacts[0])
    own = contact.result
    assert contact.pressure.relative == pytest.approx(estimate.pressure.relative)
    assert contact.largest_error == np.abs(contact.pressure_error).max()
    assert abs(own.peak_pressure - exact.peak_pressure) < 3 * contact.peak_pressure.error
    # The loads alone fix the force: it is right to rounding in both solutions, and in their difference.
    assert own.force == pytest.approx(exact.length * scenes.LOAD, rel=1e-9)
    assert contact.force.relative < 1e-9
    x = np.linspace(0, exact.length, 40001)
    z = exact.gap(x)
    (edge,) = x[1:][(z[1:] < 0) != (z[:-1] < 0)]
    assert abs(contact.result.edge[0, 0] - edge) < 3 * contact.edge[0]
    energy = exact.elastic_energy + exact.layer_energy
    assert estimate.energy.relative == pytest.approx(estimate.energy.error / energy, rel=1e-2)


def test_the_energy_falls_and_its_error_is_that_of_the_energy_norm():
    """F₁(u_k) ≥ F₁(u_{k+1}): the finer space contains the coarser one. The error falls like h² at degree 1."""
    errors = []
    for refine in (1, 2):
        problem = scenes.pressed((16 * refine, 8 * refine), gap=lambda x: 0.1 * scenes.groove(x))
        estimate = cd.error_estimate(cd.solve(problem))
        assert estimate.solution.energy > estimate.better.energy
        errors.append(estimate.energy.error)
    assert np.log2(errors[0] / errors[1]) > 1.5  # the edge of the groove costs some of the order


@pytest.mark.parametrize(
    "options",
    [
        {"kinematics": "plane stress"},
        {"kinematics": "axisymmetric"},
        {"shape": "quadrilateral"},
        {"quadrature": "facet"},
        {"quadrature": "vertex"},
        {"local_solver": "assembled"},
        {"local_solver": "multigrid"},
    ],
    ids=str,
)
def test_every_kind_of_scene(options):
    """The estimate of a coarse mesh against what a mesh four times as fine tells of it."""

    def solved(refine):
        scene = scenes.pressed((16 * refine, 8 * refine), degree=1, **options)
        return cd.solve(scene)

    kind = {key: value for key, value in options.items() if key != "quadrature"}
    fine = cd.solve(scenes.pressed((64, 32), degree=3, **kind))
    solution = solved(1)
    estimate = cd.error_estimate(solution)
    contact = estimate.contact()
    assert estimate.better.scene.bodies[0].degree == 2
    p = fine.contact(degree=8).at(contact.result.x)["pressure"]
    w = contact.result.weights
    true = np.sqrt(w @ (contact.result.pressure - p) ** 2 / (w @ p**2))
    assert 0.5 < estimate.pressure.relative / true < 2.5


def test_swapped_bodies_and_other_units():
    """The errors do not depend on which body is the first, nor are they changed by metres for centimetres."""

    def estimate(order=1, length=1.0):
        def gap(x):
            return scenes.groove(x / length) * length

        low = scenes.block("low", 0, (12, 6), length=4 * length, height=length, loads=[cd.Pressure("bottom", 10.0)])
        high = scenes.block("high", length, (18, 9), length=4 * length, height=length, loads=[cd.Pressure("top", 10.0)])
        layer = cd.PowerLayer(B=4e-6 * length, a=1.1)
        sides = [(low, "top"), (high, "bottom")][::order]
        return cd.error_estimate(cd.solve(cd.Scene([low, high], [cd.Contact(*sides, layer, gap=gap)])))

    first, swapped, small = estimate(), estimate(order=-1), estimate(length=1e-2)
    assert swapped.pressure.relative == pytest.approx(first.pressure.relative, rel=1e-5)
    assert small.pressure.relative == pytest.approx(first.pressure.relative, rel=1e-5)
    assert small.pressure.error == pytest.approx(first.pressure.error, rel=1e-5)
    assert small.displacement("low").relative == pytest.approx(first.displacement("low").relative, rel=1e-5)


def test_several_contacts_of_unlike_degrees():
    bodies = [
        scenes.block("a", 0, (12, 4), loads=[cd.Pressure("bottom", 10.0)]),
        scenes.block("b", 1, (10, 4), degree=2),
        scenes.block("c", 2, (12, 4), loads=[cd.Pressure("top", 10.0)], shape="quadrilateral"),
    ]
    estimate = cd.error_estimate(cd.solve(scenes.stack(bodies)))
    assert [body.degree for body in estimate.better.scene.bodies] == [2, 3, 2]
    assert len(estimate.contacts) == 2
    squares = [c.result.weights @ c.pressure_error**2 for c in estimate.contacts]
    norms = [c.result.weights @ c.better_pressure**2 for c in estimate.contacts]
    assert estimate.pressure.relative == pytest.approx(np.sqrt(sum(squares) / sum(norms)))
    assert repr(estimate).count("\n") == 2


def test_a_body_without_a_mesh():
    fine = np.linspace(0, 2, 33)
    mesh = cd.rectangle((0, -2), (2, 0), (fine, 16))
    body = cd.Body("block", mesh, scenes.STEEL, supports=[cd.Fixed("bottom")])
    cylinder = RigidCylinder((0.9, 3.0), 3.0, force=50.0)
    scene = cd.Scene([body, cylinder], [cd.Contact((body, "top"), cylinder, cd.LinearLayer(1e6))])
    estimate = cd.error_estimate(cd.solve(scene))
    assert estimate.better.scene.bodies[1] is cylinder
    assert 0.0 < estimate.pressure.relative < 0.1
    assert 0.0 < estimate.displacement("cylinder").relative < 0.1
    assert estimate.displacement_error("block").function_space.mesh is mesh.domain
    with pytest.raises(ValueError, match="'cylinder': it has no mesh"):
        estimate.displacement_error("cylinder")


def test_a_solution_whose_parameters_have_gone_on():
    """The estimate is that of the solution's own load, and the parameter is left where it was."""
    load = cd.Parameter(10.0)
    scene = scenes.pressed((16, 8), load=load)
    solution = cd.solve(scene)
    before = cd.error_estimate(solution)
    load.value = 30.0
    cd.solve(scene)
    after = cd.error_estimate(solution)
    assert after.pressure.relative == pytest.approx(before.pressure.relative, rel=1e-9)
    assert load.value == 30.0


def test_the_fields_are_the_differences():
    solution = cd.solve(scenes.pressed((16, 8)))
    estimate = cd.error_estimate(solution, degrees=2)
    better = estimate.better
    assert better.scene.bodies[0].degree == 3
    error = estimate.displacement_error("upper")
    point = [[1.3, 1.4]]
    wanted = solution.displacement_at("upper", point) - better.displacement_at("upper", point)
    at = error.eval([[1.3, 1.4, 0.0]], _cell(error, [1.3, 1.4, 0.0]))
    assert at == pytest.approx(wanted[0], abs=1e-12 * np.abs(error.x.array).max() + 1e-18)
    assert estimate.cost > 0.0
    assert estimate.cpu_seconds > 0.0


def _cell(function, point):
    from dolfinx import geometry

    domain = function.function_space.mesh
    tree = geometry.bb_tree(domain, domain.topology.dim)
    x = np.array([point])
    hits = geometry.compute_colliding_cells(domain, geometry.compute_collisions_points(tree, x), x)
    return hits.links(0)[:1]


def test_a_start_in_elements_of_another_degree():
    """From the solution of a lower degree fewer steps are left than from nothing, to the same answer; and back."""
    coarse, fine = (scenes.pressed((16, 8), degree=1), None)
    first = cd.solve(coarse)
    fine = coarse.with_bodies({body.name: body.with_degree(2) for body in coarse.bodies})
    cold, warm = cd.solve(fine), cd.solve(fine, start=first)
    assert warm.iterations < cold.iterations
    assert warm.energy == pytest.approx(cold.energy, rel=1e-12)
    assert cd.solve(coarse, start=warm).energy == pytest.approx(first.energy, rel=1e-12)


def test_copies_stay_copies():
    """The upper block mirrors the lower one; in elements of another degree it still shares its condensation."""
    scene = scenes.pressed((8, 4))
    raised = scene.with_bodies({body.name: body.with_degree(2) for body in scene.bodies})
    from contactdd.local.copies import originals

    assert (originals(raised.bodies)[1] is None) == (originals(scene.bodies)[1] is None)


def test_refusals():
    solution = cd.solve(scenes.pressed((4, 2)))
    with pytest.raises(TypeError, match="solution = 3: expected a Solution"):
        cd.error_estimate(3)
    with pytest.raises(ValueError, match="degrees = 0: expected a whole number"):
        cd.error_estimate(solution, degrees=0)
    with pytest.raises(ValueError, match="degree = 16: expected at most 15"):
        cd.error_estimate(solution, degrees=15)
    with pytest.raises(ValueError, match="no body 'middle'; expected some of 'lower', 'upper'"):
        solution.scene.with_bodies({"middle": solution.scene.bodies[0]})
    with pytest.raises(TypeError, match="'lower' is 3; expected a body"):
        solution.scene.with_bodies({"lower": 3})
    with pytest.raises(ValueError, match="contact = 'x': expected an index or one of 'lower-upper'"):
        cd.error_estimate(solution).contact("x")


RANKS = """
import numpy as np
from mpi4py import MPI
import contactdd as cd
from scenes import block, stack

loads = [[cd.Pressure("bottom", 10.0)], [], [cd.Pressure("top", 10.0)]]
bodies = [block(f"b{i}", i, (n, n // 2), loads=loads[i]) for i, n in enumerate((8, 12, 8))]
estimate = cd.error_estimate(cd.solve(stack(bodies, comm=MPI.COMM_WORLD)))
print("told", repr(float(estimate.pressure.relative)), repr(float(estimate.displacement("b1").error)))
"""


def test_the_same_estimate_on_several_ranks():
    told = []
    for ranks in (1, 2):
        done = launch(ranks, RANKS)
        assert done.returncode == 0, done.stderr
        told.append([line.split()[1:] for line in done.stdout.splitlines() if line.startswith("told")])
    numbers = np.array(told[0] + told[1], dtype=float)
    assert len(numbers) == 3
    assert np.abs(numbers / numbers[0] - 1).max() < 1e-6  # two solves to a tolerance of 1e-10


def between_walls(refine, layer, quadrature="gauss", unlike=True, degree=1):
    """The groove, the upper mesh finer than the lower one or as fine."""
    low = scenes.block("low", 0, (16 * refine, 8 * refine), loads=[cd.Pressure("bottom", 10.0)], degree=degree)
    fine = (22 * refine, 11 * refine) if unlike else (16 * refine, 8 * refine)
    high = scenes.block("high", 1, fine, loads=[cd.Pressure("top", 10.0)], degree=degree)
    contact = cd.Contact((low, "top"), (high, "bottom"), layer, gap=scenes.groove, quadrature=quadrature)
    return cd.Scene([low, high], [contact])


STIFF = cd.LinearLayer(1e8)  # a hundred times as stiff as the facets are


@pytest.fixture(scope="module")
def stiffly_pressed():
    return cd.solve(between_walls(6, STIFF, degree=2, unlike=False))


@pytest.mark.parametrize("unlike", [True, False])
@pytest.mark.parametrize("quadrature", ["gauss", "facet", "mortar"])
def test_a_stiff_layer(stiffly_pressed, quadrature, unlike):
    """Where pressures waver between points, or belong to nodes or facets, like is compared with like."""
    solution = cd.solve(between_walls(1, STIFF, quadrature, unlike))
    nodal = quadrature == "mortar" or unlike
    with pytest.warns(cd.ContactWarning, match="linear between nodes") if nodal else nullcontext():
        estimate = cd.error_estimate(solution)
    result = estimate.contact().result
    p = stiffly_pressed.contact().at(result.x)["pressure"]
    true = np.sqrt(result.weights @ (result.pressure - p) ** 2 / (result.weights @ p**2))
    assert 0.5 < estimate.pressure.relative / true < 2.5


def test_hard_contact():
    """Hard contact is nearly the contact of a layer that is stiffer than all."""
    truth = cd.solve(between_walls(6, cd.HardContact(), "mortar"))
    with pytest.warns(cd.ContactWarning, match="with no layer its pressure is linear between nodes"):
        estimate = cd.error_estimate(cd.solve(between_walls(1, cd.HardContact(), "mortar")))
    result = estimate.contact().result
    p = truth.contact().at(result.x)["pressure"]
    true = np.sqrt(result.weights @ (result.pressure - p) ** 2 / (result.weights @ p**2))
    assert 0.5 < estimate.pressure.relative / true < 2.5


@pytest.mark.parametrize(("layer", "quadrature"), [(STIFF, "gauss"), (STIFF, "mortar"), (cd.HardContact(), "mortar")])
def test_what_a_higher_degree_cannot_tell_is_refused(layer, quadrature):
    """Measured, the estimate was a twentieth of the error there: the field of nodes is as coarse as before."""
    solution = cd.solve(between_walls(1, layer, quadrature, degree=2))
    with pytest.raises(ValueError, match=r"'low–high': with .* its pressure is linear between nodes"):
        cd.error_estimate(solution)
