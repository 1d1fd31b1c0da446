"""Runs of the bar without a worker, for what a worker has to give."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from solver.discrete import discretise
from solver.latin import Iterate, Record, Solution, iterations, solve
from solver.reference.distance import distance_to
from solver.reference.incremental import incremental
from solver.scenes.bar import BarSettings


def direct(values: dict[str, Any]) -> Solution:
    settings = BarSettings.checked({"method": "paper", **values})
    problem = discretise(settings)
    return solve(problem, settings, distance=distance_to(incremental(problem), problem))


def iterate_number(number: int, values: dict[str, Any]) -> Iterate:
    settings = BarSettings.checked({"method": "paper", **values})
    for iterate in iterations(discretise(settings), settings):
        if iterate.number == number:
            return iterate
    raise AssertionError


def timeless(records: Iterable[Record]) -> list[Record]:
    """Give records without what is measured, and without what there is of separated bases."""
    return [replace(entry, seconds=0.0, reduction=()) for entry in records]
