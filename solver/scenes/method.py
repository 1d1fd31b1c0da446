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
    direction: Paper | Auto = Auto(settings.k_scale)
    if settings.search_direction == "paper":
        direction = Paper(settings.k_scale)
    linear: Full | PGD = Full()
    if settings.linear_stage == "pgd":
        linear = PGD(
            modes=settings.pgd_modes,
            tolerance=settings.pgd_tolerance,
            pairs=settings.pgd_pairs,
            sharing=settings.pgd_sharing,
        )
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
        direction=direction,
        linear=linear,
        multiscale=settings.multiscale,
        relaxation=settings.relaxation,
        acceleration=acceleration,
        start=start,
        finish=finish,
        stop=Stop(settings.accuracy, settings.tolerance, settings.max_iterations),
        threads=settings.threads,
    )
