"""From flat settings to the method: the one place that knows both."""

from __future__ import annotations

from functools import partial

from solver.discrete.problem import Problem
from solver.latin import (
    PGD,
    Anderson,
    Auto,
    FromStatus,
    Full,
    Latin,
    Nested,
    Paper,
    StatusStep,
    Stop,
)
from solver.latin.directions import SearchDirection
from solver.settings import Settings


def method_of(settings: Settings) -> Latin:
    """Method that checked settings describe."""
    at_once = settings.finish == "at-once"
    return Latin(
        direction=_direction(settings),
        linear=_linear(settings),
        multiscale=settings.multiscale,
        relaxation=settings.relaxation,
        acceleration=Anderson() if settings.acceleration == "anderson" else None,
        start=Nested(partial(_coarser_problems, settings)) if settings.start == "nested" else None,
        finish=None if settings.finish == "none" else StatusStep(at_once=at_once),
        stop=Stop(settings.accuracy, settings.tolerance, settings.max_iterations),
        threads=settings.threads,
    )


def _coarser_problems(settings: Settings) -> list[Problem]:
    return [structure.discretise() for structure in settings.coarser()]


def _direction(settings: Settings) -> SearchDirection | FromStatus:
    rule: type[SearchDirection] = Paper if settings.search_direction == "paper" else Auto
    first = rule(settings.k_scale)
    updates = settings.k_update == "status" and settings.applies("k_update")
    return FromStatus(first) if updates else first


def _linear(settings: Settings) -> Full | PGD:
    if settings.linear_stage == "full":
        return Full()
    return PGD(
        modes=settings.pgd_modes,
        tolerance=settings.pgd_tolerance,
        pairs=settings.pgd_pairs,
        sharing=settings.pgd_sharing,
    )
