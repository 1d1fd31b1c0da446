"""A case of the proof: a scene's problem whose answer is known, and what is known of it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple
from urllib.parse import urlencode

import numpy as np

from solver.discrete.problem import Problem
from solver.discrete.structure import LoopFields
from solver.latin import Ending, solve
from solver.reference.choice import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of

LATIN, INCREMENTAL = "LATIN", "incremental"
CLOSED_FORMS, PUBLISHED = "Closed forms", "Published numbers"
"""Parts of the report, by where what is known is from."""


@dataclass(frozen=True)
class KnownNumber:
    """A number that is known, and what a run has for it, in the same unit."""

    quantity: str
    unit: str
    exact: float
    found: float

    @property
    def deviation(self) -> float:
        """Distance of the two over what is known."""
        return float(np.abs(self.found - self.exact) / np.abs(self.exact))


class Answer(NamedTuple):
    """A problem, and what a run or a reference has for it."""

    problem: Problem
    fields: LoopFields


@dataclass(frozen=True, eq=False)
class KnownCase:
    """A problem whose answer is known.

    Attributes
    ----------
    title
        What it is.
    source
        Where the answer is from, in full.
    allowed
        Largest deviation: what the mesh leaves.
    scene, values
        The problem: a name of the catalogue, and settings that differ from its own.
    numbers
        What is known, beside what an iterate or a reference has; called with settings and answer.
    part
        Of the report.
    """

    title: str
    source: str
    allowed: float
    scene: str
    values: Mapping[str, Any]
    numbers: Callable[[Any, Answer], Iterable[KnownNumber]]
    part: str = CLOSED_FORMS

    @property
    def settings(self) -> Any:
        """Settings of the run."""
        return CATALOGUE[self.scene].settings.checked(dict(self.values))

    @property
    def mesh(self) -> str:
        """What it is solved on, and over how many instants."""
        names = [name for name in ("elements", "elements_up") if name in self.values]
        elements = " x ".join(str(self.values[name]) for name in names)
        return f"{elements} elements, {len(self.settings.times())} instants"

    @property
    def address(self) -> str:
        """What follows the page's address to open this run there."""
        texts = {
            name: value if isinstance(value, str) else json.dumps(value, separators=(",", ":"))
            for name, value in self.values.items()
        }
        return f"?{urlencode({'scene': self.scene, **texts})}"


@dataclass(frozen=True)
class ProofRow:
    """One number of one case by one solver."""

    case: KnownCase
    solver: str
    number: KnownNumber
    ended: bool
    """Whether the run came to its end; a number of one that did not proves nothing."""

    @property
    def holds(self) -> bool:
        """Whether it is as it has to be."""
        return self.ended and self.number.deviation <= self.case.allowed


def rows_of(case: KnownCase) -> Iterator[ProofRow]:
    """Solve a case by LATIN and by the incremental solver on the same mesh."""
    settings = case.settings
    problem = discretise(settings)
    solution = solve(problem, method_of(settings))
    ended = solution.status.ending is Ending.CONVERGED
    for number in case.numbers(settings, Answer(problem, solution.iterate)):
        yield ProofRow(case, LATIN, number, ended)
    reference = reference_of(problem)
    for number in case.numbers(settings, Answer(problem, reference)):
        yield ProofRow(case, INCREMENTAL, number, bool(reference.converged.all()))
