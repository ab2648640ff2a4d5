"""`solve`: choose the method, the relaxation, the start and the stopping rule, run, and say how it ended."""

from __future__ import annotations

import itertools
import math
import os
import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from functools import wraps
from pathlib import Path
from typing import ParamSpec

import numpy as np

from .base.checks import as_bool, as_count, check_choice, finite, positive
from .base.ranks import Ranks
from .errors import ContactWarning, LayerRangeWarning, NoEquilibriumError, NotConvergedError
from .hard_contact import HardContact
from .history import Record
from .iteration.augmented import AugmentedRun
from .iteration.checkpoint import CheckpointWriter, read
from .iteration.interruption import interrupts_agreed
from .iteration.progress import Progress
from .iteration.run import Run
from .iteration.step import find_step
from .iteration.stopping import StoppingCriterion
from .scene import Scene
from .scheme import Scheme, find_scheme
from .solution import Solution
from .system import start as starts
from .system.ensemble import Ensemble
from .system.likeness import refuse_differences

Gamma = float | Iterable[float] | Callable[[int], float] | str
P = ParamSpec("P")


#: γ of the decomposed methods if nothing is said: the paper's best.
BEST_GAMMA = 0.6

#: What part of the layer's compression facets may hide without a word.
DOUBTFUL = 0.1


def _by_all_ranks(function: Callable[P, Solution]) -> Callable[P, Solution]:
    """The same function of a scene, in which an error or Ctrl-C of one rank ends all."""

    @wraps(function)
    def together(*arguments: P.args, **options: P.kwargs) -> Solution:
        scene = arguments[0] if arguments else options.get("scene")
        if not isinstance(scene, Scene):
            raise TypeError(f"scene = {scene!r}: expected a cd.Scene")
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
    """Solve the contact problem (15) of a scene.

    method: "auto" (a Newton method made global by the energy; its history tells what it chose), the decomposed
        "one-point" (22), "chord" (32), "kurchatov" (36), "neumann", "robin" and "anderson" (the chord method,
        accelerated), "newton-krylov" (Newton's method by solves of the bodies apart), the coupled "newton" (17),
        "newton-chord" (26), "newton-kurchatov" (27), or a `Scheme`.
    gamma: the relaxation γ > 0: a number, a sequence, a function of the iteration from 0, or "search" for the minimum
        of the energy F₁; by default 0.6 for the decomposed methods and "search" for the others.
    tolerance, criterion: "residual" asks for ‖F₁'(u)‖ relative to the forces at work; "change" is the paper's rule,
        ‖u_n^{k+1} − u_n^k‖₂ ≤ tolerance ‖u_n^{k+1}‖₂ for every body.
    start: u_n at the contact points (length), a number or a function of the coordinates x (dim, n), or a `Solution` to
        go on from. By default the decomposed methods, and all with a given gamma, start from contacts closed by the
        mean load, the others from no deformation, with bodies that float moved until their contacts close.
    previous: u_n of the iterate before the start, for the two-point methods (by default the start itself).
    local_solver: "condensed" (each body seen from its contacts), "assembled" (reassemble and refactor every time),
        "multigrid" (nothing is factored, for large solids), or "auto".
    callback: called with each iteration's `Record`; the run ends when it returns True.
    progress: show a progress bar; by default when somebody watches.
    on_failure: "raise", or "return" the solution with its status.
    checkpoint: a file that keeps the state: written every `checkpoint_every` seconds, at the end and when the run is
        interrupted (Ctrl-C, SIGTERM) or fails; where it is something else than a checkpoint of the same bodies and
        method, or another run writes it, that stays as it is and a file beside it is taken, with a warning; so is
        there a warning, and no more, where it can't be written. resume: go on from that file, to the same digits, if
        it is there.
    time_limit: seconds after which the run stops with the status "stopped".

    Warns (`LayerRangeWarning`) where a layer is compressed further than its law is known.

    Raises NotConvergedError where the run ends without a solution, NoEquilibriumError where there is none,
    CheckpointError for a checkpoint that is damaged or of another run, ValueError for one of hard contacts.
    """
    ranks = scene.ranks
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
    hard = any(isinstance(contact.layer, HardContact) for contact in scene.contacts)
    if hard and file is not None:
        raise ValueError(f"checkpoint = {checkpoint!r}: hard contacts' multipliers are not kept; expected None")
    problems, interfaces = scene.local_problems(local_solver), scene.interfaces
    if hard and scheme.decomposed:
        interfaces = [interface.decomposed() for interface in interfaces]
    ensemble = Ensemble(problems, interfaces)
    if resume and ranks.once(file.exists):
        earlier = read(file, ensemble, scheme.name, ranks)
    else:
        earlier = (_start(ensemble, ranks, scheme, gamma, start, previous),)
    run = (AugmentedRun if hard else Run)(ensemble, ranks, scheme, find_step(scheme, ensemble, ranks), *earlier)
    keeper = CheckpointWriter(file if ranks.comm.rank == 0 else None, every, run)
    with Progress(shown, rule.tolerance, rule.criterion) as bar, keeper:
        deadline = time.monotonic() + seconds

        def observe(record: Record) -> bool:
            bar.update(record)
            keeper.update()
            return bool(callback is not None and callback(record)) or time.monotonic() >= deadline

        ending = run.iterate(relaxation, rule, observe)
    solution = Solution(scene, ensemble, run.state, run.history, ending.status, ending.reason, scheme.name)
    _warn_of_facets(solution)
    _warn_of_notes(solution)
    if on_failure == "raise" and ending.status not in ("converged", "stopped"):
        if ending.escape is not None:
            raise NoEquilibriumError(ending.escape.body, ending.escape.motion, solution, ending.escape.advice)
        raise NotConvergedError(ending.status, ending.reason, solution)
    if solution.converged:
        solution.warn_of_large_strains()
    return solution


