"""`solve`: choose the method, the relaxation, the start and the stopping rule, run, and say how it ended."""

from __future__ import annotations

import math
import os
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, ParamSpec, cast

import numpy as np

from .base.arrays import Floats
from .base.checks import as_bool, as_count, check_choice, finite, positive
from .doubts import warn_of_doubts
from .errors import CheckpointError, ContactWarning, NoEquilibriumError, NotConvergedError
from .hard_contact import HardContact
from .history import Record
from .iteration.augmented import AugmentedRun
from .iteration.checkpoint import CheckpointWriter, closures, read
from .iteration.interruption import interrupts_agreed
from .iteration.progress import Progress
from .iteration.run import Observer, Run
from .iteration.step import Step, find_step
from .iteration.stopping import StoppingCriterion, Termination
from .relaxation import Gamma, Relaxation, relaxations
from .scene import Scene
from .scheme import Scheme, find_scheme
from .solution import Solution
from .system import start as starts
from .system.ensemble import Ensemble
from .system.likeness import refuse_differences

if TYPE_CHECKING:
    from .interface.discretise import Interface
    from .iteration.active_set import ActiveSetRun
    from .iteration.pressures import Pressures
    from .layers.gasket import GasketAtPoints, GasketLayer

P = ParamSpec("P")


#: The default γ of the decomposed methods: the paper's best.
BEST_GAMMA = 0.6


def _by_all_ranks(function: Callable[P, Solution]) -> Callable[P, Solution]:
    """The same function of a scene, made collective: an error or Ctrl-C on one rank ends it on all."""

    @wraps(function)
    def together(*arguments: P.args, **options: P.kwargs) -> Solution:
        scene = arguments[0] if arguments else options.get("scene")
        if not isinstance(scene, Scene):
            raise TypeError(f"scene = {scene!r}: expected a cd.Scene")
        if "accuracy" in options:
            raise TypeError(
                f"accuracy = {options['accuracy']!r}: solve keeps the scene's meshes; expected "
                "cd.adapt(scene, accuracy), which makes meshes for it"
            )
        if scene.ranks.alone:
            return function(*arguments, **options)
        with scene.ranks.together(), interrupts_agreed(scene.ranks):
            return function(*arguments, **options)

    return together


