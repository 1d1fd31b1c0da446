"""All cases: stiff and extreme ones of all scenes, and random ones."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from solver.scenes import CATALOGUE
from solver.settings import Settings
from solver.study.stability.case import METHODS, NOT_WRONG, Case
from solver.study.stability.draws import draw
from solver.study.stability.plane_cases import plane_cases
from solver.study.stability.rod_cases import bar_cases, rope_cases, strand_cases

RANDOM = "random"
"""Group of random runs."""


def cases_of(scenes: Sequence[str] = (), *, quick: bool = False) -> list[Case]:
    """Cases of some scenes, or of all; with `quick` only the few for a short check."""
    return [
        case
        for case in (*bar_cases(), *strand_cases(), *rope_cases(), *plane_cases())
        if case.scene in (scenes or CATALOGUE) and (case.quick or not quick)
    ]


def by_all_methods(cases: Sequence[Case]) -> list[Case]:
    """Cases, each by both methods."""
    return [case.by(method) for case in cases for method in METHODS]


def random_cases(scenes: Sequence[str], number: int, seed: int) -> Iterator[Case]:
    """Draw random runs of scenes in turn; row n is of scene n modulo their number.

    Parameters
    ----------
    scenes
        Names of the catalogue; all without.
    number, seed
        Of the runs, and of their draws.
    """
    names = list(scenes or CATALOGUE)
    for row in range(number):
        yield random_case(draw(names[row % len(names)], seed, row), seed, row)


def random_case(settings: Settings, seed: int, row: int) -> Case:
    """The run of settings that were drawn; right are errors of its force within its accuracy."""
    return Case(
        RANDOM,
        f"row {row} of seed {seed}",
        settings.changed(),
        NOT_WRONG,
        scene=settings.scene,
        method=_method_name(settings),
        error_force=settings.accuracy,
        error_displacement=math.inf,
    )


def _method_name(settings: Settings) -> str:
    """Name of the method; with bases, or with options of its own, that is said."""
    if settings.linear_stage == "pgd":
        return "pgd"
    own = set(settings.changed()) & {*settings.METHODS["fast"], "k_update"}
    return f"{settings.method}{', mixed' if own - {'tolerance'} else ''}"