def _warn_of_facets(solution: Solution) -> None:
    """Warn where what facets hide of a curved surface is not small beside what the layer is compressed by."""
    for interface in solution.interfaces:
        if interface.doubt is not None and solution.scene.ranks.comm.rank == 0:
            result = solution.contact(interface.contact.name)
            near = np.flatnonzero((interface.doubt > 0.0) & (result.gap < interface.doubt))
            doubt = float(interface.doubt[near].mean()) if len(near) else 0.0
            pressed = result.pressure / interface.facet_stiffness if interface.hard else -result.compression
            compression = float(pressed[near].mean()) if len(near) else 0.0
            if doubt > DOUBTFUL * compression:
                warnings.warn(
                    f"contact {interface.contact.name!r}: where the surfaces touch or nearly do, their facets do not "
                    f"tell what curved surface is meant, if any is: the gap may be off by {doubt:.3g}, while the layer "
                    f"is compressed by {compression:.3g}; a finer mesh, one of second order, facets that match, or "
                    "measure_gap=False with the gap given would tell",
                    ContactWarning,
                    stacklevel=3,
                )


def _warn_of_notes(solution: Solution) -> None:
    """Warn where a layer is compressed further than its law is known."""
    if solution.converged and solution.scene.ranks.comm.rank == 0:
        for note in solution.notes:
            warnings.warn(note, LayerRangeWarning, stacklevel=3)


def _rule(tolerance: float, criterion: str, most: int, scheme: Scheme) -> StoppingCriterion:
    """The stopping rule, its numbers checked."""
    check_choice("criterion", criterion, ("residual", "change"))
    most = as_count("max_iterations", most)
    # A relaxed method may come closer by a thousandth per iteration and still arrive; Newton's does not creep.
    return StoppingCriterion(positive("tolerance", tolerance), criterion, most, 250 if scheme.decomposed else 40)


def _relaxation(gamma: Gamma | None, scheme: Scheme) -> Iterator[float | None]:
    """γ^0, γ^1, … of whatever the user gave; None where it is to be searched."""
    if gamma is None:
        gamma = BEST_GAMMA if scheme.decomposed else "search"
    if isinstance(gamma, str):
        check_choice("gamma", gamma, ("search",))
        return itertools.repeat(None)
    if callable(gamma):
        return (positive("gamma", gamma(k)) for k in itertools.count())
    if isinstance(gamma, Iterable) and np.ndim(gamma) > 0:
        values = [positive("gamma", value) for value in gamma]
        if not values:
            raise ValueError(f"gamma = {gamma!r}: expected at least one number")
        return iter(values)
    return itertools.repeat(positive("gamma", gamma))


def _file(checkpoint: str | Path | None, resume: bool) -> Path | None:
    """The file of the checkpoint, in a folder that is there."""
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
    """Refuse what no run can start from."""
    if start is None and previous is not None:
        raise ValueError(f"previous = {previous!r}: expected a start to go with it")
    for name, value in (("start", None if isinstance(start, Solution) else start), ("previous", previous)):
        if value is not None and not callable(value):
            finite(name, value)


def _start(
    ensemble: Ensemble,
    ranks: Ranks,
    scheme: Scheme,
    gamma: Gamma | None,
    start: starts.Given | Solution | None,
    previous: starts.Given | None,
) -> starts.State:
    """The first iterate."""
    if isinstance(start, Solution):
        state = starts.from_displacements(ensemble, lambda body: start.displacement(body).x.array)
        return starts.with_multipliers(state, ensemble, start.multipliers)
    if start is not None:
        return starts.from_contacts(ensemble, ranks, start, previous)
    # Bodies that touch but do not press hold nothing; only a step that the energy watches over survives that.
    guarded = not scheme.decomposed and (gamma is None or isinstance(gamma, str))
    return starts.together(ensemble) if guarded else starts.closed(ensemble, ranks)