@_by_all_ranks
def solve(
    scene: Scene,
    method: str | Scheme = "auto",
    *,
    gamma: Gamma | None = None,
    tolerance: float = 1e-10,
    criterion: str = "residual",
    max_iterations: int = 5000,
    start: starts.Given | Solution | None = None,
    previous: starts.Given | None = None,
    local_solver: str = "auto",
    callback: Callable[[Record], bool | None] | None = None,
    progress: bool | None = None,
    on_failure: str = "raise",
    checkpoint: str | Path | None = None,
    checkpoint_every: float = 30.0,
    resume: bool = False,
    time_limit: float | None = None,
) -> Solution:
    """The solution of the contact problem (15) of a scene.

    Args:
        scene: The scene.
        method: "auto" (Newton's method with an exact line search on the convex energy F₁; `history` notes which linear
            solver was chosen), the decomposed "one-point" (22), "chord" (32), "kurchatov" (36), "neumann", "robin" and
            "anderson" (the chord method, accelerated), the coupled "newton" (17), "newton-chord" (26) and
            "newton-kurchatov" (27), "newton-krylov" (17) (its linear systems by conjugate gradients, preconditioned by
            solves of the single bodies), or a `Scheme`.
        gamma: The relaxation γ > 0: a number, a sequence (the run ends with it), a function of the iteration k
            from 0, or of k and the `Correction` with the history, such as Aitken's; or "search" for the minimum of the
            energy F₁; by default 0.6 for the decomposed methods and "search" for the others.
        tolerance: The bound of the stopping criterion (no unit).
        criterion: "residual": ‖F₁'(u)‖ relative to the forces at work; or "change", the paper's rule,
            ‖u_n^{k+1} − u_n^k‖₂ ≤ tolerance ‖u_n^{k+1}‖₂ for every body.
        max_iterations: The largest number of iterations; after it the run ends with the status "iteration limit".
        start: u_n at the contact points (length), a number or a function of the coordinates x (dim, n), or a `Solution`
            to go on from, also one in elements of another degree or on meshes that the scene's were refined from. By
            default the decomposed methods, and all with a given gamma, start from contacts closed by the mean load, the
            others from undeformed bodies, of which floating ones are moved until their contacts close.
        previous: u_n of the iterate before the start (length), for the two-point methods; by default the start itself.
        local_solver: "condensed" (each body is condensed once to the displacements at its contacts, by a Schur
            complement), "assembled" (each body's full matrix is assembled and factored in every iteration), "multigrid"
            (nothing is factored, for large solids), a registered name, or "auto": condensed or multigrid, whichever is
            estimated to cost less; `history` notes the estimates for large solids.
        callback: A function of each iteration's `Record`; the run ends when it returns True.
        progress: Whether a progress bar is shown after the first second, by default on a terminal or in a notebook.
        on_failure: "raise" an error, or "return" the last iterate as a solution with its status.
        checkpoint: The path of a file to keep the state in. It is written every `checkpoint_every` seconds, at the end
            and when the run is interrupted (Ctrl-C, SIGTERM) or fails. A file that is no checkpoint of the same bodies
            and method, or that another run writes, is kept, and a file beside it is taken, with a warning; a file that
            cannot be written causes a warning only.
        checkpoint_every: The time between checkpoints (s).
        resume: Whether to go on from the checkpoint, to the same digits, if the file exists.
        time_limit: The time after which the run stops with the status "stopped" (s), by default unlimited.

    Returns:
        The solution; with the status "stopped" if the callback or the time limit ended the run.

    Raises:
        TypeError, ValueError: An argument is none of these; hard contacts with a checkpoint.
        NotConvergedError: The run ended without a solution.
        NoEquilibriumError: There is no solution: the loads move a body for ever.
        CheckpointError: The checkpoint is damaged or of another run.

    Warns:
        LayerRangeWarning: A layer is compressed further than its law is known.
        LargeStrainWarning: Strains or rotations are too large for linear theory.
        ContactWarning: Facets leave open which curved surface is meant; a gasket was closed further in the start than
            the scene remembers.
        RuntimeWarning: The checkpoint cannot be written, or not in the file given.

    Example:
        >>> import contactdd as cd
        >>> steel, mesh = cd.Isotropic(E=2e5, nu=0.0), cd.rectangle((0, 0), (2, 1), (2, 1))
        >>> lower = cd.Body("lower", mesh, steel, supports=[cd.Fixed("bottom")])
        >>> rollers = [cd.Symmetry("left"), cd.Symmetry("right")]
        >>> upper = cd.Body("upper", mesh.moved((0, 1)), steel, supports=rollers, loads=[cd.Pressure("top", 3.0)])
        >>> contact = cd.Contact((lower, "top"), (upper, "bottom"), cd.LinearLayer(1e4))
        >>> solution = cd.solve(cd.Scene([lower, upper], [contact]))
        >>> solution.status, round(solution.contact().peak_pressure, 6)
        ('converged', 3.0)
    """
    began, ranks = time.process_time(), scene.ranks
    scheme = find_scheme(method)
    check_choice("on_failure", on_failure, ("raise", "return"))
    relaxation = _relaxation(gamma, scheme)
    rule = _rule(tolerance, criterion, max_iterations, scheme)
    file, every = _file(checkpoint, as_bool("resume", resume)), positive("checkpoint_every", checkpoint_every)
    seconds = math.inf if time_limit is None else positive("time_limit", time_limit)
    _check_start(start, previous)
    if callback is not None and not callable(callback):
        raise TypeError(f"callback = {callback!r}: expected a function of a record")
    shown = None if progress is None else as_bool("progress", progress)
    if not ranks.alone:
        given = {"gamma": gamma, "start": "solution" if isinstance(start, Solution) else start, "previous": previous}
        limits = {"tolerance": tolerance, "criterion": criterion, "max_iterations": max_iterations}
        ends = {"time_limit": time_limit, "on_failure": on_failure, "resume": resume}
        way = {"method": f"{scheme.name}, {scheme.step}", "local_solver": local_solver}
        refuse_differences(scene, way | given | limits | ends)
    if file is not None and _is_hard(scene):
        raise ValueError(f"checkpoint = {checkpoint!r}: hard contacts' multipliers are not kept; expected None")
    saved = file if file is not None and resume and ranks.once(file.exists) else None
    if saved is not None:
        scene = _remembering(scene, saved)
    ensemble = _ensemble(scene, scheme, local_solver)
    step = find_step(scheme, ensemble, ranks)
    if local_solver == "auto" and scene.estimates:
        step.note = ", ".join(filter(None, (step.note, *scene.estimates)))
    run = _begun(scene, ensemble, scheme, step, saved, gamma, start, previous)
    writer = CheckpointWriter(file if ranks.comm.rank == 0 else None, every, run) if isinstance(run, Run) else None
    with Progress(shown, rule.tolerance, rule.criterion) as bar, writer or nullcontext():
        ending = run.iterate(relaxation, rule, _observer(bar, writer, callback, seconds))
    end, spent = (ending.status, ending.reason, scheme.name), time.process_time() - began
    solution = Solution(scene, ensemble, run.state, run.history, *end, local_solver, spent)
    warn_of_doubts(solution)
    if on_failure == "raise":
        _raise_failure(solution, ending)
    return solution


