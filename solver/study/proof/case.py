"""A case of the proof: a problem whose answer is known, and what is to be found of it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any, NamedTuple
from urllib.parse import urlencode

import numpy as np

from solver.arrays import Array
from solver.discrete.loops import LoopFields
from solver.discrete.problem import Problem
from solver.latin import Ending, Latin, solve
from solver.reference.choice import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of

LATIN, INCREMENTAL = "LATIN", "incremental"


class ProofPart(Enum):
    """Where what is known is from."""

    CLOSED_FORMS = "Closed forms"
    PUBLISHED = "Published numbers"
    OTHERS = "Other programs on the same mesh"


@dataclass(frozen=True)
class KnownNumber:
    """A number that is known, and what a run has for it, in the same unit.

    Attributes
    ----------
    exact, found
        The number; of a field its largest size.
    apart
        Largest distance of two fields at any place and instant; 0 of a number alone.
    """

    quantity: str
    unit: str
    exact: float
    found: float
    apart: float = 0.0

    @property
    def deviation(self) -> float:
        """Distance of the two over what is known."""
        distance = np.maximum(self.apart, abs(self.found - self.exact))
        return float(distance / abs(self.exact))


def of_field(quantity: str, unit: str, exact: Array, found: Array) -> KnownNumber:
    """Compare a field everywhere: vectors along the first axis, of any shape beyond it."""
    sizes = (float(np.linalg.norm(one, axis=0).max()) for one in (exact, found, found - exact))
    return KnownNumber(quantity, unit, *sizes)


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
    mesh
        What it is solved on, and over how many instants.
    allowed
        Largest deviation: what the mesh leaves.
    problem, method
        Make both.
    numbers
        What is known of it, beside what an iterate or a reference has.
    address
        What follows the page's address to open this run there.
    part
        Of the report.
    """

    title: str
    source: str
    mesh: str
    allowed: float
    problem: Callable[[], Problem]
    method: Callable[[], Latin]
    numbers: Callable[[Answer], Iterable[KnownNumber]]
    address: str
    part: ProofPart


@dataclass(frozen=True)
class HeldNumber:
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


def of_scene(
    title: str,
    source: str,
    allowed: float,
    scene: str,
    values: Mapping[str, Any],
    numbers: Callable[[Any, Answer], Iterable[KnownNumber]],
    part: ProofPart = ProofPart.CLOSED_FORMS,
) -> KnownCase:
    """Make a case of a scene of the catalogue; `numbers` is given its settings too."""
    settings = CATALOGUE[scene].settings.checked(dict(values))
    meshes = [values[name] for name in ("elements", "elements_up") if name in values]
    mesh = f"{' x '.join(map(str, meshes))} elements, {len(settings.times())} instants"
    texts = {
        name: value if isinstance(value, str) else json.dumps(value, separators=(",", ":"))
        for name, value in values.items()
    }
    return KnownCase(
        title,
        source,
        mesh,
        allowed,
        problem=lambda: discretise(settings),
        method=lambda: method_of(settings),
        numbers=lambda answer: numbers(settings, answer),
        address=f"?{urlencode({'scene': scene, **texts})}",
        part=part,
    )


def rows_of(case: KnownCase) -> Iterator[HeldNumber]:
    """Solve a case by LATIN and by the incremental solver on the same mesh."""
    problem = case.problem()
    solution = solve(problem, case.method())
    ended = solution.status.ending is Ending.CONVERGED
    for number in case.numbers(Answer(problem, solution.iterate)):
        yield HeldNumber(case, LATIN, number, ended)
    reference = reference_of(problem)
    for number in case.numbers(Answer(problem, reference)):
        yield HeldNumber(case, INCREMENTAL, number, bool(reference.converged.all()))
