"""From flat settings to the parts of the method: made once, at the edge."""

from __future__ import annotations

from typing import Any

from numpy.linalg import LinAlgError

from solver.arrays import Array
from solver.definitions import SettingError
from solver.discrete.problem import Problem
from solver.latin.acceleration import anderson
from solver.latin.blocks import Blocks
from solver.latin.clock import Clock
from solver.latin.cycle import Acceleration, Everywhere, LocalPart, Parts, Unaccelerated
from solver.latin.direction import search_direction
from solver.latin.direction_update import ConstantDirection, DirectionUpdate
from solver.latin.iterate import Checkpoint
from solver.latin.linear import FullLinearStage, LinearStage
from solver.latin.local import LocalStage
from solver.latin.nested import nested_start
from solver.latin.reduced_linear import ReducedLinearStage
from solver.latin.reduced_local import AtReferences, ReducedLocalStage
from solver.scenes import coarser_problems
from solver.settings import Settings


def plugged(problem: Problem, settings: Settings, k: Array, clock: Clock) -> Parts:
    """Make the parts of the method; the linear stage is factored.

    Parameters
    ----------
    problem, settings
        What to solve, and the options of the method.
    k
        Search direction of the rows, shape (n_rows,), scaled, read-only.
    clock
        On which nothing is billed that only a viewer wants.

    Raises
    ------
    SettingError
        If k is so far from the stiffness that a factor breaks down.
    """
    try:
        return _plugged(problem, settings, k, clock)
    except (LinAlgError, RuntimeError):  # of a dense factor, and of a sparse one
        raise SettingError(
            "k_scale",
            settings.k_scale,
            "a k that holds every substructure in the digits of a number",
            "bring the factors on k nearer to 1, or the sides of the elements to each other",
        ) from None


def _plugged(problem: Problem, settings: Settings, k: Array, clock: Clock) -> Parts:
    blocks = Blocks(problem.n_rows, problem.n_instants, settings.threads)
    stage = LocalStage(problem, k, blocks=blocks)
    acceleration: Acceleration = Unaccelerated()
    linear: LinearStage[Any]
    local: LocalPart
    if settings.is_reduced:
        linear = reduced = ReducedLinearStage(problem, k, settings)
        local = Everywhere(stage, linear)
        if settings.local_stage == "reduced":
            few = ReducedLocalStage(problem, k, settings, reduced)
            local = AtReferences(stage, reduced, few, clock)
    else:
        linear = full = FullLinearStage(problem, k, multiscale=settings.multiscale, blocks=blocks)
        local = Everywhere(stage, linear)
        if settings.acceleration == "anderson":
            acceleration = anderson(problem, full, blocks)
    return Parts(k, local, linear, acceleration, float(settings.relaxation))


def direction_of(
    problem: Problem, settings: Settings, start: Checkpoint | None
) -> ConstantDirection | DirectionUpdate:
    """Choose the search direction, and whether it changes along the run."""
    k = search_direction(problem, settings)
    k.flags.writeable = False
    if settings.k_update == "status" and not settings.is_reduced:
        return DirectionUpdate(problem, k, start.course if start else None)
    return ConstantDirection(k)


def start_of(problem: Problem, settings: Settings, k: Array) -> Checkpoint | None:
    """Give the start of the settings' own choice; None is zero fields."""
    if problem.rest is not None:
        return Checkpoint(0, 0.0, problem.rest[problem.row_dofs])
    if settings.start == "nested":
        return nested_start(coarser_problems(settings), problem, k)
    return None