def _begun(
    scene: Scene,
    ensemble: Ensemble,
    scheme: Scheme,
    step: Step,
    saved: Path | None,
    gamma: Gamma | None,
    start: starts.Given | Solution | None,
    previous: starts.Given | None,
) -> Run | AugmentedRun | ActiveSetRun:
    """The run at its first iterate, or as a checkpoint has kept it."""
    if saved is not None:
        return Run(ensemble, scene.ranks, scheme, step, *read(saved, ensemble, scheme.name, scene.ranks))
    if isinstance(start, Solution):
        _warn_of_forgotten(scene, start)
    first = _start(ensemble, scene, scheme, gamma, start, previous)
    if not _is_hard(scene):
        return Run(ensemble, scene.ranks, scheme, step, first)
    if hasattr(step, "held") and (gamma is None or isinstance(gamma, str)):  # in the pressures, with nothing to relax
        from .iteration.active_set import ActiveSetRun

        return ActiveSetRun(ensemble, scene.ranks, scheme, cast("Pressures", step), first)
    return AugmentedRun(ensemble, scene.ranks, scheme, step, first)


def _observer(
    bar: Progress,
    writer: CheckpointWriter | None,
    callback: Callable[[Record], bool | None] | None,
    seconds: float,
) -> Observer:
    """What shows, keeps and passes on every iteration, and ends the run if the callback says so or the time is over."""
    deadline = time.monotonic() + seconds

    def observe(record: Record) -> bool:
        bar.update(record)
        if writer is not None:
            writer.update()
        return bool(callback is not None and callback(record)) or time.monotonic() >= deadline

    return observe


def _remembering(scene: Scene, file: Path) -> Scene:
    """The scene with what its gaskets remembered when a checkpoint was written."""
    gaskets = [index for index, interface in enumerate(scene.interfaces) if interface.layer.remembers]
    known = closures(file, scene.ranks) if gaskets else {}
    for index in gaskets:
        contact, x = scene.contacts[index], scene.interfaces[index].x.T
        if known.get(index, np.zeros(0)).shape != x.shape[1:]:
            raise CheckpointError(f"checkpoint = {str(file)!r}: no closures of contact {contact.name!r} at its points")
        scene = scene.with_layer(cast("GasketLayer", contact.layer).remembering(x, known[index]), contact.name)
    return scene


def _warn_of_forgotten(scene: Scene, start: Solution) -> None:
    """Warn where a start's gaskets were closed further than those of the scene remember."""
    if not start.converged or not any(interface.layer.remembers for interface in scene.interfaces):
        return
    for interface, after in zip(scene.interfaces, start.scene_after.interfaces, strict=False):
        here, there = _closures(interface), _closures(after)
        if here.shape == there.shape and np.any(there > here):
            warnings.warn(
                f"start: the gasket of contact {interface.contact.name!r} was closed up to {there.max():.6g} in it, "
                f"and the scene's remembers {here.max():.6g}; start.scene_after is the scene that goes on from there",
                ContactWarning,
                stacklevel=5,  # `_begun`, `solve` and its decorator are between
            )


