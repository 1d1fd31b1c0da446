"""A case of the proof: a scene's problem whose answer is known, and what is known of it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlencode

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.discrete.structure import Loop, LoopFields
from solver.latin import Ending, Solution, solve
from solver.reference.incremental import reference_of
from solver.scenes import discretise, loop_of
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.study.cases.case import Case
from solver.study.quantities.finished import FinishedRun

PARTS = CLOSED_FORMS, PUBLISHED, TRADE = "Closed forms", "Published numbers", "Cases of the trade"
"""Parts of the report, by where what is known is from; cases of the trade are solved by LATIN."""


@dataclass(frozen=True, eq=False)
class Answer:
    """A problem with its settings, and what a run or a reference has for it."""

    settings: Any
    problem: Problem
    fields: LoopFields
    solution: Solution | None = None

    @property
    def support(self) -> tuple[Array, Array]:
        """Pressing force and friction on a support, N, each of shape (n_points, n_instants)."""
        contact = self.fields.contact("support")
        assert contact.normal_force is not None
        return contact.normal_force, contact.tangential_force

    @property
    def slip(self) -> Array:
        """Slip on a support, m, same shape."""
        return self.fields.contact("support").slip

    @property
    def loop(self) -> Loop:
        """Loop that the scene shows."""
        return loop_of(self.settings, self.problem)


Number = tuple[str, str, float, float]
"""Quantity, unit, what is known, and what an answer has."""


@dataclass(frozen=True, eq=False)
class KnownCase:
    """A problem whose answer is known from a source, and the largest deviation that is allowed.

    `numbers` are what is known of an answer, beside what it has; `part` is that of the report.
    """

    title: str
    source: str
    allowed: float
    settings: Settings
    numbers: Callable[[Answer], Iterable[Number]]
    part: str = CLOSED_FORMS

    @property
    def address(self) -> str:
        """What follows the page's address to open this run there."""
        texts = {
            name: value if isinstance(value, str) else json.dumps(value, separators=(",", ":"))
            for name, value in self.settings.changed().items()
        }
        return f"?{urlencode({'scene': self.settings.scene, **texts})}"


@dataclass(frozen=True)
class ProofRow:
    """One number of one case by one solver, as it is known and as that has it.

    `ended` is whether the run came to its end; a number of one that did not proves nothing.
    """

    case: KnownCase
    solver: str
    ended: bool
    quantity: str
    unit: str
    exact: float
    found: float

    @property
    def deviation(self) -> float:
        """Distance of the two over what is known."""
        return float(abs(self.found - self.exact) / abs(self.exact))

    @property
    def holds(self) -> bool:
        """Whether it is as it has to be."""
        return self.ended and self.deviation <= self.case.allowed


def rows_of(case: KnownCase) -> Iterator[ProofRow]:
    """Solve a case by LATIN and, unless it is of the trade, by the incremental solver too."""
    settings = case.settings
    problem = discretise(settings)
    solution = solve(problem, method_of(settings))
    ended = solution.status.ending is Ending.CONVERGED
    for number in case.numbers(Answer(settings, problem, solution.iterate, solution)):
        yield ProofRow(case, "LATIN", ended, *number)
    if case.part != TRADE:
        reference = reference_of(problem)
        for number in case.numbers(Answer(settings, problem, reference)):
            yield ProofRow(case, "incremental", bool(reference.converged.all()), *number)


def known_case(case: Case) -> KnownCase:
    """Make a row of the proof of a case of the trade."""
    asked = case.quantity

    def numbers(answer: Answer) -> Iterator[Number]:
        assert answer.solution is not None
        found = asked(FinishedRun(answer.settings, answer.solution))
        yield asked.title, asked.unit or "-", case.known, found

    source = f"{case.formula}. {case.how} {case.source}"
    return KnownCase(case.title, source, case.tolerance, case.settings, numbers, TRADE)
