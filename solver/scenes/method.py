"""From flat settings to the method: the one place that knows both."""

from __future__ import annotations

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
from solver.settings.scene import Settings


def method_of(settings: Settings) -> Latin:
    """Method that checked settings describe."""
    at_once = settings.finish == "at-once"
    direction = (Paper if settings.search_direction == "paper" else Auto)(
        settings.k_scale
    )
    updates = settings.k_update == "status" and settings.applies("k_update")
    modes = PGD(
        modes=settings.pgd_modes,
        tolerance=settings.pgd_tolerance,
        pairs=settings.pgd_pairs,
        sharing=settings.pgd_sharing,
    )
    return Latin(
        direction=FromStatus(direction) if updates else direction,
        linear=Full() if settings.linear_stage == "full" else modes,
        multiscale=settings.multiscale,
        relaxation=settings.relaxation,
        acceleration=Anderson() if settings.acceleration == "anderson" else None,
        start=Nested(settings.coarser) if settings.start == "nested" else None,
        finish=None if settings.finish == "none" else StatusStep(at_once=at_once),
        stop=Stop(settings.accuracy, settings.tolerance, settings.max_iterations),
        threads=settings.threads,
    )