def _closures(interface: Interface) -> Floats:
    """What the layer of a contact remembers, (points,); nothing of one that does not."""
    return cast("GasketAtPoints", interface.layer).closures if interface.layer.remembers else np.zeros(0)


def _is_hard(scene: Scene) -> bool:
    """Whether a contact of the scene has no layer."""
    return any(isinstance(contact.layer, HardContact) for contact in scene.contacts)


def _ensemble(scene: Scene, scheme: Scheme, local_solver: str) -> Ensemble:
    """All bodies of the scene as one, with the contacts as the scheme needs them."""
    problems, interfaces = scene.local_problems(local_solver), scene.interfaces
    if scheme.decomposed and _is_hard(scene):
        interfaces = [interface.decomposed() for interface in interfaces]
    return Ensemble(problems, [*interfaces, *scene.sliding], scene.ranks)


def _raise_failure(solution: Solution, ending: Termination) -> None:
    """Raise what a run without a solution has ended in."""
    if ending.status in ("converged", "stopped"):
        return
    if ending.unbounded_motion is not None:
        loose = ending.unbounded_motion
        raise NoEquilibriumError(loose.body, loose.motion, solution, loose.advice)
    raise NotConvergedError(ending.status, ending.reason, solution)


def _rule(tolerance: float, criterion: str, most: int, scheme: Scheme) -> StoppingCriterion:
    """The stopping rule, its numbers checked."""
    check_choice("criterion", criterion, ("residual", "change"))
    most = as_count("max_iterations", most)
    # A relaxed method may come closer by a thousandth per iteration and still arrive; Newton's does not creep.
    return StoppingCriterion(positive("tolerance", tolerance), criterion, most, 250 if scheme.decomposed else 40)


def _relaxation(gamma: Gamma | None, scheme: Scheme) -> Iterator[Relaxation]:
    """The relaxations γ^0, γ^1, …; None where γ is found by a line search."""
    if gamma is None:
        gamma = BEST_GAMMA if scheme.decomposed else "search"
    return relaxations(gamma)


def _file(checkpoint: str | Path | None, resume: bool) -> Path | None:
    """The path of the checkpoint, checked: a file in a folder that can be written to."""
    if checkpoint is None:
        if resume:
            raise ValueError("resume = True: expected a checkpoint to go on from")
        return None
    if not isinstance(checkpoint, (str, os.PathLike)):
        raise TypeError(f"checkpoint = {checkpoint!r}: expected the path of a file")
    file = Path(checkpoint)
    if (file.exists() and not file.is_file()) or not os.access(file.parent, os.W_OK):
        raise ValueError(f"checkpoint = {checkpoint!r}: expected a file in a folder that can be written to")
    return file


def _check_start(start: starts.Given | Solution | None, previous: starts.Given | None) -> None:
    """Refuse a start that is no number, function or solution."""
    if start is None and previous is not None:
        raise ValueError(f"previous = {previous!r}: expected a start to go with it")
    for name, value in (("start", None if isinstance(start, Solution) else start), ("previous", previous)):
        if value is not None and not callable(value):
            finite(name, value)


def _start(
    ensemble: Ensemble,
    scene: Scene,
    scheme: Scheme,
    gamma: Gamma | None,
    start: starts.Given | Solution | None,
    previous: starts.Given | None,
) -> starts.State:
    """The first iterate."""
    ranks = scene.ranks
    if isinstance(start, Solution):
        bodies = {body.name: body for body in scene.bodies}
        state = starts.from_displacements(ensemble, ranks, lambda name: start.displacement_on(bodies[name]))
        return starts.with_multipliers(state, ensemble, start.multipliers)
    if start is not None:
        return starts.from_contacts(ensemble, ranks, start, previous)
    # Contacts without pressure hold no body; only a line search on the energy survives that.
    guarded = not scheme.decomposed and (gamma is None or isinstance(gamma, str))
    return starts.rigidly_closed(ensemble) if guarded else starts.uniformly_closed(ensemble, ranks)
