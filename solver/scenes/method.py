"""From flat settings to the method: the one place that knows both."""

from __future__ import annotations

from functools import partial
from typing import Any

from solver.latin import (
    PGD,
    Accuracy,
    Anderson,
    Auto,
    FromStatus,
    Full,
    Indicator,
    Iterations,
    Latin,
    Nested,
    Paper,
    References,
    StatusStep,
)
from solver.latin.direction import SearchDirection
from solver.scenes import coarser_problems
from solver.settings import Settings


def method_of(settings: Settings) -> Latin:
    """Give the method that checked settings describe."""
    goal = Accuracy(settings.accuracy) & Indicator(settings.tolerance)
    return Latin(
        direction=_direction(settings),
        linear=_bases(settings) if settings.is_reduced else Full(),
        multiscale=settings.multiscale,
        relaxation=settings.relaxation,
        acceleration=Anderson() if settings.acceleration == "anderson" else None,
        start=Nested(partial(coarser_problems, settings)) if settings.start == "nested" else None,
        finish=StatusStep() if settings.may_finish else None,
        stop=goal | Iterations(settings.max_iterations),
        threads=settings.threads,
    )


def _direction(settings: Settings) -> SearchDirection | FromStatus:
    along, across = settings.k_factors
    rule: type[SearchDirection] = Paper if settings.search_direction == "paper" else Auto
    first = rule(settings.k_scale, along, across)
    updates = settings.k_update == "status" and not settings.is_reduced
    return FromStatus(first) if updates else first


def _bases(settings: Settings) -> PGD:
    own: Any = settings
    is_sampled = own.local_stage == "reduced"
    return PGD(
        modes=own.pgd_modes,
        tolerance=own.pgd_tolerance,
        enrichment=own.pgd_enrichment,
        pairs=own.pgd_pairs,
        sharing=own.pgd_sharing,
        local=References(own.local_points, own.local_instants) if is_sampled else None,
    )
