"""The method that settings describe."""

from __future__ import annotations

from solver.latin import (
    PGD,
    Anderson,
    Auto,
    Full,
    Latin,
    Nested,
    Paper,
    StatusStep,
    Stop,
)
from solver.settings.scene import Settings


def method_of(settings: Settings) -> Latin:
    """Make the method that checked settings describe."""
    acceleration = None
    if settings.acceleration == "anderson":
        acceleration = Anderson()
    start = None
    if settings.start == "nested":
        start = Nested(settings.coarser)
    finish = None
    if settings.finish != "none":
        finish = StatusStep(at_once=settings.finish == "at-once")
    return Latin(
        direction=_direction_of(settings),
        linear=_linear_stage_of(settings),
        multiscale=settings.multiscale,
        relaxation=settings.relaxation,
        acceleration=acceleration,
        start=start,
        finish=finish,
        stop=Stop(settings.accuracy, settings.tolerance, settings.max_iterations),
        threads=settings.threads,
    )


def _direction_of(settings: Settings) -> Paper | Auto:
    """Search direction, with the factor on it."""
    if settings.search_direction == "paper":
        return Paper(settings.k_scale)
    return Auto(settings.k_scale)


def _linear_stage_of(settings: Settings) -> Full | PGD:
    """Linear stage: full fields, or a sum of modes."""
    if settings.linear_stage == "full":
        return Full()
    return PGD(
        modes=settings.pgd_modes,
        tolerance=settings.pgd_tolerance,
        pairs=settings.pgd_pairs,
        sharing=settings.pgd_sharing,
    )
