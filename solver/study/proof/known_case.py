"""A case of the proof: a scene's problem whose answer is known, and what is known of it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlencode

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.discrete.structure import Loop, LoopFields
from solver.latin import Ending, Solution, solve
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.study.cases.case import Case
from solver.study.mesh import size_of
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
    def bar(self) -> tuple[float, float]:
        """ES, N, and mu p, N/m, of a uniform bar."""
        settings = self.settings
        return settings.young * settings.section, settings.friction * settings.pressure

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
    def _loop(self) -> Loop:
        loop: Loop = self.settings.structure().loop(self.problem)
        return loop

    @property
    def loop_displacement(self) -> Array:
        """Displacement of the scene's loop, shape (n_instants,)."""
        return self._loop.displacement(self.fields.displacement)

    @property
    def loop_force(self) -> Array:
        """Force of that loop, shape (n_instants,)."""
        return self._loop.force(self.fields)


Number = tuple[str, str, float, float]
"""Quantity, unit, what is known, and what an answer has."""


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
        What is known of an answer, beside what it has.
    part
        Of the report.
    """

    title: str
    source: str
    allowed: float
    scene: str
    values: Mapping[str, Any]
    numbers: Callable[[Answer], Iterable[Number]]
    part: str = CLOSED_FORMS

    @property
    def settings(self) -> Any:
        """Settings of the run."""
        return CATALOGUE[self.scene].checked(dict(self.values))

    @property
    def mesh(self) -> str:
        """What it is solved on, and over how many instants."""
        return size_of(self.settings)

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
    """One number of one case by one solver.

    Attributes
    ----------
    solver
        LATIN, or the incremental one.
    ended
        Whether the run came to its end; a number of one that did not proves nothing.
    exact, found
        What is known, and what the solver has, in the same unit.
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

    settings, source = case.settings, f"{case.formula}. {case.how} {case.source}"
    changes = settings.changed()
    return KnownCase(case.title, source, case.tolerance, settings.scene, changes, numbers, TRADE)
