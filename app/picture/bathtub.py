"""Iterations over k of the runs that a page has made, all else being equal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from app.picture.recording import Recording
from app.picture.shown import has_reference
from app.picture.usual import ANSWER
from solver.settings import Settings

APART = "k_scale", "finish"
"""Settings in which its runs may differ: what ends a search leaves its iterations as they are."""
FEWEST = 3
"""Values of k that make a curve."""
Count = tuple[int, bool]


@dataclass(frozen=True)
class Bathtub:
    """Iterations until the contact force is as near as is asked, by the factor on k.

    Attributes
    ----------
    settings
        Those that all runs have but for k.
    counts
        Iterations by `k_scale`, and whether the run got there, or had ended before.
    """

    settings: Mapping[str, Any]
    counts: Mapping[float, Count] = field(default_factory=dict)

    @property
    def points(self) -> list[tuple[float, int, bool]]:
        """Factor on k, iterations, and whether they were enough; none before there is a curve."""
        if len(self.counts) < FEWEST:
            return []
        return [(k, *count) for k, count in sorted(self.counts.items())]


def grown(before: Bathtub | None, run: Recording) -> Bathtub:
    """Give the curve with a run in it; one of other settings begins a new curve."""
    settings = _apart(run.settings)
    tub = before if before is not None and before.settings == settings else Bathtub(settings)
    count = _count(run)
    if count is None:
        return tub
    return replace(tub, counts={**tub.counts, run.settings.k_scale: count})


def _apart(settings: Settings) -> dict[str, Any]:
    values = {name: value for name, value in settings.values().items() if name not in APART}
    return {"scene": settings.scene, **values}


def _count(run: Recording) -> Count | None:
    """Count the iterations of a search from zero; None before one knows."""
    is_warm = run.choice is not None and run.choice.is_previous
    # A solution at once is no iterate, however near it is.
    if is_warm or run.settings.finish == ANSWER or not has_reference(run.settings):
        return None
    reached = run.first_within(run.settings.accuracy)
    if reached is not None:
        return reached, True
    return None if run.status is None else (run.searched, False)
