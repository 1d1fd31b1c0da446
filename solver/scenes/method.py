"""From flat settings to the method: the one place that knows both."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

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
from solver.scenes import coarser_problems
from solver.settings import Settings


def method_of(settings: Settings) -> Latin:
    """Method that checked settings describe."""
    return Latin(
        direction=_direction(settings),
        linear=_LINEAR[settings.linear_stage](settings),
        multiscale=settings.multiscale,
        relaxation=settings.relaxation,
        acceleration=Anderson() if settings.acceleration == "anderson" else None,
        start=Nested(partial(coarser_problems, settings)) if settings.start == "nested" else None,
        finish=_FINISH[settings.finish],
        stop=Stop(settings.accuracy, settings.tolerance, settings.max_iterations),
        threads=settings.threads,
    )


def _direction(settings: Settings) -> SearchDirection | FromStatus:
    along, across = settings.k_factors
    rule: type[SearchDirection] = Paper if settings.search_direction == "paper" else Auto
    first = rule(settings.k_scale, along, across)
    updates = settings.k_update == "status" and settings.applies("k_update")
    return FromStatus(first) if updates else first


def _modes(settings: Settings) -> PGD:
    return PGD(
        modes=settings.pgd_modes,
        tolerance=settings.pgd_tolerance,
        pairs=settings.pgd_pairs,
        sharing=settings.pgd_sharing,
    )


_FINISH = {
    "none": None,
    "accuracy": StatusStep(at_once=False),
    "at-once": StatusStep(),
}
_LINEAR: dict[str, Callable[[Settings], Full | PGD]] = {
    "full": lambda settings: Full(),
    "pgd": _modes,
}
