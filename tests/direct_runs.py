"""Runs of the bar without a worker, for what a worker has to give."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from solver.latin import Iterate, Record, Solution, iterations, solve
from solver.reference.distance import distance_to
from solver.reference.incremental import incremental
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of


def direct(values: dict[str, Any]) -> Solution:
    settings = BarSettings.checked(values)
    problem = discretise(settings)
    return solve(problem, method_of(settings), distance=distance_to(incremental(problem), problem))


def iterate_number(number: int, values: dict[str, Any]) -> Iterate:
    settings = BarSettings.checked(values)
    for iterate in iterations(discretise(settings), method_of(settings)):
        if iterate.number == number:
            return iterate
    raise AssertionError


def timeless(records: Iterable[Record]) -> list[Record]:
    """Give records without what is measured, what there is of separated bases, and NaN."""
    plain = []
    for entry in records:
        known = math.isfinite(entry.estimated_error)
        estimated = entry.estimated_error if known else -1.0
        plain.append(replace(entry, seconds=0.0, reduction=(), estimated_error=estimated))
    return plain
